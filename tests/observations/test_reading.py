"""Files in any form: order of rows, delimiters, line ends, headers; and what is not said is asked for."""

import numpy as np
import pytest

import cyclosis as cy
from measured import PIXELS, SAMPLES, refused

read = cy.observations.read
PLAIN = (SAMPLES / "openpiv_ordered_raw_pixels_y_down.txt").read_text()
PIVLAB = (SAMPLES / "pivlab_pixels.txt").read_bytes().decode()
SPOTS = (SAMPLES / "trackmate_spots.csv").read_text()


def written(tmp_path, text, name="file.txt", **how):
    path = tmp_path / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode(how.get("encoding", "utf-8")))
    return path


def same(one, other, **near):
    for a, b in zip(one.frames, other.frames, strict=True):
        assert a.grid == b.grid
        assert np.array_equal(a.good, b.good)
        for name in ("x", "y", "vx", "vy"):
            assert np.allclose(getattr(a, name), getattr(b, name), equal_nan=True, **near)


def shuffled(text, header=1):
    lines = text.splitlines()
    rows = lines[header:]
    np.random.default_rng(0).shuffle(rows)
    return "\n".join([*lines[:header], *rows]) + "\n"


FORMS = {
    "rows in another order": shuffled,
    "CRLF": lambda text: text.replace("\n", "\r\n"),
    "BOM": lambda text: "\ufeff" + text,
    "UTF-16": lambda text: text.encode("utf-16"),
    "spaces": lambda text: text.replace("\t", "  "),
    "commas": lambda text: text.replace("\t", ","),
    "semicolons": lambda text: text.replace("\t", ";"),
    "decimal commas": lambda text: text.replace(".", ","),
    "decimal commas and spaces": lambda text: text.replace(".", ",").replace("\t", "   "),
    "decimal commas and semicolons": lambda text: text.replace(".", ",").replace("\t", ";"),
    "empty lines": lambda text: text.replace("\n", "\n\n", 40) + "\n\n",
    "no line end": lambda text: text.rstrip("\n"),
    "comments": lambda text: text.replace("\n", "\n# a comment\n", 3),
    "no header": lambda text: text.partition("\n")[2],
    "plain numbers": lambda text: "\n".join(
        [
            text.splitlines()[0],
            *("\t".join(f"{float(n):.6g}" for n in r.split()) for r in text.splitlines()[1:]),
        ]
    ),
}


@pytest.mark.parametrize("form", FORMS)
def test_the_form_of_a_file_does_not_matter(tmp_path, form):
    expected = read(SAMPLES / "openpiv_ordered_raw_pixels_y_down.txt", **PIXELS)
    same(read(written(tmp_path, FORMS[form](PLAIN)), **PIXELS), expected)


PIVLAB_FORMS = {
    "rows in another order": lambda text: shuffled(text, 3),
    "LF": lambda text: text.replace("\r\n", "\n"),
    "tabs": lambda text: "\r\n".join(
        [*text.splitlines()[:2], *(r.replace(",", "\t") for r in text.splitlines()[2:])]
    ),
    "spaces": lambda text: "\r\n".join(
        [*text.splitlines()[:3], *(r.replace(",", " ") for r in text.splitlines()[3:])]
    ),
    "only names": lambda text: "\r\n".join(text.splitlines()[2:]),
    "BOM": lambda text: "\ufeff" + text,
}


@pytest.mark.parametrize("form", PIVLAB_FORMS)
def test_the_form_of_a_pivlab_file_does_not_matter(tmp_path, form):
    expected = read(SAMPLES / "pivlab_pixels.txt", y="down", frame_s=0.3)
    same(read(written(tmp_path, PIVLAB_FORMS[form](PIVLAB)), y="down", frame_s=0.3), expected)


def test_pivlab_further_columns_and_unknown_types(tmp_path):
    lines = PIVLAB.splitlines()
    more = [*lines[:2], lines[2] + ",magnitude [px/frame]", *(line + ",1" for line in lines[3:])]
    expected = read(SAMPLES / "pivlab_pixels.txt", y="down")
    same(read(written(tmp_path, "\n".join(more)), y="down"), expected)
    with refused("types", "7"):
        read(written(tmp_path, "\n".join([*lines[:-1], lines[-1][:-1] + "7"])), y="down")


def test_pivlab_of_version_7_3(tmp_path):
    """HDF5 with references, as MATLAB writes cells, and transposed matrices."""
    import h5py
    from scipy.io import loadmat

    found = loadmat(SAMPLES / "pivlab_v7.mat")
    path = tmp_path / "session.mat"
    with h5py.File(path, "w", userblock_size=512) as file:
        for name, value in found.items():
            if not name.startswith("__") and value.dtype == object:
                cells = file.create_dataset(name, (1, 1), h5py.ref_dtype)
                cells[0, 0] = file.create_dataset(f"#refs#/{name}", data=value[0, 0].T).ref
        codes = np.array([[ord(c)] for c in str(found["units"][0])], dtype=np.uint16)
        file.create_dataset("units", data=codes).attrs["MATLAB_class"] = np.bytes_("char")
    same(read(path, y="down"), read(SAMPLES / "pivlab_v7.mat", y="down"))


@pytest.mark.parametrize("rows", [1, 2, 3, 4])
def test_trackmate_has_one_to_four_header_rows(tmp_path, rows):
    lines = SPOTS.splitlines()
    path = written(tmp_path, "\n".join([*lines[:1], *lines[5 - rows : 4], *lines[4:]]), "spots.csv")
    said = {"pixel_um": 5.0} if rows > 1 else {"pixel_um": 5.0, "length": "um", "frame_s": 0.3}
    same(read(path, **said), read(SAMPLES / "trackmate_spots.csv", pixel_um=5.0))
    if rows == 1:
        with refused("unit of x and y"):
            read(path, pixel_um=5.0)


def test_trackmate_rows_labels_and_quotes(tmp_path):
    """Rows in another order, a label with a comma in it, and a table that a spreadsheet has quoted."""
    expected = read(SAMPLES / "trackmate_spots.csv", pixel_um=5.0)
    counts = sum(frame.x.size for frame in expected.frames)
    for text in (
        shuffled(SPOTS, 4),
        SPOTS.replace("\nID1000,", "\nnear, the end,"),
        SPOTS.replace("\nID1001,", '\n"one, two",'),
    ):
        found = read(written(tmp_path, text, "spots.csv"), pixel_um=5.0)
        assert sum(frame.x.size for frame in found.frames) == counts
        for a, b in zip(expected.frames, found.frames, strict=True):
            assert np.allclose(np.sort(a.vx), np.sort(b.vx))


def test_tracks_leave_gaps_and_refuse_repeated_spots(tmp_path):
    rows = ["x,y,frame,particle", "0,0,0,1", "2,0,1,1", "8,0,4,1", "100,0,20,1", "50,50,0,2"]
    path = written(tmp_path, "\n".join(rows))
    seen = read(path, frame_s=0.5)
    assert [frame.vx.tolist() for frame in seen.frames] == [[4.0], [4.0]]
    assert seen.times.tolist() == [0.25, 1.25]
    assert len(read(path, frame_s=0.5, max_gap=100).frames) == 3
    with refused("one spot of a track"):
        read(written(tmp_path, "\n".join([*rows, "3,0,1,1"])), frame_s=0.5)


TABLE = "0 0 1 2\n16 0 1 2\n0 16 3 4\n16 16 3 4\n"
NAMED = {"x": 0, "y": 1, "u": 2, "v": 3}


def test_nothing_is_guessed(tmp_path):
    raw = SAMPLES / "openpiv_ordered_raw_pixels_y_down.txt"
    with refused("y = None", "down", "up"):
        read(raw, speed="px/s")
    with refused("speed = None", "px/s"):
        read(raw, y="down")
    with refused("pixel_um = None", "micrometres"):
        read(raw, y="down", speed="um/s")
    with refused("begins with '0 0 1 2'", "columns"):
        read(written(tmp_path, TABLE), y="down", speed="px/s")
    seen = read(raw, **PIXELS)
    with refused("radius_px"):
        seen.view(axis_deg=0.0, centre_px=(0.0, 0.0))
    with refused("centre_px"):
        seen.view(radius_px=100.0, axis_deg=0.0)
    with refused("axis_deg"):
        seen.view(radius_px=100.0, centre_px=(0.0, 0.0))
    with refused("view"):
        seen.on_surface()
    assert "mirrored=False" in repr(seen.view(100.0, 17.0, (30.0, 225.0)))


def test_what_is_not_said_is_in_the_repr():
    shown = repr(read(SAMPLES / "openpiv_ordered_um_per_s_y_up.txt", y="up", speed="um/s", pixel_um=5.0))
    for word in ("openpiv", "22 x 13", "transform_coordinates", "flags", "5 um"):
        assert word in shown


def test_any_table_by_its_columns(tmp_path):
    path = written(tmp_path, TABLE)
    seen = read(path, columns=NAMED, y="up", speed="px/frame")
    assert seen.time_unit == "frame"
    assert seen.frames[0].vy.tolist() == [-4.0, -4.0, -2.0, -2.0]  # y up becomes y down
    moved = read(path, columns=NAMED, y="up", speed="px/frame", origin_px=(5.0, 100.0)).frames[0]
    assert (moved.x.min(), moved.y.max()) == (5.0, 100.0)
    with refused("columns", "0 to 3"):
        read(path, columns=NAMED | {"v": 4}, y="up", speed="px/s")
    with refused("columns", "x, y, u and v"):
        read(path, columns={"x": 0, "y": 1}, y="up", speed="px/s")
    with refused("columns", "did you mean angle"):
        read(path, columns=NAMED | {"angel": 3}, y="up", speed="px/s")
    header = read(written(tmp_path, "x [px],y [px],u [px/s],v [px/s]\n" + TABLE.replace(" ", ",")), y="down")
    assert header.frames[0].vx.tolist() == [1.0, 1.0, 3.0, 3.0]


def test_speeds_are_in_seconds_whatever_the_unit_of_time(tmp_path):
    path = written(tmp_path, TABLE)
    given = {"columns": NAMED, "y": "down", "pixel_um": 2.0}
    for unit, seconds in (("um/s", 1.0), ("um/min", 60.0), ("mm/h", 3.6), ("um/ms", 1e-3)):
        found = read(path, speed=unit, **given)
        assert found.time_unit == "s"
        assert found.frames[0].vx * seconds == pytest.approx([0.5, 0.5, 1.5, 1.5]), unit


BROKEN = {
    "empty": ("", "empty"),
    "only blanks": (" \n\n", "empty"),
    "words": ("this is not\na table\n", "begins with"),
    "cut in a row": (PLAIN[:-30], "line"),
    "cut after a row": ("\n".join(PLAIN.splitlines()[:200]), "regular grid"),
    "a word in it": (PLAIN.replace("2.8000e+01\t2.1000e+01", "2.8000e+01\tabc", 1), "line"),
    "a repeated row": (PLAIN + PLAIN.splitlines()[5] + "\n", "regular grid"),
    "all flagged": ("\n".join(r[:-10] + "1.0000e+00" for r in PLAIN.splitlines()[1:]), "good"),
    "zero bytes": (b"x\0y", "zero bytes"),
    "names and columns differ": (PLAIN.replace("\tflags", "", 1), "begins with"),
    "a name unknown": (PLAIN.replace("# x\ty\tu", "# x\ty\tw", 1), "begins with"),
    "other XML": ("<TrackMate><Model/></TrackMate>", "TrackMate"),
    "cut XML": ("<Tracks><particle>", "whole"),
    "two vectors a place": ("0 0 1 2 0\n0 0 1 2 0\n16 0 1 2 0\n16 16 1 2 0\n", "regular grid"),
}


@pytest.mark.parametrize("what", BROKEN)
def test_broken_files_are_refused_in_one_sentence(tmp_path, what):
    text, word = BROKEN[what]
    with refused("cannot be used", word):
        read(written(tmp_path, text), y="down", speed="px/s")


def test_a_folder_a_missing_file_and_a_run_are_refused(tmp_path):
    with refused("folder"):
        read(tmp_path)
    with refused("No such file"):
        read(tmp_path / "nowhere.txt")
    grid = cy.CylinderGrid(16, 16)
    path = cy.write(cy.simulate(cy.Parameters(), grid, cy.initial.stripes(grid), 1.0), tmp_path / "run.nc")
    with refused("file of the model"):
        read(path)


def test_files_of_one_film_and_of_a_focal_stack(tmp_path):
    paths = [written(tmp_path, PLAIN, f"{k}.txt") for k in range(3)]
    with refused("every_s"):
        read(paths, **PIXELS)
    assert read(paths, **PIXELS, every_s=0.6).times.tolist() == [0.0, 0.6, 1.2]
    other = SAMPLES / "pivlab_pixels.txt"
    with refused("format is openpiv"):
        read([paths[0], other], **PIXELS)
    with refused("3 numbers"):
        read(paths, **PIXELS, focus_um=[0.0])
    stack = read(paths, **PIXELS, pixel_um=5.0, focus_um=[0.0, 120.0, 240.0])
    view = stack.view(100.0, 17.0, (30.0, 225.0), mirrored=False)
    one = read(paths[0], **PIXELS, pixel_um=5.0).view(100.0, 17.0, (30.0, 225.0), mirrored=False)
    seen, cap = view.on_surface(depth_um=120.0), one.on_surface(depth_um=120.0)
    assert seen.sizes["time"] == 1
    wide = [np.abs(d["theta"].values - np.pi).max() for d in (seen, cap)]
    assert wide[0] == pytest.approx(np.arccos(1 - 360 / 500), abs=0.1)
    assert wide[1] <= np.arccos(1 - 120 / 500)


@pytest.mark.slow
def test_a_million_rows(tmp_path):
    """Read in seconds: the time is not tested, that it ends is."""
    x, y = np.meshgrid(np.arange(1000.0), np.arange(1000.0))
    rows = np.stack([x.ravel(), y.ravel(), y.ravel(), x.ravel(), 0 * x.ravel(), 0 * x.ravel()], axis=1)
    path = tmp_path / "large.txt"
    np.savetxt(path, rows, fmt="%.4e", delimiter="\t", header="x\ty\tu\tv\tflags\tmask")
    seen = read(path, y="down", speed="px/s")
    assert seen.frames[0].grid == (1000, 1000)
    assert np.array_equal(seen.frames[0].vx, y.ravel())
