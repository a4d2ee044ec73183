# SPDX-License-Identifier: MIT
"""A unit's run as an entry of a list."""

from myhdl import ConcatSignal, block, instances

from raycaster.configuration import CHANNEL_BITS, Configuration
from raycaster.hdl.verbs import assign


@block
def run_entry(run, ready, entry, config: Configuration):
    """Keep the highest `config.colour_bits` bits of each channel, and pass ready on.

    Args:
        run: `Run`; ready is an output.
        ready: flag; the list takes the run.
        entry: `ListEntry`; output.
    """
    red, green, blue = (
        run.colour(end, end - config.colour_bits) for end in (3 * CHANNEL_BITS, 2 * CHANNEL_BITS, CHANNEL_BITS)
    )
    pixel = ConcatSignal(red, green, blue)
    whole = entry.joined(end=run.end, pixel=pixel)

    join = assign((entry.word, run.ready), lambda: (whole, ready))

    return instances()
