"""Programs cut at their Fourier transforms: the same numbers, each transform alone, no field too many."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from cyclosis.model import transforms_apart as apart
from cyclosis.model.precision import double
from cyclosis.model.room import Room
from cyclosis.model.transforms_apart import transforms_apart

RNG = np.random.default_rng(0)
A, B = RNG.normal(size=(2, 6, 4)) + 1j * RNG.normal(size=(2, 6, 4))
R = RNG.normal(size=(6, 4))
TABLE = RNG.normal(size=(6, 4))


def to(a):
    return jnp.fft.fft2(a)


def back(a):
    return jnp.fft.ifft2(a)


def shared(a, b, r):
    both = jnp.exp(1j * r) * a
    sums = to(both) + to(a)
    return back(sums * both) + sums, jnp.abs(both) + sums.real


def chosen(a, b, r):
    """Branches with transforms, one inside the other, of which one hands on what it gets."""

    def inner(x):
        return jax.lax.cond(x[0, 0].real > 0, lambda: to(x) * b, lambda: x)

    found, same = jax.lax.cond(jnp.sum(r) > 0, lambda x: (to(inner(x)), x), lambda x: (x, back(x) - r), a + b)
    return to(found) + a, same


FUNCTIONS = {
    "one transform": lambda a, b, r: to(a),
    "no transform": lambda a, b, r: a * b + r,
    "of what is computed": lambda a, b, r: to(a * b + 2.0) * r,
    "one after the other": lambda a, b, r: back(to(back(a) * r) + b) - b,
    "side by side": lambda a, b, r: to(a) * to(b) + to(r.astype(complex)),
    "of a transform": lambda a, b, r: to(to(to(a))),
    "shared values": shared,
    "one of many": lambda a, b, r: back(jnp.stack([a, b, a * b]))[1] + a,
    "real ones": lambda a, b, r: jnp.fft.irfft2(jnp.fft.rfft2(r) * 2.0, r.shape) + a,
    "constants": lambda a, b, r: to(jnp.asarray(TABLE) * a) + TABLE + to(jnp.asarray(TABLE + 0j)),
    "numbers": lambda a, b, r: (to(a) * 3 + 1j, 2.5, jnp.float32(1.5), jnp.sum(to(b)).real),
    "nested programs": lambda a, b, r: jax.jit(lambda x, y: (to(jax.jit(to)(x) * y), y))(
        a, jax.jit(jnp.abs)(b)
    ),
    "branches": chosen,
    "the other branch": lambda a, b, r: chosen(a, b, jnp.abs(r)),
    "the inner branches": lambda a, b, r: [chosen(s * a - b, b, jnp.abs(r)) for s in (1e3, -1e3)],
    "several choices": lambda a, b, r: [
        jax.lax.switch(k, [lambda x: to(x), lambda x: x * 2.0, lambda x: back(x)], a)
        for k in (-3, 0, 1, 2, 7)
    ],
    "a loop": lambda a, b, r: to(jax.lax.fori_loop(0, 3, lambda _, x: to(x) / 5.0 + b, a)),
    "arguments as results": lambda a, b, r: (a, to(b), r, r),
    "a result twice": lambda a, b, r: (lambda x: (x, x, x * 1.0))(to(a)),
    "unused": lambda a, b, r: (to(a), to(b), jnp.exp(r))[0],
    "other rules of derivatives": lambda a, b, r: to(jax.nn.relu(r) * jnp.where(r > 0, 1.0, 2.0) + a),
    "several types": lambda a, b, r: (to(a.astype(np.complex64)), to(a), jnp.sum(r > 0), r > 0),
}


def in_pieces(function):
    return transforms_apart(lambda a, b, r, fixed: function(a, b, r))


@pytest.fixture(autouse=True)
def in_double():
    with double():
        yield


@pytest.fixture
def counted(monkeypatch):
    """The transforms that run by themselves."""
    seen, run = [], apart._transform
    monkeypatch.setattr(apart, "_transform", lambda *how: seen.append(how[2:]) or run(*how))
    return seen


def same(found, expected):
    assert jax.tree.structure(found) == jax.tree.structure(expected)
    for one, other in zip(*map(jax.tree.leaves, (found, expected)), strict=True):
        assert np.asarray(one).dtype == jnp.asarray(other).dtype
        np.testing.assert_allclose(one, other, rtol=1e-13, atol=1e-13)


@pytest.mark.parametrize("name", FUNCTIONS)
def test_the_numbers_are_the_same(name):
    """On the second call results take over the memory of the first; neither arguments nor results suffer."""
    function, room = FUNCTIONS[name], Room()
    cut = in_pieces(function)
    given = [tuple(map(jnp.asarray, arguments)) for arguments in ((A, B, R), (B, A, 2.0 * R))]
    found = [cut(room, *arguments, None) for arguments in (*given, *given)]
    for one, arguments in zip(found, (*given, *given), strict=True):
        same(one, jax.jit(function)(*arguments))
    same(given, [(A, B, R), (B, A, 2.0 * R)])


@pytest.mark.parametrize(
    ("name", "expected"),
    {
        "no transform": 0,
        "of what is computed": 1,
        "side by side": 3,
        "of a transform": 3,
        "shared values": 3,
        "nested programs": 2,
        "real ones": 2,
        "branches": 2,
        "several choices": 4,
        "unused": 1,
    }.items(),
)
def test_transforms_that_are_needed_run_by_themselves(name, expected, counted):
    """Those of the branch that is taken, and none of which no result follows."""
    function = FUNCTIONS[name]
    in_pieces(function)(Room(), A, B, -np.abs(R), None)
    assert len(counted) == expected


def test_no_other_program_has_a_transform(monkeypatch):
    """The compiled pieces between them have none."""
    seen, compiled = [], apart._compiled
    monkeypatch.setattr(apart, "_compiled", lambda each, gives: seen.extend(each) or compiled(each, gives))
    for name in ("shared values", "nested programs", "branches", "one of many"):
        in_pieces(FUNCTIONS[name])(Room(), A, B, R, None)
    assert seen
    assert not any("fft" in str(each.equation) for each in seen)


def test_what_is_compiled_in_and_shapes_have_programs_of_their_own():
    traced = []

    def power(a, n):
        traced.append((a.shape, n))
        return to(a) ** n

    cut, room = transforms_apart(power), Room()
    for _ in range(3):
        same(cut(room, A, 2), np.fft.fft2(A) ** 2)
        same(cut(room, A, 3), np.fft.fft2(A) ** 3)
        same(cut(room, A[:4], 2), np.fft.fft2(A[:4]) ** 2)
    assert traced == [((6, 4), 2), ((6, 4), 3), ((4, 4), 2)]


def test_further_calls_compile_nothing(monkeypatch):
    compiled = []
    cut, room = in_pieces(FUNCTIONS["branches"]), Room()
    for sign in (1, -1):
        cut(room, A, B, sign * np.abs(R), None)
    listen = jax.monitoring.register_event_duration_secs_listener
    listen(lambda event, seconds, **_: compiled.append(event) if "compile" in event else None)
    for sign in (1, -1, 1):
        jax.block_until_ready(cut(room, B, A, sign * np.abs(R), None))
    jax.monitoring.clear_event_listeners()
    assert compiled == []


def fields(room):
    """Return how many arrays a room keeps."""
    return sum(map(len, room._free.values()))


def test_fields_are_dropped_as_soon_as_they_are_not_needed():
    """A chain of transforms has two fields at a time, however long it is; later calls make no more."""

    def chain(a, n):
        for _ in range(n):
            a = to(a * 0.2) + 1.0
        return jnp.sum(a)

    cut, room = transforms_apart(chain), Room()
    a = jnp.asarray(A)
    for _ in range(3):
        cut(room, a, 20).block_until_ready()
        assert fields(room) == 2


@pytest.mark.parametrize("name", FUNCTIONS)
def test_no_array_is_left_behind(name):
    """Besides its results a call leaves as many arrays as the one before."""
    cut, room = in_pieces(FUNCTIONS[name]), Room()
    a, b, r = map(jnp.asarray, (A, B, R))
    left = []
    for _ in range(4):
        cut(room, a, b, r, None)
        left.append(len(jax.live_arrays()))
    assert left[1] == left[2] == left[3]


def test_results_take_over_the_memory_of_what_is_given_up():
    cut, room = in_pieces(lambda a, b, r: to(a) * b), Room()
    a, b = jnp.asarray(A), jnp.asarray(B)
    first = cut(room, a, b, R, None)
    kept = fields(room)
    second = cut(room, first, b, R, None, given_up=first)
    assert fields(room) == kept + 1
    assert not first.is_deleted()
    third = cut(room, a, b, R, None)
    assert first.is_deleted()
    assert fields(room) == kept
    same((second, third), (np.fft.fft2(np.fft.fft2(A) * B) * B, np.fft.fft2(A) * B))


def test_a_result_that_is_given_up_is_kept():
    cut, room = in_pieces(lambda a, b, r: (a, to(a))), Room()
    first = cut(room, jnp.asarray(A), B, R, None)[1]
    handed, _ = cut(room, first, B, R, None, given_up=(first,))
    for _ in range(3):
        cut(room, jnp.asarray(B), B, R, None)
    same(handed, np.fft.fft2(A))


def test_a_program_that_prints_runs_as_a_whole(counted):
    said = []

    def telling(a, fixed):
        jax.debug.callback(lambda x: said.append(float(x)), jnp.sum(jnp.abs(a)))
        return to(a)

    cut = transforms_apart(telling)
    for _ in range(2):
        same(cut(Room(), A, None), np.fft.fft2(A))
    jax.effects_barrier()
    assert said == pytest.approx([np.abs(A).sum()] * 2)
    assert counted == []
