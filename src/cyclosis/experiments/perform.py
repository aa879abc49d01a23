"""Doing an experiment: measure, judge, draw, and leave dataset and figure in a folder."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

import xarray

from ..dataset import check_writable
from ..dataset.tables import write_table
from ..figures import style
from ..model.errors import InputError, whole
from .catalogue import experiment
from .experiment import Experiment, Verdict
from .lab import Lab, Told

MOST_SEEDS = 100_000
STORES = "stores"
"""Folder, beside the results, of the sweeps of all experiments."""


@dataclass(frozen=True)
class Performance:
    """What an experiment left: its dataset, its verdict, and the files it was written to.

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
) -> Performance:
    """Do an experiment and return what it left in the folder `out`: NAME.nc and NAME.png.

    `seeds` replaces the experiment's own number of seeds; `quick` takes few, and less of all else. What its
    sweeps have computed stays in `out`/stores, so that the same call goes on after an interruption.
    Raises `InputError` for an unknown name, files that stand (unless `force`), and seeds out of range.

    Example:
        >>> from cyclosis.experiments import perform
        >>> done = perform("timescales", "bench", quick=True)
        >>> done.verdict.outcome, done.file.name, done.figure.name
        ('in part', 'timescales.nc', 'timescales.png')
    """
    chosen = experiment(name)
    folder = Path(out)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        rule = "a folder that can be made"
        raise InputError("out", str(folder), rule, f"choose another ({error.strerror})") from error
    file, picture = folder / f"{name}.nc", folder / f"{name}.png"
    for target in (file, picture):
        check_writable(target, force)
    given = chosen.quick_seeds if quick else chosen.seeds
    count = given if seeds is None else whole("seeds", seeds, 1, MOST_SEEDS, f"the default is {given}")
    kind = f"{name}-{'quick' if quick else 'full'}-{count}"
    with Lab(folder / STORES / kind, count, quick, workers, told) as lab:
        data = labelled(chosen, chosen.measure(lab), count, quick)
    write_table(data, file)
    style.save(chosen.draw(data), picture)
    return Performance(chosen, data, verdict_of(data), file, picture)


def labelled(chosen: Experiment, data: xarray.Dataset, seeds: int, quick: bool) -> xarray.Dataset:
    """Return the dataset of an experiment with claim, verdict and command as attributes."""
    found = chosen.verdict(data)
    command = f"cyclosis experiment {chosen.name}" + (" --quick" if quick else "")
    if seeds != (chosen.quick_seeds if quick else chosen.seeds):
        command += f" --seeds {seeds}"
    return data.assign_attrs(
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
        rule = "that of an experiment"
        raise InputError("dataset", "this one", rule, "make one with `cyclosis experiment`") from error
