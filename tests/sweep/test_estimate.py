"""What a sweep is said to cost, on a made-up machine whose clock runs as the test says."""

import math

import jax
import numpy as np
import pytest

from cyclosis.report import sweep as report
from cyclosis.sweep.cluster import estimate
from sweep import fakes


class Machine:
    """Computes nothing: a member takes `each(number)` seconds, a point `once`, what is new `compiling`."""

    def __init__(self, each=lambda number: 0.1, once=0.0, compiling=0.0, start=0.0):
        self.each, self.once, self.compiling, self.start = each, once, compiling, start
        self.now, self.programs, self.seen = 0.0, 0, []

    def clock(self):
        return self.now

    def computed(self, sweep, numbers):
        self.seen.append(list(numbers))
        points = [number // len(sweep.seeds) for number in numbers]
        seconds = [
            self.each(number) + self.once * (place == 0 or points[place] != points[place - 1])
            for place, number in enumerate(numbers)
        ]
        if self.programs == 0:
            self.programs += 1
            seconds[0] += self.compiling
        self.now += sum(seconds)
        arrays = {name: value[: len(numbers)] for name, value in fakes.arrays(sweep, 0).items()}
        return arrays | {"seconds": np.array(seconds)}

    def started(self, sweep, number, clock):
        return self.start + self.once + self.each(number)


@pytest.fixture
def cost(monkeypatch):
    """Return the estimate of a sweep on a machine."""

    def found(machine, sweep, workers=2, lanes=1, **how):
        monkeypatch.setattr(estimate, "computed", machine.computed)
        monkeypatch.setattr(estimate, "compilations", lambda: machine.programs)
        monkeypatch.setattr(estimate, "started", machine.started)
        monkeypatch.setattr(estimate, "default_lanes", lambda grid, precision: lanes)
        return estimate.estimate(sweep, workers, clock=machine.clock, **how)

    return found


def points(count, seeds=1, block=10):
    values = np.linspace(0.1, 1.0, count).tolist()
    return fakes.sweep(axes={"alpha_p": {"values": values}}, ensemble={"seeds": seeds, "block": block})


@pytest.fixture(autouse=True)
def one_axis(monkeypatch):
    monkeypatch.setitem(fakes.TABLES, "axes", {})


def test_compiling_and_starting_are_not_taken_for_the_cost_of_members(cost):
    machine = Machine(each=lambda number: 0.25, compiling=30.0, start=10.0)
    said = cost(machine, points(20, block=2))
    assert said.core_seconds == pytest.approx(20 * 0.25)
    assert (said.compiling, said.start) == pytest.approx((30.0, 10.0))
    # Ten blocks of two for two workers, after their start, which does not compile.
    assert said.seconds == pytest.approx(10.0 + 5 * 2 * 0.25)
    assert said.range == pytest.approx((said.seconds, said.seconds))
    assert (said.members, said.points) == (20, 20)


def test_what_a_point_costs_once_is_shared_by_its_seeds(cost):
    said = cost(Machine(once=2.0), points(6, seeds=10))
    assert said.core_seconds == pytest.approx(6 * (2.0 + 10 * 0.1))
    # In blocks of four a point of ten seeds has its steady states found three times, or four.
    said = cost(Machine(once=2.0), points(6, seeds=10, block=4))
    assert said.core_seconds == pytest.approx(18 * 2.0 + 60 * 0.1)


@pytest.mark.parametrize("seeds", [1, 3, 4, 10])
@pytest.mark.parametrize("block", [1, 2, 4, 5, 12, 40, 100])
def test_points_are_counted_in_every_block_that_holds_of_them(seeds, block):
    planned = points(8, seeds, block)
    blocks = [planned.block(index).members for index in range(planned.blocks)]
    held = sum(len({number // seeds for number in members}) for members in blocks)
    assert estimate._pieces(planned) == held


@pytest.mark.parametrize(
    ("members", "block", "workers"), [(20, 2, 2), (21, 2, 2), (21, 4, 3), (5, 10, 4), (9, 2, 4)]
)
def test_the_busiest_worker_is_that_of_blocks_dealt_in_turn(members, block, workers):
    planned = points(members, block=block)
    sizes = [len(planned.block(index).members) for index in range(planned.blocks)]
    assert estimate._busiest(planned, workers) == max(sum(sizes[k::workers]) for k in range(workers))


def test_points_are_sampled_until_their_mean_is_known(cost):
    even = cost(Machine(), points(1000))
    assert even.points == estimate.ENOUGH
    assert even.low == pytest.approx(even.high)
    # One in ten takes fifty times as long: the budget goes by, and the range holds the truth.
    machine = Machine(each=lambda number: 5.0 if number % 10 == 3 else 0.1)
    said = cost(machine, points(1000))
    assert said.points > estimate.ENOUGH
    assert said.low < 1000 * 0.59 < said.high
    assert machine.now > estimate.BUDGET_SECONDS


def test_the_sample_covers_the_axes_and_is_the_same_again(cost):
    machines = [Machine(each=lambda number: 0.1 + 0.01 * (number % 7)) for _ in range(2)]
    said = [cost(machine, points(400, seeds=3)) for machine in machines]
    assert said[0].core_seconds == said[1].core_seconds
    assert machines[0].seen == machines[1].seen
    places = sorted(numbers[0] // 3 for numbers in machines[0].seen)
    assert max(np.diff([0, *places, 400])) < 4 * 400 / len(places)
    assert len({number % 3 for numbers in machines[0].seen for number in numbers}) == 3


def test_one_costly_point_says_nothing_of_the_others(cost):
    said = cost(Machine(each=lambda number: 500.0), points(30))
    assert (said.points, math.isnan(said.high)) == (1, True)
    assert said.core_seconds == pytest.approx(30 * 500.0)
    assert "perhaps" in report.plan(points(30), said)
    assert "judged by one point" in report.plan(points(30), said)


def test_where_members_run_side_by_side_whole_blocks_are_sampled(cost):
    machine = Machine()
    said = cost(machine, points(40, seeds=2, block=16), lanes=64)
    assert {len(numbers) for numbers in machine.seen} == {16}
    assert said.core_seconds == pytest.approx(80 * 0.1)


def test_a_plan_tells_the_range_and_what_is_no_computing(cost):
    planned = points(1000)
    machine = Machine(each=lambda number: 5.0 if number % 10 == 3 else 0.1, compiling=7.0, start=4.0)
    text = report.plan(planned, cost(machine, planned))
    assert "4 s until a worker computes, 7 s more on a machine that has no compiled programs yet" in text
    assert " to " in next(line for line in text.splitlines() if line.strip().startswith("time"))
    assert "1000 points" not in text


def test_a_program_that_is_compiled_is_counted_once():
    before = estimate.compilations()
    program = jax.jit(lambda x: 3.0 * x + 17.25)
    program(1.0)
    after = estimate.compilations()
    assert after > before
    program(2.0)
    assert estimate.compilations() == after
