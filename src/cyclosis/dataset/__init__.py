"""Trajectory <-> xarray <-> NetCDF: one description of the contents of a run serves all three.

Variables: `P` and `u` (time, component, theta, z), the recorded quantities of
`cyclosis.diagnostics.QUANTITIES` (over `time`, or over `record_time` if `record_every` was given), and for
every saved field the angles of the indifferent zones and the widths of the stripes (time, zone; NaN if
there are fewer). Group `restart` holds the stepper's state. Everything is dimensionless, unit "1".
"""

from .convert import load as load
from .convert import open_dataset as open_dataset
from .convert import to_dataset as to_dataset
from .convert import write as write
from .place import check_writable as check_writable
from .run_export import export_run as export_run
from .run_tables import run_table as run_table
from .scaled import with_scales as with_scales
from .tables import write_table as write_table
from .vtk import export_vtk as export_vtk
from .writer import RunWriter as RunWriter
from .writer import resume_file as resume_file

__all__ = [
    "RunWriter",
    "check_writable",
    "export_run",
    "export_vtk",
    "load",
    "open_dataset",
    "resume_file",
    "run_table",
    "to_dataset",
    "with_scales",
    "write",
    "write_table",
]


def __dir__() -> list[str]:
    return sorted(__all__)
