"""Input paths: the store of a sweep given instead of a file of a run, or the reverse, is reported as such."""

from __future__ import annotations

import shlex
from pathlib import Path

from ..model.errors import InputError

RUN, STORE, EXPORT, TABLE, FOLDER, OTHER = "run", "store", "export", "table", "folder", "other"
_MEANT = {
    RUN: "a file of a run",
    STORE: "the store of a sweep",
    EXPORT: "an export of a sweep",
    TABLE: "a file of numbers of the theory or of an experiment",
    FOLDER: "a folder",
}


def named(path: Path) -> Path:
    """Return a path that ends in a name, so that something can be put next to it.

    Raises `InputError` for a path that cannot be accessed.
    """
    try:
        path.stat()
    except (FileNotFoundError, NotADirectoryError):
        pass  # perhaps an unfinished run; if not, reading it fails
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise InputError("file", str(path), "a place that can be read", f"check it ({reason})") from error
    return path if path.name else path.resolve()


def of_run(path: Path) -> Path:
    """Return the path of a file of a run. Raises `InputError` for anything known to be something else."""
    remedies = {
        STORE: "try `cyclosis sweep status {0}` or `cyclosis figure phase-diagram {0}`",
        EXPORT: "try `cyclosis figure phase-diagram {0}`",
        FOLDER: "give a file in it",
    }
    return _checked("file", path, (RUN, OTHER), "a NetCDF file of a run", remedies)


def of_store(path: Path) -> Path:
    """Return the path of a sweep's store. Raises `InputError` for anything known to be something else."""
    rule = "the folder that `cyclosis sweep run` has filled"
    return _checked("store", path, (STORE, FOLDER, OTHER), rule, _NOT_A_SWEEP)


def of_sweep(path: Path) -> Path:
    """Return the path of a sweep's store or of an export. Raises `InputError` for something else."""
    rule = "the store of a sweep or an export of it (.nc, .zarr)"
    return _checked("store", path, (STORE, EXPORT, OTHER), rule, _NOT_A_SWEEP)


_NOT_A_SWEEP = {
    RUN: "try `cyclosis info {0}` or `cyclosis figure history {0}`",
    EXPORT: "give the store that it came from, or try `cyclosis figure phase-diagram {0}`",
    FOLDER: "check the path: there is no sweep.json in it",
}


def _checked(field: str, path: Path, right: tuple[str, ...], rule: str, remedies: dict[str, str]) -> Path:
    """Return a path if it holds the right kind of thing. Raises `InputError` with the remedy otherwise."""
    path = named(path)
    found = kind(path)
    if found in right:
        return path
    remedy = remedies.get(found, "open it with xarray").format(shlex.quote(str(path)))
    raise InputError(field, str(path), f"{rule}, but it is {_MEANT[found]}", remedy)


def kind(path: Path) -> str:
    """Return what is at a path, one of the names above: `OTHER` also for anything unreadable."""
    try:
        if path.is_dir():
            if (path / "sweep.json").exists():
                return STORE
            return EXPORT if any((path / name).exists() for name in (".zgroup", "zarr.json")) else FOLDER
        if not path.is_file():
            return OTHER  # perhaps an unfinished run
        import h5py

        with h5py.File(path, "r") as file:
            names, own = set(file.attrs), str(file.attrs.get("program", "")).startswith("cyclosis")
            if "outcome" in names:
                return RUN
            if "digest" in names and "members_computed" in names:
                return EXPORT
            return TABLE if own else OTHER
    except (OSError, KeyError, ValueError, RuntimeError):
        return OTHER
