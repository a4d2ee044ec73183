# SPDX-License-Identifier: MIT
"""Configuration of a design: the options that a user chooses, and everything decided from them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import BeforeValidator, ConfigDict, Field, ValidationError
from pydantic.dataclasses import dataclass as validated_dataclass
from pydantic.fields import FieldInfo
from pydantic_core import PydanticKnownError

from raycaster.buses import BUSES, OWN
from raycaster.complaints import as_typed, refusal
from raycaster.engines import ENGINES, SEED, Engine
from raycaster.engines.engine import LOOK_NAMES, LOOKS
from raycaster.errors import UserError, listed
from raycaster.fixed import FixedScene
from raycaster.screens import COORDINATE_BITS, Screen

WORLD_SIZE = 1 << COORDINATE_BITS
MOST_RECTANGLES = 32
"""Number of entries in the largest rectangle table."""

MOST_REFLECTIONS = 4
"""Largest number of reflections per ray."""

CHANNEL_BITS = 8
"""Bits per colour channel inside the hardware, before the video output."""

SLOW_HZ = 50_000_000
"""Clock frequency that designs meet on the boards' chips without registers on long wires."""


def _whole(value: object) -> object:
    """Return a value unless it has a decimal point, as pydantic takes 12.0 for 12; scene files refuse it, too."""
    if isinstance(value, float) or (isinstance(value, str) and "." in value):
        raise PydanticKnownError("int_type")
    return value


if TYPE_CHECKING:
    Whole = int
else:
    Whole = Annotated[int, BeforeValidator(_whole)]

if TYPE_CHECKING:
    EngineName = BusName = str
else:
    EngineName, BusName = Literal[*ENGINES], Literal[*BUSES]


Rounding = Literal["truncate", "nearest"]
"""Rounding of quotients: toward zero, or to nearest."""


class ConfigurationError(UserError):
    """A configuration that cannot be built; its text is one line that says what is wrong, where, and what to do."""


@validated_dataclass(frozen=True, kw_only=True, config=ConfigDict(extra="forbid"))
class Options:
    """Options that a user chooses for a design. `configure` decides those that are None or "auto".

    Raises pydantic's `ValidationError`.
    """

    engine: EngineName = Field(
        SEED.name,
        description=f"engine that computes the rays: {listed(ENGINES)}; by default exact for a scene that needs it",
    )
    units: Whole | None = Field(
        None,
        ge=1,
        description="parallel ray units, a divisor of the columns; by default 32 (seed), the fewest that meet the row "
        "budget (exact) or one per pixel of a clock (beam)",
    )
    rectangles: Whole = Field(12, ge=1, le=MOST_RECTANGLES, description="capacity of the scene memory, in rectangles")
    reflections: Whole = Field(
        1,
        ge=0,
        le=MOST_REFLECTIONS,
        description="most reflections per ray; if not given, the scene's number or, without a scene, the default",
    )
    rows: Whole | None = Field(
        None,
        description="rows of rays: 240 (640x480@60), 200 (640x400@70); seed and exact: 120, 96 or 60 (640x480@60 at "
        "half the clock); beam: 180 (1280x720@60, or 1920x1080 at scale 3 or 6)",
    )
    scale: Whole | None = Field(
        None,
        description="resolution scale: 1; beam: 1, 2 or 4, by default one ray per monitor pixel; "
        "with 180 rows also 3 or 6 (1920x1080)",
    )
    pixels: Whole = Field(1, ge=1, le=2, description="pixels per clock: 1, or 2 (beam, if each has its own column)")
    fraction_bits: Whole = Field(0, ge=0, le=8, description="fraction bits of origins, planes and quotients")
    rounding: Rounding = Field("truncate", description="rounding of quotients: truncate or nearest")
    divider_bits: Whole | Literal["auto"] = Field("auto", description="quotient bits per cycle: auto, 1, 2 or 3")
    colour_bits: Whole = Field(8, ge=1, le=CHANNEL_BITS, description="bits per colour channel on the VGA output")
    screen: Literal["vga", "tiny", "play"] = Field(
        "vga",
        description="screen: vga (on boards without a PLL, 640x480 has 25 MHz, 0.7 per cent below the standard), tiny "
        "(64x48, for slow simulators) or play (320x240 with short frames, beam only)",
    )
    allow_underrun: bool = Field(False, description="accept a design that cannot meet the row budget")
    culling: bool | None = Field(
        None,
        description="abandon early the rectangles that no ray of a group can hit, 1 or 0; by default 1 for the seed "
        "engine without a fixed scene",
    )
    turn: bool | None = Field(
        None, description="camera that can turn, 1 or 0 (exact and beam); by default 1 if the scene's camera is turned"
    )
    materials: bool | None = Field(
        None, description="rectangles that mirror more or less than half, 1 or 0; by default 1 if the scene has any"
    )
    patterns: bool | None = Field(
        None, description="rectangles with a two-colour pattern, 1 or 0; by default 1 if the scene has any"
    )
    light: bool | None = Field(
        None, description="point light with exact shadows, 1 or 0 (exact); by default 1 if the scene has one"
    )
    bus: BusName = Field(OWN, description=f"bus of the registers: {listed(BUSES)}")
    fixed: FixedScene | None = Field(None, description="scene that is built into the hardware")


@dataclass(frozen=True, kw_only=True)
class Configuration:
    """Everything that distinguishes one generated design from another, with nothing left open; made by `configure`.

    Attributes:
        engine: name of the engine.
        units: number of parallel ray units; with the beam engine, one per pixel of a clock.
        rectangles: number of rectangles in the hardware.
        reflections: most reflections per ray.
        rows: rows of rays, at scale 1.
        scale: resolution of the picture in both directions, relative to `rows`.
        pixels: pixels per clock.
        fraction_bits: fraction bits of origins, planes and quotients; 0 if the engine does not divide.
        rounding: rounding of quotients.
        divider_bits: quotient bits per cycle; 0 if the engine does not divide.
        colour_bits: bits per colour channel on the VGA output.
        screen: name of the screen.
        allow_underrun: True if the design may miss the row budget.
        culling: True if units abandon early the rectangles that no ray of a group can hit. This saves cycles in most
            groups but none in the worst case, so the row budget ignores it.
        turn: True if the camera can turn.
        materials: True if rectangles can mirror more or less than half.
        patterns: True if rectangles can have patterns.
        light: True if there is a point light that casts shadows.
        bus: name of the bus.
        fixed: scene that is built in, or None.
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
        """The engine that `engine` names."""
        return ENGINES[self.engine]

    @property
    def looks(self) -> tuple[str, ...]:
        """Options of `LOOKS` that the design has."""
        return tuple(name for name in LOOKS if getattr(self, name))

    @property
    def table(self) -> int:
        """Number of entries in the rectangle table that software writes; 0 if the rectangles are fixed."""
        return 0 if self.fixed else self.rectangles

    @property
    def passes(self) -> tuple[int, ...]:
        """Masks of the rectangles that are tested, for the primary ray and each reflection."""
        return self.fixed.passes if self.fixed else (self.reflections + 1) * ((1 << self.rectangles) - 1,)

    @property
    def shadows(self) -> tuple[int, ...]:
        """Masks of the rectangles that are tested from the light, for each pass; empty without a light."""
        if not self.light:
            return ()
        return self.fixed.shadows if self.fixed else self.passes

    @property
    def capacity(self) -> int | None:
        """Most rectangles that a scene may have; None for a fixed scene, some of whose rectangles may be left out."""
        return None if self.fixed else self.rectangles

    @cached_property
    def whole_screen(self) -> Screen:
        """The screen with this name, number of rows and scale, counted in single pixels."""
        return self.facts.screens[self.screen, self.rows].scaled(self.scale)

    @cached_property
    def screen_geometry(self) -> Screen:
        """The screen as the hardware counts it, in steps of `pixels` pixels."""
        return self.whole_screen if self.pixels == 1 else self.whole_screen.paired()

    @property
    def has_long_wires(self) -> bool:
        """True if long wires leave no time for logic: two lanes, spread over the chip, and a clock above `SLOW_HZ`."""
        return self.pixels > 1 and self.screen_geometry.clock_hz > SLOW_HZ

    @property
    def groups(self) -> int:
        """Number of groups of `units` columns per row; `Max` in the seed."""
        return self.screen_geometry.columns // self.units

    @property
    def quotient_bits(self) -> int:
        """Bits of a quotient, and steps of the divider at one bit per cycle."""
        return COORDINATE_BITS + self.fraction_bits

    @property
    def divider_steps(self) -> int:
        """Cycles per division; only for engines that divide."""
        return -(-self.quotient_bits // self.divider_bits)

    @property
    def rect_cycles(self) -> int:
        """Cycles from one rectangle to the next; 0 for the beam engine, which tests all at once."""
        return self.facts.rect_cycles(self)

    @property
    def pass_latency(self) -> int:
        """Cycles from the end of a pass's last rectangle to the first cycle of the next pass."""
        return self.facts.pass_latency(self)

    @property
    def group_cycles(self) -> int:
        """Cycles per group in the worst case, with all rectangles enabled."""
        return self.facts.group_cycles(self)

    @property
    def group_budget(self) -> int:
        """Most cycles per group at which a row is ready before the row above it has been shown."""
        return (self.screen_geometry.row_cycles - 1) // self.groups

    @property
    def name(self) -> str:
        """Short file name, different for designs whose hardware differs."""
        rounding = "n" if self.rounding == "nearest" else "t"
        quotients = f"-f{self.fraction_bits}{rounding}-d{self.divider_bits}" if self.facts.divides else ""
        scale = f"-s{self.scale}" if not self.facts.line_buffered else ""
        fixed = f"-{self.fixed.name}" if self.fixed else ""
        # Defaults are left out of the name.
        culling = "" if self.fixed or self.culling == self.facts.divides else f"-k{int(self.culling)}"
        looks = "".join(f"-{name}" for name in self.looks)
        bus = "" if self.bus == OWN else f"-{self.bus}"
        return (
            f"{self.engine}-{self.screen}{self.rows}{scale}-u{self.units}-r{self.rectangles}-m{self.reflections}"
            f"{quotients}-c{self.colour_bits}{culling}{looks}{bus}{fixed}"
        )


def need_avalon(config: Configuration, what: str) -> None:
    """Refuse any bus except Avalon-MM for a design that contains the host of its registers.

    Raises:
        ConfigurationError: the design has another bus.
    """
    if config.bus != OWN:
        raise ConfigurationError(f"bus: {what} drives the registers itself, by Avalon-MM; leave out {config.bus}")


OPTIONS: Mapping[str, FieldInfo] = {
    name: field for name, field in vars(Options)["__pydantic_fields__"].items() if name != "fixed"
}
"""All options by name, with bounds, default and help, except `fixed`, which comes from a scene."""


def decided(options: Options) -> Configuration:
    """Decide everything that the user left open.

    Raises:
        ValueError: no such design is possible; the text is `option: why, and what to do instead`.
    """
    engine, fixed = ENGINES[options.engine], options.fixed
    if fixed is not None and len(fixed.passes) != options.reflections + 1:
        raise ValueError(f"fixed: is for {len(fixed.passes) - 1} reflections, not {options.reflections}")
    rows = _rows(options, engine)
    scale = _scale(options, engine, rows)
    for look, reason in engine.lacks.items():
        if getattr(options, look):
            raise ValueError(f"{look}: {reason}; {_instead(options)}")
    if options.pixels > 1 and engine.line_buffered:
        raise ValueError(f"pixels: the {engine.name} engine has 1 per clock, not {options.pixels}; {_instead(options)}")
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


def _lacking(engine: Engine, options: Options) -> Iterator[str]:
    """Yield the wanted features and the screen, in words, that an engine does not have."""
    yield from (name for look, name in LOOK_NAMES.items() if getattr(options, look) and look in engine.lacks)
    if options.pixels > 1 and engine.line_buffered:
        yield f"{options.pixels} pixels per clock"
    screens = [screen for place, screen in engine.screens.items() if _matches(place, options)]
    if not screens:
        yield f"the {options.screen} screen" if options.rows is None else f"{options.rows} rows of {options.screen}"
    elif options.scale is not None and all(options.scale not in engine.scales(screen) for screen in screens):
        yield f"scale {options.scale}"


def _matches(place: tuple[str, int], options: Options) -> bool:
    return place[0] == options.screen and options.rows in (None, place[1])


def _instead(options: Options) -> str:
    """Return the engines with all that is wanted or, if there are none, what each of them lacks."""
    lacking = {name: list(_lacking(engine, options)) for name, engine in ENGINES.items()}
    able = [as_typed("engine", name) for name, lacks in lacking.items() if not lacks]
    if able:
        return f"choose {' or '.join(able)}"
    lacks = ", ".join(f"{name} lacks {' and '.join(lacks)}" for name, lacks in lacking.items())
    return f"no engine has all of it: {lacks}; leave something out"


def _rows(options: Options, engine: Engine) -> int:
    allowed = [rows for screen, rows in engine.screens if screen == options.screen]
    if not allowed:
        raise ValueError(f"screen: the {engine.name} engine does not have {options.screen}; {_instead(options)}")
    if options.rows is None:
        return allowed[0]
    if options.rows not in allowed:
        choices = ", ".join(map(str, allowed))
        known = any(_matches(place, options) for other in ENGINES.values() for place in other.screens)
        hint = f"; {_instead(options)}" if known else ""
        raise ValueError(f"rows: {engine.name} has {choices} rows on screen {options.screen}, not {options.rows}{hint}")
    return options.rows


def _scale(options: Options, engine: Engine, rows: int) -> int:
    allowed = engine.scales(engine.screens[options.screen, rows])
    if options.scale is None:
        return allowed[0]
    if options.scale not in allowed:
        scales = " or ".join(map(str, sorted(allowed)))
        others = (other for other in ENGINES.values() if (options.screen, rows) in other.screens)
        known = any(options.scale in other.scales(other.screens[options.screen, rows]) for other in others)
        hint = f"; {_instead(options)}" if known else ""
        raise ValueError(f"scale: the {engine.name} engine shows {rows} rows at {scales}, not {options.scale}{hint}")
    return options.scale


def configure(**values: Any) -> Configuration:
    """Make a configuration from options, given as values or as text.

    Raises:
        ConfigurationError: one line that names the option, what was given and what was expected.
    """
    try:
        return decided(Options(**values))
    except ValidationError as error:
        raise ConfigurationError(refusal(error.errors(), depth=1)) from None
    except ValueError as error:
        raise ConfigurationError(str(error)) from None
