# SPDX-License-Identifier: MIT
"""Compare the page's own check, in WebAssembly, with the golden models; errors of the page's tools."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from conftest import BUILD
from wasmtime import Instance, Module, Store

from raycaster.configuration import FEATURES, Configuration
from raycaster.design.decide import configure
from raycaster.errors import UserError
from raycaster.golden.engines import model_of
from raycaster.golden.picture import shown
from raycaster.program import scene_words
from raycaster.registers import register_map
from raycaster.rtl.engines import EXACT, SPAN
from raycaster.scene import load_scene, packaged_scenes
from raycaster.screens import SCREENS, Screen
from raycaster.sim.register_model import COMMIT_CLOCKS, LiveScene, SceneFollower
from raycaster.sim.simulator import MODELS_VARIABLE
from raycaster.verif.catalogue import catalogue
from raycaster.verif.random_scenes import random_scene
from raycaster.verif.seeds import seed
from raycaster.web import wasm
from raycaster.web.wasm import golden_wasm

WORDS = 1024

QUOTIENTS = [(bits, rounding) for bits in (0, 3, 8) for rounding in ("truncate", "nearest")]
ENGINES = [
    *({"engine": engine.facts.name, **dict.fromkeys(engine.facts.features, True)} for engine in (EXACT, SPAN)),
    *(
        {"engine": "seed", "fraction_bits": bits, "rounding": rounding, "materials": True, "patterns": True}
        for bits, rounding in QUOTIENTS
    ),
]
WORLDS = 30
"""Random worlds per engine."""

_VGA = SCREENS["vga", 240]
WIDE, TALL = replace(_VGA, rows=24, horizon_row=12), replace(_VGA, columns=32)
"""Screens with the full screen's steepest rays to the sides, and up and down."""

few = pytest.mark.slow_sets("seed-3", "seed-8")
of_each_engine = pytest.mark.parametrize("options", ENGINES, ids=lambda options: "-".join(map(str, options.values())))


def design(rectangles: int = 12, **options: object) -> Configuration:
    """Return a design that need not be fast enough for its screen."""
    small = configure(screen="tiny", rectangles=1, reflections=0, allow_underrun=True, **options)
    return replace(small, rectangles=rectangles, reflections=2)


class Golden:
    """The compiled program as the page uses it.

    Args:
        call: calls an exported function, given its name and arguments.
        read: reads the program's memory, given an address and a size.
        write: writes the program's memory, given an address and bytes.
    """

    def __init__(
        self, call: Callable[..., int], read: Callable[[int, int], bytes], write: Callable[[int, bytes], object]
    ):
        self.call, self.read, self.write = call, read, write

    def load(self, words: Iterable[tuple[int, int]]) -> None:
        """Replace the live words by these, with their word addresses."""
        table = np.zeros(WORDS, dtype="<u4")
        for address, word in words:
            table[address] = word
        self.write(self.call("golden_words"), table.tobytes())

    def draw(self, config: Configuration, screen: Screen | None = None) -> np.ndarray:
        """Draw the picture of a design, optionally on another screen."""
        screen = screen or config.screen_geometry
        self.call(
            "golden_draw", config.facts.code, config.rectangles, config.materials, config.patterns, config.turn,
            config.light, screen.columns, screen.rows, screen.horizon_row, screen.scale, config.fraction_bits,
            config.rounding == "nearest", config.colour_bits,
        )  # fmt: skip
        data = self.read(self.call("golden_picture"), 3 * screen.columns * screen.rows)
        return np.frombuffer(data, dtype=np.uint8).reshape(screen.rows, screen.columns, 3)


@pytest.fixture(scope="module")
def golden() -> Golden:
    """The program as the page runs it; it imports nothing."""
    store = Store()
    module = Module.from_file(store.engine, str(golden_wasm(BUILD)))
    assert list(module.imports) == []
    exports = Instance(store, module, []).exports(store)
    memory = exports["memory"]
    return Golden(
        lambda name, *arguments: exports[name](store, *map(int, arguments)),
        lambda address, size: bytes(memory.read(store, address, address + size)),
        lambda address, data: memory.write(store, data, address),
    )


def random_words(rng: np.random.Generator, config: Configuration) -> list[tuple[int, int]]:
    """Return the writes of a random scene with all looks, whether the design has them or not, and a few wrong bits.

    Unlike in scene files, entries may be disabled or have no plane, mirrors may be above 4, and vectors may be any.
    """
    everything = design(config.rectangles, engine="exact", **dict.fromkeys(FEATURES, True))
    scene = random_scene(int(rng.integers(1 << 32)), config.rectangles, 2, FEATURES)
    *words, start = scene_words(scene, everything)
    bits = {register.address: register.implemented for register in register_map(config.rectangles).values()}
    wrong = np.where(rng.random(len(words)) < 0.05, 1 << rng.integers(32, size=len(words)), 0).tolist()
    return [(address, word ^ bit & bits[address]) for (address, word), bit in zip(words, wrong, strict=True)] + [start]


def live(config: Configuration, words: Iterable[tuple[int, int]]) -> LiveScene:
    """Return the live scene in the design's registers after these writes."""
    follower = SceneFollower(config)
    for address, word in words:
        follower.write(0, address, word, 0b1111)
    follower.start_screen(COMMIT_CLOCKS)
    return follower.live


def assert_drawn(
    golden: Golden, config: Configuration, words: list[tuple[int, int]], context: str, screen: Screen | None = None
) -> np.ndarray:
    """Return the picture drawn from these words, with one pixel per ray; assert that it matches the golden model."""
    golden.load(words)
    drawn, doubling = golden.draw(config, screen), config.screen_geometry.doubling
    right = live(config, words).picture(model_of(config), screen or config.screen_geometry)
    wrong = np.argwhere((drawn != shown(right, config)[::doubling, ::doubling]).any(axis=-1))
    assert not len(wrong), f"{len(wrong)} wrong pixels, the first at row, column {wrong[0]}: {config.name}, {context}"
    return drawn


@few
@of_each_engine
def test_stiff_catalogue(golden, options):
    config = design(**options)
    cases = catalogue(config.features)
    assert len(cases) > 80
    for case in cases:
        for screen in (WIDE, TALL):
            assert_drawn(golden, config, scene_words(case.scene, config), case.name, screen)


@few
@of_each_engine
def test_random_worlds(golden, options):
    rng = np.random.default_rng([seed(), ENGINES.index(options)])
    colourful = 0
    for number in range(WORLDS):
        # Some looks are left out; the design then ignores their fields in the words.
        looks = {name: has and rng.random() < 0.7 for name, has in options.items() if name in FEATURES}
        rectangles, colour_bits = int(rng.integers(1, 33)), int(rng.integers(1, 9))
        config = design(rectangles=rectangles, colour_bits=colour_bits, **{**options, **looks})
        drawn = assert_drawn(golden, config, random_words(rng, config), f"world {number}")
        colourful += len(np.unique(drawn.reshape(-1, 3), axis=0)) > 2
    assert colourful > WORLDS / 6


@pytest.mark.parametrize("rows", [240, 200, 180])
def test_every_screen(golden, rows, random):
    """Every screen is drawn at its finest scale."""
    config = configure(engine="span", rows=rows, turn=True, materials=True, patterns=True, reflections=2)
    if rows == 180:
        config = replace(config, scale=2)
    assert_drawn(golden, config, random_words(random, config), f"{rows} rows")


def test_does_not_run(golden):
    """The picture is black, and a pixel's ray has no bounces."""
    config = design(engine="exact")
    words = dict(scene_words(load_scene(packaged_scenes()["floor"]), config))
    control = register_map(config.rectangles)["control"]
    for mask, runs in ((0, True), (control.fields["run"].mask, False)):
        words[control.address] &= ~mask
        golden.load(words.items())
        assert golden.draw(config).any() == runs
        assert bool(golden.call("golden_ray", 0, 0)) == runs


def test_an_error_of_the_compiler_is_one_line(tmp_path, monkeypatch):
    source = tmp_path / "golden.cpp"
    monkeypatch.setattr(wasm, "GOLDEN", source)
    monkeypatch.delenv(MODELS_VARIABLE)
    source.write_text("int one = two;\n")
    with pytest.raises(UserError, match=r"^the compiler failed on golden; its log is \S+\.log$") as refused:
        golden_wasm(tmp_path)
    assert "'two'" in Path(str(refused.value).rpartition(" ")[2]).read_text()
    source.write_text("int one = 1;\n")
    assert golden_wasm(tmp_path).exists(), "a failure does not count as compiled"
    monkeypatch.setattr(wasm, "find_spec", lambda name: None)
    with pytest.raises(UserError, match=r"^ziglang is missing; it comes with the extra play: .*$"):
        golden_wasm(tmp_path)
