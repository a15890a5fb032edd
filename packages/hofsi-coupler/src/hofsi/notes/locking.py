"""Elements that lock: solids that are nearly incompressible, of low order."""

from __future__ import annotations

from collections.abc import Iterator

from hofsi.case import Case

__all__ = ["locking"]

_NEARLY_INCOMPRESSIBLE = 0.49
_ENOUGH = 4  # order from which bending is right to a few percent at ν = 0.4999 on a few elements


def locking(case: Case) -> Iterator[str]:
    """Say which solids are too stiff on elements of the mesh's order."""
    for solid in case.solids:
        if solid.poissons_ratio >= _NEARLY_INCOMPRESSIBLE and solid.plane == "strain" and case.mesh.order < _ENOUGH:
            yield (
                f"solid {solid.name!r} is nearly incompressible (ν = {solid.poissons_ratio:g}): elements of order "
                f"{case.mesh.order} lock, and it will be too stiff, at order 1 by far. Set mesh.order to {_ENOUGH} or "
                "more"
            )
