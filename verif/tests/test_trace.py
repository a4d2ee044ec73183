# SPDX-License-Identifier: MIT
"""The life of a pixel: the trace finds nothing in a correct design and names the module of each planted fault; the
viewers' files show the recording."""

from __future__ import annotations

import io
import re
from functools import cache
from itertools import combinations, pairwise, product
from pathlib import Path

import pytest
from conftest import BUILD, broken, called, faulty, plant
from rich.console import Console

from raycaster.debug.probes.engines import description_of
from raycaster.debug.probes.ray import Place, Ray, Reading, first_difference, read
from raycaster.debug.recorder import record
from raycaster.debug.trace import difference_line, main, show
from raycaster.debug.wave import write_view
from raycaster.debug.waves import Waves
from raycaster.design.for_scene import Design, design_for
from raycaster.fit.fixing import SCOPES, fix
from raycaster.rtl.engine.ray_sequencer import RayState
from raycaster.rtl.span.painter import PaintState
from raycaster.rtl.span.span_control import SpanState
from raycaster.rtl.span.sweep import SweepState
from raycaster.sim.monitor import CLOCK_NS
from raycaster.sim.simulator import WINDOW_BENCH, build_model, convert

SCENE = Path(__file__).with_name("tall.toml")
PIXEL = (48, 2)
"""Column and row, at scale 1, of a pixel where the post hides the wall and mirrors it."""

CAMERA = "position = [20, 250, 100]"
WALL = "corners = [[300, 60, 0], [300, 400, 500]]"
POST = "corners = [[130, 270, 20], [200, 270, 300]]"
PIECES = {
    "turn": {CAMERA: CAMERA + "\nyaw = 1\npitch = -2\nroll = 2"},
    "materials": {POST: POST + "\nmirror = 0.75"},
    "patterns": {WALL: WALL + '\npattern = "checker"\ncolour2 = "#103010"\ncell = 8'},
    "light": {'background = "#203040"': 'background = "#203040"\n[light]\nposition = [100, 255, 250]\nshade = 0.25'},
    # The pixel's ray meets the wall and the post in one point.
    "corner": {WALL: "corners = [[120, 60, 0], [120, 400, 500]]", POST: "corners = [[60, 266, 20], [120, 266, 300]]"},
    # The corner of a camera that looks along y: no ray of the middle column moves along x.
    "across": {
        CAMERA: "position = [250, 20, 100]\nyaw = 90",
        WALL: "corners = [[100, 120, 0], [440, 120, 500]]",
        POST: "corners = [[234, 60, 20], [234, 120, 300]]",
    },
    "unculled": {},
    "pairs": {},
    "shared": {},
    "rects": {},
    "all": {},
}
"""Changes of the scene for each look, before those of another look."""

GIVEN = {
    "seed": {"engine": "seed", "units": "8"},
    "exact": {"engine": "exact", "units": "8", "allow_underrun": "1"},
    "span": {"engine": "span"},
    # With columns that last several clocks.
    "patterns": {"patterns": "1", "scale": "1"},
    "materials": {"materials": "1", "rounding": "nearest"},
    "corner": {"reflections": "2"},
    "across": {"reflections": "2"},
    "unculled": {"culling": "0"},
    "pairs": {"pixels": "2"},
    "shared": {"units": "3"},
}


def looks(*names: str) -> list[str]:
    """Return all choices of some looks, joined by dashes, the empty one first."""
    return ["-".join(chosen) for count in range(len(names) + 1) for chosen in combinations(names, count)]


DESIGNS = [
    "-".join(filter(None, (engine, *more)))
    for engine, more in [
        *(("seed", more) for more in product(looks("materials", "patterns"), ["", "unculled"])),
        *(("exact", (more,)) for more in looks("turn", "materials", "patterns", "light")),
        *(("exact", (more,)) for more in ("corner", "across", "materials-patterns-light-corner", "unculled")),
        *(("span", (more,)) for more in looks("turn", "materials", "patterns", "light")),
        *(("span", (more,)) for more in ("corner", "across", "materials-patterns-light-corner", "pairs-shared")),
        *(("span", (more,)) for more in ("rects-shared", "turn-materials-patterns-light-pairs-all")),
    ]
]
QUICK = ["seed]", "exact-light]", "span-turn-materials-patterns-light-pairs-all]"]
"""Designs of `make test`."""


@cache
def design(name: str) -> Design:
    """Return a design for a small scene on the tiny screen, which Icarus builds quickly: an engine with some looks."""
    engine, *chosen = name.split("-")
    text = SCENE.read_text()
    for before, after in [change for look in chosen for change in PIECES[look].items()]:
        text = faulty(text, before, after)
    scene = BUILD / "test" / f"tall-{name}.toml"
    scene.parent.mkdir(parents=True, exist_ok=True)
    scene.write_text(text)
    given = {key: value for part in (engine, *chosen) for key, value in GIVEN.get(part, {}).items()}
    for option, only in (("scale", "span"), ("rounding", "seed")):
        if engine != only or (option == "scale" and "pairs" in chosen):
            given.pop(option, None)
    scope = next((look for look in chosen if look in SCOPES), None)
    if scope:
        return fix(scene, {"screen": "tiny", **given}, scope).design
    return design_for(scene, {"screen": "tiny", "rectangles": "3", **given})


def pixel(name: str) -> tuple[int, int]:
    """Return the column and the row of `PIXEL` at the design's scale."""
    scale = design(name).configuration.scale
    return PIXEL[0] * scale, PIXEL[1] * scale


def recorded(engine: str, directory: Path, edit: tuple[str, str, str] | None = None) -> Waves:
    """Record the pixel's row, optionally with a text replaced in one of the design's modules."""
    sources = convert(design(engine).configuration, BUILD)
    if edit:
        sources = broken(sources, directory, *edit)
    model = build_model(design(engine).configuration, "icarus", build=directory, verilog=sources, bench=WINDOW_BENCH)
    return Waves(record(model, design(engine), (pixel(engine)[1],) * 2, directory / "rows" / "row"))


def traced(waves: Waves, name: str, column: int | None = None) -> tuple[Ray, list[Reading]]:
    """Return the golden ray and the readings from the hardware of the pixel, or of another one in its row."""
    own, row = pixel(name)
    ray = Ray(design(name), row, own if column is None else column)
    return ray, read(waves, description_of(design(name).configuration, ray.unit), ray)


@pytest.fixture(scope="module", params=DESIGNS)
def sound(request, tmp_path_factory) -> tuple[str, Waves]:
    """Return the name of a design, and a recording of it."""
    return request.param, recorded(request.param, tmp_path_factory.mktemp("sound"))


@pytest.mark.slow_sets(quick=QUICK)
def test_a_sound_design_has_no_difference(sound):
    """No pixel of the row differs; both rays of the chosen pixel hit something, and every value is read."""
    name, waves = sound
    quantities = set()
    for column in [None, *range(2, design(name).configuration.screen_geometry.columns, 3)]:
        ray, readings = traced(waves, name, column)
        first = first_difference(readings)
        assert first is None, f"column {ray.column}: {difference_line(ray, first)}"
        quantities |= {reading.probe.quantity for reading in readings}
        if column is None:
            at_once = {"corner", "across"} & {*name.split("-")}
            seen = [ray.name(ray.winner(bounce)) for bounce in (0, 1)]
            assert seen == (["wall", "post"] if at_once else ["post", "wall"])
    # A value that is never read could never be wrong.
    missing = {probe.quantity for probe in description_of(design(name).configuration, ray.unit).probes} - quantities
    if "corner" in name:
        missing.discard("shadow")  # nothing there is between the light and what is seen
    assert not missing, f"never read: {missing}"


@pytest.mark.slow_sets(quick=QUICK)
def test_window_has_its_rows_alone(sound):
    """It runs from the start of the row's computation until the row has been shown; both apart, of whole frames."""
    engine, waves = sound
    config = design(engine).configuration
    times = waves.sample([]).times_ns
    breaks = [cycle for cycle, (before, time) in enumerate(pairwise(times), 1) if time - before > CLOCK_NS]
    assert len(breaks) == config.facts.whole_frames
    *drawn, shown = (end - begin for begin, end in pairwise([0, *breaks, len(times)]))
    rows = 2 - config.facts.whole_frames
    assert rows < shown / config.screen_geometry.row_cycles < rows + 0.2
    assert sum(drawn) < config.screen_geometry.frame_cycles / 5
    assert [path.name for path in waves.path.parent.parent.iterdir()] == ["row"], "nothing half-written is left"


@pytest.mark.slow_sets(quick=QUICK)
def test_viewers_show_what_there_is(sound):
    """The waveform has every signal of the view, with its width; labels are unique; the cursor is where the pixel's ray
    starts; states have the names from the hardware's source."""
    engine, waves = sound
    config, ray = design(engine).configuration, Ray(design(engine), *reversed(pixel(engine)))
    description = description_of(config, ray.unit)
    gtkwave = write_view(waves.path, design(engine), ray).read_text()

    # Bits of a word are shown as bits or as the whole word.
    shown = re.findall(r"^(?:\+\{.*\} |#\{.*\} (?:.*\(\d+\)|\(\d+\)))?(bench\.\S+)$", gtkwave, re.MULTILINE)
    assert len(shown) > 30
    for name in shown:
        signal, _, last_bit = name.removesuffix(":0]").partition("[")
        assert waves.width(signal) == int(last_bit or 0) + 1, name
    labels = re.findall(r"^[+#]\{(.*?)\}", gtkwave, re.MULTILINE)
    assert len(set(labels)) == len(labels), "two signals have one label"

    [units] = re.findall(r"^\*-\d+\.\d+ (\d+) ", gtkwave, re.MULTILINE)
    expected = {"left": config.screen_geometry.rows - ray.row - 1, "next_row": 1}
    if not config.facts.whole_frames:
        expected = {"place_row": ray.row, "place_column_offset": ray.offset, "steps_screen_to_ray": 1}
    signals = [description.signals(name)[0] for name in expected]
    # The first sample is of the cycle before the cursor.
    values = waves.sample(signals, int(units) / waves.tick_units / waves.ticks(1)).values
    assert [values[signal][1] for signal in signals] == [*expected.values()]

    filters = re.findall(r"^\^\d+ (\S+)$", gtkwave, re.MULTILINE)
    kinds = [SpanState, SweepState, PaintState] if config.facts.whole_frames else [RayState]
    names = [[f"{getattr(kind, name)._val} {name}" for name in kind._names] for kind in kinds]
    assert [Path(path).read_text().split("\n")[:-1] for path in filters] == names
    state = description.states[0]
    passed = {*waves.sample([state]).values[state]}
    assert passed == {*range(len(names[0]))} or config.facts.whole_frames, "every state is passed through"


def test_values_have_names_and_colours_are_colours():
    """The wrong one of three values is named; a colour is #rrggbb, alone and next to other values."""
    ray = Ray(design("seed"), PIXEL[1], PIXEL[0])
    probes = {probe.quantity: probe for probe in description_of(ray.config, ray.unit).probes}

    def line(quantity: str, golden: tuple[int, ...], found: tuple[int, ...], rectangle: int | None = None) -> str:
        return difference_line(ray, Reading(probes[quantity], Place(0, rectangle), 0, 0, golden, found))

    pins = line("pins", (1, 2, 3), (1, 9, 3))
    assert "pins, green is #010903, expected #010203; " in pins and pins.endswith("vga_g")
    assert "pins, red is unknown, expected #010203; " in line("pins", (1, 2, 3), (None, 2, 3))
    assert "origin, z is 7, expected 6;" in line("origin", (4, 5, 6), (4, 5, 7))
    of_rectangle = ((0, 0, 0xC8C8B4, 0, 0, 0, 0), (0, 0, 0xA00, 0, 0, 0, 0), 0)
    assert "rectangle, colour is #000a00, expected #c8c8b4;" in line("rectangle", *of_rectangle)


FAULTS = {
    "seed": [
        ("rect_mem", "rects_rect_word <= ", "rects_rect_word <= 1 ^ "),
        ("group_culler", "may_hit <= found", "may_hit <= 0"),
        ("ray_generator", "dy = column - 32", "dy = column - 31"),
        ("intersection_helper", "forward = a + quotient", "forward = a - quotient"),
        ("divider", "quotient <= last_pending[8:0]", "quotient <= last_pending[8:0] ^ 1"),
        ("ray_control", "offered_word <= dividing_word", "offered_word <= 0"),
        ("intersection_finder", "assign inside_u = ", "assign inside_u = 0 && "),
        ("z_buffer", "depth < nearest", "depth > nearest"),
        ("ray_mem", "dy = ray_dy != (found_axis == 1)", "dy = ray_dy"),
        ("rect_sequencer", "offered <= candidates != 0", "offered <= 0"),
        ("ray_sequencer", "bounce == picture_reflections", "bounce == 0"),
        ("colour_sum", "total + weighted", "total - weighted"),
        ("colour_combiner", "? found_colour :", "? ~found_colour :"),
        ("line_buffer", "read_address = read_offset;", "read_address = 1 + read_offset;"),
        ("video_generator", "vga_g <= pixel_green", "vga_g <= pixel_red"),
    ],
    "exact": [
        ("exact_control", "steps_write_z_buf = in_flight[2]", "steps_write_z_buf = 0"),
        ("rect_tester", "hit <= seen_2_crosses", "hit <= 0 && seen_2_crosses"),
        ("nearest_hit", "offered_product < nearest_product", "offered_product > nearest_product"),
        ("eye_register", "difference = twice_signed - mirrored", "difference = twice_signed + mirrored"),
    ],
    "span": [
        ("row_slope", "slope_y <= -64", "slope_y <= -63"),
        ("half_lines", "offset = whole_bound - eye_w", "offset = whole_bound + eye_w"),
        ("line_eval", "left = (ax_left - by_left)", "left = (ax_left + by_left)"),
        ("first_change", "columns <= quotient + 1", "columns <= quotient"),
        ("clipper", "if (rises && (border > low))", "if (!rises && (border > low))"),
        ("entry_table", "memory[write_address] <= entry_word", "memory[write_address] <= entry_word ^ 'h100"),
        ("sweep", "follows = outlasts_1", "follows = 0 && outlasts_1"),
        ("span_control", "column <= stop", "column <= stop - 1"),
        ("fold", "whole = eye_a + twice", "whole = eye_a - twice"),
        ("quarters_of", "sum_2 = once + twice", "sum_2 = once"),
        ("surface_table", "memory[level] <= given_word", "memory[level] <= ~given_word"),
        ("painter", "red + red_part", "red - red_part"),
        ("run_joiner", "same = part_colour == colour", "same = part_colour != colour"),
        ("row_collector", "next_place <= next_place + 1", "next_place <= next_place + 2"),
        ("row_place", "    place <= next_first", "    place <= next_first + 1"),
        ("video_generator", "vga_g <= pixel_green", "vga_g <= pixel_red"),
    ],
    "seed-materials-patterns": [
        ("cell_parity", "odd = value[3 + each]", "odd = value[2 + each]"),
        ("pattern_colour", "second = odd_u != odd_v", "second = odd_u"),
        ("colour_share", "(weight >>> 1)", "weight"),
        ("video_generator", "vga_blank_n <= (x", "vga_blank_n <= 0 && (x"),
    ],
    "exact-turn": [
        ("camera_mem", "camera_word = whole", "camera_word = whole ^ 'h100"),
        ("turned_generator", "column = group_start - 32", "column = group_start - 31"),
        ("slope_component", "total = level + upward", "total = level - upward"),
    ],
    "exact-materials-patterns-light": [
        ("cell_finder", "digits <= point[8:3]", "digits <= ~point[8:3]"),
        ("pattern_colour", "second = odd_u != odd_v", "second = odd_u"),
        ("shadow_ray", "(light_a < found_surface_position)", "(light_a > found_surface_position)"),
        ("shadow_sequencer", "shadow_pass_start = (state == AIM)", "shadow_pass_start = (state == WAIT)"),
        ("ray_switch", "$signed({1'b0, camera_light_y})", "eye_y"),
        ("shadow_register", "reached < denominator", "reached > denominator"),
        ("exact_unit", "dark = camera_light_on", "dark = 0 && camera_light_on"),
        ("shade_colour", "dark ? shade : 4", "dark ? 3 : 4"),
        ("colour_share", "(weight >>> 1)", "weight"),
    ],
    "span-turn": [
        ("camera_mem", "camera_word = whole", "camera_word = whole ^ 'h100"),
        ("slope_start", "whole = (ahead_1 - aside_1) + above_1", "whole = (ahead_1 - aside_1) - above_1"),
    ],
    "span-materials-patterns-light-corner": [
        ("corner_finder", "corner <= at_left", "corner <= 0"),
        ("cell_walker", "(present + 1)", "(present + 2)"),
    ],
    "span-materials-patterns-light": [
        ("pattern_colour", "second = odd_u != odd_v", "second = odd_u"),
        ("surface_light", "(light_a < rect_position)", "(light_a >= rect_position)"),
        ("shadow_finder", "offset = light_q - eye_q", "offset = light_q + eye_q"),
        ("shadow_scan", "covers = begun", "covers = 0 && begun"),
        ("shade_colour", "dark ? shade : 4", "dark ? 3 : 4"),
    ],
    "span-pairs-shared": [
        ("rect_table", "walk_rect_word <= words[walk_index]", "walk_rect_word <= words[0]"),
        ("list_player", "shown = {right, left}", "shown = {left, right}"),
    ],
}
"""Faults by design: the module, and a text of its Verilog with what replaces it."""


@pytest.mark.slow_sets(
    quick=[
        "exact-rect_tester",
        "exact-materials-patterns-light-shadow_register",
        "seed-divider",
        "seed-ray_mem",
        "seed-video_generator",
        "span-fold",
    ]
)
@pytest.mark.parametrize(
    ("engine", "edit"),
    [pytest.param(engine, edit, id=f"{engine}-{edit[0]}") for engine, edits in FAULTS.items() for edit in edits],
)
def test_names_the_module_of_a_fault(tmp_path, engine, edit):
    """Each fault is planted alone, in a different module; the first pixel that differs shows it."""
    waves, count = recorded(engine, tmp_path, edit), design(engine).configuration.screen_geometry.columns
    found = (traced(waves, engine, column) for column in [None, *range(2, count, 3)])
    ray, readings = next(one for one in found if first_difference(one[1]) is not None)
    first = first_difference(readings)
    assert first is not None
    line = difference_line(ray, first)
    assert first.module == edit[0], line
    assert f"module {edit[0]}, signal bench.dut." in line
    console = Console(width=160, record=True, file=io.StringIO())
    show(ray, readings, console)
    text = console.export_text()
    assert "<- first" in text
    assert line in text.replace("\n", "")


def test_the_command_finds_a_fault(tmp_path):
    """The exit code is 1; test_waves.py has a command that finds none."""
    # Files converted before are used as they are.
    [buffer] = [path for path in convert(design("seed").configuration, tmp_path / "build") if path.stem == "z_buffer"]
    plant(buffer, "depth < nearest", "depth > nearest")
    options = ["--simulator", "icarus", "--build", "build", "--pixel", "48,2"]
    options += ["--screen", "tiny", "--units", "8", "--rectangles", "3"]
    done = called(str(SCENE), *options, cwd=tmp_path, program=main)
    assert done.returncode == 1, done.stdout + done.stderr
    assert "expected colour #" in done.stdout and "module z_buffer" in done.stdout
