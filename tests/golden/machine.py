"""What last digits depend on besides the code: processor, JAX, NumPy. Every kind of machine has records."""

from pathlib import Path

import jax
import numpy as np

from cyclosis.model.programs import programs_folder

RECORDS = Path(__file__).parent / "records"


def machine():
    """Return a name that is the same where the same code gives the same bits."""
    return f"{programs_folder().name}-{jax.default_backend()}-numpy-{np.__version__}"


def file_of(folder, case):
    """Return the file of a case in a folder of records."""
    return folder / f"{case.replace(' ', '-')}.npz"


def kinds():
    """Return the folders of all machines that have records."""
    return sorted(path for path in RECORDS.iterdir() if path.is_dir())
