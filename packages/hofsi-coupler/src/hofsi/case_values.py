"""The values of a case by their keys in a scene, and which of them may be others when a run is resumed."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields, is_dataclass

import numpy as np

from hoblock.expression_syntax import Push
from hoblock.expressions import Expression
from hofsi.case import Case
from hofsi.errors import RestartError

__all__ = ["Change", "case_values", "changes"]

_LONGEST = 80  # characters of a value that are told
_NAMES = {"boundaries": "boundary", "curves": "curve", "counts": "count", "gradings": "grading"}  # as a scene has them
_TOLD_ELSEWHERE = ("place", "file", "title", "steps", "tables", "variables")  # the number of steps follows from the end
_NOTHING = "nothing"

_SETTINGS = r"time\.(dt|end|halvings|tolerance|first|spectral_radius)|(coupling|nonlinear|linear|output)\.\w+"
_NUMERICS = r"fluid\.(convection|convection_form|grad_div)|mover\..*"
_PHYSICS = r"fluid\.(density|viscosity|body_force.*)|solid\[\d+\]\.(density|youngs_modulus|poissons_ratio|body_force.*)"
_GIVEN = r"(fluid|solid\[\d+\])\.boundary\[\d+\]\.(x|y|value|traction_x|traction_y|backflow)|motion\[\d+\]\.(x|y)"
_PAST = r"(fluid|solid\[\d+\])\.initial_\w+.*"
_FREE = re.compile("|".join(f"(?:{kind})" for kind in (_SETTINGS, _NUMERICS, _PHYSICS, _GIVEN, _PAST)))
_CONDITION = re.compile(_GIVEN)
_MATRICES = re.compile(f"(?:{_NUMERICS}|{_PHYSICS}|{_GIVEN})|linear\\..*|coupling\\.geometry")
_INITIAL = re.compile(_PAST)


@dataclass(frozen=True)
class Change:
    """A value that is another one than before.

    Attributes
    ----------
    key : str
        In the scene, for example ``"time.dt"``.
    old, new : str
    """

    key: str
    old: str
    new: str

    @property
    def of_matrices(self) -> bool:
        """Whether factors that were made before may be of no use after it."""
        return bool(_MATRICES.fullmatch(self.key))

    def __str__(self) -> str:
        past = ", which has no effect any more" if _INITIAL.fullmatch(self.key) else ""
        return f"{self.key} = {_short(self.new)} instead of {_short(self.old)}{past}"


def changes(old: Mapping[str, str], new: Mapping[str, str]) -> list[Change]:
    """Compare the values of a run with those it is to go on with.

    Parameters
    ----------
    old, new : mapping of str to str
        By `case_values`.

    Raises
    ------
    RestartError
        Naming the first key whose value cannot be another one, because it decides which unknowns there are, or what
        the values before mean.
    """
    found = [
        Change(key, old.get(key, _NOTHING), new.get(key, _NOTHING))
        for key in dict.fromkeys([*old, *new])
        if old.get(key) != new.get(key)
    ]
    for change in found:
        fixed = _NOTHING in (change.old, change.new) and _CONDITION.fullmatch(change.key)
        if fixed or not _FREE.fullmatch(change.key):
            raise RestartError(
                f"{change.key}: got {_short(change.new)}; expected {_short(change.old)}, with which the run was made, "
                "for the state of the restart file belongs to it. Change it back, or run from the start, without "
                "--resume."
            )
    return found


def case_values(case: Case) -> dict[str, str]:
    """Return the values of a case as texts, by key; equal texts are equal values."""
    values: dict[str, str] = {}
    parts = {
        "mesh": case.mesh,
        "fluid": case.fluid,
        "solid": case.solids,
        "motion": case.motions,
        "mover": case.mover,
        "time": case.time,
        "coupling": case.coupling,
        "nonlinear": case.nonlinear,
        "linear": case.linear,
        "output": case.output,
        "quantities": {quantity.name: quantity for quantity in case.quantities},
    }
    for name, part in parts.items():
        values.update(_leaves(name, part))
    if case.solids:
        values["time.solid"] = case.scheme.name
        values["time.spectral_radius"] = repr(case.scheme.spectral_radius)
    return values


def _leaves(key: str, value: object) -> Iterator[tuple[str, str]]:
    """The values below a key."""
    if isinstance(value, Expression):
        yield key, _text_of(value)
    elif isinstance(value, np.ndarray):
        digest = hashlib.sha256(np.ascontiguousarray(value).tobytes()).hexdigest()[:16]
        yield key, f"an array of shape {value.shape}, {digest}"
    elif is_dataclass(value):
        yield f"{key}.type", type(value).__name__
        for item in fields(value):
            if item.name not in _TOLD_ELSEWHERE:
                yield from _leaves(f"{key}.{_NAMES.get(item.name, item.name)}", getattr(value, item.name))
    elif isinstance(value, Mapping):
        for name, member in value.items():
            yield from _leaves(f"{key}.{name}", member)
    elif isinstance(value, tuple) and value and all(isinstance(member, Expression) for member in value):
        yield key, f"[{', '.join(_text_of(member) for member in value)}]"
    elif isinstance(value, tuple | list) and any(is_dataclass(member) for member in value):
        yield f"{key}.number", str(len(value))
        for k, member in enumerate(value):
            yield from _leaves(f"{key}[{k}]", member)
    elif value is not None:
        yield key, value if isinstance(value, str) else repr(value)


def _text_of(expression: Expression) -> str:
    """The text, with the numbers in it: constants of the scene may have changed."""
    numbers = [repr(step.value) for step in expression.program if isinstance(step, Push)]
    if expression.is_constant:
        return ", ".join(numbers)
    return f'"{expression.text}"' + (f" with {', '.join(numbers)}" if numbers else "")


def _short(text: str) -> str:
    return text if len(text) <= _LONGEST else f"{text[: _LONGEST - 1]}…"
