"""All templates: certified meshes, areas against formulas, names, bad parameters."""

from __future__ import annotations

import math

import numpy as np
import pytest

from hoblock.blocks import BlockStructure
from hoblock.errors import CurveError, HoblockError, TemplateError
from hoblock.generate import generate
from hoblock.quality import scaled_jacobian
from hoblock.templates import (
    TEMPLATES,
    annulus,
    backward_facing_step,
    bifurcation,
    cavity_with_flexible_bottom,
    cylinder_in_channel,
    disc,
    find_template,
    flag_in_channel,
    l_shape,
    naca_c_grid,
    nozzle,
    o_grid_cylinder,
    rectangle,
)


def wavy(t):
    return np.stack([3.0 * t, 1.0 + 0.2 * np.sin(4.0 * t)], axis=-1)


def floor(t):
    return np.stack([3.0 * t, -0.3 * t * t], axis=-1)


CHANNEL = 2.2 * 0.41 - math.pi * 0.05**2
WAVY = 3.0 * (1.0 + 0.2 * (1.0 - math.cos(4.0)) / 4.0)  # below the wavy wall

# Template, parameters, area (None: not compared), least scaled Jacobian at order 2.
CASES = [
    (rectangle, {}, 1.0, 0.999),
    (rectangle, {"width": 3, "height": 0.2, "blocks_x": 4, "blocks_y": 2, "stretch_x": 4, "stretch_y": -3}, 0.6, 0.999),
    (annulus, {}, 3.0 * math.pi, 0.999),
    (annulus, {"inner_radius": 0.001, "sectors": 3, "stretch": 5, "center": (7, -2)}, math.pi * (4 - 1e-6), 0.98),
    (annulus, {"opening": 150, "sectors": 1, "start": -20}, math.pi * 3 * 150 / 360, 0.99),
    (annulus, {"inner_radius": 0.999, "outer_radius": 1.0, "opening": 355.0}, math.pi * 0.001999 * 355 / 360, 0.99),
    (disc, {}, math.pi, 0.86),
    (disc, {"radius": 1e-3, "core": 0.9, "stretch": 2, "center": (5, 5)}, math.pi * 1e-6, 0.86),
    (disc, {"core": 0.05, "elements": 2, "elements_radial": 6, "stretch": -4}, math.pi, 0.85),
    (l_shape, {}, 3.0, 0.999),
    (l_shape, {"width": 5, "height": 3, "notch_width": 4.5, "notch_height": 0.2, "stretch": 6}, 15 - 0.9, 0.999),
    (backward_facing_step, {}, 4.0 + 40.0, 0.999),
    (backward_facing_step, {"step_height": 0.01, "outlet_length": 50}, 4.0 + 50 * 1.01, 0.999),
    (cavity_with_flexible_bottom, {}, 1.002, 0.999),
    (
        cavity_with_flexible_bottom,
        {"opening": 0, "thickness": 0.1, "width": 2, "blocks_x": 1, "blocks_y": 1},
        2.2,
        0.99,
    ),
    (cavity_with_flexible_bottom, {"opening": 0.9, "thickness": 1e-5}, 1.00001, 0.999),
    (naca_c_grid, {"closed": False}, None, 0.8),
    (cylinder_in_channel, {}, CHANNEL, 0.7),
    (cylinder_in_channel, {"center": (1.1, 0.3), "radius": 0.002, "square": 0.1}, 2.2 * 0.41 - math.pi * 4e-6, 0.7),
    (o_grid_cylinder, {}, 35 * 20 - math.pi / 4, 0.7),
    (o_grid_cylinder, {"first_height": 1e-4, "growth": 1.3}, 35 * 20 - math.pi / 4, 0.7),
    (o_grid_cylinder, {"radius": 1, "ring_radius": 1.1, "square": 2.5, "center": (3, 4)}, 700 - math.pi, 0.4),
    (flag_in_channel, {}, 2.5 * 0.41 - math.pi * 0.05**2, 0.6),
    (flag_in_channel, {"body": "square"}, 19.5 * 12 - 1, 0.37),
    (flag_in_channel, {"size": 0.2, "center": (0.3, 0.2)}, 2.5 * 0.41 - math.pi * 0.01, 0.4),
    (flag_in_channel, {"height": 4.1, "center": (0.2, 2), "flag_length": 0.1}, 2.5 * 4.1 - math.pi * 0.0025, 0.25),
    (flag_in_channel, {"body": "square", "flag_length": 1, "flag_thickness": 0.4, "refine": 2}, 19.5 * 12 - 1, 0.19),
    (flag_in_channel, {"body": "square", "size": 3, "height": 6.8, "center": (4, 3.6)}, 19.5 * 6.8 - 9, 0.2),
    (nozzle, {}, 4.0 * (0.4 * 1.5 + 0.6 * 1.3), 0.89),
    (nozzle, {"half": True, "blocks": 5, "throat_height": 0.1}, 2.0 * (0.4 * 1.05 + 0.6 * 0.85), 0.6),
    (nozzle, {"upper": wavy, "lower": floor, "blocks": 3}, WAVY + 0.3, 0.6),
    (nozzle, {"upper": wavy}, 2.0 * WAVY, 0.6),
    (bifurcation, {}, None, 0.8),
    (bifurcation, {"upper_angle": 10, "lower_angle": 10, "rounding": 0.1}, None, 0.7),
    (bifurcation, {"upper_angle": 0, "lower_angle": 90, "upper_width": 1.0, "lower_width": 0.4}, None, 0.6),
    (bifurcation, {"upper_angle": 85, "lower_angle": 85, "upper_width": 2.0, "lower_width": 1.9}, None, 0.5),
]


def name_of(value):
    return value.__name__ if callable(value) else "-".join(value) or "default" if isinstance(value, dict) else ""


@pytest.mark.parametrize(("function", "parameters", "expected", "quality"), CASES, ids=name_of)
def test_meshes_are_certified_and_have_the_right_area(function, parameters, expected, quality, measure_area):
    structure = function(**parameters)
    for order in (1, 2, 8):
        mesh = generate(structure, order)  # raises unless every element is certified
        if order == 2:
            assert scaled_jacobian(mesh).min() >= quality
    if expected is not None:
        assert measure_area(mesh) == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("name", TEMPLATES)
@pytest.mark.parametrize("order", range(1, 9))
def test_defaults_are_certified_at_all_orders(name, order):
    mesh = generate(TEMPLATES[name].function(), order)
    assert scaled_jacobian(mesh).min() > 0.3
    assert scaled_jacobian(mesh).mean() > 0.85


NAMES = {
    "annulus": ({"domain"}, {"inner", "outer"}),
    "backward_facing_step": ({"fluid"}, {"inlet", "outlet", "top", "floor", "step", "bottom"}),
    "bifurcation": (
        {"fluid"},
        {"inlet", "upper_outlet", "lower_outlet", "upper_wall", "lower_wall", "inner_wall"},
    ),
    "cavity_with_flexible_bottom": (
        {"fluid", "solid"},
        {"lid", "inlet", "outlet", "left", "right", "interface", "underside", "clamp"},
    ),
    "cylinder_in_channel": ({"fluid"}, {"inlet", "outlet", "top", "bottom", "cylinder"}),
    "disc": ({"domain"}, {"circle"}),
    "flag_in_channel": ({"fluid", "solid"}, {"inlet", "outlet", "top", "bottom", "cylinder", "flag", "clamp"}),
    "l_shape": ({"domain"}, {"left", "right", "bottom", "top", "notch"}),
    "naca_c_grid": ({"fluid"}, {"airfoil", "inflow", "far_field", "outflow", "wake"}),
    "nozzle": ({"fluid"}, {"inlet", "outlet", "upper", "lower"}),
    "o_grid_cylinder": ({"fluid"}, {"inflow", "outflow", "top", "bottom", "cylinder"}),
    "rectangle": ({"domain"}, {"left", "right", "bottom", "top"}),
}


@pytest.mark.parametrize("name", TEMPLATES)
def test_names_cover_the_boundary(name):
    topology = TEMPLATES[name].function().topology
    groups, edges = NAMES[name]
    assert set(topology.block_groups) == groups
    assert set(topology.edge_groups) == edges
    outer = set(np.flatnonzero(topology.blocks_per_edge == 1).tolist())
    named = [edge for members in topology.edge_groups.values() for edge in members.tolist()]
    assert len(named) == len(set(named))
    assert outer <= set(named)


@pytest.mark.parametrize(("function", "parameters"), [case[:2] for case in CASES], ids=name_of)
def test_every_chain_has_a_number_of_elements(function, parameters, monkeypatch):
    build = BlockStructure.build

    def with_mark(*args, **options):
        return build(*args, default_count=97, **options)

    monkeypatch.setattr(BlockStructure, "build", with_mark)
    assert 97 not in function(**parameters).topology.counts


def test_registry_is_sorted_and_describes_every_parameter():
    assert list(TEMPLATES) == sorted(TEMPLATES)
    for template in TEMPLATES.values():
        assert template.summary
        assert template.details
        for parameter in template.parameters.values():
            assert parameter.meaning.endswith("."), (template.name, parameter.name)
            assert parameter.default is not None or parameter.example is not None
            if parameter.default is not None:
                assert parameter.checked(parameter.default) == parameter.default


# --- what single templates promise --------------------------------------------------------------------------------


def test_elements_of_a_rectangle_do_not_depend_on_its_blocks():
    options = {"width": 3.0, "stretch_x": 2.5, "stretch_y": -1.0}
    whole = generate(rectangle(elements_x=12, elements_y=6, **options), 3)
    parts = generate(rectangle(blocks_x=4, elements_x=3, blocks_y=2, elements_y=3, **options), 3)

    def ordered(mesh):
        return mesh.points[np.lexsort(np.round(mesh.points, 10).T)]

    np.testing.assert_allclose(ordered(parts), ordered(whole), atol=1e-13)
    assert ordered(whole)[:, 0].max() == 3.0


def test_annulus_closes_only_if_it_is_whole():
    assert "first" not in annulus().topology.edge_groups
    part = annulus(opening=90.0, sectors=1, start=30.0)
    mesh = generate(part, 4)
    ends = mesh.points[mesh.edge_nodes("last")]
    np.testing.assert_allclose(np.degrees(np.arctan2(ends[:, 1], ends[:, 0])), 120.0)


def test_three_equal_angles_meet_inside_a_disc():
    assert scaled_jacobian(generate(disc(), 6)).min() == pytest.approx(math.sin(math.radians(60.0)), rel=1e-3)


def test_first_height_of_an_o_grid(measure_first_heights):
    mesh = generate(o_grid_cylinder(first_height=2e-4, growth=1.4), 3)
    np.testing.assert_allclose(measure_first_heights(mesh, "cylinder"), 2e-4, rtol=1e-9)


def test_default_flags_are_the_known_layouts():
    circle, square = flag_in_channel(), flag_in_channel(body="square")
    for structure, cells, T0, mid in ((circle, 255 + 7, 0.24898979, 0.305), (square, 322 + 8, 5.5, 7.6)):
        topology = structure.topology
        assert (len(topology.quads), len(structure.vertices), len(topology.edges)) == (57, 76, 133)
        assert len(np.unique(topology.chains)) == 19
        assert len(generate(structure, 1).cells) == cells
        assert structure.vertices[topology.vertex("T0"), 0] == pytest.approx(T0, abs=1e-8)
        assert structure.vertices[topology.vertex("m2t"), 1] == mid
    assert "square" in square.topology.edge_groups
    wet = circle.shared_edges(["fluid"], ["solid"])
    assert set(wet.tolist()) == set(circle.topology.edge_groups["flag"].tolist())


def test_flag_layout_follows_its_unit():
    metres, millimetres = (
        flag_in_channel(
            length=2.5 * f,
            height=0.41 * f,
            center=(0.2 * f, 0.2 * f),
            size=0.1 * f,
            flag_length=0.35 * f,
            flag_thickness=0.02 * f,
        )
        for f in (1.0, 1000.0)
    )
    np.testing.assert_allclose(millimetres.vertices, 1000.0 * metres.vertices, rtol=1e-12)


def test_nozzle_is_cut_where_its_walls_have_kinks():
    class Kinked:
        breaks = np.array([0.3])

        def __call__(self, t):
            return np.stack([t, 1.0 + np.abs(t - 0.3)], axis=-1)

    structure = nozzle(upper=Kinked(), blocks=2)
    assert len(structure.topology.quads) == 3
    np.testing.assert_allclose(np.unique(structure.vertices[:, 0]), [0.0, 0.3, 0.5, 1.0], atol=1e-15)


def test_area_of_a_bifurcation(measure_area):
    """Walls are lines and parabolas: the polygon with the knees, and a third of the triangle that a bend cuts off."""
    structure = bifurcation(upper_angle=30, lower_angle=55, upper_width=0.8, lower_width=0.6, rounding=0.7)
    at = {name: structure.vertices[k] for k, name in enumerate(structure.topology.vertex_names)}
    knees = {"up": np.array([0.0, 0.5]), "down": np.array([0.0, -0.5])}
    corners = [at[k] for k in ("i0", "a0")] + [knees["down"]] + [at[k] for k in ("l0", "m0", "m2", "k", "v0", "v2")]
    corners += [at["u2"], knees["up"], at["a2"], at["i2"]]

    def polygon(points):
        x, y = np.array(points).T
        return 0.5 * float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))

    bends = abs(polygon([at["a2"], knees["up"], at["u2"]])) + abs(polygon([at["a0"], knees["down"], at["l0"]]))
    assert measure_area(generate(structure, 3)) == pytest.approx(polygon(corners) + bends / 3.0, rel=1e-12)


def test_three_blocks_meet_at_the_carina():
    topology = bifurcation().topology
    assert int((topology.quads == topology.vertex("k")).sum()) == 3


def test_bifurcation_does_not_depend_on_the_unit():
    lengths = ("width", "upper_width", "lower_width", "inlet_length", "upper_length", "lower_length", "rounding")
    defaults = {name: TEMPLATES["bifurcation"].parameters[name].default for name in lengths}
    small = bifurcation(**{name: 1e-6 * value for name, value in defaults.items()})
    np.testing.assert_allclose(small.vertices, 1e-6 * bifurcation().vertices, rtol=0.0, atol=1e-8)


# --- bad parameters -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("function", "parameters", "message"),
    [
        (rectangle, {"width": 0}, r"^width: got 0; expected a number > 0\."),
        (rectangle, {"width": "1"}, r"^width: got '1'; expected a number > 0\."),
        (rectangle, {"width": True}, "width: got True; expected a number"),
        (rectangle, {"height": math.inf}, "height: got inf; expected a number"),
        (rectangle, {"elements_x": 2.0}, "elements_x: got 2.0; expected an integer >= 1"),
        (rectangle, {"elements_x": 0}, "elements_x: got 0; expected an integer >= 1"),
        (rectangle, {"corner": (1.0,)}, r"corner: got \(1.0,\); expected two numbers \(x, y\)"),
        (rectangle, {"stretch_x": 21.0}, "stretch_x: got 21.0; expected a number >= -20 and <= 20"),
        (annulus, {"inner_radius": 2.0}, "inner_radius: got 2; expected less than outer_radius = 2"),
        (annulus, {"sectors": 2}, "sectors: got 2 for an opening of 360 degrees; expected at least 3"),
        (annulus, {"opening": 361.0}, "opening: got 361.0; expected a number > 0 and <= 360"),
        (disc, {"core": 1.0}, "core: got 1.0; expected a number > 0 and < 1"),
        (l_shape, {"notch_height": 2.0}, "notch_height: got 2; expected less than height = 2"),
        (cavity_with_flexible_bottom, {"opening": 1.0}, "opening: got 1; expected less than height = 1"),
        (cylinder_in_channel, {"radius": 0.1}, r"square: got 0.2; expected more than 2 radius = 0.2"),
        (cylinder_in_channel, {"center": (0.05, 0.2)}, "center: got 0.05 as x; expected between 0.1 and 2.1"),
        (cylinder_in_channel, {"center": (0.2, 0.4)}, "center: got 0.4 as y; expected between 0.1 and 0.31"),
        (o_grid_cylinder, {"ring_radius": 0.4}, "ring_radius: got 0.4; expected more than radius = 0.5"),
        (o_grid_cylinder, {"square": 3.0}, "square: got 3; expected more than 2 ring_radius = 3"),
        (o_grid_cylinder, {"downstream": 2.0}, "downstream: got 2; expected more than half of square = 5"),
        (o_grid_cylinder, {"first_height": 1.0}, "first_height: got 1; expected less than ring_radius - radius = 1"),
        (flag_in_channel, {"body": "triangle"}, "body: got 'triangle'; expected one of 'circle', 'square'"),
        (flag_in_channel, {"center": (0.2, 0.38)}, r"center: got \(0.2, 0.38\); a body of size 0.1 there touches"),
        (flag_in_channel, {"flag_length": 3.0}, "flag_length: got 3: the flag ends at x = 3.25; expected less than"),
        (flag_in_channel, {"flag_length": 0.01}, "flag_length: got 0.01; expected at least half of size = 0.1"),
        (flag_in_channel, {"flag_thickness": 0.06}, "flag_thickness: got 0.06; expected at most half of size = 0.1"),
        (flag_in_channel, {"length": -1}, "length: got -1; expected a number > 0 or None"),
        (nozzle, {"lower": floor}, "lower: got a curve without an upper wall"),
        (nozzle, {"upper": wavy, "lower": floor, "half": True}, "half: got True and a lower wall"),
        (nozzle, {"half": 1}, "half: got 1; expected True or False"),
        (nozzle, {"upper": 3.0}, "upper: got 3.0; expected a curve, a function of t"),
        (bifurcation, {"upper_angle": 5, "lower_angle": 5}, "upper_angle: got 5 and lower_angle = 5; expected a sum"),
        (
            bifurcation,
            {"upper_width": 0.1, "lower_width": 0.1},
            "upper_width: got 0.1 .* the carina would lie at .-",
        ),
        (bifurcation, {"upper_width": 2.0, "upper_angle": 85, "lower_angle": 85}, "widths more alike"),
    ],
)
def test_bad_parameters(function, parameters, message):
    with pytest.raises(TemplateError, match=message) as caught:
        function(**parameters)
    assert caught.value.parameter
    assert isinstance(caught.value, HoblockError)


def test_numpy_numbers_are_numbers():
    structure = rectangle(width=np.float64(2.0), elements_x=np.int64(3), corner=np.array([1.0, 2.0]))
    assert len(generate(structure, 1).cells) == 12


def test_unknown_template_and_parameter():
    with pytest.raises(TemplateError, match=r"no template 'naca_cgrid'\. Did you mean 'naca_c_grid'\?"):
        find_template("naca_cgrid")
    with pytest.raises(TemplateError, match=r"radius_inner.*no such parameter.*Parameters: inner_radius, outer_radius"):
        find_template("annulus").build({"radius_inner": 1.0})
    with pytest.raises(TemplateError, match="Did you mean 'inner_radius'"):
        find_template("annulus").build({"inner_radios": 1.0})
    with pytest.raises(
        TypeError, match=r"disc\(\) got an unexpected keyword argument 'radios'\. Did you mean 'radius'"
    ):
        disc(radios=1.0)


def test_a_wall_that_is_not_finite_is_refused():
    with pytest.raises((CurveError, HoblockError), match="not finite"):
        nozzle(
            upper=lambda t: (
                np.stack([t, 1.0 / (t - 0.5)], axis=-1) if np.all(t != 0.5) else np.full((len(t), 2), np.nan)
            )
        )
