"""Turek–Hron FSI1 with NGSolve: an independent value for docs/verification.md. Needs `pip install ngsolve`.

    python benchmarks/peers/fsi1_ngsolve.py --order 5 --tip 5e-4

Fluid and solid share one mesh of curved triangles, refined at the flag's corners. Partitioned: Taylor–Hood flow on the
harmonically deformed mesh, nodal momentum residuals as loads, St. Venant–Kirchhoff solid, constant relaxation.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass

import ngsolve as ngs
import numpy as np
from netgen import occ

DENSITY, VISCOSITY, INFLOW, HEIGHT = 1000.0, 1.0, 0.2, 0.41
LAME_MU, LAME_LAMBDA = 0.5e6, 2.0e6
RELAXATION = 0.535


@dataclass(frozen=True)
class Result:
    """What one run gave: elements, tip displacement, forces on cylinder and flag, last change of the displacement."""

    elements: int
    u_x: float
    u_y: float
    drag: float
    lift: float
    change: float


def domain(tip: float) -> occ.OCCGeometry:
    """Channel, cylinder and flag; ``tip`` is the element size at the flag's free corners."""
    channel = occ.MoveTo(0, 0).Rectangle(2.5, HEIGHT).Face()
    channel.edges.name = "wall"
    channel.edges.Min(occ.X).name, channel.edges.Max(occ.X).name = "inlet", "outlet"
    cylinder = occ.Circle((0.2, 0.2), 0.05).Face()
    cylinder.edges.name = "cylinder"
    flag = occ.MoveTo(0.2, 0.19).Rectangle(0.4, 0.02).Face() - cylinder
    for edge in flag.edges:
        edge.name = "clamp" if edge.center[0] < 0.2601 else "flag"
    flag.faces.name = "solid"
    fluid = (channel - cylinder) - flag
    fluid.faces.name = "fluid"
    for edge in fluid.edges:
        x, y = edge.center[0], edge.center[1]
        if 0.19 - 1e-9 <= y <= 0.21 + 1e-9 and 0.26 < x < 0.61:
            edge.name = "flag"
    both = occ.Glue([fluid, flag])
    for vertex in both.vertices:
        if abs(vertex.p[0] - 0.6) < 1e-6:
            vertex.maxh = tip
        if abs(vertex.p[0] - 0.2489898) < 1e-4:
            vertex.maxh = 2.0 * tip
    for edge in both.edges:
        if edge.name in ("flag", "cylinder", "clamp"):
            edge.maxh = 0.02
    return occ.OCCGeometry(both, dim=2)


def newton(
    form: ngs.BilinearForm, field: ngs.GridFunction, free: ngs.BitArray, load: np.ndarray, tolerance: float
) -> None:
    """Solve form(field) + load = 0 in place; the load acts on the first unknowns."""
    residual = field.vec.CreateVector()
    for _ in range(15):
        form.Apply(field.vec, residual)
        residual.FV().NumPy()[: len(load)] += load
        form.AssembleLinearization(field.vec)
        change = (form.mat.Inverse(free, inverse="umfpack") * residual).Evaluate()
        field.vec.data -= change
        if ngs.Norm(change) < tolerance:
            return
    raise RuntimeError("Newton's method did not converge")


class Coupled:
    """Spaces and forms of both fields on one mesh."""

    def __init__(self, order: int, tip: float) -> None:
        self.mesh = ngs.Mesh(domain(tip).GenerateMesh(maxh=0.06, grading=0.25))
        self.mesh.Curve(order)
        fluid, solid = self.mesh.Materials("fluid"), self.mesh.Materials("solid")
        walls = "wall|inlet|cylinder|flag|clamp"
        V = ngs.VectorH1(self.mesh, order=order, dirichlet=walls)
        self.space = V * ngs.H1(self.mesh, order=order - 1, definedon="fluid")
        self.displacements = ngs.VectorH1(self.mesh, order=order, dirichlet="wall|inlet|outlet|cylinder|clamp")
        self.count = V.ndof
        outer = ngs.VectorH1(self.mesh, order=order, dirichlet=walls + "|outlet").FreeDofs()
        in_fluid, in_solid = (np.array(list(V.GetDofs(part)), dtype=bool) for part in (fluid, solid))
        self.only_fluid = in_fluid & ~in_solid
        self.free_flow, self.free_solid = (
            ngs.BitArray(self.space.FreeDofs()),
            ngs.BitArray(self.displacements.FreeDofs()),
        )
        free_mesh = ngs.BitArray(outer)
        for k in np.flatnonzero(in_solid):
            self.free_flow[int(k)] = free_mesh[int(k)] = False
        for k in np.flatnonzero(self.only_fluid):
            self.free_solid[int(k)] = False
        self.flow_form, self.solid_form = self._flow(fluid), self._solid(solid)
        u, v = self.displacements.TnT()
        self.extension = ngs.BilinearForm(self.displacements)
        self.extension += ngs.InnerProduct(ngs.Grad(u), ngs.Grad(v)) * ngs.dx(definedon=fluid)
        self.extension.Assemble()
        self.extend_inverse = self.extension.mat.Inverse(free_mesh, inverse="umfpack")
        self.flow = ngs.GridFunction(self.space)
        profile = 1.5 * INFLOW * 4.0 / HEIGHT**2 * ngs.y * (HEIGHT - ngs.y)
        self.flow.components[0].Set(ngs.CF((profile, 0)), definedon=self.mesh.Boundaries("inlet"))

    def _flow(self, fluid: ngs.Region) -> ngs.BilinearForm:
        (u, p), (v, q) = self.space.TnT()
        form = ngs.BilinearForm(self.space)
        form += (
            VISCOSITY * ngs.InnerProduct(ngs.Grad(u) + ngs.Grad(u).trans, ngs.Grad(v))
            + DENSITY * ngs.InnerProduct(ngs.Grad(u) * u, v)
            - p * ngs.div(v)
            - q * ngs.div(u)
        ) * ngs.dx(definedon=fluid, bonus_intorder=4)
        return form

    def _solid(self, solid: ngs.Region) -> ngs.BilinearForm:
        u, v = self.displacements.TnT()
        F = ngs.Id(2) + ngs.Grad(u)
        E = 0.5 * (F.trans * F - ngs.Id(2))
        form = ngs.BilinearForm(self.displacements, symmetric=False)
        S = LAME_LAMBDA * ngs.Trace(E) * ngs.Id(2) + 2.0 * LAME_MU * E
        form += ngs.InnerProduct(F * S, ngs.Grad(v)) * ngs.dx(definedon=solid)
        return form

    def extended(self, d: ngs.GridFunction) -> ngs.GridFunction:
        """Displacement of the solid, continued harmonically into the fluid."""
        e = ngs.GridFunction(self.displacements)
        e.vec.data = d.vec
        e.vec.FV().NumPy()[self.only_fluid] = 0.0
        residual = e.vec.CreateVector()
        residual.data = -self.extension.mat * e.vec
        e.vec.data += self.extend_inverse * residual
        return e

    def force(self, residual: ngs.BaseVector, direction: tuple[float, float]) -> float:
        """Force on cylinder and flag."""
        test = ngs.GridFunction(self.space)
        test.components[0].Set(ngs.CF(direction), definedon=self.mesh.Boundaries("cylinder|flag"))
        return -ngs.InnerProduct(residual, test.vec)

    def solve_flow(self, d: ngs.GridFunction) -> tuple[np.ndarray, float, float]:
        """Nodal residuals of the momentum, drag and lift for a displacement."""
        self.mesh.SetDeformation(self.extended(d))
        newton(self.flow_form, self.flow, self.free_flow, np.zeros(0), 1e-10)
        residual = self.flow.vec.CreateVector()
        self.flow_form.Apply(self.flow.vec, residual)
        drag, lift = self.force(residual, (1.0, 0.0)), self.force(residual, (0.0, 1.0))
        self.mesh.UnsetDeformation()
        return residual.FV().NumPy()[: self.count].copy(), drag, lift


def main(order: int = 4, tip: float = 3e-3, iterations: int = 12) -> Result:
    """Iterate to the steady state."""
    coupled = Coupled(order, tip)
    d = ngs.GridFunction(coupled.displacements)
    for _ in range(iterations):
        load, drag, lift = coupled.solve_flow(d)
        image = ngs.GridFunction(coupled.displacements)
        image.vec.data = d.vec
        newton(coupled.solid_form, image, coupled.free_solid, load, 1e-14)
        change = d.vec.CreateVector()
        change.data = image.vec - d.vec
        d.vec.data += RELAXATION * change
        u_x, u_y = image(coupled.mesh(0.6 - 1e-10, 0.2))
        result = Result(coupled.mesh.ne, u_x, u_y, drag, lift, float(ngs.Norm(change)))
        print(result, flush=True)
        if result.change < 1e-8:
            break
    return result


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--order", type=int, default=4)
    parser.add_argument("--tip", type=float, default=3e-3, help="element size at the flag's free corners")
    options = parser.parse_args()
    main(options.order, options.tip)
