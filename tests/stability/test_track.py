"""Arclength continuation on curves that are known exactly."""

import numpy as np
import pytest

from cyclosis.stability.branches.follow import Track
from cyclosis.stability.branches.switching import other_branch
from stability.madeup import MadeUp


def followed(rate, y, value, low=0.0, high=4.0, longest=0.05, way=1):
    from dataclasses import replace

    watch, first = MadeUp(rate).begin(y, value)
    first = replace(first, tangent=way * first.tangent)
    track = Track(watch, first, low, high, longest, 500)
    points = np.array([[*node.X[:2], watch.curve.value(node.X)] for node in [first, *track.nodes]])
    return watch, track, points


def places(watch, track, what):
    return [watch.curve.value(event.node.X) for _, event in track.events if event.what == what]


def test_an_s_is_followed_through_both_folds():
    def s(y, x):
        return np.array([x - 2 - 2 * y[0] ** 3 + 1.5 * y[0], -y[1]])

    watch, track, points = followed(s, [-1.0, 0.0], 1.0 - 0.5 + 1.5 - 1.5)
    y, x = points[:, 0], points[:, 2]
    assert x == pytest.approx(2 + 2 * y**3 - 1.5 * y, abs=1e-9)
    assert x[-1] == 4.0
    assert track.end == "this is the end of the range"
    fold = 0.5  # 6 y² = 1.5
    assert places(watch, track, "fold") == pytest.approx([2 + fold, 2 - fold], abs=1e-9)
    assert len(track.events) == 2
    steps = np.sqrt(2 * np.diff(y) ** 2 / 16 + (np.diff(x) / 4) ** 2)
    assert steps.max() < 0.05 * 1.05


def test_a_ring_is_followed_once_around():
    def ring(y, x):
        return np.array([1 - (2 * (x - 2)) ** 2 - (y[0] / 0.6) ** 2, -y[1]])

    watch, track, points = followed(ring, [0.6, 0.0], 2.0)
    assert (2 * (points[:, 2] - 2)) ** 2 + (points[:, 0] / 0.6) ** 2 == pytest.approx(1, abs=1e-9)
    assert places(watch, track, "fold") == pytest.approx([2.5, 1.5], abs=1e-9)
    assert track.closed
    angle = np.unwrap(np.arctan2(points[:, 0] / 0.6, 2 * (points[:, 2] - 2)))
    assert 0.9 < abs(angle[-1] - angle[0]) / (2 * np.pi) < 1.1


def pitchfork(y, x):
    return np.array([(x - 2) * y[0] - y[0] ** 3, -y[1]])


def test_a_pitchfork_is_found_on_the_stem_and_switched_at():
    watch, track, points = followed(pitchfork, [0.0, 0.0], 1.0)
    assert not np.any(points[:, 0])
    assert places(watch, track, "branch") == pytest.approx([2.0], abs=1e-8)
    curve, node = watch.curve, track.events[0][1].node
    X = other_branch(curve, node.X, node.tangent, False, 0.1)
    assert abs(X[0]) == pytest.approx(0.1 * np.sqrt(curve.n), rel=1e-6)
    assert curve.value(X) == pytest.approx(2 + X[0] ** 2, abs=1e-9)


@pytest.mark.parametrize("side", [-1, 1])
def test_a_prong_ends_where_it_becomes_symmetric(side):
    watch, track, points = followed(pitchfork, [0.8 * side, 0.0], 2.64, way=-1)
    assert track.events[-1][1].what == "apex"
    assert places(watch, track, "apex") == pytest.approx([2.0], abs=1e-8)
    assert np.all(side * points[:, 0] > -1e-3)


def test_a_transcritical_point_is_a_branch_point_of_both():
    def cross(y, x):
        return np.array([y[0] * (x - 2 - y[0]), -y[1]])

    watch, track, _ = followed(cross, [0.0, 0.0], 1.0)
    assert places(watch, track, "branch") == pytest.approx([2.0], abs=1e-8)
    node = track.events[0][1].node
    X = other_branch(watch.curve, node.X, node.tangent, False, 0.1)
    assert abs(X[0]) > 0.1
    assert watch.curve.value(X) == pytest.approx(2 + X[0], abs=1e-9)
    watch, track, _ = followed(cross, [-0.9, 0.0], 1.1)
    assert [event.what for _, event in track.events] == ["branch"]


def test_a_hopf_point_has_its_frequency():
    def turning(y, x):
        return np.array([(x - 2) * y[0] - 3 * y[1], 3 * y[0] + (x - 2) * y[1]])

    watch, track, _ = followed(turning, [0.0, 0.0], 1.0)
    assert places(watch, track, "Hopf") == pytest.approx([2.0], abs=1e-8)
    assert len(track.events) == 1
    assert track.events[0][1].frequency == pytest.approx(3.0)


def test_a_branch_that_comes_to_nothing_says_so():
    def edge(y, x):
        return np.array([np.where(x < 2.5, x - 2 - y[0], np.nan), -y[1]])

    _, track, points = followed(edge, [-0.5, 0.0], 1.5)
    assert "Newton" in track.end
    assert 2.4 < points[-1, 2] < 2.5
