"""The vacuole's drag: theory against an oracle of its own, and verdicts on made-up ends."""

import numpy as np
import pytest
import scipy.optimize
import xarray

import cyclosis as cy
from cyclosis.experiments import dragged
from cyclosis.experiments import vacuole_passive as subject
from cyclosis.experiments import vacuole_passive_verdict as judged
from cyclosis.models.on_polar import rate_modes
from cyclosis.stability.existence.crossings import existing_from, stable_from
from vacuole_oracle import wave

BETA = 0.3
N = dragged.POINTS
THETA = 2 * np.pi / N * np.arange(N)
M = np.arange(1, N // 2)


def drag(m, q):
    """Return Z, the work of the wall on a solenoidal wave of speed 1, from Stokes flow to sixty digits."""
    a, b = np.array([-q, m]) / np.hypot(m, q)
    stress = wave(m, q, a, b, 1.0)[2]
    return float((stress[0] * a + stress[1] * b).real)


# An oracle: stripes P(θ) e_z by dense matrices, with a flow resisted by 1 + μ m² + β m.


def kernel(values):
    """Return the matrix (n, n) that multiplies wave m of a function on the circle by values[m - 1]."""
    apart = THETA[:, None] - THETA
    return 2 / N * np.einsum("m,mij->ij", values, np.cos(M[:, None, None] * apart))


CURVATURE = kernel(-1.0 * M**2)


SINES = np.sin(np.outer(THETA, M)) * np.sqrt(2 / N)


class Oracle:
    def __init__(self, params, beta):
        self.p, self.mobility = params, kernel(1 / (1 + params.mu * M**2 + beta * M))

    def rate(self, P):
        p = self.p
        torque = p.alpha_p * P + p.alpha_u * (self.mobility @ P**3)
        return p.d_s * (CURVATURE @ P) - p.d_r * P + (1 - P**2) * torque

    def steady(self):
        """Return the odd steady state, by waves sin mθ."""
        zone = np.sqrt(2 * self.p.d_s / (self.p.alpha_p + self.p.alpha_u))
        start = SINES.T @ (0.95 * np.tanh(np.sin(THETA) / zone))
        found, _, status, _ = scipy.optimize.fsolve(
            lambda c: SINES.T @ self.rate(SINES @ c),
            start,
            fprime=lambda c: SINES.T @ self.across(SINES @ c) @ SINES,
            xtol=1e-13,
            full_output=True,
        )
        assert status in (1, 4), "it must have converged, at worst to rounding"
        return SINES @ found

    def across(self, P):
        """δP_z: the flow answers 3P² v, and the torque along P turns v back."""
        p, u = self.p, self.mobility @ P**3
        local = p.alpha_p * (1 - 3 * P**2) - 2 * p.alpha_u * P * u - p.d_r
        answer = 3 * p.alpha_u * (1 - P**2)[:, None] * self.mobility * P**2
        return p.d_s * CURVATURE + np.diag(local) + answer

    def widths(self, P):
        """Return the largest growth rate of even perturbations with a mean over each stripe."""
        waves = np.cos(np.outer(THETA, np.arange(0, N // 2, 2)))
        waves /= np.linalg.norm(waves, axis=0)
        return np.linalg.eigvals(waves.T @ self.across(P) @ waves).real.max()

    def tilt(self, P):
        """δP_theta drives no waves, since ∇·u = 0, but the mean flow <P² v>, which turns the vacuole."""
        p, u = self.p, self.mobility @ P**3
        local = p.alpha_p - p.kappa - p.d_r - P * (p.alpha_p * P + p.alpha_u * u)
        matrix = p.d_s * CURVATURE + np.diag(local) + p.alpha_u * np.tile(P**2 / N, (N, 1))
        return np.linalg.eigvals(matrix).real.max()


@pytest.mark.parametrize("m", [1, 2, 7])
def test_waves_around_the_axis_alone_are_resisted_by_their_number(m):
    assert drag(m, 0) == pytest.approx(m, rel=1e-12)


@pytest.mark.parametrize(("m", "j"), [(1, 0), (2, 0), (1, 1), (2, -3), (0, 2)])
@pytest.mark.parametrize("state", ["disorder", "one stream"])
def test_growth_of_waves_of_the_model_is_that_of_theory_with_drag(state, m, j):
    """About P0 e_z, W = (α_u + iε P0 q) P0²/(k² (1 + μk² + βZ)) acts; without order, nothing."""
    p = cy.Parameters(alpha_p=0.1 if state == "one stream" else 0.03, alpha_u=0.4, mu=0.07)
    grid = cy.CylinderGrid(16, 16, 4.0)
    q = 2 * np.pi / grid.length * j
    k2, ratio = m**2 + q**2, p.d_r / p.alpha_p
    if state == "one stream":
        P0, a = np.sqrt(1 - ratio), p.alpha_p - p.d_r
        W = (p.alpha_u + 1j * p.epsilon * P0 * q) * P0**2 / k2
        W /= 1 + p.mu * k2 + BETA * drag(m, q)
        theory = np.array(
            [
                [-p.d_s * k2 - p.kappa + W * q**2, -3 * m * q * W],
                [-ratio * m * q * W, -p.d_s * k2 - 2 * a + 3 * ratio * m**2 * W],
            ]
        )
    else:
        P0, theory = 0.0, np.diag([p.alpha_p - p.d_r - p.d_s * k2 - p.kappa, p.alpha_p - p.d_r - p.d_s * k2])
    phase = m * grid.theta[:, None] + q * grid.z
    model = cy.models.coupled_model(BETA)
    found = np.empty((2, 2), complex)
    for column in range(2):
        answer = 0
        for sign in (1, -1):
            P = np.zeros((2, *grid.shape))
            P[1] = P0
            P[column] += sign * 1e-4 * np.cos(phase)
            packed = np.fft.ifft2(rate_modes(model.problem(p, grid), P))
            answer = answer + sign * np.stack([packed.real, packed.imag]) / 2e-4
        found[:, column] = 2 * np.mean(answer * np.exp(-1j * phase), axis=(1, 2))
    np.testing.assert_allclose(found, theory, rtol=0, atol=3e-7)


def test_one_stream_breaks_up_where_its_wave_neither_grows_nor_decays():
    weak = subject.WEAK
    P = np.full(N, np.sqrt(1 - weak.d_r / weak.alpha_p))
    for beta in (0.0, BETA):
        at = weak.replace(alpha_u=dragged.breaking_up(weak, beta))
        matrix = Oracle(at, beta).across(P)
        first = np.cos(THETA)
        np.testing.assert_allclose(matrix @ first, 0.0, atol=2e-12)  # m = 1 is the first of all
        assert np.linalg.eigvals(matrix).real.max() < 1e-12


@pytest.mark.parametrize("params", [subject.FIGURE_4, subject.CORNER], ids=["Figure 4", "corner"])
def test_steady_stripes_and_their_growth_rates_are_those_of_the_oracle(params):
    oracle = Oracle(params, BETA)
    P = oracle.steady()
    found = dragged.stripes(params, BETA)
    u = oracle.mobility @ P**3
    assert np.abs(oracle.rate(P)).max() < 1e-11
    assert found.peak_order == pytest.approx(P.max(), abs=1e-10)
    assert found.peak_speed == pytest.approx(u.max(), abs=1e-10)
    assert found.speed == pytest.approx(np.sqrt(np.mean(u**2)), abs=1e-10)
    assert found.tilt == pytest.approx(oracle.tilt(P), abs=1e-9)
    assert found.widths == pytest.approx(oracle.widths(P), abs=1e-9)
    spent = np.mean(u * P**3) - np.mean(u * (u - params.mu * (CURVATURE @ u)))
    assert found.share == pytest.approx(spent / np.mean(u * P**3), abs=1e-9)


def test_without_drag_they_are_those_of_the_theory():
    found, known = dragged.stripes(subject.FIGURE_4, 0.0), cy.stability.cyclosis(subject.FIGURE_4, N)
    assert found.share == 0.0
    assert found.peak_speed == pytest.approx(known.u.max(), abs=1e-10)
    assert [found.tilt, found.widths] == pytest.approx(known.spectrum(3).eigenvalues[1:].real, abs=1e-9)
    assert found.bend == pytest.approx(known.spectrum(1, axial_mode=1).eigenvalues[0].real, abs=1e-9)


def test_thresholds_are_those_of_the_oracle():
    drug, weak = dragged.DraggedStripes(subject.DRUG, BETA), dragged.DraggedStripes(subject.WEAK, BETA)
    fold = existing_from(drug)
    oracle = Oracle(subject.DRUG.replace(alpha_u=fold.alpha_u), BETA)
    P = fold.state.P
    assert np.abs(oracle.rate(P)).max() < 1e-11
    # Where the branch turns back a perturbation of its own kind neither grows nor decays.
    assert np.abs(np.linalg.eigvals(SINES.T @ oracle.across(P) @ SINES)).min() < 1e-6
    rates = []
    for side in (0.99, 1.01):
        oracle = Oracle(subject.WEAK.replace(alpha_u=side * stable_from(weak).alpha_u), BETA)
        rates.append(oracle.widths(oracle.steady()))
    assert rates[0] > 0 > rates[1]
    assert rates[0] == pytest.approx(-rates[1], rel=0.05)


def test_the_drag_at_which_stripes_tilt_is_that_of_the_oracle():
    found = dragged.tilting_drag(subject.CORNER, 0.5)
    oracle = Oracle(subject.CORNER, found)
    assert oracle.tilt(oracle.steady()) == pytest.approx(0.0, abs=1e-6)
    assert np.isnan(dragged.tilting_drag(subject.FIGURE_4, 0.1))
    assert dragged.tilting_drag(subject.CORNER.replace(kappa=0.3), 0.1) == 0.0
    border = dragged.tilting_alpha_p(subject.CORNER, BETA, 0.1, 1.0)
    oracle = Oracle(subject.CORNER.replace(alpha_p=border), BETA)
    assert oracle.tilt(oracle.steady()) == pytest.approx(0.0, abs=2e-4)
    assert np.isnan(dragged.tilting_alpha_p(subject.CORNER, 0.0, 0.1, 1.0))


def test_stripes_that_do_not_exist_are_refused():
    weak = subject.DRUG.replace(alpha_u=0.25)  # above the fold without drag, and below it with
    assert dragged.stripes(weak, 0.0).peak_speed > 0.5
    with pytest.raises(cy.InputError, match="drag of the vacuole"):
        dragged.stripes(weak, BETA)


@pytest.mark.slow
def test_tilted_stripes_without_drag_are_the_drifting_ones():
    params = cy.Parameters(kappa=0.2)
    known = cy.stability.drifting(params, N)
    around, drift = dragged.tilted(params, 0.0)
    assert around == pytest.approx(abs(known.P[0].mean()), abs=1e-9)
    assert drift == pytest.approx(abs(known.drift), abs=1e-9)
    assert dragged.tilted(subject.FIGURE_4, 0.1) == pytest.approx((0.0, 0.0), abs=1e-6)


@pytest.mark.slow
def test_measured_thresholds_and_tilts_are_those_of_theory():
    for measured, theory in (subject.ordering(BETA, 1), subject.breaking(BETA)):
        assert measured == pytest.approx(theory, rel=1e-5)
    measured, theory = subject.leaning(BETA)
    assert measured == pytest.approx(theory, abs=1e-6)


# Made-up ends


def made(ends=(), speed=0.98, usual_speed=0.999, seeds=20):
    """Return data in which some (beta, place) end with kinds (seeds,), and all others in two stripes."""
    beta, places = np.array([0.0, 0.007, 0.3]), 4
    kind = np.full((3, places, seeds), 2)
    kind[:, 0] = 0
    kind[:, 1] = np.arange(seeds) % 2 + 1  # one stream, or two stripes
    for (k, place), given in dict(ends).items():
        kind[k, place] = given
    curve = np.array([0.0, 0.007, 0.3])
    speeds = np.array([1.0, usual_speed, speed])
    grid = cy.CylinderGrid(16, 16)
    P = np.stack([cy.initial.stripes(grid)] * 4)
    frame = ("frame", "component", "theta", "z")
    return xarray.Dataset(
        {
            "P": (frame, P),
            "u": (frame, P),
            "kind": (("beta", "place", "seed"), kind),
            "around": (("beta", "place", "seed"), np.where(kind == 3, 0.2, 0.0)),
            "theory_tilt": (("beta", "place"), np.full((3, places), -0.1)),
            "share": ("curve", [0.0, 0.01, 0.2]),
            "lean": (("curve", "cell", "number"), np.zeros((3, 2, 3))),
            "tilting_drag": ("cell", [0.1814, 0.0268]),
            "edge": (("edge_beta", "edge_alpha_u"), [[np.nan, 0.9], [0.9, 0.7]]),
            "grown": (("what", "grown_beta", "way"), np.ones((4, 3, 2))),
            "peak_speed": ("curve", 0.97 * speeds),
            **dict.fromkeys(judged.COMPARED[1:], ("curve", 0.2 / speeds)),
        },
        {
            "beta": beta,
            "curve": curve,
            "cell": ["figure 4", "corner"],
            "number": ["rate", "around", "drift"],
            "edge_beta": [0.1, 0.3],
            "edge_alpha_u": [0.5, 1.0],
            "what": ["order", "wave", "break-up", "tilt"],
            "grown_beta": curve,
            "way": ["measured", "theory"],
            "place_alpha_p": ("place", [0.025, 0.1, 1.0, 1.0]),
            "place_alpha_u": ("place", [0.5, 0.1, 0.5, 1.0]),
            "place_kappa": ("place", np.full(4, 0.5)),
        },
        {"length": 5.0},
    )


SWAPPED = 2 - np.arange(20) % 2  # every seed ends otherwise, and as many in each kind
TILTED = np.full(20, 3)
MERGED = np.where(np.arange(20) < 16, 1, np.arange(20) % 2 + 1)  # 8 of 10 cells with two stripes lose one


@pytest.mark.parametrize(
    ("data", "outcome"),
    [
        (made(), "agrees"),
        (made({(2, 1): SWAPPED}), "agrees"),  # as other seeds do
        (made({(2, 3): TILTED}), "in part"),
        (made({(2, 1): MERGED}), "in part"),
        (made(speed=0.94), "in part"),
        (made({(1, 3): TILTED, (2, 3): TILTED}), "does not"),
        (made(speed=0.9, usual_speed=0.94), "does not"),
    ],
)
def test_verdict_and_figure_follow_from_the_data(data, outcome):
    assert subject.verdict(data).outcome == outcome
    assert len(subject.draw(data).axes) == 4 + 3


def test_ends_are_compared_seed_by_seed():
    changed, redrawn = judged.changes(made({(2, 1): SWAPPED}), 0.3)
    assert changed.tolist() == [0, 20, 0, 0]
    assert redrawn == pytest.approx(20 * 10 / 19)  # of 19 other seeds 10 end otherwise
    assert not judged.beyond_seeds(made({(2, 1): SWAPPED}), 0.3).any()
    assert judged.beyond_seeds(made({(2, 3): TILTED}), 0.3).tolist() == [False, False, False, True]
    few = np.where(np.arange(20) < 6, 3, 2)  # p = 2 · 2⁻⁶, and 24 kinds and places are tested
    assert not judged.beyond_seeds(made({(2, 3): few}), 0.3).any()
    assert not judged.beyond_seeds(made({(2, 1): MERGED}), 0.3).any()
    assert judged.merged(made({(2, 1): MERGED}), 0.3) == (8, 0)
    assert judged.merged(made({(2, 1): SWAPPED, (2, 3): TILTED}), 0.3) == (10, 10)
    assert judged.mcnemar(8, 0) == pytest.approx(2**-7)
    assert judged.mcnemar(0, 0) == 1.0
    more = np.where(np.arange(20) < 11, 3, 2)
    assert judged.beyond_seeds(made({(2, 3): more}), 0.3).sum() == 1


def test_the_sentence_has_the_numbers():
    data = made({(2, 3): TILTED}, speed=0.8)
    words = subject.verdict(data).measured
    assert "0 of 80 at β = 0.007 (nowhere beyond chance; other seeds: 11)" in words
    assert "20 of 80 at β = 0.3 (beyond chance at 1 of 4 places; other seeds: 11)" in words
    assert "0.999 of their speed at β = 0.007 (a thin layer) and 0.800 at 0.3" in words
    assert "130 of 150 cells" in words  # theory said that the others would not tilt
    assert subject.decisive(data).startswith("0.0268")


def test_places_above_the_border_are_counted():
    # α_p from 0.025 in steps of 0.0513: 2 at 0.9 or more, 6 at 0.7 or more.
    assert judged.tilted_places(made()) == {0.1: 2, 0.3: 8}


def test_kinds_follow_from_regime_and_tilt():
    names = ("disordered", "unidirectional", "cyclosis", "travelling", "cyclosis", "circumferential")
    tilts = (0.0, 0.0, 1e-3, 0.3, 0.1, 0.99)
    assert [subject.kind(*each) for each in zip(names, tilts, strict=True)] == [0, 1, 2, 3, 3, 4]
    assert subject.kind("undecided", 0.0) == subject.kind("multistripe", 0.0) == 5
