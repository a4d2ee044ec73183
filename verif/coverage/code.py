# SPDX-License-Identifier: MIT
"""Code coverage: Verilator's counts in the converted Verilog, and explanations of points that were never hit."""

from __future__ import annotations

import re
import tomllib
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from pathlib import Path

from pydantic import BaseModel, ConfigDict, ValidationError, model_validator

from raycaster.complaints import refusal
from raycaster.errors import UserError

HOLES = Path(__file__).with_name("holes.toml")
KINDS = {"lines": ("line", "branch"), "conditions": ("expr",), "toggles": ("toggle",)}
"""Kinds of points in reports, with Verilator's types."""

_RECORD = re.compile(r"C '(?P<fields>.*)' (?P<count>\d+)")
_TOGGLE = re.compile(r"(?P<signal>.*?)(?:\[(?P<bit>\d+)\])?:(?P<edge>0->1|1->0)")


@dataclass(frozen=True)
class Point:
    """A coverage point of a module, whose instances count together."""

    module: str
    kind: str
    """Verilator's type: line, branch, expr or toggle."""

    what: str
    """`signal[bit]:0->1`, the values of a condition, or how a line is entered, with its text."""

    file: Path
    line: int
    column: int

    @cached_property
    def toggle(self) -> tuple[str, int | None, str] | None:
        """Signal, bit and edge of a toggle; the bit is None for a one-bit signal."""
        match = _TOGGLE.fullmatch(self.what) if self.kind == "toggle" else None
        return match and (match["signal"], None if match["bit"] is None else int(match["bit"]), match["edge"])


class Explanation(BaseModel):
    """Reason why some points cannot be hit: toggles by `signal`, or lines and conditions by `code`."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    module: str
    """Regular expression that matches a whole module name; likewise `signal`."""

    signal: str | None = None
    bits: str | None = None
    """Bits such as "9, 19, 29-31"; all bits of the signal by default."""

    edge: str | None = None
    """0->1 or 1->0; both by default."""

    code: str | None = None
    """Regular expression that is searched for in `Point.what`."""

    engine: str | None = None
    """Regular expression for the engine, if not every engine with the module has the hole."""

    reason: str

    @model_validator(mode="after")
    def _one_kind(self) -> Explanation:
        if (self.signal is None) == (self.code is None):
            raise ValueError("either signal or code is needed")
        return self

    @cached_property
    def wanted_bits(self) -> frozenset[int] | None:
        """The bits, or None for all."""
        if self.bits is None:
            return None
        found: set[int] = set()
        for part in self.bits.split(","):
            first, _, last = part.strip().partition("-")
            found |= set(range(int(first), int(last or first) + 1))
        return frozenset(found)

    def covers(self, point: Point) -> bool:
        """True if it explains why a point was not hit."""
        if not re.fullmatch(self.module, point.module):
            return False
        if self.signal is None:
            return point.kind != "toggle" and bool(re.search(self.code or "", point.what))
        if point.toggle is None:
            return False
        signal, bit, edge = point.toggle
        return (
            bool(re.fullmatch(self.signal, signal))
            and (self.wanted_bits is None or bit in self.wanted_bits)
            and self.edge in (None, edge)
        )

    def __str__(self) -> str:
        what = f"{self.signal}[{self.bits}]" if self.bits else self.signal or self.code
        return f"{self.module}: {what}{f' {self.edge}' if self.edge else ''} ({self.reason})"


@dataclass(frozen=True)
class Judgement:
    """Points that were not hit, with and without an explanation."""

    explained: dict[Point, Explanation]
    unexplained: list[Point]
    stale: list[str]
    """Explanations, or bits of them, for points that were hit or do not exist in the named modules."""


def read_counts(path: Path, leave_out: Iterable[str] = ()) -> Counter[Point]:
    """Count how often each point was hit in a simulation, including never.

    Args:
        path: Verilator's coverage.dat; the Verilog files that it names must exist.
        leave_out: modules to leave out, whatever their parameters.
    """
    counts: Counter[Point] = Counter()
    left_out = set(leave_out)
    for record in path.read_text().splitlines():
        if not (match := _RECORD.fullmatch(record)):
            continue
        # Each field is \1 name \2 value.
        values = dict(part.split("\2", 1) for part in match["fields"].split("\1") if part)
        module = values["page"].partition("/")[2]
        # Verilator adds a suffix to the names of modules with parameters.
        if module.partition("__")[0] in left_out:
            continue
        kind, line, what = values["t"], int(values["l"]), values["o"]
        if kind in ("line", "branch"):
            what = f"{what}: {_source(values['f'])[line - 1].strip()}"
        counts[Point(module, kind, what, Path(values["f"]), line, int(values["n"]))] += int(match["count"])
    return counts


@lru_cache
def _source(path: str) -> list[str]:
    return Path(path).read_text().splitlines()


def load_explanations(engine: str, path: Path = HOLES) -> list[Explanation]:
    """Read the explanations of an engine's holes.

    Raises:
        UserError: the file is malformed.
    """
    try:
        every = [Explanation(**table) for table in tomllib.loads(path.read_text())["hole"]]
        return [one for one in every if one.engine is None or re.fullmatch(one.engine, engine)]
    except ValidationError as error:
        raise UserError(f"{path}: {refusal(error.errors())}") from None
    except (tomllib.TOMLDecodeError, KeyError) as error:
        raise UserError(f"{path}: {error}") from None


def judge(counts: Mapping[Point, int], explanations: Sequence[Explanation]) -> Judgement:
    """Match points that were never hit with explanations; the first match counts.

    Explanations of modules that the design does not have are ignored.
    """
    modules = {point.module for point in counts}
    explanations = [one for one in explanations if any(re.fullmatch(one.module, module) for module in modules)]
    explained: dict[Point, Explanation] = {}
    unexplained = []
    used: dict[Explanation, set[int | None]] = {explanation: set() for explanation in explanations}
    for point in sorted((point for point, count in counts.items() if not count), key=_place):
        explanation = next((candidate for candidate in explanations if candidate.covers(point)), None)
        if explanation is None:
            unexplained.append(point)
        else:
            explained[point] = explanation
            used[explanation].add(point.toggle[1] if point.toggle else None)
    stale = []
    for explanation, bits in used.items():
        if not bits:
            stale.append(str(explanation))
        elif missing := (explanation.wanted_bits or frozenset()) - bits:
            stale.append(f"{explanation}: bits {', '.join(map(str, sorted(missing)))}")
    return Judgement(explained, unexplained, stale)


def _place(point: Point) -> tuple[str, int, int, str]:
    return point.module, point.line, point.column, point.what


def describe(points: Iterable[Point]) -> list[str]:
    """Return a line for each place: file, line and what was not hit, with a signal's bits together."""
    places: dict[tuple[str, int, str], list[str]] = {}
    for point in points:
        if point.toggle:
            signal, bit, edge = point.toggle
            places.setdefault((point.file.name, point.line, signal), []).append(
                edge if bit is None else f"[{bit}] {edge}"
            )
        else:
            places.setdefault((point.file.name, point.line, point.what), [])
    return [
        f"{file}:{line}: {what}{': ' + ', '.join(edges) if edges else ''}"
        for (file, line, what), edges in places.items()
    ]
