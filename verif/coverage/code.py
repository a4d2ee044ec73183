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

from raycaster.errors import UserError

HOLES = Path(__file__).with_name("holes.toml")
EVERY = "every"
KINDS = {"lines": ("line", "branch"), "conditions": ("expr",), "toggles": ("toggle",)}
"""Kinds of points in reports, with Verilator's types."""

_RECORD = re.compile(r"C '(?P<fields>.*)' (?P<count>\d+)")
_RULE = re.compile(
    r"(?P<module>[^:]+): (?:/(?P<code>.+)/|"
    r"(?P<signal>\S+)(?: \[(?P<bits>[-\d, ]+)\])?(?: (?P<edge>0->1|1->0)| = (?P<constant>\d+))?)"
)
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


@dataclass(frozen=True)
class Explanation:
    """Reason why some points cannot be hit: toggles of signals, or lines and conditions with some code."""

    engines: str
    """Regular expression for the engines that have the hole; `EVERY` if all do that have the module."""

    rule: str
    """`module: signal`, or `module: /code/`, with the points' place and name as regular expressions: those of modules
    and signals match a whole name; code is searched for in `Point.what`. Bits such as `[9, 19, 29-31]`, an edge
    `1->0`, or a signal's only value such as `= 100` may follow."""

    reason: str

    def __post_init__(self):
        if not _RULE.fullmatch(self.rule):
            raise UserError(f"expected a rule such as module: signal [9, 29-31] 1->0, got {self.rule}")

    @cached_property
    def _parts(self) -> Mapping[str, str]:
        match = _RULE.fullmatch(self.rule)
        return match.groupdict(default="") if match else {}

    @cached_property
    def constant(self) -> int | None:
        """The only value of the signal, if the rule names it."""
        return int(self._parts["constant"]) if self._parts["constant"] else None

    @cached_property
    def bits(self) -> frozenset[int] | None:
        """The bits, or None for all."""
        if not self._parts["bits"]:
            return None
        ends = (part.partition("-") for part in self._parts["bits"].split(","))
        return frozenset(bit for first, _, last in ends for bit in range(int(first), int(last or first) + 1))

    def is_in(self, modules: Iterable[str]) -> bool:
        """True if any of the modules may have the hole."""
        return any(re.fullmatch(self._parts["module"], module) for module in modules)

    def covers(self, point: Point) -> bool:
        """True if it explains why a point was not hit."""
        if not self.is_in([point.module]):
            return False
        if self._parts["code"]:
            return point.kind != "toggle" and bool(re.search(self._parts["code"], point.what))
        if point.toggle is None:
            return False
        signal, bit, edge = point.toggle
        if not re.fullmatch(self._parts["signal"], signal):
            return False
        if self.constant is not None:
            # A bit that is 1 rises once, when the simulation begins.
            return edge == "1->0" or not self.constant >> (bit or 0) & 1
        return (self.bits is None or bit in self.bits) and self._parts["edge"] in ("", edge)

    def __str__(self) -> str:
        return f"{self.rule} ({self.reason})"


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
        tables = tomllib.loads(path.read_text())
        every = [
            Explanation(engines, rule, reason)
            for engines, reasons in tables.items()
            for reason, rules in reasons.items()
            for rule in rules
        ]
        return [one for one in every if one.engines == EVERY or re.fullmatch(one.engines, engine)]
    except (UserError, tomllib.TOMLDecodeError, AttributeError, TypeError) as error:
        raise UserError(f"{path}: {error}") from None


def judge(counts: Mapping[Point, int], explanations: Sequence[Explanation]) -> Judgement:
    """Match points that were never hit with explanations; the first match counts.

    Explanations of modules that the design does not have are ignored.
    """
    modules = {point.module for point in counts}
    explanations = [one for one in explanations if one.is_in(modules)]
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
        elif missing := (explanation.bits or frozenset()) - bits:
            stale.append(f"{explanation}: bits {', '.join(map(str, sorted(missing)))}")
    constants = [explanation for explanation in explanations if explanation.constant is not None]
    for point in sorted((point for point, count in counts.items() if count and point.toggle), key=_place):
        stale += [f"{explanation}: {point.what} was hit" for explanation in constants if explanation.covers(point)]
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
