"""Expressions: agreement with Python's own arithmetic, broadcasting, refusals."""

from __future__ import annotations

import copy
import math
import random
import re
import warnings
from pathlib import Path

import numpy as np
import pytest

from hoblock.errors import ExpressionError, HoblockError, SceneError
from hoblock.expression_functions import FUNCTIONS
from hoblock.expressions import RESERVED_NAMES, Expression, compile_expression


def value(text: str | float, **values: float) -> float:
    return float(compile_expression(text, tuple(values)).evaluate(**values))


# --- values ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "reference"),
    [
        ("x + y", lambda x, y: x + y),
        ("x - y - 1", lambda x, y: x - y - 1),
        ("x - (y - 1)", lambda x, y: x - (y - 1)),
        ("x*y/3.5", lambda x, y: x * y / 3.5),
        ("x/y/2", lambda x, y: x / y / 2),
        ("-x**2", lambda x, y: -(x**2)),
        ("(-x)**2", lambda x, y: x * x),
        ("2**-y", lambda x, y: math.pow(2, -y)),
        ("x**2**0.5", lambda x, y: math.pow(x, math.sqrt(2))),
        ("x**y", math.pow),
        ("+x - -y", lambda x, y: x + y),
        ("2*pi*x + e", lambda x, y: 2 * math.pi * x + math.e),
        ("1.5e-3*x + .5 + 2.", lambda x, y: 0.0015 * x + 2.5),
        ("1 if x < y else 2", lambda x, y: 1 if x < y else 2),
        ("1 if x < 1 else 2 if x < 2 else 3", lambda x, y: 1 if x < 1 else 2 if x < 2 else 3),
        ("where(x >= y, x, y)", max),
        ("0.5 < x <= y", lambda x, y: float(0.5 < x <= y)),
        ("x > 1 and y > 1", lambda x, y: float(x > 1 and y > 1)),
        ("x > 1 or y > 1 and x < 0.5", lambda x, y: float(x > 1 or (y > 1 and x < 0.5))),
        ("not x > 1", lambda x, y: float(not x > 1)),
        ("x == x", lambda x, y: 1.0),
        ("x != x", lambda x, y: 0.0),
        ("(x > 1)*y", lambda x, y: y if x > 1 else 0.0),
        ("min(x, y, 1)", lambda x, y: min(x, y, 1)),
        ("max(x, y, 1)", lambda x, y: max(x, y, 1)),
        ("floor(-x)", lambda x, y: math.floor(-x)),
        ("sign(x - y)", lambda x, y: math.copysign(1, x - y)),
        ("abs(x - y)", lambda x, y: abs(x - y)),
        ("atan2(-x, -y)", lambda x, y: math.atan2(-x, -y)),
        ("hypot(x, y)", math.hypot),
        ("log(x) + exp(-y) + sqrt(x)", lambda x, y: math.log(x) + math.exp(-y) + math.sqrt(x)),
        ("sin(x) + cos(y) + tan(x/3)", lambda x, y: math.sin(x) + math.cos(y) + math.tan(x / 3)),
        ("sinh(x) + cosh(y) + tanh(x)", lambda x, y: math.sinh(x) + math.cosh(y) + math.tanh(x)),
        ("asin(x/9) + acos(y/9) + atan(x)", lambda x, y: math.asin(x / 9) + math.acos(y / 9) + math.atan(x)),
    ],
)
def test_agrees_with_python(text, reference):
    rng = np.random.default_rng(731)
    x, y = rng.uniform(0.2, 3.0, (2, 40))
    expected = [float(reference(float(a), float(b))) for a, b in zip(x, y, strict=True)]
    np.testing.assert_allclose(
        compile_expression(text, ("x", "y")).evaluate(x=x, y=y), expected, rtol=1e-14, atol=1e-14
    )


def _random_tree(rng: random.Random, depth: int) -> tuple[str, object]:
    """A text with all brackets written, and a function of (x, y) that uses Python's floats only."""
    if depth == 0:
        leaf = rng.choice(("x", "y", "number"))
        if leaf == "number":
            number = round(rng.uniform(-3, 3), 3)
            return f"({number})", lambda x, y: number
        return leaf, (lambda x, y: x) if leaf == "x" else (lambda x, y: y)
    left, f = _random_tree(rng, depth - 1)
    right, g = _random_tree(rng, rng.randrange(depth))
    match rng.randrange(9):
        case 0:
            return f"({left} + {right})", lambda x, y: f(x, y) + g(x, y)
        case 1:
            return f"({left} - {right})", lambda x, y: f(x, y) - g(x, y)
        case 2:
            return f"({left}*{right})", lambda x, y: f(x, y) * g(x, y)
        case 3:
            return f"({left}/(1 + {right}**2))", lambda x, y: f(x, y) / (1 + g(x, y) * g(x, y))
        case 4:
            return f"(-{left})", lambda x, y: -f(x, y)
        case 5:
            return f"sin({left})", lambda x, y: math.sin(f(x, y))
        case 6:
            return f"max({left}, {right})", lambda x, y: max(f(x, y), g(x, y))
        case 7:
            return f"({left} if {right} > 0 else y)", lambda x, y: f(x, y) if g(x, y) > 0 else y
        case _:
            return f"sqrt(abs({left}))", lambda x, y: math.sqrt(abs(f(x, y)))


@pytest.mark.parametrize("seed", range(1000, 1060))
def test_random_expressions_agree_with_python(seed):
    rng = random.Random(seed)
    text, reference = _random_tree(rng, 5)
    x, y = np.random.default_rng(seed).uniform(-2, 2, (2, 7))
    expected = [reference(float(a), float(b)) for a, b in zip(x, y, strict=True)]
    np.testing.assert_allclose(compile_expression(text, ("x", "y")).evaluate(x=x, y=y), expected, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("name", sorted(FUNCTIONS))
def test_every_function_of_the_format_is_reserved_and_answers(name):
    assert name in RESERVED_NAMES
    arguments = ", ".join(["0.5"] * FUNCTIONS[name].least)
    assert math.isfinite(value(f"{name}({arguments})"))


def test_the_functions_are_those_of_the_format():
    page = (Path(__file__).parents[2] / "docs" / "scene.md").read_text(encoding="utf-8")
    listed = re.search(r"Functions: `([^`]*)`", page)[1]
    assert sorted(FUNCTIONS) == sorted(re.findall(r"\w+", re.sub(r"\(.*?\)", "", listed)))


def test_numbers_stand_for_themselves():
    assert value(3) == 3.0
    assert value(-0.25) == -0.25
    assert compile_expression(3, ()).text == "3"


def test_constants_are_used():
    inflow = compile_expression("1.5*U*y*(H - y)/(H/2)**2", ("x", "y", "t"), {"U": 2.0, "H": 0.41})
    np.testing.assert_allclose(inflow.evaluate(y=[0.0, 0.205, 0.41]), [0.0, 3.0, 0.0], atol=1e-15)


def test_lines_of_a_long_text_are_joined():
    assert value("x +\n   2*x\r\n\t- 1", x=3.0) == 8.0


# --- shapes and properties --------------------------------------------------------------------------------------


def test_broadcasts_all_values_given():
    x, y = np.arange(3.0)[:, None], np.arange(4.0)
    result = compile_expression("x + 10*y", ("x", "y", "t")).evaluate(x=x, y=y, t=0.0)
    np.testing.assert_array_equal(result, x + 10 * y)
    assert compile_expression("t", ("x", "y", "t")).evaluate(x=x, y=y, t=2.0).shape == (3, 4)


def test_result_is_a_new_writable_float_array():
    x = np.arange(4)
    for text in ("x", "2", "x > 1"):
        result = compile_expression(text, ("x",)).evaluate(x=x)
        assert result.dtype == np.float64
        assert result.shape == (4,)
        assert not np.shares_memory(result, x)
        result[:] = -1.0
    np.testing.assert_array_equal(x, np.arange(4))


def test_input_of_the_same_type_is_not_returned_itself():
    x = np.array([1.0, 2.0])
    result = compile_expression("x", ("x",)).evaluate(x=x)
    assert not np.shares_memory(result, x)


def test_empty_arrays_give_empty_arrays():
    assert compile_expression("1/x", ("x",)).evaluate(x=np.empty((0, 3))).shape == (0, 3)


def test_variables_used_are_those_in_the_text():
    expression = compile_expression("U*x + sin(pi)", ("x", "y", "t"), {"U": 2.0})
    assert expression.variables_used == frozenset({"x"})
    assert expression.variables == ("x", "y", "t")
    assert not expression.is_constant


@pytest.mark.parametrize(("text", "zero"), [("0", True), ("2*pi - pi*2", True), (0, True), (0.0, True), ("1", False)])
def test_constants_know_their_value(text, zero):
    expression = compile_expression(text, ("x", "t"))
    assert expression.is_constant
    assert expression.is_zero is zero
    assert expression.value == (0.0 if zero else 1.0)


def test_an_expression_with_variables_is_not_zero_and_has_no_value():
    expression = compile_expression("0*x", ("x",), place="solid[0].x")
    assert not expression.is_zero
    with pytest.raises(ExpressionError, match=r'solid\[0\]\.x: expression "0\*x" depends on x; expected a constant'):
        expression.value  # noqa: B018


def test_value_of_a_bare_variable_is_refused():
    with pytest.raises(ExpressionError, match="depends on x"):
        compile_expression("x", ("x",)).value  # noqa: B018


def test_constant_parts_are_computed_once():
    expression = compile_expression("x*(3*U**2/4)", ("x",), {"U": 2.0})
    assert len(expression.program) == 3
    assert expression.evaluate(x=2.0) == 6.0


def test_expressions_are_values():
    first, second = (compile_expression("x**2 + where(x < 1, 1, 0)", ("x",)) for _ in range(2))
    assert first == second
    assert hash(first) == hash(second)
    third = copy.deepcopy(first)
    assert isinstance(third, Expression)
    assert third.evaluate(x=3.0) == 9.0
    with pytest.raises(AttributeError):
        first.text = "1"


# --- conditions and undefined values ----------------------------------------------------------------------------


def test_branches_not_selected_may_be_undefined():
    x = np.array([-1.0, 0.0, 4.0])
    np.testing.assert_allclose(compile_expression("where(x > 0, log(x), 0)", ("x",)).evaluate(x=x), [0, 0, math.log(4)])
    np.testing.assert_allclose(compile_expression("1/x if x != 0 else 7", ("x",)).evaluate(x=x), [-1, 7, 0.25])
    assert value("where(1 > 2, 1/0, 3)") == 3.0


def test_conditions_are_decided_from_left_to_right():
    x = np.array([-1.0, 4.0])
    np.testing.assert_array_equal(compile_expression("x > 0 and sqrt(x) > 1", ("x",)).evaluate(x=x), [0, 1])
    np.testing.assert_array_equal(compile_expression("x < 0 or sqrt(x) > 3", ("x",)).evaluate(x=x), [1, 0])


@pytest.mark.parametrize(
    "text", ["sqrt(x) > 0", "not sqrt(x) > 0", "where(sqrt(x) < 1, 1, 2)", "sqrt(x)**0", "1**sqrt(x)", "sqrt(x) and 1",
             "1 and sqrt(x)", "0 or sqrt(x)", "max(sqrt(x), 1)", "sign(sqrt(x))", "(sqrt(x) > 0)*0", "x**0.5 != 1",
             "min(1, sqrt(x))", "0 < 1 < sqrt(x)", "sqrt(x)**(x + 1)"],
)  # fmt: skip
def test_undefined_values_do_not_vanish_in_conditions(text):
    with pytest.raises(ExpressionError, match=r"is nan at x = -1; expected a finite number"):
        compile_expression(text, ("x",)).evaluate(x=[1.0, -1.0])


def test_the_first_undefined_place_is_named():
    expression = compile_expression("y/x", ("x", "y", "t"), place="fluid.boundary[2].x")
    x = np.array([[1.0, 2.0], [0.0, 0.0]])
    with pytest.raises(
        ExpressionError,
        match=r'^fluid\.boundary\[2\]\.x: expression "y/x" is inf at x = 0, y = 0\.5, t = 3; '
        r"expected a finite number\. Guard the place where it is undefined",
    ):
        expression.evaluate(x=x, y=[0.5, 0.25], t=3)


def test_undefined_values_give_no_warning():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(ExpressionError, match="is nan at x = 0"):
            compile_expression("log(x)*0 + 0/x + 10**400**x", ("x",)).evaluate(x=[0.0])
        assert value("1e308*10 > 1") == 1.0


@pytest.mark.parametrize("text", ["1/0", "0/0", "log(0)", "9**9**9**9", "(-8)**(1/3)", "10.0**400", "exp(1000)"])
def test_constants_must_be_finite_at_once(text):
    with pytest.raises(ExpressionError, match=r"^mesh: expression .* is (inf|-inf|nan); expected a finite number"):
        compile_expression(text, ("x",), place="mesh")


@pytest.mark.parametrize("number", [math.inf, -math.inf, math.nan, 10**400])
def test_numbers_must_be_finite(number):
    with pytest.raises(ExpressionError, match="expected a finite number"):
        compile_expression(number, ())


# --- refusals ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("x^2", r"'\^' at character 2 is not allowed; write \*\* for powers"),
        ("x % 2", r"write a - b\*floor\(a/b\)"),
        ("x & y", "write 'and'"),
        ("x | y", "write 'or'"),
        ("~x", "write 'not'"),
        ("x ? 1 : 2", "write 'a if condition else b'"),
        ("x // 2", r"the operator // is not known; write floor\(a/b\)"),
        ("x is y", "write =="),
        ("x is not y", "write !="),
        ("x in y", "the operator 'in' is not known"),
        ("x not in y", "the operator 'not in' is not known"),
        ("x @ y", r"write \* for products"),
        ("x << 2", "LShift is not allowed"),
        ("x = 1", "Write == for equality"),
        ("!x", "Write 'not' instead of !"),
        ("x − 1", "write the plain minus sign"),
        ("π*x", "write pi"),
        ("x²", r"write \*\*2"),
        ("2x", r"a number runs into a name in '2x'; write \* for products"),
        ("1e3y", "runs into a name in '1e3y'"),
        ("1_000", "runs into a name"),
        ("0x10", "runs into a name"),
        ("2j", "runs into a name"),
        ("2 x", r"at character 3\. Write \* for products"),
        ("2(x)", r"a bracket follows a value as if it were a function; write \* for products"),
        ("x(3)", r"'x' is a number, not a function; write x\*\(\.\.\.\) for a product"),
        ("pi(3)", "'pi' is a number, not a function"),
        ("x +", "Check operators and brackets"),
        ("(x", "was never closed"),
        ("x)", "unmatched"),
        ("", "the expression is empty"),
        (" \n\t", "the expression is empty"),
        ("007", "leading zeros"),
        ("1e999", "beyond the range of floating point"),
        ("9" * 400, "beyond the range of floating point"),
        ("sin", r"'sin' is a function; give it its argument\(s\), sin\(\.\.\.\)"),
        ("sin()", r"sin\(\) takes 1 argument\(s\), got 0"),
        ("sin(x, y)", r"sin\(\) takes 1 argument\(s\), got 2"),
        ("max(x)", r"max\(\) takes 2 or more argument\(s\), got 1"),
        ("where(x, y)", r"where\(\) takes 3 argument\(s\), got 2"),
        ("sin(a=x)", r"sin\(\) takes no named arguments"),
        ("max(*x, y)", "the star before an argument"),
        ("sin(**x)", "takes no named arguments"),
        ("sine(x)", r"unknown function 'sine'\. Did you mean 'sin'\? Known functions: abs, acos"),
        ("SQRT(x)", r"Did you mean 'sqrt'\?"),
        ("ln(x)", r"unknown function 'ln'\. Write log\."),
        ("pow(x, 2)", r"Write a\*\*b\."),
        ("Pi*x", r"the name 'Pi' is not known\. Did you mean 'pi'\? Known names: 'x', 'y', 'pi', 'e', 'U_mean'"),
        ("u_mean*x", r"Did you mean 'U_mean'\?"),
        ("x*t", r"the name 't' has no meaning here\. Known names"),
        ("True", "True is not a number; write 1 or 0"),
        ("None", "None is not a number"),
        ("...", "Ellipsis is not a number"),
        ("x, y", "an expression has one value"),
        ("()", "an expression has one value"),
    ],
)
def test_mistakes_are_explained(text, message):
    with pytest.raises(ExpressionError, match=message) as caught:
        compile_expression(text, ("x", "y"), {"U_mean": 1.0}, place="motion[0].y")
    assert caught.value.place == "motion[0].y"
    assert str(caught.value).startswith("motion[0].y: ")


@pytest.mark.parametrize(
    "text",
    [
        "__import__('os').system('true')",
        "__import__(x)",
        "x.__class__",
        "().__class__.__bases__",
        "x.real",
        "np.sin(x)",
        "x[0]",
        "[x]",
        "{x}",
        "{}",
        "'text'",
        '"text"',
        "f'{x}'",
        "b'x'",
        "lambda: x",
        "lambda x: x",
        "(lambda: 1)()",
        "[i for i in x]",
        "max(i for i in x)",
        "(i for i in x)",
        "(x := 1)",
        "x; y",
        "x # comment",
        "print(x)",
        "open(x)",
        "exec(x)",
        "eval(x)",
        "compile(x, y, x)",
        "globals()",
        "getattr(x, y)",
        "sin.__call__(x)",
        "sin(x)(x)",
        "await x",
        "yield x",
        "(yield)",
        "import os",
        "del x",
        "x\\\n+y",
        "\0",
        "x\0",
        "x\u202e",
        "ｓｉｎ(x)",
        "`x`",
        "$x",
    ],
)
def test_hostile_texts_are_refused(text):
    with pytest.raises(ExpressionError, match=r"^motion: expression "):
        compile_expression(text, ("x", "y"), place="motion")


@pytest.mark.parametrize(
    "text",
    [
        "-" * 4000 + "1",
        "not " * 1000 + "x",
        "(" * 4000,
        "(" * 150 + "x" + ")" * 150 + "+" + "-" * 300 + "x",
        "+".join("x" * 400),
        "sin(" * 300 + "x" + ")" * 300,
        "x**" * 300 + "x",
        "x+" * 5000 + "x",
        " 1 if x else" * 300 + " 2",
    ],
)
def test_deep_and_long_texts_are_refused(text):
    with pytest.raises(ExpressionError, match=r"nested|characters; at most 4096 are allowed") as caught:
        compile_expression(text, ("x",))
    assert len(str(caught.value)) < 300


def test_generous_texts_are_accepted():
    text = " + ".join(f"sin({k}*x)/{k}" for k in range(1, 150))
    assert value(text, x=0.3) == pytest.approx(sum(math.sin(k * 0.3) / k for k in range(1, 150)), rel=1e-13)


def test_nested_comparisons_stay_small():
    text = "x"
    for _ in range(60):
        text = f"(0 < {text} < 2)"
    assert value(text, x=1.0) == 1.0
    assert len(compile_expression(text, ("x",)).program) == 181


@pytest.mark.parametrize("thing", [True, None, [1], {"x": 1}, 1j])
def test_other_types_are_refused(thing):
    with pytest.raises(ExpressionError, match="expected a number or an expression"):
        compile_expression(thing, ("x",))


def test_a_constant_cannot_have_the_name_of_a_variable():
    with pytest.raises(ExpressionError, match="the constant 's' has the name of a variable; rename the constant"):
        compile_expression("s", ("s",), {"s": 1.0})


def test_values_must_be_complete_and_known():
    expression = compile_expression("x + y", ("x", "y"))
    with pytest.raises(ExpressionError, match="was evaluated without 'y' and with the unknown 'z'"):
        expression.evaluate(x=1.0, z=2.0)
    with pytest.raises(ExpressionError, match="without 'x', 'y' and with the unknown none"):
        expression.evaluate()


def test_shapes_must_fit():
    with pytest.raises(ExpressionError, match=r"shapes do not broadcast: x \(2,\), y \(3,\)"):
        compile_expression("x", ("x", "y")).evaluate(x=[1.0, 2.0], y=[1.0, 2.0, 3.0])


def test_errors_are_scene_errors():
    assert issubclass(ExpressionError, SceneError)
    assert issubclass(SceneError, HoblockError)
