"""The benchmarks run, on the smallest settings, and say what they measured on what."""

from __future__ import annotations

import importlib
from pathlib import Path

import numpy as np
import pytest


def test_every_script_has_a_test(tiny):
    own = {path.stem.removeprefix("test_") for path in Path(__file__).parent.glob("test_*.py")} - {"scripts"}
    scripts = (Path(__file__).parents[2] / "benchmarks").glob("[!_]*.py")
    assert {script.stem for script in scripts} == {*tiny, *own}


def test_results_are_printed_and_written(script_name, measured):
    name = script_name
    found = measured(name)
    result, written, printed = found.result, found.written, found.printed
    assert written["benchmark"] == name
    assert {"settings", "rows", "machine", "versions", "date"} <= written.keys()
    assert written["rows"] == [dict(row) for row in result.rows]
    assert written["versions"]["numpy"]
    for column in result.rows[0]:
        assert column in printed


def test_generation_is_counted_in_copies(measured):
    result = measured("mesh_generation").result
    assert [(row["blocks"], row["gradings"]) for row in result.rows] == [
        (1, "equal"), (1, "different"), (4, "equal"), (4, "different"),
    ]  # fmt: skip
    for row in result.rows:
        assert 1500 < row["nodes"] < 2500
        assert row["regenerate/copy"] > 1.0


def test_the_contest_ranks_the_movers(measured):
    result = measured("mesh_motion").result
    reach = {row["mover"]: row["reach"] for row in result.rows}
    assert reach["pseudo-solid, m = -1"] > reach["pseudo-solid, m = 1 (published)"] > 0.0
    assert reach["barrier, bar"] >= 0.82
    assert reach["barrier, bar"] > reach["Laplace"]
    assert (measured("mesh_motion").folder / "mesh_motion.png").stat().st_size > 10_000


def test_only_what_has_one_mesh_a_position_comes_back(measured):
    result = measured("mesh_motion_return").result
    rows = {(row["layout"], row["mover"]): row for row in result.rows}
    for mover in ("barrier, bar", "barrier, ang", "pseudo-solid, m = -1"):
        assert rows["f4", mover]["after 2"] < 1e-12
        assert rows["f4", mover]["cold - warm"] < 1e-8
    assert rows["f4", "angles, published"]["after 2"] > 1e-2


def test_the_barriers_vertices_move_as_smoothly_as_the_body(measured):
    result = measured("mesh_motion_smoothness").result
    rows = {row["mover"]: row for row in result.rows}
    for mover in ("barrier, bar", "pseudo-solid, m = -1"):
        assert rows[mover]["dt = 1/24"] == pytest.approx(rows[mover]["dt = 1/12"], rel=0.02)
        assert rows[mover]["dt = 1/24"] < 1.5
    assert rows["barrier, bar"]["velocity error"] < 1e-6
    assert rows["angles, best setting"]["dt = 1/24"] > 2.0


def test_the_worst_elements_of_the_flap(measured):
    result = measured("mesh_motion_histograms").result
    rows = {row["mover"]: row for row in result.rows}
    assert rows["barrier, bar"]["worst scaled Jacobian"] > 0.7
    assert rows["barrier, ang, sliding"]["worst scaled Jacobian"] > 0.9


def test_costs_are_in_terms_of_the_barrier(measured):
    result = measured("mesh_motion_cost").result
    assert result.rows[0]["all, barriers"] == 1.0
    assert {row["method"] for row in result.rows} >= {"pseudo-solid", "full-mesh pseudo-solid, refactored"}


def test_errors_of_the_cylinder_fall_with_the_order(measured):
    result = measured("fluid_work_precision").result
    second, fourth = result.rows
    for name in ("c_D", "c_L", "dp"):
        assert fourth[f"error of {name}"] < 0.1 * second[f"error of {name}"]
    assert fourth["error of c_D"] < 1e-3
    assert fourth["largest error"] == max(fourth[f"error of {name}"] for name in ("c_D", "c_L", "dp"))
    assert (measured("fluid_work_precision").folder / "fluid_work_precision.png").stat().st_size > 10_000


def test_the_factor_compares_the_cheapest_runs_that_are_good_enough(measured):
    measured("fluid_work_precision")
    factors = importlib.import_module("_precision").factors
    runs = [
        {"program": program, "order": order, "elements": 9, "s": seconds, "e": error}
        for program, order, seconds, error in (
            ("hofsi", 4, 1.0, 2e-5),
            ("hofsi", 5, 2.0, 3e-7),
            ("hofsi", 6, 1.5, 4e-7),
            ("NGSolve", 4, 5.0, 8e-5),
            ("NGSolve", 5, 12.0, 2e-7),
        )
    ]
    found = {row["error"]: row for row in factors(runs, "s", "e")}
    assert found[1e-4]["factor"] == 5.0
    assert found[1e-6]["factor"] == 8.0
    assert found[1e-6]["hofsi run"] == "order 6, 9 elements"
    assert found[1e-8]["factor"] is None


def test_flows_converge_on_both_kinds_of_meshes(measured):
    result = measured("fluid_order").result
    assert [(row["flow"], row["mesh"]) for row in result.rows] == [
        (flow, mesh) for flow in ("vortex", "imposed") for mesh in ("blocks", "pseudo-solid")
    ]
    for row in result.rows:
        assert row["velocity order"] > 2.0
        assert row["pressure order"] > 1.5


def test_coupled_problems_converge_in_space_and_in_time(measured):
    result = measured("fsi_order").result
    assert [row["case"] for row in result.rows] == [
        "shear layer, p = 2",
        "rotating disc, p = 2",
        *["piston, in time"] * 3,
        *["flap, in time"] * 3,
    ]
    for row in result.rows[:2]:
        assert row["displacement order"] > 2.5
        assert row["load order"] > 3.5
    for row in result.rows[2:5]:
        assert row["velocity order"] > 1.8


def test_curves_are_met_at_the_order_of_the_elements(measured):
    result = measured("curve_accuracy").result
    rows = {(row["curve"], row["order"]): row for row in result.rows}
    assert len(rows) == 6
    for name in ("area", "perimeter"):
        assert rows["arc", 1][f"{name} order"] == pytest.approx(2.0, abs=0.05)
        assert rows["arc", 3][f"{name} order"] == pytest.approx(6.0, abs=0.2)
        assert rows["spline", 3][f"{name} order"] == "round-off"
        assert rows["nurbs, degree 3", 3][name] < 0.1 * rows["nurbs, degree 3", 1][name]


def test_a_run_that_is_known_is_not_made_again(measured, monkeypatch, tiny):
    first = measured("flag_oscillations")
    module = importlib.import_module("flag_oscillations")
    monkeypatch.setattr(module, "measure", lambda *_: pytest.fail("made again"))
    again = module.main([*tiny["flag_oscillations"], "--json", str(first.folder / "flag_oscillations.json")])
    assert [dict(row) for row in again.rows] == [dict(row) for row in first.result.rows]


def test_differences_are_relative_to_the_reference(measured):
    measured("flag_oscillations")
    module = importlib.import_module("flag_oscillations")
    row = {"reference": "fsi3", **module.REFERENCE["fsi3"], "drag amplitude": 1.01 * 27.74, "lift amplitude": None}
    off = module.errors(row)
    assert off["drag amplitude"] == pytest.approx(0.01)
    assert np.isnan(off["lift amplitude"])
    assert off["frequency"] == 0.0


def test_the_last_periods_are_cut_out(measured):
    measured("flag_oscillations")
    module = importlib.import_module("flag_oscillations")
    t = np.linspace(0.0, 5.0, 501)
    start, stop = module._last_crossings(t, 0.3 + np.sin(2.0 * np.pi * (t - 0.123)))
    assert (start, stop) == pytest.approx((2.123, 4.123), abs=1e-4)


@pytest.fixture
def force_noise(measured):
    measured("wall_ramm")
    return importlib.import_module("_force_noise")


def test_the_flap_of_the_paper_is_drawn(measured):
    found = measured("wall_ramm")
    assert [row["mover"] for row in found.result.rows] == ["barrier", "angles, published"]
    assert all(row["steps"] == 6 and not row["failure"] for row in found.result.rows)
    for name in ("wall_ramm", "wall_ramm_meshes", "wall_ramm_quality"):
        assert (found.folder / f"{name}.png").stat().st_size > 10_000


def test_the_flap_s_runs_are_not_made_again(measured, monkeypatch, tiny):
    first = measured("wall_ramm")
    module = importlib.import_module("wall_ramm")
    monkeypatch.setattr(module, "measure", lambda *_: pytest.fail("made again"))
    again = module.main([*tiny["wall_ramm"], "--json", str(first.folder / "wall_ramm.json")])
    assert [dict(row) for row in again.rows] == [dict(row) for row in first.result.rows]


@pytest.mark.parametrize("dt", [0.005, 0.0025, 0.00125])
def test_smooth_forces_have_no_noise(force_noise, dt):
    """Harmonics of the flap to beyond its second mode (20 Hz), and a growing amplitude."""
    t = np.arange(0.0, 7.5, dt)
    force = (1.0 + 0.1 * t) * sum(
        size * np.sin(2.0 * np.pi * f * t + f) for f, size in ((3.1, 1.0), (9.3, 0.3), (15.5, 0.1), (31.0, 0.01))
    )
    largest, mean = force_noise.noise(t, force, 2.5)
    assert mean < largest < 2e-5


@pytest.mark.parametrize("dt", [0.005, 0.0025])
def test_saw_teeth_are_measured_whole(force_noise, dt):
    t = np.arange(0.0, 7.5, dt)
    smooth = 40.0 * np.sin(2.0 * np.pi * 3.1 * t)
    teeth = 0.01 * 40.0 * (-1.0) ** np.arange(len(t))
    assert force_noise.noise(t, smooth + teeth, 2.5) == pytest.approx((0.01, 0.01), rel=0.03)


def test_the_same_wave_is_the_same_noise_whatever_the_step(force_noise):
    found = []
    for dt in (0.005, 0.0025, 0.00125):
        t = np.arange(0.0, 7.5, dt)
        found.append(force_noise.noise(t, np.sin(2.0 * np.pi * 3.1 * t) + 0.02 * np.sin(2.0 * np.pi * 83.1 * t), 2.5))
    assert [largest for largest, _ in found] == pytest.approx([0.02] * 3, rel=0.025)
    assert [mean for _, mean in found] == pytest.approx([0.02 / np.sqrt(2.0)] * 3, rel=0.03)


def test_a_single_jolt_is_found_where_it_is(force_noise):
    t = np.arange(0.0, 7.5, 0.005)
    force = np.sin(2.0 * np.pi * 3.1 * t)
    force[1000] += 0.05
    times, high = force_noise.high_passed(t, force)
    k = int(np.abs(high).argmax())
    assert times[k] == t[1000]
    assert 0.02 < high[k] < 0.05


def test_series_that_the_filter_cannot_take_are_refused(force_noise):
    t = np.arange(0.0, 1.0, 0.005)
    with pytest.raises(ValueError, match="expected equal ones"):
        force_noise.high_passed(np.delete(t, 50), t[1:])
    with pytest.raises(ValueError, match=r"cutoff 50 Hz with width 30: expected an end below 50 Hz, 1/\(2 dt\)"):
        force_noise.high_passed(2.0 * t, t)
    with pytest.raises(ValueError, match="20 steps; expected at least the 45 of the filter"):
        force_noise.high_passed(t[:20], t[:20])


def test_the_noisiest_block_vertex_is_told(measured):
    measured("wall_ramm")
    module = importlib.import_module("wall_ramm")
    t = np.arange(0.0, 7.5, 0.005)
    tip = 0.9 * np.sin(2.0 * np.pi * 3.2 * t)
    vertices = np.zeros((len(t), 3, 2))
    vertices[:, 0, 0] = 0.5 * tip
    vertices[:, 1, 1] = 3.0 + 0.5 * tip + 0.009 * (-1.0) ** np.arange(len(t))
    vertices[:, 2] = 7.0
    assert module.mesh_noise(t, tip, vertices) == pytest.approx(0.01, rel=0.02)
    found = module.figures({"t": t, "u_y": tip, "lift": tip, "vertices": vertices})
    assert found["mesh noise %"] == pytest.approx(1.0, rel=0.02)
    assert found["noise %"] < 0.01
    assert found["u_y"] == pytest.approx(0.9, rel=0.01)
    assert found["Hz"] == pytest.approx(3.2, rel=1e-3)


def test_a_step_that_has_become_slower_is_told(measured, tmp_path):
    measured("guard")
    guard = importlib.import_module("guard")
    rows = {row["case"]: row for row in guard.compared({"a": 2.0, "b": 1.1, "c": 3.0}, {"a": 1.0, "b": 1.0})}
    assert [rows[name][""] for name in "abc"] == ["SLOWER", "", ""]
    assert (rows["a"]["change"], rows["c"]["change"]) == (2.0, None)
    file = tmp_path / "baseline.json"
    for _ in range(2):  # the second time there is something to compare with
        asked = ["--steps", "1", "--cases", "CSM3", "--baseline", str(file), "--json", str(tmp_path / "guard.json")]
        result = guard.main([*asked, "--update"])
    assert 0.2 < result.rows[0]["change"] < 5.0


def test_what_is_left_out_is_left_out(measured):
    rows = {row["need"]: row for row in measured("skipping").result.rows}
    floor = rows["time loop, mesh and coupling beside the solver"]
    assert floor["counts without, with"] == "fluid.geometries 1 / 1; fluid.constant_assemblies 2 / 2"
    assert rows["convection"]["counts without, with"].startswith("fluid.factorisations 2 / ")
    assert rows["a nonlinear solid"]["counts without, with"].startswith("solid.factorisations 2 / ")
    assert rows["convection"]["ratio"] > 1.5
    assert all(row["ms with"] > 0.0 < row["ms without"] for row in rows.values())


def test_functions_add_up_to_a_step(measured):
    result = measured("step_profile").result
    phases = result.settings["phases ms"]
    assert {"fluid", "solid", "mesh", "step"} <= phases.keys()
    assert sum(row["own ms"] for row in result.rows) == pytest.approx(phases["step"])
    assert sum(value for name, value in phases.items() if name != "step") == pytest.approx(phases["step"])
    assert any("multifrontal" in row["function"] for row in result.rows)


def test_peers_solve_the_same_flag(measured):
    rows = measured("solid_work_precision").result.rows
    own = {row["mesh"]: row for row in rows if row["program"] == "hofsi"}
    for row in rows:
        if row["program"] == "scikit-fem":
            assert row["u_y"] == pytest.approx(own[row["mesh"]]["u_y"], rel=2e-4)  # other quadrature
    assert own["8 x 8"]["error"] < own["4 x 4"]["error"] < 0.05
