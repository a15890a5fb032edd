"""Classical problems of elasticity, set up as scenes, against exact solutions and published values."""

from __future__ import annotations

import tomllib

import numpy as np
import pytest

from hofsi.build import build
from hofsi.io.scene import read_case
from hofsi.quantities import evaluators
from hofsi.simulate import simulate
from hofsi.solvers.solid_stress import SolidStress

pytestmark = [pytest.mark.verification, pytest.mark.slow]

COOK = """
[mesh.vertices]
a = [0, 0]
b = [48, 44]
c = [48, 60]
d = [0, 44]

[mesh.blocks]
solid = [["a", "b", "c", "d"]]

[mesh.edges]
left = [["a", "d"]]
right = [["b", "c"]]
rest = [["a", "b"], ["d", "c"]]

[[solid]]
density = 1
youngs_modulus = 1
poissons_ratio = "NU"
model = "linear"
plane = "PLANE"

[[solid.boundary]]
on = "left"
type = "fixed"

[[solid.boundary]]
on = "rest"
type = "free"

[[solid.boundary]]
on = "right"
type = "traction"
y = "1/16"

[time]
steady = true

[quantities.middle]
type = "probe"
field = "displacement"
component = "y"
at = [48, 52]

[quantities.top]
type = "probe"
field = "displacement"
component = "y"
at = "c"

[quantities.shear]
type = "force"
on = "left"
component = "y"
"""

HOLE = """
[constants]
mu = "100/2.6"
k = 1.8

[mesh]
order = 8
elements = 4

[mesh.vertices]
h0 = [1, 0]
h1 = ["cos(pi/4)", "sin(pi/4)"]
h2 = [0, 1]
o0 = [4, 0]
o1 = [4, 4]
o2 = [0, 4]

[mesh.blocks]
solid = [["h0", "o0", "o1", "h1"], ["h1", "o1", "o2", "h2"]]

[mesh.edges]
hole = [["h0", "h1", "h2"]]
outer = [["o0", "o1", "o2"]]
below = [["h0", "o0"]]
beside = [["h2", "o2"]]

[[mesh.curve]]
on = ["hole"]
kind = "arc"
center = [0, 0]

[[solid]]
density = 1
youngs_modulus = 100
poissons_ratio = 0.3
model = "linear"

[[solid.boundary]]
on = "hole"
type = "free"

[[solid.boundary]]
on = ["below", "beside"]
type = "symmetry"

[[solid.boundary]]
on = "outer"
type = "displacement"
x = "X"
y = "Y"

[time]
steady = true

[quantities.pull]
type = "force"
on = "beside"
component = "x"
"""

PLATE = """
[mesh]
order = 4

[mesh.vertices]
a = [0, 0]
b = [4, 0]
c = [4, 0.06]
d = [0, 0.06]

[mesh.blocks]
solid = [["a", "b", "c", "d"]]

[mesh.edges]
clamp = [["a", "d"]]
rest = [["a", "b", "c", "d"]]

[[mesh.count]]
on = [["a", "b"]]
elements = 8

[[solid]]
density = 0.1
youngs_modulus = 2.5e6
poissons_ratio = 0.35
plane = "PLANE"
initial_velocity = ["0", "0.05*(cosh(K*x) - cos(K*x) - S*(sinh(K*x) - sin(K*x)))"]

[[solid.boundary]]
on = "clamp"
type = "fixed"

[[solid.boundary]]
on = "rest"
type = "free"

[time]
dt = 0.005
end = 2.0

[quantities.u]
type = "probe"
field = "displacement"
component = "y"
at = "c"
"""


def solved(text):
    problem = build(read_case(tomllib.loads(text), "scene.toml"))
    return problem, evaluators(problem), list(simulate(problem))


@pytest.mark.parametrize(("order", "elements", "tolerance"), [(2, 32, 5e-4), (4, 8, 1e-3), (8, 4, 5e-4)])
def test_cooks_membrane(order, elements, tolerance):
    """Tip of the plane stress membrane with ν = 1/3; 23.96 (Bergan & Felippa 1985), extrapolated 23.967."""
    text = COOK.replace('"NU"', "0.3333333333333333").replace("PLANE", "stress")
    _, read, (record,) = solved(f"[mesh]\norder = {order}\nelements = {elements}\n" + text)
    assert read["middle"](record) == pytest.approx(23.967, rel=tolerance)
    assert read["shear"](record) == pytest.approx(1.0, rel=1e-9)


def test_cooks_membrane_nearly_incompressible():
    """7.769 at the upper corner for E = 250, ν = 0.4999, F = 100 in plane strain."""
    text = COOK.replace('"NU"', "0.4999").replace("PLANE", "strain")
    _, read, (record,) = solved("[mesh]\norder = 8\nelements = 8\n" + text)
    assert 100.0 / 250.0 * read["top"](record) == pytest.approx(7.769, rel=5e-3)


def test_a_hole_triples_the_stress():
    """Kirsch's solution in plane strain, imposed on the outer edges."""
    r, phi = "hypot(x, y)", "atan2(y, x)"
    x = f"({r}*(k + 1)*cos({phi}) + 2/{r}*((1 + k)*cos({phi}) + cos(3*{phi})) - 2/{r}**3*cos(3*{phi}))/(8*mu)"
    y = f"({r}*(k - 3)*sin({phi}) + 2/{r}*((1 - k)*sin({phi}) + sin(3*{phi})) - 2/{r}**3*sin(3*{phi}))/(8*mu)"
    problem, read, (record,) = solved(HOLE.replace('"X"', f'"{x}"').replace('"Y"', f'"{y}"'))
    points = problem.solid.mesh.points
    sigma = SolidStress(problem.solid.mesh, problem.case.solids).cauchy(record.state.solid.displacement)
    top, side = (int(np.argmin(np.hypot(*(points - at).T))) for at in ((0.0, 1.0), (1.0, 0.0)))
    assert sigma[top, 0] == pytest.approx(3.0, rel=1e-4)
    assert sigma[side, 1] == pytest.approx(-1.0, rel=1e-4)
    pull = (4.0 - 1.0 / 8.0 - 1.0 / 128.0) - (1.0 - 0.5 - 0.5)  # ∫ 1 + 1/(2 y²) + 3/(2 y⁴) dy from 1 to 4
    assert read["pull"](record) == pytest.approx(pull, rel=1e-8)


@pytest.mark.parametrize(("plane", "published"), [("stress", 3.03), ("strain", 3.23)])
def test_frequency_of_the_plate_behind_the_square(plane, published):
    """First bending frequency; Euler–Bernoulli gives 3.0289 and 3.2334, which BDF2 lowers by (ω dt)²/3 = 0.3 %."""
    k = 1.8751040687119611
    s = (np.cosh(k) + np.cos(k)) / (np.sinh(k) + np.sin(k))
    text = f"[constants]\nK = {k / 4.0!r}\nS = {float(s)!r}\n" + PLATE.replace("PLANE", plane)
    _, read, records = solved(text)
    t, u = np.array([(record.time, read["u"](record)) for record in records]).T
    up = np.flatnonzero((u[:-1] < 0.0) & (u[1:] >= 0.0))
    crossings = t[up] - u[up] * (t[up + 1] - t[up]) / (u[up + 1] - u[up])
    frequency = (len(crossings) - 1) / (crossings[-1] - crossings[0])
    modulus = 2.5e6 / (1.0 if plane == "stress" else 1.0 - 0.35**2)
    beam = k**2 / (2.0 * np.pi) * np.sqrt(modulus * 0.06**2 / (12.0 * 0.1)) / 4.0**2
    assert frequency == pytest.approx(beam, rel=5e-3)
    assert frequency == pytest.approx(published, rel=5e-3)
