# SPDX-License-Identifier: MIT
"""A unit with the Q18.14 fixed point of HomebrewGPU, built like the seed engine's unit, to count its cells."""

from __future__ import annotations

import json
import tempfile
from pathlib import Path
from typing import Any

from myhdl import always, always_comb, block, instances

from raycaster.fpga.cells import FAMILIES
from raycaster.hdl.elaboration import elaborated
from raycaster.hdl.hierarchy import convert_hierarchy
from raycaster.hdl.signals import bit, signed, unsigned
from raycaster.rtl.common.magnitude import magnitude
from raycaster.rtl.engine.divider_step import divider_step
from raycaster.tools import run_yosys

BITS, FRACTION_BITS = 32, 14
STEPS = BITS + FRACTION_BITS
"""Cycles of a division, at one quotient bit per cycle."""


@block
def fixed_unit(clk, load, store, a, b, b_negative, c, d, e, e_negative, value):
    """Compute value = a + b * ((c - d) / e), truncated after the division and after the multiplication.

    The quotient must fit 32 signed bits; product and sum wrap around.

    Args:
        clk: the clock.
        load: strobe; takes all operands except a.
        store: strobe, `STEPS` + 1 cycles after load.
        a: signed, 32 bits; read in the cycle after store.
        b, e: unsigned, 32 bits, magnitudes; e is not 0.
        b_negative, e_negative: flags, the signs of b and e.
        c, d: signed, 32 bits.
        value: signed output, 32 bits; valid from the second cycle after store.
    """
    difference, away = signed(BITS + 1), unsigned(BITS)
    remainder, next_remainder, divisor, factor = (unsigned(BITS) for _ in range(4))
    dividend, digits, next_digits = (unsigned(STEPS) for _ in range(3))
    product = unsigned(2 * BITS)
    total = signed(BITS + 2)
    negative, stored_negative = bit(), bit()

    absolute = magnitude(difference, away)
    step = divider_step(
        remainder=remainder, digits=digits, divisor=divisor, next_remainder=next_remainder, next_digits=next_digits
    )

    @always_comb
    def subtract():
        difference.next = c - d

    @always_comb
    def append_fraction():
        dividend.next = 0
        dividend.next[STEPS:FRACTION_BITS] = away

    @always(clk.posedge)
    def compute():
        if load:
            remainder.next = 0
            digits.next = dividend
            divisor.next = e
            factor.next = b
            negative.next = ((difference < 0) != e_negative) != b_negative
        else:
            remainder.next = next_remainder
            digits.next = next_digits
        if store:
            product.next = factor * digits[BITS:]
            stored_negative.next = negative
        value.next = total[BITS:].signed()

    # The lower 32 bits do not depend on signs.
    @always_comb
    def add():
        if stored_negative:
            total.next = a - product[BITS + FRACTION_BITS : FRACTION_BITS]
        else:
            total.next = a + product[BITS + FRACTION_BITS : FRACTION_BITS]

    return instances()


def fixed_unit_ports() -> dict[str, Any]:
    """Return signals for all ports of `fixed_unit`."""
    numbers = {name: signed(BITS) for name in ("a", "c", "d", "value")} | {name: unsigned(BITS) for name in "be"}
    return numbers | {name: bit() for name in ("clk", "load", "store", "b_negative", "e_negative")}


def fixed_unit_cells() -> dict[str, int]:
    """Count the unit's ECP5 cells, before placement, as `raycaster.fpga.cells` does.

    Raises:
        ToolError: Yosys is missing, or reported an error.
    """
    family, top = FAMILIES["ecp5"], fixed_unit.__name__
    with tempfile.TemporaryDirectory(prefix="raycaster-") as scratch:
        directory = Path(scratch)
        modules = convert_hierarchy(elaborated(fixed_unit, **fixed_unit_ports()), directory, "")
        reads = [f"read_verilog {module.path.name}" for module in modules]
        run_yosys(directory, "synthesis", [*reads, f"{family.synthesis} -top {top} -json netlist.json"])
        area = family.count(json.loads((directory / "netlist.json").read_text())["modules"][top]["cells"])
    return {"cells": area.tables, "registers": area.registers, "multipliers": area.multipliers}
