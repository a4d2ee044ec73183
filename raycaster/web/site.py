# SPDX-License-Identifier: MIT
"""`raycaster web`: write a static page that runs the hardware in any browser, without a server."""

from __future__ import annotations

import base64
import gzip
import io
import json
import re
import shutil
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from PIL import Image

from raycaster.buses import USUAL_BAUD
from raycaster.complaints import LONGEST_SHOWN
from raycaster.configuration import FEATURES, MOST_RECTANGLES, WORLD_SIZE, Configuration
from raycaster.design.decide import configure
from raycaster.design.options import CommandParser, add_build_option
from raycaster.errors import UserError
from raycaster.fpga.area import ROOM_DESIGNS
from raycaster.fpga.board import OpenBoard, board_names, find_board
from raycaster.fpga.flows import largest_list
from raycaster.golden.exact import ExactModel
from raycaster.golden.frames import FIRST_DEAL
from raycaster.memory_map import BUTTON_NAMES
from raycaster.output import Console, replaced
from raycaster.play.system import FASTEST
from raycaster.play.walk import DRAG, STEEPEST, TURNS, WALKS
from raycaster.play.window import GAME_KEYS, TURN_KEYS, WALK_KEYS
from raycaster.registers import register_map
from raycaster.rtl.engines import ENGINES, SEED, SPAN
from raycaster.runs.jobs import processes, run_jobs
from raycaster.runs.outcomes import RESULTS, kept_outcome, kept_outcomes
from raycaster.scene import CELLS, COMPLAINTS, PATTERN_KEYS, PATTERNS, Scene, load_scene, packaged_scenes
from raycaster.screens import LIST_SCREENS, SCREENS, Screen
from raycaster.sim.simulator import SimulationError
from raycaster.sw.firmware import build_firmware
from raycaster.web.taps import tap_facts
from raycaster.web.wasm import golden_wasm, machine_wasm

PAGE = Path(__file__).with_name("page")
SCRIPTS = (
    "vendor/smol-toml", "scene", "hardware", "settings", "text", "room", "page", "engines", "life", "pixel", "plan",
    "properties", "board", "live", "monitor",
)  # fmt: skip
"""Scripts in loading order; `settings.js` is generated."""

FIRST_SCENE = "mirror_room"
FRACTIONS = (0, 8)
"""Fraction bits of the seed engines on the page."""

WALK_SPEED, TURN_SPEED = 120, 90
"""World units and degrees per second, at any frame rate."""

BROWSER_KEYS = {name: f"arrow{name}" for name in ("left", "right", "up", "down")} | {"space": " ", "return": "enter"}
"""Browser's names of keys, by the window's name where the two differ."""


_ROUTED = re.compile(
    rf"{SPAN.facts.name}-(?P<screen>[a-z]+).*-s(?P<scale>\d+)-.*-l(?P<list>\d+)-c\d+"
    rf"(?P<features>(-({'|'.join(FEATURES)}))*)(?P<serial>-uart\d*)?"
)
"""Name of a design that draws whole frames of any scene."""


@dataclass(frozen=True)
class Model:
    """A design that the page can run."""

    name: str
    options: Mapping[str, Any]
    processor: bool = False
    taps: bool = False
    """True if the page can watch a ray unit and the monitor's signals of the design."""

    draws: bool = False
    """True if the page takes runs from the design, without a monitor."""

    @property
    def configuration(self) -> Configuration:
        """Configuration of the design."""
        return configure(**self.options)


_LOOKS = {"materials": True, "patterns": True, "reflections": 2}
ROOM_MODELS = (
    *(
        Model(name, {"engine": SPAN.facts.name, "screen": "play", **of}, draws=True)
        for name, of in ROOM_DESIGNS.items()
    ),
    *(Model(f"{name}-480", {"engine": SPAN.facts.name, **ROOM_DESIGNS[name]}, draws=True) for name in ("plain", "lit")),
)
"""Models for rooms: of 320x240 rays, fastest first, then of 640x480."""

MODELS = (
    *ROOM_MODELS,
    Model("exact", {"engine": "exact", "turn": True, **_LOOKS, "light": True}, taps=True),
    Model("game", FASTEST, processor=True),
    *(Model(f"seed-{bits}", {"engine": "seed", "fraction_bits": bits, **_LOOKS}, taps=bits == 0) for bits in FRACTIONS),
)


def packed(contents: bytes) -> str:
    """Compress and encode bytes as text for a script."""
    return base64.b64encode(gzip.compress(contents, 9, mtime=0)).decode()


def _build(model: Model, build: Path) -> tuple[bytes, dict[str, Any]]:
    """Build a model: return its WebAssembly, and the facts that the page needs about it."""
    config, screen = model.configuration, model.configuration.screen_geometry
    of = {"processor": model.processor, "taps": model.taps, "draws": model.draws}
    wasm = machine_wasm(config, **of, build=build).read_bytes()
    return wasm, {
        "engine": config.facts.code,
        **{name: int(getattr(config, name)) for name in FEATURES},
        **{name: getattr(config, name) for name in ("rectangles", "reflections", "fraction_bits")},
        **{name: getattr(screen, name) for name in ("columns", "rows", "horizon_row", "scale", "doubling")},
        "draws": model.draws,
        "first_deal": FIRST_DEAL,
        **({"taps": tap_facts(config), "monitor": _monitor(screen)} if model.taps else {}),
    }


def _monitor(screen: Screen) -> dict[str, int]:
    """Return the timing that a monitor expects, in its pixels and lines, and the levels of its syncs."""
    return {
        "columns": screen.horizontal.total, "lines": screen.vertical.total, "hz": screen.pixel_hz,
        "clocks": screen.clocks_per_pixel, "hs": int(screen.horizontal.active_high),
        "vs": int(screen.vertical.active_high),
    }  # fmt: skip


def scene_schema() -> dict[str, object]:
    """Build the rules of scene files for `RayCasterScene.read`, from the model that checks them on the command line.

    `model` is the JSON schema of `Scene`: tables, their keys in order, defaults, and the `checks` of each value in the
    order in which they are applied. `complaints` are the other messages, with placeholders in braces. `longest_shown`
    is in characters, and `most_rectangles` is the limit of any hardware. `patterns` are in the order of the register
    codes, `cells` are the sizes of their cells, and `pattern_keys` are the keys that only a pattern has.
    """
    return {
        "model": Scene.model_json_schema(),
        "complaints": dict(COMPLAINTS),
        "longest_shown": LONGEST_SHOWN,
        "most_rectangles": MOST_RECTANGLES,
        "patterns": list(PATTERNS),
        "cells": list(CELLS),
        "pattern_keys": list(PATTERN_KEYS),
    }


def _thumbnail(path: Path) -> str:
    """Draw a scene as a small picture, and return its address."""
    picture = ExactModel().render(load_scene(path), SCREENS["tiny", 48])
    png = io.BytesIO()
    Image.fromarray(picture).save(png, "png", optimize=True)
    return f"data:image/png;base64,{base64.b64encode(png.getvalue()).decode()}"


def _settings(models: Sequence[Model], *, test: bool) -> dict[str, Any]:
    """Return the parts of the project that the page uses, such as scenes, keys and step sizes."""

    def keys(of: Mapping[str, Iterable[str]]) -> dict[str, list[str]]:
        return {name: [BROWSER_KEYS.get(key, key) for key in held] for name, held in of.items()}

    return {
        "test": test,
        "worker": (PAGE / "machine.js").read_text(),
        "schema": scene_schema(),
        "scenes": {name: path.read_text() for name, path in packaged_scenes().items()},
        "thumbnails": {name: _thumbnail(path) for name, path in packaged_scenes().items()},
        "walk": {
            "speed": WALK_SPEED, "turn": TURN_SPEED, "drag": DRAG, "steepest": STEEPEST, "world_size": WORLD_SIZE,
            "buttons": [*WALKS, *TURNS], "keys": keys(WALK_KEYS | TURN_KEYS), "first": FIRST_SCENE,
            "models": [
                {
                    "name": model.name, "design": model.name.partition("-")[0],
                    "features": list(model.configuration.features),
                    "reflections": model.configuration.most_reflections,
                    "rectangles": model.configuration.rectangles,
                    "columns": model.configuration.screen_geometry.columns,
                    "rows": model.configuration.screen_geometry.rows,
                }
                for model in models if model.draws
            ],
        },
        "cost": _cost(),
        "game": {"buttons": list(BUTTON_NAMES), "keys": keys(GAME_KEYS)},
        "board": _board(),
        "seed": {"fractions": list(FRACTIONS), "lacks": dict(SEED.facts.lacks)},
    }  # fmt: skip


def _cost(path: Path = RESULTS / "features.json") -> dict[str, Any] | None:
    """Return the cells of `ROOM_DESIGNS` on an ECP5, as last measured, and what the open boards have.

    `runs` of a board are the entries of the longest list for which it has memory, by design. `routed` are the designs
    for any scene that were placed and routed for boards. None where no figures are kept, as in an installed program.
    """
    if not path.exists():
        return None
    kept = kept_outcome(path)
    counted = [row for row in kept.figures["designs"] if row["engine"] == SPAN.facts.name]
    rooms = {
        name: {key: row[key] for key in ("tables", "registers", "multipliers")}
        for name, options in ROOM_DESIGNS.items() for row in counted if row["options"] == options
    }  # fmt: skip
    boards = {name: find_board(name, OpenBoard) for name in board_names(OpenBoard)}
    titles = {name: board.title.partition(",")[0] for name, board in boards.items()}
    routed = []
    for one in kept_outcomes(path.with_name("bitstreams.json")):
        figures = one.figures
        # A module that was routed alone has no board.
        if "board" in figures and (design := _ROUTED.fullmatch(figures["configuration"])):
            screen = LIST_SCREENS[design["screen"], figures["rows"]].scaled(int(design["scale"]))
            routed.append({
                "title": titles[figures["board"]], "serial": bool(design["serial"]),
                "features": design["features"].split("-")[1:], "runs": int(design["list"]),
                "columns": screen.columns, "rows": screen.rows,
                "cells": figures["cells"][figures["kinds"]["logic"]],
                "clock": figures["clocks"]["clk"], "date": one.date,
                **{name: figures[name] for name in ("rectangles", "reflections")},
            })  # fmt: skip
    designs = {name: configure(engine=SPAN.facts.name, **options) for name, options in ROOM_DESIGNS.items()}
    return {"date": kept.date, "rooms": rooms, "routed": routed, "boards": [
        {
            "title": titles[name], "elements": board.elements, "multipliers": board.multipliers,
            "runs": {room: largest_list(board, config) for room, config in designs.items()},
        }
        for name, board in boards.items()
    ]}  # fmt: skip


def _board() -> dict[str, Any]:
    """Return what the page needs to send a scene to a board.

    That is registers, engines by code and those that draw whole frames, and the usual rate.
    """
    known = register_map(1, lists=True)
    registers = {
        name: {
            "address": register.address,
            "fields": {key: [one.lsb, one.width] for key, one in register.fields.items()},
        }
        for name, register in known.items()
    }
    engines = {engine.facts.code: name for name, engine in ENGINES.items()}
    draws = [name for name, engine in ENGINES.items() if engine.facts.whole_frames]
    return {
        "registers": registers, "engines": engines, "draws": draws, "baud": USUAL_BAUD,
        "id": known["id"].reset, "major": known["version"].fields["major"].reset,
    }  # fmt: skip


def write_site(
    output: Path, build: Path, console: Console, *, models: Sequence[Model] = MODELS, test: bool = False
) -> int:
    """Write the page.

    Args:
        output: directory, replaced as a whole once everything is built.
        build: directory that holds `model/`.
        console: console for the progress bar.
        models: designs that the page can run.
        test: True if the page's address may plant a wrong pixel, as in `index.html?plant=100,50`.

    Returns:
        Total size of the files in bytes, compressed as servers do.

    Raises:
        UserError: a tool is missing.
        SimulationError: a design could not be compiled.
    """
    firmware = build_firmware((build / "firmware").absolute()).words.read_text()
    make, pool = partial(_build, build=build), processes(2)
    built = run_jobs("models", make, models, pool, console)
    with replaced(output) as site:
        (site / "models").mkdir()
        contents = {model.name: of for model, of in zip(models, built, strict=True)}
        contents["golden"] = golden_wasm(build).read_bytes(), {}
        programs = {model.name: {"program": packed(firmware.encode())} for model in models if model.processor}
        for name, (wasm, design) in contents.items():
            value = {"design": design, "wasm": packed(wasm), **programs.get(name, {})}
            text = f"RayCaster.models[{json.dumps(name)}] = {json.dumps(value)};\n"
            (site / "models" / f"{name}.js").write_text(text)
        for path in PAGE.iterdir():
            copy = shutil.copytree if path.is_dir() else shutil.copyfile
            copy(path, site / path.name)
        settings = json.dumps(_settings(models, test=test), separators=(",", ":"))
        (site / "settings.js").write_text(f"Object.assign(RayCaster, {settings});\n")
        page = site / "index.html"
        tags = "\n".join(f'<script src="{name}.js"></script>' for name in SCRIPTS)
        page.write_text(page.read_text().replace("<!-- SCRIPTS -->", tags))
    return sum(len(gzip.compress(path.read_bytes(), 9)) for path in output.rglob("*") if path.is_file())


def command_parser() -> CommandParser:
    """Build the parser of the command line."""
    parser = CommandParser("web", __doc__, "")
    add_build_option(parser)
    parser.add_argument("--output", type=Path, help="directory of the page (default: web/ in the build directory)")
    parser.add_argument(
        "--test", action="store_true", help="allow planting a wrong pixel by address, as in index.html?plant=100,50"
    )
    return parser


def main(argv: Sequence[str] | None = None) -> None:
    """Run the command."""
    arguments = command_parser().parse_args(argv)
    console = Console()
    output = arguments.output or arguments.build / "web"
    try:
        size = write_site(output, arguments.build, console, test=arguments.test)
    except SimulationError as error:
        raise UserError(str(error)) from None
    console.print(
        f"The page is {output / 'index.html'}, {size / 1e6:.2f} MB compressed. Open it in a browser, or put it on any "
        "web server.",
        soft_wrap=True,
    )
