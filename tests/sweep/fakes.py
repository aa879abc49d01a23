"""Small sweeps and made-up results, so that stores can be tested without computing."""

import numpy as np

import cyclosis as cy
from cyclosis.analysis.regimes import REGIMES
from cyclosis.ensemble import OUTCOMES, Outcome
from cyclosis.sweep.plan.sweep import Sweep

TABLES = {
    "grid": {"n_theta": 8, "n_z": 8, "length": 5.0},
    "axes": {"alpha_p": {"values": [0.1, 0.5, 1.0]}, "kappa": {"start": 0.0, "stop": 0.5, "count": 2}},
    "ensemble": {"seeds": 4, "first_seed": 7, "block": 5},
    "record": {"quantities": ["mean_P", "rms_speed", "budget"]},
}


def tables(**changes):
    """Return the tables of a small sweep of 24 members in 5 blocks, with tables updated."""
    return {name: TABLES.get(name, {}) | changes.get(name, {}) for name in TABLES | changes}


def sweep(**changes):
    return Sweep.from_tables(tables(**changes))


def arrays(planned, index):
    """Return made-up results of a block, different for every member and variable but always the same."""
    members = planned.block(index).members
    out = {}
    for place, item in enumerate(planned.variables):
        shape = (len(members), *(planned.sizes[dim] for dim in item.dims))
        values = np.random.default_rng([place, *members]).normal(size=shape)
        if item.codes:
            values = np.arange(members.start, members.stop) % (7 if item.name == "regime" else 4)
        elif item.dtype.startswith("int"):
            values = np.arange(members.start, members.stop) * 2
        elif "zone" in item.dims:
            values[:, 3:] = np.nan
        out[item.name] = values.astype(item.dtype)
    return out


def follow(members, how=None):
    """Stand in for `cyclosis.ensemble.follow`: two stripes whose amplitude and angle follow the seed."""
    out = []
    for member in members:
        start = member.state()
        shift = float(start[1, 0, 0]) * 5
        state = np.zeros((2, *member.grid.shape))
        state[1] = 0.5 * member.params.alpha_p * np.cos(member.grid.theta + shift)[:, None]
        disordered = member.params.alpha_p < 0.2
        out.append(
            Outcome(
                regime=REGIMES[0 if disordered else 2],
                status=OUTCOMES[0],
                reason="made up",
                t_final=10.0 + shift,
                t_order=np.nan if disordered else 5.0,
                state=state,
                eigenvalue=-0.1,
                tail=0.0,
                evaluations=100,
                seconds=0.01,
            )
        )
    return out


def same(a, b):
    """Assert that two blocks are equal bit for bit."""
    assert a.keys() == b.keys()
    for name, values in a.items():
        assert values.dtype == b[name].dtype, name
        assert np.array_equal(values, b[name], equal_nan=values.dtype.kind == "f"), name


def filled(store, *without):
    """Fill a store with made-up results, and return it."""
    for index in range(store.sweep.blocks):
        if index not in without:
            store.write(index, arrays(store.sweep, index))
    return store


GRID = cy.CylinderGrid(8, 8, 5.0)
