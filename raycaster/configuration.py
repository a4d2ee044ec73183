# SPDX-License-Identifier: MIT
"""The one home of what a design is: its screen, its size, its arithmetic, and the row budget that they must meet."""

from __future__ import annotations

from dataclasses import fields
from functools import cached_property
from typing import Any, Literal

from pydantic import ConfigDict, Field, ValidationError, model_validator
from pydantic.dataclasses import dataclass as validated_dataclass

from raycaster.engines import ENGINES, Engine
from raycaster.errors import UserError
from raycaster.fixed import FixedScene
from raycaster.screens import Screen

COORDINATE_BITS = 9
"""World coordinates are unsigned: 0..511."""

WORLD_SIZE = 1 << COORDINATE_BITS
MOST_RECTANGLES = 32
"""Entries that the largest rectangle table has."""

MOST_REFLECTIONS = 4
"""That a ray may have."""

CHANNEL_BITS = 8
"""Bits a colour channel has until it leaves for the monitor."""

UNIT_CELLS = {1: 559, 2: 607, 3: 647}
"""LUT4 of an ECP5 that a unit of the seed engine takes, by quotient bits a cycle; from `make area DIVIDER_BITS=`."""

GROUP_OVERHEAD = 4
"""Cycles a group pays once: the write to the line buffer with the reset of two cycles, idling, ray generation."""

SLOW_HZ = 50_000_000
"""A clock that designs meet on the chips of the boards without registers on long wires."""


class ConfigurationError(UserError):
    """A configuration that cannot be built, with one line that says what, where and what to do."""


@validated_dataclass(frozen=True, kw_only=True, config=ConfigDict(extra="forbid"))
class Configuration:
    """Everything that distinguishes one generated design from another.

    `rows`, `scale`, `units` and `divider_bits` may be left to the default (`None`, `"auto"`); a constructed
    configuration holds the numbers that were chosen, so that equal designs compare equal. An engine without quotients
    has no fraction, no rounding and no divider bits; the beam engine has a unit for each pixel of a clock, and every
    scale that its monitor has pixels for. With a fixed scene, `rectangles` are the scene's, and the seed engine too
    takes as few units as do. Culling saves cycles in most groups and none in the worst case, so the row budget does not
    know of it.

    Raises `ConfigurationError` through `configure`; constructed directly, pydantic's `ValidationError`.
    """

    engine: Literal["seed", "exact", "beam"] = Field("seed", description="what computes the rays: seed, exact or beam")
    units: int | None = Field(
        None, ge=1, description="ray units in parallel, a divisor of the columns: 32; the fewest of the exact engine; 1"
    )
    rectangles: int = Field(12, ge=1, le=MOST_RECTANGLES, description="rectangles that the scene memory holds")
    reflections: int = Field(1, ge=0, le=MOST_REFLECTIONS, description="reflections a ray may have")
    rows: int | None = Field(
        None,
        description="rows of rays: 240 (640x480@60), 200 (640x400@70); not beam: 120, 96 or 60 (640x480@60 at half the "
        "clock); beam only: 180 (1280x720@60, or SCALE=6)",
    )
    scale: int | None = Field(
        None,
        description="resolution scale: 1; beam: 1, 2 or 4, and as fine as the monitor where it is left out; "
        "of 180 rows 3 or 6 too (1920x1080)",
    )
    pixels: int = Field(1, ge=1, le=2, description="pixels a clock: 1, or 2 (beam) where each has a column of its own")
    fraction_bits: int = Field(0, ge=0, le=8, description="fraction bits of origins, planes and quotients")
    rounding: Literal["truncate", "nearest"] = Field("truncate", description="of quotients")
    divider_bits: int | Literal["auto"] = Field("auto", description="quotient bits a cycle: auto, 1, 2 or 3")
    colour_bits: int = Field(8, ge=1, le=CHANNEL_BITS, description="bits a colour channel on the VGA output")
    screen: Literal["vga", "tiny", "play"] = Field(
        "vga",
        description="vga, tiny (64x48) for slow simulators, or play (320x240, beam only), whose frames are short",
    )
    allow_underrun: bool = Field(False, description="accept a design that cannot meet the row budget")
    culling: bool | None = Field(
        None, description="give up early what no ray of a group can hit, 1 or 0: 1 of the seed engine's general design"
    )
    turn: bool | None = Field(
        None, description="a camera that turns, 1 or 0 (exact and beam): 1 where the scene's does"
    )
    materials: bool | None = Field(
        None, description="rectangles that mirror more or less than half, 1 or 0: 1 where the scene has them"
    )
    patterns: bool | None = Field(
        None, description="rectangles with a pattern of two colours, 1 or 0: 1 where the scene has them"
    )
    bus: Literal["avalon", "axi4lite", "wishbone", "apb"] = Field(
        "avalon", description="what the registers are behind: avalon, axi4lite, wishbone or apb"
    )
    fixed: FixedScene | None = Field(None, description="what of a scene is built in")

    @model_validator(mode="after")
    def _complete(self) -> Configuration:
        if self.fixed is not None:
            object.__setattr__(self, "rectangles", len(self.fixed.rectangles))
            if len(self.fixed.passes) != self.reflections + 1:
                raise ValueError(f"fixed: is for {len(self.fixed.passes) - 1} reflections, not {self.reflections}")
        self._choose_rows()
        self._choose_scale()
        self._check_pixels()
        if not self.facts.divides:
            self._refuse_quotients()
        self._choose_culling()
        self._choose_looks()
        if self.units is None:
            self._choose_units()
        elif not self.facts.line_buffered and self.units != self.pixels:
            raise ValueError(
                f"units: the beam engine has one for each of PIXELS={self.pixels} a clock, not {self.units}"
            )
        if self.screen_geometry.columns % self.units:
            columns = self.screen_geometry.columns
            divisors = ", ".join(str(n) for n in range(1, columns + 1) if columns % n == 0)
            raise ValueError(f"units: {self.units} does not divide the {columns} columns; choose one of {divisors}")
        self._choose_divider_bits()
        self._check_budget()
        return self

    @property
    def facts(self) -> Engine:
        """What its engine is."""
        return ENGINES[self.engine]

    def _choose_rows(self) -> None:
        allowed = [rows for screen, rows in self.facts.screens if screen == self.screen]
        if not allowed:
            raise ValueError(f"screen: {self.screen} needs the beam engine, ENGINE=beam, not {self.engine}")
        if self.rows is None:
            object.__setattr__(self, "rows", allowed[0])
        elif self.rows not in allowed:
            choices = " or ".join(map(str, allowed))
            beam = "; 180 rows need the beam engine, ENGINE=beam" if self.rows == 180 and self.screen == "vga" else ""
            raise ValueError(f"rows: the {self.screen} screen has {choices} rows, not {self.rows}{beam}")

    def _choose_scale(self) -> None:
        """The finest that the monitor shows, where the engine is one that has scales."""
        screen = self.facts.screens[self.screen, self.rows]
        allowed = [1] if self.facts.line_buffered else screen.scales
        if self.scale is None:
            object.__setattr__(self, "scale", 1 if self.facts.line_buffered else screen.doubling)
        elif self.scale not in allowed:
            scales = " or ".join(map(str, allowed))
            beam = "; scales need the beam engine, ENGINE=beam" if self.engine != "beam" else ""
            shown = f"the {self.engine} engine shows {self.rows} rows at {scales}"
            raise ValueError(f"scale: {shown}, not {self.scale}{beam}")

    def _check_pixels(self) -> None:
        """Two pixels a clock are two neighbouring columns, and both edges of each sync are between two clocks."""
        if self.pixels == 1:
            return
        if self.facts.line_buffered:
            raise ValueError(f"pixels: 2 a clock need the beam engine, ENGINE=beam, not {self.engine}")
        screen = self.facts.screens[self.screen, self.rows].scaled(self.scale)
        if screen.doubling != 1:
            finest = self.scale * screen.doubling
            raise ValueError(
                f"pixels: 2 a clock need a column for each of the monitor's pixels, SCALE={finest}, not {self.scale}"
            )
        line = screen.horizontal
        if any(part % 2 for part in (line.visible, line.front, line.sync, line.back)):
            raise ValueError(
                f"pixels: 2 a clock need an even width and blanking, and the {self.screen} screen's are not"
            )

    def _refuse_quotients(self) -> None:
        if self.fraction_bits:
            raise ValueError(f"fraction_bits: the {self.engine} engine has none, not {self.fraction_bits}")
        if self.rounding != "truncate":
            raise ValueError(f"rounding: the {self.engine} engine does not round; leave out {self.rounding}")
        if self.divider_bits not in ("auto", 0):
            raise ValueError(f"divider_bits: the {self.engine} engine has no divider; leave out {self.divider_bits}")
        object.__setattr__(self, "divider_bits", 0)

    def _choose_culling(self) -> None:
        """The seed engine's slots are long enough to be worth it; what a fixed scene does not need is left out."""
        if self.culling is None:
            object.__setattr__(self, "culling", self.facts.divides and self.fixed is None)
        elif self.culling and not self.facts.line_buffered:
            raise ValueError("culling: the beam engine takes all rectangles at once; leave it out")
        elif self.culling and self.fixed is not None:
            raise ValueError("culling: is for scenes that change; leave it out, or what is fixed")

    def _choose_looks(self) -> None:
        """What no scene asks for is left out."""
        for name in ("turn", "materials", "patterns"):
            object.__setattr__(self, name, bool(getattr(self, name)))
        if self.turn and not self.facts.turns:
            raise ValueError(
                f"turn: the {self.engine} engine measures depth along x, so its camera cannot turn; "
                "choose ENGINE=exact or ENGINE=beam"
            )

    def _choose_units(self) -> None:
        """The seed's 32; a beam for each pixel of a clock; otherwise as few as meet the row budget."""
        if not self.facts.line_buffered:
            object.__setattr__(self, "units", self.pixels)
        elif not self.facts.divides:
            object.__setattr__(self, "units", self._fewest_units(0))
        elif self.fixed is None:
            object.__setattr__(self, "units", 32)
        else:
            # A faster divider makes a unit larger, but there may be fewer of them.
            given = self.divider_bits
            fewest = {bits: self._fewest_units(bits) for bits in UNIT_CELLS if given in ("auto", bits)}
            chosen = min(fewest, key=lambda bits: fewest[bits] * UNIT_CELLS[bits], default=given)
            object.__setattr__(self, "units", fewest.get(chosen, 32))
            object.__setattr__(self, "divider_bits", chosen)

    def _fewest_units(self, divider_bits: int) -> int:
        """Those that meet the row budget with so many quotient bits a cycle, or all columns where none do."""
        columns = self.screen_geometry.columns
        fitting = (
            units
            for units in range(1, columns + 1)
            if columns % units == 0 and self._group_cycles(divider_bits) <= self._group_budget(units)
        )
        return next(fitting, columns)

    def _choose_divider_bits(self) -> None:
        if not self.facts.divides:
            return
        if self.divider_bits == "auto":
            costs = {bits: self._group_cycles(bits) for bits in (1, 2, 3)}
            chosen = next((bits for bits, cycles in costs.items() if cycles <= self.group_budget), 3)
            object.__setattr__(self, "divider_bits", chosen)
        elif self.divider_bits not in (1, 2, 3):
            raise ValueError(f"divider_bits: must be auto, 1, 2 or 3, not {self.divider_bits}")

    def _check_budget(self) -> None:
        if self.group_cycles > self.group_budget and not self.allow_underrun:
            raise ValueError(
                f"row budget: a group of {self.units} columns takes {self.group_cycles} cycles with {self.rectangles} "
                f"rectangles, {self.reflections} reflections and {self.slot_cycles} cycles a rectangle, but a row "
                f"leaves it {self.group_budget} (less than {self.screen_geometry.row_cycles} cycles over {self.groups} "
                "groups); "
                "take more units or divider bits, fewer rectangles, reflections or fraction bits, or ALLOW_UNDERRUN=1"
            )

    @property
    def looks(self) -> tuple[str, ...]:
        """Of turn, materials and patterns, those that it has."""
        return tuple(name for name in ("turn", "materials", "patterns") if getattr(self, name))

    @property
    def table(self) -> int:
        """Entries of the rectangle table that software writes: none where the rectangles are fixed."""
        return 0 if self.fixed else self.rectangles

    @property
    def passes(self) -> tuple[int, ...]:
        """For the primary ray and each reflection, which rectangles are tested, as a mask."""
        return self.fixed.passes if self.fixed else (self.reflections + 1) * ((1 << self.rectangles) - 1,)

    @property
    def capacity(self) -> int | None:
        """The most rectangles that a scene may have; None where the scene is fixed, which may have lost some."""
        return None if self.fixed else self.rectangles

    @cached_property
    def screen_geometry(self) -> Screen:
        """The screen of this name, these rows and this scale, and with so many pixels a clock."""
        screen = self.facts.screens[self.screen, self.rows].scaled(self.scale)
        return screen if self.pixels == 1 else screen.paired()

    @property
    def has_long_wires(self) -> bool:
        """Two lanes spread over a chip, and above `SLOW_HZ` a wire across it leaves no time for logic on its way."""
        return self.pixels > 1 and self.screen_geometry.clock_hz > SLOW_HZ

    @property
    def groups(self) -> int:
        """Groups of `units` columns that make a row; the seed's Max."""
        return self.screen_geometry.columns // self.units

    @property
    def quotient_bits(self) -> int:
        """Bits of a quotient, and steps of the divider at one bit a cycle."""
        return COORDINATE_BITS + self.fraction_bits

    @property
    def divider_steps(self) -> int:
        """Cycles of one division; only of engines that divide."""
        return -(-self.quotient_bits // self.divider_bits)

    @property
    def slot_cycles(self) -> int:
        """Cycles from one rectangle to the next; the beam engine takes all at once."""
        return self._slot_cycles(self.divider_bits)

    def _slot_cycles(self, divider_bits: int) -> int:
        return -(-self.quotient_bits // divider_bits) if self.facts.divides else self.facts.slot_cycles

    @property
    def pass_latency(self) -> int:
        """Cycles from the end of a pass's last slot to the first cycle of the next pass."""
        return self.facts.result_latency + (self.facts.pattern_latency if self.patterns else 0)

    def _group_cycles(self, divider_bits: int) -> int:
        if not self.facts.line_buffered:
            return 1
        slots = sum(mask.bit_count() for mask in self.passes) * self._slot_cycles(divider_bits)
        return slots + len(self.passes) * self.pass_latency + GROUP_OVERHEAD

    @property
    def group_cycles(self) -> int:
        """Cycles from one group's start to the next one's with all rectangles enabled: the worst case."""
        return self._group_cycles(self.divider_bits)

    @property
    def group_budget(self) -> int:
        """Cycles that a group may take for a row to be ready before the row above it was shown."""
        return self._group_budget(self.units)

    def _group_budget(self, units: int) -> int:
        return (self.screen_geometry.row_cycles - 1) // (self.screen_geometry.columns // units)

    @property
    def name(self) -> str:
        """A short file name that differs wherever the generated hardware does."""
        rounding = "n" if self.rounding == "nearest" else "t"
        quotients = f"-f{self.fraction_bits}{rounding}-d{self.divider_bits}" if self.facts.divides else ""
        scale = f"-s{self.scale}" if not self.facts.line_buffered else ""
        fixed = f"-{self.fixed.name}" if self.fixed else ""
        # Only what is not the default is told.
        culling = "" if self.fixed or self.culling == self.facts.divides else f"-k{int(self.culling)}"
        looks = "".join(f"-{name}" for name in self.looks)
        bus = "" if self.bus == "avalon" else f"-{self.bus}"
        return (
            f"{self.engine}-{self.screen}{self.rows}{scale}-u{self.units}-r{self.rectangles}-m{self.reflections}"
            f"{quotients}-c{self.colour_bits}{culling}{looks}{bus}{fixed}"
        )


def need_avalon(config: Configuration, what: str) -> None:
    """Refuse another bus where what drives the registers is part of the design.

    Raises:
        ConfigurationError: one line that says of what.
    """
    if config.bus != "avalon":
        raise ConfigurationError(f"bus: {what} drives the registers itself, by Avalon-MM; leave out {config.bus}")


OPTION_NAMES = tuple(field.name for field in fields(Configuration) if field.name != "fixed")
"""Of the fields that people choose one by one; what is fixed comes from a scene."""


def configure(**values: Any) -> Configuration:
    """Make a configuration from options, numbers or their texts.

    Raises:
        ConfigurationError: one line that names the option, what was given and what was expected.
    """
    try:
        return Configuration(**values)
    except ValidationError as error:
        first = error.errors()[0]
        message = first["msg"].removeprefix("Value error, ")
        if first["loc"]:
            message = f"{first['loc'][0]}: {message}, not {first['input']!r}"
        raise ConfigurationError(message) from None
