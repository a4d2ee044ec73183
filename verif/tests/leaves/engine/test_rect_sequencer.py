# SPDX-License-Identifier: MIT
"""`rect_sequencer`: all, some or single rectangles; some tests end early, and some sequences with a reset."""

from vectors import by, check_fetches, exact_config

from raycaster.rtl.engine.rect_sequencer import rect_sequencer


@by(count=[1, 5, 12], rect_cycles=[1, 3, 9])
def test_rect_sequencer(count, rect_cycles, leaf_of, random):
    config = exact_config(rectangles=count)
    leaf, on_port = leaf_of(rect_sequencer, config, wanted=count, rect_cycles=lambda: rect_cycles), {}

    def drive(reset, start, mask, current=None, first=False, early_out=0):
        """Add a cycle in which `current` is on the memory's port."""
        if current is not None:
            on_port[leaf.cycle] = current
        leaf.case({"reset_ray_caster": reset, "start_ray": start, "wanted": mask, "early_out": early_out})
        leaf.expect({"fetched": current is not None, "starting": first}, when=not reset)

    every = (1 << count) - 1
    for number in range(60):
        mask = every if number % 7 == 0 else int(random.integers(1 << count)) & int(random.integers(1 << count))
        if number % 3 == 1:
            mask = 1 << number // 3 % count
        if number % 5 == 0:
            drive(1, 0, mask)
        for _ in range(int(random.integers(1, 3))):
            drive(0, 0, mask)
        drive(0, 1, mask)
        tests = []
        for index in range(count):
            if mask >> index & 1:
                # Some tests end early, in any of their cycles.
                last = int(random.integers(rect_cycles)) if random.random() < 0.3 else rect_cycles - 1
                ends = last < rect_cycles - 1
                tests += [(index, cycle == 0, int(ends and cycle == last)) for cycle in range(last + 1)]
        # Only a reset may come before the end.
        for current, first, early_out in tests[: int(random.integers(len(tests) + 1))] if number % 5 == 4 else tests:
            drive(0, 0, mask, current, first, early_out)
        if number % 5 != 4:
            drive(0, 0, mask)
    outputs = leaf.check(settled=4)
    check_fetches(outputs, on_port, "", settled=4)
