# SPDX-License-Identifier: MIT
"""Decide a design: from the options that a user chooses to a configuration with nothing left open."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import BeforeValidator, ConfigDict, Field, ValidationError
from pydantic.dataclasses import dataclass as validated_dataclass
from pydantic.fields import FieldInfo

from raycaster.buses import BUSES, RATE_ERROR, USUAL_BAUD, most_baud
from raycaster.complaints import as_typed, refusal
from raycaster.configuration import FEATURES, Configuration, ConfigurationError, Options
from raycaster.errors import listed
from raycaster.rtl.engine.engine import Engine
from raycaster.rtl.engines import ENGINES, SUCCESSORS


def _present(name: object) -> object:
    """Return an engine's name unless that engine is gone."""
    if name in SUCCESSORS:
        raise ValueError(
            f"{name} is gone; choose {as_typed('engine', SUCCESSORS[name])}, which draws the same pictures"
        )
    return name


if TYPE_CHECKING:
    EngineName = str
else:
    EngineName = Annotated[Literal[*ENGINES], BeforeValidator(_present)]


@validated_dataclass(frozen=True, kw_only=True, config=ConfigDict(extra="forbid"))
class Choice(Options):
    """Options with the name of an engine that exists."""

    engine: EngineName = Field(
        next(iter(ENGINES)),
        description=f"engine that computes the rays: {listed(ENGINES)}; by default the first that draws the scene",
    )


OPTIONS: Mapping[str, FieldInfo] = {
    name: field for name, field in vars(Choice)["__pydantic_fields__"].items() if name != "fixed"
}
"""All options by name, with bounds, default and help, except `fixed`, which comes from a scene."""


def decided(options: Options) -> Configuration:
    """Decide everything that the user left open.

    Raises:
        ConfigurationError: no such design is possible; the text is `option: why, and what to do instead`.
    """
    engine, fixed = ENGINES[options.engine], options.fixed
    if fixed is not None and len(fixed.passes) != options.reflections + 1:
        raise ConfigurationError(f"fixed: is for {len(fixed.passes) - 1} reflections, not {options.reflections}")
    rows = _rows(options, engine)
    scale = _scale(options, engine, rows)
    for _, complaint in _lacking(engine, options):
        raise ConfigurationError(f"{complaint}; {_instead(options)}")
    engine.refuse(options)
    # Culling shortens the long slots of a division; a fixed scene leaves out more.
    culls = engine.facts.divides and fixed is None
    decisions = {
        "units": options.units or 1,
        "rectangles": len(fixed.rectangles) if fixed else options.rectangles,
        "rows": rows,
        "scale": scale,
        "list": 0,
        "divider_bits": 0,
        "culling": culls if options.culling is None else options.culling,
        **{feature: bool(getattr(options, feature)) for feature in FEATURES},
        "facts": engine.facts,
    }
    config = Configuration(**{**vars(options), **decisions})
    _check_baud(config)
    columns = config.screen_geometry.columns
    if columns % config.units and not engine.facts.whole_frames:
        divisors = ", ".join(str(n) for n in range(1, columns + 1) if columns % n == 0)
        raise ConfigurationError(
            f"units: {config.units} does not divide the {columns} columns; choose one of {divisors}"
        )
    config = engine.sized(config, options)
    engine.check(config)
    return config


def _lacking(engine: Engine, options: Options) -> Iterator[tuple[str, str]]:
    """Yield what is wanted and an engine does not have, except the screen: in a few words, and as a complaint."""
    facts, pixels, rectangles = engine.facts, options.pixels, options.rectangles
    for feature, reason in facts.lacks.items():
        if getattr(options, feature):
            yield FEATURES[feature], f"{feature}: {reason}"
    if pixels > 1 and not facts.whole_frames:
        yield f"{pixels} pixels per clock", f"pixels: the {facts.name} engine has 1 per clock, not {pixels}"
    if rectangles > facts.rectangles:
        complaint = f"rectangles: the {facts.name} engine holds at most {facts.rectangles}, not {rectangles}"
        yield f"{rectangles} rectangles", complaint


def _lacking_screen(engine: Engine, options: Options) -> Iterator[str]:
    """Yield the wanted screen or scale, in words, if an engine does not have it."""
    screens = [screen for place, screen in engine.facts.screens.items() if _matches(place, options)]
    if not screens:
        yield f"the {options.screen} screen" if options.rows is None else f"{options.rows} rows of {options.screen}"
    elif options.scale is not None and all(options.scale not in engine.scales(screen) for screen in screens):
        yield f"scale {options.scale}"


def _matches(place: tuple[str, int], options: Options) -> bool:
    return place[0] == options.screen and options.rows in (None, place[1])


def _instead(options: Options) -> str:
    """Return the engines with all that is wanted or, if there are none, what each of them lacks."""
    lacking = {
        name: [*(words for words, _ in _lacking(engine, options)), *_lacking_screen(engine, options)]
        for name, engine in ENGINES.items()
    }
    able = [as_typed("engine", name) for name, lacks in lacking.items() if not lacks]
    if able:
        return f"choose {' or '.join(able)}"
    lacks = ", ".join(f"{name} lacks {' and '.join(lacks)}" for name, lacks in lacking.items())
    return f"no engine has all of it: {lacks}; leave something out"


def _check_baud(config: Configuration) -> None:
    if not BUSES[config.bus].serial:
        if config.baud != USUAL_BAUD:
            raise ConfigurationError(
                f"baud: only a serial bus has a rate; choose {as_typed('bus', 'uart')}, or leave it out"
            )
        return
    clock_hz = config.screen_geometry.clock_hz
    if config.baud > most_baud(clock_hz):
        raise ConfigurationError(
            f"baud: the design's clock of {clock_hz / 1e6:g} MHz makes at most {most_baud(clock_hz)} within "
            f"{RATE_ERROR:.1%}, not {config.baud}"
        )


def _rows(options: Options, engine: Engine) -> int:
    allowed = [rows for screen, rows in engine.facts.screens if screen == options.screen]
    if not allowed:
        raise ConfigurationError(
            f"screen: the {options.engine} engine does not have {options.screen}; {_instead(options)}"
        )
    if options.rows is None:
        return allowed[0]
    if options.rows not in allowed:
        choices = ", ".join(map(str, allowed))
        known = any(_matches(place, options) for other in ENGINES.values() for place in other.facts.screens)
        hint = f"; {_instead(options)}" if known else ""
        raise ConfigurationError(
            f"rows: {options.engine} has {choices} rows on screen {options.screen}, not {options.rows}{hint}"
        )
    return options.rows


def _scale(options: Options, engine: Engine, rows: int) -> int:
    allowed = engine.scales(engine.facts.screens[options.screen, rows])
    if options.scale is None:
        return allowed[0]
    if options.scale not in allowed:
        scales = " or ".join(map(str, sorted(allowed)))
        others = (other for other in ENGINES.values() if (options.screen, rows) in other.facts.screens)
        known = any(options.scale in other.scales(other.facts.screens[options.screen, rows]) for other in others)
        hint = f"; {_instead(options)}" if known else ""
        raise ConfigurationError(
            f"scale: the {options.engine} engine shows {rows} rows at {scales}, not {options.scale}{hint}"
        )
    return options.scale


def configure(**values: Any) -> Configuration:
    """Make a configuration from options, given as values or as text.

    Raises:
        ConfigurationError: one line that names the option, what was given and what was expected.
    """
    try:
        options = Choice(**values)
    except ValidationError as error:
        raise ConfigurationError(refusal(error.errors(), depth=1)) from None
    return decided(options)
