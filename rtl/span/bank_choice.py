# SPDX-License-Identifier: MIT
"""A stage between the banks of a memory for runs and its output."""

from myhdl import block, instances

from raycaster.hdl.verbs import register


@block
def bank_choice(clk, run_0, run_1, run_2, run_3, run):
    """Register the run of up to four banks; all but one of them show 0.

    Args:
        run_0: unsigned.
        run_1: unsigned.
        run_2: unsigned.
        run_3: unsigned.
        run: unsigned output; the run, a cycle later.
    """

    choose = register(clk, run, lambda: run_0 | run_1 | run_2 | run_3)

    return instances()
