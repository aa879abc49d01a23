"""Closed cells: shapes, the harmonics of their surfaces, initial states, and defects.

    grid = cyclosis.ClosedGrid(cyclosis.Capsule(length=5.0), k_max=24)
    run = cyclosis.simulate(cyclosis.Parameters(), grid, cyclosis.closed.disordered(grid, seed=1))

In surface harmonics diffusion and the flow are diagonal, and there is no pole trouble. The equations are
in `cyclosis.closed.system`.
"""

from .defects import Defect as Defect
from .defects import defects as defects
from .grid import ClosedGrid as ClosedGrid
from .initial import disordered as disordered
from .initial import from_vectors as from_vectors
from .initial import noise as noise
from .initial import rotation as rotation
from .initial import source_to_sink as source_to_sink
from .initial import swirl as swirl
from .initial import with_noise as with_noise
from .shapes import Capsule as Capsule
from .shapes import Sphere as Sphere
from .shapes import Spheroid as Spheroid

__all__ = [
    "Capsule",
    "ClosedGrid",
    "Defect",
    "Sphere",
    "Spheroid",
    "defects",
    "disordered",
    "from_vectors",
    "noise",
    "rotation",
    "source_to_sink",
    "swirl",
    "with_noise",
]


def __dir__() -> list[str]:
    return sorted(__all__)
