# SPDX-License-Identifier: MIT
"""Leaf tests of `shadow_sequencer`: the order of shadow passes, compared with the contract."""

from vectors import ports

from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import unsigned
from raycaster.rtl.common.interfaces import ShadowPass
from raycaster.rtl.exact.shadow_sequencer import shadow_sequencer

AIM = 4
"""Cycles in which a shadow ray is computed."""


def test_shadow_sequencer(tmp_path, random):
    """Passes of any length and outcome: nothing in question, decided early, or tested to the last rectangle."""
    leaf = Leaf(
        shadow_sequencer,
        lambda: ports("clk reset_ray_caster any_in_question from_light", shadow_pass=ShadowPass(), aim=unsigned(AIM)),
        tmp_path,
    )  # fmt: skip
    names = (
        "aim",
        "from_light",
        "shadow_pass_awaited",
        "shadow_pass_comes_next",
        "shadow_pass_start",
        "shadow_pass_stop",
    )
    stimulus, expected = [], []

    def cycle(traced: int, question: int | None, *values: int, reset: int = 0) -> None:
        asked = int(random.integers(2)) if question is None else question
        stimulus.append({"reset_ray_caster": reset, "shadow_pass_traced": traced, "any_in_question": asked})
        expected.append(dict(zip(names, values, strict=True)))

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
            cycle(1, None, 1 << number, 0, 1, 1, 0, 0)
        question = int(random.integers(2))
        cycle(1, question, 1 << AIM - 1, 0, question, 0, question, 0)
        if not question:
            outcomes.add("none")
            continue
        length = int(random.integers(1, 6))
        decided = int(random.integers(1, 8))
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
    outputs = leaf.run_both(stimulus, settled=1)
    for number, wanted in enumerate(expected[1:], 1):
        assert outputs[number] == wanted, (number, stimulus[number])
    assert outcomes == {"none", "decided", "whole"}
