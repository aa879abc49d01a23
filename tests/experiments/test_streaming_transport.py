"""Transport by straight streams: verdicts on made-up data, and the limit of diffusion."""

import numpy as np
import pytest
import xarray

from cyclosis.experiments.streaming_transport import (
    EXPERIMENT,
    decisive,
    deviations,
    exchange,
    exponents,
    verdict,
)

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
