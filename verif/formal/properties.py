# SPDX-License-Identifier: MIT
"""All properties that are proved. Each is a Verilog file of this folder, whose header says what is proved, and how.

`raycaster.verif.formal.wrapper` describes the Verilog.

The header is TOML in comments after the line `// [proof]`:

- `claim`: the claim in a few words. `modules`: the generated modules that it is about.
- `quick`, `designs`: the designs that it is proved for; the former are the quick subset. A design is options of
  `configure`, several values of an option separated by commas, and words of `WORDS`. Names in capitals set parameters.
  `alone=` chooses one of `ALONE`, if blocks are converted alone instead of a whole design.
- `label`: the proof's name for a design, as an f-string. A text before a colon in the design replaces it; without
  both it is the configuration's name.
- `parameters`: values of the property's constants; all others have the value of the same name in `FACTS`.
- `faults`: by label of a proof, faults that contradict it, as in `raycaster.verif.formal.faults`.
- `induction`, `reach`, `cut`, `as_registers`, `any_product`: as in `Property`.

Values may be Python expressions of these constants and `FACTS`, and modules may have a condition, `name if
CONDITION`. So a table says which designs are proved, and how deep, and no code does.
"""

from __future__ import annotations

import itertools
import tomllib
from collections.abc import Callable, Iterator
from operator import attrgetter
from typing import Any

from raycaster.configuration import Configuration
from raycaster.design.decide import configure
from raycaster.hdl.signals import bits_for
from raycaster.registers import address_bits, register_map
from raycaster.rtl.common import widths
from raycaster.rtl.common.interfaces import AIM_CYCLES
from raycaster.rtl.common.records import Camera, Rect, Surface, look_fields
from raycaster.rtl.cull.rect_setup import SETUP_LATENCY
from raycaster.rtl.engines import ENGINES, SEED, buffered_engine_of
from raycaster.rtl.exact.eye_register import Mirror
from raycaster.rtl.span.first_change import division_cycles, quotient_bits, stage_bits
from raycaster.rtl.span.records import Entry
from raycaster.verif.formal.alone import (
    Alone,
    BridgeAlone,
    ListAlone,
    QueueAlone,
    TableAlone,
    TesterAlone,
    VideoAlone,
)
from raycaster.verif.formal.prover import Property
from raycaster.verif.formal.wrapper import constants, source

ORDER = (
    "video-timing", "avalon-agent", "host-transfers", "axi4lite-transfers", "wishbone-transfers", "apb-transfers",
    "ray-order", "shadow-order", "line-sections", "render-counters", "finder-quotients", "nearest-depth",
    "shares-exact", "group-safe", "tester-exact", "tester-products", "nearest-products",
    "eye-exact", "cell-products", "shadow-products", "shadow-wiring", "unit-wiring", "slope-exact", "row-setup",
    "fixed-rects", "divider-exact", "sign-change", "span-sweep", "run-order", "whole-frames", "played-lines",
)  # fmt: skip
"""Names of the properties, in the order of tables. The file of each has underscores for dashes."""

WORDS: dict[str, dict[str, Any]] = {
    **{name: {"engine": name} for name in ENGINES},
    # For properties that do not depend on the number of units or rectangles: designs that are converted quickly.
    "one-unit": {"units": 1, "allow_underrun": True},
    "tiny": {"screen": "tiny", "units": 2, "allow_underrun": True},
    "two": {"rectangles": 2},
    "pairs": {"rows": 180, "scale": 6, "pixels": 2},
    # Divider steps, and fraction and divider bits that give as many.
    "steps=9": {"fraction_bits": 0, "divider_bits": 1},
    "steps=8": {"fraction_bits": 7, "divider_bits": 2},
    "steps=7": {"fraction_bits": 5, "divider_bits": 2},
    "steps=6": {"fraction_bits": 3, "divider_bits": 2},
    "steps=5": {"fraction_bits": 0, "divider_bits": 2},
    "steps=4": {"fraction_bits": 3, "divider_bits": 3},
    "steps=3": {"fraction_bits": 0, "divider_bits": 3},
}
"""Words for options that many designs have. A word that is not here is an option that is switched on."""

ALONE: dict[str, Callable[[Facts], Alone]] = {
    "video": lambda facts: VideoAlone(),
    "host": lambda facts: BridgeAlone("", facts["ADDRESS_BITS"]),
    "axi4lite": lambda facts: BridgeAlone("axi4lite", facts["ADDRESS_BITS"]),
    "wishbone": lambda facts: BridgeAlone("wishbone", facts["ADDRESS_BITS"]),
    "apb": lambda facts: BridgeAlone("apb", facts["ADDRESS_BITS"]),
    "tester": lambda facts: TesterAlone(facts["COORDINATE_BITS"], facts["REFLECTIONS"]),
    "queue": lambda facts: QueueAlone(facts["COLUMNS"], facts["PLACES"]),
    "list": lambda facts: ListAlone(facts["UNITS"], facts["ROWS"], facts["COLUMNS"], facts["ENTRIES"], facts["PIXELS"]),
    "table": lambda facts: TableAlone(facts.config.engine, bool(facts["ALIKE"])),
}
"""Blocks that are converted alone, by the word in a header."""


FACTS: dict[str, Callable[[Configuration], int]] = {
    "SEED": lambda config: config.engine == SEED.facts.name,
    "RECT_CYCLES": lambda config: buffered_engine_of(config).rect_cycles(config),
    "PASS_LATENCY": lambda config: buffered_engine_of(config).pass_latency(config),
    "GROUP_CYCLES": lambda config: buffered_engine_of(config).group_cycles(config),
    "NEAREST": lambda config: config.rounding == "nearest",
    "LEAD": lambda config: config.screen_geometry.clocks_per_pixel == 1,
    "SETUP_LATENCY": lambda config: SETUP_LATENCY,
    "AIM_CYCLES": lambda config: AIM_CYCLES,
    "CYCLES": division_cycles,
    "STAGE_BITS": stage_bits,
    "ADDRESS_BITS": lambda config: address_bits(*config.map),
    "VERSION_WORD": lambda config: register_map(*config.map)["version"].reset,
    "SLOPE_BITS": widths.exact_slope_bits,
    "LIGHT_BITS": widths.light_slope_bits,
    "STEEPEST": widths.steepest_slope,
    "CYCLE_BITS": lambda config: bits_for(buffered_engine_of(config).rect_cycles(config)),
    "QUOTIENT_BITS": quotient_bits,
    "LOOK_BITS": lambda config: sum(look_fields(config).values()),
    **{
        f"{record.__name__.upper()}_BITS": lambda config, record=record: len(record(config).word)
        for record in (Camera, Rect, Surface, Mirror, Entry)
    },
}
"""Numbers of a design by their names in wrappers; options, and what `widths` has, have their own names."""

SCREEN_FACTS: dict[str, str] = {
    **{
        f"{way}_{name.upper()}": f"{part}.{name}"
        for way, part in (("H", "beats"), ("V", "vertical"))
        for name in ("visible", "front", "sync", "back")
    },
    **{"H_HIGH": "beats.active_high", "V_HIGH": "vertical.active_high", "CLOCKS": "clocks_per_pixel"},
    **{"CENTRE": "centre_column", "HORIZON": "horizon_row"},
    **{name.upper(): name for name in ("doubling", "rows", "columns", "view_distance")},
}
"""Attributes of a screen, likewise."""


class Facts(dict[str, int]):
    """Numbers of a proof: those given for it, and those of its design."""

    def __init__(self, config: Configuration, given: dict[str, int]):
        super().__init__(given)
        self.config = config
        self.screen = config.screen_geometry

    def __missing__(self, name: str) -> int:
        if name in SCREEN_FACTS:
            return int(attrgetter(SCREEN_FACTS[name])(self.screen))
        of_design = FACTS.get(name) or getattr(widths, name.lower(), None)
        found = of_design(self.config) if of_design else getattr(self.config, name.lower(), getattr(widths, name, None))
        if not isinstance(found, int):
            raise KeyError(name)
        return int(found)

    def value(self, expression: str | int) -> Any:
        """Evaluate an expression of these numbers; a number is its own value."""
        if not isinstance(expression, str):
            return expression
        words = {"DESIGN": self.config.name.removeprefix("seed-"), "ENGINE": self.config.engine}
        return eval(expression, {"__builtins__": {}} | words, self)

    def chosen(self, names: list[str]) -> tuple[str, ...]:
        """Return the names whose conditions hold."""
        parts = [name.partition(" if ") for name in names]
        return tuple(name for name, _, condition in parts if not condition or self.value(condition))


def header(text: str) -> dict[str, Any]:
    """Read the header of a property's file."""
    comments = text.partition("// [proof]\n")[2].splitlines()
    return tomllib.loads("\n".join(line[3:] for line in itertools.takewhile(lambda line: line[:2] == "//", comments)))


def _designs(row: str) -> Iterator[tuple[str, Configuration | Alone, Facts]]:
    """Return the designs that a row of a header names, with their facts, and their label if the row has one."""
    label, _, words = row.rpartition(": ")
    choices = []
    for word in words.split():
        name, _, values = word.partition("=")
        options = [
            WORDS.get(f"{name}={each}", {name: int(each) if each.isdigit() else each}) for each in values.split(",")
        ]
        choices.append(options if values else [WORDS.get(name, {name: True})])
    for chosen in itertools.product(*choices):
        options = {name: value for each in chosen for name, value in each.items()}
        alone = options.pop("alone", None)
        given = {name: options.pop(name) for name in [*options] if name.isupper()}
        facts = Facts(configure(**options), given)
        design = ALONE[alone](facts) if alone else facts.config
        if isinstance(design, VideoAlone):
            facts.screen = design.screen
        if isinstance(design, Alone):
            facts.update(design.facts())
        yield label, design, facts


def _proofs(name: str) -> Iterator[Property]:
    wrapper = name.replace("-", "_")
    text = source(wrapper)
    said, names = header(text), constants(text, wrapper)
    quick, given, labels = said.get("quick", []), said.get("parameters", {}), set()
    for row in (*quick, *said.get("designs", [])):
        for own_label, design, facts in _designs(row):
            label = own_label or facts.value(f"f{said['label']!r}" if "label" in said else "DESIGN")
            if label in labels:
                continue  # it is quick too
            labels.add(label)
            values = {each: facts.value(given.get(each, each)) for each in names}
            facts.update(values)
            yield Property(
                name,
                said["claim"],
                design,
                label,
                facts.chosen(said["modules"]),
                values,
                induction=facts.value(said["induction"]),
                cut=facts.chosen(said.get("cut", [])),
                any_product=bool(facts.value(said.get("any_product", False))),
                as_registers=tuple(said.get("as_registers", [])),
                reach=facts.value(said.get("reach", 0)),
                small=row in quick,
                faults=tuple(said.get("faults", {}).get(label, [])),
            )


PROPERTIES: list[Property] = [proof for name in ORDER for proof in _proofs(name)]
