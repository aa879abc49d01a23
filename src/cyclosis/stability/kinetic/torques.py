"""Parameters as the theory of the kinetic model takes them: numbers, with the rates of a convention."""

from __future__ import annotations

import numpy as np

from ...model.errors import InputError, choice
from ...model.parameters import Parameters
from ...models.kinetic.model import TORQUES
from ..uniform.uniform import check_numbers


def with_torques(params: Parameters, torques: str) -> Parameters:
    """Return parameters that hold a_p and a_u in place of α_p and α_u; "literal" changes nothing.

    Raises `InputError` for fields, and without rotational diffusion, where densities have no width.
    """
    factor = TORQUES[choice("torques", torques, tuple(TORQUES))]
    for name, value in params.items():
        if isinstance(value, np.ndarray):
            raise InputError(name, value, "one number: the state is the same all along", "simulate a cell")
    check_numbers(params)
    if params.d_r == 0:
        raise InputError("d_r", params.d_r, "above 0 for a steady density of some width", "raise it")
    return params.replace(alpha_p=factor * params.alpha_p, alpha_u=factor * params.alpha_u)
