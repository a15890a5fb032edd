"""CSM1 of Turek and Hron with NGSolve: curved triangles refined at the clamp's corners; needs `pip install ngsolve`.

St. Venant–Kirchhoff, plane strain, Newton's method from rest with static condensation, the tangent by NGSolve's own
differentiation of the energy; its sparse Cholesky factors, which are faster here than UMFPACK.
"""

from __future__ import annotations

from time import perf_counter, process_time
from typing import Any

import ngsolve as ngs
from netgen import occ

MU, LAMBDA, WEIGHT = 0.5e6, 2.0e6, 2000.0  # Lamé's constants in Pa, N/m³
TOLERANCE = 1e-10  # of the energy norm of an increment, relative to the first


def measure(order: int, size: float, corner: float) -> dict[str, Any]:
    """Bend the flag, meshed with triangles of a size, at the clamp's corners of another: the same as scikit-fem's."""
    wall, cpu = perf_counter(), process_time()
    mesh = ngs.Mesh(_flag(size, corner).GenerateMesh(maxh=size, grading=0.4))
    mesh.Curve(order)
    space = ngs.VectorH1(mesh, order=order, dirichlet="clamp")
    u = space.TrialFunction()
    F = ngs.Id(2) + ngs.Grad(u)
    E = 0.5 * (F.trans * F - ngs.Id(2))
    form = ngs.BilinearForm(space, condense=True)
    energy = MU * ngs.InnerProduct(E, E) + 0.5 * LAMBDA * ngs.Trace(E) ** 2 + WEIGHT * u[1]
    form += ngs.Variation(energy.Compile() * ngs.dx)
    found = ngs.GridFunction(space)
    residual, step, first = found.vec.CreateVector(), found.vec.CreateVector(), None
    for _ in range(20):
        form.Apply(found.vec, residual)
        form.AssembleLinearization(found.vec)
        inverse = form.mat.Inverse(space.FreeDofs(coupling=True), "sparsecholesky")
        residual.data += form.harmonic_extension_trans * residual
        step.data = inverse * residual
        step.data += form.harmonic_extension * step
        step.data += form.inner_solve * residual
        found.vec.data -= step
        change = abs(ngs.InnerProduct(step, residual)) ** 0.5
        first = first or change
        if change < TOLERANCE * first:
            break
    x, y = found(mesh(0.6, 0.2))
    used = {"seconds": perf_counter() - wall, "CPU s": process_time() - cpu}
    return {"elements": mesh.ne, "unknowns": space.ndof, "u_x": x, "u_y": y} | used


def _flag(size: float, corner: float) -> occ.OCCGeometry:
    """The flag with its end on the cylinder's arc; its middle axis is an edge, so that the tip's middle is a node."""
    cylinder = occ.Circle((0.2, 0.2), 0.05).Face()
    halves = [occ.MoveTo(0.2, y).Rectangle(0.4, 0.01).Face() - cylinder for y in (0.19, 0.2)]
    flag = occ.Glue(halves)
    for edge in flag.edges:
        edge.name = "clamp" if edge.center[0] < 0.2601 else "flag"
    for vertex in flag.vertices:
        if abs(vertex.p[0] - 0.2489898) < 1e-4:
            vertex.maxh = corner
    return occ.OCCGeometry(flag, dim=2)
