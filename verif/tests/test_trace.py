# SPDX-License-Identifier: MIT
"""The life of a pixel: the trace finds nothing in a correct design and names the module of each planted fault."""

from __future__ import annotations

import io
from functools import cache
from pathlib import Path

import pytest
from conftest import BUILD, called
from rich.console import Console

from raycaster.debug.probes.engines import description_of
from raycaster.debug.probes.ray import Place, Ray, Reading, first_difference, module_of, read
from raycaster.debug.recorder import pixel_place, record
from raycaster.debug.trace import difference_line, main, show
from raycaster.debug.wave_files import View, signal_names
from raycaster.debug.waves import Waves
from raycaster.design import Design, design_for
from raycaster.engines import ENGINES
from raycaster.errors import UserError
from raycaster.sim.simulator import WINDOW_BENCH, build_model, convert

SCENE = Path(__file__).with_name("tall.toml")
LOOKS = {"materials": "1", "patterns": "1", "allow_underrun": "1"}
SIZES = {
    name: {"units": "8" if engine.divides else "4"} if engine.line_buffered else {"scale": "1"}
    for name, engine in ENGINES.items()
}
OPTIONS = {
    name + ending: {"engine": name, **size, **looks}
    for ending, looks in (("", {}), ("-looks", LOOKS))
    for name, size in SIZES.items()
} | {"exact-light": {"engine": "exact", "light": "1", "units": "8"}}
LIGHT = "[light]\nposition = [20, 100, 250]\n"
PIXEL = (48, 2)
"""Column and row of a pixel where the post hides the wall and mirrors it."""


@cache
def design(engine: str) -> Design:
    """Return a design for a small scene on the tiny screen, which Icarus builds quickly."""
    scene = SCENE
    if "light" in OPTIONS[engine]:
        scene = BUILD / "test" / "tall_light.toml"
        scene.parent.mkdir(parents=True, exist_ok=True)
        scene.write_text(SCENE.read_text() + LIGHT)
    return design_for(scene, {"screen": "tiny", "rectangles": "3", **OPTIONS[engine]})


def recorded(engine: str, directory: Path, edit: tuple[str, str, str] | None = None) -> Waves:
    """Record the pixel's row, optionally with a text replaced in one of the design's modules."""
    sources = convert(design(engine).configuration, BUILD)
    if edit:
        module, old, new = edit
        copies = []
        for source in sources:
            text = source.read_text()
            if source.stem == module:
                assert old in text, f"{module} has changed: there is no {old}"
                text = text.replace(old, new)
            copies.append(directory / source.name)
            copies[-1].write_text(text)
        sources = copies
    model = build_model(design(engine).configuration, "icarus", build=directory, verilog=sources, bench=WINDOW_BENCH)
    return Waves(record(model, design(engine), (PIXEL[1], PIXEL[1]), directory / "row"))


def traced(waves: Waves, engine: str, column: int = PIXEL[0]) -> tuple[Ray, list[Reading]]:
    """Return a pixel's golden ray and the readings from the hardware."""
    ray = Ray(design(engine), PIXEL[1], column)
    return ray, read(waves, description_of(design(engine).configuration, ray.unit), ray)


@pytest.mark.parametrize("engine", OPTIONS)
def test_a_sound_design_has_no_difference(tmp_path, engine):
    """No pixel of the row differs; both rays of the chosen pixel hit something."""
    waves = recorded(engine, tmp_path)
    for column in range(0, design(engine).configuration.screen_geometry.columns, 3):
        ray, readings = traced(waves, engine, column)
        first = first_difference(readings)
        assert first is None, difference_line(ray, first)
    ray, readings = traced(waves, engine)
    view = View(description_of(design(engine).configuration, ray.unit).groups(ray), {}, 0, 1)
    for name in signal_names(view):
        assert waves.width(name), "a viewer would get signals that do not exist"
    assert [ray.winner(bounce) for bounce in (0, 1)] == [2, 1]
    quantities = {reading.probe.quantity for reading in readings}
    # A value that is never read could never be wrong.
    missing = {probe.quantity for probe in description_of(design(engine).configuration, ray.unit).probes} - quantities
    assert not missing, f"never read: {missing}"


def test_values_have_names_and_colours_are_colours():
    """The wrong one of three values is named; a colour is #rrggbb, alone and next to other values."""
    ray = Ray(design("seed"), PIXEL[1], PIXEL[0])
    probes = {probe.quantity: probe for probe in description_of(ray.config, ray.unit).probes}

    def line(quantity: str, golden: tuple[int, ...], found: tuple[int, ...], rectangle: int | None = None) -> str:
        return difference_line(ray, Reading(probes[quantity], Place(0, rectangle), 0, 0, golden, found))

    assert "pins, green is 9, expected 2;" in line("pins", (1, 2, 3), (1, 9, 3))
    assert "origin, z is 7, expected 6;" in line("origin", (4, 5, 6), (4, 5, 7))
    of_rectangle = ((0,) * 6 + (0xC8C8B4,), (0,) * 6 + (0xA00,), 0)
    assert "rectangle is #000a00, expected #c8c8b4;" in line("rectangle", *of_rectangle)
    assert "rectangle is 1, expected 0;" in line("rectangle", (0,) * 7, (1,) + (0,) * 6, 0)
    narrow = Ray(design_for(SCENE, {"screen": "tiny", "units": "8", "rectangles": "3", "colour_bits": "4"}), 2, 48)
    pixel = Reading(probes["pixel"], Place(0), 0, 0, (0x1F0,), (0,))
    assert "pixel is #000000, expected #10f000;" in difference_line(narrow, pixel)
    console = Console(width=160, record=True, file=io.StringIO())
    show(ray, [Reading(probes["pins"], Place(1), 0, 0, (1, 2, 3), (1, 9, 3))], console)
    assert "pins (red, green, blue)" in console.export_text()


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
        ("colour_combiner", "ray_colour_word = found_colour", "ray_colour_word = ~found_colour"),
        ("line_buffer", "read_address = read_offset", "read_address = 1 + read_offset"),
        ("video_generator", "vga_g <= pixel_green", "vga_g <= pixel_red"),
    ],
    "exact": [
        ("exact_control", "steps_write_z_buf = in_flight[2]", "steps_write_z_buf = 0"),
        ("rect_tester", "hit <= seen_2_crosses", "hit <= 0 && seen_2_crosses"),
        ("nearest_hit", "offered_product < nearest_product", "offered_product > nearest_product"),
        ("eye_register", "difference = twice_signed - mirrored", "difference = twice_signed + mirrored"),
    ],
    "beam": [
        ("rect_setup", "way_p = distance_2 * slope_p_2", "way_p = distance_2 + slope_p_2"),
        ("rect_walker", "way_p <= way_p + growth_way_p", "way_p <= way_p - growth_way_p"),
        ("ray_tester", "valid = ", "valid = 0 && "),
        ("fold_tester", "valid = ", "valid = 0 && "),
        ("nearest_of_two", "second_product < first_product", "second_product > first_product"),
        ("ray_fold", "mirrored = ", "mirrored = 1 + "),
        ("colour_mean", "mean = ", "mean = 1 + "),
    ],
}


@pytest.mark.slow_sets(
    quick=[
        "beam-colour_mean",
        "beam-fold_tester",
        "exact-rect_tester",
        "seed-divider",
        "seed-ray_mem",
        "seed-video_generator",
    ]
)
@pytest.mark.parametrize(
    ("engine", "edit"),
    [pytest.param(engine, edit, id=f"{engine}-{edit[0]}") for engine, edits in FAULTS.items() for edit in edits],
)
def test_names_the_module_of_a_fault(tmp_path, engine, edit):
    """Each fault is planted alone, in a different module."""
    ray, readings = traced(recorded(engine, tmp_path, edit), engine)
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


def test_the_command(tmp_path):
    """The exit code is 0 without a difference and 1 with one."""
    options = ["--simulator", "icarus", "--build", "build", "--pixel", "48,2"]
    options += ["--screen", "tiny", "--units", "8", "--rectangles", "3"]
    sound = called(str(SCENE), *options, cwd=tmp_path, program=main)
    assert sound.returncode == 0, sound.stdout + sound.stderr
    assert "The hardware agrees with the golden model." in sound.stdout
    assert "expected colour #" in sound.stdout
    # Files converted before are used as they are.
    (buffer,) = tmp_path.glob("build/model/*/verilog/z_buffer.v")
    buffer.write_text(buffer.read_text().replace("depth < nearest", "depth > nearest"))
    broken = called(str(SCENE), *options, cwd=tmp_path, program=main)
    assert broken.returncode == 1, broken.stdout + broken.stderr
    assert "module z_buffer" in broken.stdout


@pytest.mark.parametrize(
    ("options", "complaint"),
    [
        ((), "pixel: expected a ray's column and row, as in PIXEL=160,120, got none"),
        (("--pixel", "48"), "pixel: expected a ray's column and row, as in 160,120, got 48"),
        (("--pixel", "64,9", "--screen", "tiny"), "pixel: expected column from 0 to 63 and row from 0 to 47, got 64,9"),
        (("--pixel", "1,1", "--units", "7"), "units: 7 does not divide"),
        (("--pixel", "1,1", "no.toml"), "no.toml"),
    ],
)
def test_mistakes(refuses, options, complaint):
    """The error is one line without a traceback."""
    assert complaint in refuses(main, *options)


def test_names():
    """A signal's name gives its module, and a pixel's text gives its place."""
    assert module_of("bench.dut.ray_caster_renderer_i.ray_caster_i.ray_unit_12_i.z_buffer_i.found") == "z_buffer"
    assert module_of("bench.dut.ray_caster_renderer_i.line_buffer_3_i.write") == "line_buffer"
    assert module_of("bench.dut.irq") == "ray_caster_module"
    assert pixel_place("3, 4") == (3, 4)
    with pytest.raises(UserError, match="a ray's column and row"):
        pixel_place("3,-4")
