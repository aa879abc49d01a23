"""Runs and their files in a few lines of text."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..model.units import scales_in, scales_text, speed_unit, stored, time_unit
from .again import command_of, start_of
from .facts import at_the_end, regime_of
from .lines import aligned

if TYPE_CHECKING:
    import xarray

    from ..dynamics.trajectory import Trajectory
    from ..model.scales import Scales


def summary(run: Trajectory) -> str:
    """Return the outcome of a run: status, regime, zones, widths, speed and time."""
    found, numbers = at_the_end(run)
    effort = run.effort
    lines = {
        "status": run.message,
        "regime": str(found),
        **found.details,
        "order": f"{numbers['order']:.4f}",
        "peak speed": _speed(numbers["peak_speed"], run.scales),
        "wall time": f"{effort.wall_time:.1f} s",
        "effort": f"{effort.evaluations} right-hand sides in {effort.accepted} steps",
    }
    if run.scales is not None:
        lines["time"] = f"{time_unit(run.scales, run.t_final)(run.t_final)} in {scales_text(run.scales)}"
    if run.protocol:
        lines["protocol"] = _steps_done(run)
    return aligned(lines)


def _steps_done(run: Trajectory) -> str:
    steps = len(run.protocol)
    waiting = sum(step.at > run.t_final for step in run.protocol)
    text = f"{steps} step{'s' if steps > 1 else ''}"
    return f"{text}, {waiting} of them after t = {run.t_final:g} and not reached" if waiting else text


def tree(dataset: xarray.Dataset, file: Path) -> str:
    """Return what is in a file of a run as a short tree."""
    run = json.loads(dataset.attrs["outcome"])
    asked = json.loads(dataset.attrs["configuration"])
    times = dataset["time"].values
    span = f"{times.size} frames, t = {times[0]:g} to {times[-1]:g}" if times.size else "no frames"
    scales = scales_in(dataset)
    if scales is not None and times.size:
        unit = time_unit(scales, times[-1])
        span += f" ({unit.factor * times[0]:.4g} to {unit(times[-1])})"
    again = command_of(asked, file, stored(dataset))
    lines = [
        f"cyclosis run: {run['message']}",
        *_regime(file, scales),
        f"├─ grid        {_grid(dataset, asked)}",
        *_model(asked),
        f"├─ saved       {span}",
        "├─ parameters  " + _listed(asked["parameters"]),
        "├─ run         " + _listed(asked["run"]),
        f"├─ initial     {_listed(start_of(asked)) or 'given in Python'}",
        *([] if scales is None else [f"├─ units       {scales_text(scales)}"]),
        *_protocol(asked),
        f"├─ effort      {run['evaluations']} right-hand sides, "
        f"{run['accepted']} steps, {run['rejected']} rejected",
        f"├─ made        {dataset.attrs['created']} on {dataset.attrs['device']}, "
        + _listed(json.loads(dataset.attrs["versions"])),
        f"├─ again       {''.join(filter(None, again))}",
        "└─ variables",
    ]
    names = list(dataset.data_vars)
    for name in names:
        variable = dataset[name]
        dims = ", ".join(map(str, variable.dims))
        branch = "└─" if name == names[-1] else "├─"
        lines.append(f"   {branch} {f'{name}({dims})':<32} {variable.attrs.get('long_name', '')}")
    return "\n".join(lines)


def _speed(speed: float, scales: Scales | None) -> str:
    """Return a speed in words."""
    units = "" if scales is None else f" = {speed_unit(scales)(speed)}"
    return f"{speed:.4f} U{units}"


def _regime(file: Path, scales: Scales | None) -> list[str]:
    """Return the regime at the end of a run as branches of its tree."""
    judged = regime_of(file)
    if judged is None:
        return ["├─ regime      not known without the terms that were given in Python"]
    found, numbers = judged
    speed = f"order {numbers['order']:.4f}, peak speed {_speed(numbers['peak_speed'], scales)}"
    details = [f"│  {name:<18} {text}" for name, text in found.details.items()]
    return [f"├─ regime      {found}", *details, f"├─ final       {speed}"]


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
