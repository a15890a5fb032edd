"""Errors against seconds of several programs: who reaches what first, and the picture of it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

__all__ = ["draw", "factors"]

Rows = Sequence[Mapping[str, Any]]
GOALS = (1e-4, 1e-5, 1e-6, 1e-7, 1e-8)
MARKS = {"hofsi": "o", "NGSolve": "^"}


def factors(rows: Rows, seconds: str, error: str) -> list[dict[str, Any]]:
    """For each goal the cheapest run of each program that reaches it, and the time of NGSolve over that of hofsi."""
    found = []
    for goal in GOALS:
        row: dict[str, Any] = {"error": goal}
        for program in MARKS:
            good = [run for run in rows if run["program"] == program and run[error] <= goal]
            best = min(good, key=lambda run: run[seconds]) if good else None
            row[program] = best[seconds] if best else None
            row[f"{program} run"] = f"order {best['order']}, {best['elements']} elements" if best else "none"
        both = row["hofsi"] is not None and row["NGSolve"] is not None
        row["factor"] = row["NGSolve"] / row["hofsi"] if both else None
        found.append(row)
    return found


def draw(rows: Rows, seconds: str, names: Mapping[str, str], file: Path) -> None:
    """Draw each error against seconds, with the line of what nothing faster beats."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(11.0, 8.0), layout="constrained")
    FigureCanvasAgg(figure)
    for axes, (column, title) in zip(figure.subplots(2, 2).flat, names.items(), strict=True):
        for colour, (program, mark) in zip(("tab:blue", "tab:orange"), MARKS.items(), strict=True):
            mine = sorted((run for run in rows if run["program"] == program), key=lambda run: run[seconds])
            if not mine:
                continue
            axes.plot([r[seconds] for r in mine], [r[column] for r in mine], mark, color=colour, ms=4, alpha=0.35)
            best: list[Mapping[str, Any]] = []
            for run in mine:
                if not best or run[column] < best[-1][column]:
                    best.append(run)
            axes.plot([r[seconds] for r in best], [r[column] for r in best], mark + "-", color=colour, label=program)
            for run in best:
                place = (run[seconds], run[column])
                axes.annotate(str(run["order"]), place, (4, 4), textcoords="offset points", fontsize=7, color=colour)
        axes.set(xscale="log", yscale="log", xlabel="CPU seconds", ylabel="error", title=title)
        axes.grid(visible=True, which="major", alpha=0.3)
        axes.legend()
    file.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(file, dpi=110)
