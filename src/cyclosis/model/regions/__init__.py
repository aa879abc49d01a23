"""Regions of the surface, defined without a grid: boxes, discs, bands, strips, images, and combinations.

A region is a value; `mask(grid)` says which points of a grid lie in it. `~a`, `a | b` and `a & b` are the
complement, the union and the intersection. Angles in radians, lengths in radii; both directions are periodic.

On a `cyclosis.ClosedGrid` z stands for the arc length s along the meridian, from 0 at the south pole to
`grid.surface.meridian_length` at the north pole. A region that wraps around along s holds both
ends of the cell.
"""

# In the order in which they are to be read.
# isort: off
from .shapes import Mask as Mask
from .points import ROUNDING as ROUNDING
from .images import LARGEST_IMAGE as LARGEST_IMAGE
from .images import LARGEST_TEXT as LARGEST_TEXT
from .shapes import Region as Region
from .shapes import Box as Box
from .shapes import Disc as Disc
from .shapes import Band as Band
from .shapes import Strips as Strips
from .images import Image as Image
from .shapes import Complement as Complement
from .shapes import Union as Union
from .shapes import Intersection as Intersection
from .shapes import box as box
from .shapes import disc as disc
from .shapes import band as band
from .shapes import strips as strips
from .images import image as image

__all__ = [
    "LARGEST_IMAGE",
    "LARGEST_TEXT",
    "ROUNDING",
    "Band",
    "Box",
    "Complement",
    "Disc",
    "Image",
    "Intersection",
    "Mask",
    "Region",
    "Strips",
    "Union",
    "band",
    "box",
    "disc",
    "image",
    "strips",
]


def __dir__() -> list[str]:
    return sorted(__all__)
