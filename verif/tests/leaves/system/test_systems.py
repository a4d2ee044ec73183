# SPDX-License-Identifier: MIT
"""Leaf tests of the whole module, and of the system that shows a scene."""

import numpy as np
import pytest
from engine_vectors import TINY_SCREEN, check_frames, golden_words, scene_in_view, small_config, start_cycle
from hard_scenes import rectangles_in_view, tracer, with_looks
from vectors import AXES, Bench, designs

from raycaster.configuration import WORLD_SIZE, Configuration
from raycaster.golden.engines import model_of
from raycaster.golden.rays import primary_slopes
from raycaster.golden.world import Rectangles
from raycaster.hdl.leaf import Leaf
from raycaster.hdl.verilog_style import without_power_up
from raycaster.program import basis_fields, rectangle_fields
from raycaster.registers import register_map
from raycaster.rtl.engines import buffered_engine_of
from raycaster.rtl.system.camera_axis import STEP
from raycaster.rtl.system.ports import module_ports, scene_system_ports
from raycaster.rtl.system.ray_caster_module import ray_caster_module
from raycaster.rtl.system.reset_release import HOLD_CYCLES
from raycaster.rtl.system.scene_player import BUTTONS
from raycaster.rtl.system.scene_system import scene_system
from raycaster.scene import UNTURNED, Basis, Camera, Scene
from raycaster.sim.register_model import RegisterFile, Request
from raycaster.verif.random_scenes import rectangle_of
from raycaster.verif.random_world import random_basis


def without_one(random: np.random.Generator, config: Configuration, scene: tuple) -> tuple:
    """Return the scene without one of the rectangles that its picture shows, if it shows any."""
    camera, table, background, reflections, words = scene
    slopes = primary_slopes(config.screen_geometry).reshape(-1, 3)
    for index in random.permutation(np.flatnonzero(table.visible)):
        less = Rectangles(table.corners, table.colours, table.enabled & (np.arange(len(table)) != index))
        trace = tracer(config, eye=camera, background=background, reflections=reflections)
        left = golden_words(config, trace(less, slopes=slopes).colours)
        if not np.array_equal(left, words):
            return camera, less, background, reflections, left
    return scene


class Bus:
    """Builds the stimulus of a bus master, and records when the answer to each read comes."""

    def __init__(self, config: Configuration):
        self.config, self.registers = config, register_map(config.rectangles)
        self.stimulus: list[dict[str, int]] = []
        self.reads: dict[str, int] = {}
        self._idle = {"avs_s0_write": 0, "avs_s0_read": 0}

    def wait(self, cycles: int, **signals: int) -> None:
        self.stimulus += [{**self._idle, **signals}] * cycles

    def write(self, name: str, **fields: int) -> None:
        transfer = {"avs_s0_address": self.registers[name].address, "avs_s0_byteenable": 15}
        transfer["avs_s0_writedata"] = self.registers[name].pack(**{key: int(value) for key, value in fields.items()})
        self.stimulus.append({**self._idle, **transfer, "avs_s0_write": 1})

    def write_word(self, name: str, word: int, lanes: int) -> None:
        """Write any word to some of its byte lanes."""
        transfer = {"avs_s0_address": self.registers[name].address, "avs_s0_writedata": word}
        self.stimulus.append({**self._idle, **transfer, "avs_s0_byteenable": lanes, "avs_s0_write": 1})

    def read(self, name: str) -> None:
        self.reads[name] = len(self.stimulus) + 2
        self.stimulus.append({**self._idle, "avs_s0_address": self.registers[name].address, "avs_s0_read": 1})

    def write_scene(
        self, camera, background, reflections: int, table: Rectangles, run: bool = True, basis: Basis = UNTURNED
    ) -> None:
        self.write("camera", **dict(zip(AXES, camera, strict=True)))
        for name, fields in basis_fields(basis) if self.config.turn else ():
            self.write(name, **fields)
        self.write("background", **dict(zip(("red", "green", "blue"), background, strict=True)))
        looks = [name for name in ("materials", "patterns") if getattr(self.config, name)]
        for index, enabled in enumerate(table.enabled):
            for name, fields in rectangle_fields(index, rectangle_of(table, index, looks), self.config):
                self.write(name, **fields | ({"enable": enabled} if "enable" in fields else {}))
        self.write("control", run=run, commit=1, reflections=reflections)


def check_bus(config: Configuration, stimulus: list[dict[str, int]], outputs: list[dict[str, int]]) -> int:
    """Compare the bus with the register model in every cycle; return the number of reads that were answered."""
    model, inputs, answers = RegisterFile(config), {}, 0
    for cycle, (given, output) in enumerate(zip(stimulus, outputs, strict=True)):
        inputs |= given
        if cycle >= 2:
            expected = {"avs_s0_waitrequest": model.agent.waiting, "avs_s0_readdatavalid": model.agent.answer[0]}
            assert {name: output[name] for name in expected} == expected, cycle
            if output["avs_s0_readdatavalid"]:
                model.check_answer(output["avs_s0_readdata"])
                answers += 1
        reads, writes = inputs["avs_s0_read"], inputs["avs_s0_write"]
        word = inputs["avs_s0_writedata"] if writes else None
        request = Request(inputs.get("avs_s0_address", 0), word, inputs.get("avs_s0_byteenable", 0))
        model.clock(bool(inputs["reset"]), request if reads or writes else None)
    return answers


@designs(
    small_config(units=4, rectangles=3, reflections=1),
    small_config(units=4, rectangles=2, reflections=2, fraction_bits=4, rounding="nearest", colour_bits=4),
    small_config(units=2, rectangles=5, reflections=0, divider_bits=3, colour_bits=6),
    small_config(units=4, rectangles=3, reflections=1, materials=True, patterns=True),
    small_config(engine="exact", units=4, rectangles=3, reflections=2, turn=True, materials=True, patterns=True),
    slow=[""],
    quick=[
        "exact-tiny4-u4-r3-m2-c8-turn",
        "seed-tiny4-u4-r3-m1-f0t-d1-c8-materials-patterns",
    ],
)
def test_ray_caster_module(config, tmp_path, random):
    """Two scenes over the bus, one shown after the other; every output in every cycle, and every pixel."""
    screen = config.screen_geometry
    bus = Bus(config)
    pictures = []
    bus.wait(2, reset=1)
    bus.wait(3, reset=0)
    for _ in range(2):
        # Most random scenes look like a plain wall.
        for _ in range(1000):
            camera = random.integers(WORLD_SIZE, size=3) // [2, 1, 1]
            basis = random_basis(random) if config.turn else UNTURNED
            slopes = primary_slopes(screen, basis).reshape(-1, 3)
            table = with_looks(random, config, rectangles_in_view(random, camera, slopes, config.rectangles))
            background = random.integers(256, size=3)
            colours = model_of(config).trace(table, camera, background, slopes, config.most_reflections).colours
            if len(np.unique(colours, axis=0)) > min(config.rectangles, 3):
                break
        else:
            raise AssertionError(f"no scene shows more than {min(config.rectangles, 3)} colours")
        pictures.append(golden_words(config, colours))
        bus.write_scene(camera, background, config.most_reflections, table, basis=basis)
        # Wait until the cycle after the next StartScreen.
        so_far = len(bus.stimulus) - 2 - start_cycle(screen) - 1
        bus.wait(-so_far % screen.frame_cycles)
    bus.wait(screen.frame_cycles - 50)
    for name in ("status", "cycles", "engine", "size"):
        bus.read(name)
    bus.wait(60)
    leaf = Leaf(ray_caster_module, lambda: module_ports(config) | {"config": config}, tmp_path)
    outputs = leaf.run_both(bus.stimulus, settled=2)

    check_frames(outputs[2:], config, pictures)
    answers = {name: bus.registers[name].unpack(outputs[cycle]["avs_s0_readdata"]) for name, cycle in bus.reads.items()}
    assert check_bus(config, bus.stimulus, outputs) == len(bus.reads)
    assert answers["status"] == {"busy": 0, "underrun": 0, "bad_rectangle": 0, "frame": 2}
    assert answers["cycles"]["group"] <= buffered_engine_of(config).group_cycles(config)
    assert answers["size"] == {"units": config.units, "rectangles": config.rectangles, "rows": config.rows}
    assert answers["engine"]["fraction_bits"] == config.fraction_bits


@pytest.mark.slow
@designs(
    small_config(TINY_SCREEN, units=2, rectangles=3, reflections=1, divider_bits=2),
)
def test_ray_caster_module_scenes(config, tmp_path, random):
    """One scene per frame over a bus that is never idle: words are read back, and written in part.

    Some frames are black because the module does not run.
    """
    screen = config.screen_geometry
    bus = Bus(config)
    bus.wait(2, reset=1)
    bus.wait(3, reset=0)
    pictures = []

    def traffic(until: int) -> None:
        while len(bus.stimulus) < until:
            name = str(random.choice([name for name in bus.registers if name != "control"]))
            if random.random() < 0.6:
                bus.read(name)
            else:
                bus.write_word(name, int(random.integers(1 << 32)), int(random.choice([1, 2, 4, 8, 3, 12, 15])))

    for number in range(40):
        scene = scene_in_view(random, config, number % 3)
        if number % 4 == 3:
            scene = without_one(random, config, scene)
        camera, table, background, reflections, words = scene
        run = random.random() < 0.9
        pictures.append(words * run)
        start = 2 + start_cycle(screen) + number * screen.frame_cycles
        # A commit before the scene is never shown; writes after the scene wait for a commit.
        traffic(start - screen.frame_cycles + int(random.integers(10, 400)))
        bus.write("control", run=1, commit=1, reflections=0)
        bus.read("status")
        traffic(start - int(random.integers(50, 290)))
        bus.write_scene(camera, background, reflections, table, run)
        traffic(start + 1)
    bus.wait(screen.frame_cycles)
    leaf = Leaf(ray_caster_module, lambda: module_ports(config) | {"config": config}, tmp_path)
    outputs = leaf.run_both(bus.stimulus, settled=2)
    assert check_bus(config, bus.stimulus, outputs) > 1000
    check_frames(outputs[2:], config, pictures)


def test_scene_system(tmp_path, random):
    """The scene loads itself, also at power-up, and buttons move the camera every frame."""
    config = small_config(TINY_SCREEN, units=2, rectangles=3, reflections=1, divider_bits=2)
    screen = config.screen_geometry
    slopes = primary_slopes(screen).reshape(-1, 3)
    frames, ready = 9 if Bench.few else 15, 5
    start = ready + 2 + HOLD_CYCLES  # the first cycle without reset
    for _ in range(2000):
        camera, table, background, *_ = scene_in_view(random, config, 0)
        table = Rectangles(table.corners, table.colours, np.ones(config.rectangles, dtype=bool))
        holds = np.repeat(random.integers(1 << len(BUTTONS), size=frames // 3), 3)
        trace = tracer(config, background=background, slopes=slopes, reflections=config.most_reflections)
        pictures = [trace(table, eye=position).colours for position in walk(camera, holds)]
        # Most random scenes look the same from everywhere.
        if len({picture.tobytes() for picture in pictures}) > frames // 2:
            break
    else:
        raise AssertionError("no walk changes the picture in most frames")
    scene = Scene(
        reflections=config.most_reflections,
        background=tuple(map(int, background)),
        camera=Camera(position=tuple(map(int, camera))),
        rect=tuple(rectangle_of(table, index) for index in range(len(table))),
    )
    stimulus = [{"ready": 0, "buttons": 0}] * ready
    for number, held in enumerate(holds):
        # Hold the buttons until the cycle after StartScreen, in which they count.
        until = start + start_cycle(screen) + number * screen.frame_cycles + 2
        stimulus += [{"ready": 1, "buttons": int(held)}] * (until - len(stimulus))
    stimulus += [{"ready": 1, "buttons": 0}] * screen.frame_cycles
    leaf = Leaf(scene_system, lambda: scene_system_ports(config) | {"config": config, "scene": scene}, tmp_path)
    outputs = leaf.run_both(stimulus, settled=ready)
    words = [golden_words(config, picture) for picture in pictures]
    check_frames(outputs[start:], config, words)
    # Powers up with ready high and all registers unknown, except those that release the reset.
    [release] = [module for module in leaf.modules if module.name == "reset_release"]
    (tmp_path / "unknown").mkdir()
    leaf.verilog = []
    for module in leaf.modules:
        text = module.path.read_text()
        begins = module.name in (release.name, *release.instances.values())
        leaf.verilog.append(tmp_path / "unknown" / module.path.name)
        leaf.verilog[-1].write_text(text if begins else without_power_up(text))
    frames = 3
    power_up = leaf.run_verilog(stimulus[ready : start + (frames + 1) * screen.frame_cycles])[start - ready :]
    check_frames(power_up, config, words[:frames])


def walk(camera: np.ndarray, holds: np.ndarray) -> list[np.ndarray]:
    """Return the camera's place in each frame, with these buttons held at each StartScreen."""
    position, positions = camera, []
    for held in holds:
        positions.append(position)
        forward, back, left, right, up, down = (held >> place & 1 for place in range(len(BUTTONS)))
        target = position + STEP * np.array([forward - back, right - left, up - down])
        position = np.where((target >= 0) & (target < WORLD_SIZE), target, position)
    return positions
