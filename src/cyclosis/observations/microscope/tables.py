"""Records as the tables that programs write: OpenPIV, PIVlab, TrackMate, trackpy, OrientationJ.

The layouts are those of OpenPIV 0.26 (`tools.save`), PIVlab 3 (`file_save.m`, `mat_file_save.m`), TrackMate 7
(`TablePanel.exportToCsv`, `ExportTracksToXML`), trackpy 0.7 and OrientationJ.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from .body import Array

if TYPE_CHECKING:
    from .observe import Recording

Content = dict[str, Callable[[Path], None]]
_OPENPIV = "# x\ty\tu\tv\tflags\tmask\n"
_PIVLAB_FIRST = "PIVlab, ASCII chart output - 01-Jul-2026"


def openpiv(recording: Recording) -> Content:
    """OpenPIV as it measures: pixels, pixels a frame, y down; the first row of the picture first."""
    return _openpiv(recording, 1.0, 1.0, False)


def openpiv_um(recording: Recording) -> Content:
    """OpenPIV after `scaling.uniform` and `transform_coordinates`: µm, µm/s, y up, rows in their order."""
    camera = recording.camera
    return _openpiv(recording, camera.pixel_um, camera.pixel_um / camera.frame_s, True)


def _openpiv(recording: Recording, length: float, speed: float, up: bool) -> Content:
    data = recording.data
    x, y = np.meshgrid(data["x"].values, data["y"].values)
    y = y[::-1] if up else y
    mask = data["mask"].values
    content: Content = {}
    for k in range(data.sizes["time"]):
        vx, vy = data["vx"].values[k], data["vy"].values[k] * (-1 if up else 1)
        columns = [length * x, length * y, speed * vx, speed * vy, data["flag"].values[k], mask]
        # Masked vectors are written as zeros.
        rows = np.stack([np.where(mask & (i in (2, 3)), 0.0, part) for i, part in enumerate(columns)], -1)
        lines = ["\t".join(f"{value:.4e}" for value in row) for row in rows.reshape(-1, 6)]
        content[f"piv_{k + 1:04d}.txt"] = partial(_put, _OPENPIV + "\n".join(lines) + "\n")
    return content


def pivlab(recording: Recording) -> Content:
    """PIVlab's text in pixels and pixels a frame, y down, columns first, NaN where masked."""
    return _pivlab(recording, 1.0, 1.0, "px", "px/frame")


def pivlab_m(recording: Recording) -> Content:
    """PIVlab's text in metres and metres a second."""
    camera = recording.camera
    length = camera.pixel_um * 1e-6
    return _pivlab(recording, length, length / camera.frame_s, "m", "m/s")


def _pivlab(recording: Recording, length: float, speed: float, unit: str, of_speed: str) -> Content:
    data = recording.data
    x, y = (part.T for part in np.meshgrid(data["x"].values, data["y"].values))
    names = f"x [{unit}],y [{unit}],u [{of_speed}],v [{of_speed}],Vector type [-]"
    content: Content = {}
    for k in range(data.sizes["time"]):
        first, second = f"cell_{2 * k + 1:04d}.tif", f"cell_{2 * k + 2:04d}.tif"
        factors = f"conversion factor xy (px -> m): {length:.6g}, "
        factors += f"conversion factor uv (px/frame -> m/s): {speed:.6g}"
        head = [_PIVLAB_FIRST, f"FRAME: {k + 1}, filenames: {first} & {second}, {factors}", names]
        u, v = speed * data["vx"].values[k].T, speed * data["vy"].values[k].T
        kind = _types(recording, k).T
        rows = zip(*(part.ravel() for part in (length * x, length * y, u, v, kind)), strict=True)
        lines = [f"{a:.8g},{b:.8g},{_nan(c)},{_nan(d)},{e:d}" for a, b, c, d, e in rows]
        content[f"PIVlab_{k + 1:04d}.txt"] = partial(_put, "\r\n".join([*head, *lines]) + "\r\n")
    return content


def _types(recording: Recording, k: int) -> Any:
    """Return PIVlab's types of vectors: 0 masked, 1 measured, 2 replaced."""
    data = recording.data
    return np.where(data["mask"].values, 0, np.where(data["flag"].values[k], 2, 1))


def pivlab_mat(recording: Recording) -> Content:
    """PIVlab's session export (MATLAB 7): cells of one matrix a frame, plain matrices for one frame."""
    data, count = recording.data, recording.data.sizes["time"]
    x, y = np.meshgrid(data["x"].values, data["y"].values)

    def cells(parts: list[Array]) -> Any:
        if count == 1:
            return parts[0]
        out = np.empty((count, 1), dtype=object)
        for k, part in enumerate(parts):
            out[k, 0] = part
        return out

    empty = cells([np.zeros((0, 0))] * count)
    kinds = [_types(recording, k).astype(float) for k in range(count)]
    content = {
        "x": cells([x] * count),
        "y": cells([y] * count),
        "u_original": cells(list(data["vx"].values)),
        "v_original": cells(list(data["vy"].values)),
        "typevector_original": cells(kinds),
        **{
            f"{name}_{state}": empty
            for state in ("filtered", "smoothed")
            for name in ("u", "v", "typevector")
        },
        "calxy": 1.0,
        "calu": 1.0,
        "calv": 1.0,
        "units": "[px] respectively [px/frame]",
    }

    def put(path: Path) -> None:
        from scipy.io import savemat

        with open(path, "wb") as file:
            savemat(file, content)

    return {"PIVlab.mat": put}


def flow_npy(recording: Recording) -> Content:
    """Displacements as scikit-image's optical flow has them: (2, rows, columns), the first along rows."""
    data = recording.data
    return {
        f"flow_{k + 1:04d}.npy": partial(
            save_npy, np.stack([data["vy"].values[k], data["vx"].values[k]]).astype(np.float32)
        )
        for k in range(data.sizes["time"])
    }


def trackmate(recording: Recording) -> Content:
    """TrackMate's table of spots: four rows of names, long names, short names and units."""
    names = "LABEL,ID,TRACK_ID,QUALITY,POSITION_X,POSITION_Y,POSITION_Z,POSITION_T,FRAME,RADIUS,VISIBILITY"
    long = "Label,Spot ID,Track ID,Quality,X,Y,Z,T,Frame,Radius,Visibility"
    short = "Label,Spot ID,Track ID,Quality,X,Y,Z,T,Frame,R,Visibility"
    units = ",,,(quality),(micron),(micron),(micron),(sec),,(micron),"
    data, camera = recording.data, recording.camera
    lines = [names, long, short, units]
    radius = 2.0 * camera.pixel_um
    for k, (track, frame, x, y, quality) in enumerate(_spots(recording)):
        at = f"{x * camera.pixel_um:.5f},{y * camera.pixel_um:.5f},0.0,{frame * camera.frame_s:.5f}"
        lines.append(f"ID{1000 + k},{1000 + k},{track},{quality:.4f},{at},{frame},{radius:.3f},1")
    assert len(lines) == 4 + data.sizes["spot"]
    return {"spots.csv": partial(_put, "\n".join(lines) + "\n")}


def _spots(recording: Recording) -> list[tuple[int, int, float, float, float]]:
    parts = [recording.data[name].values for name in ("track", "frame", "x", "y", "quality")]
    return [(int(a), int(b), float(c), float(d), float(e)) for a, b, c, d, e in zip(*parts, strict=True)]


def trackmate_xml(recording: Recording) -> Content:
    """TrackMate's tracks in XML; t counts frames."""
    camera = recording.camera
    tracks: dict[int, list[tuple[int, float, float]]] = {}
    for track, frame, x, y, _ in _spots(recording):
        tracks.setdefault(track, []).append((frame, x * camera.pixel_um, y * camera.pixel_um))
    lines = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        f'<Tracks nTracks="{len(tracks)}" spaceUnits="micron" frameInterval="{camera.frame_s:g}" '
        'timeUnits="sec" generationDateTime="Sat, 28 Nov 2026 20:20:00" from="TrackMate v7.14.0">',
    ]
    for spots in tracks.values():
        lines.append(f'  <particle nSpots="{len(spots)}">')
        lines += [f'    <detection t="{t}" x="{x:.5f}" y="{y:.5f}" z="0.0" />' for t, x, y in spots]
        lines.append("  </particle>")
    return {"tracks.xml": partial(_put, "\n".join([*lines, "</Tracks>"]) + "\n")}


def trackpy(recording: Recording) -> Content:
    """The table of trackpy: y before x, in pixels, sorted by frame."""
    names = ",y,x,mass,size,ecc,signal,raw_mass,ep,frame,particle"
    spots = sorted(_spots(recording), key=lambda spot: (spot[1], spot[0]))
    lines = [
        f"{k},{y!r},{x!r},{40 * quality:.6f},1.9,0.2,{2 * quality:.6f},{300 * quality:.1f},0.02,"
        f"{frame},{track}"
        for k, (track, frame, x, y, quality) in enumerate(spots)
    ]
    return {"trackpy.csv": partial(_put, "\n".join([names, *lines]) + "\n")}


def orientationj(recording: Recording) -> Content:
    """OrientationJ's vector table: angles counter-clockwise with y up, places with y down, DX = -cos."""
    from .images import textures

    data, step = recording.data, int(recording.data.attrs["step_px"])
    content: Content = {}
    for k in range(data.sizes["time"]):
        lines, number = [" ,X,Y,Slice,DX,DY,Orientation,Coherency,Energy"], 0
        angle, coherency, energy = (data[n].values[k] for n in ("angle", "coherency", "energy"))
        for row in range(step // 4, angle.shape[0], step):
            for column in range(step // 4, angle.shape[1], step):
                number += 1
                here = float(angle[row, column])
                dx, dy = -np.cos(np.radians(here)), np.sin(np.radians(here))
                values = (
                    f"{dx:.4f},{dy:.4f},{here:.4f},{coherency[row, column]:.4f},{energy[row, column]:.4f}"
                )
                lines.append(f"{number},{column},{row},{k},{values}")
        content[f"orientationj_{k + 1:04d}.csv"] = partial(_put, "\n".join(lines) + "\n")
    return content | textures(recording)


def save_npy(values: Any, path: Path) -> None:
    """Write an array; NumPy would add a suffix to the name of a temporary file."""
    with open(path, "wb") as file:
        np.save(file, values)


def _nan(value: float) -> str:
    return "NaN" if np.isnan(value) else f"{value:.8g}"


def _put(text: str, path: Path) -> None:
    path.write_bytes(text.encode())
