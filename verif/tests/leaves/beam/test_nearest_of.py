# SPDX-License-Identifier: MIT
"""Leaf tests of `nearest_of`: MyHDL and converted Verilog match the expected values on the same vectors."""

import pytest
from beam_vectors import CANDIDATE, any_candidate, beam_config, candidate_ports, close_candidates, fraction_of
from vectors import ports

from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import unsigned
from raycaster.rtl.beam.nearest_of import nearest_of
from raycaster.rtl.common.records import candidate_of


@pytest.mark.parametrize(("count", "contest"), [(1, 2), (2, 2), (3, 2), (5, 2), (8, 2), (12, 2), (1, 3), (7, 3)])
def test_nearest_of(count, contest, tmp_path, random):
    """The first of the nearest candidates, for any count; even a single one takes a round."""
    config = beam_config(rectangles=count)
    rounds = max(1, (count - 1).bit_length())
    record = candidate_of(config)
    leaf = Leaf(nearest_of, lambda: ports(
        "clk", candidates=unsigned(count * len(record.word)), nearest=candidate_of(config), rounds=rounds,
        latency=contest
    ), tmp_path)  # fmt: skip
    # Often only a few are valid, so that each is the nearest often enough.
    fields = []
    for _ in range(1200):
        share = random.choice([0.2, 0.5, 1])
        field = [any_candidate(random, config) for _ in range(count)]
        field = [(int(valid and random.random() < share), *others) for valid, *others in field]
        if count > 1 and random.random() < 0.5:
            # Neighbours are compared in the first round, any two in the last round at the latest.
            first = 2 * int(random.integers(count // 2))
            places = [first, first + 1] if random.random() < 0.5 else random.choice(count, 2, replace=False).tolist()
            for place, one in zip(places, close_candidates(random, config), strict=True):
                field[place] = one
        fields.append(field)
    stimulus = [
        {"candidates": sum(record.pack(dict(zip(CANDIDATE, one, strict=True))) << i * len(record.word)
                           for i, one in enumerate(field))}
        for field in fields
    ]  # fmt: skip
    latency = rounds * contest
    outputs = leaf.run_both([*stimulus, *[{}] * latency], settled=latency)
    for field, output in zip(fields, outputs[latency:], strict=True):
        valid = [one for one in field if one[0]]
        assert output["nearest_valid"] == bool(valid)
        if valid:
            assert output == candidate_ports(config, "nearest", min(valid, key=fraction_of))
