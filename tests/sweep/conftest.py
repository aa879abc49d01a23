"""One cluster for all sweeps that leave their workers alive."""

import pytest

from cyclosis.sweep.cluster.local_cluster import local_client


@pytest.fixture(scope="session")
def client():
    with local_client(2) as client:
        client.wait_for_workers(2)
        yield client
