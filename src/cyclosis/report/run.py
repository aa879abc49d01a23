"""Runs and their files in a few lines of text."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from .lines import aligned

if TYPE_CHECKING:
    import xarray

    from ..dynamics.trajectory import Trajectory


def summary(run: Trajectory) -> str:
    """Return the outcome of a run: status, regime, zones, widths, speed and time."""
    found, numbers = _at_the_end(run)
    effort = run.effort
    lines = {
        "status": run.message,
        "regime": str(found),
        **found.details,
        "order": f"{numbers['order']:.4f}",
        "peak speed": f"{numbers['peak_speed']:.4f} U",
        "wall time": f"{effort.wall_time:.1f} s",
        "effort": f"{effort.evaluations} right-hand sides in {effort.accepted} steps",
    }
    if run.protocol:
        lines["protocol"] = _steps_done(run)
    return aligned(lines)


def _at_the_end(run: Trajectory) -> tuple[Any, dict[str, Any]]:
    """Return the regime of the final state, and its quantities."""
    from ..analysis.diagnostics import diagnose
    from ..analysis.regimes import regime
    from ..model.precision import double
    from ..models import polar

    model, grid, state, params = run.model, run.grid, run.final_state, run.params_at(run.t_final)
    if model is polar:
        how = (run.terms, run.t_final, run.settings.dealias)
        numbers = diagnose(params, grid, state, run.t_final, run.terms, run.settings.dealias)
        return regime(params, grid, state, *how), numbers
    problem = model.problem(params, grid, run.terms, run.settings.dealias, shape=state.shape)
    system = model.system(problem, True)
    assert model.regime is not None
    with double():
        numbers = model.measure(system, model.modes(system, state), run.t_final)
    return model.regime(problem, state), numbers


def _steps_done(run: Trajectory) -> str:
    steps = len(run.protocol)
    waiting = sum(step.at > run.t_final for step in run.protocol)
    text = f"{steps} step{'s' if steps > 1 else ''}"
    return f"{text}, {waiting} of them after t = {run.t_final:g} and not reached" if waiting else text


def tree(dataset: xarray.Dataset) -> str:
    """Return a file of a run as a short tree."""
    run = json.loads(dataset.attrs["outcome"])
    asked = json.loads(dataset.attrs["configuration"])
    times = dataset["time"].values
    span = f"{times.size} frames, t = {times[0]:g} to {times[-1]:g}" if times.size else "no frames"
    lines = [
        f"cyclosis run: {run['message']}",
        f"├─ grid        {_grid(dataset, asked)}",
        *_model(asked),
        f"├─ saved       {span}",
        "├─ parameters  " + _listed(asked["parameters"]),
        "├─ run         " + _listed(asked["run"]),
        *_protocol(asked),
        f"├─ effort      {run['evaluations']} right-hand sides, "
        f"{run['accepted']} steps, {run['rejected']} rejected",
        f"├─ made        {dataset.attrs['created']} on {dataset.attrs['device']}, "
        + _listed(json.loads(dataset.attrs["versions"])),
        "└─ variables",
    ]
    names = list(dataset.data_vars)
    for name in names:
        variable = dataset[name]
        dims = ", ".join(map(str, variable.dims))
        branch = "└─" if name == names[-1] else "├─"
        lines.append(f"   {branch} {f'{name}({dims})':<32} {variable.attrs.get('long_name', '')}")
    return "\n".join(lines)


def _grid(dataset: xarray.Dataset, asked: dict[str, Any]) -> str:
    """Return the grid of a run in words."""
    sizes = dataset.sizes
    if "z" in sizes:
        return f"{sizes['theta']} x {sizes['z']}, length {dataset.attrs['length']:g}"
    return _listed(asked["grid"])


def _model(asked: dict[str, Any]) -> list[str]:
    """Return the model of a run as a branch of its tree, unless it is the polar one without settings."""
    if "model" not in asked:
        return []
    kind = {"kind": asked["model"]["kind"]}
    return [f"├─ model       {_listed(kind | asked['model'])}"]


def _protocol(asked: dict[str, Any]) -> list[str]:
    """Return the protocol of a run as branches of its tree."""
    if "protocol" not in asked:
        return []
    from ..dynamics.protocol import Protocol

    protocol = Protocol.from_tables(asked["protocol"], asked["protocol_seed"])
    first, *steps = repr(protocol).splitlines()
    return [f"├─ protocol    {first.removeprefix('Protocol: ')}", *(f"│  {step}" for step in steps)]


def _listed(values: dict[str, object]) -> str:
    shown = {name: value for name, value in values.items() if name != "terms"}
    return ", ".join(
        f"{name} = {value:g}" if isinstance(value, float) else f"{name} = {value}"
        for name, value in shown.items()
    )
