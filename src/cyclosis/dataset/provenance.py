"""The origin of a file: configuration, versions, and how the run ended, as plain attributes."""

from __future__ import annotations

import hashlib
import json
import platform
from datetime import UTC, datetime
from typing import Any

import jax
import numpy as np

from ..dynamics.trajectory import Trajectory
from ..models import polar
from ..version import __version__

SCHEMA = 1
"""Version of the layout of files; a file of any other version is refused."""


def configuration(run: Trajectory) -> dict[str, Any]:
    """Return the configuration as the tables of a configuration file (fields are named, not listed)."""
    asked: dict[str, Any] = {
        "parameters": {n: "field" if isinstance(v, np.ndarray) else v for n, v in run.params.items()},
        "grid": run.model.table_of(run.grid),
        "run": {k: v for k, v in run.settings.as_dict().items() if v is not None}
        | {"terms": [term.name for term in run.terms]},
    }
    if run.model is not polar:
        asked["model"] = {"kind": run.model.name, **run.model.options}
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
    scales = run.provenance.get("scales")
    return {
        "Conventions": "CF-1.11",
        "title": run.model.title,
        **origin(run.model.source),
        "schema": SCHEMA,
        **run.model.attributes(run.grid),
        "configuration": asked,
        "configuration_sha256": hashlib.sha256(asked.encode()).hexdigest(),
        "initial_sha256": run.provenance.get("initial_sha256", ""),
        **({} if scales is None else {"scales": json.dumps(scales, sort_keys=True)}),
        "outcome": json.dumps(outcome(run), sort_keys=True),
        "wall_time_seconds": run.effort.wall_time,
        "precision": run.settings.precision,
        "device": jax.devices()[0].device_kind,
    }


def origin(source: str = polar.source) -> dict[str, str]:
    """Return the attributes that say which program made a file, with which versions, and when."""
    versions = {
        "cyclosis": __version__,
        "jax": jax.__version__,
        "numpy": np.__version__,
        "python": platform.python_version(),
    }
    return {
        "source": source,
        "program": "cyclosis",
        "created": datetime.now(UTC).isoformat(timespec="seconds"),
        "versions": json.dumps(versions),
    }
