"""Run one scene with each mover and draw the same quantity of all runs over time.

    python examples/compare_movers.py --end 4.0 -o results/compare_movers

By default the Wall–Ramm flap: the paper's comparison (its Fig. 5b) with the barrier energy beside it.
"""

from __future__ import annotations

import argparse
import csv
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

import hofsi

MOVERS = ("barrier", "pseudo-solid", "angle-optimisation")
QUIET = ("output.fields=false", "output.plots=false")
SCENE = Path(__file__).with_name("wall_ramm.toml")


@dataclass(frozen=True)
class Result:
    """What each mover gave.

    Attributes
    ----------
    times : dict of str to ndarray
    values : dict of str to ndarray
        The quantity, by mover.
    min_det_J : dict of str to float
        Smallest certified bound of det J over the run.
    iterations : dict of str to float
        Mean coupling iterations a step.
    seconds : dict of str to float
        Mean seconds a step.
    picture : Path
    """

    times: dict[str, np.ndarray]
    values: dict[str, np.ndarray]
    min_det_J: dict[str, float]
    iterations: dict[str, float]
    seconds: dict[str, float]
    picture: Path

    def peaks(self, mover: str) -> list[tuple[float, float]]:
        """Times and values of the upper peaks of a run."""
        t, y = self.times[mover], self.values[mover]
        top = np.flatnonzero((y[1:-1] > y[:-2]) & (y[1:-1] >= y[2:]) & (y[1:-1] > 0.0)) + 1
        return [(float(t[k]), float(y[k])) for k in top]


def main(
    scene: Path = SCENE,
    end: float = 4.0,
    output: Path = Path("results/compare_movers"),
    quantity: str = "u_y",
    changes: Sequence[str] = (),
) -> Result:
    """Run a scene with each mover.

    Parameters
    ----------
    scene : Path
    end : float
        Last time.
    output : Path
        Folder for the runs and the picture.
    quantity : str
        The quantity to draw.
    changes : sequence of str
        Further ``key=value`` changes of the scene.
    """
    times, values, bounds, iterations, seconds = {}, {}, {}, {}, {}
    for mover in MOVERS:
        settings = [
            f"time.end={end}",
            f'mover={{type="{mover}"}}',
            "output.fields=false",
            "output.plots=false",
            *changes,
        ]
        result = hofsi.run(hofsi.load_case(scene, settings), output / mover, changes=settings)
        times[mover], values[mover] = result.times, result.series[quantity]
        with (output / mover / "steps.csv").open() as table:
            steps = list(csv.DictReader(table))
        bounds[mover] = min(float(step["min_det_J"]) for step in steps)
        iterations[mover] = float(np.mean([float(step["coupling_iterations"]) for step in steps]))
        seconds[mover] = result.summary["seconds"]["total"] / len(steps)
    picture = draw(times, values, quantity, output / f"{quantity}.png")
    return Result(times, values, bounds, iterations, seconds, picture)


def draw(times: dict[str, np.ndarray], values: dict[str, np.ndarray], quantity: str, file: Path) -> Path:
    """Draw one curve a mover."""
    figure = Figure(figsize=(9.0, 4.0), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot(xlabel="t", ylabel=quantity)
    for (mover, t), style in zip(times.items(), ("-", "--", ":"), strict=True):
        axes.plot(t, values[mover], style, label=mover, linewidth=1.2)
    axes.grid(alpha=0.3)
    axes.legend()
    figure.savefig(file, dpi=150)
    return file


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scene", type=Path, default=SCENE)
    parser.add_argument("--end", type=float, default=4.0)
    parser.add_argument("--quantity", default="u_y")
    parser.add_argument("-o", "--output", type=Path, default=Path("results/compare_movers"))
    parser.add_argument("--set", dest="changes", nargs="*", default=[], metavar="KEY=VALUE")
    arguments = parser.parse_args()
    outcome = main(arguments.scene, arguments.end, arguments.output, arguments.quantity, arguments.changes)
    for name in MOVERS:
        last = ", ".join(f"{value:.4g}" for _, value in outcome.peaks(name)[-3:])
        print(
            f"{name}: {len(outcome.times[name])} steps, {outcome.seconds[name]:.3f} s and "
            f"{outcome.iterations[name]:.2f} iterations a step, "
            f"min det J {outcome.min_det_J[name]:.3g}, last peaks {last}"
        )
    print(outcome.picture)
