# SPDX-License-Identifier: MIT
"""Rules of scene files for `page/scene.js`, all derived from the model that checks them on the command line."""

from __future__ import annotations

from raycaster.complaints import LONGEST_SHOWN
from raycaster.configuration import MOST_RECTANGLES
from raycaster.scene import COMPLAINTS, PATTERNS, Scene


def scene_schema() -> dict[str, object]:
    """Build the JSON object for `RayCasterScene.read`.

    `model` is the JSON schema of `Scene`: tables, their keys in order, defaults, and the `checks` of each value in the
    order in which they are applied. `complaints` are the other messages, with placeholders in braces. `longest_shown`
    is in characters, and `most_rectangles` is the limit of any hardware. `patterns` are in the order of the register
    codes.
    """
    return {
        "model": Scene.model_json_schema(),
        "complaints": dict(COMPLAINTS),
        "longest_shown": LONGEST_SHOWN,
        "most_rectangles": MOST_RECTANGLES,
        "patterns": list(PATTERNS),
    }
