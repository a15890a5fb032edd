"""Mesh-motion tests: bodies that move in boxes of blocks, defined in docs/meshing/mesh_motion_tests.md."""

from __future__ import annotations

from motion_cases import block, flag, flap, plate
from motion_cases.case import MotionCase

_BODIES = (
    (plate.MOTIONS, plate.LAYOUTS, plate.plate_case),
    (block.MOTIONS, block.LAYOUTS, block.block_case),
    (flap.MOTIONS, flap.LAYOUTS, flap.flap_case),
    (flag.MOTIONS, flag.LAYOUTS, flag.flag_case),
)
_MAKERS = {(test, layout): make for motions, layouts, make in _BODIES for test in motions for layout in layouts}

CASES: tuple[tuple[str, str], ...] = tuple(_MAKERS)

__all__ = ["CASES", "MotionCase", "motion_case"]


def motion_case(test: str, layout: str, elements: int = 4) -> MotionCase:
    """Case of a test on a layout, one of ``CASES``.

    Parameters
    ----------
    test, layout : str
    elements : int
        Along every block edge.

    Raises
    ------
    ValueError
        If there is no such test, or the test has no such layout.
    TopologyError
        If the number of elements is not a positive integer.
    """
    layouts = [known for name, known in CASES if name == test]
    if not layouts:
        tests = ", ".join(dict.fromkeys(name for name, _ in CASES))
        raise ValueError(f"motion_case: there is no test {test!r}; expected one of {tests}.")
    if layout not in layouts:
        raise ValueError(f"motion_case: {test} has no layout {layout!r}; expected one of {', '.join(layouts)}.")
    return _MAKERS[test, layout](test, layout, elements)
