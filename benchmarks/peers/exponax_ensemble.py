"""Many members in Exponax: one program, mapped over some of them at once."""

import exponax as ex
import jax
import jax.numpy as jnp
import numpy as np
from exponax_model import prepare, stepped


def ensemble(params, n, length, dt, batch=1):
    """Return a function that takes many states to time t, `batch` of them at once."""
    if batch == 1:
        advance = prepare(params, n, length, dt)
        return lambda states, t_end: [advance(state, t_end) for state in states]
    run = jax.jit(jax.vmap(stepped(params, n, length, dt), (0, None)))
    back = jax.vmap(lambda modes: ex.ifft(modes, num_spatial_dims=2, num_points=n))

    def advance_all(states, t_end):
        found = []
        for first in range(0, len(states), batch):
            given = jnp.asarray(np.stack(states[first : first + batch]))
            found.extend(np.asarray(back(run(jax.vmap(ex.fft)(given), round(t_end / dt)))))
        return found

    return advance_all
