# SPDX-License-Identifier: MIT
"""All properties that are proved, with their configurations and depths."""

from __future__ import annotations

from itertools import product

from raycaster.configuration import MOST_RECTANGLES, MOST_REFLECTIONS, Configuration, configure
from raycaster.engines.beam import (
    AIM_LATENCY,
    TESTER_LATENCY,
    beam_latency,
    blend_latency,
    contest_latency,
    fold_lead,
    is_staged,
    mixes,
)
from raycaster.engines.engine import SETUP_LATENCY
from raycaster.engines.exact import AIM_CYCLES
from raycaster.fit.fixing import fixed_rectangle
from raycaster.fixed import FixedScene
from raycaster.hdl.signals import bits_for
from raycaster.program import scene_words
from raycaster.registers import address_bits, register_map
from raycaster.rtl.bus.avalon_interface import engine_word, size_word
from raycaster.rtl.common.records import camera_of, candidate_of, look_fields, mirror_of, rect_of, surface_of
from raycaster.rtl.common.widths import (
    BASIS_BITS,
    COORDINATE_BITS,
    DISTANCE_BITS,
    REFLECTION_BITS,
    WIDE_BITS,
    exact_slope_bits,
    eye_bits,
    factor_bits,
    fold_bits,
    index_bits,
    light_slope_bits,
    offset_bits,
    pixel_bits,
    position_bits,
    row_bits,
    share_bits,
    steepest_slope,
    turn_bits,
    unit_bits,
    walk_bits,
    wide_walk_bits,
)
from raycaster.rtl.scene.written_rect import CORNER, surface_mask
from raycaster.rtl.system.ray_caster import CONTROLS
from raycaster.scene import Camera, Rectangle, Scene
from raycaster.screens import Screen, Span
from raycaster.verif.formal.prover import BridgeWidths, FixedTable, FoldWidths, HostWidths, Property, TesterWidths

TOY_SCREEN = Screen(3, 2, 1, 3, Span(9, 1, 2, 1, active_high=True), Span(6, 1, 1, 3, active_high=True))
"""A screen with tripled pixels and a frame that is short enough to be run completely."""

SLOWEST = {9: (0, 1), 8: (7, 2), 7: (5, 2), 6: (3, 2), 5: (0, 2), 4: (3, 3), 3: (0, 3)}
"""By number of divider steps, fraction bits and divider bits that give it."""


def _signed_bits(least: int, beyond: int) -> int:
    """Return the width of a two's complement counter from `least`, which is negative, to below `beyond`."""
    return max((-least - 1).bit_length(), (beyond - 1).bit_length()) + 1


def _video(design: Configuration | Screen, label: str, small: bool) -> Property:
    screen = design if isinstance(design, Screen) else design.screen_geometry
    lead = None if isinstance(design, Screen) or design.facts.line_buffered else beam_latency(design)
    spans = {"H": screen.beats, "V": screen.vertical}
    parameters = {}
    for letter, span in spans.items():
        parameters |= {
            f"{letter}_VISIBLE": span.visible,
            f"{letter}_FRONT": span.front,
            f"{letter}_SYNC": span.sync,
            f"{letter}_BACK": span.back,
            f"{letter}_HIGH": int(span.active_high),
        }
    parameters |= {
        "DOUBLING": screen.doubling,
        "ROWS": screen.rows,
        "COLOUR_BITS": 8 if isinstance(design, Screen) else design.colour_bits * design.pixels,
        "CLOCKS": screen.clocks_per_pixel,
        "LEAD": lead or 0,
        "X_BITS": _signed_bits(-screen.beats.blank, screen.beats.visible),
        "Y_BITS": _signed_bits(-screen.vertical.blank, screen.vertical.visible),
        "REPEAT_BITS": bits_for(screen.doubling),
    }
    return Property(
        "video-timing",
        "sync, blanking and strobes come exactly at the standard's counts, for any inputs",
        design, label, ("video_generator", *([] if lead is None else ["pixel_clock"])), parameters, induction=1,
        small=small,
    )  # fmt: skip


def _avalon(config: Configuration, small: bool) -> Property:
    return Property(
        "avalon-agent",
        "reads are answered once and in order, no write is lost, commit is atomic, sticky bits and interrupt are kept",
        config,
        _label(config),
        ("avalon_interface", "camera_mem", "rect_mem", "rect_slot", "rect_sorter", "scene_word"),
        {
            "ADDRESS_BITS": address_bits(config.table),
            "VERSION_WORD": register_map(config.table)["version"].reset,
            "ENGINE_WORD": engine_word(config),
            "SIZE_WORD": size_word(config),
            "REFLECTIONS": config.reflections,
            "RECT_BITS": len(rect_of(config).word),
        },
        induction=3,
        reach=12,
        cut=("rect_sorter",),
        as_registers=("rect_mem",),
        small=small,
    )


def _host(address_bits: int, most_wait: int, most_latency: int, small: bool) -> Property:
    """Build the property for an agent that waits, and takes to answer, at most this many cycles."""
    return Property(
        "host-transfers",
        "each access of the processor is one transfer, stable while it waits, and ready once, in time",
        HostWidths(address_bits),
        f"{address_bits} bits, {most_wait} and {most_latency} cycles",
        ("avalon_host",),
        {"ADDRESS_BITS": address_bits, "MOST_WAIT": most_wait, "MOST_LATENCY": most_latency},
        induction=1,
        reach=2 * most_wait + most_latency + 5,
        small=small,
    )


BRIDGES = {
    "axi4lite": "a write and a read at a time are one transfer each, answered once, in time, and held until accepted",
    "wishbone": "each access is one transfer, acknowledged once, in time; an abandoned read disturbs no other access",
    "apb": "each access is one transfer, stable while it waits, and ready once, in time",
}
"""Claims about the bridge from each bus."""


def _bridge(bus: str, address_bits: int, most_wait: int, most_latency: int, small: bool) -> Property:
    """Build the property for an agent that waits, and takes to answer, at most this many cycles."""
    return Property(
        f"{bus}-transfers",
        BRIDGES[bus],
        BridgeWidths(bus, address_bits),
        f"{address_bits} bits, {most_wait} and {most_latency} cycles",
        (f"{bus}_bridge",),
        {"ADDRESS_BITS": address_bits, "MOST_WAIT": most_wait, "MOST_LATENCY": most_latency},
        # AXI's two directions wait for each other, limited only by the bounds.
        induction=2 * most_wait + most_latency + 5 if bus == "axi4lite" else 2,
        reach=3 * (most_wait + most_latency) + 8,
        small=small,
    )


def _order(config: Configuration, small: bool) -> Property:
    bound = config.group_cycles - 2  # done comes two cycles before the next group may start
    return Property(
        "ray-order",
        "each rectangle that a ray may hit is visited once and in order, and ends early if behind all; reflections + 1 "
        "rays, done within the budget's cycles",
        config,
        _label(config),
        (CONTROLS[config.engine].__name__, "ray_sequencer", "rect_sequencer"),
        {
            "RECTANGLES": config.rectangles,
            "INDEX_BITS": index_bits(config),
            "STEPS": config.slot_cycles,
            "SLOT_BITS": bits_for(config.slot_cycles),
            "REFLECTIONS": config.reflections,
            "REFLECTION_BITS": REFLECTION_BITS,
            "RESULT_LATENCY": config.pass_latency,
            "RUN_BOUND": bound,
            "CULLING": int(config.culling),
        },
        induction=1,
        reach=bound + 2 if config.rectangles == 2 and config.reflections == 1 and config.slot_cycles < 5 else 0,
        small=small,
    )


def _shadow_order(config: Configuration, small: bool) -> Property:
    bound = config.group_cycles - 2  # done comes two cycles before the next group may start
    return Property(
        "shadow-order",
        "a pass of rays and a shadow pass each test every rectangle that they may hit once and in order; a shadow pass "
        "follows if a hit point is in question, ends early only if none is, and none of its tests reaches a z buffer",
        config,
        _label(config),
        ("exact_control", "ray_sequencer", "rect_sequencer", "shadow_sequencer"),
        {
            "RECTANGLES": config.rectangles,
            "INDEX_BITS": index_bits(config),
            "REFLECTIONS": config.reflections,
            "REFLECTION_BITS": REFLECTION_BITS,
            "AIM_CYCLES": AIM_CYCLES,
            "RUN_BOUND": bound,
        },
        induction=1,
        reach=bound + 2 if config.rectangles == 2 and config.reflections == 1 else 0,
        small=small,
    )  # fmt: skip


def _sections(config: Configuration, small: bool) -> Property:
    return Property(
        "line-sections",
        "a section of the line buffer is never read while it is written",
        config,
        _label(config),
        ("line_buffer",),
        {
            "GROUPS": config.groups,
            "WRITE_BITS": offset_bits(config),
            "READ_BITS": bits_for(config.groups),
            "ADDRESS_BITS": bits_for(2 * config.groups),
            "PIXEL_BITS": pixel_bits(config),
        },
        induction=1,
        small=small,
    )


def _counters(config: Configuration, small: bool) -> Property:
    cut = ("ray_unit", "line_buffer", "video_generator", *(("group_culler",) if config.culling else ()))
    return Property(
        "render-counters",
        "the renderer's counters stay in range, and each group is written once, into its row",
        config,
        _label(config),
        ("ray_caster_renderer", "clock_gate", "ray_caster", "ray_control", "ray_sequencer", "rect_sequencer", *cut),
        {
            "RECTANGLES": config.rectangles,
            "INDEX_BITS": index_bits(config),
            "COLOUR_BITS": config.colour_bits,
            "GROUPS": config.groups,
            "UNITS": config.units,
            "ROWS": config.screen_geometry.rows,
            "ROW_BITS": row_bits(config),
            "COLUMN_BITS": offset_bits(config),
            "OFFSET_BITS": bits_for(config.groups),
            "UNIT_BITS": unit_bits(config),
        },
        induction=1,
        cut=cut,
        reach=20 if config.rectangles == 2 else 0,
        small=small,
    )


def _divider(config: Configuration, part: int, small: bool) -> Property:
    return Property(
        "divider-exact",
        "quotient * divisor + remainder = dividend, rounded as configured, or overflow",
        config,
        f"{_label(config)} {('digits', 'product', 'result')[part]}",
        ("divider", "divider_step"),
        {
            "WIDTH": position_bits(config),
            "BITS": config.divider_bits,
            "STEPS": config.divider_steps,
            "NEAREST": int(config.rounding == "nearest"),
            "PART": part,
        },
        induction=1,
        any_product=part == 1,
        small=small,
    )


def _finder(config: Configuration, small: bool) -> Property:
    return Property(
        "finder-quotients",
        "hit, depth and point are those of the golden model's a + b * (c - d) / e, at full width",
        config,
        _label(config),
        (
            "intersection_finder",
            "intersection_helper",
            "magnitude",
            *(("cell_parity",) if config.patterns else ()),
            "divider",
        ),
        {
            "POSITION_BITS": position_bits(config),
            "FRACTION_BITS": config.fraction_bits,
            "LOOK_BITS": _look_bits(config),
            "STEPS": config.divider_steps,
            "PATTERNS": int(config.patterns),
        },
        induction=1,
        cut=("divider",),
        any_product=True,
        reach=config.divider_steps + 5,
        small=small,
    )


def _tester(coordinate_bits: int, reflections: int, small: bool) -> Property:
    last = (1 << coordinate_bits) - 1
    eye_bits = (last * (reflections + 1)).bit_length() + 1
    widths = TesterWidths(coordinate_bits, coordinate_bits, eye_bits, corners=reflections > 1)
    return Property(
        "tester-exact",
        "a rectangle is hit if the quotient's point is within it and beyond the mirror, or in a corner with it",
        widths,
        f"{coordinate_bits} bits, {reflections} mirrors",
        ("rect_tester", "extent_tester"),
        {
            "COORDINATE_BITS": widths.coordinate,
            "SLOPE_BITS": widths.slope,
            "EYE_BITS": widths.eye,
            "REFLECTIONS": reflections,
        },
        induction=4,
        reach=5,
        small=small,
    )


def _look_bits(config: Configuration) -> int:
    return sum(look_fields(config.materials, config.patterns).values())


def _tester_products(config: Configuration) -> Property:
    return Property(
        "tester-products",
        "a rectangle is hit if the cross-multiplied definition says so, and no distance overflows, at full width",
        config,
        _label(config),
        ("rect_tester", "extent_tester"),
        {
            "COORDINATE_BITS": COORDINATE_BITS,
            "LOOK_BITS": _look_bits(config),
            "SLOPE_BITS": light_slope_bits(config) if config.light else exact_slope_bits(config),
            "EYE_BITS": eye_bits(config),
            "REFLECTIONS": config.reflections,
        },
        induction=4,
        any_product=True,
        reach=5,
    )  # fmt: skip


def _nearest_products(config: Configuration, small: bool) -> Property:
    return Property(
        "nearest-products",
        "the first of the nearest hits is kept, in the order of cross-multiplication, at full width",
        config,
        _label(config),
        ("nearest_hit",),
        {
            "SURFACE_BITS": len(surface_of(config).word),
            "SLOPE_BITS": exact_slope_bits(config),
            "DISTANCE_BITS": eye_bits(config) - 1,
        },
        induction=2,
        any_product=True,
        reach=6,
        small=small,
    )


def _eye(config: Configuration, small: bool) -> Property:
    return Property(
        "eye-exact",
        "the eye is the camera mirrored in each plane, in range, with the right signs and corner, at full width",
        config,
        _label(config),
        ("eye_register",),
        {
            "COORDINATE_BITS": COORDINATE_BITS,
            "LOOK_BITS": _look_bits(config),
            "BASIS_BITS": len(camera_of(config).word) - 3 * COORDINATE_BITS,
            "EYE_BITS": eye_bits(config),
            "REFLECTIONS": config.reflections,
        },
        induction=1,
        reach=6,
        small=small,
    )


def _cell(config: Configuration, small: bool) -> Property:
    return Property(
        "cell-products",
        "the digits that give a pattern's cell are those of the quotient, by long division, at full width",
        config,
        _label(config),
        ("cell_finder", "divider_step"),
        {
            "COORDINATE_BITS": COORDINATE_BITS,
            "LOOK_BITS": _look_bits(config),
            "SLOPE_BITS": exact_slope_bits(config),
            "EYE_BITS": eye_bits(config),
        },
        induction=2,
        any_product=True,
        reach=8,
        small=small,
    )


def _shadow(config: Configuration, small: bool) -> Property:
    return Property(
        "shadow-products",
        "the ray from the light leads to the hit point, whose shadow is decided as the definition says, at full width",
        config,
        _label(config),
        ("shadow_ray", "hit_component", "shadow_register"),
        {
            "COORDINATE_BITS": COORDINATE_BITS,
            "LOOK_BITS": _look_bits(config),
            "SLOPE_BITS": exact_slope_bits(config),
            "EYE_BITS": eye_bits(config),
            "LIGHT_BITS": light_slope_bits(config),
            "CAMERA_BITS": len(camera_of(config).word),
        },
        induction=2,
        any_product=True,
        reach=10,
        small=small,
    )


def _slope(config: Configuration, small: bool) -> Property:
    screen = config.screen_geometry
    return Property(
        "slope-exact",
        "a pixel's slope in the exact engine has the definition's sign and magnitude, and fits, at full width",
        config,
        _label(config),
        (*(("turned_generator", "slope_component") if config.turn else ("ray_generator",)), "magnitude"),
        {
            "TURN": int(config.turn),
            "SLOPE_BITS": exact_slope_bits(config),
            "COORDINATE_BITS": COORDINATE_BITS,
            "BASIS_BITS": BASIS_BITS,
            "VIEW_DISTANCE": screen.view_distance,
            "CENTRE": screen.centre_column,
            "HORIZON": screen.horizon_row,
            "COLUMNS": screen.columns,
            "ROWS": screen.rows,
            "UNITS": config.units,
            "UNIT_BITS": unit_bits(config),
            "OFFSET_BITS": offset_bits(config),
            "ROW_BITS": row_bits(config),
            "COLUMN_BITS": (screen.columns + config.units).bit_length() + 1,
        },
        induction=2,
        any_product=config.turn,
        reach=4,
        small=small,
    )


def _group(config: Configuration, small: bool) -> Property:
    return Property(
        "group-safe",
        "no rectangle that a ray of the group hits is left out, at full width",
        config,
        _label(config),
        ("group_tester",),
        {
            "UNITS": config.units,
            "UNIT_BITS": unit_bits(config),
            "RECTANGLES": config.rectangles,
            "INDEX_BITS": index_bits(config),
            "SLOPE_BITS": exact_slope_bits(config) + 1,
            "DISTANCE_BITS": DISTANCE_BITS,
            "WAY_BITS": walk_bits(config),
            "WALK_BITS": wide_walk_bits(config),
            "GROWTH_BITS": WIDE_BITS,
        },
        induction=2,
        reach=4,
        small=small,
    )


def _row_setup(config: Configuration, small: bool) -> Property:
    # In the culler it has multipliers made of adders, wider bounds, and no looks.
    culler = config.culling
    return Property(
        "row-setup",
        "each rectangle is loaded once, in order, with its distances and their products with the slope, at full width",
        config,
        _label(config),
        ("rect_setup",),
        {
            "TURN": int(config.turn),
            "ADDERS": int(culler),
            "BOUND_BITS": WIDE_BITS if culler else COORDINATE_BITS,
            "TO_BOUND_BITS": WIDE_BITS if culler else DISTANCE_BITS,
            "RECTANGLES": config.rectangles,
            "INDEX_BITS": index_bits(config),
            "COORDINATE_BITS": COORDINATE_BITS,
            "LOOK_BITS": _look_bits(config),
            "BASIS_BITS": len(camera_of(config).word) - 3 * COORDINATE_BITS,
            "SLOPE_BITS": exact_slope_bits(config) + 1,
            "WALK_BITS": walk_bits(config),
        },
        induction=5,
        any_product=True,
        reach=10,
        small=small,
    )


def _line_start(config: Configuration, small: bool) -> Property:
    screen = config.screen_geometry
    return Property(
        "line-start",
        "with a turning camera, a line gets its first column's slope, and then the growth per step, at full width",
        config,
        _label(config),
        ("line_starter",),
        {
            "PIXELS": config.pixels,
            "CAMERA_BITS": len(camera_of(config).word),
            "BASIS_BITS": BASIS_BITS,
            "FACTOR_BITS": factor_bits(config),
            "SLOPE_BITS": exact_slope_bits(config) + 1,
            "VIEW_DISTANCE": screen.view_distance,
            "CENTRE": screen.centre_column,
            "AIM_LATENCY": AIM_LATENCY,
            "LATENCY": SETUP_LATENCY,
        },
        induction=AIM_LATENCY + 1,
        any_product=True,
        reach=14,
        small=small,
    )


def _walked(config: Configuration, lane: int, small: bool) -> Property:
    screen = config.screen_geometry
    return Property(
        "walked-products",
        "without a turning camera, a rectangle's registers are its distances times the slope, at full width",
        config,
        f"{_label(config)} lane {lane}" if config.pixels > 1 else _label(config),
        ("rect_walker", "slope_walker", *(("lane_start",) if config.pixels > 1 else ())),
        {
            "LANE": lane,
            "PIXELS": config.pixels,
            "RECTANGLES": config.rectangles,
            "WALK_BITS": walk_bits(config),
            "DISTANCE_BITS": DISTANCE_BITS,
            "SLOPE_BITS": exact_slope_bits(config) + 1,
            "VIEW_DISTANCE": screen.view_distance,
            "CENTRE": screen.centre_column,
            "STEEPEST": steepest_slope(config),
            "COLUMNS": screen.columns,
        },
        induction=1,
        any_product=True,
        reach=6,
        small=small,
    )


def _turned_walks(config: Configuration, small: bool) -> Property:
    return Property(
        "turned-walks",
        "with a turning camera, a rectangle's registers are its distances times the slope, at full width",
        config,
        _label(config),
        ("rect_walker", "slope_walker"),
        {
            "WALK_BITS": walk_bits(config),
            "DISTANCE_BITS": DISTANCE_BITS,
            "SLOPE_BITS": exact_slope_bits(config) + 1,
            "STEEPEST": steepest_slope(config),
        },
        induction=1,
        any_product=True,
        reach=5,
        small=small,
    )


def _blend(config: Configuration, small: bool) -> Property:
    mirrors = config.reflections
    return Property(
        "blend-exact",
        "a pixel is the golden model's blend of its rays, with mirrors of half, or one of any quarters, at full width",
        config,
        _label(config),
        ("colour_blend", *(("colour_mix" if mixes(config) else "colour_mean",) if mirrors else ()), "colour_seen"),
        {
            "MIRRORS": mirrors,
            "MIXES": int(mixes(config)),
            "COLOUR_BITS": config.colour_bits,
            "LATENCY": blend_latency(config),
        },
        induction=blend_latency(config),
        reach=blend_latency(config) + 2,
        small=small,
    )


def _depth(config: Configuration, small: bool) -> Property:
    return Property(
        "nearest-depth",
        "the first of the hits that are nearest along x is kept, with all its data, at full width",
        config,
        _label(config),
        ("z_buffer",),
        {
            "POSITION_BITS": position_bits(config),
            "LOOK_BITS": _look_bits(config),
            "MATERIALS": int(config.materials),
        },
        induction=2,
        reach=6,
        small=small,
    )


def _contest(config: Configuration, small: bool) -> Property:
    candidate = candidate_of(config)
    numerator, denominator = len(candidate.numerator), len(candidate.denominator)
    return Property(
        "contest-products",
        "the nearer of two candidates wins, by cross-multiplication, or the first if they tie, at full width",
        config,
        _label(config),
        ("nearest_of_two",),
        {
            "LATENCY": contest_latency(config),
            "NUMERATOR_BITS": numerator,
            "DENOMINATOR_BITS": denominator,
            "REST_BITS": len(candidate.word) - 2 - numerator - denominator,
        },
        induction=contest_latency(config),
        any_product=True,
        reach=contest_latency(config) + 2,
        small=small,
    )


def _shares(config: Configuration, small: bool) -> Property:
    return Property(
        "shares-exact",
        "a pixel is the golden model's blend of what its rays saw one after the other, at full width",
        config,
        _label(config),
        ("colour_combiner", "colour_share", "colour_sum"),
        {
            "MATERIALS": int(config.materials),
            "REFLECTIONS": config.reflections,
            "COLOUR_BITS": config.colour_bits,
            "SHARE_BITS": share_bits(config),
        },
        induction=1,
        reach=config.reflections + 5,
        small=small,
    )


def _fold(coordinate_bits: int, slope_bits: int, view_distance: int, mirrors: int, small: bool) -> Property:
    turned = not view_distance
    widths = FoldWidths(coordinate_bits, slope_bits, mirrors, staged=turned)
    return Property(
        "fold-exact",
        "a ray hits a rectangle if the ray from the mirrored eye, by a division, is within it and beyond the mirror",
        widths,
        f"{coordinate_bits} and {slope_bits} bits, {mirrors} mirrors{', turned' if turned else ''}",
        ("ray_fold", "ray_tester", "fold_tester", "bound_tester"),
        {
            "COORDINATE_BITS": widths.coordinate,
            "SLOPE_BITS": widths.slope,
            "VIEW_DISTANCE": view_distance,
            "MIRRORS": mirrors,
            "WALK_BITS": widths.walk,
            "FOLD_BITS": widths.fold,
            "NUMERATOR_BITS": widths.numerator,
        },
        induction=8,
        reach=9,
        small=small,
    )


def _exact_unit(config: Configuration) -> tuple[str, tuple[str, ...], dict[str, int]]:
    """Return a unit's slope generator, its modules that depend on the design, and the parameters of its wrappers."""
    generator = "turned_generator" if config.turn else "ray_generator"
    patterns = ("cell_finder", "divider_step", "pattern_colour") if config.patterns else ()
    parameters = {
        "PATTERNS": int(config.patterns),
        "RECTANGLES": config.rectangles,
        "INDEX_BITS": index_bits(config),
        "COORDINATE_BITS": COORDINATE_BITS,
        "LOOK_BITS": _look_bits(config),
        "CAMERA_BITS": len(camera_of(config).word),
        "SLOPE_BITS": exact_slope_bits(config),
        "EYE_BITS": eye_bits(config),
        "ROW_BITS": row_bits(config),
        "OFFSET_BITS": offset_bits(config),
    }
    return generator, (generator, *patterns), parameters


def _unit_wiring(config: Configuration, small: bool) -> Property:
    generator, parts, parameters = _exact_unit(config)
    return Property(
        "unit-wiring",
        "each block of a unit gets the inputs that its own proof assumes, and the nearest hit, at full width",
        config,
        _label(config),
        ("exact_unit", "exact_control", "ray_sequencer", "rect_sequencer", "rect_tester", "nearest_hit", "eye_register",
         "colour_combiner", "colour_share", "colour_sum", *parts),
        parameters | {"REFLECTIONS": config.reflections},
        cut=(generator,),
        induction=config.pass_latency,
        any_product=True,
        reach=2 * config.pass_latency + 9,
        small=small,
    )  # fmt: skip


def _shadow_wiring(config: Configuration, small: bool) -> Property:
    generator, parts, parameters = _exact_unit(config)
    return Property(
        "shadow-wiring",
        "the test gets the ray or its shadow ray, which gets the nearest hit, and a pixel its colour in this light",
        config,
        _label(config),
        ("exact_unit", "exact_control", "ray_sequencer", "rect_sequencer", "shadow_sequencer", "rect_tester",
         "nearest_hit", "eye_register", "shadow_ray", "shadow_register", "ray_switch", "shade_colour", *parts),
        parameters
        | {
            "LIGHT_BITS": light_slope_bits(config),
            "MIRROR_BITS": len(mirror_of(config).word),
            "TRAVEL": config.pass_latency - 1,
        },
        cut=(generator,),
        induction=4,
        any_product=True,
        reach=30,
        small=small,
    )  # fmt: skip


def _fold_products(config: Configuration, small: bool) -> Property:
    return Property(
        "fold-products",
        "at each mirror the ray is folded like the mirrored eye and slope, and no number overflows, at full width",
        config,
        _label(config),
        ("ray_fold",),
        {
            "COORDINATE_BITS": COORDINATE_BITS,
            "SLOPE_BITS": exact_slope_bits(config),
            "STEEPEST": steepest_slope(config),
            "REFLECTIONS": config.reflections,
            "WALK_BITS": walk_bits(config),
            "TURN_BITS": turn_bits(config),
            "FOLD_BITS": fold_bits(config),
        },
        induction=4,
        any_product=True,
        reach=5,
        small=small,
    )


def _beam_tester(config: Configuration, folded: bool, small: bool) -> Property:
    latency = TESTER_LATENCY + (fold_lead(config) if folded else 0)
    return Property(
        "beam-tester-products",
        "a rectangle is hit if the cross-multiplied definition from the mirrored eye says so, at full width",
        config,
        f"{_label(config)} {'folded' if folded else 'straight'}",
        ("fold_tester" if folded else "ray_tester", "bound_tester"),
        {
            "FOLDED": int(folded),
            "STAGED": int(is_staged(config)),
            "TURN": int(config.turn),
            "PATTERNS": int(config.patterns),
            "COORDINATE_BITS": COORDINATE_BITS,
            "LOOK_BITS": _look_bits(config),
            "SLOPE_BITS": exact_slope_bits(config),
            "STEEPEST": steepest_slope(config),
            "REFLECTIONS": config.reflections,
            "WALK_BITS": walk_bits(config),
            "TURN_BITS": turn_bits(config),
            "FOLD_BITS": fold_bits(config),
            "NUMERATOR_BITS": len(candidate_of(config).numerator),
            "INDEX_BITS": index_bits(config),
            "VIEW_DISTANCE": config.screen_geometry.view_distance,
        },
        induction=latency + 1,
        any_product=True,
        reach=latency + 2,
        small=small,
    )


FIXED_SCENE = Scene(
    camera=Camera(position=(20, 250, 100)),
    rect=(
        Rectangle(corners=((0, 100, 0), (511, 420, 0)), colour=(200, 200, 180)),
        Rectangle(corners=((300, 400, 180), (300, 60, 0)), colour=(80, 160, 255), mirror=1.0),
        Rectangle(corners=((200, 270, 20), (130, 270, 140)), colour=(255, 64, 32), mirror=0.25),
    ),
)
"""A floor, a wall and a post; corners in any order."""


def _fixed(engine: str, alike: bool, small: bool) -> Property:
    """Build the property with rectangles that are all different, or almost alike."""
    rect = (FIXED_SCENE.rect[1],) * 3 if alike else FIXED_SCENE.rect
    if alike:
        rect = (*rect[:2], rect[2].model_copy(update={"colour": (1, 2, 3)}))
    options = {"engine": engine, "materials": not alike, "allow_underrun": True}
    general = configure(rectangles=len(rect), **options)
    every = (1 << len(rect)) - 1
    fixed = configure(fixed=FixedScene(tuple(map(fixed_rectangle, rect)), (every, every)), **options)
    words = dict(scene_words(FIXED_SCENE.model_copy(update={"rect": rect}), general))
    registers = register_map(len(rect))
    parameters = {
        f"{name.upper()}_{index}": words[registers[f"rectangle[{index}].{name}"].address]
        for index in range(len(rect))
        for name in ("corner_0", "corner_1", "surface")
    }
    return Property(
        "fixed-rects",
        "a fixed scene's table returns the same rectangles as a memory that holds the scene's words",
        FixedTable(general, fixed),
        f"{engine}, {'alike' if alike else 'different'}",
        ("rect_mem", "rect_slot", "rect_sorter", "rect_rom"),
        {
            "INDEX_BITS": index_bits(fixed),
            "ADDRESS_BITS": address_bits(general.table),
            "RECT_BITS": len(rect_of(fixed).word),
            "LATENCY": fixed.facts.rect_latency,
            "CORNER_BITS": CORNER.implemented,
            "SURFACE_BITS": surface_mask(general),
            **parameters,
        },
        induction=3,
        reach=16,
        as_registers=("rect_mem",),
        small=small,
    )


def _label(config: Configuration) -> str:
    return config.name.removeprefix("seed-")


def _tiny(**values: int | str) -> Configuration:
    return configure(screen="tiny", units=2, allow_underrun=True, **values)


def _ray_control(rectangles: int, reflections: int, steps: int, culling: bool) -> Configuration:
    fraction_bits, divider_bits = SLOWEST[steps]
    return _tiny(
        rectangles=rectangles,
        reflections=reflections,
        fraction_bits=fraction_bits,
        divider_bits=divider_bits,
        culling=culling,
    )


DEFAULT = configure()


def _one_unit(**values: int | str) -> Configuration:
    """Return a design that converts quickly, for properties that do not depend on the number of ray units."""
    return configure(units=1, allow_underrun=True, **values)


EXACT = tuple(
    _one_unit(engine="exact", reflections=reflections, **options)
    for reflections in range(MOST_REFLECTIONS + 1)
    for options in ({}, {"turn": True}, {"turn": True, "materials": True, "patterns": True})
)
"""The exact engine at every width that it can have, from the narrowest to the widest."""


LIGHT = tuple(
    _one_unit(engine="exact", light=True, reflections=reflections, **options)
    for reflections in range(MOST_REFLECTIONS + 1)
    for options in ({}, {"turn": True, "materials": True, "patterns": True})
)
"""The exact engine with a light, likewise."""


def _beam(**options: int | str) -> Configuration:
    """Return a design for properties that do not depend on the number of rectangles."""
    return configure(engine="beam", rectangles=2, **options)


BEAM = _beam()
BEAM_PAIRS = _beam(rows=180, scale=6, pixels=2)
BEAM_TURN = _beam(turn=True)
BEAM_TURN_PAIRS = _beam(rows=180, scale=6, pixels=2, turn=True)
BEAM_DEEPEST = _beam(turn=True, patterns=True, reflections=4)

PROPERTIES: list[Property] = [
    _video(_one_unit(), "vga240", small=True),
    _video(_one_unit(rows=200), "vga200", small=True),
    _video(_one_unit(screen="tiny"), "tiny48", small=True),
    _video(TOY_SCREEN, "toy", small=True),
    _video(configure(engine="beam", screen="tiny", rectangles=2, scale=1), "beam tiny48", small=True),
    _video(configure(engine="beam", rows=180, scale=6, rectangles=2, pixels=2), "beam 1080, 2 pixels", small=True),
    _avalon(_one_unit(rectangles=2), small=True),
    _avalon(_one_unit(rectangles=2, reflections=2, rounding="nearest", fraction_bits=4, rows=200), small=False),
    _host(address_bits(DEFAULT.table), 1, 2, small=True),
    _host(address_bits(MOST_RECTANGLES), 9, 7, small=False),
    *(
        _bridge(bus, address_bits(rectangles), wait, latency, small)
        for bus in BRIDGES
        for rectangles, wait, latency, small in ((DEFAULT.table, 1, 2, True), (MOST_RECTANGLES, 3, 4, False))
    ),
    *(
        _order(
            _ray_control(rectangles, reflections, steps, culling),
            small=(rectangles, reflections, culling) in {(2, 1, True), (4, 2, True), (2, 1, False)},
        )
        for culling in (True, False)
        for rectangles in (2, 3, 4)
        for reflections in (0, 1, 2)
        for steps in SLOWEST
    ),
    *(
        _order(_ray_control(2, reflections, steps, culling), small=False)
        for culling in (True, False)
        for reflections in (3, MOST_REFLECTIONS)
        for steps in (min(SLOWEST), max(SLOWEST))
    ),
    _order(_one_unit(divider_bits=1), small=False),  # the control of the default design
    *(
        _order(
            _tiny(engine="exact", rectangles=rectangles, reflections=reflections, culling=True),
            small=(rectangles, reflections) in {(2, 1), (4, 2)},
        )
        for rectangles in (2, 3, 4)
        for reflections in range(MOST_REFLECTIONS + 1)
    ),
    _order(_one_unit(engine="exact"), small=False),
    _order(_one_unit(engine="exact", reflections=MOST_REFLECTIONS), small=False),
    *(
        _shadow_order(
            _tiny(engine="exact", rectangles=rectangles, reflections=reflections, light=True),
            small=(rectangles, reflections) == (2, 1),
        )
        for rectangles in (2, 3, 4)
        for reflections in range(MOST_REFLECTIONS + 1)
    ),
    *(
        _shadow_order(_one_unit(engine="exact", light=True, reflections=reflections), small=False)
        for reflections in (1, MOST_REFLECTIONS)
    ),
    _sections(DEFAULT, small=True),
    _sections(configure(reflections=2), small=False),
    _sections(_tiny(rectangles=2), small=True),
    _sections(configure(units=16, rectangles=4), small=False),
    _counters(DEFAULT, small=True),
    _counters(configure(rows=200, reflections=2), small=False),
    _counters(configure(reflections=MOST_REFLECTIONS), small=False),
    _counters(_tiny(rectangles=2), small=True),
    _counters(_tiny(rectangles=2, culling=False), small=False),
    _counters(configure(units=16, rectangles=4), small=False),
    _counters(configure(rows=60, units=16, rectangles=2, reflections=0), small=False),
    _finder(_one_unit(), small=True),
    _finder(_one_unit(patterns=True, materials=True), small=False),
    _finder(_one_unit(fraction_bits=8, rounding="nearest", divider_bits=2), small=False),
    _depth(_one_unit(), small=True),
    _depth(_one_unit(materials=True, patterns=True, fraction_bits=8), small=False),
    _contest(BEAM, small=True),
    _contest(BEAM_PAIRS, small=True),
    _contest(BEAM_TURN, small=False),
    _contest(BEAM_TURN_PAIRS, small=False),
    _contest(BEAM_DEEPEST, small=True),
    *(
        _shares(_one_unit(engine="exact", reflections=reflections, materials=materials), small)
        for reflections, materials, small in (
            (1, False, True),
            (1, True, False),
            (2, False, False),
            (2, True, True),
            (3, False, False),
            (3, True, False),
            (4, False, False),
            (4, True, False),
        )
    ),
    _group(configure(engine="exact", culling=True), small=True),
    _group(configure(), small=False),
    _tester(1, 2, small=True),
    _tester(2, 1, small=True),
    _tester(2, 2, small=False),
    _tester(3, 1, small=False),
    _tester(4, 1, small=False),
    *(_tester_products(config) for config in (*EXACT, *LIGHT)),
    *(_nearest_products(config, small=config is EXACT[0]) for config in EXACT),
    *(_eye(config, small=config is EXACT[-1]) for config in EXACT),
    *(_cell(config, small=False) for config in EXACT if config.patterns),
    _cell(_one_unit(engine="exact", patterns=True), small=False),
    *(_shadow(config, small=config in (LIGHT[0], LIGHT[-1])) for config in LIGHT),
    *(_shadow_wiring(config, small=config is LIGHT[2]) for config in (LIGHT[2], LIGHT[3], LIGHT[4], LIGHT[-1])),
    _unit_wiring(_one_unit(engine="exact"), small=True),
    _unit_wiring(_one_unit(engine="exact", reflections=2), small=False),
    _unit_wiring(_one_unit(engine="exact", turn=True, materials=True, patterns=True), small=False),
    _unit_wiring(EXACT[-1], small=False),
    _slope(configure(engine="exact"), small=False),
    _slope(configure(engine="exact", rows=200), small=False),
    _slope(configure(engine="exact", turn=True), small=True),
    _slope(configure(engine="exact", turn=True, reflections=2), small=False),
    _blend(BEAM, small=False),
    _blend(_beam(reflections=2), small=True),
    *(_blend(_beam(reflections=reflections), small=False) for reflections in (3, MOST_REFLECTIONS)),
    _blend(_beam(materials=True), small=True),
    _row_setup(configure(engine="beam"), small=True),
    _row_setup(BEAM_TURN_PAIRS, small=False),
    _row_setup(configure(engine="exact", culling=True), small=True),
    _line_start(BEAM_TURN, small=True),
    _line_start(BEAM_TURN_PAIRS, small=False),
    _walked(BEAM, 0, small=True),
    _walked(BEAM_PAIRS, 0, small=False),
    _walked(BEAM_PAIRS, 1, small=False),
    _turned_walks(BEAM_TURN, small=True),
    _turned_walks(BEAM_TURN_PAIRS, small=False),
    _fold(2, 1, 1, 1, small=True),
    _fold(2, 1, 0, 1, small=False),
    _fold(2, 1, 1, 2, small=False),
    _fold(2, 2, 2, 1, small=False),
    _fold(2, 2, 2, 2, small=False),
    _fold(3, 2, 3, 1, small=False),
    _fold_products(BEAM, small=True),
    _fold_products(_beam(reflections=2), small=False),
    _fold_products(BEAM_PAIRS, small=False),
    _fold_products(BEAM_TURN_PAIRS, small=False),
    _fold_products(BEAM_DEEPEST, small=False),
    *(
        _beam_tester(config, folded, small=config is BEAM)
        for config in (BEAM, _beam(reflections=2), BEAM_PAIRS, BEAM_TURN_PAIRS, BEAM_DEEPEST)
        for folded in (False, True)
    ),
    _fixed("seed", False, small=True),
    _fixed("seed", True, small=False),
    _fixed("beam", False, small=True),
    _fixed("beam", True, small=False),
    *(
        _divider(
            _tiny(rectangles=2, fraction_bits=fraction_bits, divider_bits=bits, rounding=rounding), part, small=False
        )
        for fraction_bits, bits, rounding in (
            *product((0,), (3, 2, 1), ("truncate", "nearest")),
            *((1, 3, "nearest"), (4, 3, "truncate"), (8, 2, "nearest"), (8, 1, "nearest")),
        )
        for part in range(3)
    ),
]
