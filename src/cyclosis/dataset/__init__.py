"""Trajectory <-> xarray <-> NetCDF: one description of what a run leaves serves all.

Variables: `P` and `u` (time, component, theta, z), the recorded quantities of
`cyclosis.diagnostics.QUANTITIES` (over `time`, or over `record_time` if `record_every` was given), and at
every saved field the angles of the indifferent zones and the stripes' widths (time, zone; NaN where
there are fewer). Group `restart` holds the stepper's state. Everything is dimensionless, unit "1".
"""

from .convert import check_writable as check_writable
from .convert import load as load
from .convert import open_dataset as open_dataset
from .convert import to_dataset as to_dataset
from .convert import write as write
from .tables import write_table as write_table
from .vtk import export_vtk as export_vtk
from .writer import RunWriter as RunWriter
from .writer import resume_file as resume_file
