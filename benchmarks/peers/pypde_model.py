"""The model in py-pde on its JAX backend: finite differences, classical Runge-Kutta steps, Fourier flow.

With `derivatives = "fourier"` only the grid, the fields and the stepping are py-pde's: the derivatives that
it would take by central differences are then taken by transforms too.
"""

import jax
import jax.numpy as jnp
import numpy as np
import pde

jax.config.update("jax_enable_x64", True)


class Filaments(pde.PDEBase):
    """The filament equation, with the flow that filaments drive."""

    def __init__(self, params, derivatives):
        super().__init__()
        self.params, self.derivatives = params, derivatives

    def evolution_rate(self, state, t=0):
        """Compute with NumPy: not offered."""
        raise NotImplementedError("the JAX backend takes make_evolution_rate")

    def make_evolution_rate(self, state, backend):
        """Return the right-hand side as a function of the array of P."""
        p, grid = self.params, state.grid
        (n, k), (lower, upper) = grid.shape, grid.axes_bounds[1]
        m, q = np.fft.fftfreq(n, 1 / n)[:, None], 2 * np.pi / (upper - lower) * np.arange(k // 2 + 1)
        k2 = m**2 + q**2
        m, q = np.where(2 * abs(m) == n, 0, m), np.where(2 * np.arange(k // 2 + 1) == k, 0, q)
        damping = jnp.where(k2 > 0, 1 / jnp.where(k2 > 0, k2, 1) / (1 + p.mu * k2), 0)
        slopes = grid.make_operator("vector_gradient", bc="periodic", backend=backend)
        laplace = grid.make_operator("vector_laplace", bc="periodic", backend=backend)

        def forward(a):
            return jnp.fft.rfft2(a)

        def backward(*modes):
            return jnp.fft.irfft2(jnp.stack(modes), s=(n, k))

        def flow(P):
            F = forward((P[0] ** 2 + P[1] ** 2) * P)
            stream = damping * 1j * (m * F[1] - q * F[0])
            ut, uz = (1j * q * stream).at[0, 0].set(F[0, 0, 0]), -1j * m * stream
            return backward(ut, uz, 1j * m * ut, 1j * q * ut, 1j * m * uz)

        def by_differences(P):
            dP = slopes(P)
            return dP[:, 0], dP[:, 1], laplace(P)

        def by_fourier(P):
            P_hat = forward(P)
            found = backward(1j * m * P_hat, 1j * q * P_hat, -k2 * P_hat)
            return found[0], found[1], found[2]

        differentiated = by_fourier if self.derivatives == "fourier" else by_differences

        def rate(P, t=0):
            u0, u1, tt, zt, tz = flow(P)
            along_theta, along_z, spread = differentiated(P)
            turned = jnp.stack([P[0] * tt + P[1] * zt, P[0] * tz - P[1] * tt])
            T = p.epsilon * turned + p.alpha_p * P + p.alpha_u * jnp.stack([u0, u1])
            T = T.at[0].add(-p.kappa * P[0])
            T = T - P * (P[0] * T[0] + P[1] * T[1])
            return T - p.epsilon * (u0 * along_theta + u1 * along_z) + p.d_s * spread - p.d_r * P

        return rate


def prepare(params, n, length, dt, derivatives="differences"):
    """Return a function that takes a state P to time t in steps of `dt`."""
    grid = pde.CartesianGrid([[0, 2 * np.pi], [0, length]], [n, n], periodic=True)
    equation = Filaments(params, derivatives)
    solver = pde.RungeKuttaSolver(equation, adaptive=False, backend="jax")
    first = pde.VectorField(grid)
    step = solver.make_stepper(first, dt)

    def advance(state, t_end):
        field = pde.VectorField(grid, state)
        step(field, 0.0, t_end)
        return field.data.copy()

    return advance
