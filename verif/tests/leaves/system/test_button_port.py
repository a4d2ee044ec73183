# SPDX-License-Identifier: MIT
"""Leaf test of `button_port`: the buttons two cycles late, and the interrupt at once."""

from raycaster.memory_map import BUTTON_NAMES, INTERRUPT_BIT
from raycaster.rtl.common.widths import WORD_BITS
from raycaster.rtl.system.button_port import button_port


def test_button_port(leaf_of, random):
    leaf = leaf_of(button_port, buttons=len(BUTTON_NAMES), word=WORD_BITS)
    for cycle in range(300):
        reset, buttons = int(cycle == 0 or random.random() < 0.05), random.integers(1 << len(BUTTON_NAMES))
        leaf.case({"reset": reset, "buttons": int(buttons), "irq": int(random.integers(2))})
        if cycle > 1:
            before, last, now = leaf.stimulus[-3:]
            held = 0 if before["reset"] or last["reset"] else before["buttons"]
            leaf.expect({"word": held | now["irq"] << INTERRUPT_BIT})
    leaf.check(settled=1)
