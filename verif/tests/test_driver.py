# SPDX-License-Identifier: MIT
"""The C driver on the register model: the words it writes, the calls it refuses, and its error texts."""

from __future__ import annotations

import ctypes
import re
import shutil
import subprocess
from itertools import product

import numpy as np
import pytest
from host_software import (
    CONFIG,
    ROOT,
    SOFTWARE,
    STRICT,
    Colour,
    Point,
    RayCaster,
    Registers,
    Turned,
    attached,
    compile_library,
    enumerators,
    probed,
)
from tcl import run_tcl

from raycaster.configuration import configure
from raycaster.convert.take_home import TOP
from raycaster.engines import ENGINES, EXACT
from raycaster.golden.engines import model_of
from raycaster.golden.world import Rectangles
from raycaster.program import scene_words
from raycaster.registers import register_map
from raycaster.scene import PATTERNS, UNTURNED, Camera, Light, load_scene
from raycaster.verif.seeds import repeat, seed

ERRORS = enumerators(SOFTWARE / "raycaster.h", "raycaster_error")
WHITE = Colour(255, 255, 255)
PAGE = ROOT / "docs" / "integration.md"
CONTROL = 4 * register_map(CONFIG.rectangles)["control"].address
COMMIT = register_map(CONFIG.rectangles)["control"].fields["commit"].mask


@pytest.fixture(scope="module")
def library(tmp_path_factory) -> ctypes.CDLL:
    return compile_library(tmp_path_factory.mktemp("driver"), "raycaster.c")


@pytest.fixture
def registers(library):
    model = Registers(CONFIG)
    with attached(library, model):
        yield model


@pytest.fixture
def device(library, registers) -> RayCaster:
    return probed(library)


def error(number: int) -> str:
    return ERRORS[number].removeprefix("RAYCASTER_")


@pytest.mark.parametrize(
    "config",
    [
        CONFIG,
        configure(
            units=16, rectangles=32, reflections=2, rows=200, fraction_bits=5, rounding="nearest", colour_bits=4,
            allow_underrun=True,
        ),
        configure(engine="beam", rectangles=3, rows=180),
        configure(engine="exact", turn=True, patterns=True),
        configure(engine="exact", light=True),
        configure(engine="beam", materials=True),
    ],
    ids=lambda config: config.name,
)  # fmt: skip
def test_probe_reads_the_configuration(library, config):
    with attached(library, Registers(config)):
        found = probed(library)
    for name in (
        "units", "rows", "rectangles", "reflections", "scale", "fraction_bits", "divider_bits", "colour_bits", "turn",
        "materials", "patterns", "light",
    ):  # fmt: skip
        assert getattr(found, name) == getattr(config, name), name
    assert found.engine == config.facts.code
    assert found.nearest == (config.rounding == "nearest")
    version = register_map(config.rectangles)["version"].fields
    assert (found.major, found.minor) == (version["major"].reset, version["minor"].reset)
    assert found.built_in == 0


def test_the_header_names_every_engine_and_pattern():
    engines, patterns = (enumerators(SOFTWARE / "raycaster.h", f"raycaster_{what}") for what in ("engine", "pattern"))
    assert dict(enumerate(engines)) == {engine.code: f"RAYCASTER_{name.upper()}" for name, engine in ENGINES.items()}
    assert patterns == [f"RAYCASTER_{name.upper()}" for name in PATTERNS]


@pytest.mark.parametrize(
    ("register", "fields", "expected"),
    [
        ("id", {"magic": 0}, "NOT_FOUND"),
        ("id", {"magic": 0xFFFFFFFF}, "NOT_FOUND"),
        ("version", {"major": 1}, "OTHER_VERSION"),
        ("version", {"minor": 77}, "OK"),
    ],
)
def test_probe_refuses_others(library, registers, register, fields, expected):
    registers.say(register, **fields)
    assert error(library.raycaster_probe(ctypes.byref(RayCaster()), None)) == expected
    assert not registers.written


class ShownWhenPolled(Registers):
    """A register model that makes a commit live while software polls for it."""

    live = None

    def read(self, offset: int) -> int:
        if self.live is None and self.written and offset == CONTROL and self.written[-1][1] & COMMIT:
            self.polls = getattr(self, "polls", 0) + 1
            if self.polls == 3:
                self.live = self.start_screen()
        return super().read(offset)


@pytest.mark.parametrize("language", ["c", "python"])
def test_the_programs_of_the_page(language, tmp_path):
    """Unchanged, the page's programs draw the same picture of their rectangle as the golden model."""
    scene = tmp_path / "scene.toml"
    scene.write_text(
        '[camera]\nposition = [20, 250, 40]\n[[rect]]\ncorners = [[300, 60, 0], [300, 400, 180]]\ncolour = "#50a0ff"\n'
    )
    program, *_ = re.findall(rf"^```{language}\n(.*?)^```", PAGE.read_text(), re.M | re.S)
    assert len(program.splitlines()) <= 23
    model = ShownWhenPolled(CONFIG)
    if language == "c":
        (tmp_path / "main.c").write_text(program)
        library = compile_library(tmp_path, "raycaster.c", tmp_path / "main.c")
        with attached(library, model):
            assert library.main() == 0
    else:
        names: dict = {}
        exec(program.replace("0x40000000", "0"), names)
        names["draw"](scene, model.read, model.write)
        with pytest.raises(OSError, match="no ray tracer"):
            names["draw"](scene, lambda address: 0, model.write)
    live = model.live
    assert live.run
    full, screen = model_of(configure(engine="exact")), configure(engine="exact").screen_geometry
    shown = live.picture(full, screen)
    assert np.unique(shown.reshape(-1, 3), axis=0).shape[0] > 1
    np.testing.assert_array_equal(shown, full.render(load_scene(scene), screen, 1))


def test_a_scene_gives_the_same_words_as_the_project(library, registers, device, scenes):
    for path in sorted(scenes.glob("*.toml")):
        scene = load_scene(path)
        if scene.reflections > CONFIG.reflections or scene.lacks(()):
            continue
        model = Registers(CONFIG)
        with attached(library, model):
            results = [
                library.raycaster_set_background(ctypes.byref(device), Colour(*scene.background)),
                library.raycaster_set_camera(ctypes.byref(device), Point(*scene.camera.position)),
            ]
            for index, rectangle in enumerate(scene.rect):
                corners = [Point(*corner) for corner in rectangle.corners]
                colour = Colour(*rectangle.colour)
                results.append(library.raycaster_set_rectangle(ctypes.byref(device), index, *corners, colour))
            for index in range(len(scene.rect), CONFIG.rectangles):
                results.append(library.raycaster_enable_rectangle(ctypes.byref(device), index, False))
            library.raycaster_set_run(ctypes.byref(device), True)
            results.append(library.raycaster_set_reflections(ctypes.byref(device), scene.reflections))
            results.append(library.raycaster_commit(ctypes.byref(device)))
        assert set(results) == {0}
        expected = [(4 * address, word) for address, word in scene_words(scene, CONFIG)]
        # Run and reflections share a register with commit, and each is written separately.
        run_and_reflections = len(model.written) - len(expected)
        assert run_and_reflections == 2
        assert model.written[: len(expected) - 1] + model.written[-1:] == expected
        live = model.start_screen()
        assert (live.run, live.reflections, live.background) == (True, scene.reflections, scene.background)
        assert live.camera == scene.camera.position
        shown, wanted = live.rectangles, Rectangles.of_scene(scene)
        assert shown.enabled.sum() == len(wanted)
        np.testing.assert_array_equal(shown.corners[: len(wanted)], wanted.corners)
        np.testing.assert_array_equal(shown.colours[: len(wanted)], wanted.colours)


@pytest.mark.parametrize(
    ("index", "corners", "expected"),
    [
        (11, ((0, 0, 5), (511, 511, 5)), "OK"),
        (0, ((7, 8, 9), (7, 8, 9)), "OK"),
        (12, ((0, 0, 5), (511, 511, 5)), "NO_SUCH_RECTANGLE"),
        (0xFFFFFFFF, ((0, 0, 5), (511, 511, 5)), "NO_SUCH_RECTANGLE"),
        (0, ((512, 0, 5), (511, 511, 5)), "OUTSIDE_WORLD"),
        (0, ((0, 0, 5), (511, 512, 5)), "OUTSIDE_WORLD"),
        (0, ((0, 0, 512), (511, 511, 512)), "OUTSIDE_WORLD"),
        (0, ((0, 0, 5), (65535, 511, 5)), "OUTSIDE_WORLD"),
        (0, ((0, 1, 2), (1, 2, 3)), "NO_PLANE"),
    ],
)
def test_rectangles_that_are_refused(library, registers, device, index, corners, expected):
    result = library.raycaster_set_rectangle(ctypes.byref(device), index, *(Point(*c) for c in corners), WHITE)
    assert error(result) == expected
    assert len(registers.written) == (3 if expected == "OK" else 0)


def test_a_rectangle_is_left_out_and_shown_again(library, registers, device):
    corners = Point(1, 2, 3), Point(1, 20, 30)
    assert library.raycaster_set_rectangle(ctypes.byref(device), 4, *corners, Colour(1, 2, 3)) == 0
    for enable in (False, True):
        assert library.raycaster_enable_rectangle(ctypes.byref(device), 4, enable) == 0
        assert library.raycaster_commit(ctypes.byref(device)) == 0
        rectangles = registers.start_screen().rectangles
        assert rectangles.enabled[4] == enable
        assert rectangles.corners[4].tolist() == [[1, 2, 3], [1, 20, 30]]
        assert rectangles.colours[4].tolist() == [1, 2, 3]
    assert error(library.raycaster_enable_rectangle(ctypes.byref(device), 12, True)) == "NO_SUCH_RECTANGLE"


def test_the_whole_table_of_a_larger_design(library):
    model = Registers(configure(engine="beam", screen="tiny", rectangles=32))
    with attached(library, model):
        device = probed(library)
        for index in range(32):
            corners = Point(index, 0, 0), Point(index, 1, 1)
            assert library.raycaster_set_rectangle(ctypes.byref(device), index, *corners, WHITE) == 0
        assert library.raycaster_commit(ctypes.byref(device)) == 0
        assert error(library.raycaster_enable_rectangle(ctypes.byref(device), 32, True)) == "NO_SUCH_RECTANGLE"
    assert model.start_screen().rectangles.corners[:, 0, 0].tolist() == list(range(32))


@pytest.mark.parametrize(("built_in", "camera"), [(1, "OK"), (2, "FIXED")])
def test_built_in_parts_cannot_be_set(library, registers, built_in, camera):
    registers.say("engine", fixed=built_in)
    registers.say("size", rectangles=0)
    device = probed(library)
    handle = ctypes.byref(device)
    assert error(library.raycaster_set_rectangle(handle, 0, Point(), Point(), WHITE)) == "FIXED"
    assert error(library.raycaster_enable_rectangle(handle, 0, True)) == "FIXED"
    assert not registers.written
    assert error(library.raycaster_set_camera(handle, Point(1, 2, 3))) == camera
    assert error(library.raycaster_set_background(handle, WHITE)) == camera
    assert error(library.raycaster_set_reflections(handle, 1)) == camera
    assert len(registers.written) == (3 if camera == "OK" else 0)


@pytest.fixture
def everything(library):
    """The registers of a design with all features that scenes may need, and its handle."""
    model = Registers(configure(engine="exact", screen="tiny", **dict.fromkeys(EXACT.looks, True)))
    with attached(library, model):
        yield model, ctypes.byref(probed(library))


def shown(library, model, handle):
    assert library.raycaster_commit(handle) == 0
    return model.start_screen()


def test_looks(library, everything):
    model, handle = everything
    corners = Point(1, 2, 3), Point(1, 20, 30)
    for index in range(12):
        assert library.raycaster_set_rectangle(handle, index, *corners, Colour(1, 2, 3)) == 0
        assert library.raycaster_set_mirror(handle, index, index % 5) == 0
        assert library.raycaster_set_pattern(handle, index, index % 4, 8 << index % 6, Colour(index, 5, 6)) == 0
    live = shown(library, model, handle).rectangles
    indices = np.arange(12)
    assert live.enabled.all()
    assert (live.mirrors == indices % 5).all()
    assert (live.kinds == indices % 4).all()
    assert (live.cells == 8 << indices % 6).all()
    assert live.colours_2.tolist() == [[index, 5, 6] for index in range(12)]
    assert (live.colours == [1, 2, 3]).all()
    # A new rectangle in the same place has default looks; one that was only disabled for a while keeps its looks.
    assert library.raycaster_set_rectangle(handle, 3, *corners, Colour(7, 8, 9)) == 0
    for enable in (False, True):
        assert library.raycaster_enable_rectangle(handle, 7, enable) == 0
    live = shown(library, model, handle).rectangles
    assert (live.mirrors[3], live.kinds[3]) == (2, 0)
    assert (live.mirrors[7], live.kinds[7], live.cells[7]) == (2, 3, 16)


@pytest.mark.parametrize("quarters", [5, 8, 0xFFFFFFFF])
def test_invalid_mirrors(library, everything, quarters):
    model, handle = everything
    assert error(library.raycaster_set_mirror(handle, 0, quarters)) == "NO_SUCH_LOOK"
    assert error(library.raycaster_set_mirror(handle, 12, 1)) == "NO_SUCH_RECTANGLE"
    assert not model.written


@pytest.mark.parametrize(
    ("pattern", "cell"),
    [(len(PATTERNS), 32), (0xFFFFFFFF, 32), (1, 0), (1, 4), (1, 12), (1, 257), (1, 512), (1, 0x80000000)],
)
def test_invalid_patterns(library, everything, pattern, cell):
    model, handle = everything
    assert error(library.raycaster_set_pattern(handle, 0, pattern, cell, WHITE)) == "NO_SUCH_LOOK"
    assert error(library.raycaster_set_pattern(handle, 12, 1, 8, WHITE)) == "NO_SUCH_RECTANGLE"
    assert not model.written


def test_looks_that_the_hardware_does_not_have(library, registers, device):
    handle = ctypes.byref(device)
    assert error(library.raycaster_set_mirror(handle, 0, 1)) == "NOT_IN_HARDWARE"
    assert error(library.raycaster_set_pattern(handle, 0, 1, 8, WHITE)) == "NOT_IN_HARDWARE"
    assert error(library.raycaster_set_basis(handle, ctypes.byref(Turned.of(UNTURNED)))) == "NOT_IN_HARDWARE"
    assert error(library.raycaster_set_light(handle, Point(1, 2, 3), 2)) == "NOT_IN_HARDWARE"
    assert error(library.raycaster_clear_light(handle)) == "NOT_IN_HARDWARE"
    assert not registers.written


def test_a_light(library, everything):
    model, handle = everything
    assert shown(library, model, handle).light is None
    for position, quarters in product(((0, 0, 0), (511, 0, 1), (7, 300, 511)), range(4)):
        assert library.raycaster_set_light(handle, Point(*position), quarters) == 0
        assert shown(library, model, handle).light == Light(position=position, shade=quarters / 4)
    written = len(model.written)
    for axis in range(3):
        outside = Point(*(512 * (axis == other) for other in range(3)))
        assert error(library.raycaster_set_light(handle, outside, 0)) == "OUTSIDE_WORLD"
    assert error(library.raycaster_set_light(handle, Point(0, 0, 0), 4)) == "NO_SUCH_LOOK"
    assert len(model.written) == written
    assert library.raycaster_clear_light(handle) == 0
    assert shown(library, model, handle).light is None
    model.say("engine", fixed=2)
    fixed = ctypes.byref(probed(library))
    assert error(library.raycaster_set_light(fixed, Point(1, 2, 3), 2)) == "FIXED"
    assert error(library.raycaster_clear_light(fixed)) == "FIXED"


def test_a_camera_turns(library, everything):
    model, handle = everything
    assert library.raycaster_set_camera(handle, Point(1, 2, 3)) == 0
    assert shown(library, model, handle).basis == UNTURNED
    basis = ((-512, 511, 0), (1, -1, 256), (511, -512, -511))
    assert library.raycaster_set_basis(handle, ctypes.byref(Turned.of(basis))) == 0
    live = shown(library, model, handle)
    assert (live.basis, live.camera) == (basis, (1, 2, 3))
    written = len(model.written)
    for place in range(9):
        for part in (512, -513):
            parts = [part if place == other else 0 for other in range(9)]
            wrong = Turned.of([parts[:3], parts[3:6], parts[6:]])
            assert error(library.raycaster_set_basis(handle, ctypes.byref(wrong))) == "OUTSIDE_WORLD"
    model.say("engine", fixed=2)
    fixed = probed(library)
    right = Turned.of(UNTURNED)
    assert error(library.raycaster_set_basis(ctypes.byref(fixed), ctypes.byref(right))) == "FIXED"
    assert len(model.written) == written


def test_angles_match_those_of_scenes(library):
    """Any angle with selected values of the other two, and random triples, give the same basis as in scenes."""
    random = np.random.default_rng(seed())
    some = [*range(-360, 361, 45), -37, 1, 89]
    angles = [(one, other, third) for one in range(-360, 361) for other in some[::2] for third in some[::3]]
    angles += [(third, one, other) for one, other, third in angles]
    angles = [angles[index] for index in random.permutation(len(angles))[:6000]]
    angles += random.integers(-360, 361, (12000, 3)).tolist()
    for yaw, pitch, roll in angles:
        wanted = Camera(position=(0, 0, 0), yaw=yaw, pitch=pitch, roll=roll).basis
        assert library.raycaster_turned(yaw, pitch, roll).basis == wanted, (yaw, pitch, roll, repeat())


def test_angles_of_any_size(library):
    for turns in (-5, 7, 5_000_000):
        wanted = library.raycaster_turned(30, -20, 77).basis
        assert library.raycaster_turned(30 + 360 * turns, -20, 77 - 360 * turns).basis == wanted
    assert (
        library.raycaster_turned(2**31 - 1, -(2**31), 0).basis
        == Camera(position=(0, 0, 0), yaw=(2**31 - 1) % 360, pitch=2**31 % 360 * -1.0).basis
    )


@pytest.mark.parametrize("position", [(512, 0, 0), (0, 512, 0), (0, 0, 512), (65535, 65535, 65535)])
def test_cameras_outside_the_world(library, registers, device, position):
    assert error(library.raycaster_set_camera(ctypes.byref(device), Point(*position))) == "OUTSIDE_WORLD"
    assert not registers.written


def test_reflections_that_the_hardware_does_not_have(library, registers, device):
    assert error(library.raycaster_set_reflections(ctypes.byref(device), 2)) == "TOO_MANY_REFLECTIONS"
    assert not registers.written


def test_a_commit_waits_for_the_one_before(library, registers, device):
    handle = ctypes.byref(device)
    library.raycaster_set_run(handle, True)
    assert library.raycaster_commit(handle) == 0
    assert library.raycaster_is_committing(handle)
    # Changes from now on belong to the next commit and must not trigger one.
    assert library.raycaster_set_reflections(handle, 1) == 0
    assert library.raycaster_set_camera(handle, Point(1, 2, 3)) == 0
    written = len(registers.written)
    assert error(library.raycaster_commit(handle)) == "STILL_COMMITTING"
    assert len(registers.written) == written
    live = registers.start_screen()
    assert (live.run, live.reflections, live.camera) == (True, 0, (0, 0, 0))
    assert not library.raycaster_is_committing(handle)
    assert library.raycaster_commit(handle) == 0
    live = registers.start_screen()
    assert (live.run, live.reflections, live.camera) == (True, 1, (1, 2, 3))
    library.raycaster_set_run(handle, False)
    assert library.raycaster_commit(handle) == 0
    live = registers.start_screen()
    assert (live.run, live.reflections) == (False, 1)


def test_waiting_for_a_frame(library, registers, device):
    handle = ctypes.byref(device)
    registers.polls_to_frame = 10
    assert error(library.raycaster_wait_frame(handle, 9)) == "NO_FRAME"
    assert library.raycaster_frame(handle) == 0
    assert error(library.raycaster_wait_frame(handle, 9)) == "OK"
    assert library.raycaster_frame(handle) == 1
    # Each frame counts once, even if it came before the wait.
    assert error(library.raycaster_wait_frame(handle, 100)) == "NO_FRAME"
    registers.start_screen()
    assert error(library.raycaster_wait_frame(handle, 1)) == "OK"
    assert error(library.raycaster_wait_frame(handle, 0)) == "NO_FRAME"


def test_the_interrupt(library, registers, device):
    handle = ctypes.byref(device)

    def raised() -> bool:
        agent = registers.file.agent
        return agent.irq_enable and agent.irq_pending

    registers.start_screen()
    assert not raised()
    library.raycaster_enable_interrupt(handle, True)
    assert raised()
    assert library.raycaster_acknowledge(handle)
    assert not raised()
    assert not library.raycaster_acknowledge(handle)
    registers.start_screen()
    assert raised()
    library.raycaster_enable_interrupt(handle, False)
    assert not raised()


def test_sticky_errors(library, registers, device):
    handle = ctypes.byref(device)
    assert error(library.raycaster_check(handle)) == "OK"
    # Bypass the driver, which would refuse the rectangle.
    table = register_map(CONFIG.rectangles)
    registers.write(4 * table["rectangle[3].corner_0"].address, table["rectangle[3].corner_0"].pack(x=1, y=2, z=3))
    assert library.raycaster_enable_rectangle(handle, 3, True) == 0
    assert library.raycaster_commit(handle) == 0
    assert error(library.raycaster_check(handle)) == "BAD_RECTANGLE"
    registers.file.agent.underrun = True
    assert error(library.raycaster_check(handle)) == "UNDERRUN"
    for _ in range(3):
        registers.start_screen()
    status = library.raycaster_get_status(handle)
    assert (status.frame, status.busy, status.underrun, status.bad_rectangle) == (3, False, True, True)
    library.raycaster_clear_status(handle)
    assert error(library.raycaster_check(handle)) == "OK"
    status = library.raycaster_get_status(handle)
    assert (status.frame, status.underrun, status.bad_rectangle) == (3, False, False)


def test_cycles(library, registers, device):
    registers.file.agent.row, registers.file.agent.group = 1234, 321
    cycles = library.raycaster_get_cycles(ctypes.byref(device))
    assert (cycles.row, cycles.group) == (1234, 321)
    library.raycaster_clear_cycles(ctypes.byref(device))
    cycles = library.raycaster_get_cycles(ctypes.byref(device))
    assert (cycles.row, cycles.group) == (0, 0)


def test_every_error_has_its_own_text(library):
    texts = [library.raycaster_error_text(number).decode() for number in range(len(ERRORS) + 1)]
    assert len(set(texts)) == len(texts)
    assert texts[-1] == "unknown error"
    assert not any(text.endswith(".") for text in texts)


@pytest.mark.parametrize("standard", ["c99", "c11"])
@pytest.mark.parametrize("level", ["-O0", "-Os", "-O2"])
def test_plain_memory_and_no_library(tmp_path, standard, level):
    """The driver works with its own register access and links without any library."""
    compiler = shutil.which("gcc") or shutil.which("cc")
    flags = (f"-std={standard}", *STRICT[1:], level, "-ffreestanding", "-shared", "-fPIC", "-nostdlib", "-Wl,-z,defs")
    subprocess.run([compiler, *flags, SOFTWARE / "raycaster.c", "-o", tmp_path / "driver.so"], check=True)
    library = ctypes.CDLL(tmp_path / "driver.so")
    memory = (ctypes.c_uint32 * 64)()
    registers = register_map(CONFIG.rectangles)
    memory[registers["id"].address] = registers["id"].reset
    memory[registers["version"].address] = registers["version"].reset
    memory[registers["size"].address] = registers["size"].pack(units=4, rectangles=12, rows=240)
    device = RayCaster()
    assert library.raycaster_probe(ctypes.byref(device), memory) == 0
    assert (device.units, device.rectangles, device.rows) == (4, 12, 240)
    assert library.raycaster_set_camera(ctypes.byref(device), Point(1, 2, 3)) == 0
    assert memory[registers["camera"].address] == registers["camera"].pack(x=1, y=2, z=3)


def test_a_cpp_compiler_takes_the_header():
    command = ["g++", "-x", "c++", *STRICT[1:], "-fsyntax-only", SOFTWARE / "raycaster.h"]
    subprocess.run(command, check=True)


def test_the_driver_for_nios(tmp_path):
    """The description runs in a real Tcl with stub commands, and names existing files and the component."""
    script = "".join(
        f"proc {name} {{args}} {{ puts [join [list {name} {{*}}$args] \\t] }}\n"
        for name in ("create_driver", "set_sw_property", "add_sw_property")
    )
    done = run_tcl(tmp_path, f"{script}source {SOFTWARE / 'raycaster_sw.tcl'}\n")
    assert (done.returncode, done.stderr) == (0, "")
    calls = [line.split("\t") for line in done.stdout.splitlines()]
    assert calls[0][0] == "create_driver"
    assert ["set_sw_property", "hw_class_name", TOP] in calls
    files = {call[2] for call in calls if call[1] in ("c_source", "include_source")}
    assert files == {path.name for path in SOFTWARE.glob("*.[ch]")}
