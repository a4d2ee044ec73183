# SPDX-License-Identifier: MIT
"""Leaf test of `nearest_of_two`: any two candidates, and two whose cross products hardly differ."""

from beam_vectors import any_candidate, by_screen, candidate_ports, close_candidates, first_of, fraction_of

from raycaster.rtl.beam.latencies import contest_latency
from raycaster.rtl.beam.nearest_of_two import nearest_of_two
from raycaster.rtl.common.records import Candidate


@by_screen
def test_nearest_of_two(config, leaf_of, random):
    latency = contest_latency(config)
    both = dict.fromkeys(("first", "second"), lambda: Candidate(config))
    leaf = leaf_of(nearest_of_two, config, **both, latency=latency)
    pairs = [(any_candidate(random, config), any_candidate(random, config)) for _ in range(leaf.some(3000))]
    pairs += [close_candidates(random, config) for _ in range(leaf.some(1000))]
    for one, two in pairs:
        inputs = candidate_ports(config, "first", one) | candidate_ports(config, "second", two)
        leaf.case(inputs, first_of(config, (one, two)))
    leaf.check(latency)
    assert sum(one[0] and two[0] and fraction_of(one) == fraction_of(two) for one, two in pairs) > leaf.some(20)
