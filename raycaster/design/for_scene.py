# SPDX-License-Identifier: MIT
"""A scene with the hardware that shows it, chosen from the scene file and the options."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from raycaster.complaints import as_typed
from raycaster.configuration import FEATURES, MOST_RECTANGLES, Configuration, ConfigurationError
from raycaster.design.decide import OPTIONS, configure
from raycaster.errors import UserError
from raycaster.rtl.engines import ENGINES
from raycaster.scene import Scene, load_scene, packaged_scenes


@dataclass(frozen=True)
class Design:
    """A scene file, the hardware for it, and the number of reflections to show."""

    path: Path
    scene: Scene
    configuration: Configuration
    reflections: int

    @property
    def name(self) -> str:
        """Name of the scene file, without its suffix."""
        return self.path.stem

    @property
    def shown(self) -> Scene:
        """The scene with the design's reflections instead of its own."""
        return self.scene.model_copy(update={"reflections": self.reflections})


@dataclass(frozen=True)
class ProcessorDesign:
    """Hardware with a processor, and the program that it runs."""

    path: Path
    """The program: 32-bit words in hexadecimal, one per line, from address 0 on."""

    configuration: Configuration


def packaged_for(options: Mapping[str, Any]) -> list[Path]:
    """List the packaged scenes that hardware with these options can show."""
    others = [name for names in left_out(options).values() for name in names]
    return [path for name, path in packaged_scenes().items() if name not in others]


def held_by(options: Mapping[str, Any]) -> int:
    """Return the number of rectangles that hardware with these options holds; the default if it is no number."""
    given = str(options.get("rectangles", ""))
    return int(given) if given.isascii() and given.isdecimal() and len(given) < 9 else OPTIONS["rectangles"].default


def left_out(options: Mapping[str, Any]) -> dict[str, list[str]]:
    """Return the names of the packaged scenes that hardware with these options cannot show, by the reason."""
    lacking = {name: f"needs {what}" for name, what in FEATURES.items() if str(options.get(name)) in ("0", "False")}
    if engine := ENGINES.get(str(options.get("engine"))):
        lacking |= {feature: f"needs {FEATURES[feature]}: {reason}" for feature, reason in engine.facts.lacks.items()}
    held, found = held_by(options), defaultdict(list)
    for name, path in packaged_scenes().items():
        scene = load_scene(path)
        reason = next((reason for feature, reason in lacking.items() if scene.needs[feature]), "")
        if not reason and len(scene.rect) > held:
            reason = f"has more than {held} rectangles"
        if reason:
            found[reason].append(name)
    return found


def design_for(path: Path, options: Mapping[str, Any], defaults: Mapping[str, Any] | None = None) -> Design:
    """Read a scene and choose its hardware; rows, reflections and features that are not given come from the scene.

    A scene with more rectangles than a default design has gets a design that holds them. If no engine is given, the
    first one that can show the scene and hold the rectangles is chosen.

    Args:
        path: the scene file.
        options: options of the configuration that were given.
        defaults: values for options that were not given, preferred to those of the scene and the configuration.

    Raises:
        UserError: the scene or the options are invalid; one line.
    """
    scene = load_scene(path)
    chosen = {**(defaults or {}), **options}
    if "rows" not in chosen and chosen.get("screen", "vga") == "vga":
        chosen["rows"] = scene.rows
    chosen.setdefault("reflections", scene.reflections)
    if OPTIONS["rectangles"].default < len(scene.rect) <= MOST_RECTANGLES:
        chosen.setdefault("rectangles", len(scene.rect))
    needed = scene.lacks(())
    able = [name for name, engine in ENGINES.items() if not scene.lacks(engine.facts.features)]
    large = [name for name in able if held_by(chosen) <= ENGINES[name].facts.rectangles]
    chosen.setdefault("engine", (large or able)[0])
    try:
        configuration = configure(**dict.fromkeys(needed, True) | chosen)
    except ConfigurationError as error:
        option, _, reason = str(error).partition(": ")
        if option in options or option not in (*needed, "rows"):
            raise
        if option == "turn":
            option = "camera." + next(name for name in ("yaw", "pitch", "roll") if getattr(scene.camera, name))
        raise ConfigurationError(f"{path}: {option}: {reason}") from None
    if lacking := scene.lacks(configuration.features):
        raise UserError(f"{path}: the scene needs {FEATURES[lacking[0]]}; leave out {as_typed(lacking[0])}")
    load_scene(path, configuration.rectangles)  # refuses more rectangles than the hardware holds
    # Use the hardware's number if it was given; a default design may compute more than the scene needs.
    reflections = configuration.most_reflections if "reflections" in options else scene.reflections
    return Design(path, scene, configuration, reflections)
