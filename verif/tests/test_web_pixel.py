# SPDX-License-Identifier: MIT
"""A pixel's life on the page: the recorded signals and the page's account of them match the golden model."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from conftest import BUILD, ROOT
from rich.console import Console
from wasmtime import Linker, Module, Store, WasiConfig

from raycaster.configuration import Configuration, configure
from raycaster.debug.probes.engines import description_of
from raycaster.debug.probes.exact import lighting, shadow_slope
from raycaster.debug.probes.ray import Place, Ray, read
from raycaster.debug.waves import Samples
from raycaster.design import Design
from raycaster.engines import SEED
from raycaster.golden.world import OTHER_AXES
from raycaster.scene import Scene, load_scene
from raycaster.verif.seeds import repeat, seed
from raycaster.web.browser import browser_page
from raycaster.web.site import Model, write_site
from raycaster.web.taps import TAP_BITS, tap_facts, tapped_probes, tapped_signals
from raycaster.web.wasm import machine_wasm

LOOKS = {"materials": True, "patterns": True}
OPTIONS = {"exact": {"engine": "exact", "turn": True, "light": True}, "seed": {"engine": "seed"}}
DESIGNS = {name: configure(screen="tiny", reflections=2, **LOOKS, **options) for name, options in OPTIONS.items()}
SCENES = {"exact": ("evening", "shadow_hall", "kaleidoscope", "staircase"), "seed": ("facing_mirrors", "stage")}
"""Scenes with several kinds of mirrors, patterns, rays that miss, and for the exact engine a turned camera and a light.
"""

PIXELS = 12
"""Pixels per scene."""

PAGE = ROOT / "web" / "page"
TIMEOUT_MS = 120_000

of_each = pytest.mark.parametrize("engine", DESIGNS)


@pytest.fixture(scope="module")
def site(tmp_path_factory) -> Path:
    """Write a page whose designs have the tiny screen."""
    output = tmp_path_factory.mktemp("site") / "web"
    models = [
        Model(name, {"screen": "tiny", "reflections": 2, **LOOKS, **OPTIONS[engine]}, taps=True)
        for name, engine in (("exact", "exact"), ("seed-0", "seed"))
    ]
    write_site(output, BUILD, Console(quiet=True), models=models, test=True)
    return output


@pytest.fixture(scope="module")
def page():
    with browser_page() as page:
        page.set_default_timeout(TIMEOUT_MS)
        yield page


def code(colour: Iterable[int]) -> int:
    return int.from_bytes(bytes(colour))


class Hardware:
    """The machine as the page's worker calls it."""

    def __init__(self, config: Configuration):
        self.config = config
        self._store = Store()
        self._store.set_wasi(WasiConfig())
        linker = Linker(self._store.engine)
        linker.define_wasi()
        module = Module.from_file(self._store.engine, str(machine_wasm(config, taps=True, build=BUILD)))
        self._exports = linker.instantiate(self._store, module).exports(self._store)
        self.call("_initialize")
        assert self.call("start") == 0

    def call(self, name: str, *arguments: int) -> int:
        return self._exports[name](self._store, *map(int, arguments))

    def words(self, start: int, count: int) -> np.ndarray:
        return np.frombuffer(self._exports["memory"].read(self._store, start, start + 4 * count), dtype="<u4")

    def load(self, scene: Scene) -> None:
        errors = [self.call("set_background", code(scene.background))]
        errors.append(self.call("set_camera", *scene.camera.position))
        if self.config.turn:
            errors.append(self.call("set_basis", *(part for vector in scene.camera.basis for part in vector)))
        for index, rect in enumerate(scene.rect):
            first, second = rect.corners
            errors.append(self.call("set_rectangle", index, *first, *second, code(rect.colour)))
            errors.append(self.call("set_mirror", index, round(4 * rect.mirror)))
            if rect.pattern != "plain":
                errors.append(self.call("set_pattern", index, rect.kind, rect.cell, code(rect.colour2)))
            else:
                errors.append(self.call("set_pattern", index, 0, 8, 0))
        if self.config.light:
            light = scene.light
            errors.append(
                self.call("set_light", *light.position, light.quarters) if light else self.call("clear_light")
            )
        errors += [self.call("disable_rectangle", n) for n in range(len(scene.rect), self.config.rectangles)]
        errors.append(self.call("set_reflections", scene.reflections))
        self.call("set_run", 1)
        errors.append(self.call("commit"))
        assert not any(errors), errors

    def watch(self, column: int, row: int) -> np.ndarray:
        """Return a row of taps for each clock cycle."""
        units = self.config.units
        self.call("watch", column % units, row, column // units)
        self.call("frame", 0)
        count = len(tapped_signals(self.config, 0))
        return self.words(self.call("samples"), self.call("sample_count")).reshape(-1, count)

    def shown(self, column: int, row: int) -> int:
        """Return a pixel of the last frame."""
        screen = self.config.screen_geometry
        picture = self.words(self.call("pixels"), self.call("pixel_count"))
        picture = picture.reshape(screen.vertical.visible, screen.horizontal.visible)
        return code(picture[row * screen.doubling, column * screen.doubling].tobytes()[:3])


class Recorded:
    """The taps of a unit, read like a waveform."""

    path = Path("taps")

    def __init__(self, samples: np.ndarray, config: Configuration, unit: int):
        self._values = dict(zip(tapped_signals(config, unit), samples.T.tolist(), strict=True))
        self._clocks = len(samples)
        self._video = description_of(config, unit).video

    def width(self, name: str) -> int:
        return TAP_BITS

    def sample(self, names: Iterable[str]) -> Samples:
        values = {name: self._clocks * [0] if name.startswith(self._video) else self._values[name] for name in names}
        return Samples([float(clock) for clock in range(self._clocks)], values)


@cache
def hardware(engine: str) -> Hardware:
    return Hardware(DESIGNS[engine])


def scene_of(name: str, scenes: Path) -> tuple[Path, Scene]:
    """Load a scene with as many reflections as the design has."""
    path = scenes / f"{name}.toml"
    return path, load_scene(path).model_copy(update={"reflections": 2})


def random_pixels(config: Configuration, number: int, count: int = PIXELS) -> list[tuple[int, int]]:
    screen = config.screen_geometry
    rng = np.random.default_rng([seed(), number])
    return rng.integers((screen.columns, screen.rows), size=(count, 2)).tolist()


@pytest.mark.slow_sets("seed")
@of_each
def test_taps_match_golden(engine, scenes):
    config, machine = DESIGNS[engine], hardware(engine)
    held, missed, reflected = 0, 0, 0
    for number, name in enumerate(SCENES[engine]):
        path, scene = scene_of(name, scenes)
        machine.load(scene)
        for column, row in random_pixels(config, number):
            context = f"{name}, column {column}, row {row}; {repeat()}"
            ray = Ray(Design(path, scene, config, scene.reflections), row, column)
            samples = machine.watch(column, row)
            assert len(samples), context
            whole = description_of(config, ray.unit)
            tapped = SimpleNamespace(
                probes=tapped_probes(config, ray.unit), events=whole.events, controls=whole.controls,
                expected=lambda of, whole=whole: [event for event in whole.expected(of) if event[0] != "shown"],
                event_names=whole.event_names, named=whole.named,
            )  # fmt: skip
            readings = read(Recorded(samples, config, ray.unit), tapped, ray)
            wrong = [reading for reading in readings if reading.wrong is not None]
            assert not wrong, f"{wrong[0]}; {context}"
            assert {reading.probe.quantity for reading in readings} >= {"colour seen", "pixel", "inside"}, context
            assert machine.shown(column, row) == ray.pixel, context
            held += len(readings)
            missed += ray.winner(0) < 0
            reflected += ray.alive(2)
    assert held > 2 * PIXELS * 50
    assert reflected, repeat()


def shadow_of(ray: Ray, number: int) -> int:
    """Return the rectangle that shades a hit point; -1 if it is lit, -2 on the dark side."""
    shading = ray.golden.shadings[number]
    return int(shading.shades[0]) if shading.facing[0] else -2


def assert_bounce(bounce: dict, ray: Ray, number: int, context: str) -> int:
    """Assert that the page's account of a ray matches the golden model; return the number of rectangles tested."""
    config = ray.config
    assert bounce["slope"] == list(ray.of_ray(number, "slopes")), context
    assert bounce["winner"] == ray.winner(number), context
    assert bounce["colour"] == code(ray.golden.seen[number][0]), context
    tried = [one["rectangle"] for one in bounce["tried"]]
    assert tried == sorted(set(tried)), context
    left_out = set(range(len(ray.rectangles))) - set(tried)
    assert not left_out or (config.culling and number == 0), context
    assert not any(ray.of_rectangle(Place(number, index), "hits") for index in left_out), context
    for one in bounce["tried"]:
        place, values = Place(number, one["rectangle"]), one["values"]
        hits = ray.of_rectangle(place, "hits")
        if "inside" not in values:  # its slot ended early
            assert config.culling and not hits, context
            continue
        assert values["inside"] == [hits], context
        assert one["kept"] == (ray.nearest(place) == place.rectangle), context
        assert one["found"] == (ray.nearest(place) >= 0), context
        if config.engine == "exact":
            if hits:
                assert values["t"] == [ray.of_rectangle(place, name) for name in ("numerators", "denominators")], (
                    context
                )
            continue
        assert values["valid"] == list(ray.of_rectangle(place, "valid")), context
        quotients, points = ray.of_rectangle(place, "quotients"), ray.of_rectangle(place, "points")
        for part, axis in enumerate(OTHER_AXES[ray.plane(place)[0]]):
            if values["valid"][part]:
                assert values["quotient u, v"][part] == quotients[part], context
                assert values["hit point u, v"][part] == points[axis], context
        if hits:
            assert values["depth"] == [ray.of_rectangle(place, "depths")], context
    if ray.winner(number) >= 0:
        assert bounce["point"] == ray.golden.points[number][0].tolist(), context
        assert bounce["denominator"] == ray.golden.denominators[number][0], context
        if ray.scene.light:
            assert bounce["values"]["slope from the light"] == shadow_slope(ray, Place(number)), context
            assert bounce["shadow"] == shadow_of(ray, number), context
    return len(tried)


@pytest.mark.slow_sets("seed")
@of_each
def test_a_life_matches_golden(engine, scenes, page):
    config, machine, facts = DESIGNS[engine], hardware(engine), tap_facts(DESIGNS[engine])
    page.goto("about:blank")
    page.add_script_tag(path=PAGE / "life.js")
    tested, misses, lost, shadows = 0, 0, 0, set()
    for number, name in enumerate(SCENES[engine]):
        path, scene = scene_of(name, scenes)
        machine.load(scene)
        for column, row in random_pixels(config, 10 + number):
            context = f"{name}, column {column}, row {row}; {repeat()}"
            ray = Ray(Design(path, scene, config, scene.reflections), row, column)
            samples = machine.watch(column, row).ravel().tolist()
            life = page.evaluate(
                "([taps, words]) => RayCasterLife.read(taps, Uint32Array.from(words))", [facts, samples]
            )
            alive = [bounce for bounce in range(scene.reflections + 1) if ray.alive(bounce)]
            assert len(life["bounces"]) == len(alive), context
            assert life["values"]["pixel"] == [ray.pixel], context
            for bounce in alive:
                tested += assert_bounce(life["bounces"][bounce], ray, bounce, context)
                misses += ray.winner(bounce) < 0
                if scene.light and ray.winner(bounce) >= 0:
                    shadows.add(shadow_of(ray, bounce))
            lost += len(alive) <= scene.reflections
    assert tested > 2 * PIXELS * 10
    assert misses and lost, repeat()
    assert not config.light or ({-1, -2} < shadows), repeat()


def opened(page, site: Path, question: str = "") -> dict:
    """Open the tab and return its first state."""
    page.goto("about:blank")
    page.goto(f"{(site / 'index.html').as_uri()}{question}#pixel")
    return computed(page)


def computed(page) -> dict:
    """Return the tab's state once it has a result."""
    page.wait_for_function("RayCaster.state.pixel?.done || RayCaster.state.pixel?.error")
    return page.evaluate("RayCaster.state.pixel")


def ask(page, **values: object) -> dict:
    """Choose a scene, an engine, a column or a row in the tab, which is idle."""
    for name, value in values.items():
        control = page.locator(f"#pixel-{name}")
        page.evaluate("delete RayCaster.state.pixel")
        if name in ("scene", "engine"):
            control.select_option(str(value))
        else:
            control.fill(str(value))
            control.dispatch_event("change")
        state = computed(page)
    return state


def test_the_tab(page, site, scenes):
    opened(page, site, "?plant=9,7")
    rng = np.random.default_rng([seed(), 20])
    for engine, names in SCENES.items():
        for name in names:
            scene = load_scene(scenes / f"{name}.toml")
            column, row = rng.integers((64, 48)).tolist()
            state = ask(page, scene=name)
            if not scene.lacks(DESIGNS["seed"].looks):
                state = ask(page, engine=engine)
            state = ask(page, column=column, row=row)
            context = f"{name}, column {column}, row {row}; {repeat()}"
            ray = Ray(Design(scenes / f"{name}.toml", scene, DESIGNS[engine], scene.reflections), row, column)
            assert (state["column"], state["row"], state["wrong"]) == (column, row, False), context
            assert page.locator("#pixel-panel .wrong").count() == 0, context
            winners = [ray.winner(bounce) for bounce in range(scene.reflections + 1) if ray.alive(bounce)]
            assert [bounce["winner"] for bounce in state["life"]["bounces"]] == winners, context
            assert state["golden"]["colour"] == state["monitor"] == ray.pixel, context
            hits = sum(winner >= 0 for winner in winners)
            assert page.locator("#pixel-life tr.seen").count() == page.locator("#pixel-plan .hit").count() == hits, (
                context
            )
            assert page.locator("#pixel-life h3").count() == len(winners) + 1, context
            shadows = [page.locator("#pixel-plan .light"), page.locator("#pixel-life caption", has_text="Shadow ray")]
            assert [one.count() for one in shadows] == ([1, hits] if scene.light else [0, 0]), context
            # The wrong pixel planted by this test.
            assert ask(page, column=9, row=7)["wrong"], context
            assert page.locator("#pixel-life .wrong").count() == 1, context


def test_a_click_chooses_the_pixel(page, site):
    opened(page, site)
    box = page.locator("#pixel-picture").bounding_box()
    at = {"x": box["width"] * 40.5 / 64, "y": box["height"] * 30.5 / 48}
    page.evaluate("delete RayCaster.state.pixel")
    page.locator("#pixel-picture").click(position=at)
    state = computed(page)
    assert (state["column"], state["row"]) == (40, 30)


def test_the_tab_refuses_bad_choices(page, site):
    opened(page, site)
    assert ask(page, column=64)["error"] == "Choose a column from 0 to 63 and a row from 0 to 47."
    assert "error" not in ask(page, column=63)
    ask(page, engine="seed")
    ask(page, scene="kaleidoscope")
    assert page.locator("#pixel-engine").input_value() == "exact"
    assert page.locator("#pixel-engine option[value=seed]").is_disabled()
    refusal = page.locator("#pixel-refusal")
    for scene, look in (("kaleidoscope", "turn"), ("evening", "light")):
        ask(page, scene=scene)
        reason = SEED.lacks[look].replace("the seed engine", "it")
        assert refusal.text_content() == f"The seed engine refuses this scene: {reason}."
    ask(page, scene="boxes")
    assert refusal.is_hidden()


def test_the_tab_shows_shadows(page, site, scenes):
    """The page says what a pixel's light meets, on the hardware and in the golden model."""
    opened(page, site)
    path = scenes / "shadow_hall.toml"
    scene = load_scene(path)
    ask(page, scene="shadow_hall")
    missing = {"lit", "on the dark side", "shaded by"}
    for column, row in random_pixels(DESIGNS["exact"], 30, 40):
        ray = Ray(Design(path, scene, DESIGNS["exact"], scene.reflections), row, column)
        golden = [lighting(ray, Place(bounce)) for bounce in range(3) if ray.winner(bounce) >= 0]
        kinds = {kind for kind in missing for text in golden if text and str(text[0]).startswith(kind)}
        if not kinds:
            continue
        missing -= kinds
        ask(page, column=column)
        ask(page, row=row)
        tables = page.locator("#pixel-life .scroll", has_text="Shadow ray, from")
        cells = tables.locator("td:nth-child(2)").all_text_contents()
        assert cells == [text[0] for text in golden if text for _ in ("hardware", "golden model")], f"{column}, {row}"
    assert not missing, repeat()


def test_facts_name_each_tap():
    for config in DESIGNS.values():
        facts = tap_facts(config)
        taps = {tap for probe in facts["probes"] for tap in probe["taps"]} | set(facts["controls"].values())
        assert taps == set(range(facts["count"]))
        assert len({len(tapped_signals(config, unit)) for unit in range(config.units)}) == 1
