"""The names of the package: all load, an unknown one is told, and two threads may ask for them at once."""

import subprocess
import sys

import pytest

import cyclosis

TWO_AT_ONCE = """
import threading, cyclosis
found = {}
def ask(name):
    try:
        found[name] = getattr(cyclosis, name).__name__
    except ImportError as error:
        found[name] = error
threads = [threading.Thread(target=ask, args=(name,)) for name in ('run_sweep', 'Sweep')]
for thread in threads: thread.start()
for thread in threads: thread.join()
print(found['run_sweep'], found['Sweep'])
"""


def test_every_name_loads():
    assert all(getattr(cyclosis, name) is not None for name in cyclosis.__all__)
    assert set(dir(cyclosis)) == set(cyclosis.__all__)


def test_an_unknown_name_is_told():
    with pytest.raises(AttributeError, match="module 'cyclosis' has no attribute 'unheard_of'"):
        cyclosis.unheard_of  # noqa: B018


def test_two_threads_may_load_names_at_once():
    out = subprocess.run([sys.executable, "-c", TWO_AT_ONCE], capture_output=True, text=True)
    assert out.stdout == "run_sweep Sweep\n", out.stdout + out.stderr
