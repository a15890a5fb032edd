"""Typed reading of tables: values, defaults, and every refusal with its place."""

from __future__ import annotations

import math

import pytest

from hoblock.errors import ExpressionError, SceneError
from hoblock.io.table import Table


def table(**data: object) -> Table:
    return Table(data, "fluid.boundary[2]")


def test_a_table_must_be_a_table():
    with pytest.raises(SceneError, match=r"^solid: got a list of 1; expected a table"):
        Table([1], "solid")


# --- numbers ------------------------------------------------------------------------------------------------------


def test_number():
    number = table(a=2).number("a")
    assert number == 2.0
    assert isinstance(number, float)
    assert table().number("a", 3.5) == 3.5
    assert table().number("a", None) is None
    assert table(a=0.5).number("a", positive=True, below=1.0) == 0.5


@pytest.mark.parametrize(
    ("value", "limits", "message"),
    [
        ("heavy", {}, "got the text 'heavy'; expected a number"),
        ("1.5", {}, "got the text '1.5'; expected a number"),
        (True, {}, "got the boolean true; expected a number"),
        ([1.0], {}, "got a list of 1; expected a number"),
        ({}, {}, "got a table; expected a number"),
        (math.nan, {}, "got nan; expected a number that is finite"),
        (-math.inf, {}, "got -inf; expected a number that is finite"),
        (10**400, {}, "got inf; expected a number that is finite"),
        (0, {"positive": True}, "got 0; expected a number above 0"),
        (-1, {"positive": True, "maximum": 2.0}, "got -1; expected a number above 0 and of at most 2"),
        (0.1, {"minimum": 0.25}, "got 0.1; expected a number of at least 0.25"),
        (0.5, {"below": 0.5, "above": -1.0}, "got 0.5; expected a number above -1 and below 0.5"),
    ],
)
def test_number_refused(value, limits, message):
    with pytest.raises(SceneError) as caught:
        table(x=value).number("x", **limits)
    assert str(caught.value) == f"fluid.boundary[2].x: {message}"
    assert caught.value.place == "fluid.boundary[2].x"


def test_integer():
    assert table(a=7).integer("a", minimum=7, maximum=7) == 7
    assert table().integer("a", 1) == 1


@pytest.mark.parametrize(
    ("value", "message"),
    [
        (2.0, "got the number 2; expected an integer"),
        (True, "got the boolean true; expected an integer"),
        ("4", "got the text '4'; expected an integer"),
        (0, "got 0; expected an integer of at least 1 and of at most 32"),
        (33, "got 33; expected an integer of at least 1 and of at most 32"),
    ],
)
def test_integer_refused(value, message):
    with pytest.raises(SceneError) as caught:
        table(order=value).integer("order", minimum=1, maximum=32)
    assert str(caught.value) == f"fluid.boundary[2].order: {message}"


def test_boolean():
    assert table(a=True).boolean("a") is True
    assert table(a=False).boolean("a", True) is False
    assert table().boolean("a", True) is True
    for wrong in (1, 0, "true", []):
        with pytest.raises(SceneError, match="expected true or false"):
            table(a=wrong).boolean("a")


# --- texts and names ----------------------------------------------------------------------------------------------


def test_string():
    assert table(a="arc").string("a", choices=("arc", "parametric")) == "arc"
    assert table(a="").string("a") == ""
    assert table().string("a", "b") == "b"
    assert table().string("a", None, choices=("c",)) is None


def test_string_refused():
    with pytest.raises(SceneError, match="got the number 3; expected a text"):
        table(a=3).string("a")
    with pytest.raises(SceneError, match="got the boolean true; expected one of 'arc', 'parametric'"):
        table(a=True).string("a", choices=("arc", "parametric"))
    with pytest.raises(SceneError, match=r"got 'ark'\. Did you mean 'arc'\? Expected one of 'arc', 'parametric'"):
        table(a="ark").string("a", choices=("arc", "parametric"))


def test_names():
    assert table(on="inlet").names("on") == ("inlet",)
    assert table(on=["inlet", "walls"]).names("on") == ("inlet", "walls")
    assert table().names("on", ("fluid",)) == ("fluid",)


@pytest.mark.parametrize(
    ("value", "message"),
    [
        (3, "got the number 3; expected a name or a list of names"),
        ([], "got an empty list; expected a name"),
        (["a", 3], r"on\[1\]: got the number 3; expected a name"),
        (["a", ["b"]], r"on\[1\]: got a list of 1; expected a name"),
        ("", "got an empty name"),
        (["a", "  "], r"on\[1\]: got an empty name"),
        (["a", "b", "a"], "'a' is listed more than once"),
    ],
)
def test_names_refused(value, message):
    with pytest.raises(SceneError, match=message):
        table(on=value).names("on")


# --- pairs and expressions ----------------------------------------------------------------------------------------


def test_pair():
    assert table(a=[1, 2.5]).pair("a") == (1.0, 2.5)
    assert table(a=["r*cos(0)", 2]).pair("a", constants={"r": 0.5}) == (0.5, 2.0)
    assert table().pair("a", None) is None
    assert table().pair("a", (0.0, 1.0)) == (0.0, 1.0)


@pytest.mark.parametrize(
    ("value", "constants", "message"),
    [
        (3, None, r"boundary\[2\]\.a: got the number 3; expected two values \[x, y\]"),
        ([1, 2, 3], None, r"a: got a list of 3; expected two values"),
        ([1, "2"], None, r"a\[1\]: got the text '2'; expected a number"),
        ([True, 1], None, r"a\[0\]: got the boolean true; expected a number"),
        ([True, 1], {}, r"a\[0\]: got the boolean true; expected a number or an expression of the constants"),
        ([1, math.nan], {}, r"a\[1\]: got nan; expected .* that is finite"),
        ([1, "2*q"], {"r": 1.0}, r"a\[1\]: expression \"2\*q\": the name 'q' is not known"),
        (["x", 0], {}, r"a\[0\]: expression \"x\": the name 'x' has no meaning here"),
        (["1/0", 0], {}, r"a\[0\]: expression \"1/0\" is inf"),
    ],
)
def test_pair_refused(value, constants, message):
    with pytest.raises(SceneError, match=message):
        table(a=value).pair("a", constants=constants)


def test_expression():
    assert table(x="U*y").expression("x", ("x", "y"), {"U": 2.0}).evaluate(y=3.0) == 6.0
    assert table(x=4).expression("x", ("x",)).value == 4.0
    assert table().expression("x", ("x",), default=None) is None


def test_expression_refused():
    with pytest.raises(SceneError, match=r"boundary\[2\]\.x: got the boolean true; expected a number or an expression"):
        table(x=True).expression("x", ("x",))
    with pytest.raises(SceneError, match="got a list of 1; expected a number or an expression"):
        table(x=["1"]).expression("x", ("x",))
    with pytest.raises(ExpressionError, match=r'boundary\[2\]\.x: expression "2\*z": the name \'z\' is not known'):
        table(x="2*z").expression("x", ("x",))
    with pytest.raises(ExpressionError, match="expected a finite number"):
        table(x=math.inf).expression("x", ("x",))
    with pytest.raises(SceneError, match="the required key is missing"):
        table().expression("x", ("x",))


def test_expression_pair():
    x, y = table(f=["x*t", 2]).expression_pair("f", ("x", "t"))
    assert (x.place, y.place) == ("fluid.boundary[2].f[0]", "fluid.boundary[2].f[1]")
    assert x.evaluate(x=2.0, t=3.0) == 6.0
    assert y.is_constant
    assert table().expression_pair("f", ("x",), default=None) is None
    with pytest.raises(SceneError, match=r"f: got the text '0, 0'; expected two values \[x, y\]"):
        table(f="0, 0").expression_pair("f", ("x",))
    with pytest.raises(SceneError, match=r"f\[1\]: got a table"):
        table(f=["0", {}]).expression_pair("f", ("x",))


# --- paths --------------------------------------------------------------------------------------------------------


def test_paths():
    assert table(on=[["a", "b", "c"], ["d", "e"]]).paths("on") == (("a", "b", "c"), ("d", "e"))
    assert table(on=[["a", "b", "a"]]).paths("on") == (("a", "b", "a"),)
    assert table().paths("on", ()) == ()


@pytest.mark.parametrize(
    ("value", "message"),
    [
        ("wall", "got the text 'wall'; expected a list of paths"),
        ([], "got an empty list; expected a list of paths"),
        (["a", "b"], "Put one more pair of brackets around it"),
        ([["a", "b"], "c"], r"on\[1\]: got the text 'c'; expected a path"),
        ([["a"]], r"on\[0\]: got a path of 1 name\(s\); expected at least two"),
        ([["a", 2]], r"on\[0\]\[1\]: got the number 2; expected a name"),
        ([["a", "b", "b"]], r"on\[0\]: the path goes from 'b' to itself"),
    ],
)
def test_paths_refused(value, message):
    with pytest.raises(SceneError, match=message):
        table(on=value).paths("on")


# --- tables -------------------------------------------------------------------------------------------------------


def test_places_of_nested_tables():
    whole = Table({"fluid": {"boundary": [{"x": 1}, {"x": "a"}]}})
    first, second = whole.table("fluid").tables("boundary")
    assert first.number("x") == 1.0
    with pytest.raises(SceneError, match=r"^fluid\.boundary\[1\]\.x: got the text 'a'"):
        second.number("x")


def test_missing_tables_are_empty_if_they_may_be():
    assert list(table().table("a", required=False)) == []
    assert table().table("a", required=False).place == "fluid.boundary[2].a"
    assert table().tables("a") == ()
    assert table().named_tables("a") == {}


def test_named_tables():
    tables = Table({"quantities": {"u_y": {"type": "probe"}, "a b": {}}}).named_tables("quantities")
    assert tables["u_y"].string("type") == "probe"
    assert tables["a b"].place == 'quantities."a b"'
    with pytest.raises(SceneError, match=r"^quantities\.u_y: got the number 3; expected a table"):
        Table({"quantities": {"u_y": 3}}).named_tables("quantities")


def test_tables_refused():
    with pytest.raises(SceneError, match=r"a: got the number 3; expected a table \[fluid\.boundary\[2\]\.a\]"):
        table(a=3).table("a")
    with pytest.raises(
        SceneError, match=r"^solid: got a table; expected an array of tables\. Write \[\[solid\]\] with"
    ):
        Table({"solid": {"density": 1}}).tables("solid")
    with pytest.raises(SceneError, match="expected an array of tables"):
        table(a=[{}, 1]).tables("a")
    with pytest.raises(SceneError, match=r"expected at least one \[\["):
        table(a=[]).tables("a", required=True)
    with pytest.raises(SceneError, match="the required key is missing"):
        table().table("a")


# --- keys ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("method", ["number", "integer", "boolean", "string", "names", "pair", "paths", "raw"])
def test_required_keys(method):
    with pytest.raises(SceneError, match=r"^fluid\.boundary\[2\]\.value: the required key is missing\.$"):
        getattr(table(other=1), method)("value")


def test_a_missing_key_may_be_misspelt():
    read = table(denisty=1, x=2)
    read.number("x")
    with pytest.raises(SceneError, match=r"density: the required key is missing\. Is it misspelt as 'denisty'\?$"):
        read.number("density")


def test_unknown_keys():
    read = table(density=1.0, visc=2.0)
    read.number("density")
    read.number("viscosity", 1.0)
    with pytest.raises(
        SceneError,
        match=r"^fluid\.boundary\[2\]\.visc: unknown key\. Did you mean 'viscosity'\? Known keys: density, viscosity$",
    ):
        read.finish()


def test_unknown_key_without_a_neighbour():
    with pytest.raises(SceneError, match=r"^zzz: unknown key\. Known keys: none$"):
        Table({"zzz": 1}).finish()


def test_keys_asked_for_are_known():
    read = table(a=1, b=2, c=3)
    read.number("a")
    assert read.has("b")
    assert not read.has("d")
    assert read.raw("c") == 3
    assert list(read) == ["a", "b", "c"]
    read.finish()


def test_walking_over_keys_does_not_make_them_known():
    read = table(a=1)
    assert list(read) == ["a"]
    with pytest.raises(SceneError, match="unknown key"):
        read.finish()
