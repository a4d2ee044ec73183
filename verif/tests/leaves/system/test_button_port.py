# SPDX-License-Identifier: MIT
"""Leaf tests of `button_port`: MyHDL and converted Verilog match the expected values on the same vectors."""

from __future__ import annotations

from vectors import ports

from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import unsigned
from raycaster.memory_map import BUTTON_NAMES, INTERRUPT_BIT
from raycaster.rtl.common.widths import WORD_BITS
from raycaster.rtl.system.button_port import button_port


def test_button_port(tmp_path, random):
    leaf = Leaf(button_port, lambda: ports(
        "clk reset irq", buttons=unsigned(len(BUTTON_NAMES)), word=unsigned(WORD_BITS)
    ), tmp_path)  # fmt: skip
    stimulus = [
        {"reset": int(cycle == 0 or random.random() < 0.05)}
        | {"buttons": int(random.integers(1 << len(BUTTON_NAMES))), "irq": int(random.integers(2))}
        for cycle in range(300)
    ]
    for cycle, output in enumerate(leaf.run_both(stimulus, settled=1)):
        if cycle > 1:
            before, last = stimulus[cycle - 2 : cycle]
            held = 0 if before["reset"] or last["reset"] else before["buttons"]
            assert output["word"] == held | stimulus[cycle]["irq"] << INTERRUPT_BIT, cycle
