"""Run an experiment: measure, judge, draw, and write dataset and figure to a folder."""

from __future__ import annotations

import hashlib
import json
import os
from dataclasses import dataclass
from pathlib import Path

import xarray

from ..dataset import check_writable, with_scales
from ..dataset.tables import write_table
from ..dataset.whole import remove
from ..display.shown import shown
from ..figures import style
from ..model.errors import InputError, choice, whole
from ..model.reporting import counted, reported
from ..model.scales import Scales
from ..model.units import shown_in
from ..sweep.cluster.progress import SweepProgress
from .catalogue import experiment
from .experiment import Experiment, Verdict
from .lab import Lab, Told
from .stored import definition

MOST_SEEDS = 100_000
STORES = "stores"
"""Folder, next to the results, for the sweeps of all experiments."""


@shown
@dataclass(frozen=True)
class Performance:
    """The results of an experiment: its dataset, its verdict, and the files they were written to.

    Example:
        >>> from cyclosis.experiments import perform
        >>> done = perform("timescales", "other", quick=True)
        >>> done.experiment.name, done.dataset.attrs["command"]
        ('timescales', 'cyclosis experiment timescales --quick')
    """

    experiment: Experiment
    dataset: xarray.Dataset
    verdict: Verdict
    file: Path
    figure: Path


def perform(
    name: str,
    out: str | os.PathLike[str] = "experiments",
    seeds: int | None = None,
    quick: bool = False,
    workers: int | None = None,
    force: bool = False,
    told: Told | None = None,
    fresh: bool = False,
    progress: bool | None = None,
    scales: Scales | None = None,
    figure: str = "png",
) -> Performance:
    """Run an experiment, write NAME.nc and NAME.png to the folder `out`, and return the results.

    `seeds` replaces the experiment's default number of seeds; `quick` uses few, and fewer or shorter runs of
    every kind. Every member that is done is stored in `out`/stores, so that the same call continues after an
    interruption; `fresh` removes what is stored there of this experiment and computes it again. `progress`
    shows a bar in a terminal or a notebook unless it is False; the function `told` is called instead. With
    `scales` the figure is in seconds, µm and µm/s; what is computed is the same. `figure` is its format: png,
    pdf, svg or eps. Raises `InputError` for an unknown name, files that exist (unless `force`),
    and seeds out of range.

    Example:
        >>> from cyclosis.experiments import perform
        >>> done = perform("timescales", "bench", quick=True)
        >>> done.verdict.outcome, done.file.name, done.figure.name
        ('in part', 'timescales.nc', 'timescales.png')
    """
    chosen = experiment(name)
    choice("figure", figure, tuple(suffix[1:] for suffix in style.SUFFIXES))
    folder = Path(out)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        rule = "a folder that can be created"
        raise InputError("out", str(folder), rule, f"choose another ({error.strerror})") from error
    file, picture = folder / f"{name}.nc", folder / f"{name}.{figure}"
    for target in (file, picture):
        check_writable(target, force)
    given = chosen.quick_seeds if quick else chosen.seeds
    count = given if seeds is None else whole("seeds", seeds, 1, MOST_SEEDS, f"the default is {given}")
    kind = f"{name}-{'quick' if quick else 'full'}-{count}"
    if fresh:
        remove(folder / STORES / kind)
    shown = reported(progress if told is None else told, name, _told)
    with shown as report, Lab(folder / STORES / kind, count, quick, workers, report) as lab:
        data = labelled(chosen, chosen.measure(lab), count, quick)
    data = with_scales(data, scales)
    picture.unlink(missing_ok=True)  # an interruption must not leave an old figure beside new data
    write_table(data, file)
    with shown_in(scales):
        style.save(style.signed(chosen.draw(data), data), picture)
    return Performance(chosen, data, verdict_of(data), file, picture)


def _told(label: str, now: SweepProgress) -> tuple[float, str]:
    """Return the share of a part of an experiment that is done, and its name."""
    share, words = counted(now.done, now.total)
    return share, f"{label} {words}"


def labelled(chosen: Experiment, data: xarray.Dataset, seeds: int, quick: bool) -> xarray.Dataset:
    """Return the dataset of an experiment with claim, verdict and command as attributes."""
    found = chosen.verdict(data)
    command = f"cyclosis experiment {chosen.name}" + (" --quick" if quick else "")
    if seeds != (chosen.quick_seeds if quick else chosen.seeds):
        command += f" --seeds {seeds}"
    asked = {"experiment": chosen.name, "seeds": seeds, "quick": quick, "definition": definition()}
    configuration = json.dumps(asked, sort_keys=True)
    return data.assign_attrs(
        definition_sha256=definition(),
        configuration_sha256=hashlib.sha256(configuration.encode()).hexdigest(),
        experiment=chosen.name,
        claim=chosen.claim,
        claim_source=chosen.source,
        method=chosen.method,
        seeds=seeds,
        command=command,
        verdict=found.outcome,
        measured=found.measured,
    )


def verdict_of(data: xarray.Dataset) -> Verdict:
    """Return the verdict that a dataset of an experiment holds. Raises `InputError` for another dataset."""
    try:
        return Verdict(str(data.attrs["verdict"]), str(data.attrs["measured"]))
    except KeyError as error:
        rule = "one written by an experiment"
        raise InputError("dataset", "this one", rule, "make one with `cyclosis experiment`") from error
