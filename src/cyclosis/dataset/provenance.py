"""Where a file came from: configuration, versions, and how the run ended, as plain attributes."""

from __future__ import annotations

import hashlib
import json
import platform
from datetime import UTC, datetime
from typing import Any

import jax
import numpy as np

from ..dynamics.trajectory import Trajectory
from ..version import __version__

SCHEMA = 1
"""Version of the files' layout; a file of another version is refused, never guessed at."""


def configuration(run: Trajectory) -> dict[str, Any]:
    """Return what was asked for, as the tables of a configuration file (fields are named, not listed)."""
    asked: dict[str, Any] = {
        "parameters": {n: "field" if isinstance(v, np.ndarray) else v for n, v in run.params.items()},
        "grid": {"n_theta": run.grid.n_theta, "n_z": run.grid.n_z, "length": run.grid.length},
        "run": {k: v for k, v in run.settings.as_dict().items() if v is not None}
        | {"terms": [term.name for term in run.terms]},
    }
    given = run.provenance.get("initial")
    if given is not None:
        asked["initial"] = given
    if run.protocol:
        asked |= {"protocol": run.protocol.as_tables(), "protocol_seed": run.protocol.seed}
    return asked


def outcome(run: Trajectory) -> dict[str, Any]:
    """Return how the run ended."""
    done = {"protocol_events_done": run.restart.done} if run.protocol else {}
    return done | {
        "status": str(run.status),
        "status_time": run.status_time,
        "message": run.message,
        "t_final": run.t_final,
        "evaluations": run.effort.evaluations,
        "accepted": run.effort.accepted,
        "rejected": run.effort.rejected,
        "sign": run.restart.sign,
        "sign_time": run.restart.sign_time,
    }


def attributes(run: Trajectory) -> dict[str, Any]:
    """Return the global attributes of a dataset of this run."""
    asked = json.dumps(configuration(run), sort_keys=True)
    return {
        "Conventions": "CF-1.11",
        "title": "Self-organised cytoplasmic streaming on a cylinder",
        **origin(),
        "schema": SCHEMA,
        "length": run.grid.length,
        "configuration": asked,
        "configuration_sha256": hashlib.sha256(asked.encode()).hexdigest(),
        "initial_sha256": run.provenance.get("initial_sha256", ""),
        "outcome": json.dumps(outcome(run), sort_keys=True),
        "wall_time_seconds": run.effort.wall_time,
        "precision": run.settings.precision,
        "device": jax.devices()[0].device_kind,
    }


def origin() -> dict[str, str]:
    """Return the attributes that say which program made a file, of which versions, and when."""
    versions = {
        "cyclosis": __version__,
        "jax": jax.__version__,
        "numpy": np.__version__,
        "python": platform.python_version(),
    }
    return {
        "source": "Model of Woodhouse & Goldstein, PNAS 110 (2013), doi 10.1073/pnas.1302736110",
        "program": "cyclosis",
        "created": datetime.now(UTC).isoformat(timespec="seconds"),
        "versions": json.dumps(versions),
    }
