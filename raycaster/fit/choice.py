# SPDX-License-Identifier: MIT
"""Options that `make fit` chose for a scene, kept for the commands that build it."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from raycaster.errors import UserError
from raycaster.options import command_line

BUILD = Path("build/fit")
"""Folder of the choices, with a file per scene."""


def _digest(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


def keep_choice(path: Path, options: Mapping[str, Any], scope: str, output: Path = BUILD) -> Path:
    """Write the choice for a scene.

    Args:
        path: the scene file.
        options: options of the configuration.
        scope: part of the scene that is built in.
        output: folder to write to.

    Returns:
        The file, which is never seen half-written.
    """
    output.mkdir(parents=True, exist_ok=True)
    target = output / f"{path.stem}.json"
    partial = target.with_suffix(".partial")
    choice = {"scene": str(path), "sha256": _digest(path), "scope": scope, "options": dict(options)}
    partial.write_text(json.dumps(choice, indent=2) + "\n")
    partial.rename(target)
    return target


def kept_choice(path: Path, output: Path = BUILD) -> tuple[dict[str, Any], str]:
    """Return the options and the scope that were chosen for a scene.

    Raises:
        UserError: nothing was chosen for this scene, or it has changed since.
    """
    kept = output / f"{path.stem}.json"
    if not kept.exists():
        raise UserError(f"fit: nothing was chosen for {path} yet; run {command_line('fit', path)}")
    try:
        choice = json.loads(kept.read_text())
        digest, options, scope = choice["sha256"], choice["options"], choice["scope"]
    except (ValueError, KeyError, TypeError):
        raise UserError(f"fit: {kept} is not what the command fit wrote; run {command_line('fit', path)}") from None
    if not path.exists() or digest != _digest(path):
        raise UserError(f"fit: {path} is not the scene that {kept} was chosen for; run {command_line('fit', path)}")
    return options, scope
