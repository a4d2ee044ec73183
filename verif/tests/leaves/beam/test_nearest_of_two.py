# SPDX-License-Identifier: MIT
"""Leaf tests of `nearest_of_two`: MyHDL and converted Verilog match the expected values on the same vectors."""

from beam_vectors import any_candidate, by_screen, candidate_ports, close_candidates, first_of, fraction_of
from vectors import check, leaf_of

from raycaster.engines.beam import contest_latency
from raycaster.rtl.beam.nearest_of_two import nearest_of_two
from raycaster.rtl.common.records import candidate_of


@by_screen
def test_nearest_of_two(config, tmp_path, random):
    """Any two candidates, and two whose cross products hardly differ."""
    latency = contest_latency(config)
    both = dict.fromkeys(("first", "second"), lambda: candidate_of(config))
    leaf = leaf_of(nearest_of_two, tmp_path, config, **both, latency=latency)
    pairs = [(any_candidate(random, config), any_candidate(random, config)) for _ in range(3000)]
    pairs += [close_candidates(random, config) for _ in range(1000)]
    stimulus = [candidate_ports(config, "first", one) | candidate_ports(config, "second", two) for one, two in pairs]
    check(leaf, stimulus, [first_of(config, pair) for pair in pairs], latency)
    assert sum(one[0] and two[0] and fraction_of(one) == fraction_of(two) for one, two in pairs) > 20
