"""What `cyclosis measure` does with its options: it reads, shows and writes a measurement."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..model.errors import InputError

if TYPE_CHECKING:
    from ..observations import Observation


def reading(
    files: list[Path],
    format: str | None,
    both: dict[str, Any],
    said: dict[str, Any],
    of_film: dict[str, Any],
    quiet: bool,
) -> Observation:
    """Return the measurement in the files, or in a film, with a bar of what is done unless `quiet`."""
    from ..observations import film, read
    from ..observations.films.reading import is_film
    from ..progress import Bar

    both, said, of_film = ({k: v for k, v in each.items() if v is not None} for each in (both, said, of_film))
    filmed = format == "film" or (format is None and is_film(files[0]))
    other, what = (said, "a film") if filmed else (of_film, "files of vectors, tracks or angles")
    for name, value in other.items():
        option = "--" + {"origin_px": "origin"}.get(name, name).replace("_", "-")
        raise InputError(name, value, f"left out for {what}", f"leave out {option}")
    if not filmed:
        return read(files, format, **both, **said)
    if len(files) > 1:
        raise InputError("file", str(files[1]), "one film", "measure films one by one")
    if "step_px" in both:
        step = both["step_px"]
        both["step_px"] = int(step) if step == int(step) else step
    steady = not of_film.pop("keep_drift", False)
    with Bar("velocities", hidden=quiet) as bar:
        return film(files[0], **both, **of_film, steady_stage=steady, progress=bar)


def on_surface(
    seen: Observation, speed: float | None, max_angle: float | None, outside: str, depth_um: float | None
) -> Any:
    """Return the measurement on the surface. Its warnings are printed, not raised."""
    import warnings

    from ..model.scales import Scales

    scales = None
    if speed is not None:
        if seen.pixel_um is None or seen.camera is None:
            rule = "given with the size of a pixel"
            raise InputError("speed_um_per_s", speed, rule, "give pixel_um", "give --pixel-um UM")
        scales = Scales(seen.camera.radius_px * seen.pixel_um, speed)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)
        return seen.on_surface(
            scales=scales,
            max_angle_deg=80.0 if max_angle is None else max_angle,
            outside=outside,
            depth_um=depth_um,
        )


def say(seen: Observation, data: Any) -> None:
    """Print what was measured, and where on the surface."""
    import numpy as np

    print(seen)
    name = "u" if "u" in data else "angle"
    share = float(data["good"].mean())
    sizes = data.sizes
    low, high = (np.degrees(float(data["theta"][k])) for k in (0, -1))
    print(
        f"On the surface: {sizes['theta']} x {sizes['z']} points, θ from {low:.0f} to {high:.0f} degrees, "
        f"z from {float(data['z'][0]):.2f} to {float(data['z'][-1]):.2f} R, {share:.0%} of them with values."
    )
    if name == "u":
        largest = np.sqrt((data["u"].fillna(0.0) ** 2).sum("component")).max().item()
        unit = {"1": "U", "s-1": "R/s"}.get(data["u"].attrs["units"], "R/frame")
        print(f"Largest speed {largest:.4g} {unit}.")
    if data.attrs.get("warnings"):
        print(f"Warning: {data.attrs['warnings']}.")


def drawn(seen: Observation, data: Any, image: Path | None, depth_um: float | None) -> Any:
    """Return the picture of a measurement, on an image of the cell or on what its film shows."""
    from ..figures import measured
    from ..observations.picture import picture

    shown = seen.image if seen.format == "film" and seen.kind == "velocity" else None
    return measured.measurement(seen, data, shown if image is None else picture(image), depth_um)


def numbers(name: str, text: str | None, count: int | None = None) -> list[float] | None:
    """Return numbers with commas between them. Raises `InputError` for other text."""
    if text is None:
        return None
    try:
        found = [float(part) for part in text.split(",")]
    except ValueError:
        found = []
    if not found or (count is not None and len(found) != count):
        rule = "numbers" if count is None else f"{count} numbers"
        raise InputError(name, text, f"{rule} with commas between them", "write them without spaces")
    return found


def pair(name: str, text: str | None) -> tuple[float, float] | None:
    """Return two numbers. Raises `InputError` for other text."""
    found = numbers(name, text, 2)
    return None if found is None else (found[0], found[1])


def column(text: str) -> tuple[str, Any]:
    """Return the name and the place of a column. Raises `InputError` for other text."""
    name, _, at = text.partition("=")
    if not at:
        raise InputError("columns", text, "names with numbers", "write x=0,y=1,u=2,v=3")
    return name.strip(), int(at) if at.strip().isdigit() else at.strip()
