# SPDX-License-Identifier: MIT
"""The web page in Chromium: its pictures, counts and texts."""

from __future__ import annotations

import math
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread

import numpy as np
import pytest
from conftest import BUILD, PAGE_MODELS, page_state
from rich.console import Console

from raycaster.design.decide import configure
from raycaster.golden.exact import ExactModel
from raycaster.golden.seed_engine import SeedModel
from raycaster.play.machine import Machine, build_machine
from raycaster.rtl.engines import SEED
from raycaster.scene import Camera, Scene, SceneError, load_scene, packaged_scenes
from raycaster.screens import LIST_SCREENS, SCREENS, Screen
from raycaster.sw.firmware import build_firmware
from raycaster.sw.play_script import DEMO, load
from raycaster.web.site import MODELS, packed, write_site
from raycaster.web.wasm import is_direct, machine_wasm

ROOM, TINY = (configure(**PAGE_MODELS[name]).screen_geometry for name in ("plain", "exact"))
VGA = SCREENS["vga", 240]
PLAY = LIST_SCREENS["play", 240]
FINE = LIST_SCREENS["vga", 240].scaled(2)
MOST_BYTES = 1_200_000
"""Largest size of the whole page, compressed."""

TOUR = """async ([model, source, cameras]) => {
    const design = (await RayCaster.model(model)).design, scene = readScene(source, "scene", design.rectangles);
    const machine = await (design.draws ? Drawing : Machine).start(model);
    if (!design.draws) await machine.call("load", scene);
    const frames = [await machine.frame({ scene })];
    for (const camera of cameras) frames.push(await machine.frame({ camera }));
    machine.end();
    return frames.map((frame) => pictureHash(frame.pixels));
}"""

DRAWN = """async ([model, sources]) => {
    const drawing = await Drawing.start(model, 3), frames = [];
    for (const source of sources) {
        const scene = readScene(source, "scene", drawing.design.rectangles);
        for (const yaw of [0, 100, -130]) {
            const camera = { ...scene.camera, basis: RayCasterScene.basis(yaw, 10, 0) };
            frames.push(await drawing.frame(yaw ? { camera } : { scene }));
        }
    }
    drawing.end();
    return frames.map(({ pixels, clocks, runs, words }) => [pictureHash(pixels), clocks, runs, words.join()]);
}"""

GAME = """async (held) => {
    const machine = await Machine.start("game"), hashes = [];
    for (const buttons of held) hashes.push(pictureHash((await machine.frame({ buttons })).pixels));
    return hashes;
}"""


def picture_hash(picture: np.ndarray) -> str:
    """Return FNV-1a of the words of red, green, blue and 255, by its definition."""
    value = 2166136261
    for red, green, blue in picture.reshape(-1, 3).tolist():
        value = (value ^ (red | green << 8 | blue << 16 | 255 << 24)) * 16777619 % (1 << 32)
    return f"{value:08x}"


def golden_hash(scene: Scene, camera: Camera | None = None, screen: Screen = ROOM) -> str:
    """Return the hash of the exact picture, optionally from another camera."""
    return picture_hash(ExactModel().render(scene.model_copy(update={"camera": camera or scene.camera}), screen))


def packaged(name: str) -> Scene:
    return load_scene(packaged_scenes()[name])


@pytest.fixture(scope="module")
def whole_site(tmp_path_factory) -> Path:
    """Write the page with all models."""
    output = tmp_path_factory.mktemp("site") / "web"
    write_site(output, BUILD, Console(quiet=True), test=True)
    return output


def opened(page, address: str) -> dict:
    """Open the page and return the room's state once it shows a checked frame."""
    page.goto(address)
    page.wait_for_function("RayCaster.state.room && Number.isInteger(RayCaster.state.room.wrong)")
    return page.evaluate("RayCaster.state.room")


def test_draws_from_a_disk_and_from_a_server(page, site):
    with ThreadingHTTPServer(("127.0.0.1", 0), partial(SimpleHTTPRequestHandler, directory=site)) as server:
        Thread(target=server.serve_forever, daemon=True).start()
        for place in (site.as_uri(), f"http://127.0.0.1:{server.server_port}"):
            state = opened(page, f"{place}/index.html")
            assert (state["hash"], state["wrong"]) == (golden_hash(packaged("mirror_room")), 0)
            assert f"{state['compared']:,}, different: 0." in page.text_content("#room-compared")
        server.shutdown()
    assert page.evaluate("Object.keys(RayCaster.scenes)") == list(packaged_scenes())


def test_a_bad_scene_has_the_complaint_of_the_command_line(page, site, tmp_path):
    opened(page, (site / "index.html").as_uri())
    good = page.input_value("#room-text")
    path = tmp_path / "mirror_room.toml"
    path.write_text(good.replace("colour = ", "color = ", 1))
    with pytest.raises(SceneError) as error:
        load_scene(path)
    for text, complaint in ((path.read_text(), str(error.value).replace(str(path), path.name)), (good, "")):
        page.fill("#room-text", text)
        assert page.text_content("#room-error") == complaint


def test_an_address_plants_a_pixel(page, site):
    state = opened(page, f"{(site / 'index.html').as_uri()}?plant=40,30")
    assert (state["wrong"], state["different"]) == (1, 1)


TOURS = [("plain", "boxes", 5, ROOM), ("exact", "shadow_hall", 5, TINY), ("full", "lamplight", 5, ROOM)]
TOURS += [("full", "hall_of_mirrors", 20, PLAY)]
TOURS += [("lit-480", "mirror_room", 5, FINE)]
TOURS += [("looks", name, 20, PLAY) for name in ("checkered_hall", "kaleidoscope", "periscope", "pool", "rooftops")]
"""Models with their scenes, frames and screens; the last five scenes together need every look of a design."""


@pytest.mark.slow_sets("looks", "full-hall", "lit-480")
@pytest.mark.parametrize(("model", "name", "count", "screen"), TOURS)
def test_a_tour(page, request, model, name, count, screen):
    """A model draws golden frames, from a scene's camera and on a walk from there with a full turn."""
    site = request.getfixturevalue("whole_site" if screen in (PLAY, FINE) else "site")
    opened(page, (site / "index.html").as_uri())
    scene = packaged(name)
    x, y, z = scene.camera.position
    cameras = [scene.camera]
    for step in range(1, count):
        place, yaw = (min(511, x + 2 * step), max(0, y - step), z), scene.camera.yaw + 360 / count * step
        pitch = scene.camera.pitch + step % 7
        cameras.append(Camera(position=place, yaw=math.remainder(yaw, 360), pitch=pitch, roll=scene.camera.roll))
    expected = [golden_hash(scene, camera, screen) for camera in cameras]
    assert len(set(expected)) > count // 2
    views = [{"position": camera.position, "basis": camera.basis} for camera in cameras[1:]]
    assert page.evaluate(TOUR, [model, packaged_scenes()[name].read_text(), views]) == expected


@pytest.mark.slow
def test_stopped_clocks_change_nothing(page, site, monkeypatch):
    """A model whose clocks never stop, evaluated as usual, draws the same runs in the same clocks, after each write."""
    opened(page, (site / "index.html").as_uri())
    page.evaluate("RayCaster.model('full')")
    wasms = [machine_wasm(configure(**PAGE_MODELS["full"]), draws=True, build=BUILD)]
    assert is_direct(wasms[0].parent)
    monkeypatch.setattr("raycaster.web.wasm.CLOCKED", {})
    monkeypatch.setattr("raycaster.web.wasm.DIRECT", ("no such part",))
    wasms.append(machine_wasm(configure(**PAGE_MODELS["full"]), draws=True, build=BUILD))
    assert not is_direct(wasms[1].parent)
    names = ["lamplight", "mirror_room", "shadow_hall", "kaleidoscope", "pool", "colonnade"]
    sources, frames = [packaged_scenes()[name].read_text() for name in names], []
    for wasm in wasms:
        model = packed(wasm.read_bytes())
        page.evaluate("(wasm) => (RayCaster.models.one = { ...RayCaster.models.full, wasm }, 0)", model)
        frames.append(page.evaluate(DRAWN, ["one", sources]))
    assert frames[0] == frames[1]
    assert len({picture for picture, *_ in frames[0]}) > 2 * len(names)


@pytest.mark.slow
def test_the_size(tmp_path):
    site = tmp_path / "web"
    assert write_site(site, BUILD, Console(quiet=True)) <= MOST_BYTES
    assert {path.stem for path in (site / "models").iterdir()} == {model.name for model in MODELS} | {"golden"}


@pytest.mark.slow
def test_the_game_is_the_native_one(page, whole_site):
    held = load(DEMO)[:40]
    program = build_firmware((BUILD / "firmware").absolute()).words
    config = next(model.configuration for model in MODELS if model.processor)
    with Machine(build_machine(config, processor=True), config, program) as machine:
        # The machine has already completed its first frame.
        expected = [picture_hash(machine.frame(buttons).picture) for buttons in held]
    page.goto((whole_site / "index.html").as_uri() + "#game")
    page.wait_for_function("RayCaster.state.game?.frames > 2 && RayCaster.state.game.wrong === 0")
    assert "engine span" in page.text_content("#game-text")
    assert page.evaluate(GAME, held) == expected
    assert len(set(expected)) > 10


def engines(page, scene: str, fraction_bits: int) -> dict:
    """Return the state of the tab with both engines once it shows a scene."""
    for select, value in (("scene", scene), ("fraction", str(fraction_bits))):
        page.evaluate("delete RayCaster.state.engines")
        page.select_option(f"#engines-{select}", value)
        state = page_state(page, "engines")
    return state


@pytest.mark.slow_sets("whole")
@pytest.mark.parametrize(
    ("which", "screen", "name", "fraction_bits"), [("site", TINY, "mirror_room", 0), ("whole_site", VGA, "corners", 8)]
)
def test_the_engines_side_by_side(page, request, which, screen, name, fraction_bits):
    """The exact engine draws the shadows, and afterwards a scene without a light; the seed engine refuses the first."""
    page.goto((request.getfixturevalue(which) / "index.html").as_uri() + "#engines")
    page_state(page, "engines")
    reason = SEED.facts.lacks["light"].replace("the seed engine", "it")
    state = engines(page, "evening", fraction_bits)
    # The exact engine of the whole page has the screen of the walk.
    assert state["exact"] == {"hash": golden_hash(packaged("evening"), screen=screen), "wrong": 0}
    assert state["seed"] == {"error": f"The seed engine refuses this scene: {reason}."}
    assert page.locator("#engines-seed").is_hidden()
    state = engines(page, name, fraction_bits)
    scene = packaged(name)
    perfect, rounded = (model.render(scene, screen) for model in (ExactModel(), SeedModel(fraction_bits)))
    assert state["exact"] == {"hash": picture_hash(perfect), "wrong": 0}
    assert state["seed"] == {"hash": picture_hash(rounded), "wrong": 0}
    assert state["differs"] == np.any(perfect != rounded, axis=2).sum() > 0
    assert not page.locator("#engines-seed").is_hidden()


# The monitor ----------------------------------------------------------------------------------------------------------

PARTS = {"blanking": (48, 52, 60), "hs": (47, 88, 120), "vs": (106, 74, 128), "late": (192, 48, 48)}
"""Colours of a raster outside the picture."""


def raster(picture: np.ndarray, screen: Screen) -> np.ndarray:
    """Return what a monitor receives in a frame, from the beginnings of both syncs on."""
    whole = np.empty((screen.vertical.total, screen.horizontal.total, 3), dtype=np.uint8)
    whole[:] = PARTS["blanking"]
    whole[: screen.vertical.sync] = PARTS["vs"]
    whole[:, : screen.horizontal.sync] = PARTS["hs"]
    top, left = (of.sync + of.back for of in (screen.vertical, screen.horizontal))
    shown = picture.repeat(screen.doubling, axis=0).repeat(screen.doubling, axis=1)
    whole[top : top + shown.shape[0], left : left + shown.shape[1]] = shown
    return whole


def monitor(page, scene: str, **wanted: int) -> dict:
    """Return the state of the monitor's tab once it shows a scene, with each count at least as wanted."""
    page.evaluate("delete RayCaster.state.monitor")
    page.select_option("#monitor-scene", scene)
    script = """([scene, wanted]) => {
        const state = RayCaster.state.monitor;
        if (state?.error) return state;
        const reached = Object.entries(wanted).every(([name, least]) => state?.counts[name] >= least);
        return state?.scene === scene && state.wrong !== null && reached && { ...state, raster: state.raster };
    }"""
    return page.wait_for_function(script, arg=[scene, wanted]).json_value()


def test_the_monitor_receives_syncs_and_pictures(page, site):
    """Every clock of a frame is where the timing puts it, also after a scene that is refused and after another one."""
    page.goto((site / "index.html").as_uri() + "#monitor")
    assert "holds 12" in monitor(page, "hall_of_mirrors")["error"]
    horizontal, vertical = TINY.horizontal, TINY.vertical
    for name in ("mirror_room", "boxes"):
        state = monitor(page, name)
        picture = ExactModel().render(packaged(name), TINY)
        assert (state["raster"], state["wrong"]) == (picture_hash(raster(picture, TINY)), 0)
        displayed, hs = horizontal.visible * vertical.visible, horizontal.sync * vertical.total
        vs = vertical.sync * (horizontal.total - horizontal.sync)
        clocks = horizontal.total * vertical.total
        counts = {"clocks": clocks, "lines": vertical.total, "longest": horizontal.total, "displayed": displayed}
        counts |= {"hs": hs, "vs": vs, "blanking": clocks - displayed - hs - vs, "late": 0, "lateRows": 0}
        assert state["counts"] == counts
    assert f"{vertical.total} lines of {horizontal.total}" in page.text_content("#monitor-status")


def test_the_monitor_shows_late_rows(page, site):
    """A design with too few units is late in every row, and the raster shows it in these lines."""
    options = {**PAGE_MODELS["seed-0"], "units": 1, "allow_underrun": True}
    wasm = machine_wasm(configure(**options), taps=True, build=BUILD)
    page.goto((site / "index.html").as_uri() + "#monitor")
    page.evaluate("RayCaster.model('seed-0')")
    model = packed(wasm.read_bytes())
    page.evaluate("(wasm) => (RayCaster.models['seed-0'] = { ...RayCaster.models['seed-0'], wasm }, 0)", model)
    page.select_option("#monitor-engine", "seed")
    state = monitor(page, "boxes", lateRows=TINY.rows)
    assert state["counts"]["lateRows"] == TINY.rows and state["wrong"] > 0
    assert state["counts"]["late"] == state["counts"]["displayed"]
    place = [TINY.horizontal.sync + 2, TINY.vertical.sync + TINY.vertical.back - 2]
    script = "([x, y]) => [...find('monitor-raster').getContext('2d').getImageData(x, y, 1, 3).data]"
    above, _, beside = zip(*[iter(page.evaluate(script, place))] * 4, strict=True)
    assert (above[:3], beside[:3]) == (PARTS["blanking"], PARTS["late"])
