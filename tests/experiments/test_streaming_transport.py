"""Transport by straight streams: verdicts on made-up data, and the limit of diffusion."""

import numpy as np
import pytest
import xarray

from cyclosis.experiments.streaming_transport import (
    EXPERIMENT,
    WAVENUMBER,
    decisive,
    deviations,
    exchange,
    exponents,
    verdict,
)
from cyclosis.model.parameters import Parameters
from cyclosis.stability import cyclosis

PECLETS = np.array([1.0, 100.0, 1000.0, 5000.0])
DIFFUSION, TAYLOR = 0.666, 0.095


def made(factor=31.0, exponent=0.5, off=1.0, gain=1.0):
    """Return data with so much exchange at Pe = 1000, an exponent, and walks some errors off."""
    flux = DIFFUSION * factor * (PECLETS / 1000.0) ** exponent
    walked = np.array([10.0, 50.0])
    spread = 1 + TAYLOR * walked**2
    return xarray.Dataset(
        {
            "exchange": ("peclet", flux),
            "sherwood": ("peclet", 5.783186 * np.array([1.0, 1.0, 1.0, gain])),
            "walked": ("walk_peclet", spread + 0.3 * np.array([-1.0, off])),
            "walked_error": ("walk_peclet", np.full(2, 0.3)),
            "diffusion": DIFFUSION,
            "coefficient": TAYLOR,
            "chara_peclet": ("substance", [50.0, 500.0, 5000.0]),
        },
        coords={"peclet": PECLETS, "walk_peclet": walked},
    )


@pytest.mark.parametrize(
    ("data", "outcome"),
    [
        (made(gain=1.2), "agrees"),
        (made(), "in part"),
        (made(gain=1.05), "in part"),
        (made(factor=9.0), "does not"),
        (made(exponent=0.42), "does not"),
        (made(exponent=0.58), "does not"),
        (made(off=4.5), "does not"),
    ],
)
def test_verdict_and_figure_follow_from_the_data(data, outcome):
    assert verdict(data).outcome == outcome
    assert len(EXPERIMENT.draw(data).axes) == 3


def test_the_sentence_has_the_numbers():
    words = verdict(made(off=2.5)).measured
    assert "31.0 times that of diffusion at Pe = 1000 and grows as Pe^0.50 up to Pe = 5000" in words
    assert "238 D for small molecules in Chara (Pe = 50)" in words  # 1 + 0.095 * 50²
    assert "within 2.5 standard errors" in words
    assert decisive(made(factor=12.34)).startswith("12.3 times")


def test_exponents_and_deviations():
    np.testing.assert_allclose(exponents(made(exponent=0.37)), 0.37)
    np.testing.assert_allclose(deviations(made(off=-3.0)), [1.0, 3.0])


def test_without_much_flow_bands_exchange_as_by_diffusion():
    """The limit Pe → 0 is q I_1(q)/I_0(q), and a uniform wall takes up as without flow at every Pe."""
    flux, uptake = exchange(0.01)
    assert flux == pytest.approx(0.6659853510, rel=1e-4)
    assert uptake == pytest.approx(5.783185963, rel=1e-7)


def on_the_disc(amplitudes, peclet, q, n_r, n_theta):
    """Return the mean flux into c e^{iqz}, c = 1 on the wall, by collocation on whole diameters.

    Points are Chebyshev's along diameters and even around the axis, so that r = 0 is not special:
    Trefethen, Spectral Methods in MATLAB (2000), chapter 11. The flow is a sum of r^m sin mθ.
    """
    r = np.cos(np.pi * np.arange(n_r + 1) / n_r)
    weight = np.r_[2, np.ones(n_r - 1), 2] * (-1.0) ** np.arange(n_r + 1)
    apart = r[:, None] - r + np.eye(n_r + 1)
    D = np.outer(weight, 1 / weight) / apart
    D -= np.diag(D.sum(axis=1))
    near, far = np.arange(1, (n_r + 1) // 2), np.arange(n_r - 1, (n_r - 1) // 2, -1)
    theta = 2 * np.pi / n_theta * np.arange(n_theta)
    same, opposite = np.eye(n_theta), np.roll(np.eye(n_theta), n_theta // 2, axis=1)
    m = np.fft.fftfreq(n_theta, 1 / n_theta)
    bend = np.fft.ifft(-(m[:, None] ** 2) * np.fft.fft(same, axis=0), axis=0).real
    second = D @ D + D / np.where(np.abs(r) > 0, r, 1.0)[:, None]
    L = np.kron(second[np.ix_(near, near)], same) + np.kron(second[np.ix_(near, far)], opposite)
    L += np.kron(np.diag(r[near] ** -2), bend)
    u = sum(b * np.outer(r[near] ** k, np.sin(k * theta)) for k, b in amplitudes.items()).ravel()
    lost = q**2 + 1j * q * peclet * u
    y = np.linalg.solve(L - np.diag(lost), lost).reshape(near.size, n_theta)
    return abs((D[0, near] @ y + D[0, far] @ y @ opposite.T).mean())


def test_bands_exchange_as_much_as_on_the_disc():
    waves = np.fft.rfft(cyclosis(Parameters()).u, norm="forward")
    amplitudes = {m: -2 * waves[m].imag for m in range(1, 20, 2)}
    exact = on_the_disc(amplitudes, 30.0, WAVENUMBER, 31, 28)
    assert exact == pytest.approx(on_the_disc(amplitudes, 30.0, WAVENUMBER, 25, 24), rel=1e-4)
    assert exchange(30.0)[0] == pytest.approx(exact, rel=1e-5)
