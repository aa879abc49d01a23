"""What last digits depend on besides the code: processor, JAX and NumPy."""

import jax
import numpy as np

from cyclosis.model.programs import programs_folder


def machine():
    """Return a text that is the same where the same code gives the same bits."""
    return f"{programs_folder().name}, {jax.default_backend()}, numpy {np.__version__}"
