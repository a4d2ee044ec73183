# SPDX-License-Identifier: MIT
"""Leaf test of `scene_system`: the scene loads itself, also at power-up, and buttons move the camera every frame."""

import numpy as np
from engine_vectors import TINY_SCREEN, check_frames, golden_words, scene_in_view, small_config, start_cycle
from hard_scenes import tracer
from vectors import Bench

from raycaster.configuration import WORLD_SIZE
from raycaster.golden.rays import primary_slopes
from raycaster.golden.world import Rectangles
from raycaster.hdl.leaf import Leaf
from raycaster.hdl.verilog_style import without_power_up
from raycaster.rtl.system.camera_axis import STEP
from raycaster.rtl.system.ports import scene_system_ports
from raycaster.rtl.system.reset_release import HOLD_CYCLES
from raycaster.rtl.system.scene_player import BUTTONS
from raycaster.rtl.system.scene_system import scene_system
from raycaster.scene import Camera, Scene
from raycaster.verif.random_scenes import rectangle_of


def test_scene_system(tmp_path, random):
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
