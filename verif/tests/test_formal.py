# SPDX-License-Identifier: MIT
"""The proofs hold for the design, and each fails when a fault is planted in the Verilog."""

from __future__ import annotations

import json
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from raycaster.errors import UserError
from raycaster.verif.formal.properties import PROPERTIES
from raycaster.verif.formal.prove import main
from raycaster.verif.formal.prover import Property, Result, missing_tools, prove, refute

pytestmark = pytest.mark.skipif(bool(missing_tools()), reason=f"not installed: {', '.join(missing_tools())}")


def chosen(name: str, label: str) -> Property:
    """Return the property with this name for the design with this label."""
    [found] = [proof for proof in PROPERTIES if (proof.name, proof.label) == (name, label)]
    return found


TIMING = chosen("video-timing", "tiny48")
TOY = chosen("video-timing", "toy")
PAIRS = chosen("video-timing", "beam 1080, 2 pixels")
AGENT = chosen("avalon-agent", "vga240-u1-r2-m1-f0t-d3-c8")
HOST = chosen("host-transfers", "6 bits, 1 and 2 cycles")
AXI4LITE, WISHBONE, APB = (
    chosen(f"{bus}-transfers", "6 bits, 1 and 2 cycles") for bus in ("axi4lite", "wishbone", "apb")
)
ORDER = chosen("ray-order", "tiny48-u2-r2-m1-f0t-d3-c8")
EARLY_OUT = chosen("ray-order", "tiny48-u2-r2-m1-f3t-d3-c8")
NO_EARLY_OUT = chosen("ray-order", "tiny48-u2-r2-m1-f3t-d3-c8-k0")
PIPELINED = chosen("ray-order", "exact-tiny48-u2-r2-m1-c8-k1")
LIT = chosen("shadow-order", "exact-tiny48-u2-r2-m1-c8-light")
SECTIONS = chosen("line-sections", "tiny48-u2-r2-m1-f0t-d3-c8")
COUNTERS = chosen("render-counters", "vga60-u16-r2-m0-f0t-d1-c8")
FINDER = chosen("finder-quotients", "vga240-u1-r12-m1-f0t-d3-c8")
CELLS = chosen("finder-quotients", "vga240-u1-r12-m1-f0t-d3-c8-materials-patterns")
DEPTH = chosen("nearest-depth", "vga240-u1-r12-m1-f0t-d3-c8")
GROUP = chosen("group-safe", "exact-vga240-u4-r12-m1-c8-k1")
TESTER = chosen("tester-exact", "2 bits, 1 mirrors")
CORNERS = chosen("tester-exact", "1 bits, 2 mirrors")
PRODUCTS = chosen("tester-products", "exact-vga240-u1-r12-m1-c8")
CORNER_PRODUCTS = chosen("tester-products", "exact-vga240-u1-r12-m2-c8-turn")
NEAREST = chosen("nearest-products", "exact-vga240-u1-r12-m1-c8")
CORNER_NEAREST = chosen("nearest-products", "exact-vga240-u1-r12-m2-c8-turn-materials-patterns")
EYE = chosen("eye-exact", "exact-vga240-u1-r12-m4-c8-turn-materials-patterns")
SLOPE = chosen("slope-exact", "exact-vga240-u4-r12-m1-c8")
TURNED = chosen("slope-exact", "exact-vga240-u4-r12-m1-c8-turn")
CELL = chosen("cell-products", "exact-vga240-u1-r12-m1-c8-patterns")
SHADOW = chosen("shadow-products", "exact-vga240-u1-r12-m0-c8-light")
SHADOW_UNIT = chosen("shadow-wiring", "exact-vga240-u1-r12-m1-c8-light")
ROW = chosen("row-setup", "beam-vga240-s2-u1-r12-m1-c8")
ADDERS = chosen("row-setup", "exact-vga240-u4-r12-m1-c8-k1")
LINE = chosen("line-start", "beam-vga240-s2-u1-r2-m1-c8-turn")
WALK = chosen("walked-products", "beam-vga240-s2-u1-r2-m1-c8")
FIRST_LANE = chosen("walked-products", "beam-vga180-s6-u2-r2-m1-c8 lane 0")
SECOND_LANE = chosen("walked-products", "beam-vga180-s6-u2-r2-m1-c8 lane 1")
TURNED_WALK = chosen("turned-walks", "beam-vga240-s2-u1-r2-m1-c8-turn")
CONTEST = chosen("contest-products", "beam-vga240-s2-u1-r2-m4-c8-turn-patterns")
WIDE_CONTEST = chosen("contest-products", "beam-vga180-s6-u2-r2-m1-c8-turn")
LATE_CONTEST = chosen("contest-products", "beam-vga180-s6-u2-r2-m1-c8")
HALF = chosen("blend-exact", "beam-vga240-s2-u1-r2-m2-c8")
MIXED = chosen("blend-exact", "beam-vga240-s2-u1-r2-m1-c8-materials")
MULTIPLIED = chosen("shares-exact", "exact-vga240-u1-r12-m4-c8-materials")
SHARES = chosen("shares-exact", "exact-vga240-u1-r12-m2-c8-materials")
HALVES = chosen("shares-exact", "exact-vga240-u1-r12-m1-c8")
FOLD = chosen("fold-exact", "2 and 1 bits, 1 mirrors")
UNIT = chosen("unit-wiring", "exact-vga240-u1-r12-m1-c8")
CORNER_UNIT = chosen("unit-wiring", "exact-vga240-u1-r12-m2-c8")
PATTERN_UNIT = chosen("unit-wiring", "exact-vga240-u1-r12-m1-c8-turn-materials-patterns")
FOLD_PRODUCTS = chosen("fold-products", "beam-vga240-s2-u1-r2-m1-c8")
SECOND_FOLD = chosen("fold-products", "beam-vga240-s2-u1-r2-m2-c8")
STRAIGHT = chosen("beam-tester-products", "beam-vga240-s2-u1-r2-m1-c8 straight")
FOLDED = chosen("beam-tester-products", "beam-vga240-s2-u1-r2-m1-c8 folded")
STAGED_FOLDED = chosen("beam-tester-products", "beam-vga180-s6-u2-r2-m1-c8 folded")
TABLE = chosen("fixed-rects", "seed, different")
DIVIDER = chosen("divider-exact", "tiny48-u2-r2-m1-f0t-d3-c8 digits")
QUOTIENT = chosen("divider-exact", "tiny48-u2-r2-m1-f0t-d1-c8 product")

FAULTS = {
    "hsync-a-pixel-long": (TOY, "video_generator", "(x <= -2)", "(x <= -1)"),
    "vsync-a-line-late": (TOY, "video_generator", "(y >= -4)", "(y >= -3)"),
    "line-too-short": (TOY, "video_generator", "if (x == 8) begin", "if (x == 7) begin"),
    "sync-follows-colour": (TOY, "video_generator", "assign vga_hs = hs;",
                            "assign vga_hs = hs && (pixel_red != 255);"),
    "colour-in-blanking": (TOY, "video_generator", "if ((x >= 0) && (y >= 0)) begin", "if (x >= 0) begin"),
    "colour-between-pixels": (TOY, "video_generator", "vga_r <= pixel_red;\n",
                              "vga_r <= pixel_red;\n end if (x >= 0) begin\n"),
    "a-pair-announced-late": (PAIRS, "video_generator", "(x >= -21)", "(x >= -20)"),
    "start-screen-late": (TOY, "video_generator", "(y == -3)", "(y == -2)"),
    "start-row-each-line": (TOY, "video_generator", " && (line_repeat == 0)", ""),
    "wait-in-traffic": (AGENT, "avalon_interface", "wait_request <= 1'b0;", "wait_request <= avs_s0_write;"),
    "answer-to-write": (AGENT, "avalon_interface", "readdatavalid <= reading;",
                        "readdatavalid <= reading || bus_write;"),
    "write-lost": (AGENT, "avalon_interface", "bus_write <= avs_s0_write", "bus_write <= !reading && avs_s0_write"),
    "byteenable": (AGENT, "avalon_interface", "bus_mask[15:8] <= 255;", "bus_mask[15:8] <= 127;"),
    "unmapped-not-0": (AGENT, "rect_mem", "readback = pattern_word;", "readback = old_surface;"),
    "over-the-live-one": (AGENT, "rect_mem", "kept_1 = (latest_copies_pending == 1) || (next_live == 1);",
                          "kept_1 = latest_copies_pending == 1;"),
    "over-the-pending-one": (AGENT, "rect_mem", "kept_1 = (latest_copies_pending == 1) || (next_live == 1);",
                             "kept_1 = next_live == 1;"),
    "judged-before": (AGENT, "rect_slot", "pending_usable <= shadow_usable;", "pending_usable <= usable;"),
    "not-cleared": (AGENT, "rect_mem", "if (written[index]) begin", "if (1'b1) begin"),
    "commit-not-atomic": (AGENT, "scene_word", "if (bus_commit) begin", "if (bus_commit || bus_write) begin"),
    "live-too-early": (AGENT, "scene_word", "if (bus_go_live) begin", "if (bus_go_live || bus_commit) begin"),
    "commit-reads-0": (AGENT, "avalon_interface", "commit_pending || bus_commit", "commit_pending"),
    "sticky-lost": (AGENT, "avalon_interface", "if (progress_underrun) begin",
                    "if (progress_underrun && !bus_write) begin"),
    "irq-not-enabled": (AGENT, "avalon_interface", "assign irq = irq_pending && irq_enable;",
                        "assign irq = irq_pending;"),
    "answer-not-kept": (AGENT, "avalon_interface", "if (reading) begin", "if (!avs_s0_write) begin"),
    "axi-write-twice": (AXI4LITE, "axi4lite_bridge", "&& !write_taken", ""),
    "axi-written-without-data": (AXI4LITE, "axi4lite_bridge", "s_axi_awvalid && s_axi_wvalid", "s_axi_awvalid"),
    "axi-response-dropped": (AXI4LITE, "axi4lite_bridge", "else if (s_axi_bready) begin", "else begin"),
    "axi-two-responses": (AXI4LITE, "axi4lite_bridge", "&& (s_axi_bready || !responding)", ""),
    "axi-taken-while-it-waits": (AXI4LITE, "axi4lite_bridge", "write_taken <= writing && !avm_m0_waitrequest;",
                                 "write_taken <= writing;"),
    "axi-written-elsewhere": (AXI4LITE, "axi4lite_bridge", "if (writing) begin", "if (s_axi_awvalid) begin"),
    "axi-answer-dropped": (AXI4LITE, "axi4lite_bridge", "answer_kept <= answered && !s_axi_rready;",
                           "answer_kept <= 1'b0;"),
    "axi-read-over-an-answer": (AXI4LITE, "axi4lite_bridge", "&& !answer_kept", ""),
    "axi-read-overtaken": (AXI4LITE, "axi4lite_bridge", "&& !read_waits", ""),
    "axi-read-never": (AXI4LITE, "axi4lite_bridge", "reading <= 1'b0;", "reading <= 1'b1;"),
    "wishbone-another's-answer": (WISHBONE, "wishbone_bridge", "selected && still_wanted && avm", "selected && avm"),
    "wishbone-read-overtaken": (WISHBONE, "wishbone_bridge", "selected && wb_we && !reading;", "selected && wb_we;"),
    "wishbone-read-again": (WISHBONE, "wishbone_bridge", "selected && !wb_we && !reading;", "selected && !wb_we;"),
    "wishbone-write-not-awaited": (WISHBONE, "wishbone_bridge", "selected && wb_we && !avm_m0_waitrequest;",
                                   "selected && wb_we;"),
    "wishbone-outside-a-cycle": (WISHBONE, "wishbone_bridge", "selected = wb_cyc && wb_stb;", "selected = wb_stb;"),
    "apb-written-in-setup": (APB, "apb_bridge", "s_apb_psel && s_apb_penable && s_apb_pwrite",
                             "s_apb_psel && s_apb_pwrite"),
    "apb-read-again": (APB, "apb_bridge", "s_apb_psel && !s_apb_pwrite && !reading;", "s_apb_psel && !s_apb_pwrite;"),
    "apb-write-not-awaited": (APB, "apb_bridge", "s_apb_pready = s_apb_pwrite && !avm_m0_waitrequest;",
                              "s_apb_pready = s_apb_pwrite;"),
    "apb-read-not-followed": (APB, "apb_bridge", "!s_apb_pwrite && !avm_m0_waitrequest;\n        end",
                              "!s_apb_pwrite;\n        end"),
    "apb-error": (APB, "apb_bridge", "s_apb_pslverr = 1'b0;", "s_apb_pslverr = reading && avm_m0_waitrequest;"),
    "read-again": (HOST, "avalon_host", "avm_m0_read = reading && !waiting;", "avm_m0_read = reading;"),
    "write-not-awaited": (HOST, "avalon_host", "ready = !avm_m0_waitrequest;", "ready = 1'b1;"),
    "read-not-followed": (HOST, "avalon_host", "waiting <= reading && !avm_m0_waitrequest;", "waiting <= reading;"),
    "read-never-over": (HOST, "avalon_host", "waiting <= !avm_m0_readdatavalid;", "waiting <= 1'b1;"),
    "lanes-lost": (HOST, "avalon_host", "avm_m0_byteenable = strobe;", "avm_m0_byteenable = 15;"),
    "rectangle-twice": (ORDER, "rect_sequencer", "others[i] = 0;", "others[i] = waiting[1 - i];"),
    "last-rectangle-missed": (ORDER, "rect_sequencer", "offered <= candidates != 0;", "offered <= others != 0;"),
    "wrong-order": (ORDER, "rect_sequencer", "lowest = i;", "lowest = 1 - i;"),
    "a-ray-too-many": (ORDER, "ray_sequencer", "if (bounce == picture_reflections) begin",
                       "if (bounce > picture_reflections) begin"),
    "never-done": (ORDER, "ray_sequencer", "state <= DONE;", "state <= BLEND;"),
    "blended-too-early": (ORDER, "ray_sequencer", "(in_flight[5:0] == 0)", "(in_flight[4:0] == 0)"),
    "stored-too-early": (ORDER, "ray_control", "store_quotient = in_flight[4];", "store_quotient = in_flight[3];"),
    "wrong-rectangle": (ORDER, "ray_control", "offered_word <= dividing_word;", "offered_word <= rects_rect_word;"),
    "culled-visited": (ORDER, "ray_sequencer", "wanted = rects_usable & fate_may_hit;", "wanted = rects_usable;"),
    "mirrored-not-visited": (ORDER, "ray_sequencer", "wanted = rects_usable;",
                             "wanted = rects_usable & fate_may_hit;"),
    "not-traced-though-alive": (ORDER, "ray_sequencer", "if (fate_any_alive) begin", "if (1'b0) begin"),
    "lost-traced": (ORDER, "ray_sequencer", "if (fate_any_alive) begin", "if (1'b1) begin"),
    "a-ray-too-few": (ORDER, "ray_sequencer", "if (bounce == picture_reflections) begin",
                      "if ((bounce == picture_reflections) || !fate_any_alive) begin"),
    "stored-though-ended": (EARLY_OUT, "ray_sequencer", "in_flight[2] <= 1'b0;", "in_flight[2] <= in_flight[1];"),
    "ended-too-early": (EARLY_OUT, "ray_control", "early_out = in_flight[1] && none_towards;",
                        "early_out = in_flight[0] && none_towards;"),
    "ended-late": (EARLY_OUT, "ray_control", "early_out = in_flight[1] && none_towards;",
                   "early_out = in_flight[2] && none_towards;"),
    "ended-though-towards": (EARLY_OUT, "ray_control", "early_out = in_flight[1] && none_towards;",
                             "early_out = in_flight[1];"),
    "not-ended": (EARLY_OUT, "ray_control", "early_out = in_flight[1] && none_towards;", "early_out = 1'b0;"),
    "slot-runs-on": (EARLY_OUT, "rect_sequencer", "if (start_ray || early_out || (slot == 3)) begin",
                     "if (start_ray || (slot == 3)) begin"),
    "ended-by-itself": (NO_EARLY_OUT, "ray_control", ".early_out(1'd0)", ".early_out(in_flight[1] && !fate_any_alive)"),
    "verdict-too-early": (PIPELINED, "exact_control", "write_z_buf = in_flight[2]", "write_z_buf = in_flight[1]"),
    "another-verdict": (PIPELINED, "exact_control", "offered_word <= second_word;",
                        "offered_word <= first_word;"),
    "blended-before-the-last": (PIPELINED, "ray_sequencer", "(in_flight[1:0] == 0)", "(in_flight[0] == 0)"),
    "slot-of-two": (PIPELINED, "rect_sequencer", "if (start_ray || early_out || (slot == 0)) begin",
                    "if (start_ray || early_out) begin"),
    "halves-overlap": (SECTIONS, "line_buffer", "read_address = read_offset + 32;",
                       "read_address = read_offset + 31;"),
    "one-half": (SECTIONS, "line_buffer", "if (line_buf_sel) begin", "if (line_buf_sel && !write) begin"),
    "past-the-row": (COUNTERS, "ray_caster_renderer", "(place_column_offset != 5)", "1'b1"),
    "a-row-too-many": (COUNTERS, "ray_caster_renderer", "place_row}) == 59)", "place_row}) == 60)"),
    "control-runs-on": (COUNTERS, "ray_caster_renderer", "scan_start_screen || scan_start_row || done;",
                        "scan_start_screen || done;"),
    "read-too-far": (COUNTERS, "ray_caster_renderer", "read_offset}) != 4)", "read_offset}) != 5)"),
    "underrun-lost": (COUNTERS, "ray_caster_renderer", "progress_underrun = scan_start_row && enable;",
                      "progress_underrun = scan_start_row && enable && !done;"),
    "divisor-equal": (DIVIDER, "divider_step", "if (difference < 0) begin", "if (difference <= 0) begin"),
    "bound-left-out": (FINDER, "intersection_finder", "u_value <= $signed", "u_value < $signed"),
    "axes-crossed": (FINDER, "intersection_finder", ".on_z(ray_y),\n    .chosen(v_origin)",
                     ".on_z(ray_z),\n    .chosen(v_origin)"),
    "back-and-forth": (FINDER, "intersection_helper", "if (stored_negative) begin", "if (!stored_negative) begin"),
    "plane-behind": (FINDER, "intersection_helper", "(difference < 0) == e_negative", "(difference > 0) == e_negative"),
    "away-a-bit-short": (FINDER, "intersection_helper", "wire [8:0] away;", "wire [7:0] away;"),
    "way-of-the-next": (FINDER, "intersection_helper", "stored_word <= loaded_word;", "stored_word <= started_word;"),
    "cells-of-the-other-axis": (CELLS, "intersection_finder", ".value(v_value),\n    .size(offered_cell),",
                                ".value(u_value),\n    .size(offered_cell),"),
    "the-last-as-near": (DEPTH, "z_buffer", "(depth < nearest)", "(depth <= nearest)"),
    "depth-a-bit-short": (DEPTH, "z_buffer", "nearest <= depth;", "nearest <= depth[7:0];"),
    "point-of-another": (DEPTH, "z_buffer", "        found_point_word <= point_word;\n    end",
                         "    end\n    if (steps_write_z_buf) found_point_word <= point_word;"),
    "edge-of-a-group-missed": (GROUP, "group_tester", "(way_p_1 < end_least_p)", "(way_p_1 <= end_least_p)"),
    "end-a-bit-short": (GROUP, "group_tester", "wire signed [17:0] end_way_p;", "wire signed [16:0] end_way_p;"),
    "sign-of-the-slope": (GROUP, "group_tester", "back = column_slope < 0;", "back = column_slope > 0;"),
    "one-end-behind": (GROUP, "group_tester", "behind = back && end_back;", "behind = back || end_back;"),
    "ends-run-apart": (GROUP, "group_tester", "same_way_1 <= back == end_back;", "same_way_1 <= 1'b1;"),
    "mirror-hits-itself": (TESTER, "rect_tester", "(seen_1_n > mirror_distance)", "(seen_1_n >= mirror_distance)"),
    "behind-the-mirror": (TESTER, "extent_tester", "(passed_1 || (to_near_1 <= mirror_distance))", "passed_1"),
    "edge-missed": (TESTER, "extent_tester", "(way_2 <= way_to_far_2)", "(way_2 < way_to_far_2)"),
    "corner-met-again": (CORNERS, "rect_tester", "!(seen_2_met && in_mirror)", "1'b1"),
    "product-a-bit-short": (PRODUCTS, "extent_tester", "wire [17:0] way_to_far;", "wire [16:0] way_to_far;"),
    "wrong-operand": (PRODUCTS, "rect_tester", ".slope(slope_u)", ".slope(slope_v)"),
    "near-edge-missed": (PRODUCTS, "extent_tester", "(way_to_near_2 <= way_2)", "(way_to_near_2 < way_2)"),
    "not-complemented": (PRODUCTS, "extent_tester", "turned_eye = ~eye;", "turned_eye = -eye;"),
    "distance-a-bit-short": (PRODUCTS, "extent_tester", "to_far_1 <= to_far[9:0];", "to_far_1 <= to_far[8:0];"),
    "met-on-another-axis": (CORNER_PRODUCTS, "rect_tester", ".on_y(mirror_met_y)", ".on_y(mirror_met_x)"),
    "corner-on-one-side": (CORNER_PRODUCTS, "extent_tester", "(to_near_1 <= mirror_distance)",
                           "(to_near_1 < mirror_distance)"),
    "the-last-of-equals": (NEAREST, "nearest_hit", "(offered_product < nearest_product)",
                           "(offered_product <= nearest_product)"),
    "crossed-wrongly": (NEAREST, "nearest_hit", "numerator * found_slope", "numerator * denominator"),
    "slope-a-bit-short": (NEAREST, "nearest_hit", "found_slope <= denominator;", "found_slope <= denominator[6:0];"),
    "first-hit-lost": (CORNER_NEAREST, "nearest_hit", "hit && (!found || ", "hit && (found && "),
    "corner-of-another": (CORNER_NEAREST, "nearest_hit", "        found_at_mirror <= at_mirror;\n    end",
                          "    end\n    if (steps_write_z_buf) found_at_mirror <= at_mirror;"),
    "mirrored-at-half": (EYE, "eye_register", "twice[9:1] = ", "twice[8:0] = "),
    "eye-a-bit-short": (EYE, "eye_register", "image = $signed(difference[12:0]);",
                        "image = $signed(difference[11:0]);"),
    "mirrored-the-other-way": (EYE, "eye_register", "twice_signed - mirrored", "mirrored - twice_signed"),
    "corner-forgotten": (EYE, "eye_register", "(found_at_mirror && mirror_met_y)", "1'b0"),
    "turned-for-good": (EYE, "eye_register", "flipped_y <= !flipped_y;", "flipped_y <= 1'b1;"),
    "a-row-too-low": (SLOPE, "ray_generator", "190 - place_row", "189 - place_row"),
    "sign-of-zero": (SLOPE, "ray_generator", "dy_negative = dy < 0;", "dy_negative = dy <= 0;"),
    "steepest-too-steep": (TURNED, "slope_component", "size <= component_size;", "size <= component_size[16:0];"),
    "basis-crossed": (TURNED, "turned_generator", "camera_up_y = camera_word[19:10]",
                      "camera_up_y = camera_word[29:20]"),
    "up-is-down": (TURNED, "slope_component", "level + upward", "level - upward"),
    "never-equal": (CELL, "divider_step", "if (difference < 0) begin", "if (difference <= 0) begin"),
    "complement-alone": (CELL, "hit_component", "{turned_way[16:0], back};", "{turned_way[16:0], 1'b0};"),
    "point-a-bit-short": (CELL, "cell_finder", "remainder <= point[16:9];", "remainder <= point[15:9];"),
    "way-not-turned": (CELL, "hit_component", "turned_way = ~way;", "turned_way = way;"),
    "a-cell-too-small": (CELL, "cell_finder", "odd_v = digits_2[size];", "odd_v = digits_1[size];"),
    "shadow-difference-a-bit-short": (SHADOW, "shadow_ray", "wire signed [10:0] difference;",
                                      "wire signed [9:0] difference;"),
    "light-of-another-axis": (SHADOW, "shadow_ray", ".on_z(camera_light_z),\n    .chosen(light_q)",
                              ".on_z(camera_light_y),\n    .chosen(light_q)"),
    "shadow-slope-without-its-sign": (SHADOW, "shadow_ray", "if (back_2) begin", "if (1'b0) begin"),
    "shadow-slope-one-short": (SHADOW, "shadow_ray", "negated = inverse + 1;", "negated = inverse;"),
    "lit-edge-on": (SHADOW, "shadow_ray", "light_a < found_surface_position", "light_a <= found_surface_position"),
    "point-shades-itself": (SHADOW, "shadow_register", "reached < denominator", "reached <= denominator"),
    "shadow-forgotten": (SHADOW, "shadow_register", "shaded <= 1'b1;", "shaded <= !shaded;"),
    "shadow-reach-a-bit-short": (SHADOW, "shadow_register", "wire [16:0] reached;", "wire [15:0] reached;"),
    "shadow-pass-keeps-a-hit": (SHADOW_UNIT, "exact_control", "write_z_buf = in_flight[2] && !from_light;",
                                "write_z_buf = in_flight[2];"),
    "shadow-with-a-mirror": (SHADOW_UNIT, "ray_switch", "active = mirror_active && !from_light;",
                             "active = mirror_active;"),
    "shadow-of-the-last-test": (SHADOW_UNIT, "exact_unit", "    .found_slope(found_slope),\n    .facing(facing)",
                                "    .found_slope(denominator),\n    .facing(facing)"),
    "dark-without-a-light": (SHADOW_UNIT, "exact_unit", "dark = camera_light_on && (", "dark = ("),
    "shadow-pass-left-out": (LIT, "shadow_sequencer", "shadow_pass_awaited = state != TEST;",
                             "shadow_pass_awaited = 1'b0;"),
    "shadow-pass-of-no-use": (LIT, "shadow_sequencer", "if (any_in_question) begin", "if (1'b1) begin"),
    "shadow-pass-never-stopped": (LIT, "shadow_sequencer", "shadow_pass_stop = decided && !shadow_pass_traced;",
                                  "shadow_pass_stop = shadow_pass_traced;"),
    "aimed-a-cycle-late": (LIT, "shadow_sequencer", "cycle <= 1;", "cycle <= 0;"),
    "shadow-without-a-test": (LIT, "ray_sequencer", "start_ray || shadow_pass_start;", "start_ray;"),
    "tests-outlive-the-shadow-pass": (LIT, "ray_sequencer", "stop = reset_ray_caster || shadow_pass_stop;",
                                      "stop = reset_ray_caster;"),
    "shadow-into-the-z-buffer": (LIT, "exact_control", "write_z_buf = in_flight[2] && !from_light;",
                                 "write_z_buf = in_flight[2];"),
    "blended-before-the-shadow": (SHADOW_UNIT, "shadow_sequencer", "shadow_pass_awaited = state != TEST;",
                                  "shadow_pass_awaited = 1'b0;"),
    "loaded-a-cycle-early": (ROW, "rect_setup", "load[number_2] <= 1'b1;", "load[number_1] <= 1'b1;"),
    "one-rectangle-too-few": (ROW, "rect_setup", "if (number == 11) begin", "if (number == 10) begin"),
    "bound-of-another-axis": (ROW, "rect_setup", "to_low_q_2 * slope_a_2", "to_low_q_2 * slope_q_2"),
    "distance-turned": (ROW, "rect_setup", "distance = plane - eye_a;", "distance = eye_a - plane;"),
    "distance-a-bit-short-there": (ROW, "rect_setup", "wire signed [9:0] to_high_p;", "wire signed [8:0] to_high_p;"),
    "operands-crossed": (ADDERS, "rect_setup", ".multiplicand(to_low_q_2),", ".multiplicand(to_high_q_2),"),
    "slopes-crossed": (ADDERS, "rect_setup", ".multiplier(slope_p_2),", ".multiplier(slope_q_2),"),
    "first-column-missed": (LINE, "line_starter", "(ages[3:1] != 0)", "(ages[3:2] != 0)"),
    "aim-a-bit-short": (LINE, "line_starter", "reg signed [19:0] y_product;", "reg signed [18:0] y_product;"),
    "centre-on-the-left": (LINE, "line_starter", "factor = -320;", "factor = 320;"),
    "swept-once": (LINE, "line_starter", "ages[1] || (loaded && (sweeps != 0))", "ages[1]"),
    "walk-a-bit-short": (WALK, "rect_walker", "reg signed [18:0] high_q;", "reg signed [17:0] high_q;"),
    "growth-unsigned": (WALK, "rect_walker", "wire signed [9:0] growth_low_p", "wire [9:0] growth_low_p"),
    "walked-in-the-other-step": (WALK, "rect_walker", "else if (step_bounds) begin", "else if (step_way) begin"),
    "slope-runs-back": (WALK, "slope_walker", "slope_y <= slope_y + 1;", "slope_y <= slope_y - 1;"),
    "second-lane-at-the-first": (SECOND_LANE, "lane_start", "low_q <= start_low_q + growth_low_q;",
                                 "low_q <= start_low_q;"),
    "first-lane-never-starts": (FIRST_LANE, "lane_start", "first_start_word <= start_word;",
                                "first_start_word <= first_start_word;"),
    "turned-walk-a-bit-short": (TURNED_WALK, "rect_walker", "reg signed [28:0] low_q;", "reg signed [27:0] low_q;"),
    "turned-walk-back": (TURNED_WALK, "rect_walker", "way_q + growth_way_q;", "way_q - growth_way_q;"),
    "turned-walk-late": (TURNED_WALK, "slope_walker", "slope_z <= 0;", "slope_z <= slope_z;"),
    "the-second-of-equals": (CONTEST, "nearest_of_two", "(second_product < first_product)",
                             "(second_product <= first_product)"),
    "high-bits-crossed": (CONTEST, "nearest_of_two", "if (second_high[place]) begin",
                          "if (first_high[place]) begin"),
    "high-part-a-bit-short": (CONTEST, "nearest_of_two", "reg [12:0] second_more;", "reg [10:0] second_more;"),
    "highest-bit-lost": (WIDE_CONTEST, "nearest_of_two", "place<3;", "place<2;"),
    "a-miss-wins": (CONTEST, "nearest_of_two", "take_second = second_1_valid && ", "take_second = "),
    "late-product-of-the-other": (LATE_CONTEST, "nearest_of_two", "first_way <= first_product;",
                                  "first_way <= second_product;"),
    "late-product-a-bit-short": (LATE_CONTEST, "nearest_of_two", "reg [19:0] second_way;", "reg [18:0] second_way;"),
    "second-product-early": (LATE_CONTEST, "nearest_of_two", "(second_way < first_way)",
                             "(second_product < first_way)"),
    "mean-two-bits-short": (HALF, "colour_mean_1", "reg [9:0] other;", "reg [7:0] other;"),
    "own-counts-once": (HALF, "colour_mean", "if (reflections == 1) begin", "if (reflections == 2) begin"),
    "background-too-late": (HALF, "colour_seen_1", "here = reached && seen_found;", "here = seen_found;"),
    "difference-unsigned": (MIXED, "colour_mix", "wire signed [8:0] apart;", "wire [8:0] apart;"),
    "one-quarter-lost": (MIXED, "colour_mix", "if (mirror[0]) begin", "if (mirror[0] && !mirror[1]) begin"),
    "mirror-behind-nothing": (MIXED, "colour_seen", "if (picture_reflections > 0) begin", "if (1'b1) begin"),
    "three-quarters-are-half": (SHARES, "colour_share", "some = half + quarter;", "some = half;"),
    "all-passed-on-at-a-miss": (SHARES, "colour_share", "if (found && steps_store_ray) begin",
                                "if (steps_store_ray) begin"),
    "weight-a-bit-short": (SHARES, "colour_share", "wire [4:0] left;", "wire [3:0] left;"),
    "one-summand-only": (SHARES, "colour_sum", "at_even + at_odd", "at_even | at_odd"),
    "mirrors-forgotten": (MULTIPLIED, "colour_share", "some = half + quarter;", "some = half;"),
    "share-a-bit-short": (MULTIPLIED, "colour_sum", "seen * share", "seen * share[7:0]"),
    "last-keeps-half": (HALVES, "colour_share", "if (steps_store_ray) begin", "if (1'b1) begin"),
    "what-is-lost-seen": (HALVES, "colour_combiner", "if (found && !missed) begin", "if (found) begin"),
    "corner-missed": (FOLD, "fold_tester", "beyond = !met_2", "beyond = 1'b0"),
    "mirror-again": (FOLD, "fold_tester", "facet_distance > seen_distance", "facet_distance >= seen_distance"),
    "one-too-few": (FOLD, "ray_fold", "sum_xz_1 = x_by_z - not_z_by_x", "sum_xz_1 = x_by_z + z_by_x"),
    "bounds-swapped": (FOLD, "bound_tester", "(under_low == back_1) && (over_high == back_1)",
                       "!under_low && !over_high"),
    "bound-missed": (FOLD, "bound_tester", "low_edge = twice_low | $signed({1'b0, back})", "low_edge = twice_low"),
    "eyes-crossed-at-the-test": (UNIT, "exact_unit", ".rect_word(rect_word),\n    .eye_x(eye_x),\n    .eye_y(eye_y),",
                                 ".rect_word(rect_word),\n    .eye_x(eye_y),\n    .eye_y(eye_x),"),
    "signs-not-turned": (UNIT, "exact_unit", ".signs_word(signs_word),\n    .slope_dx",
                         ".signs_word(initial_signs_word),\n    .slope_dx"),
    "mirrored-at-the-last-offered": (UNIT, "exact_unit", ".found_surface_word(found_surface_word),\n    .eye_x",
                                     ".found_surface_word(offered_word),\n    .eye_x"),
    "distance-of-the-last-test": (UNIT, "exact_unit", ".found_distance(found_distance),\n    .steps_screen_to_ray",
                                  ".found_distance(numerator),\n    .steps_screen_to_ray"),
    "colour-of-another": (UNIT, "exact_unit", ".found_colour(found_surface_colour)",
                          ".found_colour(offered_word[23:0])"),
    "verdict-of-the-next": (UNIT, "exact_control", "offered_word <= second_word;", "offered_word <= first_word;"),
    "corner-of-the-last-test": (CORNER_UNIT, "exact_unit",
                                ".found_at_mirror(found_at_mirror),\n    .steps_screen_to_ray",
                                ".found_at_mirror(at_mirror),\n    .steps_screen_to_ray"),
    "cells-stored-early": (PATTERN_UNIT, "exact_control", "in_flight[6] && (in_flight[5:0] == 0)",
                           "in_flight[5] && (in_flight[4:0] == 0)"),
    "cells-of-the-last-test": (PATTERN_UNIT, "exact_unit", ".found_slope(found_slope),\n    .odd_u(odd_u)",
                               ".found_slope(denominator),\n    .odd_u(odd_u)"),
    "one-too-few-at-full-width": (FOLD_PRODUCTS, "ray_fold", "sum_xz_1 = x_by_z - not_z_by_x",
                                  "sum_xz_1 = x_by_z + z_by_x"),
    "slope-of-another-axis": (FOLD_PRODUCTS, "ray_fold", "x_by_z <= turn_x * slope_z;", "x_by_z <= turn_x * slope_y;"),
    "border-of-the-next-mirror": (FOLD_PRODUCTS, "ray_fold", "distance_1 * slope_z",
                                  "$signed(last_distance) * slope_z"),
    "turn-a-bit-short": (FOLD_PRODUCTS, "ray_fold", "reg signed [10:0] turn_y;", "reg signed [9:0] turn_y;"),
    "mirror-runs-ahead": (FOLD_PRODUCTS, "ray_fold", "folds_y = back_y != y_back;", "folds_y = y_back;"),
    "turned-once-more": (SECOND_FOLD, "ray_fold", "difference = doubled - turn", "difference = doubled + turn"),
    "offset-of-equals": (SECOND_FOLD, "ray_fold", "if (back_y_2 != back_z_2) begin", "if (back_y_2 || back_z_2) begin"),
    "forgotten-in-a-corner": (SECOND_FOLD, "ray_fold", "met_x <= last_at_mirror && before_met_x;", "met_x <= 1'b0;"),
    "edge-missed-at-once": (STRAIGHT, "bound_tester", "low_edge = twice_low | $signed({1'b0, back})",
                            "low_edge = twice_low"),
    "high-bound-a-bit-short": (STRAIGHT, "bound_tester", "wire signed [19:0] twice_high;",
                               "wire signed [18:0] twice_high;"),
    "plane-through-the-eye": (STRAIGHT, "ray_tester", "ahead = (numerator != 0) && ", "ahead = "),
    "sign-of-the-next-ray": (STRAIGHT, "ray_tester", "back_2 <= back_1;", "back_2 <= back;"),
    "folded-way-too-short": (FOLDED, "fold_tester", "wire signed [20:0] folded_p;", "wire signed [18:0] folded_p;"),
    "way-negated": (FOLDED, "fold_tester", "turned_way_p = ~walk_way_p;", "turned_way_p = -walk_way_p;"),
    "mirror-hit-again": (FOLDED, "fold_tester", "facet_distance > seen_distance", "facet_distance >= seen_distance"),
    "border-on-the-other-side": (FOLDED, "fold_tester", "beyond = before_border_2 != rising_2;",
                                 "beyond = before_border_2 == rising_2;"),
    "corner-left-out": (FOLDED, "fold_tester", "beyond = !met_2", "beyond = 1'b0"),
    "distance-not-turned": (STAGED_FOLDED, "fold_tester", "distance = facet_distance - seen_turn;",
                            "distance = facet_distance;"),
    "clipped-along-p": (STAGED_FOLDED, "fold_tester", "folded_clip = folded_q;", "folded_clip = folded_p;"),
    "slope-of-the-next": (STAGED_FOLDED, "fold_tester", "    e,            // denominator",
                          "    size_a,       // denominator"),
    "bounds-unsorted": (TABLE, "rect_sorter", "if (written_y_0 > written_y_1) begin", "if (1'b0) begin"),
    "not-held": (TABLE, "rect_rom", "if (rects_fetch) begin", "if (1'b1) begin"),
    "overflow-missed": (DIVIDER, "divider", "overflow <= too_large;", "overflow <= too_large && (quotient != 0);"),
    "digits-shifted-twice": (QUOTIENT, "divider", "pending <= last_pending;", "pending <= last_pending << 1;"),
    "too-few-digits": (QUOTIENT, "divider_step", "{digits[7:0], 1'b1}", "{1'b0, digits[6:0], 1'b1}"),
    "product-kept": (QUOTIENT, "divider", "if (load_divider) begin", "if (load_divider && (pending == 0)) begin"),
}  # fmt: skip

STEPS = 12
"""Cycles from reset within which a fault contradicts its property, unless it is one of `MORE_STEPS`."""

MORE_STEPS = {
    "hsync-a-pixel-long": 30,
    "vsync-a-line-late": 60,
    "line-too-short": 40,
    "start-screen-late": 80,
    "start-row-each-line": 200,
    "a-pair-announced-late": 130,
    "past-the-row": 100,
    "a-row-too-many": 70,
    "read-too-far": 90,
    "one-rectangle-too-few": 24,
    "cells-stored-early": 18,
    "shadow-pass-keeps-a-hit": 24,
    "shadow-with-a-mirror": 30,
    "cells-of-the-last-test": 18,
}
"""Steps of faults that take a line, a row's groups or pixels, a frame's rows or lines, all rectangles, or a cell."""


NOT_FROM_RESET = {"control-runs-on"}
"""Fault seen when a row is abandoned: z3 finds no run of 66 cycles in 15 minutes, so its induction step must fail."""


@pytest.mark.slow_sets(
    quick=[
        "apb",
        "axi4lite",
        "blend-exact",
        "contest-products",
        "eye-exact",
        "fixed-rects",
        "fold-products",
        "group-safe",
        "host-transfers",
        "line-sections",
        "nearest-depth",
        "ray-order",
        "render-counters",
        "row-setup",
        "shadow-order",
        "shares-exact",
        "slope-exact",
        "turned-walks",
        "unit-wiring",
        "video-timing",
        "walked-products",
        "wishbone",
    ]
)
@pytest.mark.parametrize(
    "proof",
    [TIMING, PAIRS, AGENT, HOST, AXI4LITE, WISHBONE, APB, ORDER, EARLY_OUT, NO_EARLY_OUT, PIPELINED, SECTIONS, COUNTERS,
     FINDER, CELLS, DEPTH, GROUP, TESTER, CORNERS, PRODUCTS, NEAREST, EYE, TURNED, CELL, SHADOW, SHADOW_UNIT, ROW,
     ADDERS, LINE, WALK, TURNED_WALK, CONTEST, WIDE_CONTEST, HALF, MIXED, SHARES, MULTIPLIED, HALVES, FOLD, UNIT,
     CORNER_UNIT, FOLD_PRODUCTS, SECOND_FOLD, STRAIGHT, TABLE, QUOTIENT],
    ids=lambda proof: f"{proof.name}-{proof.label}",
)  # fmt: skip
def test_holds(proof, output):
    """Each property that has a planted fault below is proved without the fault."""
    result = prove(proof, output / "proof", timeout=250)
    assert result.proved, f"{result.outcome}: {result.detail}; trace {result.trace}"


@pytest.mark.slow_sets(
    quick=[
        "apb-read-again",
        "axi-answer-dropped",
        "corner-missed",
        "distance-turned",
        "divisor-equal",
        "edge-missed",
        "growth-unsigned",
        "hsync-a-pixel-long",
        "mirrored-at-half",
        "never-equal",
        "not-held",
        "one-half",
        "one-too-few-at-full-width",
        "own-counts-once",
        "point-shades-itself",
        "read-again",
        "slope-a-bit-short",
        "swept-once",
        "up-is-down",
        "verdict-of-the-next",
        "wishbone-another",
        "write-lost",
        "wrong-operand",
    ]
)
@pytest.mark.parametrize("fault", FAULTS)
def test_fault_is_found(fault, output):
    """A run from reset contradicts the property; a failing induction step would not show that it can happen."""
    proof, module, right, wrong = FAULTS[fault]

    def plant(verilog: Path) -> None:
        path = verilog / f"{module}.v"
        text = path.read_text()
        assert text.count(right) == 1, f"{module}.v has {text.count(right)} places for this fault"
        path.write_text(text.replace(right, wrong))

    if fault in NOT_FROM_RESET:
        result = refute(proof, output / "proof", depth=proof.induction, step=True, timeout=300, change=plant)
        assert result.outcome == "step failed"
        return
    depth = MORE_STEPS.get(fault, STEPS)
    result = refute(proof, output / "proof", depth=depth, one_reset=depth > STEPS, timeout=300, change=plant)
    assert result.outcome in {"base failed", "reach failed"}
    assert result.trace or result.outcome == "reach failed"


def test_a_state_that_no_reset_leads_to_is_no_counterexample(output):
    """A register that reset clears and nothing sets can fail an induction step, but never a run from reset."""

    def plant(verilog: Path) -> None:
        path = verilog / "avalon_host.v"
        text = path.read_text()
        assert text.count("avm_m0_read = reading && !waiting;") == 1
        text = text.replace("avm_m0_read = reading && !waiting;", "avm_m0_read = (reading && !waiting) ^ never;")
        text = text.replace(");\n", ");\nreg never;\nalways @(posedge clk) if (reset) never <= 0;\n", 1)
        path.write_text(text)

    assert refute(HOST, output / "proof", depth=STEPS, change=plant).outcome == "not refuted"


def test_a_name_peeked_at_in_too_few_bits_is_refused(output):
    """Otherwise the wrapper's property would cover only part of the signal."""
    narrow = replace(ORDER, parameters={**ORDER.parameters, "REFLECTION_BITS": 2})
    with pytest.raises(UserError, match=r"Widening signal ray_order\.engine\.dut\.ray_sequencer_i\.bounce"):
        prove(narrow, output / "proof")


def test_every_property_has_a_fault():
    """A property that no fault contradicts may claim nothing."""
    assert {proof.name for proof, *_ in FAULTS.values()} == {proof.name for proof in PROPERTIES}


def test_unknown_property():
    """The error lists the known properties."""
    command = [sys.executable, "-m", "raycaster.cli", "verify", "prove", "--property", "no-such"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert "got no-such, expected one of video-timing" in done.stderr


def test_kept_proofs_are_not_repeated(output, monkeypatch, names_for_digests):
    """A proof is repeated only on request or if its Verilog or property changes; the kept figures list failures."""
    monkeypatch.setattr("raycaster.verif.formal.prove.PROOFS", [HOST])
    kept = output / "kept.json"

    def outcome(*options: str) -> tuple[int, dict]:
        code = main(["--jobs", "1", "--output", str(output / "proofs"), "--keep", str(kept), *options])
        return code, json.loads(kept.read_text())["figures"]

    label = f"host-transfers, {HOST.label}"
    assert outcome() == (0, {"proved": 1, "proofs": 1, "properties": 1, "properties_proved": 1, "lemmas": 0,
                             "lemmas_proved": 0, "failures": []})  # fmt: skip
    monkeypatch.setattr(
        "raycaster.verif.formal.prove.prove", lambda proof, *_, **__: Result(proof, "step failed", 1, 0)
    )
    assert outcome()[0] == 0
    assert outcome("--fresh") == (1, {"proved": 0, "proofs": 1, "properties": 1, "properties_proved": 0, "lemmas": 0,
                                      "lemmas_proved": 0, "failures": [f"{label}: step failed"]})  # fmt: skip
    changed = replace(HOST, parameters={**HOST.parameters, "MOST_WAIT": 2})
    monkeypatch.setattr("raycaster.verif.formal.prove.PROOFS", [changed])
    assert outcome()[0] == 1
