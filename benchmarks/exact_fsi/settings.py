"""What the scenes of all exact solutions may vary."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["SCHEMES", "Settings"]

SCHEMES = ("bdf2", "generalised-alpha", "energy-momentum")


@dataclass(frozen=True)
class Settings:
    """Discretisation of a scene.

    Attributes
    ----------
    order : int
    elements : int
        Along every block edge.
    dt : float
    steps : int
    geometry : {"extrapolated", "implicit"}
        As ``coupling.geometry``.
    scheme : str
        As ``time.solid``.
    model : str
        Of the solid.
    tolerance : float
        Of the coupling.
    """

    order: int
    elements: int = 1
    dt: float = 1.0
    steps: int = 1
    geometry: str = "extrapolated"
    scheme: str = "bdf2"
    model: str = "linear"
    tolerance: float = 1e-7

    def scene(self) -> str:
        """The ``[time]`` and ``[coupling]`` of the scene."""
        return f"""
[time]
dt = {self.dt!r}
steps = {self.steps}
solid = "{self.scheme}"
halvings = 0

[coupling]
geometry = "{self.geometry}"
tolerance = {self.tolerance!r}

[nonlinear]
tolerance = 1e-12
"""
