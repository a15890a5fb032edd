"""What is said of a coupled step that did not converge."""

from __future__ import annotations

from hofsi.case import CouplingSettings
from hofsi.coupling.convergence import ConvergenceTest, Residuals
from hofsi.coupling.stall import StallWatch, Verdict
from hofsi.errors import AddedMassError, ConvergenceError, CouplingError

__all__ = ["coupling_failure", "in_iteration", "rounding_failure", "solid_failure"]

_NEARLY = 1e-5  # residuals below it that do not fall any more are in the noise of the solvers, ...
_NEARLY_THERE = 1e-7  # ... and so is everything, whatever the force says, when the displacement is as near as that
_HEAVY = 1.0  # gain above which plain iteration diverges
_DOMINANT = 10.0  # gain above which it, and not the load itself, is what the solids cannot bear


def coupling_failure(
    verdict: Verdict,
    residuals: Residuals,
    test: ConvergenceTest,
    watch: StallWatch,
    settings: CouplingSettings,
    where: str,
    *,
    steady: bool,
    together: bool,
) -> CouplingError:
    """Return the error of a step that has used up its iterations, has stalled or diverges.

    Parameters
    ----------
    verdict : {"", "stalled", "diverging"}
        "" for a step that has used up its iterations.
    residuals : Residuals
        The last ones.
    test : ConvergenceTest
    watch : StallWatch
    settings : CouplingSettings
    where : str
    steady : bool
    together : bool
        Whether the solids took the fluid's answer into their solution.
    """
    problem = f"{_happened(verdict, watch)}: {_left(residuals, test)}."
    reason = {"": "max_iterations", "stalled": "stalled", "diverging": "diverged"}[verdict]
    stuck = bool(verdict) and residuals.largest < _NEARLY  # otherwise the iterations may have been too few
    if stuck or residuals.displacement < _NEARLY_THERE:
        way = (
            "That is close to the noise of the solvers: raise coupling.tolerance or coupling.force_tolerance, or lower "
            "nonlinear.tolerance."
        )
        return CouplingError(f"{problem} {way}", reason, where)
    more = _more(verdict, settings, apart=not (together or steady))
    if steady:
        way = _choice([*more, "lower the load", "start nearer to the solution"])
        return CouplingError(f"{problem} {way}", reason, where)
    if watch.gain <= _HEAVY:
        return CouplingError(f"{problem} {_choice(['lower time.dt', *more])}", reason, where)
    return _added_mass(problem, more, reason, where, watch)


def solid_failure(
    error: ConvergenceError, watch: StallWatch, settings: CouplingSettings, where: str, *, steady: bool, together: bool
) -> ConvergenceError:
    """Return what is said of solids that found no equilibrium under a load of the coupling's iteration.

    If the iterates led there because the fluid's added mass drives them apart, that; otherwise the error itself.

    Parameters
    ----------
    error : ConvergenceError
        Of the solids.
    watch : StallWatch
        With all iterations before that.
    settings : CouplingSettings
    where : str
    steady, together : bool
        As of `coupling_failure`.
    """
    if watch.gain <= _DOMINANT:
        return error
    problem = (
        f"diverging: after {watch.iterations} iterations the solids bear the fluid's load no more ({error.problem})"
    )
    more = _more("diverging", settings, apart=not (together or steady))
    return _added_mass(problem, more, "diverged", where, watch)


def rounding_failure(noise: float, where: str) -> CouplingError:
    """Return the error of a step so small that rounding of positions is a part ``noise`` of the fluid's load."""
    problem = (
        f"the step is so small that rounding of positions makes {100.0 * noise:.2g} % of the fluid's load, for "
        "accelerations are differences of positions over dt**2. Take larger steps: raise time.dt, or lower "
        "time.halvings."
    )
    return CouplingError(problem, "rounding", where)


def in_iteration(error: ConvergenceError, settings: CouplingSettings, *, steady: bool) -> ConvergenceError:
    """Return the error of a fluid, solid or mesh that was given an iterate of the coupling, which may be the cause."""
    if settings.condensed or steady or isinstance(error, CouplingError):
        return error
    return error.extended(
        "That was in an iteration between fluid and solid, which may have gone astray: leave coupling.condensed on, "
        "and they are solved together."
    )


def _added_mass(problem: str, ways: list[str], reason: str, where: str, watch: StallWatch) -> AddedMassError:
    added = (
        f"The fluid answers a displacement of the solid by {watch.gain:.2g} times the opposite one: its added mass "
        "dominates a light solid, and smaller steps do not change that"
    )
    way = _choice([*ways, "make the solid heavier or stiffer", "let loads begin less suddenly"])
    return AddedMassError(f"{problem} {added}. {way}", reason, where, gain=watch.gain, residual=watch.best)


def _happened(verdict: Verdict, watch: StallWatch) -> str:
    if verdict == "diverging":
        return f"diverging: in {watch.iterations} iterations the residual has grown by a factor of {watch.growth:.1g}"
    if verdict == "stalled":
        return f"stalled after {watch.iterations} iterations, the last 20 without progress"
    return f"not converged after {watch.iterations} iterations"


def _left(residuals: Residuals, test: ConvergenceTest) -> str:
    return (
        f"displacement residual {residuals.displacement:.2g}, expected below {test.tolerance:g}, force residual "
        f"{residuals.force:.2g}, expected below {test.force_tolerance:g}"
    )


def _more(verdict: Verdict, settings: CouplingSettings, *, apart: bool) -> list[str]:
    """Settings that may help, where fluid and solid could be solved together and are not, too."""
    ways = []
    if apart and settings.condensed:
        ways = ['let fluid and solid be solved together, with linear.solver = "direct" and linear steps of the fluid']
    elif apart:
        ways = ["leave coupling.condensed on"]
    ways += [] if settings.acceleration in ("iqn-ils", "imvj") else ['set coupling.acceleration = "iqn-ils"']
    return ways if verdict else [*ways, "raise coupling.max_iterations"]


def _choice(ways: list[str]) -> str:
    text = ", or ".join(ways)
    return f"{text[0].upper()}{text[1:]}."
