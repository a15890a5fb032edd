"""The Markdown pages: their links lead somewhere, their Python and TOML can be read; that of the meshing pages runs."""

from __future__ import annotations

import ast
import json
import re
import runpy
import tomllib
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
PAGES = sorted(
    page
    for pattern in ("*.md", "docs/**/*.md", "packages/*/*.md", "examples/**/*.md", "benchmarks/**/*.md")
    for page in ROOT.glob(pattern)
)
FENCE = re.compile(r"^(?P<indent> *)```(?P<language>[\w-]*)[^\n]*\n(?P<code>.*?)^ *```", re.MULTILINE | re.DOTALL)
LINK = re.compile(r"!?\[[^\]]*\]\((?P<target>[^)\s]+)(?:\s+\"[^\"]*\")?\)")
HEADING = re.compile(r"^#{1,6}\s+(?P<text>.+?)\s*#*$", re.MULTILINE)
PARSERS = {"python": ast.parse, "toml": tomllib.loads, "json": json.loads}


def _read(page: Path) -> str:
    return page.read_text(encoding="utf-8")


def _name(page: Path) -> str:
    return page.relative_to(ROOT).as_posix()


def _prose(text: str) -> str:
    return re.sub(r"`[^`\n]*`", "", FENCE.sub("", text))


def _anchors(text: str) -> set[str]:
    """The anchors GitHub gives to the headings of a page."""
    anchors: dict[str, int] = {}
    for heading in HEADING.finditer(FENCE.sub("", text)):
        words = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading["text"]).lower()
        slug = re.sub(r"[^\w\- ]", "", words).replace(" ", "-")
        anchors[slug] = anchors.get(slug, -1) + 1
    return {slug if number == 0 else f"{slug}-{number}" for slug, last in anchors.items() for number in range(last + 1)}


def _broken_links(page: Path) -> Iterator[str]:
    for link in LINK.finditer(_prose(_read(page))):
        target = link["target"]
        if re.match(r"[a-z][a-z0-9+.-]*:", target):
            continue
        path, _, anchor = target.partition("#")
        destination = (page.parent / path).resolve() if path else page
        if not destination.exists():
            yield f"{target}: there is no {path}"
        elif anchor and destination.suffix == ".md" and anchor not in _anchors(_read(destination)):
            yield f"{target}: {_name(destination)} has no heading #{anchor}"


def test_pages_are_found() -> None:
    assert {"CONTRIBUTING.md", "docs/conventions.md", "docs/scene.md"} <= {_name(page) for page in PAGES}


@pytest.mark.parametrize("page", PAGES, ids=_name)
def test_links_lead_somewhere(page: Path) -> None:
    assert list(_broken_links(page)) == []


@pytest.mark.parametrize("page", PAGES, ids=_name)
def test_snippets_can_be_read(page: Path) -> None:
    unreadable = []
    for fence in FENCE.finditer(_read(page)):
        parse = PARSERS.get(fence["language"])
        if parse is None:
            continue
        code = re.sub(rf"^{fence['indent']}", "", fence["code"], flags=re.MULTILINE)
        try:
            parse(code)
        except (SyntaxError, ValueError) as error:
            unreadable.append(f"{fence['language']} snippet {code.splitlines()[0]!r}: {error}")
    assert unreadable == []


@pytest.mark.parametrize("page", [page for page in PAGES if page.parent.name == "meshing"], ids=_name)
def test_python_of_a_meshing_page_runs_from_top_to_bottom(
    page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    snippets = [fence["code"] for fence in FENCE.finditer(_read(page)) if fence["language"] == "python"]
    (tmp_path / "page.py").write_text("\n".join(snippets), encoding="utf-8")
    runpy.run_path(str(tmp_path / "page.py"))


@pytest.mark.parametrize(
    ("text", "broken"),
    [
        ("[a](there.md)", []),
        ("[a](there.md#two-words-once)", []),
        ("[a](#here)\n# Here", []),
        ("`[a](nowhere.md)` and [b](https://example.org)", []),
        ("[a](nowhere.md)", ["nowhere.md: there is no nowhere.md"]),
        ("[a](#gone)\n# Here", ["#gone: page.md has no heading #gone"]),
    ],
)
def test_link_check_itself(text: str, broken: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(f"{__name__}.ROOT", tmp_path)
    (tmp_path / "there.md").write_text("# Two words, once\n", encoding="utf-8")
    (tmp_path / "page.md").write_text(text, encoding="utf-8")
    assert list(_broken_links(tmp_path / "page.md")) == broken
