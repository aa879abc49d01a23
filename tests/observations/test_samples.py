"""The sample files of every format end in the run that they were made from."""

import numpy as np
import pytest

import cyclosis as cy
from measured import (
    HAS_TIFFFILE,
    PIXELS,
    SAMPLES,
    SCALES,
    VIEW,
    at,
    errors,
    kymograph_truth,
    refused,
    run_of,
    truth,
)

tiff = pytest.mark.skipif(not HAS_TIFFFILE, reason="tifffile is not installed: pip install cyclosis[data]")
read = cy.observations.read


def surface(file, view=VIEW, scales=SCALES, **said):
    return read(SAMPLES / file, **said).view(**view).on_surface(scales=scales)


RAW, SCALED = "openpiv_{}_raw_pixels_y_down.txt", "openpiv_{}_um_per_s_y_up.txt"
UM = {"y": "up", "speed": "um/s", "pixel_um": 5.0, "frame_s": 0.3}


@pytest.mark.parametrize(("name", "most"), [("ordered", 0.03), ("transient", 0.015)])
@pytest.mark.parametrize(("file", "said"), [(RAW, PIXELS), (SCALED, UM)])
def test_openpiv_ends_in_the_run(file, said, name, most):
    """Raw and transformed; the window's size undoes the shift of OpenPIV's positions."""
    data = surface(file.format(name), window_px=40.0, **said)
    for part in errors(data, f"u_{name}"):
        assert part.size > 90
        assert np.median(part) < most
    assert data.attrs["warnings"] == ""


def test_openpiv_shifts_its_positions_and_the_comparison_finds_by_how_much():
    """Positions are (8.5, 1.5) px too large: 7.7 px along the axis and 3.9 px across it."""
    data = surface(RAW.format("transient"), scales=None, **PIXELS)
    found = cy.observations.compare(data, run_of("u_ordered", "u_transient"))
    assert found.time == 1.0
    assert found.rotation == pytest.approx(0.0392, abs=0.01)
    assert found.shift == pytest.approx(0.077, abs=0.01)
    assert found.speed == pytest.approx(0.2, rel=0.03)  # R/s: U is 100 um/s and R 500 um
    assert found.rms_of_peak < 0.015
    assert not found.mirrored
    assert found.other_mirror > 3.0
    assert found.figure().axes[2].get_title() == "residual"


def test_a_mirrored_view_gives_the_other_hand():
    seen = read(SAMPLES / RAW.format("transient"), **PIXELS)
    for mirrored in (False, True):
        data = seen.view(**VIEW | {"mirrored": mirrored}).on_surface()
        found = cy.observations.compare(data, run_of("u_transient"))
        assert found.mirrored is mirrored
        assert found.rms < 1.5
        assert found.other_mirror > 3.0


def test_both_directions_of_y_are_one_flow():
    raw = read(SAMPLES / RAW.format("ordered"), **PIXELS).frames[0]
    up = read(SAMPLES / SCALED.format("ordered"), **UM).frames[0]
    assert np.array_equal(raw.good, up.good)
    good = raw.good  # bad vectors were replaced in one of the files
    for name in ("x", "y", "vx", "vy"):
        assert np.allclose(getattr(raw, name)[good], getattr(up, name)[good], rtol=1e-3, atol=2e-3)


@pytest.mark.parametrize("file", ["pivlab_pixels.txt", "pivlab_metres.txt", "pivlab_v7.mat", "fiji_piv.txt"])
def test_other_piv_files_are_the_same_vectors(file):
    raw = read(SAMPLES / RAW.format("ordered"), **PIXELS).frames[0]
    other = read(SAMPLES / file, frame_s=0.3, y="down").frames[0]
    both = raw.good & other.good
    assert both.sum() > 180
    for name in ("x", "y"):
        assert np.allclose(getattr(raw, name), getattr(other, name), atol=0.01)
    for name in ("vx", "vy"):
        assert np.allclose(getattr(raw, name)[both], getattr(other, name)[both], atol=0.02)


def test_pivlab_tells_its_calibration():
    seen = read(SAMPLES / "pivlab_metres.txt", y="down")
    assert seen.pixel_um == pytest.approx(5.0)
    assert seen.frame_s == pytest.approx(0.3, rel=1e-4)
    assert any("0.3 s" in note for note in seen.notes)


@pytest.mark.parametrize(
    ("file", "said"),
    [
        ("trackmate_spots.csv", {"pixel_um": 5.0}),
        ("trackmate_tracks.xml", {"pixel_um": 5.0}),
        ("trackpy_links.csv", {"frame_s": 0.3}),
    ],
)
def test_tracks_end_in_the_run(file, said):
    """Each velocity, at the middle of its link."""
    seen = read(SAMPLES / file, **said).view(**VIEW)
    assert seen.time_unit == "s"
    assert seen.frame_s == pytest.approx(0.3)
    off = []
    for frame in seen.frames:
        theta, z, cos_phi = seen.camera.to_surface(frame.x, frame.y)
        u = np.stack(seen.camera.velocity_to_surface(frame.x, frame.y, frame.vx, frame.vy)) * SCALES.time_s
        off.append(np.abs(u - at(truth("u_ordered"), theta, z))[:, cos_phi > 0.5])
    across, along = np.concatenate(off, axis=1) / np.hypot(*truth("u_ordered")).max()
    assert along.size > 400
    assert np.median(across) < 0.02
    assert np.median(along) < 0.025
    assert np.isfinite(seen.on_surface()["u"]).sum() > 200


def test_optical_flow_is_row_and_column():
    said = {"order": "row,col", "step_px": 6.0, "frame_s": 0.3}
    file = "optical_flow_skimage_rowcol_every6px.npy"
    for part in errors(surface(file, **said), "u_ordered"):
        assert np.median(part) < 0.01
    with refused("order", "row,col", "x,y"):
        read(SAMPLES / file, step_px=6.0)


@pytest.mark.parametrize(
    ("file", "said"),
    [
        ("orientationj_vector_table.csv", {}),
        (
            "orientationpy_theta_degrees_every6px.npy",
            {"format": "angles", "step_px": 6.0, "origin_px": (3.0, 3.0)},
        ),
    ],
)
def test_angles_of_filaments(file, said):
    data = surface(file, scales=None, **said)
    theta, z = np.meshgrid(data["theta"].values, data["z"].values, indexing="ij")
    P = at(truth("P_ordered"), theta, z)
    off = np.degrees(np.abs((data["angle"].values[0] - np.arctan2(*P) + np.pi / 2) % np.pi - np.pi / 2))
    used = np.isfinite(off) & (np.cos(theta - np.pi) > 0.35)
    assert used.sum() > 500
    assert np.median(off[used]) < 3.0
    with refused("polarity"):
        cy.observations.compare(data, run_of("u_ordered"))


@tiff
def test_kymograph():
    seen = read(SAMPLES / "kymograph_imagej.tif", format="kymograph", frame_s=0.3)
    assert seen.pixel_um == pytest.approx(6.25)
    slope = kymograph_truth()["slope_um_per_s"]
    found = cy.observations.line_speeds(seen.image)
    assert found.mean * 6.25 / 0.3 == pytest.approx(slope, abs=1.0)
    parts = cy.observations.line_speeds(seen.image, columns=4, rows=2)
    assert np.allclose(parts.speed * 6.25 / 0.3, slope, atol=1.5)
    with refused("frame_s"):
        read(SAMPLES / "kymograph_imagej.tif", format="kymograph")
    with refused("kymograph", "slice"):
        read(SAMPLES / "kymograph_imagej.tif")


@tiff
def test_a_kymograph_along_the_cell_is_a_line_of_its_surface():
    line = ((0.0, 40.0), (399.0, 40.0))
    seen = read(SAMPLES / "kymograph_imagej.tif", format="kymograph", frame_s=0.3, line_px=line)
    data = seen.view(radius_px=80.0, axis_deg=0.0, centre_px=(0.0, 0.0), mirrored=False).on_surface()
    u = data["u"].isel(time=0)
    assert np.isnan(u.sel(component="theta")).all()
    assert u.sel(component="z").mean().item() == pytest.approx(-93.8 / (6.25 * 80.0), rel=0.02)
    with refused("along the cell or across it"):
        seen.view(radius_px=80.0, axis_deg=20.0, centre_px=(0.0, 0.0)).on_surface()


@tiff
def test_cross_section():
    pixel = 500 * 2.2 / 64
    seen = read(SAMPLES / "mrv_axial_mm_per_s.tif", format="slice", speed="mm/s", pixel_um=pixel)
    view = {"radius_px": 64 / 2.2, "axis_deg": 0.0, "centre_px": (31.5, 31.5), "facing": 0.0}
    data = seen.view(**view, mirrored=False).on_surface(n_theta=64, scales=SCALES)
    along = data["u"].values[0, 1, :, 0]
    assert np.abs(along - truth("u_ordered")[1].mean(axis=1)).max() < 0.04


@tiff
def test_axis_and_radius_from_the_image():
    import tifffile

    found = cy.observations.rim(tifffile.imread(SAMPLES / "openpiv_ordered_pair.tif"))
    assert found.axis_deg == pytest.approx(17.0, abs=0.2)
    assert found.radius_px == pytest.approx(100.0, abs=2.0)
    x, y = found.on_axis_px[0] + 20 - 30, found.on_axis_px[1] + 40 - 225
    assert abs(x * np.sin(np.radians(17.0)) + y * np.cos(np.radians(17.0))) < 1.0


def test_pivpy_is_read_as_it_is():
    """pivpy 0.4.0 turned OpenPIV's mask round: the file holds zeros in the cell, and noise outside."""
    seen = read(SAMPLES / "pivpy_openpiv.nc", y="up", speed="um/s", pixel_um=5.0)
    raw = read(SAMPLES / SCALED.format("ordered"), **UM)
    frame, good = seen.frames[0], seen.frames[0].good
    assert np.allclose(frame.vx[good], raw.frames[0].vx[good])
    assert np.allclose(frame.vy[good], raw.frames[0].vy[good])
    assert any("chc" in note for note in seen.notes)
