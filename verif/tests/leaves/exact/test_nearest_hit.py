# SPDX-License-Identifier: MIT
"""Leaf tests of `nearest_hit`: MyHDL and converted Verilog match the expected values on the same vectors."""

from fractions import Fraction

from exact_vectors import by_reflections, by_turn, exact_config
from vectors import ports

from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import unsigned
from raycaster.rtl.common.interfaces import Steps
from raycaster.rtl.common.records import Surface
from raycaster.rtl.common.widths import exact_slope_bits, eye_bits
from raycaster.rtl.exact.nearest_hit import nearest_hit


@by_turn
@by_reflections
def test_nearest_hit(reflections, turn, tmp_path, random):
    config = exact_config(reflections=reflections, turn=turn)
    numerator_bits, denominator_bits = eye_bits(config) - 1, exact_slope_bits(config)
    leaf = Leaf(nearest_hit, lambda: ports(
        "clk hit at_mirror found found_at_mirror", steps=Steps(), offered=Surface(),
        numerator=unsigned(numerator_bits), denominator=unsigned(denominator_bits), found_surface=Surface(),
        found_distance=unsigned(numerator_bits), found_slope=unsigned(denominator_bits)
    ), tmp_path)  # fmt: skip
    stimulus, expected = [{"steps_reset_z_buf": 1}], [None]
    best, surface, settled = None, None, None
    for _ in range(12000):
        reset, write, hit = (int(random.random() < chance) for chance in (0.1, 0.8, 0.6))
        factor = int(random.integers(1, 4))
        n, e = (
            int(random.choice([1, 2, 3, 100, random.integers(1, 1 << bits - 2), (1 << bits) - 1]))
            for bits in (numerator_bits, denominator_bits)
        )
        if best is not None and random.random() < 0.6:
            # As near as the nearest, with other terms.
            n, e = best.numerator * factor, best.denominator * factor
            if n >= 1 << numerator_bits or e >= 1 << denominator_bits:
                n, e = best.numerator, best.denominator
            if random.random() < 0.5:
                # Next to it, with another denominator.
                e = int(random.integers(1, 1 << denominator_bits))
                n = int(best * e)
            n = min(max(n + int(random.integers(-1, 2)), 1), (1 << numerator_bits) - 1)
        offered = {
            "axis": int(random.integers(3)),
            "position": int(random.integers(512)),
            "colour": int(random.integers(1 << 24)),
        }
        stimulus.append(
            {
                "steps_reset_z_buf": reset, "steps_write_z_buf": write, "hit": hit, "numerator": n, "denominator": e,
                **{f"offered_{name}": value for name, value in offered.items()},
                "at_mirror": int(random.integers(2)),
            }
        )  # fmt: skip
        expected.append((best is not None, surface))
        if reset:
            best = None
        elif write and hit and (best is None or Fraction(n, e) < best):
            best = Fraction(n, e)
            surface = {f"surface_{name}": value for name, value in offered.items()}
            surface |= {"distance": n, "slope": e} | {
                name: value for name, value in stimulus[-1].items() if name == "at_mirror"
            }
            settled = settled or len(stimulus)
    outputs = leaf.run_both(stimulus, settled=settled)
    for cycle, wanted in enumerate(expected):
        if wanted is not None:
            assert bool(outputs[cycle]["found"]) == wanted[0], cycle
            if wanted[0]:
                assert {name: outputs[cycle][f"found_{name}"] for name in wanted[1]} == wanted[1]
