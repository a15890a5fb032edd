"""Tables and pictures of the benchmarks put in their places on pages of the documentation."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

__all__ = ["TABLES", "filled", "markdown"]

Found = Mapping[str, Any]
_PLACE = re.compile(r"<!-- measured: (?P<name>[\w.]+) -->\n.*?<!-- end of measured -->", re.DOTALL)


def filled(page: str, results: Path) -> tuple[str, list[str]]:
    """A page with the tables of the results that there are, and the names of those that there are not.

    Parameters
    ----------
    page : str
        With places between ``<!-- measured: NAME -->`` and ``<!-- end of measured -->``.
    results : Path
        A folder with ``NAME.json``.
    """
    missing = []

    def table(match: re.Match[str]) -> str:
        name = match["name"]
        file = results / f"{name}.json"
        if not file.is_file():
            missing.append(name)
            return match[0]
        found = json.loads(file.read_text(encoding="utf-8"))
        machine, date = found["machine"], found["date"][:10]
        where = (
            f"{date}, {machine['processor']}, {machine['processors']} processors, Python {found['versions']['python']}"
        )
        return f"<!-- measured: {name} -->\n{TABLES[name](found).strip()}\n\n*{where}*\n<!-- end of measured -->"

    return _PLACE.sub(table, page), missing


def markdown(rows: Sequence[Mapping[str, Any]], columns: Mapping[str, str] | None = None) -> str:
    """Rows as a Markdown table; ``columns`` are keys of the rows and their titles."""
    columns = columns or {name: name for name in rows[0]}
    lines = [list(columns.values()), ["---"] * len(columns)]
    lines += [[_text(row.get(name)) for name in columns] for row in rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def _text(value: object) -> str:
    if value is None:
        return ""
    if isinstance(value, float):
        return f"{value:.3g}"
    return str(value).replace("|", "\\|")


def _percent(value: float | None) -> str:
    return "" if value is None else f"{100.0 * value:.2g} %"


def _bench(found: Found) -> str:
    rows = []
    for case in found["cases"]:
        name, seconds = f"**{case['name']}**", f"{case['seconds']['total']:.1f}"
        for finding in case["findings"]:
            limit = (
                _percent((finding["to"] - finding["reference"]) / abs(finding["reference"]))
                if finding["reference"]
                else _limit(finding)
            )
            rows.append(
                {
                    "case": name,
                    "quantity": finding["quantity"],
                    "found": None if finding["value"] is None else f"{finding['value']:.7g}",
                    "reference": ""
                    if finding["reference"] is None
                    else f"{finding['reference']:.9g} ± {_percent(finding['uncertainty'])}",
                    "error": "" if finding["error"] is None else f"{100.0 * finding['error']:+.2g} %",
                    "allowed": limit,
                    "": "pass" if finding["passed"] else "**fail**",
                    "seconds": seconds,
                }
            )
            name = seconds = ""
    return markdown(rows)


def _limit(finding: Found) -> str:
    low, high = finding["from"], finding["to"]
    if low is None:
        return f"at most {high:g}"
    return f"at least {low:g}" if high is None else f"{low:g} to {high:g}"


def _factors(below: str) -> Callable[[Found], str]:
    def table(found: Found) -> str:
        from _precision import factors_table

        return factors_table(found["settings"]["factors"], below)

    return table


def _flags(found: Found) -> str:
    from flag_oscillations import shown

    return markdown([shown(row) for row in found["rows"]])


def _regime(found: Found) -> str:
    from coupling_regime import tables

    return str(tables(found["rows"]))


def _flap(found: Found) -> str:
    names = ("program", "order", "mesh", "nodes", "dt", "iterations", "CPU s")
    errors = {f"error of {name}": f"error of {name}" for name in ("u_x", "u_y", "f_x")}
    rows = markdown(found["rows"], {name: name for name in names} | errors)
    return f"{_factors('all errors below')(found)}\n\n{rows}"


def _stress(found: Found) -> str:
    rows = found["rows"]
    groups = dict.fromkeys(row["group"] for row in rows)
    own = {group: [row for row in rows if row["group"] == group] for group in groups}
    good = {group: sum(row["verdict"] == "as expected" for row in own[group]) for group in groups}
    summary = [
        {
            "group": group,
            "cases": str(len(own[group])),
            "as expected": str(good[group]),
            "seconds": f"{sum(row['seconds'] for row in own[group]):.1f}",
        }
        for group in groups
    ]
    wrong = [row for row in rows if row["verdict"] != "as expected"]
    parts = [markdown(summary)]
    if wrong:
        columns = {"group": "group", "case": "case", "bound": "expected", "found": "found"}
        parts += ["**Not as expected:**", markdown(wrong, columns)]
    for group in groups:
        columns = {"case": "case", "bound": "expected", "found": "found", "verdict": ""}
        table = markdown(own[group], columns)
        parts.append(f"<details><summary>{group}: all {len(own[group])} cases</summary>\n\n{table}\n\n</details>")
    return "\n\n".join(parts)


def _rows(found: Found) -> str:
    return markdown(found["rows"])


def _profile(found: Found) -> str:
    phases, modules = (found["settings"][name] for name in ("phases ms", "modules ms"))
    parts = [
        markdown([{name: f"{value:.1f}" for name, value in phases.items()}]),
        markdown([{"module": name, "own ms": f"{value:.1f}"} for name, value in modules.items()]),
        markdown(found["rows"]),
    ]
    return "\n\n".join(parts)


def _motion(found: Found) -> str:
    names = ("test", "layout", "family", "mover", "end", "reach", "jacobian at mark", "milliseconds", "outcome")
    return markdown(found["rows"], {name: name for name in names})


TABLES: Mapping[str, Callable[[Found], str]] = {
    "bench": _bench,
    "fluid_work_precision": _factors("all errors below"),
    "solid_work_precision": _factors("both errors below"),
    "fsi1_work_precision": _factors("all errors below"),
    "flag_precision": _flags,
    "coupling_regime": _regime,
    "skipping": _rows,
    "step_profile": _profile,
    "gmsh_transfinite": _rows,
    "mesh_motion": _motion,
    "flap_kratos": _flap,
    "stress_suite": _stress,
}
