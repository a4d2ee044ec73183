# SPDX-License-Identifier: MIT
"""The web page in Chromium: its pictures, counts and texts."""

from __future__ import annotations

import json
import math
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread

import numpy as np
import pytest
from rich.console import Console

from raycaster.engines import SEED
from raycaster.errors import UserError
from raycaster.golden.exact import ExactModel
from raycaster.golden.seed_engine import SeedModel
from raycaster.golden.world import Rectangles
from raycaster.play.machine import Machine, build_machine
from raycaster.scene import Camera, Scene, SceneError, load_scene, packaged_scenes
from raycaster.screens import SCREENS, Screen
from raycaster.sim.simulator import BUILD
from raycaster.sw.firmware import build_firmware
from raycaster.sw.play_script import DEMO, load
from raycaster.web import speed
from raycaster.web.browser import browser_page
from raycaster.web.site import MODELS, Model, write_site
from raycaster.web.site import main as site_main

SHOWN = "RayCaster.state.walk?.frames > 2 && RayCaster.state.walk.wrong !== null"
TIMEOUT_MS = 60_000
LOOKS = {"materials": True, "patterns": True, "reflections": 2}
SMALL_MODELS = (
    Model("walk", {"engine": "beam", "screen": "tiny", "turn": True}),
    Model("exact", {"engine": "exact", "screen": "tiny", "turn": True, **LOOKS, "light": True}, taps=True),
    Model("seed-0", {"engine": "seed", "screen": "tiny", **LOOKS}, taps=True),
)
"""Small models with the names of the page's own; other tests of the page have the last two as well."""

WALK, TINY, _ = (model.configuration.screen_geometry for model in SMALL_MODELS)
PIXELS = f"{WALK.columns * WALK.rows:,}"
MOST_BYTES = 2_000_000
"""Largest size of the whole page, compressed."""

TOUR = """async ([model, source, cameras]) => {
    const machine = await Machine.start(model);
    await machine.call("load", readScene(source, "scene", machine.design.rectangles));
    const frames = [await machine.frame()];
    for (const camera of cameras) frames.push(await machine.frame({ camera }));
    machine.end();
    return frames.map((frame) => pictureHash(frame.pixels));
}"""


def picture_hash(picture: np.ndarray) -> str:
    """Return FNV-1a of the words of red, green, blue and 255, by its definition."""
    value = 2166136261
    for red, green, blue in picture.reshape(-1, 3).tolist():
        value = (value ^ (red | green << 8 | blue << 16 | 255 << 24)) * 16777619 % (1 << 32)
    return f"{value:08x}"


def golden_hash(scene: Scene, camera: Camera | None = None, screen: Screen = WALK) -> str:
    """Return the hash of the exact picture, optionally from another camera."""
    return picture_hash(ExactModel().render(scene.model_copy(update={"camera": camera or scene.camera}), screen))


def packaged(name: str) -> Scene:
    return load_scene(packaged_scenes()[name])


def cameras_around(camera: Camera, count: int) -> list[Camera]:
    """Return cameras on a walk from a scene's camera, which makes a full turn."""
    x, y, z = camera.position
    return [
        Camera(
            position=(min(511, x + 2 * step), max(0, y - step), z),
            yaw=math.remainder(camera.yaw + 360 / count * step, 360), pitch=camera.pitch + step % 7, roll=camera.roll,
        )
        for step in range(1, count)
    ]  # fmt: skip


def assert_tour(page, model: str, name: str, count: int, screen: Screen = WALK) -> None:
    """Assert that a model draws golden frames in the browser, from a scene's camera and on a walk from there."""
    scene = packaged(name)
    cameras = [scene.camera, *cameras_around(scene.camera, count)]
    expected = [golden_hash(scene, camera, screen) for camera in cameras]
    assert len(set(expected)) > count // 2
    views = [{"position": camera.position, "basis": camera.basis} for camera in cameras[1:]]
    assert page.evaluate(TOUR, [model, packaged_scenes()[name].read_text(), views]) == expected, name


@pytest.fixture(scope="module")
def site(tmp_path_factory) -> Path:
    """Write a page with three models, whose designs have the tiny screen."""
    output = tmp_path_factory.mktemp("site") / "web"
    write_site(output, BUILD, Console(quiet=True), models=SMALL_MODELS, test=True)
    return output


@pytest.fixture(scope="module")
def whole_site(tmp_path_factory) -> tuple[Path, int]:
    """Write the page with all models; return its folder and size."""
    output = tmp_path_factory.mktemp("site") / "web"
    return output, write_site(output, BUILD, Console(quiet=True), test=True)


@pytest.fixture(scope="module")
def browser():
    """Share one browser page among all tests, and keep what it writes on the console."""
    with browser_page() as page:
        page.set_default_timeout(TIMEOUT_MS)
        page.said = []
        page.on("console", lambda message: page.said.append(message.text))
        yield page


@pytest.fixture
def page(browser):
    """Return the browser's page, which must write nothing on the console."""
    browser.said.clear()
    browser.goto("about:blank")
    yield browser
    assert browser.said == []


def opened(page, site: Path, place: str = "") -> dict:
    """Open the page and return the walk's state once it shows frames."""
    page.goto(f"{(site / 'index.html').as_uri()}{place}")
    page.wait_for_function(SHOWN)
    return page.evaluate("RayCaster.state.walk")


def test_draws_from_a_disk(page, site):
    state = opened(page, site)
    assert state["hash"] == golden_hash(packaged("mirror_room"))
    assert state["wrong"] == 0
    assert f"0 wrong pixels of {PIXELS}" in page.text_content("#walk-status")


def test_draws_from_a_server(page, site):
    handler = partial(SimpleHTTPRequestHandler, directory=site)
    handler.log_message = lambda *_: None
    server = ThreadingHTTPServer(("127.0.0.1", 0), handler)
    Thread(target=server.serve_forever, daemon=True).start()
    try:
        page.goto(f"http://127.0.0.1:{server.server_port}/index.html")
        page.wait_for_function(SHOWN)
    finally:
        server.shutdown()


def test_keys_move_the_camera(page, site):
    opened(page, site)
    start = page.evaluate("RayCaster.state.walk.camera")
    for key in ("w", "ArrowRight"):
        page.keyboard.down(key)
    moved = "({ position: [x], basis: [[fx]] }) => RayCaster.state.walk.camera.position[0] > x + 20"
    page.wait_for_function(f"(start) => ({moved})(start)", arg=start)
    for key in ("w", "ArrowRight"):
        page.keyboard.up(key)
    page.wait_for_function("RayCaster.state.walk.wrong === 0")
    state = page.evaluate("RayCaster.state.walk")
    assert state["camera"]["basis"] != start["basis"]
    scene = packaged("mirror_room")
    golden = ExactModel().picture(
        WALK, Rectangles.of_scene(scene), state["camera"]["position"], scene.background, scene.reflections,
        basis=tuple(map(tuple, state["camera"]["basis"])),
    )  # fmt: skip
    assert state["hash"] == picture_hash(golden)


def test_a_bad_scene_shows_its_line(page, site, tmp_path):
    opened(page, site)
    page.click("summary")
    good = page.input_value("#walk-text")
    bad = good.replace("colour = ", "color = ", 1)
    page.fill("#walk-text", bad)
    page.click("#walk-use")
    path = tmp_path / "scene"
    path.write_text(bad)
    with pytest.raises(SceneError) as error:
        load_scene(path)
    assert page.text_content("#walk-error") == str(error.value).replace(str(path), "scene")
    page.fill("#walk-text", good)
    page.click("#walk-use")
    assert page.text_content("#walk-error") == ""


def test_a_planted_pixel_is_counted_and_marked(page, site):
    state = opened(page, site, "?plant=40,30")
    assert state["wrong"] == 1
    assert f"1 wrong pixel of {PIXELS}" in page.text_content("#walk-status .wrong")
    page.wait_for_function(
        "[...find('walk-picture').getContext('2d').getImageData(40, 30, 1, 1).data].join() === '255,0,255,255'"
    )


@pytest.mark.parametrize(("model", "name", "screen"), [("walk", "boxes", WALK), ("exact", "shadow_hall", TINY)])
def test_turning_cameras_and_a_light(page, site, model, name, screen):
    opened(page, site)
    assert_tour(page, model, name, 5, screen)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["checkered_hall", "kaleidoscope", "periscope", "pool", "rooftops"])
def test_a_hundred_frames(page, whole_site, name):
    """Five scenes together need every look that the design can have."""
    opened(page, whole_site[0])
    assert_tour(page, "walk-looks", name, 20, SCREENS["vga", 240])


@pytest.mark.slow
def test_the_size(whole_site):
    site, size = whole_site
    assert {path.stem for path in (site / "models").iterdir()} == {model.name for model in MODELS} | {"golden"}
    assert size <= MOST_BYTES


@pytest.mark.slow
def test_the_game_is_the_native_one(page, whole_site):
    site, _ = whole_site
    held = load(DEMO)[:40]
    program = build_firmware((BUILD / "firmware").absolute()).words
    config = next(model.configuration for model in MODELS if model.processor)
    with Machine(build_machine(config, processor=True), config, program) as machine:
        # The machine has already completed its first frame.
        expected = [picture_hash(machine.frame(buttons).picture) for buttons in held]
    page.goto((site / "index.html").as_uri() + "#game")
    page.wait_for_function("RayCaster.state.game?.frames > 2 && RayCaster.state.game.wrong === 0")
    assert "engine beam" in page.text_content("#game-text")
    found = page.evaluate(
        """async (held) => {
            const machine = await Machine.start("game"), hashes = [];
            for (const buttons of held) {
                const frame = await machine.frame({ buttons });
                hashes.push(pictureHash(frame.pixels));
            }
            return hashes;
        }""",
        held,
    )
    assert found == expected
    assert len(set(expected)) > 10


def engines(page, scene: str, fraction_bits: int) -> dict:
    """Return the state of the tab with both engines once it shows a scene."""
    for select, value in (("scene", scene), ("fraction", str(fraction_bits))):
        page.evaluate("delete RayCaster.state.engines")
        page.select_option(f"#engines-{select}", value)
        page.wait_for_function("RayCaster.state.engines?.done")
    return page.evaluate("RayCaster.state.engines")


@pytest.mark.slow_sets("whole")
@pytest.mark.parametrize(
    ("which", "screen", "fraction_bits"), [("site", TINY, 0), ("whole_site", SCREENS["vga", 240], 4)]
)
def test_the_engines_side_by_side(page, request, which, screen, fraction_bits):
    """The exact engine draws the shadows, and afterwards a scene without a light; the seed engine refuses the first."""
    site = request.getfixturevalue(which)
    page.goto((site if which == "site" else site[0]).joinpath("index.html").as_uri() + "#engines")
    page.wait_for_function("RayCaster.state.engines?.done")
    reason = SEED.lacks["light"].replace("the seed engine", "it")
    state = engines(page, "evening", fraction_bits)
    # The exact engine of the whole page has the screen of the walk.
    assert state["exact"] == {"hash": golden_hash(packaged("evening"), screen=screen), "wrong": 0}
    assert state["seed"] == {"error": f"The seed engine refuses this scene: {reason}."}
    assert page.locator("#engines-seed").is_hidden()
    state = engines(page, "mirror_room", fraction_bits)
    scene = packaged("mirror_room")
    perfect, rounded = (model.render(scene, screen) for model in (ExactModel(), SeedModel(fraction_bits)))
    assert state["exact"] == {"hash": picture_hash(perfect), "wrong": 0}
    assert state["seed"] == {"hash": picture_hash(rounded), "wrong": 0}
    assert state["differs"] == np.any(perfect != rounded, axis=2).sum() > 0
    assert not page.locator("#engines-seed").is_hidden()


def test_a_walk_with_a_light(page, site):
    """The walk takes the exact engine for a scene with a light, and the beam engine again for the next scene."""
    opened(page, site)
    for name, screen in (("evening", TINY), ("boxes", WALK)):
        page.select_option("#walk-scene", name)
        expected = golden_hash(packaged(name), screen=screen)
        page.wait_for_function(f"RayCaster.state.walk.hash === '{expected}' && RayCaster.state.walk.wrong === 0")


@pytest.mark.slow
def test_frames_are_timed(page, whole_site, monkeypatch):
    """Frame times in the browser and natively are positive numbers of milliseconds, and the table has them."""
    monkeypatch.setattr(speed, "SCENES", ("boxes",))
    monkeypatch.setattr(speed, "FRAMES", 2)
    site, _ = whole_site
    (row,) = speed.speed(page, site, MODELS[0].name, MODELS[0].configuration, BUILD, Console(quiet=True))
    assert row.pop("scene") == "boxes"
    assert min(row.values()) > 0
    assert speed.speed_table([row | {"scene": "boxes"}]).row_count == 1


def test_settings_are_json(site):
    """The page's settings are one assignment."""
    text = (site / "settings.js").read_text()
    settings = json.loads(text.removeprefix("Object.assign(RayCaster, ").removesuffix(");\n"))
    assert set(settings["scenes"]) == set(packaged_scenes())
    assert ["light" in model["looks"] for model in settings["walk"]["models"]] == [False, False, True]


def test_nothing_to_keep_is_refused(tmp_path):
    with pytest.raises(UserError, match=r"^keep: there is nothing to keep without --measure$"):
        site_main(["--keep", str(tmp_path / "web.json")])
    assert not (tmp_path / "web.json").exists()
