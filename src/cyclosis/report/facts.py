"""What a run and its file say, as plain values for other programs."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..model.errors import InputError
from ..model.units import scales_in, stored
from .again import command_of, start_of

if TYPE_CHECKING:
    import xarray

    from ..dynamics.trajectory import Trajectory
    from ..model.scales import Scales


def at_the_end(run: Trajectory) -> tuple[Any, dict[str, Any]]:
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


def facts(run: Trajectory) -> dict[str, Any]:
    """Return the outcome of a run as plain values, None for what is not a number."""
    told = _judged(*at_the_end(run))
    return {
        "status": str(run.status),
        "ok": run.ok,
        "message": run.message,
        "t_final": run.t_final,
        **told,
        **in_units(told, [run.t_final], run.scales),
        "model": run.model.name,
        "frames": len(run.frames),
        "wall_time_seconds": run.effort.wall_time,
        "evaluations": run.effort.evaluations,
        "steps": run.effort.accepted,
    }


def _judged(found: Any, numbers: dict[str, Any]) -> dict[str, Any]:
    """Return a regime and its quantities as plain values."""
    zones = {name: getattr(found, name).tolist() for name in ("zones", "widths") if hasattr(found, name)}
    plain = {name: _plain(value) for name, value in numbers.items()}
    return {"regime": found.name, "reason": found.reason, **zones, **plain}


def regime_of(file: Path) -> tuple[Any, dict[str, Any]] | None:
    """Return the regime at the end of the run in a file, and its quantities; None with terms of the user."""
    from .. import dataset

    try:
        run = dataset.load(file, fields=False)
    except InputError as error:
        if error.field.startswith("terms of "):
            return None
        raise
    return at_the_end(run)


def contents(dataset: xarray.Dataset, file: Path) -> dict[str, Any]:
    """Return what is in a file of a run as plain values, None for what is not a number."""
    outcome, asked, versions = (
        json.loads(dataset.attrs[name]) for name in ("outcome", "configuration", "versions")
    )
    judged = regime_of(file)
    told = {"regime": None} if judged is None else _judged(*judged)
    scales = stored(dataset)
    times = dataset["time"].values
    kept = ("status", "status_time", "message", "t_final", "evaluations", "accepted", "rejected")
    return {
        **{name: outcome[name] for name in kept},
        **told,
        "start": start_of(asked),
        "command": command_of(asked, file, scales)[0],
        **({"scales": scales, "units": in_units(told, times, scales_in(dataset))} if scales else {}),
        "configuration": asked,
        "configuration_sha256": dataset.attrs["configuration_sha256"],
        "initial_sha256": dataset.attrs["initial_sha256"],
        "frames": int(times.size),
        "times": [float(times[0]), float(times[-1])] if times.size else [],
        "sizes": {str(name): int(size) for name, size in dataset.sizes.items()},
        "variables": [str(name) for name in dataset.data_vars],
        "created": dataset.attrs["created"],
        "device": dataset.attrs["device"],
        "versions": versions,
    }


def in_units(told: Mapping[str, Any], times: Any, scales: Scales | None) -> dict[str, Any]:
    """Return the last time and the speeds of a run in seconds and µm/s, {} without scales."""
    if scales is None:
        return {}
    speeds = [name for name in ("peak_speed", "rms_speed") if told.get(name) is not None]
    return {
        **({"t_final_s": scales.seconds(float(times[-1]))} if len(times) else {}),
        **{f"{name}_um_per_s": scales.micrometres_per_second(told[name]) for name in speeds},
    }


def _plain(value: Any) -> Any:
    """Return a number or an array as JSON has them."""
    values = np.asarray(value)
    if values.ndim:
        return [_plain(each) for each in values]
    number = values.item()
    return None if isinstance(number, float) and not math.isfinite(number) else number
