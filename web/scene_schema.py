# SPDX-License-Identifier: MIT
"""What `page/scene.js` knows of scene files: all of it is derived from the model that checks them in the shell."""

from __future__ import annotations

from raycaster.complaints import LONGEST_SHOWN
from raycaster.configuration import MOST_RECTANGLES
from raycaster.scene import COMPLAINTS, PATTERNS, Scene


def scene_schema() -> dict[str, object]:
    """A JSON object for `RayCasterScene.read`.

    `model` is the JSON schema of `Scene`: tables, their keys in order, defaults, and the `checks` of each value in the
    order in which they are applied. `complaints` are the other words, with names in braces. `longest_shown` is in
    characters, and `most_rectangles` the most of any hardware. `patterns` are in the order of the registers' codes.
    """
    return {
        "model": Scene.model_json_schema(),
        "complaints": dict(COMPLAINTS),
        "longest_shown": LONGEST_SHOWN,
        "most_rectangles": MOST_RECTANGLES,
        "patterns": list(PATTERNS),
    }
