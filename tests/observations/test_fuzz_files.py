"""Damaged files: every one is refused in a sentence, or read as what it still says, with its signs."""

import warnings

import numpy as np
import pytest

import cyclosis as cy
from measured import HAS_TIFFFILE, SAMPLES

FILES = {
    "openpiv_ordered_raw_pixels_y_down.txt": {"y": "down", "speed": "px/s"},
    "pivlab_metres.txt": {"y": "down"},
    "pivlab_v7.mat": {"y": "down"},
    "fiji_piv.txt": {},
    "trackmate_spots.csv": {"pixel_um": 5.0},
    "trackmate_tracks.xml": {"pixel_um": 5.0},
    "trackpy_links.csv": {},
    "orientationj_vector_table.csv": {},
    "optical_flow_skimage_rowcol_every6px.npy": {"order": "row,col"},
    "pivpy_openpiv.nc": {"y": "up", "speed": "um/s", "pixel_um": 5.0},
    "kymograph_imagej.tif": {"format": "kymograph", "frame_s": 0.3},
}
CASES = 100
"""Damaged copies of every file: 1100 in all."""


def damaged(raw, rng):
    """A copy with bytes changed, cut out, put in or repeated, or the end missing."""
    raw = bytearray(raw)
    how = rng.integers(6)
    at, size = int(rng.integers(len(raw))), int(rng.integers(1, 40))
    if rng.random() < 0.4:
        at = int(rng.integers(min(len(raw), 400)))  # where the header is
    if how == 0:
        raw[at] = int(rng.integers(256))
    elif how == 1:
        for _ in range(20):
            raw[int(rng.integers(len(raw)))] = int(rng.integers(256))
    elif how == 2:
        del raw[at:]
    elif how == 3:
        del raw[at : at + size]
    elif how == 4:
        raw[at:at] = bytes(rng.integers(0, 256, size, dtype=np.uint8))
    else:
        raw[at:at] = raw[at : at + 10 * size]
    return bytes(raw)


def sign(seen, before):
    """The correlation of the velocities with those before, where both have the same grid."""
    a, b = seen.frames[0], before.frames[0]
    if a.vx is None or a.vx.shape != b.vx.shape:
        return 1.0
    both = a.good & b.good
    x, y = (np.concatenate([f.vx[both], f.vy[both]]) for f in (a, b))
    x = np.clip(x, *np.nanquantile(y, (0.01, 0.99))) if y.size else x
    return 1.0 if x.size < 20 else float(x @ y) / max(np.sqrt((x @ x) * (y @ y)), 1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("file", FILES)
def test_damaged_files_never_give_a_traceback_nor_another_sign(tmp_path, file):
    if file.endswith(".tif") and not HAS_TIFFFILE:
        pytest.skip("tifffile is not installed: pip install cyclosis[data]")
    raw, said = (SAMPLES / file).read_bytes(), FILES[file]
    before = cy.observations.read(SAMPLES / file, **said)
    rng, sentences = np.random.default_rng(0), []
    path = tmp_path / file
    for case in range(CASES):
        path.write_bytes(damaged(raw, rng))
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                seen = cy.observations.read(path, **said)
        except cy.InputError as error:
            sentences.append(str(error))
            continue
        repr(seen)
        if seen.frames and before.frames:
            assert sign(seen, before) > 0.5, case
    assert len(sentences) > 5
    assert all(len(sentence.splitlines()) == 1 for sentence in sentences)


@pytest.mark.slow
def test_noise_is_no_file(tmp_path):
    """Random bytes, random text, and the first bytes of binary formats with noise after them."""
    rng, path = np.random.default_rng(1), tmp_path / "noise.dat"
    starts = (
        b"",
        b"II*\0",
        b"\x93NUMPY\x01\0",
        b"MATLAB 5.0",
        b"\x89HDF\r\n\x1a\n",
        b"CDF\x01",
        b"<Tracks",
        b"# x\ty\tu\tv\n",
    )
    for case in range(400):
        letters = np.frombuffer(b"0123456789.,;-e \t\nxyuv#", dtype=np.uint8)
        size = int(rng.integers(1, 2000))
        body = rng.integers(0, 256, size, dtype=np.uint8) if case % 2 else rng.choice(letters, size)
        path.write_bytes(starts[case % len(starts)] + bytes(body))
        with pytest.raises(cy.InputError):
            cy.observations.read(path, y="down", speed="px/s", order="x,y", format=None)
