"""Errors against seconds of several programs: who reaches what first, and the picture of it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

__all__ = ["draw", "factors", "factors_table"]

Rows = Sequence[Mapping[str, Any]]
GOALS = (1e-4, 1e-5, 1e-6, 1e-7, 1e-8)
MARKS = {"hofsi": ("o", "tab:blue"), "NGSolve": ("^", "tab:orange"), "scikit-fem": ("s", "tab:green"),
         "Kratos": ("v", "tab:red")}  # fmt: skip


def programs(rows: Rows) -> list[str]:
    """The programs that were run, hofsi first."""
    return [name for name in MARKS if any(run["program"] == name for run in rows)]


def factors(rows: Rows, seconds: str, error: str, goals: Sequence[float] = GOALS) -> list[dict[str, Any]]:
    """For each goal the cheapest run of each program that reaches it, and the peers' times over that of hofsi."""
    found = []
    for goal in goals:
        row: dict[str, Any] = {"error": goal}
        for program in programs(rows):
            good = [run for run in rows if run["program"] == program and run[error] <= goal]
            best = min(good, key=lambda run: run[seconds]) if good else None
            row[program] = best[seconds] if best else None
            row[f"{program} run"] = f"order {best['order']}, {best['elements']} elements" if best else "none"
            if program != "hofsi":
                both = row["hofsi"] is not None and row[program] is not None
                row["factor" if program == "NGSolve" else f"factor, {program}"] = (
                    row[program] / row["hofsi"] if both else None
                )
        found.append(row)
    return found


def factors_table(lines: Sequence[Mapping[str, Any]], below: str) -> str:
    """The factors as a Markdown table."""
    names = [name for name in MARKS if name in lines[0]]
    head = [below, *(part for name in names for part in (name, "s"))]
    peers = [name for name in names if name != "hofsi"]
    rows = [[*head, *(f"{name} / hofsi" for name in peers)], ["---"] * (len(head) + len(peers))]
    for line in lines:
        row = [f"{line['error']:.0e}".replace("e-0", "e-")]
        for name in names:
            row += [line[f"{name} run"], "" if line[name] is None else f"{line[name]:.2g}"]
        for name in peers:
            factor = line["factor" if name == "NGSolve" else f"factor, {name}"]
            row.append("" if factor is None else f"{factor:.1f}")
        rows.append(row)
    return "\n".join("| " + " | ".join(row) + " |" for row in rows)


def draw(rows: Rows, seconds: str, names: Mapping[str, str], file: Path) -> None:
    """Draw each error against seconds, with the line of what nothing faster beats."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    wide = 2 if len(names) > 1 else 1
    figure = Figure(figsize=(5.5 * wide, 4.0 * -(-len(names) // wide)), layout="constrained")
    FigureCanvasAgg(figure)
    panels = figure.subplots(-(-len(names) // wide), wide, squeeze=False).flat
    for axes, (column, title) in zip(panels, names.items(), strict=False):
        for program in programs(rows):
            mark, colour = MARKS[program]
            mine = sorted((run for run in rows if run["program"] == program), key=lambda run: run[seconds])
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
