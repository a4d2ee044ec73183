# SPDX-License-Identifier: MIT
"""Leaf test of `shadow_sequencer`: passes of any length and outcome.

Nothing is in question, or it is decided early, or it is tested to the last rectangle. traced is not read in the cycles
of aim.
"""

from raycaster.rtl.common.interfaces import ShadowPass
from raycaster.rtl.exact.shadow_sequencer import shadow_sequencer

AIM = 4
"""Cycles in which a shadow ray is computed."""


def test_shadow_sequencer(leaf_of, random):
    leaf = leaf_of(shadow_sequencer, shadow_pass=ShadowPass, aim=AIM)
    names = ("aim", "from_light", *(f"shadow_pass_{name}" for name in ("awaited", "comes_next", "start", "stop")))

    def cycle(traced: int, question: int | None, *values: int, reset: int = 0) -> None:
        asked = int(random.integers(2)) if question is None else question
        leaf.case({"reset_ray_caster": reset, "shadow_pass_traced": traced, "any_in_question": asked})
        leaf.expect(dict(zip(names, values, strict=True)))

    waiting = (0, 0, 1, 1, 0, 0)
    cycle(0, None, *waiting, reset=1)
    outcomes = set()
    for _ in range(300):
        for _ in range(int(random.integers(4))):
            cycle(0, None, *waiting)
        cycle(1, None, *waiting)
        if random.random() < 0.05:
            cycle(1, None, 1, 0, 1, 1, 0, 0, reset=1)
            continue
        for number in range(AIM - 1):
            cycle(int(random.integers(2)), None, 1 << number, 0, 1, 1, 0, 0)
        question = int(random.integers(2))
        cycle(int(random.integers(2)), question, 1 << AIM - 1, 0, question, 0, question, 0)
        if not question:
            outcomes.add("none")
            continue
        length, decided = int(random.integers(1, 6)), int(random.integers(1, 8))
        for number in range(1, length + 1):
            in_question, last = int(number < decided), number == length
            stops = not in_question and not last
            cycle(int(last), in_question, 0, 1, 0, 0, 0, int(stops))
            if stops:
                # All tests are dropped, so the pass is over in the next cycle.
                cycle(1, 0, 0, 1, 0, 0, 0, 0)
                outcomes.add("decided")
                break
        else:
            outcomes.add("whole")
    leaf.check(settled=1)
    assert outcomes == {"none", "decided", "whole"}
