# SPDX-License-Identifier: MIT
"""Configuration of a design as plain data: the options that a user chooses, everything decided from them, and the facts
about its engine."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import BeforeValidator, ConfigDict, Field
from pydantic.dataclasses import dataclass as validated_dataclass
from pydantic_core import PydanticKnownError

from raycaster.buses import BUSES, OWN, USUAL_BAUD
from raycaster.errors import UserError, listed
from raycaster.fixed import FixedScene
from raycaster.screens import COORDINATE_BITS, Screen

WORLD_SIZE = 1 << COORDINATE_BITS
MOST_RECTANGLES = 128
"""Number of entries in the largest rectangle table of any engine."""

MOST_REFLECTIONS = 4
"""Largest number of reflections per ray."""

MOST_RUNS = 1 << 20
"""Largest capacity of a frame list."""

CHANNEL_BITS = 8
"""Bits per colour channel inside the hardware, before the video output."""


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
    BusName = str
else:
    BusName = Literal[*BUSES]

FEATURES = {
    "turn": "a camera that turns",
    "materials": "rectangles that mirror more or less than half",
    "patterns": "rectangles with patterns",
    "light": "a light",
}
"""Options for optional features of scenes, each with its purpose."""

Rounding = Literal["truncate", "nearest"]
"""Rounding of quotients: toward zero, or to nearest."""


class ConfigurationError(UserError):
    """A configuration that cannot be built; its text is one line that says what is wrong, where, and what to do."""


@dataclass(frozen=True, kw_only=True)
class Facts:
    """Facts about an engine, the hardware that computes the rays.

    Attributes:
        name: name for users.
        code: value of the register `engine`.
        colour: colour of its marks and lines in plots, from the palette of Okabe and Ito.
        marker: Matplotlib's name for the marker of its points in plots.
        usual_build: usual time to convert its default design and to build it with Verilator on two cores, estimated
            from processor time.
        screens: screens that it can fill, by name and rows.
        rectangles: entries of its largest rectangle table; the default is what every engine holds.
        margin: distance by which a primary ray that hits a rectangle may pass outside its bounds, in world units.
        lacks: options of `FEATURES` that it refuses, each with the reason.
        divides: True if it forms quotients, which have fraction bits and are rounded.
        whole_frames: True if units draw whole frames into lists of runs, of which one is shown; the others fill a line
            buffer ahead of the monitor, group by group.
    """

    name: str
    code: int
    colour: str
    marker: str
    usual_build: str
    screens: Mapping[tuple[str, int], Screen]
    rectangles: int = 32
    margin: int = 0
    lacks: Mapping[str, str] = field(default_factory=dict)
    divides: bool = False
    whole_frames: bool = False

    @property
    def features(self) -> tuple[str, ...]:
        """Options of `FEATURES` that a design can have."""
        return tuple(name for name in FEATURES if name not in self.lacks)


@validated_dataclass(frozen=True, kw_only=True, config=ConfigDict(extra="forbid"))
class Options:
    """Options that a user chooses for a design. `configure` decides those that are None or "auto".

    Raises pydantic's `ValidationError`.
    """

    engine: str = Field(description="engine that computes the rays")
    units: Whole | None = Field(
        None,
        ge=1,
        description="parallel ray units, a divisor of the columns except with span; by default 32 (seed), the fewest "
        "that meet the row budget (exact) or one (span)",
    )
    rectangles: Whole = Field(
        12,
        ge=1,
        le=MOST_RECTANGLES,
        description=f"capacity of the scene memory, in rectangles: up to {Facts.rectangles}, or {MOST_RECTANGLES} "
        "(span)",
    )
    reflections: Whole = Field(
        1,
        ge=0,
        le=MOST_REFLECTIONS,
        description="most reflections per ray; if not given, the scene's number or, without a scene, the default",
    )
    rows: Whole | None = Field(
        None,
        description="rows of rays: 240 (640x480@60), 200 (640x400@70); seed and exact: 120, 96 or 60 (640x480@60 at "
        "half the clock); span: 180 (1280x720@60, or 1920x1080 at scale 3 or 6)",
    )
    scale: Whole | None = Field(
        None,
        description="resolution scale: 1; span: 1, 2 or 4, by default one ray per monitor pixel; "
        "with 180 rows also 3 or 6 (1920x1080)",
    )
    pixels: Whole = Field(
        1, ge=1, le=2, description="pixels per clock: 1, or 2 (span, with a ray for each pixel of a line)"
    )
    fraction_bits: Whole = Field(0, ge=0, le=8, description="fraction bits of origins, planes and quotients")
    rounding: Rounding = Field("truncate", description="rounding of quotients: truncate or nearest")
    divider_bits: Whole | Literal["auto"] = Field("auto", description="quotient bits per cycle: auto, 1, 2 or 3")
    list: Whole | None = Field(
        None,
        ge=0,
        le=MOST_RUNS,
        multiple_of=2,
        description="capacity of each of the two frame lists, in runs of one colour (span); by default 120 per row, or "
        "a run per column if that is less",
    )
    colour_bits: Whole = Field(8, ge=1, le=CHANNEL_BITS, description="bits per colour channel on the VGA output")
    screen: Literal["vga", "tiny", "play"] = Field(
        "vga",
        description="screen: vga (on boards without a PLL, 640x480 has 25 MHz, 0.7 per cent below the standard), tiny "
        "(64x48, for slow simulators) or play (320x240 with short frames, span only)",
    )
    allow_underrun: bool = Field(False, description="accept a design that cannot meet the row budget")
    culling: bool | None = Field(
        None,
        description="abandon early the rectangles that no ray of a group can hit, 1 or 0; by default 1 for the seed "
        "engine without a fixed scene",
    )
    turn: bool | None = Field(
        None, description="camera that can turn, 1 or 0 (not seed); by default 1 if the scene's camera is turned"
    )
    materials: bool | None = Field(
        None, description="rectangles that mirror more or less than half, 1 or 0; by default 1 if the scene has any"
    )
    patterns: bool | None = Field(
        None, description="rectangles with a two-colour pattern, 1 or 0; by default 1 if the scene has any"
    )
    light: bool | None = Field(
        None, description="point light with exact shadows, 1 or 0 (exact and span); by default 1 if the scene has one"
    )
    bus: BusName = Field(OWN, description=f"bus of the registers: {listed(BUSES)}")
    baud: Whole = Field(USUAL_BAUD, ge=300, description="bits per second of the bus uart")
    fixed: FixedScene | None = Field(None, description="scene that is built into the hardware")


@dataclass(frozen=True, kw_only=True)
class Configuration(Options):
    """Everything that distinguishes one generated design from another, with nothing left open; made by `configure`.

    The attributes that `Options` has, too, are described there.

    Attributes:
        units: number of parallel ray units.
        list: runs that each of the two lists of frames holds; 0 if the engine has no lists.
        divider_bits: quotient bits per cycle; 0 if the engine does not divide, nor are there fraction bits then.
        culling: True if units abandon early the rectangles that no ray of a group can hit. This saves cycles in most
            groups but none in the worst case, so the row budget ignores it.
        facts: facts about the engine.
    """

    units: int
    rows: int
    scale: int
    list: int
    divider_bits: int
    culling: bool
    turn: bool
    materials: bool
    patterns: bool
    light: bool
    facts: Facts = field(compare=False, repr=False)

    @property
    def features(self) -> tuple[str, ...]:
        """Options of `FEATURES` that the design has."""
        return tuple(name for name in FEATURES if getattr(self, name))

    @property
    def table(self) -> int:
        """Number of entries in the rectangle table that software writes; 0 if the rectangles are fixed."""
        return 0 if self.fixed else self.rectangles

    @property
    def map(self) -> tuple[int, bool]:
        """What decides the register map: the entries of the rectangle table, and True with lists of frames."""
        return self.table, self.facts.whole_frames

    @property
    def varied(self) -> bool:
        """True if a surface has more than one colour, by patterns or a light."""
        return self.patterns or self.light

    @property
    def follows_fate(self) -> bool:
        """True if units report which rays may still be reflected, for culling or materials."""
        return self.culling or self.materials

    @property
    def most_reflections(self) -> int:
        """Most reflections per ray; a scene may ask for fewer."""
        return self.reflections

    @property
    def passes(self) -> tuple[int, ...]:
        """Masks of the rectangles that are tested, for the primary ray and each reflection."""
        return self.fixed.passes if self.fixed else (self.most_reflections + 1) * ((1 << self.rectangles) - 1,)

    @property
    def shadows(self) -> tuple[int, ...]:
        """Masks of the rectangles that are tested from the light, for each pass; empty without a light."""
        if not self.light:
            return ()
        return self.fixed.shadows if self.fixed else self.passes

    @property
    def port_bits(self) -> int:
        """Bits per colour of the VGA output: a channel of each pixel of a clock."""
        return self.colour_bits * self.pixels

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
    def group_budget(self) -> int:
        """Most cycles per group at which a row is ready before the row above it has been shown."""
        return (self.screen_geometry.row_cycles - 1) // self.groups

    @property
    def name(self) -> str:
        """Short file name, different for designs whose hardware differs."""
        rounding = "n" if self.rounding == "nearest" else "t"
        quotients = f"-f{self.fraction_bits}{rounding}-d{self.divider_bits}" if self.facts.divides else ""
        scale = f"-s{self.scale}" if self.facts.whole_frames else ""
        pairs = "-pairs" if self.pixels > 1 else ""
        entries = f"{pairs}-l{self.list}" if self.list else ""
        fixed = f"-{self.fixed.name}" if self.fixed else ""
        # Defaults are left out of the name.
        culling = "" if self.fixed or self.culling == self.facts.divides else f"-k{int(self.culling)}"
        features = "".join(f"-{name}" for name in self.features)
        bus = "" if self.bus == OWN else f"-{self.bus}" if self.baud == USUAL_BAUD else f"-{self.bus}{self.baud}"
        return (
            f"{self.engine}-{self.screen}{self.rows}{scale}-u{self.units}-r{self.rectangles}-m{self.most_reflections}"
            f"{quotients}{entries}-c{self.colour_bits}{culling}{features}{bus}{fixed}"
        )


def need_avalon(config: Configuration, what: str) -> None:
    """Refuse any bus except Avalon-MM for a design that contains the host of its registers.

    Raises:
        ConfigurationError: the design has another bus.
    """
    if config.bus != OWN:
        raise ConfigurationError(f"bus: {what} drives the registers itself, by Avalon-MM; leave out {config.bus}")
