"""All tables and pictures of docs/benchmarks.md and docs/stability.md, made by one command.

    python benchmarks/suite.py                # an hour on two processors, two studies at a time
    python benchmarks/suite.py --quick        # some minutes: smaller studies, pages in results/quick
    python benchmarks/suite.py skipping bench # some of them

Each study is a script and a process of its own that writes a JSON file; its output is in results/suite/NAME.log. One
that fails leaves its table as it was. Peers are compared with where they are installed.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

from _pages import filled

ROOT = Path(__file__).resolve().parent.parent
_PEER = "--ngsolve"  # asked for where it is installed
PAGES = ("benchmarks.md", "stability.md")


@dataclass(frozen=True)
class Study:
    """A script that makes a table, and perhaps a picture.

    Attributes
    ----------
    name : str
        Of its table.
    script : str
        In benchmarks/; "" for ``hofsi bench``.
    arguments, quick : tuple of str
        Of the whole study, and of a smaller one.
    picture : str
        Of the image in docs/images/; "" if there is none.
    needs : str
        A package without which it cannot be made; "" if there is none.
    """

    name: str
    script: str
    arguments: tuple[str, ...] = ()
    quick: tuple[str, ...] = ("--quick",)
    picture: str = ""
    needs: str = ""

    @property
    def missing(self) -> bool:
        """Whether it cannot be made here."""
        return bool(self.needs) and find_spec(self.needs) is None

    def command(self, folder: Path, images: Path, *, quick: bool) -> list[str]:
        """What to run."""
        program = [str(ROOT / "benchmarks" / self.script)] if self.script else ["-m", "hofsi", "bench"]
        picture = ["--picture", str(images / self.picture)] if self.picture else []
        wanted = [word for word in (self.quick if quick else self.arguments) if word != _PEER or find_spec("ngsolve")]
        return [sys.executable, *program, *wanted, "--json", str(folder / f"{self.name}.json"), *picture]


# The longest first, so that two at a time end together.
STUDIES = (
    Study("flag_precision", "flag_oscillations.py", ("--runs", "precision"), ("--runs", "quick"), "flag_precision.png"),
    Study("bench", ""),
    Study("stress_suite", "stress_suite.py"),
    Study("coupling_regime", "coupling_regime.py", picture="coupling_regime.png"),
    Study("flap_kratos", "peers/flap_kratos.py", picture="flap_kratos.png", needs="KratosMultiphysics"),
    Study(
        "mesh_motion",
        "mesh_motion.py",
        ("--tests", "WR", "T4b", "--layouts", "f4", "cross24", "--elements", "2", "--steps", "30", "--limit", "10"),
        ("--tests", "WR", "--layouts", "f1", "--elements", "1", "--steps", "10", "--limit", "10"),
        "bench_mesh_motion.png",
    ),
    Study("fsi1_work_precision", "fsi1_work_precision.py", picture="fsi1_work_precision.png"),
    Study(
        "fluid_work_precision",
        "fluid_work_precision.py",
        ("--ngsolve", "--repeats", "2"),
        ("--orders", "2", "4", "6", "8", "--counts", "1,2,4,3"),
        "bench_fluid_work_precision.png",
    ),
    Study("solid_work_precision", "solid_work_precision.py", picture="solid_work_precision.png"),
    Study(
        "gmsh_transfinite",
        "peers/gmsh_transfinite.py",
        ("--nodes", "300000"),
        ("--nodes", "30000", "--orders", "2", "4"),
        needs="gmsh",
    ),
    Study("skipping", "skipping.py"),
    Study("step_profile", "step_profile.py"),
)


@dataclass
class Running:
    """A study that was started."""

    study: Study
    process: subprocess.Popen[bytes]
    began: float


def start(study: Study, folder: Path, images: Path, *, quick: bool) -> Running:
    """Start a study; what an earlier one left goes first."""
    (folder / f"{study.name}.json").unlink(missing_ok=True)
    environment = {**os.environ, "OMP_NUM_THREADS": "1"}
    with (folder / f"{study.name}.log").open("wb") as log:
        command = study.command(folder, images, quick=quick)
        process = subprocess.Popen(command, stdout=log, stderr=subprocess.STDOUT, env=environment, cwd=ROOT)
    return Running(study, process, time.monotonic())


def carry_out(studies: Sequence[Study], folder: Path, images: Path, *, quick: bool, jobs: int) -> list[str]:
    """Run studies, so many at a time, and return the names of those that did not succeed."""
    waiting, running, failed = [study for study in studies if not study.missing], list[Running](), list[str]()
    for study in studies:
        if study.missing:
            print(f"{study.name}: not made, for {study.needs} is not installed", flush=True)
    while waiting or running:
        while waiting and len(running) < jobs:
            running.append(start(waiting.pop(0), folder, images, quick=quick))
        time.sleep(0.2)
        for done in [one for one in running if one.process.poll() is not None]:
            running.remove(done)
            name, minutes = done.study.name, (time.monotonic() - done.began) / 60.0
            good = done.process.returncode == 0
            told = "done" if good else f"exit code {done.process.returncode}, see {folder / name}.log"
            print(f"{name}: {minutes:.1f} min, {told}", flush=True)
            failed += [] if good else [name]
    return failed


def main(argv: Sequence[str] | None = None) -> int:
    """Make the studies and the pages."""
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    names = [study.name for study in STUDIES]
    options.add_argument("studies", nargs="*", metavar="STUDY", help=f"of {', '.join(names)}; default all")
    options.add_argument("--quick", action="store_true", help="smaller studies; docs/ stays as it is")
    options.add_argument("--pages", action="store_true", help="run nothing; write the pages from the results there are")
    options.add_argument(
        "--jobs", type=int, default=min(2, os.cpu_count() or 1), help="at a time (default: %(default)s)"
    )
    asked = options.parse_args(argv)
    unknown = sorted(set(asked.studies) - set(names))
    if unknown:
        options.error(f"there is no study {unknown[0]!r}; expected one of {', '.join(names)}")
    folder = ROOT / "results" / ("quick" if asked.quick else "suite")
    images = folder if asked.quick else ROOT / "docs" / "images"
    folder.mkdir(parents=True, exist_ok=True)
    began = time.monotonic()
    chosen = [study for study in STUDIES if not asked.studies or study.name in asked.studies]
    failed = [] if asked.pages else carry_out(chosen, folder, images, quick=asked.quick, jobs=asked.jobs)
    for page in PAGES:
        text, missing = filled((ROOT / "docs" / page).read_text(encoding="utf-8"), folder)
        target = folder / page if asked.quick else ROOT / "docs" / page
        target.write_text(text, encoding="utf-8")
        print(f"wrote {target}" + (f"; as they were: {', '.join(missing)}" if missing else ""))
    print(f"{(time.monotonic() - began) / 60.0:.1f} min")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
