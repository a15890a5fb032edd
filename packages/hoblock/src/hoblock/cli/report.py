"""Quality of a mesh in words and in JSON."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping, Sized
from typing import Any

from hoblock.cli.source import Source
from hoblock.fit import fit_errors
from hoblock.quality import MeasureSummary, QualitySummary, quality_summary

__all__ = ["as_json", "as_text", "overview", "rows"]

_MEASURES = {
    "scaled_jacobian": "scaled Jacobian",
    "jacobian_ratio": "Jacobian ratio",
    "skewness": "skewness",
    "aspect_ratio": "aspect ratio",
    "size_jump": "size jump",
}
_BAR = 40


def overview(source: Source) -> str:
    """Return size, validity and quality of a mesh in some lines."""
    mesh = source.mesh
    summary = quality_summary(mesh, worst=1)
    lines: dict[str, str] = {}
    if source.scene is None or source.structure is None:
        lines["mesh"] = source.name
    else:
        chains = len(set(source.structure.topology.chains.tolist()))
        lines["scene"] = f"{source.scene.file}{': ' + source.scene.title if source.scene.title else ''}"
        lines["blocks"] = f"{len(source.structure.topology.quads)} ({chains} chains of opposite edges)"
    lines |= {
        "elements": f"{summary.cells} of order {summary.order}",
        "nodes": str(summary.points),
        "area": f"{summary.area:.10g}",
        "det J": _validity(summary),
        "scaled Jacobian": f"min {summary.scaled_jacobian.min:.4g}, mean {summary.scaled_jacobian.mean:.4g}",
        "Jacobian ratio": f"min {summary.jacobian_ratio.min:.4g}",
        "skewness": f"max {summary.skewness.max:.4g}",
        "aspect ratio": f"max {summary.aspect_ratio.max:.4g}",
        "size jump": f"max {summary.size_jump.max:.4g}",
        **_fit(source),
        "groups": _sizes(mesh.cell_groups),
        "edges": _sizes(mesh.edge_groups),
    }
    return rows(lines)


def _fit(source: Source) -> dict[str, str]:
    """How far the elements are from the curves at most, and where; nothing without curves."""
    if source.structure is None:
        return {}
    errors = fit_errors(source.structure, source.mesh.order, source.mesh)
    if not errors:
        return {}
    worst = max(errors, key=errors.__getitem__)
    edges = f"{len(errors)} curved edge" + "s" * (len(errors) != 1)
    name = source.structure.topology.edge_name(worst)
    return {"curve fit": f"within {errors[worst]:.2g} ({edges}, worst {name})"}


def rows(lines: Mapping[str, str]) -> str:
    """Return names and values below each other."""
    return "\n".join(f"{name:<16} {value}" for name, value in lines.items())


def _validity(summary: QualitySummary) -> str:
    if summary.valid:
        return f"min {summary.min_det_j_bound:.4g} (positive everywhere, certified)"
    counts = ", ".join(f"{count} {status}" for status, count in summary.status_counts.items() if count)
    return f"bound {summary.min_det_j_bound:.4g}: not certified ({counts})"


def _sizes(groups: Mapping[str, Sized]) -> str:
    return ", ".join(f"{name} ({len(members)})" for name, members in groups.items()) or "none"


def as_text(source: Source, summary: QualitySummary) -> str:
    """Return the whole summary with histograms and the worst elements."""
    parts = [
        rows(
            {
                "mesh" if source.scene is None else "scene": source.name,
                "verdict": summary.verdict,
                "det J": _validity(summary),
                "elements": f"{summary.cells} of order {summary.order}",
                "nodes": str(summary.points),
                "area": f"{summary.area:.10g}",
            }
        )
    ]
    for key, name in _MEASURES.items():
        measure: MeasureSummary = getattr(summary, key)
        title = f"{name}: min {measure.min:.4g}, mean {measure.mean:.4g}, max {measure.max:.4g}"
        parts.append("\n".join([title, *_bars(measure)]))
    worst = [
        f"  element {bad.element} ({bad.status}): scaled Jacobian {bad.scaled_jacobian:.4g}, "
        f"det J ≥ {bad.det_j_bound:.4g} at ({bad.x:.6g}, {bad.y:.6g})"
        + (f" in {block}" if (block := source.block_of(bad.element)) else "")
        for bad in summary.worst_elements
    ]
    parts.append("\n".join(["worst elements", *worst]))
    return "\n\n".join(parts)


def _bars(measure: MeasureSummary) -> list[str]:
    """Lines of a histogram, from the first bin with elements to the last."""
    edges, counts = measure.histogram.edges, measure.histogram.counts
    most = max(max(counts), 1)
    bars = ["█" * math.ceil(_BAR * count / most) for count in counts]
    ends = [f"{edge:g}" for edge in edges]
    width = max(map(len, ends))
    filled = [k for k, count in enumerate(counts) if count]
    shown = range(filled[0], filled[-1] + 1) if filled else range(0)
    return [f"  {ends[k]:>{width}} to {ends[k + 1]:<{width}} {counts[k]:>8} {bars[k]}".rstrip() for k in shown]


def as_json(source: Source, summary: QualitySummary) -> dict[str, Any]:
    """Return the summary as plain data; numbers that are not finite become None."""
    data = dataclasses.asdict(summary)
    for bad in data["worst_elements"]:
        bad["block"] = source.block_of(bad["element"]) or None
    plain: dict[str, Any] = _finite({"source": source.name, **data})
    return plain


def _finite(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _finite(part) for key, part in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(part) for part in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
