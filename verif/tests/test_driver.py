# SPDX-License-Identifier: MIT
"""The C driver on the register model: the words it writes, the calls it refuses, and its error texts."""

from __future__ import annotations

import ctypes
import re
import shutil
import subprocess
from importlib.metadata import version
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT, plant
from generated import examples, options
from host_software import (
    CONFIG,
    DRIVER_HEADER,
    TYPES,
    Device,
    Error,
    RayCaster,
    Registers,
    compile_library,
    enumeration,
    members,
)
from hypothesis import given, reject
from tcl import compare_calls, tcl_calls

from raycaster.configuration import ConfigurationError
from raycaster.convert.take_home import TOP
from raycaster.design.decide import configure
from raycaster.golden.engines import model_of
from raycaster.golden.world import Rectangles
from raycaster.registers import register_map
from raycaster.rtl.engines import ENGINES, EXACT
from raycaster.scene import PATTERNS, UNTURNED, Camera, load_scene
from raycaster.sim.register_model import EVERY_LANE, Request, SceneFollower
from raycaster.sw.firmware import SOFTWARE, STRICT
from raycaster.verif.random_scenes import random_scene
from raycaster.verif.seeds import seed

MAP = register_map(CONFIG.rectangles)
EVERYTHING = configure(engine="exact", screen="tiny", **dict.fromkeys(EXACT.facts.features, True))
"""Design with all features that scenes may need."""

LARGE = configure(engine="exact", screen="tiny", units=64, rectangles=32)
RESERVED_CODE = 2
"""Code in the register `engine` that stands for no engine any more, and never for another one."""

WHITE, ORIGIN = (255, 255, 255), (0, 0, 0)
OUTSIDE = [tuple(np.roll((value, 0, 0), axis).tolist()) for axis in range(3) for value in (512, 0xFFFF)]
PAGE = ROOT / "docs" / "integration.md"


@pytest.fixture(scope="module")
def library(tmp_path_factory) -> ctypes.CDLL:
    return compile_library(tmp_path_factory.mktemp("driver"), "raycaster.c")


@pytest.fixture
def device(library) -> Device:
    return Device(library, Registers(CONFIG))


@examples(40)
@given(options())
def test_probe_reads_the_configuration(library, chosen):
    try:
        config = configure(**chosen)
    except ConfigurationError:
        reject()
    found = Device(library, Registers(config)).handle
    version = MAP["version"].fields
    expected = {
        "major": version["major"].reset, "minor": int(config.rectangles > 63), "engine": config.facts.code,
        "built_in": 0, "nearest": config.rounding == "nearest",
    }  # fmt: skip
    for name, _ in found._fields_[1:]:
        assert getattr(found, name) == expected.get(name, getattr(config, name, None)), (name, config)


def test_the_header_names_every_engine_and_pattern():
    engines, patterns = enumeration("raycaster_engine"), enumeration("raycaster_pattern")
    codes = {name.upper(): one.facts.code for name, one in ENGINES.items()}
    assert {one.name: one.value for one in engines} == codes
    assert RESERVED_CODE not in codes.values()
    assert [*patterns.__members__] == [name.upper() for name in PATTERNS]


@pytest.mark.parametrize(
    ("register", "fields", "expected"),
    [
        ("id", {"magic": 0}, Error.NOT_FOUND),
        ("id", {"magic": 0xFFFFFFFF}, Error.NOT_FOUND),
        ("version", {"major": 2}, Error.OTHER_VERSION),
        ("version", {"minor": 77}, Error.OK),
    ],
)
def test_probe_refuses_others(library, register, fields, expected):
    device = Device(library, Registers(CONFIG, **{register: fields}))
    assert device.found == expected
    assert not device.registers.written


@pytest.mark.parametrize("language", ["c", "python"])
def test_the_programs_of_the_page(language, tmp_path):
    """Unchanged, the page's programs draw the same picture of their rectangle as the golden model."""
    scene = tmp_path / "scene.toml"
    scene.write_text(
        '[camera]\nposition = [20, 250, 40]\n[[rect]]\ncorners = [[300, 60, 0], [300, 400, 180]]\ncolour = "#50a0ff"\n'
    )
    program, *_ = re.findall(rf"^```{language}\n(.*?)^```", PAGE.read_text(), re.M | re.S)
    assert len(program.splitlines()) <= 23
    model = Registers(CONFIG)
    model.polls_to_frame = 3
    if language == "c":
        (tmp_path / "main.c").write_text(program)
        library = compile_library(tmp_path, "raycaster.c", tmp_path / "main.c")
        assert Device(library, model).call("main") == 0
    else:
        names: dict = {}
        exec(program.replace("0x40000000", "0"), names)
        names["draw"](scene, model.read, model.write)
        with pytest.raises(OSError, match="no ray tracer"):
            names["draw"](scene, lambda address: 0, model.write)
    live = model.file.live
    assert live.run
    golden, screen = model_of(CONFIG), configure(engine="exact").screen_geometry
    shown = live.picture(golden, screen)
    assert np.unique(shown.reshape(-1, 3), axis=0).shape[0] > 1
    np.testing.assert_array_equal(shown, golden.render(load_scene(scene), screen, 1))


@pytest.mark.parametrize("config", [CONFIG, EVERYTHING, LARGE], ids=lambda config: config.name)
def test_any_scene_is_shown(library, config):
    """Random scenes, drawn one after another, become live whole and unchanged; new rectangles have default looks."""
    device = Device(library, Registers(config))
    for number in range(24):
        scene = random_scene(100 * seed() + number, config.rectangles, 1, config.features)
        device.set_background(scene.background)
        device.set_camera(scene.camera.position)
        if config.turn:
            device.set_basis(scene.camera.basis)
        if scene.light:
            device.set_light(scene.light.position, scene.light.quarters)
        for index, one in enumerate(scene.rect):
            device.set_rectangle(index, *one.corners, one.colour)
            if config.materials:
                device.set_mirror(index, one.quarters)
            if one.kind:
                device.set_pattern(index, one.kind, one.cell, one.colour2)
        for index in range(len(scene.rect), config.rectangles):
            device.enable_rectangle(index, False)
        device.set_run(True)
        device.set_reflections(scene.reflections)
        assert device.errors == []
        live = device.shown()
        assert (live.run, live.reflections, live.background) == (True, scene.reflections, scene.background)
        assert (live.camera, live.basis) == (scene.camera.position, scene.camera.basis)
        if scene.light:
            assert live.light == scene.light
            assert device.clear_light() == Error.OK
        assert device.shown().light is None
        shown, wanted = live.rectangles, Rectangles.of_scene(scene)
        used, patterned = slice(len(wanted)), np.flatnonzero(wanted.kinds)
        assert shown.enabled.sum() == len(wanted)
        for name in ("enabled", "corners", "colours", "mirrors", "kinds"):
            np.testing.assert_array_equal(getattr(shown, name)[used], getattr(wanted, name))
        for name in ("cells", "colours_2"):
            np.testing.assert_array_equal(getattr(shown, name)[patterned], getattr(wanted, name)[patterned])


def test_the_last_clock_of_a_commit():
    """Followers of writes agree with the model of the registers, which is compared with the hardware."""
    control = MAP["control"]
    word, found = control.pack(run=1, commit=1), []
    for clock in range(6):
        model, follower = Registers(CONFIG).file, SceneFollower(CONFIG)
        model.clock(False, None)
        model.clocks = model.start_screen_clock - clock
        for request in (Request(control.address, word), *[None] * clock):
            model.clock(False, request)
        follower.write(0, control.address, word, EVERY_LANE)
        follower.start_screen(clock)
        assert follower.live.run == model.live.run
        found.append(model.live.run)
    assert set(found) == {False, True}


OF_A_RECTANGLE = {
    "set_rectangle": (0, ORIGIN, ORIGIN, WHITE), "enable_rectangle": (0, True), "set_mirror": (0, 1),
    "set_pattern": (0, 1, 8, WHITE),
}  # fmt: skip
OF_LOOKS = {"set_basis": (UNTURNED,), "set_light": ((1, 2, 3), 2), "clear_light": ()}
CALLS = OF_A_RECTANGLE | OF_LOOKS | {"set_camera": (ORIGIN,), "set_background": (WHITE,), "set_reflections": (1,)}
"""Valid arguments by function."""


@pytest.mark.parametrize(
    ("config", "built_in", "error", "refused"),
    [
        (CONFIG, 0, Error.NOT_IN_HARDWARE, {"set_mirror", "set_pattern", *OF_LOOKS}),
        (EVERYTHING, 0, Error.OK, set()),
        (EVERYTHING, 1, Error.FIXED, {*OF_A_RECTANGLE}),
        (EVERYTHING, 2, Error.FIXED, {*CALLS}),
    ],
)
def test_parts_that_cannot_be_set(library, config, built_in, error, refused):
    """They are not in the hardware, or built into it; nothing is written."""
    said = {"engine": {"fixed": built_in}, "size": {"rectangles": 0}} if built_in else {}
    for function, arguments in CALLS.items():
        device = Device(library, Registers(config, **said))
        expected = error if function in refused else Error.OK
        assert getattr(device, function)(*arguments) == expected, function
        assert bool(device.registers.written) == (expected == Error.OK)


REFUSED = [
    *(
        (Error.NO_SUCH_RECTANGLE, function, index, *arguments)
        for function, (_, *arguments) in OF_A_RECTANGLE.items()
        for index in (12, 0xFFFFFFFF)
    ),
    *(
        (Error.OUTSIDE_WORLD, *call)
        for place in OUTSIDE
        for call in (
            ("set_rectangle", 0, place, ORIGIN, WHITE), ("set_rectangle", 0, ORIGIN, place, WHITE),
            ("set_rectangle", 0, place, place, WHITE), ("set_camera", place), ("set_light", place, 0),
        )
    ),
    *(
        (Error.OUTSIDE_WORLD, "set_basis", tuple(map(tuple, np.roll([part] + 8 * [0], at).reshape(3, 3).tolist())))
        for at in range(9)
        for part in (512, -513)
    ),
    (Error.NO_PLANE, "set_rectangle", 0, (0, 1, 2), (1, 2, 3), WHITE),
    *((Error.NO_SUCH_LOOK, "set_mirror", 0, quarters) for quarters in (5, 8, 0xFFFFFFFF)),
    *((Error.NO_SUCH_LOOK, "set_pattern", 0, kind, 32, WHITE) for kind in (len(PATTERNS), 0xFFFFFFFF)),
    *((Error.NO_SUCH_LOOK, "set_pattern", 0, 1, cell, WHITE) for cell in (0, 4, 12, 257, 512, 0x80000000)),
    (Error.NO_SUCH_LOOK, "set_light", ORIGIN, 4),
    (Error.TOO_MANY_REFLECTIONS, "set_reflections", 2),
]  # fmt: skip
"""Errors of functions with wrong arguments."""


def test_wrong_arguments(library):
    """The call is refused, and nothing is written."""
    device = Device(library, Registers(EVERYTHING))
    for error, function, *arguments in REFUSED:
        assert getattr(device, function)(*arguments) == error, (function, arguments)
    assert not device.registers.written


def test_a_rectangle_is_left_out_and_shown_again(library):
    """It keeps its contents and looks. A point and the ends of the table are accepted."""
    device = Device(library, Registers(EVERYTHING))
    for index, corners in ((0, ((7, 8, 9), (7, 8, 9))), (11, ((1, 2, 3), (1, 20, 511)))):
        device.set_rectangle(index, *corners, (1, 2, 3))
        device.set_mirror(index, 3)
        device.set_pattern(index, 3, 16, WHITE)
        for enable in (False, True):
            device.enable_rectangle(index, enable)
            live = device.shown().rectangles
            assert live.enabled[index] == enable
            assert live.corners[index].tolist() == [list(corner) for corner in corners]
            assert live.colours[index].tolist() == [1, 2, 3]
            assert (live.mirrors[index], live.kinds[index], live.cells[index]) == (3, 3, 16)
    assert device.errors == []


def test_the_longest_vectors(library):
    basis = ((-512, 511, 511), (1, -1, 256), (511, -512, -512))
    device = Device(library, Registers(EVERYTHING))
    assert device.shown().basis == UNTURNED
    assert device.set_basis(basis) == Error.OK
    assert device.shown().basis == basis


def test_angles_match_those_of_scenes(library, random):
    """Any angle with selected values of the other two, and random triples, give the same basis as in scenes."""
    some = [*range(-360, 361, 45), -37, 1, 89]
    angles = [(one, other, third) for one in range(-360, 361) for other in some[::2] for third in some[::3]]
    angles += [(third, one, other) for one, other, third in angles]
    angles = [angles[index] for index in random.permutation(len(angles))[:6000]]
    angles += random.integers(-360, 361, (12000, 3)).tolist()
    for yaw, pitch, roll in angles:
        wanted = Camera(position=(0, 0, 0), yaw=yaw, pitch=pitch, roll=roll).basis
        assert members(library.raycaster_turned(yaw, pitch, roll)) == wanted, (yaw, pitch, roll)


def test_angles_of_any_size(library):
    def of(*angles: int) -> tuple:
        return members(library.raycaster_turned(*angles))

    for turns in (-5, 7, 5_000_000):
        assert of(30 + 360 * turns, -20, 77 - 360 * turns) == of(30, -20, 77)
    extreme = Camera(position=(0, 0, 0), yaw=(2**31 - 1) % 360, pitch=2**31 % 360 * -1.0)
    assert of(2**31 - 1, -(2**31), 0) == extreme.basis


def test_a_commit_waits_for_the_one_before(device):
    device.set_run(True)
    assert device.commit() == Error.OK
    assert device.is_committing()
    # Changes from now on belong to the next commit and must not trigger one.
    device.set_reflections(1)
    device.set_camera((1, 2, 3))
    assert device.errors == []
    written = len(device.registers.written)
    assert device.commit() == Error.STILL_COMMITTING
    assert len(device.registers.written) == written
    live = device.registers.start_screen()
    assert (live.run, live.reflections, live.camera) == (True, 0, (0, 0, 0))
    assert not device.is_committing()
    live = device.shown()
    assert (live.run, live.reflections, live.camera) == (True, 1, (1, 2, 3))
    device.set_run(False)
    live = device.shown()
    assert (live.run, live.reflections) == (False, 1)


def test_waiting_for_a_frame(device):
    device.registers.polls_to_frame = 10
    assert device.wait_frame(9) == Error.NO_FRAME
    assert device.frame() == 0
    assert device.wait_frame(9) == Error.OK
    assert device.frame() == 1
    # Each frame counts once, even if it came before the wait.
    assert device.wait_frame(100) == Error.NO_FRAME
    device.registers.start_screen()
    assert device.wait_frame(1) == Error.OK
    assert device.wait_frame(0) == Error.NO_FRAME


def test_the_interrupt(device):
    agent = device.registers.file.agent
    device.enable_interrupt(True)
    device.registers.start_screen()
    assert agent.irq_enable and agent.irq_pending
    assert device.acknowledge()
    assert agent.irq_enable and not agent.irq_pending
    assert not device.acknowledge()
    device.enable_interrupt(False)
    assert not agent.irq_enable


def test_sticky_errors(device):
    assert device.check() == Error.OK
    # Bypass the driver, which would refuse the rectangle.
    corner = MAP["rectangle[3].corner_0"]
    device.registers.write(4 * corner.address, corner.pack(x=1, y=2, z=3))
    assert device.enable_rectangle(3, True) == Error.OK
    assert device.commit() == Error.OK
    assert device.check() == Error.BAD_RECTANGLE
    device.registers.file.agent.underrun = True
    assert device.check() == Error.UNDERRUN
    for _ in range(3):
        device.registers.start_screen()
    assert members(device.get_status()) == (3, False, True, True)
    device.clear_status()
    assert device.check() == Error.OK
    assert members(device.get_status()) == (3, False, False, False)


def test_cycles(device):
    device.registers.file.agent.row, device.registers.file.agent.group = 1234, 321
    for expected in ((1234, 321), (0, 0)):
        assert members(device.get_cycles()) == expected
        device.clear_cycles()


def test_every_error_has_its_own_text(library):
    texts = [library.raycaster_error_text(number).decode() for number in range(len(Error) + 1)]
    # Words from the header's names and comments.
    words = {
        "OK": "no error", "NOT_FOUND": "address", "OTHER_VERSION": "version", "NO_SUCH_RECTANGLE": "table",
        "OUTSIDE_WORLD": "511", "NO_PLANE": "share", "TOO_MANY_REFLECTIONS": "reflections", "FIXED": "built",
        "STILL_COMMITTING": "live", "NO_FRAME": "frame", "UNDERRUN": "row", "BAD_RECTANGLE": "plane",
        "NOT_IN_HARDWARE": "generated", "NO_SUCH_LOOK": "pattern",
    }  # fmt: skip
    for error in Error:
        assert [text for text in texts if words[error.name] in text] == [texts[error]]
    assert texts[-1] == "unknown error"
    assert not any(text.endswith(".") for text in texts)


NIOS_IO = """
#include <stdint.h>
#define NIOS_WORD(base, offset) \\
    (*(volatile uint32_t *)((volatile char *)(base) + ((uint32_t)(offset) <= 252 ? (uint32_t)(offset) : 252)))
#define IORD_32DIRECT(base, offset) (~NIOS_WORD(base, offset))
#define IOWR_32DIRECT(base, offset, word) (NIOS_WORD(base, offset) = ~(uint32_t)(word))
"""
"""Stand-in for the Nios II's `io.h`: byte offsets, and its registers appear inverted to everything but these macros."""


def check_access(directory: Path, nios: bool, *flags: str, driver: Path = SOFTWARE) -> None:
    """Let the driver probe registers in a memory with its own register access, and write one, without any library."""
    (directory / "io.h").write_text(NIOS_IO)
    flags = (*flags, "-ffreestanding", "-nostdlib", "-Wl,-z,defs", f"-I{directory}", *["-D__nios2__"] * nios)
    library = compile_library(directory, driver / "raycaster.c", flags=flags)
    seen_as = 0xFFFFFFFF if nios else 0
    memory = (ctypes.c_uint32 * 64)(*[seen_as] * 64)
    for name in ("id", "version"):
        memory[MAP[name].address] = MAP[name].reset ^ seen_as
    memory[MAP["size"].address] = MAP["size"].pack(units=4, rectangles=12, rows=240) ^ seen_as
    memory[MAP["status"].address] = MAP["status"].pack(frame=777, busy=1) ^ seen_as
    before = list(memory)
    device = RayCaster()
    assert library.raycaster_probe(device, memory) == Error.OK
    assert (device.units, device.rectangles, device.rows) == (4, 12, 240)
    assert members(library.raycaster_get_status(device)) == (777, True, False, False)
    assert library.raycaster_set_camera(device, TYPES["raycaster_point"](1, 2, 3)) == Error.OK
    changed = {address: word ^ seen_as for address, word in enumerate(memory) if word != before[address]}
    assert changed == {MAP["camera"].address: MAP["camera"].pack(x=1, y=2, z=3)}


@pytest.mark.parametrize("nios", [False, True], ids=["plain", "nios"])
@pytest.mark.parametrize("standard", ["c99", "c11"])
@pytest.mark.parametrize("level", ["-O0", "-Os", "-O2"])
def test_own_access_and_no_library(tmp_path, standard, level, nios):
    check_access(tmp_path, nios, f"-std={standard}", level)


@pytest.mark.parametrize(
    ("nios", "right", "wrong"),
    [
        (True, "IOWR_32DIRECT(base, offset, word)", "IOWR_32DIRECT(base, word, offset)"),
        (True, "IORD_32DIRECT(base, offset)", "IORD_32DIRECT(base, (offset) / 4)"),
        (True, "#ifdef __nios2__", "#ifdef __nios__"),
        (False, "((base)[(offset) / 4] = (word))", "((base)[offset] = (word))"),
        (False, "((base)[(offset) / 4])", "((base)[(offset) / 2])"),
    ],
)
def test_a_fault_in_the_access_is_noticed(tmp_path, nios, right, wrong):
    for path in SOFTWARE.glob("raycaster*.[ch]"):
        shutil.copy(path, tmp_path)
    plant(tmp_path / DRIVER_HEADER.name, right, wrong)
    with pytest.raises(AssertionError):
        check_access(tmp_path, nios, driver=tmp_path)


def test_a_cpp_program_calls_the_driver(tmp_path):
    program = '#include "raycaster.h"\nint main() { raycaster device; return raycaster_probe(&device, nullptr); }\n'
    sources = ("-x", "c++", "-", "-x", "c", SOFTWARE / "raycaster.c")
    command = ["g++", *STRICT[1:], f"-I{SOFTWARE}", "-o", tmp_path / "program", *sources]
    subprocess.run(command, input=program, text=True, check=True)


def test_the_driver_for_nios(tmp_path):
    """The description has the commands that were reviewed, and names existing files and the component."""
    calls = tcl_calls(tmp_path, SOFTWARE / "raycaster_sw.tcl")
    compare_calls("raycaster_sw", calls)
    properties = {call[1]: call[2] for call in calls if call[0] == "set_sw_property"}
    assert properties["hw_class_name"] == TOP
    least, present = properties["min_compatible_hw_version"].split("."), version("raycaster").split(".")
    assert int(least[0]) == MAP["version"].fields["major"].reset
    assert [*map(int, least)] <= [*map(int, present)]
    files = {call[2] for call in calls if call[1] in ("c_source", "include_source")}
    assert files == {path.name for path in SOFTWARE.glob("*.[ch]")}
