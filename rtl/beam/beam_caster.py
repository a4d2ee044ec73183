# SPDX-License-Identifier: MIT
"""The beam engine: all rectangles at once, one or two pixels per clock."""

from collections.abc import Mapping

from myhdl import always_comb, block, instances

from raycaster.configuration import Configuration
from raycaster.hdl.records import Record
from raycaster.hdl.signals import Tied, bit, side_by_side, tied, unsigned
from raycaster.rtl.beam.beam_lane import beam_lane
from raycaster.rtl.beam.lane_start import lane_start
from raycaster.rtl.beam.line_starter import line_starter
from raycaster.rtl.beam.row_register import row_register
from raycaster.rtl.common.interfaces import Vector
from raycaster.rtl.common.records import Facet, Look, Pixel, Walk, growth_of
from raycaster.rtl.common.widths import exact_slope_bits
from raycaster.rtl.engine.rect_setup import rect_setup


def known_facet(number: int, config: Configuration) -> dict[str, int]:
    """Return the known fields of a rectangle's facet; empty unless the scene is fixed."""
    if config.fixed is None:
        return {}
    rectangle = config.fixed.rectangles[number]
    distance = {"distance": config.fixed.distances[number]} if config.fixed.camera else {}
    look = {name: getattr(rectangle, name) for name in Look(config).layout}
    return {"usable": 1, "axis": rectangle.axis, **look, **distance}


def known_growth(number: int, config: Configuration) -> dict[str, int]:
    """Return the known fields of a rectangle's growth; empty unless the scene is fixed and the camera does not turn.

    Along a row either the way along p grows, or the bounds do; see rect_setup. If the camera turns, the growth
    registers also carry a row's start.
    """
    if config.fixed is None or config.turn:
        return {}
    rectangle, camera = config.fixed.rectangles[number], config.fixed.camera
    bounds = {"low_p": (rectangle.u_low, 0), "high_p": (rectangle.u_high, 0)}
    bounds |= {"low_q": (rectangle.v_low, 2), "high_q": (rectangle.v_high, 2)}
    known = {"way_p": 0} if rectangle.axis == 1 else dict.fromkeys(bounds, 0)
    if camera and rectangle.axis == 1:
        known |= {name: bound - camera[axis] for name, (bound, axis) in bounds.items()}
    elif camera:
        known["way_p"] = config.fixed.distances[number]
    return known


def fixing(record: Record, known: Mapping[str, int]) -> dict[str, Tied]:
    """Return the ports of a row_register for a record with these known field values."""
    live = {name: -1 for name in record.layout if name not in known}
    return {"live": tied(record.pack(live), record.word), "known": tied(record.pack(known), record.word)}


@block
def beam_caster(clk, reset, start_line, next_column, row_slope, camera, picture, rects, pixel, config: Configuration):
    """Compute a row's pixels: each next_column starts those of one clock, which follow `beam_latency` cycles later.

    Each column of a clock has its own lane. Lane i is i columns further along the row than lane 0, and every lane
    advances by as many columns as there are lanes.

    Args:
        clk: the clock.
        reset: synchronous, active high.
        start_line: strobe; begins a line. The last column of the previous line must have left by then.
        next_column: strobe; begins the columns of a clock. The first one must come at least `start_cycles` cycles after
            start_line.
        row_slope: signed, `factor_bits` bits; rows above the horizon. Constant from the third cycle after start_line
            on.
        camera: `Camera` of the live scene.
        picture: `Picture` of the live scene; run is not read.
        rects: `Rects`; drives index and fetch, reads usable and rect.
        pixel: `Pixel`; output, laid out as in `Vga`: with two pixels per clock, the low half of each channel is the
            left pixel.
        config: the design.
    """
    lanes = range(config.pixels)
    centre_column, view_distance = config.screen_geometry.centre_column, config.screen_geometry.view_distance

    load, last_rectangle = unsigned(config.rectangles), config.rectangles - 1
    new_facet, new_growth, new_start = Facet(config), growth_of(config), Walk(config)
    facets = [Facet(config) for _ in range(config.rectangles)]
    facet_words = [facet.word for facet in facets]
    growth_words = [[unsigned(bits) for bits in new_growth.layout.values()] for _ in facets]
    all_facets = side_by_side(facet_words)
    aims = [Vector(exact_slope_bits(config) + 1) for _ in lanes]
    aim = aims[0]

    if config.turn:
        # Everything that walks along a row starts at 0, and its first step is the start value; later steps are growth.
        start_sweep, enter = bit(), unsigned(config.pixels)
        grown = new_start
        starter = line_starter(
            clk, reset, start_line=start_line, camera=camera, row_slope=row_slope, loaded=load(last_rectangle), aim=aim,
            start_sweep=start_sweep, enter=enter, config=config,
        )  # fmt: skip
        setup = rect_setup(
            clk, reset, start_line=start_sweep, rects=rects, camera=camera, slope=aim, load=load, facet=new_facet,
            growth=new_growth, start=new_start, config=config,
        )  # fmt: skip
        aims = [aim for _ in lanes]
        enters = [enter(lane) for lane in lanes]
        loads, lane_starts = [tied(0, load) for _ in lanes], [Walk(config).tie({}) for _ in lanes]
    else:
        for lane, lane_aim in enumerate(aims):
            lane_aim.x, lane_aim.z = tied(view_distance, lane_aim.x), row_slope
            lane_aim.y = tied(lane - centre_column, lane_aim.y)
        grown = new_growth
        setup = rect_setup(
            clk, reset, start_line=start_line, rects=rects, camera=camera, slope=aim, load=load, facet=new_facet,
            growth=new_growth, start=new_start, config=config,
        )  # fmt: skip
        enters, loads, lane_starts = [tied(0, 1) for _ in lanes], [load], [new_start]
        if config.pixels > 1:
            late_load, first_start, second_start = unsigned(config.rectangles), Walk(config), Walk(config)
            late_starts = lane_start(
                clk, load=load, start=new_start, growth=new_growth, late_load=late_load, first_start=first_start,
                second_start=second_start,
            )  # fmt: skip
            loads, lane_starts = [late_load, late_load], [first_start, second_start]

    facet_registers = [
        row_register(clk, load(i + 1, i), new_facet.word, word=word, **fixing(new_facet, known_facet(i, config)))
        for i, word in enumerate(facet_words)
    ]
    # One register per field, so that a simulator need not split words to add growth in every column.
    growth_registers = [
        row_register(clk, load(i + 1, i), grown.word(grown.slice(name)[0] + 1, grown.slice(name)[1]), word=word,
            **fixing(Record({name: bits}), known_growth(i, config)))
        for i, words in enumerate(growth_words)
        for (name, bits), word in zip(grown.layout.items(), words, strict=True)
    ]  # fmt: skip
    # If the camera does not turn, growth is per column, and a step of two lanes is twice that.
    doubled = [] if config.turn or config.pixels == 1 else ["0"]
    all_growths = side_by_side(
        [part for words in growth_words for word in reversed(words) for part in [*doubled, word]]
    )

    pixels = [pixel] if config.pixels == 1 else [Pixel(config.colour_bits) for _ in lanes]
    casters = [
        beam_lane(
            clk, start_line=start_line, next_column=next_column, enter=enters[lane], load=loads[lane],
            start=lane_starts[lane], aim=aims[lane], facets=all_facets, growths=all_growths, camera=camera,
            picture=picture, pixel=pixels[lane], config=config,
        )
        for lane in lanes
    ]  # fmt: skip
    if config.pixels > 1:
        left, right = pixels

        both = pixel.joined(
            red=side_by_side([left.red, right.red]), green=side_by_side([left.green, right.green]),
            blue=side_by_side([left.blue, right.blue]),
        )  # fmt: skip

        @always_comb
        def join():
            pixel.word.next = both

    return instances()
