# SPDX-License-Identifier: MIT
"""Leaf tests of `rect_copy`: MyHDL and converted Verilog match the expected values on the same vectors."""

import numpy as np
import pytest
from vectors import AXES, any_place, ports

from raycaster.configuration import configure
from raycaster.golden.world import Rectangles
from raycaster.hdl.leaf import Leaf
from raycaster.rtl.common.interfaces import Rects
from raycaster.rtl.common.records import WideRect
from raycaster.rtl.common.widths import WIDE_BITS
from raycaster.rtl.cull.rect_copy import rect_copy
from raycaster.verif.expected import sorted_rect

BOUNDS = ("u_low", "u_high", "v_low", "v_high")


@pytest.mark.parametrize("margin", [0, 1])
@pytest.mark.parametrize("count", [1, 12, 32])
def test_rect_copy(count, margin, tmp_path, random):
    """Fetches of both readers in any order; the second gets what the first got last, with the margin added."""
    config = configure(engine="exact", rectangles=count, allow_underrun=True)
    latency = config.facts.rect_latency

    def copy():
        copied = Rects(config)
        copied.rect = WideRect()
        return copied

    leaf = Leaf(rect_copy, lambda: ports(
        "clk", rects=Rects(config), copy=copy(), margin=margin, config=config
    ), tmp_path)  # fmt: skip
    stimulus, written, asked = [], [], []
    for cycle in range(600):
        fetch, index = int(cycle < count or random.random() < 0.3), cycle if cycle < count else random.integers(count)
        # Ask only for rectangles that were fetched long enough ago.
        ask = int(cycle > count + 4 and random.random() < 0.7)
        corners = np.array([[any_place(random) for _ in AXES] for _ in range(2)])
        corners[1, random.integers(3)] = corners[0].copy()[axis := int(random.integers(3))]
        corners[1, axis] = corners[0, axis]
        shown = sorted_rect(Rectangles(corners[None], np.zeros((1, 3), np.uint8), np.ones(1, bool)), 0, "rects_rect")
        del shown["rects_rect_colour"]
        wanted = int(random.integers(count))
        stimulus.append(
            {"rects_fetch": fetch, "rects_index": int(index), "copy_fetch": ask, "copy_index": wanted, **shown}
        )
        written.append((fetch, int(index), shown))
        asked.append((ask, wanted))
    outputs = leaf.run_both(stimulus, settled=count + 8)
    memory, answer = {}, None
    for cycle, output in enumerate(outputs):
        # A rectangle that arrived three cycles ago could be read two cycles ago.
        at_hand, read = cycle - 3, cycle - 2
        if at_hand >= latency and written[at_hand - latency][0]:
            memory[written[at_hand - latency][1]] = written[at_hand][2]
        if read >= 0 and asked[read][0]:
            answer = memory[asked[read][1]]
        if answer is not None:
            expected = {name: answer[f"rects_rect_{name}"] for name in ("axis", "position", *BOUNDS)}
            for name in BOUNDS:
                further = expected[name] + (margin if name.endswith("high") else -margin)
                expected[name] = further % (1 << WIDE_BITS)
            assert output == {f"copy_rect_{name}": value for name, value in expected.items()}, cycle
