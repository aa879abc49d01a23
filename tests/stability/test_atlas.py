import numpy as np
import pytest

import cyclosis as cy
from cyclosis.stability.regime_map import opened, regime_map
from cyclosis.stability.states import states


@pytest.fixture(scope="module")
def found():
    done = []
    made = regime_map(
        cy.Parameters(),
        ("kappa", [0.03, 0.2, 0.5]),
        ("alpha_u", [0.3, 0.7]),
        progress=lambda *n: done.append(n),
    )
    assert done[0] == (1, 6)
    assert done[-1] == (6, 6)
    return made


@pytest.mark.slow
def test_a_map_holds_the_states_of_its_points(found):
    for i, kappa in enumerate(found.x):
        for j, alpha_u in enumerate(found.y):
            here = states(cy.Parameters(kappa=kappa, alpha_u=alpha_u))
            assert dict(zip(found.names, found.stable[:, i, j], strict=True)) == {
                name: standing.stable for name, standing in here.items()
            }
    assert found.at(0.19, 0.9) == ("tilted",)
    assert found.at(0.5, 0.3) == ("unidirectional", "cyclosis")


def test_a_dataset_gives_the_map_back(found, tmp_path):
    data = found.to_dataset()
    data.to_netcdf(tmp_path / "map.nc", engine="h5netcdf")
    import xarray

    with xarray.open_dataset(tmp_path / "map.nc", engine="h5netcdf") as stored:
        again = opened(stored)
    assert np.array_equal(again.stable, found.stable)
    assert np.array_equal(again.cause, found.cause)
    assert (again.x_name, again.y_name, again.names) == (found.x_name, found.y_name, found.names)
    assert again.params == found.params.replace(kappa=cy.Parameters().kappa, alpha_u=cy.Parameters().alpha_u)
    assert again.length == found.length
    with pytest.raises(cy.InputError, match="regime map"):
        opened(data[["exists"]])


def test_the_length_of_the_cell_may_be_an_axis():
    made = regime_map(cy.Parameters(epsilon=0.45), ("length", [1.0, 5.0]), ("alpha_u", [0.5, 0.6]))
    row = made.names.index("cyclosis")
    assert made.stable[row, 0].all()
    assert not made.stable[row, 1].any()


@pytest.mark.parametrize(
    ("x", "y", "match"),
    [
        (("kappa", [0.1, 0.2]), ("kappa", [0.1, 0.2]), "another parameter"),
        (("seed", [1, 2]), ("kappa", [0.1, 0.2]), "one of alpha_p"),
        (("kappa", [0.2, 0.1]), ("alpha_u", [0.1, 0.2]), "grow"),
        (("kappa", [0.2]), ("alpha_u", [0.1, 0.2]), "at least two"),
        (("kappa", [-1.0, 0.2]), ("alpha_u", [0.1, 0.2]), "kappa"),
    ],
)
def test_axes_that_make_no_map_are_refused(x, y, match):
    with pytest.raises(cy.InputError, match=match):
        regime_map(cy.Parameters(), x, y)
