"""Every script of the gallery runs, leaves its picture, and finds the number that its phenomenon has."""

import importlib.util
from pathlib import Path

import PIL.Image
import pytest

pytestmark = pytest.mark.slow

EXAMPLES = Path(__file__).parents[1] / "examples"


def growth(found):
    assert found["largest difference of a rate from theory"] < 1e-3
    assert found["fastest rate"] == pytest.approx(found["alpha_p - d_r"], rel=1e-3)


def emergence(found):
    assert found["stripes"] == 2
    assert found["width of one stripe"] == pytest.approx(0.5, abs=1e-3)
    assert found["peak speed"] == pytest.approx(found["peak speed in theory"], rel=1e-3)


def cytochalasin(found):
    assert found["speed under the drug, of that before"] == pytest.approx(0.9208, abs=1e-4)
    assert found["the same in theory"] == pytest.approx(0.9208, abs=1e-4)
    assert found["speed once cables are fragmented"] < 1e-6
    assert found["least alpha_u that streams without bundling"] == pytest.approx(0.2267244755, abs=1e-9)


def wound(found):
    assert abs(found["order in the wound, of that before"]) < 0.05
    assert 1.0 < found["time after which nine tenths are back"] < 5.0
    assert found["order at the end, of that before"] == pytest.approx(1.0, abs=0.01)
    assert found["shift of the zones in radians"] < 0.1


def unequal_stripes(found):
    assert found["growth rate at the least alpha_u"] == pytest.approx(found["the same in theory"], rel=1e-3)
    assert found["critical alpha_u, from runs"] == pytest.approx(7.472133664e-3, rel=1e-3)
    assert found["critical alpha_u, in theory"] == pytest.approx(7.472133664e-3, rel=1e-8)


def straightening(found):
    assert found["the same in theory"] == pytest.approx(-0.0541, abs=1e-4)
    assert found["decay rate of the bend"] == pytest.approx(found["the same in theory"], rel=0.01)


def circumferential(found):
    assert found["circumferential"]
    assert found["mean of P around the axis"] == pytest.approx(found["the same in theory"], abs=1e-4)
    assert found["peak speed"] == pytest.approx(found["its theory, the cube of order"], abs=1e-3)


def drifting_stripes(found):
    assert found["the same in theory"] == pytest.approx(5.40121e-3, abs=1e-8)
    assert found["speed of drift"] == pytest.approx(found["the same in theory"], rel=1e-4)
    assert found["mean of P around the axis"] == pytest.approx(found["its theory"], rel=1e-4)


def helix(found):
    assert found["zones"] == 2
    assert found["turns of a zone along the cell"] == 1
    assert found["peak speed"] == pytest.approx(found["the same in theory"], rel=1e-3)


def breaking_up(found):
    assert found["growth rate"] == pytest.approx(found["the same in theory"], rel=1e-3)
    # α_p² (1 + μ)(2a + d_s)/(3 d_r a) at α_p = 0.1, a = 0.075.
    assert found["critical alpha_u"] == pytest.approx(0.01 * 1.05 * 0.175 / (3 * 0.025 * 0.075), rel=1e-9)
    assert found["stripes at the end"] == 2


def two_ends(found):
    assert found["certain of their end"] == found["cells"] == 40
    assert 0.3 < found["share that became cyclosis"] < 0.8
    assert found["share foretold"] >= 0.85


def thresholds(found):
    assert found["least alpha_u at alpha_p = 0.1"] == pytest.approx(7.472133664e-3, rel=1e-8)
    assert found["least alpha_u at alpha_p = 1"] == pytest.approx(5.864021369e-10, rel=1e-8)
    assert found["computed over law of fronts at alpha_p = 1"] == pytest.approx(1.00006, abs=1e-5)
    assert found["fold at alpha_p = 0"] == pytest.approx(0.2267244755, abs=1e-9)


def closure(found):
    # I_1(x)/I_0(x) with x = α_p |P|/d_r, and in the closed equation |P|² = 1 - d_r/α_p.
    assert found["the same in theory"] == pytest.approx(0.83146, abs=1e-5)
    assert found["uniform order at alpha_p = 0.1"] == pytest.approx(found["the same in theory"], abs=5e-4)
    assert found["the same, closed equation"] == pytest.approx(0.75**0.5, rel=1e-12)
    assert found["time to half the order, every angle"] > 2 * found["time to half the order, closed equation"]


def ends(found):
    assert found["least sum of their indices"] == found["greatest sum of their indices"] == 2
    assert found["places without a direction at first"] > 20
    assert found["the same at the end"] == 2
    assert found["two streams"]


def mixing(found):
    assert found["rate of mixing, straight streams"] == pytest.approx(1.8411837813**2, rel=1e-6)
    assert found["its slowest mode"] > 1.4 * found["the same in theory"]
    assert found["rate of mixing, helical streams"] > found["its slowest mode"]


def transport(found):
    assert found["exchange without flow"] == pytest.approx(found["the same in theory"], rel=1e-6)
    assert found["exponent of the Péclet number"] == pytest.approx(0.5, abs=0.03)
    assert found["coefficient of dispersion"] == pytest.approx(7 / 96, rel=1e-9)


def own_film(found):
    assert found["speed U from the film, of the true one"] == pytest.approx(1.0, abs=0.03)
    assert abs(found["rotation of the cell, in radians"]) < 0.02
    assert abs(found["shift along the cell, in radii"]) < 0.02
    assert found["mirror image"] == 0


CHECKS = {
    check.__name__: check
    for check in (
        *(growth, emergence, cytochalasin, wound, unequal_stripes, straightening, circumferential),
        *(drifting_stripes, helix, breaking_up, two_ends, thresholds),
        *(closure, ends, mixing, transport, own_film),
    )
}


def test_every_script_is_checked():
    assert sorted(CHECKS) == sorted(path.stem for path in EXAMPLES.glob("*.py"))


@pytest.mark.parametrize("name", CHECKS)
def test_the_phenomenon_is_there(name, tmp_path):
    if name == "own_film":
        pytest.importorskip("skimage")
    spec = importlib.util.spec_from_file_location(name, EXAMPLES / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    CHECKS[name](module.main(tmp_path))
    with PIL.Image.open(tmp_path / f"{name}.png") as picture:
        assert min(picture.size) > 200
