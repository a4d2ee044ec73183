# SPDX-License-Identifier: MIT
"""A pixel's life on the page: its account of the recorded signals matches the golden model."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from conftest import PAGE_MODELS, page_state

from raycaster.configuration import Configuration
from raycaster.debug.probes.exact import lighting
from raycaster.debug.probes.ray import Place, Ray
from raycaster.design.decide import configure
from raycaster.design.for_scene import Design
from raycaster.rtl.engines import SEED
from raycaster.scene import load_scene, packaged_scenes
from raycaster.verif.seeds import seed
from raycaster.web.taps import tapped_probes

MODELS = {"exact": "exact", "seed": "seed-0"}
DESIGNS = {engine: configure(**PAGE_MODELS[model]) for engine, model in MODELS.items()}
SCENES = {"exact": ("evening", "shadow_hall", "kaleidoscope", "staircase"), "seed": ("facing_mirrors", "stage")}
"""Scenes with several kinds of mirrors, patterns, rays that miss, and for the exact engine a turned camera and a light.
"""

PIXELS = 12
"""Pixels per scene."""

COLUMNS, ROWS = 64, 48

WATCH = """async ([model, source, pixels]) => {
    const machine = await Machine.start(model);
    const { taps, fraction_bits: fractionBits, columns, rectangles } = machine.design;
    await machine.call("load", { ...readScene(source, "scene", rectangles), reflections: 2 });
    const found = [];
    for (const [column, row] of pixels) {
        const { samples, pixels } = await machine.watch(column, row);
        const monitor = rgb(pixels.subarray(4 * (row * columns + column)));
        found.push({ monitor, life: RayCasterLife.read(taps, samples, fractionBits) });
    }
    machine.end();
    return found;
}"""


def ray_of(path: Path, config: Configuration, column: int, row: int, reflections: int | None = None) -> Ray:
    """Return the golden ray of a pixel, optionally with another number of reflections than the scene's."""
    scene = load_scene(path)
    reflections = scene.reflections if reflections is None else reflections
    return Ray(Design(path, scene.model_copy(update={"reflections": reflections}), config, reflections), row, column)


def random_pixels(number: int, count: int) -> list[tuple[int, int]]:
    return np.random.default_rng([seed(), number]).integers((COLUMNS, ROWS), size=(count, 2)).tolist()


def shadow_of(ray: Ray, number: int) -> int:
    """Return the rectangle that shades a hit point; -1 if it is lit, -2 on the dark side."""
    shading = ray.golden.shadings[number]
    return int(shading.shades[0]) if shading.facing[0] else -2


def assert_account(life: dict, ray: Ray, context: str) -> set[str]:
    """Assert that the page's account of a pixel matches the golden model; return the quantities that it has."""
    probes = {probe.quantity: probe for probe in tapped_probes(ray.config, ray.unit)}
    compared = set()

    def compare(values: dict[str, list[int]], place: Place) -> None:
        for quantity, found in values.items():
            golden = probes[quantity].golden(ray, place)
            if golden and not probes[quantity].decode:
                known = [value if one is None else one for one, value in zip(golden, found, strict=True)]
                assert found == known, f"{quantity} at {place}; {context}"
                compared.add(quantity)

    bounces = life["bounces"]
    assert len(bounces) == sum(ray.alive(number) for number in range(3)), context
    compare(life["values"], Place(0))
    for number, bounce in enumerate(bounces):
        compare(bounce["values"], Place(number))
        winner, told = ray.winner(number), (bounce["winner"], tuple(bounce["slope"]), bounce["colour"])
        assert told == (winner, ray.of_ray(number, "slopes"), *ray.seen_colour(Place(number))), context
        tried = [one["rectangle"] for one in bounce["tried"]]
        assert tried == sorted(set(tried)), context
        left_out = set(range(len(ray.rectangles))) - set(tried)
        assert not left_out or (ray.config.culling and number == 0), context
        for one in bounce["tried"]:
            place = Place(number, one["rectangle"])
            compare(one["values"], place)
            if "inside" in one["values"]:
                nearest = ray.nearest(place)
                assert (one["kept"], one["found"]) == (nearest == place.rectangle, nearest >= 0), context
            else:  # its slot ended early
                assert ray.config.culling, context
                left_out.add(place.rectangle)
        assert not any(ray.of_rectangle(Place(number, index), "hits") for index in left_out), context
        if winner >= 0:
            point = ray.golden.points[number][0].tolist(), ray.golden.denominators[number][0]
            assert (bounce["point"], bounce["denominator"]) == point, context
            assert not ray.scene.light or bounce["shadow"] == shadow_of(ray, number), context
    return compared


@pytest.mark.slow_sets("seed")
@pytest.mark.parametrize("engine", DESIGNS)
def test_a_life_matches_golden(engine, page, site):
    config = DESIGNS[engine]
    page.goto((site / "index.html").as_uri())
    compared, lengths, shadows = set(), set(), set()
    for number, name in enumerate(SCENES[engine]):
        path, pixels = packaged_scenes()[name], random_pixels(number, PIXELS)
        found = page.evaluate(WATCH, [MODELS[engine], path.read_text(), pixels])
        for (column, row), pixel in zip(pixels, found, strict=True):
            context = f"{name}, column {column}, row {row}"
            ray = ray_of(path, config, column, row, 2)
            assert pixel["monitor"] == ray.pixel, context
            compared |= assert_account(pixel["life"], ray, context)
            hit = [bounce for bounce in range(3) if ray.winner(bounce) >= 0]
            lengths.add(len(hit))
            shadows |= {shadow_of(ray, bounce) for bounce in hit if ray.scene.light}
    assert compared == {probe.quantity for probe in tapped_probes(config, 0) if not probe.decode}
    assert len(lengths) > 1 and 3 in lengths
    assert not config.light or {-1, -2} < shadows


def opened(page, site: Path, question: str = "") -> None:
    """Open the tab and wait for its first result."""
    page.goto(f"{(site / 'index.html').as_uri()}{question}#pixel")
    page_state(page, "pixel")


def ask(page, **values: object) -> dict:
    """Choose a scene, an engine, a column or a row in the tab, which is idle; return its state once it has a result."""
    for name, value in values.items():
        control = page.locator(f"#pixel-{name}")
        page.evaluate("delete RayCaster.state.pixel")
        if name in ("scene", "engine"):
            control.select_option(value)
        else:
            control.fill(str(value))
            control.dispatch_event("change")
        state = page_state(page, "pixel")
    return state


@pytest.mark.slow_sets("exact-staircase", "seed-stage")
@pytest.mark.parametrize(("engine", "name"), [("exact", "shadow_hall"), ("exact", "staircase"), ("seed", "stage")])
def test_the_tab(page, site, engine, name):
    """The tab shows each ray and what its light meets, and marks only the pixel that this test plants."""
    opened(page, site, "?plant=9,7")
    ask(page, scene=name)
    if engine != "exact":
        ask(page, engine=engine)
    for column, row in random_pixels(20, 8):
        ray = ray_of(packaged_scenes()[name], DESIGNS[engine], column, row)
        winners = [ray.winner(bounce) for bounce in range(ray.reflections + 1) if ray.alive(bounce)]
        texts = [text for bounce in range(len(winners)) for text in lighting(ray, Place(bounce)) or ()]
        state, context = ask(page, column=column, row=row), f"column {column}, row {row}"
        assert (state["column"], state["row"], state["wrong"]) == (column, row, False), context
        assert [bounce["winner"] for bounce in state["life"]["bounces"]] == winners, context
        assert [bounce["winner"] for bounce in state["golden"]["bounces"]] == winners, context
        assert state["golden"]["colour"] == state["monitor"] == ray.pixel, context
        assert page.locator("#pixel-life h3").count() == len(winners) + 1, context
        shadows = page.locator("#pixel-life .scroll", has_text="Shadow ray, from")
        cells = shadows.locator("td:nth-child(2)").all_text_contents()
        assert cells == [text for text in texts for _ in ("hardware", "golden model")], context
    assert ask(page, column=9, row=7)["wrong"]
    assert page.locator("#pixel-life .wrong").count() == 1


def test_a_click_chooses_the_pixel(page, site):
    opened(page, site)
    box = page.locator("#pixel-picture").bounding_box()
    page.evaluate("delete RayCaster.state.pixel")
    at = {"x": box["width"] * 40.5 / COLUMNS, "y": box["height"] * 30.5 / ROWS}
    page.locator("#pixel-picture").click(position=at)
    state = page_state(page, "pixel")
    assert (state["column"], state["row"]) == (40, 30)


def test_the_tab_refuses_bad_choices(page, site):
    opened(page, site)
    assert ask(page, column=64)["error"] == "Choose a column from 0 to 63 and a row from 0 to 47."
    assert "error" not in ask(page, column=63)
    ask(page, engine="seed")
    refusal = page.locator("#pixel-refusal")
    for scene, look in (("kaleidoscope", "turn"), ("evening", "light")):
        ask(page, scene=scene)
        reason = SEED.facts.lacks[look].replace("the seed engine", "it")
        assert refusal.text_content() == f"The seed engine refuses this scene: {reason}."
        assert page.locator("#pixel-engine").input_value() == "exact"
        assert page.locator("#pixel-engine option[value=seed]").is_disabled()
    ask(page, scene="boxes")
    assert refusal.is_hidden()
