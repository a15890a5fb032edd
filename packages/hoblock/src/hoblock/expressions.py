"""Expressions of a scene: arithmetic over a fixed list of names and functions, on NumPy arrays.

An expression is data. It is compiled once to a flat program and evaluated on arrays; it can neither
call Python nor reach anything but the numbers it is given.
"""

from __future__ import annotations

import keyword
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hoblock.errors import ExpressionError
from hoblock.expression_functions import FUNCTIONS
from hoblock.expression_syntax import Load, Program, Push, parse, run, shortened
from hoblock.spelling import listing

__all__ = ["RESERVED_NAMES", "Expression", "compile_expression"]

RESERVED_NAMES: frozenset[str] = frozenset({"x", "y", "t", "s", "pi", "e", *keyword.kwlist, *FUNCTIONS})
"""Names that a constant of a scene cannot have."""


@dataclass(frozen=True)
class Expression:
    """A compiled expression, made by `compile_expression`.

    Attributes
    ----------
    text : str
        What was compiled.
    variables : tuple of str
        Names that may be given to `evaluate`.
    variables_used : frozenset of str
        Names that occur in the text. Work that depends on other variables only can be skipped.
    place : str
        Where the expression stands in its scene.
    program : tuple
        Instructions in reverse Polish order.
    """

    text: str
    variables: tuple[str, ...]
    variables_used: frozenset[str]
    place: str
    program: Program

    @property
    def is_constant(self) -> bool:
        """Whether no variable occurs."""
        return not self.variables_used

    @property
    def is_zero(self) -> bool:
        """Whether the expression is a constant with the value 0."""
        return self.is_constant and self.value == 0.0

    @property
    def value(self) -> float:
        """The value of a constant expression.

        Raises
        ------
        ExpressionError
            If a variable occurs in it.
        """
        (first, *rest) = self.program
        if rest or not isinstance(first, Push):
            used = ", ".join(sorted(self.variables_used))
            raise ExpressionError(
                f'expression "{shortened(self.text)}" depends on {used}; expected a constant here', self.place
            )
        return first.value

    def evaluate(self, **values: ArrayLike) -> NDArray[np.float64]:
        """Values of the expression.

        Parameters
        ----------
        **values : array_like
            One array or number for each variable that occurs, by name; other variables of the expression may
            be given too. They broadcast with one another.

        Returns
        -------
        ndarray
            A new array of 64-bit floats, of the shape that all given values broadcast to.

        Raises
        ------
        ExpressionError
            If a variable is missing or unknown, the shapes do not fit, or a value of the expression is not
            finite. Non-finite values in branches that a condition does not select are no error.
        """
        arrays = {name: np.asarray(value, dtype=np.float64) for name, value in values.items()}
        shape = self._shape(arrays)
        result: NDArray[np.float64] = np.empty(shape)
        result[...] = run(self.program, arrays)
        finite = np.isfinite(result)
        if not finite.all():
            raise self._not_finite(arrays, result, int(np.flatnonzero(~finite)[0]))
        return result

    def _shape(self, arrays: Mapping[str, NDArray[np.float64]]) -> tuple[int, ...]:
        missing = sorted(self.variables_used.difference(arrays))
        unknown = sorted(set(arrays).difference(self.variables))
        if missing or unknown:
            raise ExpressionError(
                f'expression "{shortened(self.text)}" of {listing(self.variables)} was evaluated without '
                f"{listing(missing)} and with the unknown {listing(unknown)}",
                self.place,
            )
        try:
            return np.broadcast_shapes(*(array.shape for array in arrays.values()))
        except ValueError as error:
            shapes = ", ".join(f"{name} {array.shape}" for name, array in arrays.items())
            raise ExpressionError(
                f'expression "{shortened(self.text)}": the shapes do not broadcast: {shapes}', self.place
            ) from error

    def _not_finite(
        self, arrays: Mapping[str, NDArray[np.float64]], result: NDArray[np.float64], index: int
    ) -> ExpressionError:
        at = ", ".join(
            f"{name} = {np.broadcast_to(array, result.shape).flat[index]:.10g}" for name, array in arrays.items()
        )
        return _not_finite(self.text, float(result.flat[index]), f" at {at}" if at else "", self.place)


def compile_expression(
    text: str | float | int,
    variables: Sequence[str],
    constants: Mapping[str, float] | None = None,
    place: str = "expression",
) -> Expression:
    """Compile an expression.

    Operators ``+ - * / **``, comparisons, ``and``, ``or``, ``not``, ``a if condition else b`` and the functions
    of the scene format. All arithmetic is in 64-bit floats; conditions are 1.0 or 0.0, and a number is true if
    it is not zero. As in Python, ``-x**2`` is ``-(x**2)`` and ``a < b < c`` means both.

    Parameters
    ----------
    text : str or float
        The expression; a number stands for itself.
    variables : sequence of str
        Names whose values are given to `Expression.evaluate`.
    constants : mapping of str to float, optional
        Names with values, besides ``pi`` and ``e``.
    place : str, optional
        Where the expression stands, for error messages.

    Returns
    -------
    Expression
        The compiled expression.

    Raises
    ------
    ExpressionError
        If the text is not an allowed expression, a name is both variable and constant, or a constant expression
        is not finite.

    Examples
    --------
    >>> inflow = compile_expression("1.5*U*y*(H - y)/(H/2)**2", ["x", "y", "t"], {"U": 1.0, "H": 0.41})
    >>> sorted(inflow.variables_used)
    ['y']
    >>> float(inflow.evaluate(y=0.205).round(12))
    1.5
    """
    constants = constants or {}
    clash = sorted(set(variables).intersection(constants))
    if clash:
        raise ExpressionError(f"the constant {clash[0]!r} has the name of a variable; rename the constant", place)
    if isinstance(text, str):
        program = parse(text, variables, constants, place)
    elif isinstance(text, bool) or not isinstance(text, int | float):
        raise ExpressionError(f"got {text!r}; expected a number or an expression such as '2*x'", place)
    else:
        program = (Push(_float(text)),)
    (first, *rest) = program
    if not rest and isinstance(first, Push) and not math.isfinite(first.value):
        raise _not_finite(str(text), first.value, "", place)
    used = frozenset(step.name for step in program if isinstance(step, Load))
    return Expression(str(text).strip(), tuple(variables), used, place, program)


def _float(number: float | int) -> float:
    try:
        return float(number)
    except OverflowError:
        return math.inf


def _not_finite(text: str, value: float, at: str, place: str) -> ExpressionError:
    return ExpressionError(
        f'expression "{shortened(text)}" is {value}{at}; expected a finite number. Guard the place where it is '
        "undefined, for example where(x > 0, log(x), 0)",
        place,
    )
