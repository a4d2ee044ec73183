# SPDX-License-Identifier: MIT
"""Block RAM with runs."""

from myhdl import always_comb, block, instances

from raycaster.hdl.signals import bits_for, tied, unsigned
from raycaster.rtl.span.bank_choice import bank_choice
from raycaster.rtl.span.run_bank import run_bank

BANK_PLACES = 2048
"""Runs of a bank, a power of two: as many as a block RAM of an ECP5 or a GW2A holds if it is as wide as a byte and its
parity. So a bank is a few of these blocks side by side, and nothing is between them and its register."""

CHOICES = 4
"""Banks of a `bank_choice`."""


def read_latency(places: int, bank: int = BANK_PLACES) -> int:
    """Return the cycles from a place to its run: two of a bank, and one for each choice among the banks."""
    cycles, left = 2, -(-places // bank)
    while left > 1:
        cycles, left = cycles + 1, -(-left // CHOICES)
    return cycles


@block
def run_memory(clk, write, write_place, written, read_place, shown, places: int, bank: int = BANK_PLACES):
    """Keep runs in block RAM, which is unknown at power-up.

    A large memory is made of banks, each with a register of its own, and of a tree of registers behind them: a
    multiplexer for all blocks at once would take most of a cycle, and the way to it the rest.

    Args:
        clk: the clock.
        write: strobe; stores written.
        write_place: unsigned, below places; read with write.
        written: `ListEntry`; read with write.
        read_place: unsigned, below places.
        shown: `ListEntry`; output, the run at read_place `read_latency` cycles later. Don't care if the place was
            written in the cycle in which it was read.
        places: number of runs.
        bank: number of runs of a bank, a power of two.
    """
    count = -(-places // bank)
    low, width = bits_for(bank), len(written.word)

    if count == 1:
        only = run_bank(
            clk, write=write, write_place=write_place, written=written.word, read=tied(1, 1), read_place=read_place,
            shown=shown.word, places=places,
        )  # fmt: skip
    else:
        top = len(read_place)
        reads, writes = unsigned(count), unsigned(count)
        runs = [unsigned(width) for _ in range(count)]
        sizes = [min(bank, places - number * bank) for number in range(count)]
        banks = [
            run_bank(
                clk, write=writes(number), write_place=write_place(bits_for(size), 0), written=written.word,
                read=reads(number), read_place=read_place(bits_for(size), 0), shown=runs[number], places=size,
            )
            for number, size in enumerate(sizes)
        ]  # fmt: skip
        # The outputs of the banks, and behind them stage after stage.
        choices, first = [], 0
        while (end := len(runs)) > first + 1:
            for start in range(first, end, CHOICES):
                group = runs[start : min(start + CHOICES, end)]
                run_0, run_1, run_2, run_3 = group + [tied(0, width)] * (CHOICES - len(group))
                runs.append(unsigned(width) if end - first > CHOICES else shown.word)
                choices.append(bank_choice(clk, run_0=run_0, run_1=run_1, run_2=run_2, run_3=run_3, run=runs[-1]))
            first = end

        @always_comb
        def choose_bank():
            reads.next = 0
            reads.next[read_place[top:low]] = True
            writes.next = 0
            if write:
                writes.next[write_place[top:low]] = True

    return instances()
