"""Every public value shows itself shortly, without its arrays, and as valid HTML in a notebook."""

import ast
import inspect
from html.parser import HTMLParser
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest
import xarray

import cyclosis as cy
from cyclosis.display.shown import brief, shown
from test_docstrings import DOCUMENTED, PUBLIC, found

THEMSELVES = {"InputError", "Status"}
"""An exception and an enumeration, which every program knows how to show."""
CLASSES = {n: v for n, v in PUBLIC.items() if inspect.isclass(v) and v.__name__ not in THEMSELVES}
NEVER_CLOSED = {"img", "br", "path", "rect", "circle"}


class Checked(HTMLParser):
    """Raises AssertionError for tags that are not closed in order."""

    def __init__(self, html):
        super().__init__()
        self.open, self.text = [], []
        self.feed(html)
        assert not self.open, self.open

    def handle_starttag(self, tag, attrs):
        if tag not in NEVER_CLOSED:
            self.open.append(tag)

    def handle_endtag(self, tag):
        if tag not in NEVER_CLOSED:
            assert self.open.pop() == tag

    def handle_data(self, data):
        self.text.append(data)


class Anything:
    """What stands in a field of an example: an array, a text with tags, or a number, by the type written."""

    ARRAY = np.linspace(-1.0, 1.0, 2 * 48 * 48).reshape(2, 48, 48)

    @classmethod
    def of(cls, annotation):
        words = str(annotation)
        if any(name in words for name in ("Array", "NDArray", "Complex")):
            return cls.ARRAY
        if "float" in words or "int" in words:
            return 0.1 + 0.2
        if "Dataset" in words:
            return xarray.Dataset({"P": (("a", "b", "c"), cls.ARRAY)})
        if "Mapping" in words or "dict" in words:
            return {f"key {k}": cls.ARRAY for k in range(99)}
        if "tuple" in words or "list" in words or "Sequence" in words:
            return tuple(range(999))
        return "<b>" + "long & wide " * 99


def example(kind):
    """An instance of a class with large arrays and long texts in its fields, past any check of its values."""
    made = object.__new__(kind)
    notes = {
        name: note for base in kind.__mro__ for name, note in vars(base).get("__annotations__", {}).items()
    }
    for name, annotation in notes.items():
        object.__setattr__(made, name, Anything.of(annotation))
    return made


def real():
    """Values as calls return them, of the classes that write themselves."""
    grid, params = cy.CylinderGrid(16, 16), cy.Parameters(alpha_p=np.full((16, 16), 0.5))
    P = cy.initial.stripes(grid)
    steps = cy.Protocol(cy.depolymerise(at=0.5))
    run = cy.simulate(params, grid, P, t_end=1.0, protocol=steps)
    stripe = cy.stability.stripes(cy.Parameters(), n_theta=128)
    yield from (grid, params, run, run.frames, run.restart, run.effort, run.settings, run.plot, run.model)
    yield from (run.interventions[0], steps, next(iter(steps)), stripe, cy.regime(params, grid, P))
    yield from (cy.Scales(25.0, 50.0), cy.regions.disc(1.0, 1.0, 0.5) & ~cy.regions.band("z", 0.0, 1.0))
    yield from (cy.ClosedGrid(cy.Capsule(3.0), k_max=8), cy.closed.Defect(1.0, 0.1, 0.2))
    yield from (cy.vacuole.flow(grid, cy.flow(cy.Parameters(), grid, P)),)
    yield cy.ensemble.Member(params, grid, lambda: P, steps)
    yield cy.Sweep.from_tables({"axes": {"alpha_u": {"values": [0.1, 0.2]}}})
    yield cy.observations.View(100.0, 3.0, (10.0, 20.0), mirrored=False)


def check(value):
    text, html = repr(value), value._repr_html_()
    assert 0 < len(text) <= 700, text
    assert len(text.splitlines()) <= 20
    assert len(html) < 30_000
    for words in (text, html):
        assert "array(" not in words
        assert "..., " not in words
        assert " object at 0x" not in words
    seen = "".join(Checked(html).text)
    assert ("<b>" in seen) == ("<b>" in text), "escaped, and so seen as it is"
    assert type(value).__name__ in text + seen or "\n" in text or "run.plot" in text or "cyclosis." in text
    return seen


@pytest.mark.parametrize("name", CLASSES)
def test_every_public_class_has_both_forms_of_its_own(name):
    kind = CLASSES[name]
    assert kind.__repr__ is not object.__repr__
    assert callable(getattr(kind, "_repr_html_", None)), "decorate it with display.shown.shown"
    if kind.__repr__.__module__ == shown.__module__ and not hasattr(kind, "_fields"):
        check(example(kind))


def test_values_of_calls_show_themselves():
    for value in real():
        check(value)


def test_a_short_value_looks_as_it_is_written():
    assert repr(cy.vacuole.Held(0.5)) == "Held(value=0.5)"
    assert repr(cy.Spheroid(2.0)) == "Spheroid(aspect=2.0)"
    assert brief(np.float64(0.1)) == "0.1"
    assert brief((1, "a")) == "(1, 'a')"
    assert brief((1,)) == "(1,)"
    assert brief({"a": np.ones(3)}) == "{'a': <array (3,)>}"
    assert brief(list(range(100))) == "<100 items>"
    assert brief("x" * 100).endswith("...'")


def test_a_tree_tells_the_range_of_an_array():
    stripe = cy.stability.stripes(cy.Parameters(), n_theta=128)
    html = stripe._repr_html_()
    assert f"128 values, {stripe.P.min():.4g} to {stripe.P.max():.4g}" in html


def public_modules():
    """Attributes of the package, modules imported by their path, and those of the API's pages."""
    yield "cyclosis"
    yield from (f"cyclosis.{name}" for name in ("dataset", "experiments", "fitting"))
    yield from (f"cyclosis.sweep.{name}" for name in ("export", "plan", "store"))
    yield from (getattr(cy, name).__name__ for name in cy.__all__ if inspect.ismodule(getattr(cy, name)))
    yield from (f"cyclosis.stability.{name}" for name in ("dispersion", "elliptic", "profile"))
    for path in (Path(cy.__file__).parents[2] / "docs" / "api").glob("*.md"):
        for documented in DOCUMENTED.findall(path.read_text()):
            yield inspect.getmodule(found(documented)).__name__ if ".figures." in documented else "cyclosis"


@pytest.mark.parametrize("name", sorted(set(public_modules())))
def test_the_names_of_a_public_module_are_its_public_names_alone(name):
    module = import_module(name)
    names = dir(module)
    assert names == sorted(module.__all__)
    assert not [each for each in names if each.startswith("_") and each != "__version__"]
    assert all(getattr(module, each) is not None for each in names)
    tree = ast.parse(inspect.getsource(module))
    offered = {node.name for node in tree.body if isinstance(node, ast.FunctionDef | ast.ClassDef)}
    offered |= {
        alias.asname
        for node in tree.body
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
        if alias.asname
    }
    missing = {each for each in offered if not each.startswith("_")} - set(names)
    assert not missing, "public names that dir() does not list"
