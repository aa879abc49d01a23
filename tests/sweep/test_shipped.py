"""Functions that travel to workers: what they need on the way, and that they load in peace."""

import subprocess
import sys

from distributed.protocol import pickle

from cyclosis.sweep.cluster import running_cluster
from cyclosis.sweep.cluster.pickling import shipped
from cyclosis.sweep.cluster.task import BlockTask
from measure.sweeps import slow

SCHEDULER = """
import sys; sys.modules['cyclosis'] = sys.modules['measure'] = None
from distributed.protocol import pickle
print(pickle.dumps(pickle.loads(open('function', 'rb').read())) != b'')
"""
WORKER = """
import pickle, threading
from types import SimpleNamespace
import cyclosis.sweep.cluster.environment
report, compute = (pickle.loads(open(name, 'rb').read()) for name in ('report', 'function'))
by_dask, found = {'dask_worker': SimpleNamespace(state=SimpleNamespace(nthreads=1))}, {}
def call(which, function, *arguments, **named):
    try:
        found[which] = function(*arguments, **named).obstacle
    except Exception as error:
        found[which] = repr(error)
threads = [
    threading.Thread(target=call, args=('report', report, 'absent', 'digest'), kwargs=by_dask),
    threading.Thread(target=call, args=('block', compute, 0)),
]
for thread in threads: thread.start()
for thread in threads: thread.join()
print(found['report']); print(found['block'])
"""


def printed(code, folder):
    out = subprocess.run([sys.executable, "-c", code], cwd=folder, capture_output=True, text=True)
    assert not out.stderr
    return out.stdout.splitlines()


def test_a_scheduler_needs_nothing_but_dask(tmp_path):
    task = BlockTask(str(tmp_path), "digest", compute=slow(0.0))
    (tmp_path / "function").write_bytes(pickle.dumps(shipped(task)))
    assert printed(SCHEDULER, tmp_path) == ["True"]


def test_a_worker_that_reports_while_it_gets_its_first_block_loads_the_package_once(tmp_path):
    (tmp_path / "report").write_bytes(pickle.dumps(shipped(running_cluster.worker_report)))
    (tmp_path / "function").write_bytes(pickle.dumps(shipped(BlockTask("absent", "digest"))))
    report, block = printed(WORKER, tmp_path)
    assert report == block
    assert report.endswith("there is no sweep.json.")
