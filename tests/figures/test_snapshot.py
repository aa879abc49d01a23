"""Single panels, comparisons, and what saved pictures say of the run that they show."""

import io

import numpy as np
import PIL.Image
import pytest

import cyclosis as cy
from cyclosis.dataset import with_scales
from cyclosis.figures import looks, paper, style
from cyclosis.figures.compare import compare
from cyclosis.figures.snapshot import snapshot
from measure.commandline import said

SCALES = ("--radius-um", 500, "--speed-um-s", 75)
GRID = cy.CylinderGrid(16, 16)


@pytest.fixture(scope="module")
def run():
    return cy.simulate(cy.Parameters(), GRID, cy.initial.stripes(GRID, magnitude=0.5), 6.0)


@pytest.fixture(scope="module")
def file(run, tmp_path_factory):
    return cy.write(run, tmp_path_factory.mktemp("drawn") / "run.nc")


def inside(figure):
    """Whether every axis with its labels lies within the figure."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    whole = figure.bbox
    boxes = [ax.get_tightbbox(canvas.get_renderer()) for ax in figure.axes]
    return all(
        box.x0 >= -1 and box.y0 >= -1 and box.x1 <= whole.x1 + 1 and box.y1 <= whole.y1 + 1 for box in boxes
    )


@pytest.mark.parametrize("width", [60.0, 89.0, 183.0])
@pytest.mark.parametrize(("view", "parts"), [("both", 3), ("cylinder", 2), ("map", 2)])
def test_a_moment_is_drawn_as_wide_as_asked(run, view, parts, width):
    figure = snapshot(run.to_dataset(), 2.2, view, width)
    assert len(figure.axes) == parts
    assert figure.get_size_inches()[0] * 25.4 == pytest.approx(width)
    assert figure.texts[0].get_text() == "$t$ = 2"
    assert inside(figure)


@pytest.mark.slow
def test_a_closed_cell_has_its_snapshot_too():
    grid = cy.ClosedGrid(cy.Spheroid(1.5), k_max=8)
    run = cy.simulate(cy.Parameters(), grid, cy.closed.swirl(grid, 0.5), 0.1, save_every=0.1)
    scaled = with_scales(run.to_dataset(), cy.Scales(20.0, 2.0))
    with looks.chosen(colours="direction"):
        figure = snapshot(scaled, width=120.0)
    assert len(figure.axes) == 3
    assert inside(figure)


def test_the_map_shows_the_frame_nearest_to_the_time(run):
    data = run.to_dataset()
    image = snapshot(data, 1.0, "map").axes[0].images[0].get_array()
    # Colours where points of the grid are: every fourth of the finer map.
    assert np.allclose(image[:-1:4, :-1:4], style.polarity_rgb(data["P"].values[1, 1].T), atol=1e-6)
    for mistake in ({"time": 7.0}, {"view": "globe"}, {"width": 10.0}):
        with pytest.raises(cy.InputError):
            snapshot(data, **mistake)


@pytest.mark.slow
def test_two_runs_are_compared_on_one_grid(run):
    fine = cy.CylinderGrid(32, 24)
    other = cy.simulate(cy.Parameters(), fine, cy.initial.stripes(fine), 2.0)
    figure = compare(run.to_dataset(), other.to_dataset(), names=("coarse", "fine"))
    titles = [ax.get_title() for ax in figure.axes]
    assert titles[:2] == ["coarse, $t$ = 2", "fine, $t$ = 2"]
    assert inside(figure)
    same = compare(run.to_dataset(), run.to_dataset(), 3.0)
    assert any(title.endswith("= 0") for title in (ax.get_title() for ax in same.axes))
    longer = other.to_dataset().assign_attrs(length=6.0)
    longer = longer.assign_coords(z=longer["z"] * 1.2)
    with pytest.raises(cy.InputError, match="cells of one length"):
        compare(run.to_dataset(), longer)


@pytest.mark.slow
def test_two_closed_cells_are_compared():
    """The size of the difference is that over the surface."""
    grid = cy.ClosedGrid(cy.Capsule(3.0), k_max=8)
    state = cy.closed.swirl(grid, magnitude=0.5)
    one = cy.simulate(cy.Parameters(), grid, state, t_end=0.001, save_every=0.001).to_dataset()
    sizes = []
    for second in (one, one.assign(P=-one["P"])):
        figure = compare(one, second, 0.0)
        assert len(figure.axes) == 5
        assert inside(figure)
        sizes.append(float(figure.axes[3].get_title().split("= ")[1]))
    expected = 2 * np.sqrt(grid.mean(np.sum(one["P"].values[0] ** 2, axis=0)))
    assert sizes == pytest.approx([0.0, expected], rel=0.02)
    cylinder = cy.simulate(cy.Parameters(), cy.CylinderGrid(16, 16), np.zeros((2, 16, 16)), 0.1).to_dataset()
    longer = one.assign_attrs(
        configuration=one.attrs["configuration"].replace('"length": 3.0', '"length": 4.0')
    )
    for first, second in ((one, cylinder), (cylinder, one), (one, longer)):
        with pytest.raises(cy.InputError):
            compare(first, second)


def test_pictures_of_every_format_name_the_configuration(file, tmp_path):
    with cy.open_dataset(file) as data:
        mark = data.attrs["configuration_sha256"]
    for kind in ("png", "pdf", "svg", "eps"):
        path = tmp_path / f"panel.{kind}"
        words = ("figure", "snapshot", file, "--at", 2, "--view", "map", "--width-mm", 89, "--out", path)
        code, out, errors = said(*words)
        assert (code, out, errors) == (0, f"saved {path}\n", "")
        if kind == "png":
            assert mark in PIL.Image.open(path).text["Description"]
        else:
            assert mark.encode() in path.read_bytes()


@pytest.mark.slow
def test_the_looks_of_the_command_line_reach_the_picture(file, tmp_path):
    sheet = tmp_path / "thick.mplstyle"
    sheet.write_text("axes.linewidth: 4\n")
    pictures = []
    for number, words in enumerate(
        ((), ("--colours", "berlin"), ("--font", "DejaVu Sans"), ("--style", sheet), SCALES)
    ):
        path = tmp_path / f"{number}.png"
        same = ("figure", "snapshot", file, "--view", "map", "--width-mm", 60, "--out", path)
        assert said(*same, *words)[0] == 0
        pictures.append(np.asarray(PIL.Image.open(path).convert("RGB")))
    for other in pictures[1:]:
        assert pictures[0].shape != other.shape or np.any(pictures[0] != other)
    code, _, errors = said("figure", "snapshot", file, "--colours", "jet", "--out", tmp_path / "x.png")
    assert code == 2
    assert "one of purple-green, blue-orange, berlin, managua, vanimo, direction" in errors


def test_a_run_draws_itself(run, tmp_path):
    assert len(run.plot().axes) == 10
    assert len(run.plot.history().axes) == 6
    figure = run.plot.snapshot(2.0, view="cylinder", width=60.0)
    path = style.save(figure, tmp_path / "cell.png")
    assert "configuration_sha256" in PIL.Image.open(path).text["Description"]
    assert "run.plot.snapshot(time)" in repr(run.plot)
    shown = PIL.Image.open(io.BytesIO(figure._repr_png_()))  # what a notebook asks for
    assert shown.width == round(60.0 / 25.4 * paper.DPI)
    assert shown.text["Description"] == PIL.Image.open(path).text["Description"]
    mark = run.to_dataset().attrs["configuration_sha256"]
    for name in ("cell.gif", "cell.mp4"):
        (path,) = run.plot.movie(tmp_path / name, frames=2, seconds=0.5, height=180, workers=1)
        assert mark.encode() in path.read_bytes()
