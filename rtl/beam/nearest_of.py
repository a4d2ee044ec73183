# SPDX-License-Identifier: MIT
"""The nearest of several hits, by comparing pairs in rounds."""

from myhdl import block, instances

from raycaster.hdl.signals import side_by_side
from raycaster.rtl.beam.nearest_of_two import nearest_of_two
from raycaster.rtl.common.delay_line import delay_line


@block
def nearest_of(clk, candidates, nearest, rounds: int, latency: int):
    """Find the nearest of several candidates, the first one at equal t, rounds * latency cycles later.

    Neighbours are compared in the first round, and their winners in later rounds; the last of an odd number wins
    unopposed, and so does a single one.

    Args:
        clk: the clock.
        candidates: at most 2^rounds words of `Candidate`, side by side, the first in the lowest bits.
        nearest: `Candidate`; output, rounds * latency cycles after candidates.
        rounds: the number of rounds.
        latency: cycles per round, as in nearest_of_two.
    """
    ones = [nearest.twin().cut(candidates, i) for i in range(len(candidates) // len(nearest.word))]
    winners = [nearest] if rounds == 1 else [nearest.twin() for _ in ones[::2]]
    contests = [
        nearest_of_two(clk, *pair, winner, latency)
        if len(pair) == 2
        else delay_line(clk, pair[0].word, winner.word, latency)
        for pair, winner in zip([ones[i : i + 2] for i in range(0, len(ones), 2)], winners, strict=True)
    ]
    if rounds > 1:
        left = side_by_side([winner.word for winner in winners])
        other_rounds = nearest_of(clk, left, nearest, rounds - 1, latency)

    return instances()
