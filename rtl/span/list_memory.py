# SPDX-License-Identifier: MIT
"""The memory of the list that is drawn, and that of the list that is shown."""

from myhdl import block, instances

from raycaster.hdl.signals import bit, unsigned
from raycaster.hdl.verbs import assign
from raycaster.rtl.span.run_memory import BANK_PLACES, run_memory


@block
def list_memory(
    clk, upper, write, write_place, written, read_place, shown, places: int, bank: int = BANK_PLACES
):  # fmt: skip
    """Keep the runs of two lists, each in a memory that is either written or read.

    Both places of a memory are the same, so RAM with a single port will do.

    Args:
        upper: flag; the upper list is written and the lower one is read, or the other way round.
        write: strobe; stores written.
        write_place: unsigned, below places; read with write.
        written: `ListEntry`; read with write.
        read_place: unsigned, below places.
        shown: `ListEntry`; output, the run at read_place `read_latency` cycles later. Don't care if upper has changed
            in between.
        places: number of runs of each list.
        bank: number of runs of a bank of a memory, as in `run_memory`.
    """
    lower_write, upper_write, lower_read, upper_read = (bit() for _ in range(4))
    lower_write_place, lower_read_place = (unsigned(len(read_place)) for _ in range(2))
    upper_write_place, upper_read_place = (unsigned(len(read_place)) for _ in range(2))
    lower_run, upper_run = written.twin(), written.twin()

    lower_list = run_memory(
        clk, write=lower_write, write_place=lower_write_place, written=written, read=lower_read,
        read_place=lower_read_place, shown=lower_run, places=places, bank=bank,
    )  # fmt: skip
    upper_list = run_memory(
        clk, write=upper_write, write_place=upper_write_place, written=written, read=upper_read,
        read_place=upper_read_place, shown=upper_run, places=places, bank=bank,
    )  # fmt: skip

    choose_lower_write = assign(lower_write, lambda: write and not upper)
    choose_upper_write = assign(upper_write, lambda: write and upper)
    choose_lower_read = assign(lower_read, lambda: upper)
    choose_upper_read = assign(upper_read, lambda: not upper)
    choose_lower_write_place = assign(lower_write_place, lambda: read_place if upper else write_place)
    choose_lower_read_place = assign(lower_read_place, lambda: read_place if upper else write_place)
    choose_upper_write_place = assign(upper_write_place, lambda: write_place if upper else read_place)
    choose_upper_read_place = assign(upper_read_place, lambda: write_place if upper else read_place)
    show = assign(shown.word, lambda: lower_run.word | upper_run.word)

    return instances()
