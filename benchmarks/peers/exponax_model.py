"""The model in Exponax: fourth-order exponential steps, on the square domain that it knows."""

import exponax as ex
import jax
import jax.numpy as jnp
import numpy as np

jax.config.update("jax_enable_x64", True)


class Rate(ex.nonlin_fun.BaseNonlinearFun):
    """All but the diffusion of filaments and of their directions."""

    params: dict
    d: jax.Array
    damping: jax.Array

    def __init__(self, params, n, derivative):
        super().__init__(2, n)
        self.params, self.d = params, derivative
        k2 = -jnp.sum(derivative**2, axis=0).real
        self.damping = jnp.where(k2 > 0, 1 / jnp.where(k2 > 0, k2, 1) / (1 + params["mu"] * k2), 0)

    def flow(self, P):
        """Return the Fourier modes of the flow that a state drives."""
        F = self.fft((P[0] ** 2 + P[1] ** 2) * P)
        stream = self.damping * (self.d[0] * F[1] - self.d[1] * F[0])
        return jnp.stack([self.d[1] * stream, -self.d[0] * stream]).at[0, 0, 0].set(F[0, 0, 0])

    def __call__(self, P_hat):
        """Return the Fourier modes of the rate of a state given by its own."""
        P = self.ifft(P_hat)
        u_hat, p, (dt, dz) = self.flow(P), self.params, self.d
        shear = jnp.stack([dt * u_hat[0], dz * u_hat[0], dt * u_hat[1]])
        gradient = jnp.concatenate([dt * P_hat, dz * P_hat])
        u0, u1, tt, zt, tz, Pt0, Pt1, Pz0, Pz1 = self.ifft(jnp.concatenate([u_hat, shear, gradient]))
        u, along_theta, along_z = jnp.stack([u0, u1]), jnp.stack([Pt0, Pt1]), jnp.stack([Pz0, Pz1])
        turned = jnp.stack([P[0] * tt + P[1] * zt, P[0] * tz - P[1] * tt])
        T = p["epsilon"] * turned + p["alpha_p"] * P + p["alpha_u"] * u
        T = T.at[0].add(-p["kappa"] * P[0])
        T = T - P * (P[0] * T[0] + P[1] * T[1])
        return self.fft(T - p["epsilon"] * (u0 * along_theta + u1 * along_z))


class Filaments(ex.BaseStepper):
    """One step of the filament equation."""

    params: dict

    def __init__(self, params, n, dt):
        self.params = params
        super().__init__(2, 2 * np.pi, n, dt, num_channels=2, order=4)

    def _build_linear_operator(self, derivative):
        return self.params["d_s"] * ex._spectral.build_laplace_operator(derivative) - self.params["d_r"]

    def _build_nonlinear_fun(self, derivative):
        return Rate(self.params, self.num_points, derivative)


def stepped(params, n, length, dt):
    """Return a traceable function that takes the modes of P some steps of `dt` on."""
    if not np.isclose(length, 2 * np.pi):
        raise ValueError("Exponax knows square domains only: the length must be 2 pi")
    names = ("epsilon", "alpha_p", "alpha_u", "kappa", "mu", "d_s", "d_r")
    stepper = Filaments({name: getattr(params, name) for name in names}, n, dt)
    return lambda P, steps: jax.lax.fori_loop(0, steps, lambda _, x: stepper.step_fourier(x), P)


def prepare(params, n, length, dt):
    """Return a function that takes a state P to time t in steps of `dt`."""
    run = jax.jit(stepped(params, n, length, dt))

    def advance(state, t_end):
        spectrum = run(ex.fft(jnp.asarray(state)), round(t_end / dt))
        return np.asarray(ex.ifft(spectrum, num_spatial_dims=2, num_points=n))

    return advance
