"""Whole runs reproduce fields computed earlier by an independent program (see tests/reference/README.md)."""

import hashlib

import pytest

from measure import check, reference


def test_the_files_are_those_of_the_note():
    note = (reference.FOLDER / "README.md").read_text()
    for name in reference.OWN_GRID:
        assert hashlib.sha256((reference.FOLDER / f"{name}.npz").read_bytes()).hexdigest() in note


@pytest.mark.parametrize("name", ["paper", pytest.param("general", marks=pytest.mark.slow)])
def test_on_their_own_grid(name):
    """What is left is the error of the grid."""
    check(reference.own_grid(name))


@pytest.mark.slow
@pytest.mark.parametrize("name", reference.OWN_GRID)
def test_on_twice_the_grid(name):
    """What is left is the error of the time step, which falls with its fourth power."""
    check(reference.twice_the_grid(name))
