# SPDX-License-Identifier: MIT
"""Leaf tests of `button_port`: MyHDL and converted Verilog match the expected values on the same vectors."""

from vectors import check, leaf_of

from raycaster.memory_map import BUTTON_NAMES, INTERRUPT_BIT
from raycaster.rtl.common.widths import WORD_BITS
from raycaster.rtl.system.button_port import button_port


def test_button_port(tmp_path, random):
    """The buttons two cycles late, and the interrupt at once."""
    leaf = leaf_of(button_port, tmp_path, buttons=len(BUTTON_NAMES), word=WORD_BITS)
    stimulus, expected = [], [None, None]
    for cycle in range(300):
        stimulus.append({"reset": int(cycle == 0 or random.random() < 0.05)})
        stimulus[-1] |= {"buttons": int(random.integers(1 << len(BUTTON_NAMES))), "irq": int(random.integers(2))}
        if cycle > 1:
            before, last, now = stimulus[-3:]
            held = 0 if before["reset"] or last["reset"] else before["buttons"]
            expected.append({"word": held | now["irq"] << INTERRUPT_BIT})
    check(leaf, stimulus, expected, settled=1)
