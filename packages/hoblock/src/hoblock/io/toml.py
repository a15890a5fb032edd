"""TOML files of scenes: reading them, and changing single values from the command line."""

from __future__ import annotations

import contextlib
import copy
import os
import re
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from hoblock.errors import SceneError
from hoblock.io.values import describe, place_of
from hoblock.spelling import suggestion

__all__ = ["apply_overrides", "naming_file", "read_toml", "repeat_option"]

_CHANGE = re.compile(r"[A-Za-z_][\w.\[\]\"-]*=")
_SEGMENT = re.compile(r'([A-Za-z0-9_-]+)|"([^"]+)"|\[([0-9]{1,9})\]')


def read_toml(path: str | os.PathLike[str]) -> dict[str, Any]:
    """Parse a TOML file.

    Parameters
    ----------
    path : path-like
        The file; UTF-8, with or without a byte order mark.

    Returns
    -------
    dict
        The tables as the parser gives them.

    Raises
    ------
    SceneError
        If the file does not exist, cannot be read, is not valid TOML (with line and column) or is empty.
    """
    path = Path(path)
    with naming_file(path):
        try:
            data = tomllib.loads(_text_of(path))
        except tomllib.TOMLDecodeError as error:
            raise SceneError(f"not valid TOML: {error}") from error
        except (ValueError, RecursionError) as error:
            raise SceneError("not readable as TOML: a number is too long or lists are nested too deeply") from error
        if not data:
            raise SceneError("the file is empty: expected at least [mesh]")
    return data


def apply_overrides(data: Mapping[str, Any], overrides: Sequence[str]) -> dict[str, Any]:
    """Change values of a parsed TOML file.

    Parameters
    ----------
    data : mapping
        The tables as the parser gives them; not changed.
    overrides : sequence of str
        ``"key.sub=value"`` each, applied in order. List items are ``solid[0].density`` or ``solid.0.density``;
        keys with special characters stand in double quotes. The value is TOML; what is not TOML is a text.
        Missing keys and tables are created.

    Returns
    -------
    dict
        A changed deep copy.

    Raises
    ------
    SceneError
        If an override has no ``=``, no key or no value, or its key leads through something that is not a table.
    """
    changed = copy.deepcopy(dict(data))
    for override in overrides:
        key, equals, text = override.partition("=")
        if not equals or not key.strip():
            raise SceneError(f"got {override!r}; expected key=value, for example mesh.order=6", "--set")
        _assign(changed, _segments(key.strip(), override), _value(text.strip(), override), override)
    return changed


@contextlib.contextmanager
def naming_file(file: str | os.PathLike[str]) -> Iterator[None]:
    """Put the name of the file into every `SceneError` that passes through without one."""
    try:
        yield
    except SceneError as error:
        error.file = error.file or os.fspath(file)
        raise


def _text_of(path: Path) -> str:
    try:
        return path.read_bytes().decode("utf-8-sig").replace("\r\n", "\n")
    except FileNotFoundError as error:
        raise SceneError(f"no such file. {_neighbour(path)}Check the name and the folder") from error
    except IsADirectoryError as error:
        raise SceneError("this is a folder; expected a TOML file") from error
    except UnicodeDecodeError as error:
        raise SceneError(f"not UTF-8 text (byte {error.start}); save the file as UTF-8") from error
    except (OSError, ValueError) as error:
        raise SceneError(f"cannot be read: {error}") from error


def _neighbour(path: Path) -> str:
    try:
        return suggestion(path.name, sorted(other.name for other in path.parent.glob("*.toml")))
    except OSError:
        return ""


def _value(text: str, override: str) -> Any:
    if not text:
        raise SceneError(f'got {override!r} without a value; write key="" for an empty text', "--set")
    with contextlib.suppress(ValueError, RecursionError):
        parsed = tomllib.loads(f"v = {text}")
        if set(parsed) == {"v"}:
            return parsed["v"]
    if text[0] in "[{\"'":
        raise SceneError(f"got {override!r}; the value begins like a TOML list, table or text but is none", "--set")
    return text


def _segments(key: str, override: str) -> list[str | int]:
    segments: list[str | int] = []
    position = 0
    while True:
        match = _SEGMENT.match(key, position)
        if match is None or (match[3] is not None and not segments):
            raise SceneError(
                f"got {override!r}; the key cannot be read at character {position + 1}. Expected names separated by "
                "dots, for example solid[0].density",
                "--set",
            )
        segments.append(int(match[3]) if match[3] is not None else match[1] or match[2])
        position = match.end()
        if position == len(key):
            return segments
        if key[position] == ".":
            position += 1
        elif key[position] != "[":
            raise SceneError(
                f"got {override!r}; expected a dot after {key[: match.end()]!r}, for example solid[0].density", "--set"
            )


def _assign(data: dict[str, Any], segments: Sequence[str | int], value: Any, override: str) -> None:
    holder: Any = data
    place = ""
    for depth, segment in enumerate(segments):
        last = depth == len(segments) - 1
        if isinstance(holder, list):
            index = _index(segment, holder, place)
            place = f"{place}[{index}]"
            if last:
                holder[index] = value
                return
            holder = holder[index]
        elif isinstance(holder, dict) and isinstance(segment, str):
            place = place_of(place, segment)
            if last:
                holder[segment] = value
                return
            if segment not in holder and isinstance(segments[depth + 1], int):
                raise SceneError(f"there is no such list; --set {override} can only change items that exist", place)
            holder = holder.setdefault(segment, {})
        else:
            what = "a list" if isinstance(segment, int) else "a table"
            raise SceneError(f"it is {describe(holder)}, not {what}; --set {override} cannot reach into it", place)


def _index(segment: str | int, items: Sequence[Any], place: str) -> int:
    index = int(segment) if re.fullmatch("[0-9]{1,9}", str(segment)) else -1
    if not 0 <= index < len(items):
        expected = f"an index from 0 to {len(items) - 1}" if items else "no index, the list is empty"
        raise SceneError(f"got the index {segment}; expected {expected}", place)
    return index


def repeat_option(arguments: Sequence[str], option: str = "--set") -> list[str]:
    """Return a command line's words with ``--set a=1 b=2`` written as ``--set a=1 --set b=2``.

    A word after a value of the option counts as another value if it reads ``key=…``.
    """
    words: list[str] = []
    values = False  # the last word was a value of the option
    for word in arguments:
        if values and _CHANGE.match(word):
            words.append(option)
        values = bool(words) and words[-1] == option
        words.append(word)
    return words
