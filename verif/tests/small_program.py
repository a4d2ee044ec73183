# SPDX-License-Identifier: MIT
"""A small program for the processor: it shows a scene, moves the camera by buttons, and prints text."""

from __future__ import annotations

from pathlib import Path

from raycaster.configuration import Configuration
from raycaster.memory_map import INTERRUPT_BIT
from raycaster.program import scene_words
from raycaster.registers import register_map
from raycaster.scene import load_scene
from raycaster.sw.firmware import START, build_firmware

STEP = 8
"""World units per frame by which buttons move the camera."""


def write_program(scene: Path, configuration: Configuration, directory: Path) -> Path:
    """Compile the program for a scene and a design; return the file from which a memory is loaded."""
    shown = load_scene(scene, configuration.rectangles)
    x, y, z = shown.camera.position
    still = register_map(*configuration.map)["camera"].pack(x=x, z=z)
    words = ", ".join(f"{{{address}, {word:#x}}}" for address, word in scene_words(shown, configuration))
    (directory / "scene.h").write_text(
        "#include <stdint.h>\n"
        f"enum {{ STEP = {STEP}, INTERRUPT = {1 << INTERRUPT_BIT}, CAMERA_Y = {y}, CAMERA_X_AND_Z = {still} }};\n"
        f"static const struct {{ uint32_t address, word; }} SCENE[] = {{ {words} }};\n"
    )
    return build_firmware(directory / "program", (START, Path(__file__).with_suffix(".c")), (directory,)).words
