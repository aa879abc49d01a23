"""Where the wall's velocity comes from: an array, a state, a run, or the dataset of one."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from .. import models
from ..contract.model import Model
from ..dynamics.protocol import Protocol
from ..dynamics.schedule import Schedule
from ..dynamics.trajectory import Trajectory
from ..model.doors import door, is_a
from ..model.errors import InputError, choice, number
from ..model.grid import Array, CylinderGrid, covered
from ..models import polar
from .flow import CLOSURES, VacuoleFlow, of_surface
from .unsteady import INTERPOLATIONS, UnsteadyFlow

if TYPE_CHECKING:
    import xarray

_PLANE = ("component", "theta", "z")


@door
def flow(
    source: Any,
    u: npt.ArrayLike | None = None,
    *,
    t: float | None = None,
    closure: str = "zero_flux",
    interpolation: str = "cubic",
) -> Any:
    """Return the flow that the moving wall drives in the vacuole: a `VacuoleFlow` or `UnsteadyFlow`.

        ∇p = ∇²v,   ∇·v = 0,   v(1, θ, z) = (0, u_θ, u_z)

    `source` is a `CylinderGrid` with the wall's velocity `u` (2, n_theta, n_z), components (θ, z), in units
    of U; or a run (`Trajectory`), its dataset, or one frame of that. A run gives an `UnsteadyFlow`, or with
    `t` (in R/U) the flow at that time. The flow of a run is that of its model, computed from the states where
    a dataset does not hold it. `closure` matters only where <u_z> is not 0, which no model here has: a closed
    cell ("zero_flux") or one without a pressure drop ("no_pressure_drop"). `interpolation` in time is "cubic"
    or "linear". The wall's velocity may have a divergence. Raises `InputError` for fields that do not match
    the grid or are not finite, and for runs whose surface is no cylinder or that have no flow.

    Example:
        >>> import numpy as np
        >>> import cyclosis as cy
        >>> params, grid = cy.Parameters(), cy.CylinderGrid(16, 16)
        >>> run = cy.simulate(params, grid, cy.initial.stripes(grid, magnitude=0.5), t_end=2.0)
        >>> cy.vacuole.flow(run)
        UnsteadyFlow(16 x 16, length 5, 3 frames, t = 0 to 2)
        >>> flow = cy.vacuole.flow(run, t=2.0)
        >>> frame = cy.vacuole.flow(run.to_dataset().isel(time=-1))
        >>> bool(np.allclose(flow.surface, frame.surface))
        True
    """
    choice("closure", closure, CLOSURES)
    choice("interpolation", interpolation, INTERPOLATIONS)
    if is_a(source, "CylinderGrid"):
        if u is None:
            raise InputError("u", None, "the velocity of the wall", "write flow(grid, u)")
        if t is not None:
            raise InputError("t", t, "given only with a run", "leave it out")
        return of_surface(source, u, closure)
    if is_a(source, "ClosedGrid"):
        rule = "a cyclosis.CylinderGrid: the vacuole of a closed cell is not modelled"
        raise InputError("grid", source, rule, "use a cylinder")
    if u is not None:
        raise InputError("u", u, "given only with a grid", "write flow(grid, u), or flow(run) without u")
    if isinstance(source, Trajectory):
        found = _of_run(source)
    elif hasattr(source, "data_vars"):
        if "time" not in source.dims:
            if t is not None:
                raise InputError("t", t, "given only with a run", "leave it out: this is one frame")
            grid, _, frame = _of_dataset(source.expand_dims("time"))
            return of_surface(grid, frame(0), closure)
        found = _of_dataset(source)
    else:
        rule = "a grid (with u), a run, or the dataset of a run"
        raise InputError("source", source, rule, "write flow(grid, u) or flow(run)")
    grid, times, frame = found
    if times.size == 0:
        raise InputError("the number of saved frames", 0, "at least 1", "save fields during the run")
    unsteady = UnsteadyFlow(grid, times, frame, closure, interpolation)
    return unsteady if t is None else unsteady.at_time(t)


@door
def flow_of_state(
    params: Any, grid: CylinderGrid, state: npt.ArrayLike, *, model: Model = polar, dealias: str = "none"
) -> VacuoleFlow:
    """Return the `VacuoleFlow` of the flow that a state of a model drives, dimensionless.

    `state` is what the model has on the grid: P (2, n_theta, n_z) of the polar model, moments of the kinetic
    one. Raises `InputError` for a state that does not match the grid.

    Example:
        >>> import numpy as np
        >>> import cyclosis as cy
        >>> params, grid = cy.Parameters(), cy.CylinderGrid(16, 16)
        >>> P = cy.initial.stripes(grid)
        >>> flow = cy.vacuole.flow_of_state(params, grid, P)
        >>> bool(np.allclose(flow.surface, cy.flow(params, grid, P)))
        True
    """
    checked = model.check_state(grid, state, "state")
    problem = model.problem(params, grid, dealias=dealias, shape=checked.shape)
    return of_surface(grid, _derived(problem)(params, checked))


def _derived(problem: Any) -> Callable[[Any, Any], Array]:
    """Return the function that gives the flow of parameters and a state. Raises `InputError` if none."""
    if not isinstance(problem.grid, CylinderGrid) or "u" not in {item.name for item in problem.model.stored}:
        rule = "one with a flow on a cylinder"
        raise InputError("model", problem.model.name, rule, "give the velocity of the wall as flow(grid, u)")
    derive = problem.model.derive(problem)
    return lambda params, state: np.asarray(derive(params, state)["u"], dtype=np.float64)


def _of_run(run: Trajectory) -> tuple[CylinderGrid, Array, Callable[[int], Array]]:
    problem = run.model.problem(
        run.params, run.grid, run.terms, run.settings.dealias, shape=run.final_state.shape
    )
    derived = _derived(problem)

    def frame(index: int) -> Array:
        state = run.frames[index].astype(np.result_type(run.frames.dtype, np.float64))
        return derived(run.params_at(float(run.times[index])), state)

    return run.grid, np.asarray(run.times, dtype=np.float64), frame


def _of_dataset(data: xarray.Dataset) -> tuple[CylinderGrid, Array, Callable[[int], Array]]:
    if "s" in data.coords:
        rule = "the periodic cylinder, for which alone this is defined"
        raise InputError("the surface of the run", "a closed cell", rule, "use a run of another model")
    lacking = [name for name in ("theta", "z", "time") if name not in data.coords]
    if lacking:
        rule = "those of a run: theta, z and time"
        raise InputError("the dataset's coordinates", list(data.coords), rule, "use the dataset of a run")
    length = number("length", data.attrs.get("length"), 1e-9, 1e9, "keep the dataset's attribute `length`")
    for name, period in (("theta", 2 * np.pi), ("z", length)):
        covered(name, np.atleast_1d(data[name].values), period, "the dataset")
    grid = CylinderGrid(data.sizes["theta"], data.sizes["z"], length)
    times = np.asarray(data["time"].values, dtype=np.float64)
    if "u" not in data:
        return grid, times, _recomputed(data, grid, times)
    if set(data["u"].dims) != {"time", *_PLANE}:
        rule = "(time, component, theta, z)"
        raise InputError("dimensions of u", data["u"].dims, rule, "use the dataset of a run")
    return grid, times, lambda index: grid.check_state(data["u"].isel(time=index), "u")


def _recomputed(data: xarray.Dataset, grid: CylinderGrid, times: Array) -> Callable[[int], Array]:
    """Return the flow of the states in a dataset that does not hold it."""
    tables = json.loads(data.attrs.get("configuration", "{}"))
    kind = tables.get("model", {}).get("kind", polar.name)
    model = models.of_tables(tables) if kind in models.MODELS else None
    if model is None or "parameters" not in tables or model.state_name not in data:
        rule = "those of a run, with u or with the states of a model that is known and their configuration"
        raise InputError("the dataset's variables", list(data.data_vars), rule, "keep u in the dataset")
    given = tables["parameters"]
    params = model.parameters(**{n: data[n].values if v == "field" else v for n, v in given.items()})
    protocol = Protocol.from_tables(tables.get("protocol", []), tables.get("protocol_seed", 0))
    schedule = Schedule(params, grid, protocol)
    state = data[model.state_name].transpose("time", *model.stored[0].dims)
    paired = model.stored[0].dims[0] == "part"

    def frame(index: int) -> Array:
        now = np.asarray(state.isel(time=index).values, dtype=np.float64)
        now = now[0] + 1j * now[1] if paired else now
        problem = model.problem(params, grid, dealias=tables["run"]["dealias"], shape=now.shape)
        return _derived(problem)(schedule.params_at(float(times[index])), now)

    return frame
