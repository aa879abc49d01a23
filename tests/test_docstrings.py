"""Every public function and class has an example in its docstring, and every example runs."""

import doctest
import inspect
import re
from importlib import import_module
from pathlib import Path
from types import ModuleType

import pytest

import cyclosis as cy

MODULES = (
    *(f"cyclosis.{name}" for name in ("dataset", "experiments", "sweep.export", "sweep.store")),
    *(f"cyclosis.stability.{name}" for name in ("dispersion", "elliptic", "profile")),
)
"""Further public modules, beside those that are attributes of `cyclosis`."""
FIGURES = Path(cy.__file__).parent / "figures"
OTHERS = (
    *(
        "cyclosis.figures.movie.movie",
        "cyclosis.figures.cylinder.draw",
        "cyclosis.figures.unwrapped.draw_map",
    ),
    *("cyclosis.figures.streamlines.streamlines", "cyclosis.figures.style.save"),
    *(
        "cyclosis.sweep.execute.repair",
        "cyclosis.sweep.plan.Block",
        "cyclosis.model.scales.PhysicalParameters",
    ),
    *(
        "cyclosis.model.scales.layer_mu",
        "cyclosis.dynamics.steps.Step",
        "cyclosis.dynamics.protocol.step_from_table",
    ),
)
"""Further public names that no rule below finds."""
PLAIN = {"cyclosis.figures.style.blank"}
"""A part of figures, and no figure."""
FLAGS = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE
DOCUMENTED = re.compile(r"^\.\. auto(?:function|class):: (cyclosis\S+)$", re.MULTILINE)


def named(value):
    return f"{value.__module__}.{value.__qualname__}"


def documentable(value):
    return inspect.isclass(value) or (callable(value) and hasattr(value, "__qualname__"))


def offered(module):
    """The functions and classes that a public module offers: its own, or those of the package's files."""
    package = hasattr(module, "__path__")
    for name, value in vars(module).items():
        if name.startswith("_") or not documentable(value) or isinstance(value, ModuleType):
            continue
        home = getattr(value, "__module__", "")
        if home == module.__name__ or (package and home.startswith(module.__name__ + ".")):
            yield value


def found(path):
    """The object of a dotted name, whose first parts are modules."""
    value = cy
    for part in path.split(".")[1:]:
        if not hasattr(value, part):
            import_module(f"{value.__name__}.{part}")
        value = getattr(value, part)
    return value


def everything():
    for value in (getattr(cy, name) for name in cy.__all__):
        if isinstance(value, ModuleType):
            yield from offered(value)
        elif documentable(value):
            yield value
    for name in MODULES:
        yield from offered(import_module(name))
    for path in FIGURES.glob("[!_]*.py"):
        for value in offered(import_module(f"cyclosis.figures.{path.stem}")):
            if inspect.isfunction(value) and value.__annotations__.get("return") == "Figure":
                yield value
    for path in (Path(cy.__file__).parents[2] / "docs" / "api").glob("*.md"):
        yield from map(found, DOCUMENTED.findall(path.read_text()))
    yield from map(found, OTHERS)


PUBLIC = {named(value): value for value in everything() if named(value) not in PLAIN}


def own_members(cls):
    """The public methods and properties of a class that are not those of its bases in another form."""
    for name, value in vars(cls).items():
        if isinstance(value, classmethod | staticmethod):
            value = value.__func__
        method = inspect.isfunction(value) or isinstance(value, property) or hasattr(value, "func")
        if method and not name.startswith("_") and not any(hasattr(base, name) for base in cls.__mro__[1:]):
            yield name, value


def text_of(value):
    return inspect.getdoc(value) or ""


def examples(value):
    return ">>> " in (value.__doc__ or "")


def without_example():
    for name, value in PUBLIC.items():
        if not examples(value):
            yield name
        if inspect.isclass(value):
            shown = "".join(
                example.source for example in doctest.DocTestParser().get_examples(text_of(value))
            )
            for member, own in own_members(value):
                if not examples(own) and not re.search(rf"\.{member}\b", shown):
                    yield f"{name}.{member}"


def with_examples():
    for name, value in PUBLIC.items():
        if examples(value):
            yield name, value.__doc__
        if inspect.isclass(value):
            for member, own in own_members(value):
                if examples(own):
                    yield f"{name}.{member}", own.__doc__


TESTED = dict(with_examples())


def test_every_public_name_has_an_example():
    assert list(without_example()) == []


def test_the_public_names_are_found():
    assert len(PUBLIC) > 120
    for name in (
        "cyclosis.model.initial.stripes",
        "cyclosis.stability.branches.branch.Branch",
        "cyclosis.traced.flow",
    ):
        assert name in PUBLIC


@pytest.mark.parametrize("name", TESTED)
@pytest.mark.filterwarnings("ignore:some workers of this cluster are not set up well")
def test_examples_are_true(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    test = doctest.DocTestParser().get_doctest(inspect.cleandoc(TESTED[name]), {}, name, None, 0)
    told = []
    doctest.DocTestRunner(optionflags=FLAGS).run(test, out=told.append)
    assert not told, "".join(told)
