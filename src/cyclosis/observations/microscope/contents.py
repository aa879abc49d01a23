"""Records as datasets: names, dimensions and units."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import xarray

    from .camera import Camera

FIELDS: dict[str, dict[str, tuple[tuple[str, ...], str, str]]] = {
    "piv": {
        "vx": (("time", "y", "x"), "velocity to the right", "px/frame"),
        "vy": (("time", "y", "x"), "velocity downwards", "px/frame"),
        "flag": (("time", "y", "x"), "whether the vector is wrong", "1"),
        "mask": (("y", "x"), "whether the window sees too little of the cell", "1"),
    },
    "film": {"frames": (("time", "y", "x"), "light", "grey level")},
    "kymograph": {
        "image": (("time", "place"), "light along the line", "grey level"),
        "x": (("place",), "place in the picture, to the right", "px"),
        "y": (("place",), "place in the picture, downwards", "px"),
        "phi": (("place",), "angle from the meridian that faces the camera", "rad"),
        "z": (("place",), "place along the cell", "R"),
    },
    "tracks": {
        "track": (("spot",), "number of the track", "1"),
        "frame": (("spot",), "number of the frame", "1"),
        "x": (("spot",), "place to the right", "px"),
        "y": (("spot",), "place downwards", "px"),
        "quality": (("spot",), "quality of the spot", "1"),
    },
    "orientation": {
        "image": (("time", "y", "x"), "light", "grey level"),
        "angle": (("time", "y", "x"), "angle of the texture, counter-clockwise from the right", "degrees"),
        "coherency": (("time", "y", "x"), "how parallel the texture is", "1"),
        "energy": (("time", "y", "x"), "how much texture there is", "1"),
    },
    "mrv": {
        "speed": (("time", "row", "column"), "velocity along the cell", "mm/s"),
        "inside": (("row", "column"), "whether the pixel is in the cell", "1"),
    },
}
"""The variables of each kind of record, with dimensions, meaning and unit."""
RENAMED = {("mrv", "image"): "speed"}
TITLES = {
    "piv": "Vectors of image velocimetry",
    "film": "Film of particles",
    "kymograph": "Kymograph",
    "tracks": "Tracks of particles",
    "orientation": "Picture of filaments and the angle of its texture",
    "mrv": "Velocity along the cell in a slice",
}


def dataset(kind: str, camera: Camera, ends: tuple[float, float], found: dict[str, Any]) -> xarray.Dataset:
    """Return what an instrument found of a cell between two heights as an `xarray.Dataset`."""
    import xarray

    values = {RENAMED.get((kind, name), name): value for name, value in found.items()}
    times = values.pop("times")
    about = {"long_name": "time of the run", "units": "R/U"}
    coordinates: dict[str, Any] = {"time": ("time", times, about)}
    coordinates["seconds"] = (
        "time",
        (times - times[0]) * camera.scales.time_s,
        {"long_name": "time from the first", "units": "s"},
    )
    if kind == "piv":
        for name, way in (("x", "to the right"), ("y", "downwards")):
            note = {"long_name": f"middle of the window, {way}", "units": "px"}
            coordinates[name] = (name, values.pop(name), note)
    if kind == "kymograph":
        note = {"long_name": "place along the line", "units": "px"}
        coordinates["place"] = ("place", values.pop("place_px"), note)
    fields = {
        name: (dims, values.pop(name), {"long_name": meaning, "units": unit})
        for name, (dims, meaning, unit) in FIELDS[kind].items()
    }
    return xarray.Dataset(fields, coordinates, {"title": TITLES[kind], "ends": list(ends), **values})
