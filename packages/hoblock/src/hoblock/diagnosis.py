"""Why elements are not valid, from the geometry of their blocks: angles, crossings, folds, gradings, coarseness."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hoblock.block_geometry import BlockGeometry, Crossing
from hoblock.blocks import BlockStructure
from hoblock.errors import CurveError
from hoblock.layout import Layout, layout
from hoblock.mesh import QuadMesh
from hoblock.quality import BadElement, Certificate, bad_elements

Array = NDArray[np.float64]

__all__ = ["diagnose", "invalid_mesh_message"]

_LISTED = 100
"""Bad elements that are looked at; thousands are as good as a hundred."""
_EXPLAINED = 5
"""Bad elements whose reason is sought in the geometry of their block."""
_STRAIGHT = 1e-5
"""Angles are known to this many degrees: they come from differences of the curves."""


def diagnose(mesh: QuadMesh, structure: BlockStructure, certificate: Certificate) -> tuple[BadElement, ...]:
    """Name the worst elements of a mesh that are not proven valid, with their blocks and the reasons.

    Parameters
    ----------
    mesh : QuadMesh
    structure : BlockStructure
        What the mesh was made from.
    certificate : Certificate
        Of the mesh.

    Returns
    -------
    tuple of BadElement
        Invalid ones first, each kind by ascending det J; at most 100. The first five carry a reason from the geometry
        of their block.
    """
    plan = layout(structure, mesh.order)
    found = bad_elements(mesh, certificate, certificate.doubtful[:_LISTED])
    found.sort(key=lambda bad: (bad.status != "invalid", not np.isnan(bad.det_J), bad.det_J))
    blocks = plan.block_of_cell[[bad.element for bad in found]]
    named = [
        replace(bad, block=structure.topology.block_name(int(block))) for bad, block in zip(found, blocks, strict=True)
    ]
    diagnoses: dict[int, _BlockDiagnosis] = {}
    for k, block in enumerate(blocks[:_EXPLAINED].tolist()):
        if block not in diagnoses:
            diagnoses[block] = _BlockDiagnosis(structure, plan, block)
        with np.errstate(all="ignore"):  # bad meshes may be infinite or huge
            reason = diagnoses[block].reason(named[k])
        named[k] = replace(named[k], reason=reason or named[k].reason)
    return tuple(named)


def invalid_mesh_message(certificate: Certificate, worst: tuple[BadElement, ...]) -> str:
    """Sentence that says how many elements are bad, which are the worst ones, where and why."""
    counts, total = certificate.counts, len(certificate.status)
    kinds = []
    if counts["invalid"]:
        kinds.append("invalid: det J <= 0 somewhere")
    if counts["undecided"]:
        kinds.append("undecided: rounding hides the sign of det J")
    numbers = [counts[kind.partition(":")[0]] for kind in kinds]
    parts = " and ".join(
        f"{number} of {total} elements {'is' if number == 1 else 'are'} {kind}"
        for number, kind in zip(numbers, kinds, strict=True)
    )
    first, others = worst[0], worst[1:_EXPLAINED]
    text = f"{parts}. Worst: {_place(first)}. {first.reason}"
    told = {first.reason}
    for bad in others:
        text += f" Also: {_place(bad)}."
        if bad.reason not in told:
            text += f" {bad.reason}"
            told.add(bad.reason)
    return text


def _place(bad: BadElement) -> str:
    return (
        f"element {bad.element} in {bad.block}, det J = {bad.det_J:.3g} at (xi, eta) = ({bad.xi:.3g}, {bad.eta:.3g}), "
        f"(x, y) = ({bad.x:.6g}, {bad.y:.6g})"
    )


class _BlockDiagnosis:
    """What is wrong with a block, found once, and with its elements."""

    def __init__(self, structure: BlockStructure, plan: Layout, block: int) -> None:
        self.structure, self.plan, self.block = structure, plan, block

    @cached_property
    def geometry(self) -> BlockGeometry:
        return BlockGeometry(self.structure, self.block)

    def reason(self, bad: BadElement) -> str | None:
        """Return a sentence on why an element is bad and what to do; None if its block shows nothing."""
        try:
            return self._reason(bad)
        except CurveError:  # the curve has points at the nodes, but not everywhere between them
            return None

    def _reason(self, bad: BadElement) -> str | None:
        if np.isnan(bad.det_J):
            return self._not_finite()
        if self._of_block is not None:
            return self._of_block
        if bad.status != "invalid":
            return None
        sides = self._parameters(bad.element)
        if self.geometry.folds_within(*sides):
            return self._grading_reason()
        return self._coarse_reason()

    def _not_finite(self) -> str:
        for side in range(4):
            if not np.isfinite(self.geometry.sampled[side]).all():
                return (
                    f"Its nodes are not finite: the edge {self.geometry.side_name(side)} has points that are NaN or "
                    "infinite. Check its vertices and its curve."
                )
        return "Its nodes are not finite. Check where the points of the mesh come from."

    @cached_property
    def _of_block(self) -> str | None:
        """The first thing that is wrong with the block as a whole."""
        geometry = self.geometry
        lengths = geometry.lengths()
        if lengths.min() <= 1e-14 * lengths.max():
            name = geometry.side_name(int(lengths.argmin()))
            return f"The edge {name} of its block has no length. Move one of its vertices."
        crossing = geometry.crossing()
        if crossing is not None:
            return _crossing_reason(geometry, crossing)
        if geometry.area < 0.0:
            return "The block is inverted: its vertices run clockwise. Check the positions of its vertices."
        angles = geometry.angles()
        wrong = np.flatnonzero((angles >= 180.0 - _STRAIGHT) | (angles <= _STRAIGHT))
        if wrong.size:
            corner = int(wrong[0])
            return _angle_reason(geometry, corner, float(angles[corner]))
        if geometry.folds():
            return _fold_reason(geometry)
        return None

    def _parameters(self, element: int) -> tuple[Array, Array, Array, Array]:
        """Parameters (2,) at the ends of an element on bottom, top, left, right of its block."""
        plan, p = self.plan, self.plan.order
        bottom, right, top, left = (plan.parameters_of_edge(edge)[::p] for edge in self.geometry.edges)
        row, column = divmod(element - int(plan.numbers.cell_starts[self.block]), len(bottom) - 1)
        across, up = slice(column, column + 2), slice(row, row + 2)
        return bottom[across], top[across], left[up], right[up]

    def _grading_reason(self) -> str:
        geometry, gradings = self.geometry, self.structure.gradings
        pairs = [(a, b) for a, b in ((0, 2), (3, 1)) if gradings[geometry.edges[a]] != gradings[geometry.edges[b]]]
        if not pairs:
            pairs = [(0, 2), (3, 1)]
        names = " or ".join(f"{geometry.side_name(a)} and {geometry.side_name(b)}" for a, b in pairs)
        return (
            f"The grading is too strong: without it the block's map is valid, with it the lines of elements fold. Use "
            f"a milder or more equal grading on {names}, or split the block."
        )

    def _coarse_reason(self) -> str | None:
        curved = self.geometry.curved
        if not curved:
            return None
        counts = self.structure.topology.counts
        names = ", ".join(f"{self.geometry.side_name(k)} ({counts[self.geometry.edges[k]]})" for k in curved)
        return (
            f"The element is too coarse for a curve: the block's own map is valid there, its polynomial of order "
            f"{self.plan.order} is not. Use more elements along the curved edges (elements now: {names}) or a higher "
            "order."
        )


def _crossing_reason(geometry: BlockGeometry, crossing: Crossing) -> str:
    first, second = geometry.side_name(crossing.first), geometry.side_name(crossing.second)
    place = f"near ({crossing.place[0]:.6g}, {crossing.place[1]:.6g})"
    if crossing.first == crossing.second:
        return f"The curve of edge {first} crosses itself {place}. Change the curve."
    curved = [k for k in (crossing.first, crossing.second) if k in geometry.curved]
    opposite = crossing.second - crossing.first == 2
    if not curved:
        return f"The edges {first} and {second} of its block cross {place}. Move one of their vertices."
    bulging = geometry.side_name(curved[0])
    other = second if curved[0] == crossing.first else first
    kind = "opposite" if opposite else "neighbouring"
    return (
        f"The curve of edge {bulging} bulges through the {kind} edge {other} {place}. Give edge {other} a curve as "
        f"well, soften that of edge {bulging}, or move their vertices apart."
    )


def _angle_reason(geometry: BlockGeometry, corner: int, angle: float) -> str:
    following, before = (geometry.side_name(side) for side in geometry.corner_sides(corner))
    signed = angle - 360.0 if angle > 270.0 else angle
    expected = "must be above 0°" if signed <= _STRAIGHT else "must be below 180°"
    return (
        f"The angle at vertex '{geometry.corner_name(corner)}' between edges {before} and {following} is "
        f"{signed:.4g}°; {expected}. Move the vertex, or let a curve leave it in another direction."
    )


def _fold_reason(geometry: BlockGeometry) -> str:
    names = ", ".join(geometry.side_name(k) for k in geometry.curved)
    return (
        f"The map of the block folds between its edges: they neither cross nor meet at 180°, but bend too much for "
        f"lines blended between them. Split the block, or curve the edges opposite to: {names}."
    )
