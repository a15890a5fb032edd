"""From the text of an expression to a flat program, through a whitelist of syntax.

The text is parsed to Python's syntax tree, and only the nodes listed here are translated: anything else
is an error that names it. Nothing is ever compiled to code or evaluated by Python. The program is in
reverse Polish order; parts without variables are computed once, in floating point, so that no integer
can grow without bound.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from hoblock.errors import ExpressionError
from hoblock.expression_functions import FUNCTIONS, Comparison, all_of, any_of, negation, power, select
from hoblock.spelling import listing, suggestion

__all__ = ["Apply", "Load", "Program", "Push", "parse", "run", "shortened"]

LONGEST_TEXT = 4096
DEEPEST_NESTING = 200


@dataclass(frozen=True)
class Push:
    """Put a number on the stack."""

    value: float


@dataclass(frozen=True)
class Load:
    """Put the value of a variable on the stack."""

    name: str


@dataclass(frozen=True)
class Apply:
    """Replace the last ``count`` values on the stack by the value of a function of them."""

    function: Callable[..., Any]
    count: int


Program = tuple[Push | Load | Apply, ...]

_BINARY: dict[type[ast.operator], Callable[..., Any]] = {
    ast.Add: np.add,
    ast.Sub: np.subtract,
    ast.Mult: np.multiply,
    ast.Div: np.divide,
    ast.Pow: power,
}
_UNARY: dict[type[ast.unaryop], Callable[..., Any]] = {
    ast.UAdd: np.positive,
    ast.USub: np.negative,
    ast.Not: negation,
}
_RELATIONS: dict[type[ast.cmpop], Callable[..., Any]] = {
    ast.Lt: np.less,
    ast.LtE: np.less_equal,
    ast.Gt: np.greater,
    ast.GtE: np.greater_equal,
    ast.Eq: np.equal,
    ast.NotEq: np.not_equal,
}
_REFUSED: dict[type[ast.AST], str] = {
    ast.Attribute: "attributes (a dot after a name) are not allowed; write functions by their bare name, sin(x)",
    ast.FloorDiv: "the operator // is not known; write floor(a/b)",
    ast.GeneratorExp: "comprehensions are not allowed",
    ast.In: "the operator 'in' is not known",
    ast.Is: "the operator 'is' is not known; write ==",
    ast.IsNot: "the operator 'is not' is not known; write !=",
    ast.NotIn: "the operator 'not in' is not known",
    ast.Starred: "the star before an argument is not allowed",
    ast.Tuple: "a list of values is not allowed here; an expression has one value",
}
_CHARACTERS: dict[str, str] = {
    "^": "write ** for powers",
    "%": "write a - b*floor(a/b) for the remainder",
    "&": "write 'and'",
    "|": "write 'or'",
    "~": "write 'not'",
    "?": "write 'a if condition else b'",
    ":": "neither slices, lambda nor assignments are allowed",
    "[": "subscripts and lists are not allowed; use round brackets for grouping",
    "]": "subscripts and lists are not allowed; use round brackets for grouping",
    "{": "use round brackets for grouping",
    "}": "use round brackets for grouping",
    "'": "text is not allowed inside an expression",
    '"': "text is not allowed inside an expression",
    "#": "comments are not allowed inside an expression",
    "@": "write * for products",
    "−": "write the plain minus sign -",
    "–": "write the plain minus sign -",
    "·": "write * for products",
    "×": "write * for products",
    "²": "write **2",
    "³": "write **3",
    "√": "write sqrt(a)",
    "π": "write pi",
}
_OTHER_NAMES: dict[str, str] = {
    "arccos": "Write acos. ",
    "arcsin": "Write asin. ",
    "arctan": "Write atan. ",
    "arctan2": "Write atan2. ",
    "ceil": "Write -floor(-a). ",
    "fabs": "Write abs. ",
    "fmod": "Write a - b*floor(a/b). ",
    "if": "Write where(condition, a, b). ",
    "ln": "Write log. ",
    "log10": "Write log(a)/log(10). ",
    "log2": "Write log(a)/log(2). ",
    "mod": "Write a - b*floor(a/b). ",
    "pow": "Write a**b. ",
    "power": "Write a**b. ",
    "round": "Write floor(a + 0.5). ",
    "step": "Write where(condition, a, b). ",
}
_ALLOWED = re.compile(r"[A-Za-z0-9_+\-*/().,<>=! ]")
_NUMBER_INTO_NAME = re.compile(r"(?<![\w.])(?>(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)[A-Za-z_]\w*")


def parse(text: str, variables: Sequence[str], constants: Mapping[str, float], place: str) -> Program:
    """Translate the text of an expression.

    Parameters
    ----------
    text : str
        The expression.
    variables : sequence of str
        Names whose values are given later.
    constants : mapping of str to float
        Names whose values are known now (besides ``pi`` and ``e``).
    place : str
        Where the expression stands, for error messages.

    Returns
    -------
    Program
        Instructions for `run`. If no variable is used it is a single `Push`.

    Raises
    ------
    ExpressionError
        If the text is not an allowed expression.
    """
    return _Translator(text, tuple(variables), {"pi": np.pi, "e": np.e, **constants}, place).program()


def run(program: Program, values: Mapping[str, Any]) -> Any:
    """Value of a program, for values of its variables that broadcast with one another."""
    stack: list[Any] = []
    with np.errstate(all="ignore"):
        for instruction in program:
            if isinstance(instruction, Push):
                stack.append(np.float64(instruction.value))
            elif isinstance(instruction, Load):
                stack.append(values[instruction.name])
            else:
                first = len(stack) - instruction.count
                arguments = stack[first:]
                del stack[first:]
                stack.append(instruction.function(*arguments))
    (result,) = stack
    return result


class _Translator:
    """One text on its way to a program."""

    def __init__(self, text: str, variables: tuple[str, ...], constants: Mapping[str, float], place: str) -> None:
        self.text = re.sub(r"\s", " ", text).strip()
        self.variables = variables
        self.constants = constants
        self.place = place

    def program(self) -> Program:
        self._check_characters()
        try:
            tree = ast.parse(self.text, mode="eval")
        except SyntaxError as error:
            raise self._error(f"{error.msg or 'invalid syntax'}{self._column(error.offset)}. {self._hint()}") from error
        except (ValueError, RecursionError, MemoryError, OverflowError) as error:
            raise self._error("it is nested too deeply or has a number that is too long; simplify it") from error
        return self._translate(tree.body, 0)

    def _check_characters(self) -> None:
        if not self.text:
            raise ExpressionError("the expression is empty; expected a number or something like '2*x'", self.place)
        if len(self.text) > LONGEST_TEXT:
            raise self._error(f"it has {len(self.text)} characters; at most {LONGEST_TEXT} are allowed")
        for position, character in enumerate(self.text):
            if not _ALLOWED.match(character):
                hint = _CHARACTERS.get(character, "remove it")
                raise self._error(f"the character {character!r}{self._column(position + 1)} is not allowed; {hint}")
        run_together = _NUMBER_INTO_NAME.search(self.text)
        if run_together:
            raise self._error(f"a number runs into a name in {run_together.group()!r}; write * for products")

    def _translate(self, node: ast.AST, depth: int) -> Program:
        if depth > DEEPEST_NESTING:
            raise self._error(f"it is nested more than {DEEPEST_NESTING} deep; simplify it")
        depth += 1
        match node:
            case ast.Constant(value=value):
                return (Push(self._number(value)),)
            case ast.Name(id=name):
                return self._name(name)
            case ast.BinOp(left=left, op=operator, right=right):
                return self._apply(self._look_up(_BINARY, operator), (left, right), depth)
            case ast.UnaryOp(op=operator, operand=operand):
                return self._apply(self._look_up(_UNARY, operator), (operand,), depth)
            case ast.BoolOp(op=operator, values=values):
                return self._logic(all_of if isinstance(operator, ast.And) else any_of, values, depth)
            case ast.Compare(left=left, ops=operators, comparators=others):
                comparison = Comparison(tuple(self._look_up(_RELATIONS, operator) for operator in operators))
                return self._apply(comparison, (left, *others), depth)
            case ast.IfExp(test=test, body=body, orelse=otherwise):
                return self._apply(select, (test, body, otherwise), depth)
            case ast.Call():
                return self._call(node, depth)
        raise self._refusal(node)

    def _apply(self, function: Callable[..., Any], arguments: Sequence[ast.AST], depth: int) -> Program:
        parts = [self._translate(argument, depth) for argument in arguments]
        return _join(function, parts)

    def _logic(self, function: Callable[..., Any], values: Sequence[ast.AST], depth: int) -> Program:
        # A single value never occurs, so the result is always 0.0 or 1.0.
        parts = [self._translate(value, depth) for value in values]
        program = parts[0]
        for part in parts[1:]:
            program = _join(function, [program, part])
        return program

    def _call(self, node: ast.Call, depth: int) -> Program:
        if not isinstance(node.func, ast.Name):
            if isinstance(node.func, ast.Attribute):
                raise self._refusal(node.func)
            raise self._error("a bracket follows a value as if it were a function; write * for products")
        name = node.func.id
        if name in self.variables or name in self.constants:
            raise self._error(f"{name!r} is a number, not a function; write {name}*(...) for a product")
        if name not in FUNCTIONS:
            hint = _OTHER_NAMES.get(name) or suggestion(name, FUNCTIONS)
            raise self._error(f"unknown function {name!r}. {hint}Known functions: {', '.join(FUNCTIONS)}")
        if node.keywords:
            raise self._error(f"{name}() takes no named arguments")
        function = FUNCTIONS[name]
        count = len(node.args)
        if count < function.least or (function.most is not None and count > function.most):
            more = " or more" if function.most is None else ""
            raise self._error(f"{name}() takes {function.least}{more} argument(s), got {count}")
        return self._apply(function.call, node.args, depth)

    def _name(self, name: str) -> Program:
        if name in self.constants:
            return (Push(float(self.constants[name])),)
        if name in self.variables:
            return (Load(name),)
        if name in FUNCTIONS:
            raise self._error(f"{name!r} is a function; give it its argument(s), {name}(...)")
        names = (*self.variables, *self.constants)
        reason = "has no meaning here" if name in ("x", "y", "t", "s") else "is not known"
        raise self._error(f"the name {name!r} {reason}. {suggestion(name, names)}Known names: {listing(names)}")

    def _number(self, value: object) -> float:
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise self._error(f"{value!r} is not a number; write 1 or 0 for true or false")
        try:
            number = float(value)
        except OverflowError:
            number = np.inf
        if not np.isfinite(number):
            raise self._error("it contains a number beyond the range of floating point (1.8e308)")
        return number

    def _look_up(self, table: Mapping[Any, Callable[..., Any]], operator: ast.AST) -> Callable[..., Any]:
        try:
            return table[type(operator)]
        except KeyError:
            raise self._refusal(operator) from None

    def _refusal(self, node: ast.AST) -> ExpressionError:
        return self._error(_REFUSED.get(type(node), f"{type(node).__name__} is not allowed in an expression"))

    def _error(self, problem: str) -> ExpressionError:
        return ExpressionError(f'expression "{shortened(self.text)}": {problem.rstrip()}', self.place)

    def _column(self, offset: int | None) -> str:
        return f" at character {offset}" if offset else ""

    def _hint(self) -> str:
        if re.search(r"(?<![<>=!])=(?!=)", self.text):
            return "Write == for equality; a single = is not allowed"
        if re.search(r"!(?!=)", self.text):
            return "Write 'not' instead of !"
        if re.search(r"[\w)]\s+[\w(]", self.text):
            return "Write * for products, and check the brackets"
        return "Check operators and brackets"


def shortened(text: str, longest: int = 80) -> str:
    """The text, cut in the middle if it is longer than ``longest`` characters."""
    if len(text) <= longest:
        return text
    half = (longest - 5) // 2
    return f"{text[:half]} ... {text[-half:]}"


def _join(function: Callable[..., Any], parts: Sequence[Program]) -> Program:
    """Program that applies a function to the values of others; computed now if they are all numbers."""
    program = (*(step for part in parts for step in part), Apply(function, len(parts)))
    if all(len(part) == 1 and isinstance(part[0], Push) for part in parts):
        return (Push(float(run(program, {}))),)
    return program
