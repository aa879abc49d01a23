"""Measured cells: what a camera sees of one, and what it saw.

seen = cy.observations.read("field.txt", y="down", speed="px/s")     # PIV, tracks, angles, ...
seen = seen.view(radius_px=100.0, axis_deg=17.0, centre_px=(30.0, 225.0), mirrored=False)
data = seen.on_surface()                                             # an xarray.Dataset like a run's
"""

from .compare import Comparison as Comparison
from .compare import compare as compare
from .film import film as film
from .formats import FORMATS as FORMATS
from .kymograph import LineSpeeds as LineSpeeds
from .kymograph import line_speeds as line_speeds
from .microscope.observe import Recording as Recording
from .microscope.observe import observe as observe
from .observation import Frame as Frame
from .observation import Observation as Observation
from .observation import gridded as gridded
from .read import read as read
from .rim import Rim as Rim
from .rim import rim as rim
from .surface import on_surface as on_surface
from .view import View as View

__all__ = [
    "FORMATS",
    "Comparison",
    "Frame",
    "LineSpeeds",
    "Observation",
    "Recording",
    "Rim",
    "View",
    "compare",
    "film",
    "gridded",
    "line_speeds",
    "observe",
    "on_surface",
    "read",
    "rim",
]


def __dir__() -> list[str]:
    return sorted(__all__)
