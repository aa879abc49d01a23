"""A sweep: all its members and blocks, described without listing them."""

from __future__ import annotations

import hashlib
import json
import math
import os
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any

import numpy as np

from ... import config, models
from ...contract.model import Coordinate, Model
from ...display.shown import shown
from ...model.errors import whole
from . import axes, step_axes, variables
from .configuration import UNDECISIVE, Tables, completed, grid_of
from .step_axes import place
from .variables import Variable

if TYPE_CHECKING:
    from ...dynamics.protocol import Protocol
    from ...ensemble import EnsembleSettings, Member


@shown
@dataclass(frozen=True)
class Block:
    """The numbers of the members that are computed and stored together.

    Example:
        >>> import cyclosis as cy
        >>> tables = {"axes": {"alpha_p": {"values": [0.3, 1.0]}}, "ensemble": {"seeds": 5, "block": 4}}
        >>> cy.Sweep.from_tables(tables).block(1)
        Block(index=1, members=range(4, 8))
    """

    index: int
    members: range


@shown
@dataclass(frozen=True, eq=False)
class Sweep:
    """A checked sweep: an ensemble of initial states at every point of a grid of parameters.

    Members are numbered in C order over (axes..., seed), and seed s gives the same initial state at every
    point. Make one with `from_toml` or `from_tables`; `tables` is then the complete configuration (plain, fit
    for JSON) and `axes` the values by name. Two sweeps are equal if everything that determines their results
    and blocks is equal. Members and blocks are made on request, so that a sweep of any size is small.

    Example:
        >>> import cyclosis as cy
        >>> axes = {"alpha_p": {"values": [0.3, 1.0]}, "alpha_u": {"start": 0.0, "stop": 0.5, "count": 6}}
        >>> sweep = cy.Sweep.from_tables({"axes": axes, "ensemble": {"seeds": 5, "block": 10}})
        >>> sweep
        Sweep(alpha_p 2 x alpha_u 6 x seed 5: 60 members in 6 blocks)
        >>> sweep.shape, sweep.members, sweep.blocks, sweep.block_size, sweep.seeds
        ((2, 6, 5), 60, 6, 10, range(0, 5))
        >>> sweep.axes["alpha_u"], sweep.settings.finish
        ((0.0, 0.1, 0.2, 0.3, 0.4, 0.5), 'certified')
        >>> [item.name for item in sweep.variables][:4], sweep.sizes["component"]
        (['regime', 'status', 't_final', 't_order'], 2)
        >>> len(sweep.digest), len(sweep.protocol), sweep.fields, sweep.record
        (64, 0, False, ())
    """

    tables: Tables
    axes: dict[str, tuple[float, ...]]

    @classmethod
    def from_toml(cls, path: str | os.PathLike[str]) -> Sweep:
        """Return the sweep described by a configuration file. Raises `InputError` for any mistake in it.

        Example:
            >>> from pathlib import Path
            >>> import tomli_w
            >>> import cyclosis as cy
            >>> tables = {"axes": {"alpha_p": {"values": [0.3, 1.0]}}, "ensemble": {"seeds": 5}}
            >>> written = Path("sweep.toml").write_text(tomli_w.dumps(tables))
            >>> cy.Sweep.from_toml("sweep.toml").members
            10
        """
        return cls.from_tables(config.load(str(path)))

    @classmethod
    def from_tables(cls, tables: Mapping[str, Any], *, files: bool = True) -> Sweep:
        """Return the sweep of a configuration given as tables. Raises `InputError` for any mistake in it.

        Without `files` the file of an initial state is opened only when a member is built.

        Example:
            >>> import cyclosis as cy
            >>> axes = {"alpha_p": {"start": 0.01, "stop": 1.0, "count": 3, "spacing": "log"}}
            >>> cy.Sweep.from_tables({"axes": axes, "ensemble": {"seeds": 2}}).axes
            {'alpha_p': (0.01, 0.1, 1.0)}
        """
        whole_tables = completed(tables, files)
        return cls(whole_tables, {name: axes.values(table) for name, table in whole_tables["axes"].items()})

    @property
    def model(self) -> Model:
        """The physics of all members.

        Example:
            >>> import cyclosis as cy
            >>> cy.Sweep.from_tables({"axes": {"alpha_p": {"values": [0.3, 1.0]}}}).model
            cyclosis.models.polar
        """
        return models.of_tables(self.tables)

    @property
    def shape(self) -> tuple[int, ...]:
        """The lengths of the axes, and the number of seeds."""
        return (*(len(values) for values in self.axes.values()), self.tables["ensemble"]["seeds"])

    @property
    def seeds(self) -> range:
        """The seeds."""
        first = self.tables["ensemble"]["first_seed"]
        return range(first, first + self.tables["ensemble"]["seeds"])

    @property
    def members(self) -> int:
        """The number of members."""
        return math.prod(self.shape)

    @property
    def block_size(self) -> int:
        """The number of members of every block but the last, which may have fewer."""
        return int(self.tables["ensemble"]["block"])

    @property
    def blocks(self) -> int:
        """The number of blocks."""
        return -(-self.members // self.block_size)

    def block(self, index: int) -> Block:
        """Return one block. Raises `InputError` if there is no block of this index.

        Example:
            >>> import cyclosis as cy
            >>> tables = {"axes": {"alpha_p": {"values": [0.3, 1.0]}}, "ensemble": {"seeds": 5, "block": 4}}
            >>> cy.Sweep.from_tables(tables).block(2).members
            range(8, 10)
        """
        index = whole("block", index, 0, self.blocks - 1, "choose another")
        first = index * self.block_size
        return Block(index, range(first, min(first + self.block_size, self.members)))

    def member(self, number: int) -> tuple[dict[str, float], int]:
        """Return the value of a member on every axis, and its seed.

        Raises `InputError` if there is no member of this number.

        Example:
            >>> import cyclosis as cy
            >>> tables = {"axes": {"alpha_p": {"values": [0.3, 1.0]}}, "ensemble": {"seeds": 5}}
            >>> cy.Sweep.from_tables(tables).member(7)  # the third seed at the second point
            ({'alpha_p': 1.0}, 2)
        """
        number = whole("member", number, 0, self.members - 1, "choose another")
        *place, seed = np.unravel_index(number, self.shape)
        point = {name: values[at] for (name, values), at in zip(self.axes.items(), place, strict=True)}
        return point, self.seeds[int(seed)]

    def build(self, number: int) -> Member:
        """Return a member ready to be computed; its initial state is made when needed.

        Raises `InputError` if there is no member of this number; the function that makes the state raises it
        for noise that makes |P| > 1, and for a file that has changed since the sweep was planned.

        Example:
            >>> import numpy as np
            >>> import cyclosis as cy
            >>> tables = {"axes": {"alpha_p": {"values": [0.3, 1.0]}}, "ensemble": {"seeds": 5}}
            >>> sweep = cy.Sweep.from_tables(tables)
            >>> one, other = sweep.build(2), sweep.build(7)  # one seed, two points
            >>> one.params.alpha_p, other.params.alpha_p, bool(np.array_equal(one.state(), other.state()))
            (0.3, 1.0, True)
        """
        from ...ensemble import Member

        point, seed = self.member(number)
        swept = {name: value for name, value in point.items() if place(name) == "parameters"}
        grid, model = grid_of(self.tables, point), self.model
        start = {name: value for name, value in point.items() if place(name) == "initial"}
        state = partial(models.starts_of(model).seeded, self.tables["initial"] | start, seed, grid)
        return Member(self._fixed.replace(**swept), grid, state, self.protocol_at(point, seed), model)

    def protocol_at(self, point: Mapping[str, float], seed: int = 0) -> Protocol:
        """Return the protocol of a member at a point of the axes, with the random numbers of its seed.

        Example:
            >>> import cyclosis as cy
            >>> axes = {"protocol.drug.at": {"values": [5.0, 20.0]}}
            >>> steps = [{"name": "drug", "action": "change", "alpha_u": 0.0}]
            >>> sweep = cy.Sweep.from_tables({"axes": axes, "protocol": steps})
            >>> print(sweep.protocol_at({"protocol.drug.at": 20.0}))
            Protocol: 1 step, seed 0
            └─ t = 20: alpha_u = 0
        """
        from ...dynamics.protocol import Protocol

        if not self._varied:
            return self.protocol.with_seed(seed)
        return Protocol.from_tables(step_axes.placed(self.tables["protocol"], point), seed)

    @property
    def settings(self) -> EnsembleSettings:
        """The settings with which members are integrated."""
        from ...ensemble import EnsembleSettings

        return EnsembleSettings(**(self.tables["run"] | {"terms": tuple(self.tables["run"]["terms"])}))

    @cached_property
    def record(self) -> tuple[str, ...]:
        """The names of the quantities that are stored in addition to the standard ones."""
        return variables.further(self.model, self.tables["record"]["quantities"] or ())

    @property
    def fields(self) -> bool:
        """Whether complete final states are stored."""
        return bool(self.tables["record"]["fields"])

    @cached_property
    def variables(self) -> tuple[Variable, ...]:
        """What is stored of every member."""
        field = variables.field(self.model)
        if self.tables["run"]["precision"] == "float32":
            field = variables.with_dtype(field, "float32")
        return (
            *variables.standard(self.model),
            *(variables.quantity(self.model, name) for name in self.record),
            *([field] if self.fields else []),
        )

    @cached_property
    def sizes(self) -> dict[str, int]:
        """The lengths of the dimensions of variables, except that of the members."""
        sizes = {name: along.values.size for name, along in self.coordinates.items()}
        return sizes | {"term": len(self.tables["run"]["terms"])}

    @cached_property
    def coordinates(self) -> dict[str, Coordinate]:
        """The values along the dimensions of a state, with a cell of length 1 if the length is swept.

        Example:
            >>> import cyclosis as cy
            >>> sweep = cy.Sweep.from_tables({"axes": {"alpha_p": {"values": [0.3, 1.0]}}})
            >>> list(sweep.coordinates), sweep.coordinates["theta"].meaning
            (['component', 'theta', 'z', 'zone'], 'angle around the axis in radians')
        """
        grid: dict[str, Any] = {"length": 1.0} if "length" in self.axes else {}
        return self.model.coordinates(self.model.grid_from(grid | self.tables["grid"]), None)

    @cached_property
    def digest(self) -> str:
        """SHA-256 of everything that determines results and blocks, as canonical JSON."""
        start = {key: value for key, value in self.tables["initial"].items() if key not in UNDECISIVE}
        decisive = {key: table for key, table in self.tables.items() if key != "scales"} | {
            "initial": start,
            "axes": [[name, list(values)] for name, values in self.axes.items()],
            "record": {"quantities": list(self.record), "fields": self.fields},
        }
        text = json.dumps(decisive, sort_keys=True, separators=(",", ":"), allow_nan=False)
        return hashlib.sha256(text.encode()).hexdigest()

    @cached_property
    def protocol(self) -> Protocol:
        """The protocol of every member; where axes vary it, that at their first values."""
        return next(step_axes.protocols(self.tables.get("protocol", []), self.tables["axes"]))

    @cached_property
    def _varied(self) -> bool:
        return any(map(step_axes.is_step_axis, self.axes))

    @cached_property
    def _fixed(self) -> Any:
        return self.model.parameters(**self.tables["parameters"])

    def __eq__(self, other: object) -> bool:
        return self.digest == other.digest if isinstance(other, Sweep) else NotImplemented

    def __hash__(self) -> int:
        return hash(self.digest)

    def __repr__(self) -> str:
        sizes = " x ".join(f"{name} {len(values)}" for name, values in self.axes.items())
        return f"Sweep({sizes} x seed {len(self.seeds)}: {self.members} members in {self.blocks} blocks)"
