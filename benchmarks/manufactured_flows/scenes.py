"""Scenes of 3 × 3 curved blocks for exact flows: the boundary waves, a hole in the middle moves, or nothing does."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

from manufactured_flows.flow import Flow

__all__ = ["SIDES", "Blocks", "curved_channel", "imposed", "waving_square"]

_ONE = "dt = 1\nsteps = 1"

SIDES = ("bottom", "right", "top", "left")
Node = tuple[int, int]

# v03 ── v13 ── v23 ── v33
#  │      │      │      │      all edges inside bulge, to one side and the other in turn;
# v02 ── v12 ── v22 ── v32     the block in the middle may be left out
#  │      │      │      │
# v01 ── v11 ── v21 ── v31
#  │      │      │      │
# v00 ── v10 ── v20 ── v30


@dataclass(frozen=True)
class Blocks:
    """A square of 3 × 3 blocks as the mesh of a scene.

    Attributes
    ----------
    low, high : float
        The corners are (low, low) and (high, high).
    bulge : float
        Height of the arcs of sine that edges inside follow, as a fraction of their length.
    hole : bool
        Whether the block in the middle is left out; its edges, named "hole", are straight.
    outer_bulge : float
        That of the edges at the bottom and at the top.
    """

    low: float
    high: float
    bulge: float = 0.1
    hole: bool = False
    outer_bulge: float = 0.0

    def scene(self, order: int, elements: int) -> str:
        """The ``[mesh]`` of a scene with some elements along each block edge."""
        lines = ["[mesh]", f"order = {order}", f"elements = {elements}", "[mesh.vertices]"]
        for i, j in product(range(4), repeat=2):
            x, y = self._place((i, j))
            lines.append(f"v{i}{j} = [{x!r}, {y!r}]")
        quads = [(i, j) for j, i in product(range(3), repeat=2) if not (self.hole and i == j == 1)]
        names = (f'["v{i}{j}", "v{i + 1}{j}", "v{i + 1}{j + 1}", "v{i}{j + 1}"]' for i, j in quads)
        lines += ["[mesh.blocks]", f"fluid = [{', '.join(names)}]", "[mesh.edges]"]
        lines += [f"{name} = [{path}]" for name, path in _SIDES.items() if self.hole or name != "hole"]
        return "\n".join(lines) + "\n" + "".join(self._curve(a, b) for a, b in _edges())

    def _place(self, node: Node) -> tuple[float, float]:
        width = (self.high - self.low) / 3.0
        return self.low + node[0] * width, self.low + node[1] * width

    def _curve(self, a: Node, b: Node) -> str:
        """A curve from a to b, or nothing if that edge is straight."""
        along = 0 if a[1] == b[1] else 1
        line = a[1 - along]
        bulge = self.bulge if line in (1, 2) else self.outer_bulge * (1 - along)
        if not bulge or (self.hole and line in (1, 2) and a[along] == 1):
            return ""
        height = bulge * (self.high - self.low) / 3.0 * (-1) ** (a[0] + a[1])
        (x0, y0), (x1, y1) = self._place(a), self._place(b)
        parts = [f"{x0!r} + ({x1 - x0!r})*s", f"{y0!r} + ({y1 - y0!r})*s"]
        parts[1 - along] += f" + ({height!r})*sin(pi*s)"
        pair = f'[["v{a[0]}{a[1]}", "v{b[0]}{b[1]}"]]'
        return f'[[mesh.curve]]\non = {pair}\nkind = "parametric"\nx = "{parts[0]}"\ny = "{parts[1]}"\n'


_SIDES = {
    "bottom": '["v00", "v10", "v20", "v30"]',
    "right": '["v30", "v31", "v32", "v33"]',
    "top": '["v03", "v13", "v23", "v33"]',
    "left": '["v00", "v01", "v02", "v03"]',
    "hole": '["v11", "v21", "v22", "v12", "v11"]',
}


def _edges() -> list[tuple[Node, Node]]:
    ahead = [((i, j), (i + 1, j)) for i, j in product(range(3), range(4))]
    return ahead + [((i, j), (i, j + 1)) for i, j in product(range(4), range(3))]


def waving_square(
    flow: Flow, order: int, elements: int, *, time: str = _ONE, mover: str = "barrier", convection: str | None = None
) -> str:
    """A square of side 1 about the origin whose boundary waves, as far as 0.08 at t = 1; the velocity is given on it.

    The boundary moves as in Fehn, Heinz, Wall, Kronbichler, J. Comput. Phys. 430 (2021) 110040,
    doi:10.1016/j.jcp.2020.110040; the mesh inside is made from blocks.
    """
    wave = "0.08*sin(pi*t/2)*sin(2*pi*({} + 0.5))"
    motion = _motion("bottom", "right", "top", "left", x=wave.format("y"), y=wave.format("x"))
    mesh = Blocks(-0.5, 0.5).scene(order, elements)
    return mesh + flow.scene(SIDES, convection=convection) + motion + _rest(mover, time)


def imposed(
    flow: Flow, order: int, elements: int, *, time: str = _ONE, mover: str = "barrier", convection: str | None = None
) -> str:
    """The unit square with a hole in the middle that shrinks and grows again in 1; σ·n is given on the right.

    The hole moves as all nodes do in the ALE test with imposed motion of github.com/andrealaspina/galerkin.
    """
    across = "sin(2*pi*{0})*(1 - cos(2*pi*{1}))*(1 - cos(2*pi*t))/32"
    motion = _motion("hole", x=across.format("x", "y"), y=across.format("y", "x"))
    mesh = Blocks(0.0, 1.0, hole=True).scene(order, elements)
    return mesh + flow.scene(("bottom", "top", "left", "hole"), "right", convection) + motion + _rest(mover, time)


def curved_channel(flow: Flow, order: int, elements: int) -> str:
    """A square with curved blocks and curved sides, at rest, σ·n given on the right."""
    mesh = Blocks(-0.5, 1.0, outer_bulge=0.1).scene(order, elements)
    steady = "[nonlinear]\ntolerance = 1e-13\n[time]\nsteady = true\n"
    return mesh + flow.scene(("bottom", "top", "left"), "right") + steady


def _motion(*on: str, x: str, y: str) -> str:
    names = ", ".join(f'"{name}"' for name in on)
    return f'[[motion]]\non = [{names}]\nx = "{x}"\ny = "{y}"\n'


def _rest(mover: str, time: str) -> str:
    return f'[mover]\ntype = "{mover}"\n[nonlinear]\ntolerance = 1e-13\n[time]\n{time}\n'
