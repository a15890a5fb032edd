"""CFD1 to CFD3 of Turek & Hron: the flow past a cylinder with a rigid flag, against published tables."""

from pathlib import Path

import numpy as np
import pytest

import hofsi

pytestmark = [pytest.mark.verification, pytest.mark.slow]

EXAMPLES = Path(__file__).parents[2] / "examples"
QUIET = ["output.fields=false", "output.plots=false"]


def run(scene, folder, *changes):
    result = hofsi.run(hofsi.load_case(EXAMPLES / f"{scene}.toml", [*changes, *QUIET]), folder)
    assert result.status == "completed"
    return result


@pytest.mark.parametrize(
    ("scene", "drag", "lift"),
    [
        # Featflow, level 6+0: featflow.de, FSI benchmark tables; Turek & Hron, Springer LNCSE 53 (2006) 371-385.
        ("cfd1", 14.2929, 1.11905),
        ("cfd2", 136.700, 10.5343),
    ],
)
def test_steady_forces(scene, drag, lift, tmp_path):
    series = run(scene, tmp_path).series
    assert float(series["drag"][-1]) == pytest.approx(drag, rel=1e-4)
    assert float(series["lift"][-1]) == pytest.approx(lift, rel=1e-4)


def test_linear_steps_follow_newtons_method_into_the_vortex_street(tmp_path):
    """Steps that merely convect with the extrapolated velocity go astray here: other flow, twice the frequency."""
    changes = ("mesh.order=3", "time.end=5.5")
    linear, newton = (
        run("cfd3", tmp_path / mode, f"fluid.convection={mode}", *changes).series["lift"]
        for mode in ("linearised", "newton")
    )
    assert np.ptp(newton[1000:]) > 100.0
    np.testing.assert_allclose(linear, newton, rtol=0.0, atol=0.01 * np.ptp(newton))
