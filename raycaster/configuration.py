# SPDX-License-Identifier: MIT
"""The one home of what a design is: what a user chooses of it, and what is decided from that."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal

from pydantic import ConfigDict, Field, ValidationError
from pydantic.dataclasses import dataclass as validated_dataclass
from pydantic.fields import FieldInfo

from raycaster.buses import BUSES, OWN
from raycaster.complaints import refusal
from raycaster.engines import ENGINES, SEED, Engine
from raycaster.engines.engine import LOOKS
from raycaster.errors import UserError, listed
from raycaster.fixed import FixedScene
from raycaster.screens import COORDINATE_BITS, Screen

WORLD_SIZE = 1 << COORDINATE_BITS
MOST_RECTANGLES = 32
"""Entries that the largest rectangle table has."""

MOST_REFLECTIONS = 4
"""That a ray may have."""

CHANNEL_BITS = 8
"""Bits a colour channel has until it leaves for the monitor."""

SLOW_HZ = 50_000_000
"""A clock that designs meet on the chips of the boards without registers on long wires."""


if TYPE_CHECKING:
    EngineName = BusName = str
else:
    EngineName, BusName = Literal[*ENGINES], Literal[*BUSES]


Rounding = Literal["truncate", "nearest"]
"""How quotients are rounded: towards zero, or to the nearest."""


class ConfigurationError(UserError):
    """A configuration that cannot be built, with one line that says what, where and what to do."""


@validated_dataclass(frozen=True, kw_only=True, config=ConfigDict(extra="forbid"))
class Options:
    """The choices that a user makes for a design. `configure` decides what is None or "auto".

    Raises pydantic's `ValidationError`.
    """

    engine: EngineName = Field(SEED.name, description=f"what computes the rays: {listed(ENGINES)}")
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
    rounding: Rounding = Field("truncate", description="of quotients")
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
    light: bool | None = Field(
        None, description="a point light and exact shadows, 1 or 0 (exact): 1 where the scene has one"
    )
    bus: BusName = Field(OWN, description=f"what the registers are behind: {listed(BUSES)}")
    fixed: FixedScene | None = Field(None, description="what of a scene is built in")


@dataclass(frozen=True, kw_only=True)
class Configuration:
    """Everything that distinguishes one generated design from another, all of it decided. `configure` makes one.

    Attributes:
        engine: the name of what computes the rays.
        units: ray units in parallel; of the beam engine one for each pixel of a clock.
        rectangles: that the hardware holds; of a fixed scene those that it has.
        reflections: that a ray may have.
        rows: of rays.
        scale: how many times finer than `rows` the picture is, in both directions.
        pixels: a clock.
        fraction_bits: of origins, planes and quotients; 0 where the engine does not divide.
        rounding: of quotients.
        divider_bits: quotient bits a cycle; 0 where the engine does not divide.
        colour_bits: a channel, on the VGA output.
        screen: its name.
        allow_underrun: whether it may miss the row budget.
        culling: whether units give up early what no ray of a group can hit. It saves cycles in most groups and none in
            the worst case, so the row budget does not know of it.
        turn: whether the camera turns.
        materials: whether rectangles mirror more or less than half.
        patterns: whether rectangles have patterns.
        light: whether a point light casts shadows.
        bus: the name of the bus.
        fixed: what of a scene is built in.
    """

    engine: str
    units: int
    rectangles: int
    reflections: int
    rows: int
    scale: int
    pixels: int
    fraction_bits: int
    rounding: Rounding
    divider_bits: int
    colour_bits: int
    screen: str
    allow_underrun: bool
    culling: bool
    turn: bool
    materials: bool
    patterns: bool
    light: bool
    bus: str
    fixed: FixedScene | None = None

    @property
    def facts(self) -> Engine:
        """The engine of this name."""
        return ENGINES[self.engine]

    @property
    def looks(self) -> tuple[str, ...]:
        """Of `LOOKS` those that it has."""
        return tuple(name for name in LOOKS if getattr(self, name))

    @property
    def table(self) -> int:
        """Entries of the rectangle table that software writes: none where the rectangles are fixed."""
        return 0 if self.fixed else self.rectangles

    @property
    def passes(self) -> tuple[int, ...]:
        """For the primary ray and each reflection, which rectangles are tested, as a mask."""
        return self.fixed.passes if self.fixed else (self.reflections + 1) * ((1 << self.rectangles) - 1,)

    @property
    def shadows(self) -> tuple[int, ...]:
        """For each pass, the rectangles that are tested from the light, as a mask; empty without a light."""
        if not self.light:
            return ()
        return self.fixed.shadows if self.fixed else self.passes

    @property
    def capacity(self) -> int | None:
        """The most rectangles that a scene may have; None where the scene is fixed, which may have lost some."""
        return None if self.fixed else self.rectangles

    @cached_property
    def whole_screen(self) -> Screen:
        """The screen of this name, these rows and this scale, in single pixels."""
        return self.facts.screens[self.screen, self.rows].scaled(self.scale)

    @cached_property
    def screen_geometry(self) -> Screen:
        """The screen as the hardware counts it, in steps of `pixels` pixels."""
        return self.whole_screen if self.pixels == 1 else self.whole_screen.paired()

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
        return self.facts.slot_cycles(self)

    @property
    def pass_latency(self) -> int:
        """Cycles from the end of a pass's last slot to the first cycle of the next pass."""
        return self.facts.pass_latency(self)

    @property
    def group_cycles(self) -> int:
        """Cycles from one group's start to the next one's with all rectangles enabled: the worst case."""
        return self.facts.group_cycles(self)

    @property
    def group_budget(self) -> int:
        """Cycles that a group may take for a row to be ready before the row above it was shown."""
        return (self.screen_geometry.row_cycles - 1) // self.groups

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
        bus = "" if self.bus == OWN else f"-{self.bus}"
        return (
            f"{self.engine}-{self.screen}{self.rows}{scale}-u{self.units}-r{self.rectangles}-m{self.reflections}"
            f"{quotients}-c{self.colour_bits}{culling}{looks}{bus}{fixed}"
        )


def need_avalon(config: Configuration, what: str) -> None:
    """Refuse another bus where what drives the registers is part of the design.

    Raises:
        ConfigurationError: one line that says of what.
    """
    if config.bus != OWN:
        raise ConfigurationError(f"bus: {what} drives the registers itself, by Avalon-MM; leave out {config.bus}")


OPTIONS: Mapping[str, FieldInfo] = {
    name: field for name, field in vars(Options)["__pydantic_fields__"].items() if name != "fixed"
}
"""Every option by its name, with its bounds, default and help. `fixed` is not among them: it comes from a scene."""


def decided(options: Options) -> Configuration:
    """Decide what the user left open.

    Raises:
        ValueError: there is no such design; `option: why, and what to do instead`.
    """
    engine, fixed = ENGINES[options.engine], options.fixed
    if fixed is not None and len(fixed.passes) != options.reflections + 1:
        raise ValueError(f"fixed: is for {len(fixed.passes) - 1} reflections, not {options.reflections}")
    rows = _rows(options, engine)
    scale = _scale(options, engine, rows)
    for look, reason in engine.lacks.items():
        if getattr(options, look):
            others = " or ".join(f"ENGINE={other.name}" for other in ENGINES.values() if look not in other.lacks)
            raise ValueError(f"{look}: {reason}; choose {others}")
    engine.refuse(options)
    config = Configuration(
        engine=options.engine,
        units=options.units or 1,
        rectangles=len(fixed.rectangles) if fixed else options.rectangles,
        reflections=options.reflections,
        rows=rows,
        scale=scale,
        pixels=options.pixels,
        fraction_bits=options.fraction_bits,
        rounding=options.rounding,
        divider_bits=0,
        colour_bits=options.colour_bits,
        screen=options.screen,
        allow_underrun=options.allow_underrun,
        culling=engine.culls(options) if options.culling is None else options.culling,
        turn=bool(options.turn),
        materials=bool(options.materials),
        patterns=bool(options.patterns),
        light=bool(options.light),
        bus=options.bus,
        fixed=fixed,
    )
    columns = config.screen_geometry.columns
    if columns % config.units:
        divisors = ", ".join(str(n) for n in range(1, columns + 1) if columns % n == 0)
        raise ValueError(f"units: {config.units} does not divide the {columns} columns; choose one of {divisors}")
    config = engine.sized(config, options)
    engine.check(config)
    return config


def _rows(options: Options, engine: Engine) -> int:
    allowed = [rows for screen, rows in engine.screens if screen == options.screen]
    if not allowed:
        raise ValueError(f"screen: {options.screen} needs the beam engine, ENGINE=beam, not {engine.name}")
    if options.rows is None:
        return allowed[0]
    if options.rows not in allowed:
        choices = " or ".join(map(str, allowed))
        other = next((one for one in ENGINES.values() if (options.screen, options.rows) in one.screens), None)
        hint = f"; {options.rows} rows need the {other.name} engine, ENGINE={other.name}" if other else ""
        raise ValueError(f"rows: the {options.screen} screen has {choices} rows, not {options.rows}{hint}")
    return options.rows


def _scale(options: Options, engine: Engine, rows: int) -> int:
    allowed = engine.scales(engine.screens[options.screen, rows])
    if options.scale is None:
        return allowed[0]
    if options.scale not in allowed:
        scales = " or ".join(map(str, sorted(allowed)))
        hint = "; scales need the beam engine, ENGINE=beam" if engine.line_buffered else ""
        raise ValueError(f"scale: the {engine.name} engine shows {rows} rows at {scales}, not {options.scale}{hint}")
    return options.scale


def configure(**values: Any) -> Configuration:
    """Make a configuration from options, numbers or their texts.

    Raises:
        ConfigurationError: one line that names the option, what was given and what was expected.
    """
    try:
        return decided(Options(**values))
    except ValidationError as error:
        raise ConfigurationError(refusal(error.errors(), depth=1)) from None
    except ValueError as error:
        raise ConfigurationError(str(error)) from None
