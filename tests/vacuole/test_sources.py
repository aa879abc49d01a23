"""The wall's velocity from runs of every model, their datasets and frames; and the flow between frames."""

import numpy as np
import pytest

import cyclosis as cy
from models.ring import Alignment, Ring, ring

GRID = cy.CylinderGrid(16, 16)
PARAMS = cy.Parameters()


@pytest.fixture(scope="module")
def polar():
    protocol = cy.Protocol(cy.change(at=1.5, mu=0.4))
    return cy.simulate(PARAMS, GRID, cy.initial.disordered(GRID, seed=1), t_end=4.0, protocol=protocol)


@pytest.fixture(scope="module")
def kinetic():
    state = cy.kinetic.dressed(cy.initial.stripes(GRID, magnitude=0.5), modes=8)
    return cy.simulate(PARAMS, GRID, state, t_end=2.0, model=cy.models.kinetic)


@pytest.mark.slow
@pytest.mark.parametrize("which", ["polar", "kinetic"])
def test_a_run_its_dataset_its_file_and_its_states_give_one_flow(which, request, tmp_path):
    run = request.getfixturevalue(which)
    data = run.to_dataset()
    path = cy.write(run, tmp_path / "run.nc")
    with cy.open_dataset(path) as lazy:
        sources = [run, data, lazy, cy.load(path), data.drop_vars("u")]
        sources.append(data.transpose("z", "time", "component", "theta", ...))
        for source in sources:
            flow = cy.vacuole.flow(source)
            for index, t in enumerate(run.times.tolist()):
                expected = data["u"].isel(time=index).values
                np.testing.assert_allclose(flow.at_time(t).surface, expected, rtol=0, atol=1e-14)
                once = cy.vacuole.flow(source, t=t)
                np.testing.assert_array_equal(once.modes, flow.at_time(t).modes)
    frame = cy.vacuole.flow(data.isel(time=-1))
    np.testing.assert_allclose(frame.surface, data["u"].values[-1], rtol=0, atol=1e-14)
    own = cy.vacuole.flow_of_state(run.params_at(run.t_final), GRID, run.final_state, model=run.model)
    np.testing.assert_allclose(own.surface, frame.surface, rtol=0, atol=1e-13)


@pytest.mark.parametrize(("interpolation", "degree"), [("linear", 1), ("cubic", 3)])
def test_between_frames_the_waves_are_interpolated(interpolation, degree):
    """A wall that is a polynomial in time is followed exactly, at uneven times too."""
    times = np.array([0.0, 0.4, 1.0, 1.3, 2.0, 2.2])
    u = np.random.default_rng(0).normal(size=(degree + 1, 2, 16, 16))
    at = lambda t: sum(part * t**k for k, part in enumerate(u))  # noqa: E731
    flow = cy.vacuole.UnsteadyFlow(GRID, times, lambda index: at(times[index]), interpolation=interpolation)
    for t in (0.1, 0.7, 1.0, 1.9, 2.1, 2.2):
        exact = cy.vacuole.flow(GRID, at(t)).modes
        np.testing.assert_allclose(flow.modes_at(t), exact, rtol=0, atol=1e-13)


def test_few_frames_are_enough_to_interpolate():
    flow = cy.vacuole.UnsteadyFlow(GRID, np.array([1.0]), lambda index: np.ones((2, 16, 16)))
    np.testing.assert_allclose(flow.at_time(1.0).surface, 1.0)
    flow = cy.vacuole.UnsteadyFlow(GRID, np.array([0.0, 1.0]), lambda index: np.full((2, 16, 16), index))
    np.testing.assert_allclose(flow.at_time(0.25).surface, 0.25)


def test_frames_are_read_once(polar):
    seen = []
    data = polar.to_dataset()
    source = cy.vacuole.flow(data)
    counted = cy.vacuole.UnsteadyFlow(
        GRID, source.times, lambda index: seen.append(index) or source.frame(index)
    )
    for t in np.linspace(0.0, 4.0, 33):
        counted.at_time(t)
    assert sorted(seen) == [0, 1, 2, 3, 4]


@pytest.mark.parametrize(
    ("message", "wrong"),
    [
        ("t = 5.0 cannot be used", lambda run: cy.vacuole.flow(run, t=5.0)),
        ("t = -0.5 cannot be used", lambda run: cy.vacuole.flow(run).at_time(-0.5)),
        ("z in the dataset", lambda run: cy.vacuole.flow(run.to_dataset().isel(z=slice(0, 8)))),
        ("theta in the dataset", lambda run: cy.vacuole.flow(run.to_dataset().isel(theta=slice(0, 8)))),
        ("coordinates", lambda run: cy.vacuole.flow(run.to_dataset().isel(z=0, drop=True))),
        ("dataset's variables", lambda run: cy.vacuole.flow(run.to_dataset()[["order"]].assign_coords(
            theta=GRID.theta, z=GRID.z))),
        ("length", lambda run: cy.vacuole.flow(run.to_dataset().drop_attrs())),
        ("u = ", lambda run: cy.vacuole.flow(run, np.ones((2, 16, 16)))),
        ("leave it out", lambda run: cy.vacuole.flow(run.to_dataset().isel(time=0), t=0.0)),
    ],
)  # fmt: skip
def test_what_is_no_run_on_a_cylinder_is_refused(polar, message, wrong):
    with pytest.raises(cy.InputError) as caught:
        wrong(polar)
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_run_without_a_flow_is_refused():
    grid = Ring(48)
    state = (1 + 0.1 * np.cos(grid.phi)) / (2 * np.pi)
    run = cy.simulate(Alignment(alpha_p=1.0, d_r=0.2), grid, state, 1.0, model=ring)
    for source in (run, run.to_dataset()):
        with pytest.raises(cy.InputError) as caught:
            cy.vacuole.flow(source)
        assert "\n" not in str(caught.value)
