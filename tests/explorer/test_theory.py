"""The stored curves of theory are those that the library computes."""

import numpy as np
import pytest

from cyclosis.explorer import theory
from cyclosis.explorer.catalogue import catalogue, whole
from cyclosis.model.parameters import Parameters


def check(params):
    new = theory.entry(params)
    (old,) = (each for each in theory.stored() if each["parameters"] == new["parameters"])
    assert [each["name"] for each in new["curves"]] == [each["name"] for each in old["curves"]]
    for curve, stored in zip(new["curves"], old["curves"], strict=True):
        for name in ("alpha_p", "alpha_u"):
            np.testing.assert_allclose(*(np.array(each[name], float) for each in (curve, stored)), rtol=2e-5)


def test_curves_of_an_oblique_repulsion():
    check(Parameters(repulsion_angle=0.4))


@pytest.mark.slow
def test_curves_of_the_paper():
    check(Parameters())


def test_the_table_has_the_parameters_of_every_preset_once():
    found = [each["parameters"] for each in theory.stored()]
    names = [name for name in dict(Parameters().items()) if name not in ("alpha_p", "alpha_u")]
    assert found == [{name: dict(params.items())[name] for name in names} for params in theory.described()]
    assert whole() == catalogue() | {"curves": theory.stored()}
