# SPDX-License-Identifier: MIT
"""Leaf tests of `nearest_of_two`: MyHDL and converted Verilog match the expected values on the same vectors."""

from beam_vectors import any_candidate, by_screen, candidate_ports, close_candidates, fraction_of
from vectors import ports

from raycaster.engines.beam import contest_latency
from raycaster.hdl.leaf import Leaf
from raycaster.rtl.beam.nearest_of_two import nearest_of_two
from raycaster.rtl.common.records import candidate_of


@by_screen
def test_nearest_of_two(config, tmp_path, random):
    latency, records = contest_latency(config), ("first", "second", "nearest")
    leaf = Leaf(nearest_of_two, lambda: ports(
        "clk", **{name: candidate_of(config) for name in records}, latency=latency
    ), tmp_path)  # fmt: skip
    pairs = [(any_candidate(random, config), any_candidate(random, config)) for _ in range(3000)]
    pairs += [close_candidates(random, config) for _ in range(1000)]
    stimulus = [
        candidate_ports(config, "first", first) | candidate_ports(config, "second", second) for first, second in pairs
    ]
    outputs = leaf.run_both([*stimulus, *[{}] * latency], settled=latency)
    ties = 0
    for (first, second), output in zip(pairs, outputs[latency:], strict=True):
        valid = [candidate for candidate in (first, second) if candidate[0]]
        assert output["nearest_valid"] == bool(valid)
        if valid:
            # For equal fractions, min returns the first.
            assert output == candidate_ports(config, "nearest", min(valid, key=fraction_of))
            ties += len(set(map(fraction_of, valid))) < len(valid)
    assert ties > 20
