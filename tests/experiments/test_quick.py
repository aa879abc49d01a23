"""All experiments in their quick form, by the numbers that theory and earlier runs pin down."""

from __future__ import annotations

import numpy as np
import pytest

from cyclosis.experiments import NAMES, perform
from cyclosis.experiments.coalescence import crossing
from cyclosis.experiments.droplet import off_theory, spread
from cyclosis.experiments.ends import kinds
from cyclosis.experiments.experiment import OUTCOMES
from cyclosis.experiments.streaming_transport import deviations
from cyclosis.experiments.vacuole_passive_verdict import as_predicted

pytestmark = pytest.mark.slow


def recovery(data):
    back = data["recovered"].values.astype(bool)
    assert back.mean() > 0.7
    assert np.abs(data["width"].values[back] - 0.5).max() < 1e-3


def coalescence(data):
    assert crossing(data["near"].values, data["growth"].values) == pytest.approx(1.0, abs=0.02)


def equal_stripes(data):
    for name in ("alpha_u", "cell_length"):
        count = data[f"stripes_over_{name}"].values
        assert set(np.unique(count)) <= {0, 2}
        assert data[f"uneven_over_{name}"].values[count == 2].max() < 1e-6
    assert data["theory_rate"].values == pytest.approx([0.0139, 0.06407], abs=1e-4)


def twist(data):
    assert data["helix_speed"].values == pytest.approx(data["helix_theory"].values, rel=2e-3)


def myosin_inhibition(data):
    assert set(np.unique(data["control_regime"].values)) == {2}
    assert np.abs(data["control_width"].values - 0.5).max() < 1e-3
    assert data["growth"].values.min() > 0


def circumferential(data):
    around = np.abs(data["mean_P_theta"].sel(treatment="lost").values)
    assert np.median(around) == pytest.approx(float(data["theory_order"]), abs=2e-3)
    slope, start = np.polyfit(data["growing_alpha_u"].values, data["growth"].values, 1)
    assert -start / slope == pytest.approx(float(data["theory_tilt"]), rel=5e-3)


def weak_repulsion(data):
    assert np.abs(data["speed"].values - data["theory_speed"].values[:, None]).max() < 1e-3
    assert float(data["theory_upright"]) == pytest.approx(0.4707, abs=1e-3)
    assert float(data["theory_round"]) == pytest.approx(0.0484, abs=1e-3)


def force_law(data):
    strength = data["weak_alpha_u"].values
    linear = data["growth"].values[0].mean(axis=1)
    slope, start = np.polyfit(strength, linear, 1)
    assert -start / slope == pytest.approx(float(data["theory_onset"]), rel=0.02)
    assert float(data["theory_fold"]) == pytest.approx(0.22672, abs=1e-4)


def cytochalasin(data):
    left, fold = data["left"].values, data["fold"].values[:, None]
    strength = data["map_alpha_u"].values[None]
    assert np.all(left[np.broadcast_to(strength > 1.2 * fold, left.shape)] > 0.3)
    assert np.all(left[np.broadcast_to(strength < 0.8 * fold, left.shape)] < 1e-2)


def surviving_seeds(data):
    assert np.all(np.abs(data["thinned_shift"].values) <= np.pi + 1e-6)


def emergence(data):
    order = data["order"].values
    assert np.all(order[:, 0] < 0.1)
    assert np.median(order[:, -1]) > 0.85
    assert np.median(data["domain_size"].values[:, -1]) > np.median(data["domain_size"].values[:, 3])


def ablation(data):
    fate = data["fate"].sel(start="disorder")
    everything, unbundled = (np.unique(fate.sel(tried=name)) for name in ("everything", "without bundling"))
    assert everything.size == unbundled.size == 1
    assert everything != unbundled
    assert not np.any(fate.sel(tried="only flow alignment") == everything)


def timescales(data):
    found = [float(data[f"paper_{name}_s"]) for name in ("procession", "vesicle", "detachment")]
    assert found == pytest.approx([0.1, 0.3934, 1.0], abs=1e-4)


def wound(data):
    healed = data["measured"].sel(measure="healed after").values[data["drug"].values == "none"]
    assert np.all(healed[0] < 5)
    assert data["by_old_flow"].values == pytest.approx(1.6, abs=0.1)


def shear_straightening(data):
    at = int(np.argmin(np.abs(data["epsilon"].values - 0.1)))
    assert data["slowest"].values[at] == pytest.approx(0.0541, abs=5e-4)


def cell_shape(data):
    five = float(data["theory_rate"].sel(length=5.0))
    assert five == pytest.approx(0.0541, abs=5e-4)
    assert np.nanmax(data["tail"].values) < 0.02


def mixing(data):
    straight = data.sel(pitch=np.inf)
    assert straight["sherwood"].values == pytest.approx(5.783185963, rel=1e-6)
    assert straight["mixing"].values == pytest.approx(3.389957716, rel=1e-6)
    assert straight["dispersion"].values == pytest.approx(0.0948727009, rel=1e-6)
    assert np.all(np.abs(np.hypot(*data["crossing"].values.T)) < 1)


def streaming_transport(data):
    assert float(data["diffusion"]) == pytest.approx(0.6659853510, rel=1e-8)
    assert data["exchange"].values == pytest.approx([0.672938, 5.995264, 20.632856], rel=2e-6)
    assert data["sherwood"].values == pytest.approx(5.783185963, rel=1e-6)
    assert deviations(data).max() < 4


def vacuole_passive(data):
    beta = data["curve"].values
    assert data["break_up"].values / float(data["break_up"][0]) == pytest.approx(1 + beta / 1.05)
    assert float(data["peak_speed"][0]) == pytest.approx(0.9714276568, abs=1e-9)
    thresholds = data["grown"].isel(what=[0, 1, 2])
    assert thresholds.sel(way="measured").values == pytest.approx(
        thresholds.sel(way="theory").values, rel=1e-5
    )
    assert abs(data["grown"].sel(what="tilt").diff("way")).max() < 1e-6
    right, striped = as_predicted(data)
    assert right == striped > 0


def ends(data):
    assert set(np.unique(kinds(data["end"].sel(alpha_p=1.0, alpha_u=0.5)))) <= {-1, 1}
    leading = data["over_epsilon"].sel(without="nothing", wave="displaced", weak_alpha_u=0.0)
    assert leading.values == pytest.approx([-0.02459, 0.00139, 0.02452], abs=1e-4)
    parts = data["parts"].drop_sel(part=["rate", "push"]).sum("part")
    assert parts.values == pytest.approx(data["parts"].sel(part="rate").values, abs=1e-9)


def droplet(data):
    assert data["theory"].values == pytest.approx([0.966793, 0.915540, 1.114358, 1.0135], abs=1e-4)
    assert off_theory(data, "end") < 1e-4
    assert spread(data) < 1e-4
    assert data["growth"].sel(state="circulation").max() < 1e-4
    assert data["growth"].sel(state="source to sink").max() > 0.1


CHECKS = {
    name.replace("_", "-"): check
    for name, check in list(globals().items())
    if name.replace("_", "-") in NAMES and callable(check)
}


@pytest.mark.parametrize("name", NAMES)
def test_quick_form(name, tmp_path):
    done = perform(name, tmp_path, quick=True)
    assert done.verdict.outcome in OUTCOMES
    assert done.figure.stat().st_size > 50_000
    assert done.file.stat().st_size < 1_000_000
    if name in CHECKS:
        CHECKS[name](done.dataset)
