# SPDX-License-Identifier: MIT
"""Leaf test of `nearest_of`: the first of the nearest candidates, for any count; even a single one takes a round."""

import pytest
from beam_vectors import CANDIDATE, any_candidate, beam_config, close_candidates, first_of

from raycaster.rtl.beam.nearest_of import nearest_of
from raycaster.rtl.common.records import Candidate


@pytest.mark.parametrize(("count", "contest"), [(1, 2), (2, 2), (3, 2), (5, 2), (8, 2), (12, 2), (1, 3), (7, 3)])
def test_nearest_of(count, contest, leaf_of, random):
    config = beam_config(rectangles=count)
    rounds = max(1, (count - 1).bit_length())
    record = Candidate(config)
    bits = len(record.word)
    leaf = leaf_of(nearest_of, config, candidates=count * bits, rounds=rounds, latency=contest)
    for _ in range(1200):
        # Often only a few are valid, so that each is the nearest often enough.
        share = random.choice([0.2, 0.5, 1])
        field = [any_candidate(random, config) for _ in range(count)]
        field = [(int(valid and random.random() < share), *others) for valid, *others in field]
        if count > 1 and random.random() < 0.5:
            # Neighbours are compared in the first round, any two in the last round at the latest.
            first = 2 * int(random.integers(count // 2))
            places = [first, first + 1] if random.random() < 0.5 else random.choice(count, 2, replace=False).tolist()
            for place, one in zip(places, close_candidates(random, config), strict=True):
                field[place] = one
        words = [record.pack(dict(zip(CANDIDATE, one, strict=True))) for one in field]
        leaf.case({"candidates": sum(word << place * bits for place, word in enumerate(words))})
        leaf.expect(first_of(config, field))
    leaf.check(rounds * contest)
