"""The flow inside the cell: true, bounded, only for those who ask, and without effect on the cell."""

import json
import struct
import time

import numpy as np
import pytest
from fastapi.testclient import TestClient

import cyclosis as cy
from cyclosis.explorer import inside
from cyclosis.explorer.server import ServerLimits, application
from cyclosis.vacuole.live import Interior, scattered

HOST = "http://localhost:8765"
SETUP = {"grid": {"n_theta": 16, "n_z": 16}, "parameters": {"d_s": 0.2}}
GRIDS = [(8, 1, 5.0), (9, 15, 1e-2), (33, 16, 1e4), (128, 128, 5.0)]
"""The smallest, odd, long and short ones, and the largest that the explorer takes."""


def winding(grid):
    """The wall's velocity of two bands that wind: nothing in the vacuole is at rest or straight."""
    phase = grid.theta[:, None] - 2 * np.pi * grid.z / grid.length
    return np.sin(phase) * np.array([0.78, 0.62])[:, None, None]


def emerging(grid):
    """The flow of a state without any symmetry, with waves as short as the grid has."""
    return np.asarray(cy.flow(cy.Parameters(), grid, cy.initial.disordered(grid, seed=0)))


def polar(xyz):
    """Return (r, θ, z) of places, shape (n, 3)."""
    return np.stack([np.hypot(*xyz[:2]), np.arctan2(xyz[1], xyz[0]), xyz[2]], axis=1)


def read(data):
    """Return the header of a message, the places (3, n), and the axial velocity there and on the section."""
    size, kind = struct.unpack("<II", data[:8])
    assert kind == inside.KIND
    header = json.loads(data[8 : 8 + size])
    values = np.frombuffer(data, "<f4", offset=8 + -(-size // 8) * 8).astype(float)
    n = header["tracers"]
    assert values.size == 4 * n + header["rings"] * header["sectors"]
    return header, values[: 3 * n].reshape(3, n), values[3 * n : 4 * n], values[4 * n :]


def seen(grid, u, playing=True):
    return inside.Seen(u, grid, 0.0, 1, playing)


@pytest.mark.parametrize(("wall", "bound"), [(winding, 1e-3), (emerging, 0.03)])
def test_the_velocity_is_that_of_the_exact_flow(wall, bound):
    grid = cy.CylinderGrid(32, 32)
    flow = cy.vacuole.flow(grid, wall(grid))
    xyz = scattered(300, grid.length)
    off = Interior(flow).at(xyz) - flow.cartesian_at(polar(xyz)).T
    assert np.abs(off).max() < bound * np.hypot(*flow.surface).max()


def test_tracers_keep_to_the_surfaces_of_a_stream_function():
    """Where bands wind, the flow circulates, and the stream function is constant along every path."""
    grid = cy.CylinderGrid(16, 16, length=2.8)
    flow = cy.vacuole.flow(grid, cy.vacuole.helical_bands(grid, np.sin, pitch=2.8))
    psi, interior = cy.vacuole.stream_function(flow), Interior(flow)
    at = polar(xyz := scattered(100, grid.length))
    for _ in range(150):
        xyz = interior.carried(xyz, 0.14, 1.0)
    found = polar(xyz)
    assert np.abs(psi.at(found) - psi.at(at)).max() < 5e-3 * np.abs(psi.at(at)).max()
    assert np.abs(found[:, 0] - at[:, 0]).max() > 0.3


@pytest.mark.parametrize("shape", GRIDS, ids=str)
def test_tracers_never_leave_the_cell_on_any_grid(shape):
    grid = cy.CylinderGrid(*shape)
    rng = np.random.default_rng(1)
    tracers = inside.Tracers(grid, 1000, 2.0)
    for _ in range(3 if grid.n_theta == 128 else 8):
        # With a divergence, tracers come to the wall and are pressed along it.
        u = cy.flow(cy.Parameters(), grid, rng.standard_normal((2, *grid.shape)))
        header, xyz, axial, section = read(tracers.message(seen(grid, np.asarray(u)), 0.5))
        assert np.isfinite(np.concatenate([axial, section])).all()
        assert np.hypot(*xyz[:2]).max() <= 1 + 1e-6
        assert np.hypot(*tracers.xyz[:2]).max() <= 1
        assert tracers.xyz[2].min() >= 0
        assert tracers.xyz[2].max() < grid.length
    assert header["length"] == grid.length


def test_a_message_says_how_fast_the_fluid_moves_along_the_cell():
    """Straight streams u_z = sin θ drive v_z = r sin θ, and tracers keep their places in the section."""
    grid = cy.CylinderGrid(32, 8)
    u = np.stack([np.zeros(grid.shape), np.sin(grid.theta)[:, None] * np.ones(grid.n_z)])
    tracers = inside.Tracers(grid, 200, 0.6)
    before = tracers.xyz.copy()
    header, xyz, axial, section = read(tracers.message(seen(grid, u), 0.1))
    assert header["reference"] == pytest.approx(1.0)
    assert axial == pytest.approx(xyz[1], abs=1e-4)
    r = np.linspace(0, 1, header["rings"])[:, None]
    theta = 2 * np.pi / header["sectors"] * np.arange(header["sectors"])
    assert section == pytest.approx((r * np.sin(theta)).ravel(), abs=1e-4)
    assert tracers.xyz[:2] == pytest.approx(before[:2], abs=1e-6)
    moved = (tracers.xyz[2] - before[2] + 0.5 * grid.length) % grid.length - 0.5 * grid.length
    assert moved == pytest.approx(0.06 * before[1], abs=1e-5)


def test_tracers_rest_without_flow_and_in_a_cell_that_is_paused():
    grid = cy.CylinderGrid(16, 16)
    tracers = inside.Tracers(grid, 50, 0.6)
    before = tracers.xyz.copy()
    header, *_ = read(tracers.message(seen(grid, np.zeros((2, 16, 16))), 0.5))
    assert header["reference"] == 0
    tracers.message(seen(grid, winding(grid), playing=False), 0.0)
    assert np.array_equal(tracers.xyz, before)


def test_tracers_slow_down_with_a_flow_that_dies():
    grid = cy.CylinderGrid(16, 16)
    tracers = inside.Tracers(grid, 50, 0.6)
    tracers.message(seen(grid, winding(grid)), 0.0)
    before = tracers.xyz.copy()
    tracers.message(seen(grid, 1e-3 * winding(grid)), 0.5)
    assert 0 < np.hypot(*(tracers.xyz - before)[:2]).max() < 0.3 * 1e-3 / inside.SLOWS_BELOW


class Page:
    """A page that draws all it gets, and keeps the pictures and what it was told of the inside."""

    def __init__(self, socket):
        self.socket, self.pictures, self.inside, self.cells = socket, {}, [], []

    def ask(self, **words):
        self.socket.send_text(json.dumps(words))

    def until(self, when, seconds=60):
        end = time.monotonic() + seconds
        while not when():
            assert time.monotonic() < end
            message = self.socket.receive()
            assert message["type"] != "websocket.close"
            if message.get("text"):
                self.hear(json.loads(message["text"]))
            else:
                self.look(message["bytes"])

    def hear(self, words):
        if words["type"] == "cell":
            self.cells.append(words)
        elif words["type"] == "hash":
            self.hash = words
        elif words["type"] == "refused":
            self.refused = words["sentence"]
        elif words["type"] in ("welcome", "resumed"):
            self.token = words["token"]
        elif words["type"] == "alive":
            self.ask(do="alive")

    def look(self, data):
        size, kind = struct.unpack("<II", data[:8])
        if kind:
            self.inside.append(read(data))
        else:
            header = json.loads(data[8 : 8 + size])
            self.pictures[header["frame"]] = data
            self.ask(do="seen", frame=header["frame"])


@pytest.fixture
def client():
    with TestClient(application(ServerLimits(sessions=2, idle_seconds=30.0)), base_url=HOST) as client:
        yield client


def connected(client):
    return client.websocket_connect("/cell", headers={"host": "localhost:8765"})


@pytest.fixture
def page(client):
    with connected(client) as socket:
        yield Page(socket)


def stepped(page, frames):
    """Begin a cell and step, looking at every picture; return its pictures and its hash."""
    page.ask(do="begin", setup=SETUP)
    begun = len(page.cells)
    page.until(lambda: page.cells[begun:])
    page.pictures.clear()
    page.until(lambda: 0 in page.pictures)
    for frame in range(1, frames + 1):
        page.ask(do="step")
        page.until(lambda frame=frame: frame in page.pictures)
    page.hash = None
    page.ask(do="hash")
    page.until(lambda: page.hash)
    return {frame: page.pictures[frame] for frame in range(1, frames + 1)}, page.hash


def test_a_cell_and_its_pictures_are_the_same_to_the_bit_with_the_switch_and_without(page):
    without = stepped(page, 6)
    assert page.inside == []
    assert all("vacuole" not in cell for cell in page.cells)
    page.ask(do="vacuole", on=True, tracers=300)
    page.until(lambda: page.inside)
    assert page.cells[-1]["vacuole"] == 300
    assert stepped(page, 6) == without
    page.until(lambda: page.inside[-1][0]["begun"] == page.cells[-1]["begun"])
    assert page.inside[-1][1].shape == (3, 300)


def test_the_inside_follows_to_another_grid_and_ends_when_it_is_no_longer_wanted(page):
    page.ask(do="begin", setup=SETUP)
    page.ask(do="vacuole", on=True)
    page.until(lambda: page.inside)  # though the cell stands
    assert np.array_equal(page.inside[0][1], scattered(600, 5.0).astype("<f4"))
    page.ask(do="begin", setup={"grid": {"n_theta": 16, "n_z": 16, "length": 9.0}})
    page.until(lambda: page.inside[-1][0]["length"] == 9.0)
    page.ask(do="play")
    many = len(page.inside)
    page.until(lambda: len(page.inside) > many + 2)
    assert not np.array_equal(page.inside[-1][1], page.inside[many][1])
    page.ask(do="vacuole", on=False)
    page.until(lambda: "vacuole" not in page.cells[-1])
    page.inside.clear()
    drawn = max(page.pictures)
    page.until(lambda: max(page.pictures) > drawn + 5)
    assert page.inside == []


def test_as_many_messages_come_as_are_allowed_however_often_they_are_asked_for(page):
    page.ask(do="begin", setup=SETUP)
    page.until(lambda: page.cells)
    began = time.monotonic()
    for k in range(20):
        page.ask(do="vacuole", on=True, tracers=10 + k)
    page.ask(do="hash")
    page.hash = None
    page.until(lambda: page.hash and page.inside and page.inside[-1][0]["tracers"] == 29)
    assert len(page.inside) <= 1 + (time.monotonic() - began) / inside.EVERY


def test_the_inside_goes_on_over_another_connection(client):
    with connected(client) as socket:
        page = Page(socket)
        page.ask(do="begin", setup=SETUP)
        page.ask(do="play")
        page.ask(do="vacuole", on=True, tracers=50)
        page.until(lambda: len(page.inside) > 2)
    with connected(client) as socket:
        again = Page(socket)
        again.ask(do="resume", token=page.token)
        again.until(lambda: len(again.inside) > 2)
    assert again.cells[-1]["vacuole"] == 50
    assert again.inside[-1][0]["t"] > page.inside[-1][0]["t"]
    assert again.inside[-1][1].shape == (3, 50)


def test_before_a_cell_the_switch_is_refused(page):
    page.refused = ""
    page.ask(do="vacuole", on=True)
    page.until(lambda: page.refused)
    assert "begun" in page.refused
