"""CSM1 of Turek and Hron with scikit-fem on the mesh of hoblock: the flag bends under its own weight.

St. Venant–Kirchhoff, plane strain, Newton's method from rest; elements `ElementQuadP` of the order of the mesh, nothing
condensed but the Dirichlet conditions, SciPy's SuperLU. The quadrature is exact for straight elements (2 p + 1; with
scikit-fem's default of 4 p it takes three times as long).
"""

from __future__ import annotations

from time import perf_counter, process_time
from typing import Any

import numpy as np
import skfem
from skfem.helpers import ddot, grad, identity, mul, trace, transpose

from hoblock.io.skfem import to_skfem
from hoblock.mesh import QuadMesh

MU, LAMBDA, WEIGHT = 0.5e6, 2.0e6, 2000.0  # Lamé's constants in Pa, N/m³
TOLERANCE = 1e-10  # of the residual, relative to the weight


def measure(mesh: QuadMesh) -> dict[str, Any]:
    """Bend the flag: displacement of the tip's middle, unknowns, seconds."""
    wall, cpu = perf_counter(), process_time()
    m = to_skfem(mesh)
    element = skfem.ElementVector(skfem.ElementQuadP(mesh.order))
    basis = skfem.Basis(m, element, intorder=2 * mesh.order + 1)
    clamped = basis.get_dofs("clamp").all()
    weight = _weight.assemble(basis)
    u = basis.zeros()
    for _ in range(20):
        field = basis.interpolate(u)
        residual = weight - _internal.assemble(basis, d=field)
        residual[clamped] = 0.0
        if np.linalg.norm(residual) < TOLERANCE * np.linalg.norm(weight):
            break
        u += skfem.solve(*skfem.condense(_tangent.assemble(basis, d=field), residual, D=clamped))
    tip = basis.probes(np.array([[0.6 - 1e-12], [0.2]])) @ u
    used = {"seconds": perf_counter() - wall, "CPU s": process_time() - cpu}
    return {"elements": len(mesh.cells), "unknowns": int(basis.N), "u_x": float(tip[0]), "u_y": float(tip[1])} | used


def _strain(d: Any) -> tuple[Any, Any]:
    F = grad(d) + identity(grad(d))
    return F, 0.5 * (mul(transpose(F), F) - identity(F))


def _stress(E: Any) -> Any:
    return LAMBDA * trace(E) * identity(E) + 2.0 * MU * E


@skfem.LinearForm
def _weight(v: Any, w: Any) -> Any:
    return -WEIGHT * v[1]


@skfem.LinearForm
def _internal(v: Any, w: Any) -> Any:
    F, E = _strain(w["d"])
    return ddot(mul(F, _stress(E)), grad(v))


@skfem.BilinearForm
def _tangent(u: Any, v: Any, w: Any) -> Any:
    F, E = _strain(w["d"])
    change = mul(transpose(F), grad(u))
    change = 0.5 * (change + transpose(change))
    return ddot(mul(grad(u), _stress(E)) + mul(F, _stress(change)), grad(v))
