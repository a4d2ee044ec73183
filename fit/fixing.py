# SPDX-License-Identifier: MIT
"""A scene built into the hardware, and what that leaves out."""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from rich.table import Table

from raycaster.configuration import COORDINATE_BITS, LOOKS, MOST_RECTANGLES, WORLD_SIZE, Configuration, configure
from raycaster.design import Design, design_for
from raycaster.errors import UserError
from raycaster.fit.choice import kept_choice
from raycaster.fit.unneeded import at_the_edge, covered, label, needed, unreachable, without_mirrors
from raycaster.fixed import FixedRectangle, FixedScene, varying_bits
from raycaster.golden.world import Rectangles
from raycaster.output import Console
from raycaster.scene import Rectangle, Scene

SCOPES = {
    "rects": "rectangles are constants, the camera is live",
    "all": "camera, background and reflections are constants too",
}
FIT = "fit"
"""The scope, and all else, that `raycaster.fpga.fit` chose."""

BOUNDS = {"u_low": 0, "v_low": 0, "u_high": WORLD_SIZE - 1, "v_high": WORLD_SIZE - 1}
"""The world's edge, by the bound that may be there."""


@dataclass(frozen=True)
class Omission:
    """Something that the hardware does without."""

    what: str
    reason: str


@dataclass(frozen=True)
class Fixing:
    """A design with a scene built in.

    Attributes:
        design: it.
        general: the design that shows the same scene, and any other.
        omissions: what the one has not got of the other.
    """

    design: Design
    general: Design
    omissions: tuple[Omission, ...]


def add_fix_option(parser: argparse.ArgumentParser) -> None:
    """Add `--fix`, and `--fit`, which is one more scope."""
    scopes = "; ".join(f"{name}: {meaning}" for name, meaning in SCOPES.items())
    parser.add_argument("--fix", metavar="SCOPE", help=f"build the scene into the hardware; {scopes}")
    parser.add_argument(
        "--fit", dest="fix", action="store_const", const=FIT, help="build what `raycaster fit` chose for the scene"
    )


def design_of(path: Path, options: Mapping[str, Any], scope: str | None, console: Console, **defaults: Any) -> Design:
    """The design for a scene, which is built into it where a scope is given; what that leaves out is shown.

    Args:
        path: the scene file.
        options: of the configuration, as they are given.
        scope: one of `SCOPES`, `FIT`, or None.
        console: where to show it.
        defaults: for the hardware where nothing is given; see `design_for`.

    Raises:
        UserError: as `design_for` and `fix`.
    """
    if scope is None:
        return design_for(path, options, defaults)
    chosen = defaults | dict(options)
    if scope == FIT:
        if options:
            raise UserError(
                f"{min(options)}: FIT takes what was chosen for the scene; leave {min(options).upper()} out"
            )
        chosen, scope = kept_choice(path)
        chosen = defaults | chosen
    fixing = fix(path, chosen, scope)
    show(fixing, console)
    return fixing.design


def configuration_of(
    path: Path | None, options: Mapping[str, Any], scope: str | None, console: Console
) -> Configuration:
    """The hardware for any scene, or for the one that is built into it; otherwise as `design_of`.

    Raises:
        UserError: a scope without a scene, or a scene without a scope, which would decide nothing.
    """
    if scope is None and path is None:
        return configure(**options)
    if path is None:
        raise UserError("fix: needs a scene to build in; name one with SCENE=path")
    if scope is None:
        raise UserError(f"scene: the hardware shows any; to build {path} in, say FIX={' or FIX='.join(SCOPES)}")
    return design_of(path, options, scope, console).configuration


def fix(path: Path, options: Mapping[str, Any], scope: str) -> Fixing:
    """Build a scene into a design.

    Args:
        path: the scene file.
        options: of the configuration, as they are given; not the number of rectangles, which is the scene's.
        scope: one of `SCOPES`.

    Raises:
        UserError: as `design_for`; there is no such scope; or a number of rectangles was given.
    """
    if scope not in SCOPES:
        raise UserError(f"fix: {' or '.join(SCOPES)}, not {scope}")
    if "rectangles" in options:
        raise UserError("rectangles: FIX builds in those of the scene; leave RECTANGLES out")
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
    kept = {name: getattr(general.configuration, name) for name in ("engine", "rows", *LOOKS)}
    given = {**options, **kept, "reflections": reflections, "fixed": fixed}
    design = Design(path, scene, configure(**given), reflections)
    return Fixing(design, general, tuple(_omissions(design, general, fixed, reasons)))


def _reasons(general: Design, scope: str) -> list[dict[int, str]]:
    """Reasons why a rectangle is not tested, by its index: for the primary ray and each reflection, and with a light
    for the shadow rays of each of these."""
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
            (shadows, shading or [set() for _ in shadows], "it shades nothing that is not shaded without it"),
        ):
            for one, indices in zip(every, kept, strict=True):
                one.update(dict.fromkeys(set(range(len(scene.rect))) - indices - set(one), reason))
    return reasons + shadows


def fixed_rectangle(rectangle: Rectangle) -> FixedRectangle:
    """A scene's rectangle with its corners put in order."""
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
    """Build in the scene's camera, background and light, beside its rectangles."""
    background = int.from_bytes(bytes(scene.background), "big")
    light = scene.light and (*scene.light.position, scene.light.quarters)
    return replace(fixed, camera=scene.camera.position, background=background, basis=scene.camera.basis, light=light)


def general_design(path: Path, options: Mapping[str, Any]) -> Design:
    """The design that shows a scene, and any other: the default one, or one that is large enough.

    Raises:
        UserError: as `design_for`, but for the row budget, and up to `MOST_RECTANGLES` for the number of rectangles.
    """
    underrun = {"allow_underrun": True}
    for room in ({}, underrun):
        with suppress(UserError):
            return design_for(path, {**options, **room})
    return design_for(path, {**options, **underrun, "rectangles": MOST_RECTANGLES})


def _omissions(
    design: Design, general: Design, fixed: FixedScene, reasons: Sequence[Mapping[int, str]]
) -> Iterator[Omission]:
    """In the order in which a picture is made: what is stored, what is compared, what it is multiplied with."""
    scene, small, large = design.scene, design.configuration, general.configuration
    words = (4 if large.patterns else 3) * large.rectangles
    yield Omission(f"rectangle memory: {words} words, each three times", "rectangles are constants")
    yield Omission("sorter of corners", "constants are in order")
    if fixed.camera:
        yield Omission("memory of camera and background", "they are constants")
    yield from _rectangles(scene, reasons, bool(fixed.shadows))
    if spare := large.rectangles - len(scene.rect):
        yield Omission(f"{spare} of {large.rectangles} entries for rectangles", f"the scene has {len(scene.rect)}")
    if large.reflections > small.reflections:
        yield Omission("reflection", "the scene has none" if not small.reflections else "the scene has fewer")
    if small.divider_bits != large.divider_bits or small.units != large.units:
        yield Omission(*_work(small, large))
    yield from _constant_fields(small, fixed)


def _rectangles(scene: Scene, reasons: Sequence[Mapping[int, str]], with_shadows: bool) -> Iterator[Omission]:
    passes = ["of primary rays", *(f"of the {which}reflection" for which in ("", "second ", "third ", "fourth "))]
    if with_shadows:
        passes = passes[: len(reasons) // 2]
        passes += [f"for shadows {one}" for one in passes]
    nowhere = set.intersection(*map(set, reasons))
    for index in sorted(nowhere):
        yield Omission(label(scene, index), reasons[0][index])
    for name, one in zip(passes, reasons, strict=False):
        for index in sorted(set(one) - nowhere):
            yield Omission(f"tests {name} against {label(scene, index)}", one[index])


def _work(small: Configuration, large: Configuration) -> tuple[str, str]:
    fewer = f"{large.units - small.units} of {large.units} units"
    reason = f"{small.units} meet the row budget with {small.group_cycles} cycles a group"
    if small.divider_bits != large.divider_bits:
        reason += f", at {small.divider_bits} quotient bits a cycle"
    return fewer, reason


def _constant_fields(config: Configuration, fixed: FixedScene) -> Iterator[Omission]:
    """What the rectangles have in common, so that nothing looks it up or carries it."""
    axes = set(fixed.column("axis"))
    for axis in sorted({0, 1, 2} - axes):
        yield Omission(f"rays against planes on {'xyz'[axis]}", "no rectangle is on that axis")
    for name, edge in BOUNDS.items():
        if set(fixed.column(name)) == {edge}:
            yield Omission(f"comparison with {name}", "every rectangle reaches the world's edge there")
    bits = dict.fromkeys(("position", *BOUNDS), COORDINATE_BITS) | {"colour": 24}
    bits |= {"mirror": 3} if config.materials else {}
    bits |= {"kind": 2, "cell": 3, "colour_2": 24} if config.patterns else {}
    for name, width in bits.items():
        same = width - varying_bits(fixed.column(name)).bit_count()
        if same:
            yield Omission(f"{same} of {width} bits of {name}", "the same in every rectangle")


def show(fixing: Fixing, console: Console) -> None:
    """Print what is left out, each with its reason."""
    table = Table(title=f"{fixing.design.name}: left out of {fixing.general.configuration.name}", title_justify="left")
    table.add_column("left out")
    table.add_column("as")
    for omission in fixing.omissions:
        table.add_row(omission.what, omission.reason)
    console.print(table)
