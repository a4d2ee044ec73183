# SPDX-License-Identifier: MIT
"""Block RAM with runs."""

from myhdl import always_comb, block, instances

from raycaster.hdl.signals import bits_for, tied, unsigned
from raycaster.rtl.span.bank_choice import bank_choice
from raycaster.rtl.span.bank_feed import bank_feed
from raycaster.rtl.span.run_bank import run_bank

BANK_PLACES = 2048
"""Runs of a bank, a power of two: as many as a block RAM of an ECP5 or a GW2A holds if it is as wide as a byte and its
parity. So a bank is a few of these blocks side by side, and nothing is between them and its register."""

LARGE_BANK = 16384
"""Runs of a bank that is a whole list of this length: as many as a single-port RAM of an iCE40UP holds."""

CHOICES = 4
"""Banks of a `bank_choice` and of a `bank_feed`."""


def read_latency(places: int, bank: int = BANK_PLACES) -> int:
    """Return the cycles from a place to its run.

    They are two of a bank, one for each choice among the banks and, if there are several choices, one of a feed.
    """
    banks = -(-places // bank)
    cycles, left = 2 + (banks > CHOICES), banks
    while left > 1:
        cycles, left = cycles + 1, -(-left // CHOICES)
    return cycles


@block
def run_memory(clk, write, write_place, written, read, read_place, shown, places: int, bank: int = BANK_PLACES):
    """Keep runs in block RAM, which is unknown at power-up.

    A large memory is made of banks, each with a register of its own, and of a tree of registers behind them: a
    multiplexer for all blocks at once would take most of a cycle, and the way to it the rest. If there are more than
    `CHOICES` banks, each so many have registers in front of them, too.

    Args:
        write: strobe; stores written.
        write_place: unsigned, below places; read with write.
        written: `ListEntry`; read with write.
        read: flag.
        read_place: unsigned, below places; read with the flag of that name.
        shown: `ListEntry`; output, the run at read_place `read_latency` cycles later, and 0 that long after a cycle
            without read. Don't care if the place was written in the cycle in which it was read.
        places: number of runs.
        bank: number of runs of a bank, a power of two.
    """
    count = -(-places // bank)
    low, width = bits_for(bank), len(written.word)

    if count == 1:
        only = run_bank(
            clk, write=write, write_place=write_place, written=written.word, read=read, read_place=read_place,
            shown=shown.word, places=places,
        )  # fmt: skip
    else:
        top, counts = len(read_place), [min(CHOICES, count - start) for start in range(0, count, CHOICES)]
        sizes = [min(bank, places - number * bank) for number in range(count)]
        runs = [unsigned(width) for _ in range(count)]
        near_writes, near_reads = ([unsigned(few) for few in counts] for _ in range(2))
        near_write_place, near_read_place, near_written = [write_place], [read_place], [written.word]
        write_banks, read_banks = unsigned(CHOICES), unsigned(CHOICES)
        if len(counts) == 1:
            writes, reads, middle = near_writes[0], near_reads[0], low
        else:
            middle = low + bits_for(CHOICES)
            lows = [bits_for(size) for size in sizes[::CHOICES]]
            near_write_place, near_read_place = ([unsigned(one) for one in lows] for _ in range(2))
            near_written = [unsigned(width) for _ in counts]
            writes, reads = unsigned(len(counts)), unsigned(len(counts))
            feeds = [
                bank_feed(
                    clk, write=writes(i), write_banks=write_banks(few, 0), write_place=write_place(lows[i], 0),
                    written=written.word, read=reads(i), read_banks=read_banks(few, 0),
                    read_place=read_place(lows[i], 0),
                    near_writes=near_writes[i], near_write_place=near_write_place[i], near_written=near_written[i],
                    near_reads=near_reads[i], near_read_place=near_read_place[i],
                )
                for i, few in enumerate(counts)
            ]  # fmt: skip

        # The bank that reads and the one that writes, or their feeds.
        @always_comb
        def choose():
            reads.next = 0
            if read:
                reads.next[read_place[top:middle]] = True
            writes.next = 0
            if write:
                writes.next[write_place[top:middle]] = True

        if len(counts) > 1:

            @always_comb
            def choose_bank():
                read_banks.next = 0
                read_banks.next[read_place[middle:low]] = True
                write_banks.next = 0
                write_banks.next[write_place[middle:low]] = True

        banks = [
            run_bank(
                clk, write=near_writes[number // CHOICES](number % CHOICES),
                write_place=near_write_place[number // CHOICES](bits_for(size), 0),
                written=near_written[number // CHOICES], read=near_reads[number // CHOICES](number % CHOICES),
                read_place=near_read_place[number // CHOICES](bits_for(size), 0), shown=runs[number], places=size,
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

    return instances()
