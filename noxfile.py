"""Sessions of the repository: ``nox --list`` shows them, ``nox -s NAME -- ARGUMENTS`` runs one."""

from __future__ import annotations

import os
from pathlib import Path

import nox

nox.needs_version = ">=2024.3.2"
nox.options.sessions = ["tests"]
nox.options.reuse_venv = "yes"
nox.options.default_venv_backend = "uv|virtualenv"
nox.options.error_on_missing_interpreters = True

ROOT = Path(__file__).parent
HOBLOCK = "packages/hoblock"
HOFSI = "packages/hofsi-coupler"
SOURCES = os.pathsep.join(str(ROOT / package / "src") for package in (HOBLOCK, HOFSI))

# What benchmarks compare with, besides Gmsh and scikit-fem.
KRATOS = "FSI FluidDynamics StructuralMechanics MeshMoving Mapping ConstitutiveLaws LinearSolvers CoSimulation"
PEERS = ("ngsolve", *(f"Kratos{name}Application" for name in KRATOS.split()))

# Tests run on all processors; those of a file stay together, for they share what is slow to make.
TOGETHER = ("-n", "auto", "--maxprocesses", "4", "--dist", "loadfile")
ONE_THREAD = {"OMP_NUM_THREADS": "1"}  # more threads than processors would wait for each other

# Tools whose next release may judge the same code differently.
RUFF = "ruff==0.17.6"
MYPY = "mypy==2.4.1"
IMPORT_LINTER = "import-linter==2.16"


def install_packages(session: nox.Session, *others: str) -> None:
    """Install both packages with all their extras, editable, and the other requirements."""
    session.install("-e", f"{HOBLOCK}[hdf,plot]", "-e", f"{HOFSI}[all]", *others)


@nox.session
def tests(session: nox.Session) -> None:
    """Run all tests but the slow ones on all processors, four at most; add -m slow to run those."""
    install_packages(session, "pytest", "pytest-xdist", "hypothesis", "gmsh")
    # An oracle that has no wheel for some machines; its tests are skipped there.
    session.install("--only-binary=mfem", "mfem", success_codes=[0, 1])
    session.run("pytest", "-m", "not slow and not verification", *TOGETHER, *session.posargs, env=ONE_THREAD)


@nox.session(reuse_venv=False)
def isolated(session: nox.Session) -> None:
    """Build hoblock's wheel, install it alone without extras, and run its tests against it."""
    session.install("build", "pytest", "pytest-xdist", "hypothesis")
    wheels = Path(session.create_tmp()) / "wheels"
    for old in wheels.glob("*.whl"):
        old.unlink()
    session.run("python", "-m", "build", "--wheel", "--outdir", str(wheels), HOBLOCK, silent=True)
    (wheel,) = wheels.glob("hoblock-*.whl")
    session.install(str(wheel))
    # An empty pythonpath hides the sources, so that the tests see what a user installs.
    session.run(
        "pytest",
        "-o",
        "pythonpath=",
        "-m",
        "not slow and not oracle",
        "tests/hoblock",
        *TOGETHER,
        *session.posargs,
        env={"PYTHONPATH": None, **ONE_THREAD},
    )


@nox.session
def lint(session: nox.Session) -> None:
    """Check the style of all Python files with ruff."""
    session.install(RUFF)
    session.run("ruff", "check", *(session.posargs or ["."]))


@nox.session
def types(session: nox.Session) -> None:
    """Check the types of both packages with mypy --strict."""
    session.install(MYPY, "numpy")
    session.run("mypy", *session.posargs)


@nox.session
def imports(session: nox.Session) -> None:
    """Check with import-linter that imports point only backwards along the data flow."""
    session.install(IMPORT_LINTER)
    session.run("lint-imports", *session.posargs, env={"PYTHONPATH": SOURCES})


@nox.session
def demo(session: nox.Session) -> None:
    """Run the Wall-Ramm flap for 200 steps at order 4 into results/demo."""
    install_packages(session)
    settings = ["mesh.order=4", "time.end=1.0"]
    changes = [word for setting in settings for word in ("--set", setting)]
    session.run("hofsi", "run", "examples/wall_ramm.toml", "-o", "results/demo", *changes, *session.posargs)


@nox.session
def verification(session: nox.Session) -> None:
    """Run the long comparisons with exact solutions and published values."""
    install_packages(session, "pytest", "hypothesis", "gmsh")
    session.run("pytest", "-m", "verification", "tests/verification", *session.posargs)


@nox.session(name="verification-long")
def verification_long(session: nox.Session) -> None:
    """Make the studies that take hours, as far as benchmarks/measured/ does not have them yet."""
    install_packages(session)
    session.run(
        "python",
        "benchmarks/flag_oscillations.py",
        "--json",
        "benchmarks/measured/flag_oscillations.json",
        "--picture",
        "docs/images/flag_oscillations.png",
        *session.posargs,
    )


def install_peers(session: nox.Session) -> None:
    """Install the programs that benchmarks compare with, as far as there are wheels for this machine."""
    for peer in PEERS:
        session.install(peer, success_codes=[0, 1])


@nox.session
def benchmarks(session: nox.Session) -> None:
    """Remake docs/benchmarks.md and docs/stability.md; --quick for less, or run the scripts given as arguments."""
    scripts = [name for name in session.posargs if name.endswith(".py")]
    options = [word for word in session.posargs if word not in scripts]
    install_packages(session, "gmsh")
    install_peers(session)
    for script in scripts or ["benchmarks/suite.py"]:
        session.run("python", script, *options, env=ONE_THREAD)


@nox.session
def stress(session: nox.Session) -> None:
    """Run what is built to break meshes, solvers and coupling, all of it or the groups given as arguments."""
    install_packages(session)
    command = ["benchmarks/stress_suite.py", *session.posargs]
    session.run("python", *(command if session.posargs else ("benchmarks/suite.py", "stress_suite")), env=ONE_THREAD)


@nox.session
def docs(session: nox.Session) -> None:
    """Check links and snippets of all Markdown pages, and run the Python of those about meshing."""
    install_packages(session, "pytest")
    session.run("pytest", "tests/test_docs.py", *session.posargs)
