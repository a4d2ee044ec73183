# SPDX-License-Identifier: MIT
"""The page's room in Chromium: drawn by the hardware while it is edited."""

from __future__ import annotations

import re
import tomllib
from dataclasses import replace
from typing import Any

import pytest
from conftest import PAGE_MODELS, page_state
from test_web import golden_hash

from raycaster.configuration import FEATURES, Configuration
from raycaster.design.decide import configure
from raycaster.fpga.area import ROOM_DESIGNS
from raycaster.golden.frames import scene_cycles
from raycaster.program import scene_words
from raycaster.registers import register_map
from raycaster.rtl.bus.avalon_interface import engine_word, size_word, table_word, version_word
from raycaster.runs.outcomes import RESULTS, kept_outcome, kept_outcomes
from raycaster.scene import Scene, load_scene, packaged_scenes
from raycaster.serial_frames import LEAD, access, framed, writes

CONFIG = configure(**PAGE_MODELS["plain"])
SCREEN = CONFIG.screen_geometry
GRID = 8
FRONT = 'name = "brick house, front"\ncorners = [[150, 60, 0], [150, 180, 110]]'
PHONES = [(390, 844), (844, 390)]
DROP = """async ([name, source]) => {
    const data = new DataTransfer();
    data.items.add(new File([source], name));
    find("room-text").dispatchEvent(new DragEvent("drop", { dataTransfer: data, bubbles: true }));
}"""


def open_room(page: Any, address: str) -> dict:
    """Open the page and return the state of the room once its picture is checked."""
    page.goto(address)
    return checked(page)


def checked(page: Any) -> dict:
    """Return the state of the room once the present text is drawn and its picture checked."""
    drawn = "state && state.version === RayCaster.room.version && state.wrong !== null && state.wrong !== undefined"
    page.wait_for_function(f"(() => {{ const state = RayCaster.state.room; return {drawn}; }})()")
    return page.evaluate("RayCaster.state.room")


@pytest.fixture
def room(page, site):
    """Return the page, which shows a room."""
    page.set_viewport_size({"width": 1280, "height": 800})
    open_room(page, (site / "index.html").as_uri())
    return page


def choose(page: Any, name: str) -> str:
    """Choose a packaged scene; return its text."""
    page.click(f"#room-gallery [data-scene={name}]")
    return packaged_scenes()[name].read_text()


def text_of(page: Any) -> str:
    return page.input_value("#room-text")


def scene_of(text: str) -> Scene:
    return Scene.model_validate(tomllib.loads(text))


def assert_drawn(page: Any) -> None:
    """Assert that the picture is that of the text, and that all comparisons so far found no difference."""
    state, golden = checked(page), golden_hash(scene_of(text_of(page)), screen=SCREEN)
    assert (state["hash"], state["wrong"], state["different"]) == (golden, 0, 0)


def drag(page: Any, grip: str, plan: str, across: float, up: float) -> None:
    """Drag a part of a plan by world units."""
    # In one call, as the plan is drawn again with each frame.
    script = """([grip, plan]) => {
        const [part] = [...find(`room-${plan}`).querySelectorAll(`[data-grip="${grip}"]`)].slice(-1);
        const box = part.getBoundingClientRect(), world = find(`room-${plan}`).querySelector(".world");
        return [box.x + box.width / 2, box.y + box.height / 2, world.getBoundingClientRect().width / 511];
    }"""
    x, y, unit = page.evaluate(script, [grip, plan])
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + unit * across / 2, y - unit * up / 2)
    page.mouse.move(x + unit * across, y - unit * up)
    page.mouse.up()


def test_a_wall_is_dragged(room):
    """The text and the picture follow, and undo and redo step through both."""
    text = choose(room, "evening")
    assert_drawn(room)
    room.select_option("#room-rect", "1")
    drag(room, "body 1", "above", 42, -16)
    corners = scene_of(text_of(room)).rect[1].corners
    assert corners == ((136, 104, 0), (136, 224, 110)), "snapped to the grid"
    assert text_of(room) == text.replace("[[150, 60, 0], [150, 180, 110]]", "[[136, 104, 0], [136, 224, 110]]")
    assert_drawn(room)
    drag(room, "corner 1 1 -1", "above", 24, 0)
    assert scene_of(text_of(room)).rect[1].corners == ((136, 104, 0), (136, 248, 110))
    drag(room, "camera", "above", 32, 16)
    drag(room, "light", "side", 62, 10)
    moved = scene_of(text_of(room))
    assert moved.camera.position == (16, 280, 230) and moved.light and moved.light.position == (80, 0, 272)
    assert_drawn(room)
    for _ in range(4):
        room.keyboard.press("Control+z")
    assert text_of(room) == text
    assert_drawn(room)
    assert room.locator("#room-undo").is_enabled(), "the scene before"
    for _ in range(4):
        room.click("#room-redo")
    assert scene_of(text_of(room)) == moved


def test_rectangles_come_and_go(room):
    choose(room, "boxes")
    count = len(scene_of(text_of(room)).rect)
    room.click("#room-add")
    room.select_option("#room-mirror", "0.75")
    room.select_option("#room-pattern", "rows")
    room.select_option("#room-cell", "256")
    room.fill("#room-colour", "#123456")
    room.fill("#room-corner-0-z", "40")
    room.fill("#room-label", 'a "shelf"')
    added = scene_of(text_of(room)).rect[count]
    assert (added.name, added.mirror, added.pattern, added.colour) == ('a "shelf"', 0.75, "rows", (18, 52, 86))
    assert added.corners[0][2] == 40
    room.click("#room-duplicate")
    assert scene_of(text_of(room)).rect[-2:] == (added, added)
    room.select_option("#room-pattern", "plain")
    room.click("#room-box")
    room.click("#room-light")
    room.select_option("#room-reflections", "3")
    assert_drawn(room)
    assert checked(room)["model"] == "full"
    room.select_option("#room-rect", str(count))
    room.click("#room-remove")
    assert len(scene_of(text_of(room)).rect) == count + 7
    assert_drawn(room)


def test_text_says_its_line(room):
    text = choose(room, "evening")
    for bad, line in ((text.replace("colour = ", "color = ", 1), 18), (text.replace("[light]", "[light"), 11)):
        room.fill("#room-text", bad)
        assert room.text_content("#room-lines .wrong").strip() == str(line)
        assert room.text_content("#room-error").startswith("evening.toml: ")
    # The last correct room stays, and goes on with the next correct text.
    room.fill("#room-text", text.replace("[150, 180, 110]", "[150, 180, 200]"))
    assert room.text_content("#room-error") == ""
    assert_drawn(room)


def test_a_link_and_a_file(room, site):
    """The address holds the room, and a dropped file replaces it."""
    own = choose(room, "evening").replace("#e8a87c", "#28a87c") + "# Grüße\n"
    room.fill("#room-text", own)
    room.wait_for_function("location.hash.startsWith('#room=')")
    address = room.url
    room.goto("about:blank")
    open_room(room, address)
    assert text_of(room) == own
    assert_drawn(room)
    room.click("#room-link")
    room.wait_for_function("find('room-said').textContent.startsWith('The link is')")
    other = packaged_scenes()["boxes"].read_text()
    room.evaluate(DROP, ["mine.toml", other])
    room.wait_for_function("find('room-name').textContent === 'mine.toml'")
    assert text_of(room) == other
    assert_drawn(room)
    with room.expect_download() as download:
        room.click("#room-save")
    assert download.value.suggested_filename == "mine.toml" and download.value.path().read_bytes() == other.encode()


def test_every_packaged_scene_keeps_its_text(room):
    """Values that are written again do not change a byte."""
    script = """(texts) => texts.map((text) => {
        const { scene } = RayCasterScene.read(text, "scene", RayCaster.schema);
        let written = RayCasterText.set(text, "camera", 0, "position", scene.camera.position);
        scene.rect.forEach(({ corners }, index) =>
            (written = RayCasterText.set(written, "rect", index, "corners", corners)));
        return written;
    })"""
    texts = [path.read_text() for path in packaged_scenes().values()]
    assert room.evaluate(script, texts) == texts


def test_a_click_finds_the_line(room):
    text = choose(room, "evening")
    checked(room)
    box = room.locator("#room-picture").bounding_box()
    room.mouse.click(box["x"] + box["width"] * 0.5, box["y"] + box["height"] * 0.97)
    room.wait_for_function("RayCaster.room.selected >= 0")
    selected = room.evaluate("RayCaster.room.selected")
    line = text[: text.index(f'name = "{scene_of(text).rect[selected].name}"')].count("\n")
    assert room.text_content("#room-lines .chosen >> nth=0").strip() == str(line)


def test_keys_walk(room):
    """After a click on a scene, and with a menu or a colour chosen, letters walk; in the text they are letters."""
    start = choose(room, "boxes") and scene_of(text_of(room)).camera.position
    room.select_option("#room-grid", "16")
    for far, field in ((20, "#room-grid"), (40, "#room-background")):
        room.focus(field)
        room.keyboard.down("w")
        room.wait_for_function(f"RayCaster.state.room.camera.position[0] > {start[0] + far}")
        room.keyboard.up("w")
    assert room.input_value("#room-grid") == "16"
    room.click("#room-camera")
    copied = room.evaluate("RayCaster.state.room.camera.position")
    assert list(scene_of(text_of(room)).camera.position) == copied
    assert_drawn(room)
    room.focus("#room-text")
    room.keyboard.press("w")
    assert room.text_content("#room-error") != ""
    assert room.evaluate("RayCaster.state.room.camera.position") == copied


def test_clocks_are_the_hardware_s(room):
    choose(room, "boxes")
    state, scene = checked(room), load_scene(packaged_scenes()["boxes"])
    assert state["model"] == "plain"
    assert state["clocks"] == scene_cycles(scene, CONFIG)
    cost = room.text_content("#room-cost")
    assert f"{25e6 / state['clocks']:.0f} at 25 MHz" in cost
    kept = kept_outcome(RESULTS / "features.json").figures["designs"]
    [cells] = [row for row in kept if row["engine"] == "span" and row["options"] == ROOM_DESIGNS["plain"]]
    assert f"{cells['tables']:,} look-up tables" in cost
    assert "Boards with room for it and for this frame: Colorlight i9, " in cost


def test_the_boards_that_were_routed(room):
    """The table has the designs that can draw the room from this camera, each with its cells and its clock."""
    kept = [one.figures for one in kept_outcomes(RESULTS / "bitstreams.json")]
    ices = {one["reflections"]: one for one in kept if one.get("board") == "icebreaker"}

    def line(one: dict) -> str:
        used, there = one["cells"][one["kinds"]["logic"]]
        reached, needed = one["clocks"]["clk"]
        return f"{used:,} of {there:,}{reached:.1f}{needed:.1f}"

    choose(room, "boxes")
    checked(room)
    text = room.text_content("#room-routed")
    assert "iCEBreaker with its 12-bit DVI Pmod320 x 24016,384" + line(ices[1]) in text and line(ices[0]) not in text
    choose(room, "matte")
    checked(room)
    assert "Pmod, serial port320 x 24016,384" + line(ices[0]) in room.text_content("#room-routed")
    room.focus("#room-picture")
    room.keyboard.down("ArrowLeft")
    room.wait_for_function("!find('room-routed').textContent.includes('iCEBreaker')")
    room.keyboard.up("ArrowLeft")
    turned = [line(one) for one in kept if "board" in one and "-turn-materials" in one["configuration"]]
    text = room.text_content("#room-routed")
    assert turned and all(one in text for one in turned)
    # A list that is too short for the frame.
    rows = "routedTable({ ...RayCaster.state.room, runs: %d }, RayCaster.room.scene).querySelectorAll('td').length"
    lists = [re.search(r"-l(\d+)-", one["configuration"]) for one in kept if "board" in one]
    most = max(int(found[1]) for found in lists if found)
    assert room.evaluate(rows % most) and not room.evaluate(rows % (most + 1))


def test_a_planted_pixel_is_counted(room):
    room.check("#room-plant")
    room.wait_for_function("RayCaster.state.room.wrong === 1")
    assert "different: 1." in room.text_content("#room-compared.wrong")
    pixel = "find('room-picture').getContext('2d').getImageData(40, 30, 1, 1).data"
    room.wait_for_function(f"[...{pixel}].join() === '255,0,255,255'")


@pytest.mark.parametrize("size", PHONES, ids=lambda size: f"{size[0]}x{size[1]}")
def test_a_phone(browser, site, size):
    """Nothing is wider than the screen, and a thumb walks and looks around."""
    width, height = size
    context = browser.context.browser.new_context(
        viewport={"width": width, "height": height}, has_touch=True, is_mobile=True
    )
    with context:
        page = context.new_page()
        page.set_default_timeout(60_000)
        start = open_room(page, (site / "index.html").as_uri())["camera"]
        assert page.evaluate("document.documentElement.scrollWidth") <= width
        picture = page.locator("#room-picture").bounding_box()
        assert picture["height"] > 200 and picture["y"] + picture["height"] <= height
        forward = page.locator("#room-pad button", has_text="forward")
        assert forward.bounding_box()["y"] < height
        forward.dispatch_event("pointerdown")
        page.wait_for_function(f"RayCaster.state.room.camera.position[0] > {start['position'][0] + 10}")
        forward.dispatch_event("pointerup")
        page.wait_for_function("RayCaster.state.room.wrong === 0")


def test_other_tabs_take_the_room(room):
    """The engines' tab draws the room as it is, again when it has changed."""
    room.fill("#room-text", choose(room, "boxes").replace("title", "# Mine\ntitle"))
    room.click("#tab-engines")
    state = page_state(room, "engines")
    assert room.input_value("#engines-scene") == "your room"
    tiny = configure(**PAGE_MODELS["exact"]).screen_geometry
    assert state["exact"] == {"hash": golden_hash(load_scene(packaged_scenes()["boxes"]), screen=tiny), "wrong": 0}


# A board --------------------------------------------------------------------------------------------------------------

PORT = """(([answers]) => {
    // A port of Web Serial that gives one answer per frame, and keeps what was written.
    let give, count = 0;
    const written = [];
    const readable = new ReadableStream({ start: (controller) => (give = controller) });
    const writable = new WritableStream({ write(bytes) {
        written.push([...bytes]);
        if (answers[count]) give.enqueue(new Uint8Array(answers[count++]));
    } });
    const open = async ({ baudRate }) => (window.boardRate = baudRate), close = async () => (window.boardRate = 0);
    const port = { readable, writable, open, close };
    Object.defineProperty(navigator, "serial", { configurable: true, value: { requestPort: async () => port } });
    window.sentToBoard = written;
})"""
BOARD = configure(engine="span", turn=True, light=True, materials=True, patterns=True, rectangles=128, reflections=4)


def room_bytes(scene: Scene, config: Configuration) -> list[int]:
    return [LEAD, *framed(writes(scene_words(scene, config)))]


def test_the_page_makes_the_same_frames_as_python(room):
    """Every packaged scene, for designs with and without what it needs: the same bytes."""
    script = """([name, design]) => {
        const scene = readScene(RayCaster.scenes[name], name, Infinity);
        return RayCasterBoard.frame(scene, scene.basis, design);
    }"""
    plain = configure(engine="exact", rectangles=32)
    compared = 0
    for chosen in room.evaluate("Object.keys(RayCaster.scenes)"):
        scene = load_scene(packaged_scenes()[chosen])
        for config in (BOARD, plain):
            if len(scene.rect) > config.rectangles:
                continue
            design = {name: getattr(config, name) for name in (*FEATURES, "rectangles")}
            assert bytes(room.evaluate(script, [chosen, design])) == bytes(room_bytes(scene, config)), chosen
            compared += 1
    assert compared > 40


def test_send_to_board(room):
    """The design is read first; then its room is sent in one frame, whose answer is waited for."""
    scene = scene_of(choose(room, "lamplight"))
    checked(room)
    assert room.is_visible("#room-board") == room.evaluate("Boolean(navigator.serial)")
    registers = register_map(*BOARD.map)
    asked = access(0, read=registers["table"].address + 1)

    def described(config: Configuration, **known: int) -> bytes:
        """Return what a design says of itself."""
        words = {"id": registers["id"].reset, "engine": engine_word(config), "size": size_word(config)}
        words |= {"version": version_word(config), "table": table_word(config)} | known
        by_address = {registers[name].address: word for name, word in words.items()}
        return framed([*asked, *(by_address.get(address, 0) for address in range(registers["table"].address + 1))])

    written, cleared = (framed(access(registers[name].address, [0])[:1]) for name in ("control", "frames.status"))

    def found(name: str, **fields: int) -> bytes:
        """Return the answer to a read of a register."""
        return framed([*access(registers[name].address, read=1), registers[name].pack(**fields)])

    full = framed(access(registers["frames.status"].address, [registers["frames.status"].pack(list_full=1)]))
    fixed = engine_word(BOARD) | registers["engine"].fields["fixed"].mask
    live = [written, found("control", commit=1), found("control"), cleared, found("frames.counts", drawn=7)]
    none, drawn = [found("frames.status"), found("frames.counts", drawn=7)], found("frames.counts", drawn=8)
    exact = configure(engine="exact", turn=True, light=True, materials=True, patterns=True)
    for answers, said in (
        (
            [described(BOARD), *live, *none, found("frames.status"), drawn, found("frames.status")],
            "The board shows this room, with the span engine.",
        ),
        (
            [described(BOARD), *live, *none, *[found("frames.status", list_full=1)] * 2],
            "Not sent: a frame of it has more runs than the board's list; build it with a longer LIST",
        ),
        ([described(exact), written], "The board shows this room, with the exact engine."),
        ([described(BOARD, id=1)], "Not sent: what answers is no ray tracer of this version"),
        ([described(BOARD, version=2 << 16)], "Not sent: what answers is no ray tracer of this version"),
        ([described(BOARD, engine=fixed)], "Not sent: the design has a scene built in"),
        (
            [described(replace(BOARD, rectangles=2))],
            f"Not sent: {len(scene.rect)} rectangles, but the board's design holds 2",
        ),
        (
            [described(replace(BOARD, light=False))],
            "Not sent: the board's design has no light; build it with LIGHT=1",
        ),
        (
            [described(replace(BOARD, reflections=0))],
            "Not sent: the room has 1 reflection, but the board's design computes at most 0",
        ),
        ([], "Not sent: no answer at 1000000 baud"),
    ):
        room.evaluate(PORT, [[list(one) for one in answers]])
        room.evaluate("find('room-board').hidden = false")
        room.click("#room-board")
        room.wait_for_function(f"find('room-said').textContent === {said!r}")
        frames, rate = room.evaluate("[window.sentToBoard, window.boardRate]")
        question = [LEAD, *framed(asked)]
        sent = room_bytes(scene, exact if "exact" in said else BOARD)
        assert frames[:2] == ([question] * 2, [question], [question, sent])[min(len(answers), 2)]
        assert len(frames) == max(3 * (not answers), len(answers))
        assert len(frames) < 5 or frames[4] == [LEAD, *full]
        assert rate == 0, "the port is open"
