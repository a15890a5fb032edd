"""The contest as one picture: reach of each method on each test, as a fraction of the test's range."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

__all__ = ["draw_reaches"]


def draw_reaches(rows: Sequence[Mapping[str, object]], file: Path) -> Path:
    """Draw a table of colours with the reach in the test's own unit, and after / that with scaled Jacobian 0.2."""
    tests = list(dict.fromkeys((str(row["test"]), str(row["layout"]), float(row["end"])) for row in rows))
    names = list(dict.fromkeys((str(row["family"]), str(row["mover"])) for row in rows))
    share = np.full((len(names), len(tests)), np.nan)
    figure = Figure(figsize=(1.5 + 1.05 * len(tests) + 3.0, 1.5 + 0.33 * len(names)), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    for row in rows:
        j = tests.index((str(row["test"]), str(row["layout"]), float(row["end"])))
        i = names.index((str(row["family"]), str(row["mover"])))
        share[i, j] = float(row["reach"]) / float(row["end"])
        text = f"{float(row['reach']):.3g} / {float(row['fair reach']):.3g}"
        axes.text(j, i, text, ha="center", va="center", fontsize=7, color="black" if share[i, j] > 0.25 else "white")
    axes.imshow(share, cmap="viridis", vmin=0.0, vmax=1.0, aspect="auto")
    axes.set_xticks(range(len(tests)), [f"{test}\n{layout}\n[{end:g}]" for test, layout, end in tests], fontsize=8)
    axes.set_yticks(range(len(names)), [f"{family}: {name}" for family, name in names], fontsize=8)
    axes.xaxis.tick_top()
    for k in range(1, len(names)):
        if names[k][0] != names[k - 1][0]:
            axes.axhline(k - 0.5, color="red", linewidth=1.5)
    axes.set_title("Last certified position / last one with scaled Jacobian ≥ 0.2; colour: fraction of the range")
    file.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(file, dpi=130)
    return file
