# SPDX-License-Identifier: MIT
"""Leaf test of `run_entry`: the highest bits of each channel, by their number."""

import pytest
from span_vectors import span_config

from raycaster.rtl.common.interfaces import Run
from raycaster.rtl.span.lists import ListEntry
from raycaster.rtl.span.run_entry import run_entry


@pytest.mark.parametrize("bits", [1, 5, 8])
def test_run_entry(bits, leaf_of, random):
    config = span_config(screen="tiny", colour_bits=bits)
    columns = config.screen_geometry.columns
    leaf = leaf_of(run_entry, config, run=lambda: Run(config), entry=lambda: ListEntry(columns, 3 * bits))
    for _ in range(leaf.some(60)):
        end, ready, channels = int(random.integers(columns + 1)), int(random.integers(2)), random.integers(256, size=3)
        red, green, blue = (int(channel) >> 8 - bits for channel in channels)
        leaf.case({"run_end": end, "run_colour": int.from_bytes(bytes(channels.tolist())), "ready": ready})
        leaf.expect({"entry_end": end, "entry_pixel": (red << bits | green) << bits | blue, "run_ready": ready})
    leaf.check()
