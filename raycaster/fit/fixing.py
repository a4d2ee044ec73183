# SPDX-License-Identifier: MIT
"""Designs with a scene built in, and the parts of the hardware that this leaves out."""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from raycaster.complaints import as_typed
from raycaster.configuration import FEATURES, Configuration
from raycaster.design.decide import configure
from raycaster.design.for_scene import Design, design_for
from raycaster.errors import UserError
from raycaster.fit.unneeded import at_the_edge, covered, label, needed, unreachable, without_mirrors
from raycaster.fixed import FixedRectangle, FixedScene
from raycaster.golden.frames import runs_of, scene_rows
from raycaster.golden.world import Rectangles
from raycaster.output import Console, Table
from raycaster.scene import Rectangle, Scene

SCOPES = {
    "rects": "rectangles are constants, the camera is live",
    "all": "camera, background and reflections are constants too",
}


@dataclass(frozen=True)
class Fixing:
    """A design with a scene built in.

    Attributes:
        design: the design.
        general: a design that shows the same scene, and any other.
        omissions: rectangles, and tests of them, that `design` does without, each with the reason.
    """

    design: Design
    general: Design
    omissions: Sequence[tuple[str, str]]


def add_fix_option(parser: argparse.ArgumentParser) -> None:
    """Add `--fix`."""
    scopes = "; ".join(f"{name}: {meaning}" for name, meaning in SCOPES.items())
    parser.add_argument("--fix", metavar="SCOPE", help=f"build the scene into the hardware; {scopes}")


def design_of(path: Path, options: Mapping[str, Any], scope: str | None, console: Console, **defaults: Any) -> Design:
    """Return the design for a scene; with a scope, build the scene in and show what that leaves out.

    Args:
        path: the scene file.
        options: options of the configuration that were given.
        scope: one of `SCOPES`, or None.
        console: console to show it on.
        defaults: values for options that were not given; see `design_for`.

    Raises:
        UserError: see `design_for` and `fix`.
    """
    if scope is None:
        return design_for(path, options, defaults)
    fixing = fix(path, defaults | dict(options), scope)
    show(fixing, console)
    return fixing.design


def configuration_of(
    path: Path | None, options: Mapping[str, Any], scope: str | None, console: Console
) -> Configuration:
    """Return the hardware for any scene, or with one scene built in; otherwise like `design_of`.

    Raises:
        UserError: a scope without a scene, or a scene without a scope, which would decide nothing.
    """
    if scope is None and path is None:
        return configure(**options)
    if path is None:
        raise UserError("fix: needs a scene to build in; name one, such as examples/two_boxes.toml")
    if scope is None:
        ways = " or ".join(as_typed("fix", one) for one in SCOPES)
        raise UserError(f"scene: the hardware shows any; to build {path} in, give {ways}")
    return design_of(path, options, scope, console).configuration


def fix(path: Path, options: Mapping[str, Any], scope: str) -> Fixing:
    """Build a scene into a design. With the camera built in, lists of frames hold this scene alone.

    Args:
        path: the scene file.
        options: options of the configuration that were given, without the number of rectangles.
        scope: one of `SCOPES`.

    Raises:
        UserError: see `design_for`; there is no such scope; or a number of rectangles was given.
    """
    if scope not in SCOPES:
        raise UserError(f"fix: expected {' or '.join(SCOPES)}, got {scope}")
    if "rectangles" in options:
        raise UserError(f"rectangles: a fixed scene has its own number; leave out {as_typed('rectangles')}")
    general = general_design(path, options)
    scene, reflections = general.scene, general.reflections
    reasons = _reasons(general, scope)
    # An engine has at least one rectangle, and tests primary rays against it.
    tested = sorted(set(range(len(scene.rect))) - set.intersection(*map(set, reasons))) or [0]
    primary, *others = (sum(1 << at for at, index in enumerate(tested) if index not in one) for one in reasons)
    reflected, shadows = others[:reflections], others[reflections:]
    rectangles = tuple(fixed_rectangle(scene.rect[index]) for index in tested)
    fixed = FixedScene(rectangles, (primary or 1, *reflected), shadows=tuple(shadows))
    if scope == "all":
        fixed = with_camera(fixed, scene)
    kept = {name: getattr(general.configuration, name) for name in ("engine", "rows", *FEATURES)}
    given = {**options, **kept, "reflections": reflections, "fixed": fixed}
    config = configure(**given)
    if scope == "all" and config.facts.whole_frames and "list" not in options:
        entries = runs_of(scene_rows(scene, config, reflections))
        config = configure(**given, list=entries + entries % 2)
    design = Design(path, scene, config, reflections)
    return Fixing(design, general, _omissions(scene, reasons, with_shadows=bool(fixed.shadows)))


def _reasons(general: Design, scope: str) -> list[dict[int, str]]:
    """Return reasons why rectangles are not tested, by index.

    There is an entry for the primary ray and each reflection; with a light, one more for the shadow rays of each.
    """
    scene, reflections = general.scene, general.reflections
    rectangles = Rectangles.of_scene(scene)
    within = {index: f"lies within {label(scene, other)}" for index, other in covered(rectangles).items()}
    ended = without_mirrors(rectangles, reflections)
    behind = unreachable(rectangles, reflections)
    if general.configuration.turn:
        behind = [set() for _ in behind]
    reasons = [
        dict.fromkeys(after, "nothing is a mirror") | dict.fromkeys(one, "at x = 0, and no ray runs that way") | within
        for after, one in zip(ended, behind, strict=True)
    ]
    edge = dict.fromkeys(at_the_edge(rectangles), "at the world's edge, and shades nothing") | within
    shadows = [dict.fromkeys(after, "nothing is a mirror") | edge for after in ended * general.configuration.light]
    if scope == "all":
        met, shading = needed(general.configuration, scene, reflections)
        for every, kept, reason in (
            (reasons, met, "no ray of the picture meets it first"),
            (shadows, shading or [set() for _ in shadows], "all that it shades is shaded without it"),
        ):
            for one, indices in zip(every, kept, strict=True):
                one.update(dict.fromkeys(set(range(len(scene.rect))) - indices - set(one), reason))
    return reasons + shadows


def fixed_rectangle(rectangle: Rectangle) -> FixedRectangle:
    """Return a scene's rectangle with its corners in order."""
    axis = rectangle.axis
    (u_low, u_high), (v_low, v_high) = (
        sorted(pair) for other, pair in enumerate(zip(*rectangle.corners, strict=True)) if other != axis
    )
    colour, colour_2 = (int.from_bytes(bytes(one or ()), "big") for one in (rectangle.colour, rectangle.colour2))
    return FixedRectangle(
        axis, rectangle.corners[0][axis], u_low, u_high, v_low, v_high, colour,
        mirror=rectangle.quarters, kind=rectangle.kind, cell=rectangle.cell_code, colour_2=colour_2,
    )  # fmt: skip


def with_camera(fixed: FixedScene, scene: Scene) -> FixedScene:
    """Build in the scene's camera, background and light, too."""
    background = int.from_bytes(bytes(scene.background), "big")
    light = scene.light and (*scene.light.position, scene.light.quarters)
    return replace(fixed, camera=scene.camera.position, background=background, basis=scene.camera.basis, light=light)


def general_design(path: Path, options: Mapping[str, Any]) -> Design:
    """Return the design that shows a scene, and any other: the default one, or one that is large enough for the scene.

    Raises:
        UserError: see `design_for`, except that the row budget is ignored.
    """
    with suppress(UserError):
        return design_for(path, options)
    return design_for(path, {**options, "allow_underrun": True})


def _omissions(scene: Scene, reasons: Sequence[Mapping[int, str]], *, with_shadows: bool) -> list[tuple[str, str]]:
    """Return the rectangles that no pass needs, and then those that only some passes do, with the reasons."""
    passes = ["of primary rays", *(f"of the {which}reflection" for which in ("", "second ", "third ", "fourth "))]
    if with_shadows:
        passes = passes[: len(reasons) // 2]
        passes += [f"for shadows {one}" for one in passes]
    nowhere = set.intersection(*map(set, reasons))
    found = [(label(scene, index), reasons[0][index]) for index in sorted(nowhere)]
    for name, one in zip(passes, reasons, strict=False):
        found += [(f"tests {name} against {label(scene, index)}", one[index]) for index in sorted(set(one) - nowhere)]
    return found


def show(fixing: Fixing, console: Console) -> None:
    """Print the omissions with their reasons."""
    title = f"{fixing.design.name}: left out of {fixing.general.configuration.name}"
    table = Table("left out", "reason", title=title, texts=("reason",))
    for row in [("memory and sorter of rectangles", "rectangles are constants"), *fixing.omissions]:
        table.add_row(*row)
    console.print(table)
