"""Exact flows: a decaying vortex, one with a body force, Kovasznay's, and those that are in every velocity space."""

from __future__ import annotations

import math

from hoblock.expressions import compile_expression
from manufactured_flows.flow import Flow

__all__ = ["IMPOSED", "KOVASZNAY", "LINEAR", "UNIFORM", "VORTEX", "linear"]

VORTEX = Flow(
    density=1.0,
    viscosity=0.025,
    velocity=("-sin(2*pi*y)*exp(-k*t)", "sin(2*pi*x)*exp(-k*t)"),
    pressure="-cos(2*pi*x)*cos(2*pi*y)*exp(-2*k*t)",
    traction=("cos(2*pi*x)*cos(2*pi*y)*exp(-2*k*t)", "nu*2*pi*(cos(2*pi*x) - cos(2*pi*y))*exp(-k*t)"),
    initial=("-sin(2*pi*y)", "sin(2*pi*x)"),
    constants={"nu": 0.025, "k": 4.0 * math.pi**2 * 0.025},
)
"""Fehn, Heinz, Wall, Kronbichler, J. Comput. Phys. 430 (2021) 110040, doi:10.1016/j.jcp.2020.110040, Section 5.1."""

_F1 = (
    "pi*sin(pi*x)*(cos(pi*x) + cos(pi*t)*sin(pi*y) - pi*sin(pi*t)*sin(pi*y) - cos(pi*t)**2*cos(pi*x)"
    " + 2*mu*pi*sin(pi*t)*sin(pi*y))"
)
_F2 = (
    "pi*cos(pi*y)*(-sin(pi*y) + cos(pi*t)*cos(pi*x) + pi*cos(pi*x)*sin(pi*t) + cos(pi*t)**2*sin(pi*y)"
    " + 2*mu*pi*cos(pi*x)*sin(pi*t))"
)
IMPOSED = Flow(
    density=1.0,
    viscosity=0.1,
    velocity=("sin(pi*x)*sin(pi*y)*sin(pi*t)", "cos(pi*x)*cos(pi*y)*sin(pi*t)"),
    pressure="pi*cos(pi*x)*sin(pi*y)*sin(pi*t)",
    # μ (∂u/∂y + ∂v/∂x) = μ π (sin πx cos πy - sin πx cos πy) sin πt = 0.
    traction=("(2*mu - 1)*pi*cos(pi*x)*sin(pi*y)*sin(pi*t)", "0"),
    force=(_F1, _F2),
    constants={"mu": 0.1},
)
"""The ALE test with imposed interior motion of github.com/andrealaspina/galerkin, incompressible flow, 2D."""


def linear(g: str, rate: str) -> Flow:
    """u = (g + x + y, g - x - y), p = g for a function g of t and its derivative: only the time scheme errs.

    References
    ----------
    ``MMS_fluid.py`` of github.com/KVSlab/turtleFSI.
    """
    return Flow(
        density=1.0,
        viscosity=0.5,
        velocity=(f"{g} + x + y", f"{g} - x - y"),
        pressure=g,
        traction=(f"-({g}) + 2*mu", "0"),
        force=(f"{rate} + 2*({g})", f"{rate} - 2*({g})"),
        initial=("g_0 + x + y", "g_0 - x - y"),
        constants={"mu": 0.5, "g_0": float(compile_expression(g, ("t",)).evaluate(t=0.0))},
    )


LINEAR = linear("(exp(3*t) + t + t**3 + sin(t))", "(3*exp(3*t) + 1 + 3*t**2 + cos(t))")
"""That function of the same source."""

UNIFORM = Flow(density=1.3, viscosity=0.01, velocity=("1", "1"), pressure="3", traction=("-3", "0"), initial=("1", "1"))

_RE = 40.0
_K = 0.5 * _RE - math.sqrt(0.25 * _RE**2 + 4.0 * math.pi**2)
KOVASZNAY = Flow(
    density=1.0,
    viscosity=1.0 / _RE,
    velocity=("1 - exp(k*x)*cos(2*pi*y)", "k/(2*pi)*exp(k*x)*sin(2*pi*y)"),
    pressure="(1 - exp(2*k*x))/2",
    traction=(
        "-(1 - exp(2*k*x))/2 - 2*nu*k*exp(k*x)*cos(2*pi*y)",
        "nu*(2*pi + k**2/(2*pi))*exp(k*x)*sin(2*pi*y)",
    ),
    constants={"nu": 1.0 / _RE, "k": _K},
)
"""Kovasznay, Math. Proc. Cambridge Philos. Soc. 44 (1948) 58–62, doi:10.1017/S0305004100023999, at Re = 40."""
