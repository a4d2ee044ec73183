# SPDX-License-Identifier: MIT
"""A scene with the hardware that shows it, chosen from the scene file and the options."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from raycaster.configuration import Configuration, ConfigurationError, configure
from raycaster.engines import ENGINES, EXACT, SEED
from raycaster.errors import UserError
from raycaster.scene import Scene, load_scene, packaged_scenes

NEEDED_FOR = {
    "turn": "a camera that turns",
    "materials": "rectangles that mirror more or less than half",
    "patterns": "rectangles with patterns",
    "light": "a light",
}
"""Scene features, by the configuration option that they need."""


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
    lacking = {name for name in NEEDED_FOR if str(options.get(name)) in ("0", "False")}
    engine = ENGINES.get(str(options.get("engine")))
    lacking.update(engine.lacks if engine else ())
    return [
        path
        for path in packaged_scenes().values()
        if not any(needed and name in lacking for name, needed in load_scene(path).needs.items())
    ]


def design_for(path: Path, options: Mapping[str, Any], defaults: Mapping[str, Any] | None = None) -> Design:
    """Read a scene and choose its hardware; rows, reflections and looks that are not given come from the scene.

    If no engine is given and the default one cannot show the scene, the exact engine is chosen.

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
        engine = ENGINES.get(chosen.get("engine", SEED.name))
        if engine and ("vga", scene.rows) not in engine.screens:
            raise UserError(f"{path}: rows: 180 rows need the beam engine; give ENGINE=beam, or ROWS=240 or 200")
        chosen["rows"] = scene.rows
    chosen.setdefault("reflections", scene.reflections)
    needed = scene.lacks(())
    if scene.lacks(SEED.looks):
        chosen.setdefault("engine", EXACT.name)
    try:
        configuration = configure(**dict.fromkeys(needed, True) | chosen)
    except ConfigurationError as error:
        option, _, reason = str(error).partition(": ")
        if option not in needed or option in chosen:
            raise
        if option == "turn":
            option = "camera." + next(name for name in ("yaw", "pitch", "roll") if getattr(scene.camera, name))
        raise ConfigurationError(f"{path}: {option}: {reason}") from None
    if lacking := scene.lacks(configuration.looks):
        raise UserError(f"{path}: the scene needs {NEEDED_FOR[lacking[0]]}; leave {lacking[0].upper()} out")
    load_scene(path, configuration.rectangles)  # refuses more rectangles than the hardware holds
    # Use the hardware's number if it was given; a default design may compute more than the scene needs.
    reflections = configuration.reflections if "reflections" in options else scene.reflections
    return Design(path, scene, configuration, reflections)
