# SPDX-License-Identifier: MIT
"""Compare the page's own check, compiled for this machine and as WebAssembly, with the golden models."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np
import pytest
from conftest import BUILD
from hard_scenes import scene_of
from wasmtime import Instance, Module, Store

from raycaster.configuration import LOOKS, Configuration, configure
from raycaster.engines import BEAM, EXACT
from raycaster.golden.catalogue import catalogue
from raycaster.golden.engines import model_of
from raycaster.golden.picture import shown
from raycaster.golden.random_world import random_basis, random_grid, random_light, random_looks
from raycaster.golden.rays import primary_slopes
from raycaster.golden.world import Rectangles
from raycaster.program import basis_fields, light_fields, scene_words
from raycaster.registers import register_map
from raycaster.scene import UNTURNED, Light, load_scene
from raycaster.screens import SCREENS, Screen
from raycaster.sim.register_model import COMMIT_CLOCKS, LiveScene, SceneFollower
from raycaster.verif.seeds import repeat, seed
from raycaster.web.golden import Golden, NativeGolden
from raycaster.web.wasm import golden_wasm

LIT, DARK_SIDE = -1, -2
"""Values of `Bounce::shadow`, besides the rectangle that shades."""

QUOTIENTS = [(bits, rounding) for bits in (0, 3, 8) for rounding in ("truncate", "nearest")]
ENGINES = [
    *(
        {"engine": engine.name, **{look: True for look in LOOKS if look not in engine.lacks}}
        for engine in (EXACT, BEAM)
    ),
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

of_each_engine = pytest.mark.parametrize("options", ENGINES, ids=lambda options: "-".join(map(str, options.values())))


def design(rectangles: int = 12, **options: object) -> Configuration:
    """Return a design that need not be fast enough for its screen."""
    small = configure(screen="tiny", rectangles=1, reflections=0, allow_underrun=True, **options)
    return replace(small, rectangles=rectangles, reflections=2)


class Wasm(Golden):
    def __init__(self):
        self._store = Store()
        module = Module.from_file(self._store.engine, str(golden_wasm(BUILD)))
        self.imports = list(module.imports)
        self._exports = Instance(self._store, module, []).exports(self._store)

    def call(self, name: str, *arguments: int) -> int:
        return self._exports[name](self._store, *map(int, arguments))

    def read(self, address: int, size: int) -> bytes:
        return bytes(self._exports["memory"].read(self._store, address, address + size))

    def write(self, address: int, data: bytes) -> None:
        self._exports["memory"].write(self._store, data, address)


@pytest.fixture(scope="module")
def golden() -> Golden:
    return NativeGolden(BUILD)


def world_words(
    table: Rectangles, camera: Sequence[int], basis, light: Light | None, background: Sequence[int], reflections: int
) -> list[tuple[int, int]]:
    """Return a world's register writes; unlike a scene file, they allow disabled entries and ones without a plane."""
    registers = register_map(len(table))
    fields = [
        ("background", dict(zip(("red", "green", "blue"), background, strict=True))),
        ("camera", dict(zip("xyz", map(int, camera), strict=True))),
        *basis_fields(basis),
        *light_fields(light),
    ]
    for index in range(len(table)):
        entry = f"rectangle[{index}]"
        for corner, position in enumerate(table.corners[index].tolist()):
            fields.append((f"{entry}.corner_{corner}", dict(zip("xyz", position, strict=True))))
        for name, colours, more in (
            ("surface", table.colours, {"enable": int(table.enabled[index]), "mirror": int(table.mirrors[index])}),
            (
                "pattern", table.colours_2,
                {"kind": int(table.kinds[index]), "cell": int(table.cells[index]).bit_length() - 4},
            ),
        ):  # fmt: skip
            red, green, blue = colours[index].tolist()
            fields.append((f"{entry}.{name}", {"red": red, "green": green, "blue": blue, **more}))
    fields.append(("control", {"run": 1, "commit": 1, "reflections": reflections}))
    return [(registers[name].address, registers[name].pack(**values)) for name, values in fields]


def random_words(rng: np.random.Generator, config: Configuration) -> list[tuple[int, int]]:
    """Return the writes of a world of any kind with all looks, whether the design has them or not."""
    count, basis = config.rectangles, random_basis(rng)
    if rng.random() < 0.3 and count >= 7:
        corners, camera = random_grid(rng, count)
        table = Rectangles(corners, rng.integers(256, size=(count, 3)).astype(np.uint8), np.ones(count, dtype=bool))
    else:
        slopes = primary_slopes(config.screen_geometry, basis if config.turn else UNTURNED)
        camera, table = scene_of(rng, slopes.reshape(-1, 3), count)
    table = random_looks(rng, table)
    # A mirror value above 4 counts as 4.
    table = replace(table, mirrors=np.where((table.mirrors == 4) & (rng.random(count) < 0.5), 7, table.mirrors))
    background = rng.integers(256, size=3).tolist()
    light = random_light(rng, table, np.asarray(camera)) if rng.random() < 0.8 else None
    return world_words(table, camera, basis, light, background, int(rng.integers(3)))


def live(config: Configuration, words: Iterable[tuple[int, int]]) -> LiveScene:
    """Return the live scene in the design's registers after these writes."""
    follower = SceneFollower(config)
    for address, word in words:
        follower.write(0, address, word, 0b1111)
    follower.start_screen(COMMIT_CLOCKS)
    return follower.live


def expected(config: Configuration, screen: Screen, scene: LiveScene) -> np.ndarray:
    """Return the expected picture at the pins, with one pixel per ray."""
    picture = scene.picture(model_of(config), screen)
    doubling = config.screen_geometry.doubling
    return shown(picture, config)[::doubling, ::doubling]


def assert_drawn(
    golden: Golden, config: Configuration, words: list[tuple[int, int]], context: str, screen: Screen | None = None
) -> np.ndarray:
    """Return the picture drawn from these words; assert that it matches the golden model."""
    golden.load(words)
    drawn = golden.draw(config, screen)
    wrong = np.argwhere((drawn != expected(config, screen or config.screen_geometry, live(config, words))).any(axis=-1))
    assert not len(wrong), f"{len(wrong)} wrong pixels, the first at row, column {wrong[0]}: {config.name}, {context}"
    return drawn


@of_each_engine
def test_packaged_scenes(golden, scenes, options):
    config = design(rectangles=16, **options)
    drawn, lit = 0, 0
    for path in sorted(scenes.glob("*.toml")):
        scene = load_scene(path)
        if not scene.lacks(config.looks):
            picture = assert_drawn(golden, config, scene_words(scene, config), path.name)
            assert len(np.unique(picture.reshape(-1, 3), axis=0)) > 1, path.name
            drawn += 1
            lit += scene.light is not None
    assert drawn > 10
    assert lit >= 5 or not config.light


@of_each_engine
def test_stiff_catalogue(golden, options):
    config = design(**options)
    cases = catalogue(config.looks)
    assert len(cases) > 80
    for case in cases:
        for screen in (WIDE, TALL):
            assert_drawn(golden, config, scene_words(case.scene, config), case.name, screen)


@of_each_engine
def test_random_worlds(golden, options):
    rng = np.random.default_rng([seed(), ENGINES.index(options)])
    colourful = 0
    for number in range(WORLDS):
        # Some looks are left out; the design then ignores their fields in the words.
        looks = {name: has and rng.random() < 0.7 for name, has in options.items() if name in LOOKS}
        rectangles, colour_bits = int(rng.integers(1, 33)), int(rng.integers(1, 9))
        config = design(rectangles=rectangles, colour_bits=colour_bits, **{**options, **looks})
        drawn = assert_drawn(golden, config, random_words(rng, config), f"world {number}; {repeat()}")
        colourful += len(np.unique(drawn.reshape(-1, 3), axis=0)) > 2
    assert colourful > WORLDS / 6, repeat()


@pytest.mark.parametrize("rows", [240, 200, 180])
def test_every_screen(golden, rows):
    """Every screen is drawn at its finest scale."""
    rng = np.random.default_rng(seed())
    config = configure(engine="beam", rows=rows, turn=True, materials=True, patterns=True, reflections=2)
    if rows == 180:
        config = replace(config, scale=2)
    assert_drawn(golden, config, random_words(rng, config), repeat())


def test_does_not_run(golden, scenes):
    """The picture is black, and a pixel's ray has no bounces."""
    config = design(engine="exact")
    words = dict(scene_words(load_scene(scenes / "floor.toml"), config))
    control = register_map(config.rectangles)["control"]
    golden.load(words.items())
    assert golden.draw(config).any()
    assert len(golden.bounces(0, 0))
    words[control.address] &= ~control.fields["run"].mask
    golden.load(words.items())
    assert not golden.draw(config).any()
    assert not len(golden.bounces(0, 0))


@of_each_engine
def test_explains_a_pixel(golden, options):
    rng = np.random.default_rng([seed(), 2])
    config = design(**options)
    screen = config.screen_geometry
    longest, misses = 0, 0
    shadows: Counter[str] = Counter()
    for number in range(WORLDS):
        words = random_words(rng, config)
        golden.load(words)
        golden.draw(config)
        scene = live(config, words)
        table = scene.rectangles
        pixels = rng.integers((screen.rows, screen.columns), size=(20, 2))
        slopes = primary_slopes(screen)[tuple(pixels.T)]
        if config.turn:
            # The basis is a factor even if it is not turned, since t is relative to these slopes.
            slopes = slopes @ np.array(scene.basis)
        trace = model_of(config).trace(
            table, scene.camera, scene.background, slopes, scene.reflections, light=scene.light
        )
        for ray, (row, column) in enumerate(pixels.tolist()):
            context = f"world {number}, row {row}, column {column}; {repeat()}"
            bounces = golden.bounces(column, row)
            winners = [int(winner[ray]) for winner in trace.winners]
            assert bounces[:, 0].tolist() == winners[: len(bounces)], context
            assert set(winners[len(bounces) :]) <= {-1}, context
            longest = max(longest, len(bounces))
            eye, slope = np.array(scene.camera), slopes[ray].copy()
            for depth, bounce in enumerate(bounces.tolist()):
                winner, numerator, denominator, *point, colour, quarters, shadow = bounce
                assert colour == int.from_bytes(trace.seen[depth][ray].tobytes(), "big"), context
                if winner < 0 or not scene.light:
                    assert shadow == LIT, context
                else:
                    shading = trace.shadings[depth]
                    assert shadow == (shading.shades[ray] if shading.facing[ray] else DARK_SIDE), context
                    shadows[{LIT: "lit", DARK_SIDE: "dark"}.get(shadow, "shaded")] += 1
                if winner < 0:
                    misses += 1
                    continue
                assert quarters == table.mirrors[winner], context
                assert point == trace.points[depth][ray].tolist(), context
                assert denominator == trace.denominators[depth][ray], context
                if config.facts.divides:
                    start = trace.points[depth - 1][ray, 0] if depth else scene.camera[0] << config.fraction_bits
                    assert numerator == abs(point[0] - start), context
                else:
                    assert point == (eye * denominator + slope * numerator).tolist(), context
                    axis = table.axes[winner]
                    eye[axis] = 2 * table.low[winner, axis] - eye[axis]
                    slope[axis] *= -1
    assert longest == 3, repeat()
    assert misses, repeat()
    assert len(shadows) == (3 if config.light else 0), repeat()


@pytest.fixture(scope="module")
def wasm() -> Wasm:
    return Wasm()


def test_wasm_imports_nothing(wasm):
    assert wasm.imports == []


@of_each_engine
def test_wasm_draws_the_same(golden, wasm, options):
    rng = np.random.default_rng([seed(), 3])
    for _ in range(10):
        config = design(**options)
        words = random_words(rng, config)
        pictures = []
        for one in (golden, wasm):
            one.load(words)
            pictures.append((one.draw(config).tobytes(), one.bounces(20, 30).tobytes()))
        assert pictures[0] == pictures[1], repeat()
