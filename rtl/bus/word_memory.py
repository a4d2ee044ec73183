# SPDX-License-Identifier: MIT
"""The processor's memory: its program and data."""

from pathlib import Path

from myhdl import Signal, always, always_seq, block, instances, intbv

from raycaster.hdl.given import load_words
from raycaster.hdl.signals import bit
from raycaster.hdl.verbs import assign, register
from raycaster.rtl.common.widths import WORD_BITS


def first_words(program: str, count: int) -> list[int]:
    """Return the memory's initial words: a file's hexadecimal words, then zeros; only zeros if there is no file."""
    path = Path(program)
    words = [int(word, 16) for word in path.read_text().split()] if path.exists() else []
    return words + [0] * (count - len(words))


@block
def word_memory(clk, reset, access, strobe, address, data, words: int, program: str):
    """Hold the processor's program and data; an access takes two cycles.

    Args:
        reset: synchronous, active high; does not restore the words that the memory had at power-up.
        access: `Access`; reads select, drives ready and word. ready is high in the second cycle of an access, with the
            word that was read.
        strobe: unsigned, 4 bits; the bytes of data to write, or 0 for a read.
        address: unsigned; word address, below words.
        data: unsigned, 32 bits; the word to write.
        words: the number of words.
        program: name of the file with the memory's words at power-up.
    """
    memory = [Signal(intbv(value)[WORD_BITS:]) for value in first_words(program, words)]
    writing, reading, done = bit(), bit(), bit()

    loading = load_words(memory, program)

    start_write = assign(writing, lambda: access.select and (strobe != 0) and not done)
    start_read = assign(reading, lambda: access.select and (strobe == 0) and not done)

    @always(clk.posedge)
    def store():
        if writing and strobe[0]:
            memory[address].next[8:0] = data[8:0]
        if writing and strobe[1]:
            memory[address].next[16:8] = data[16:8]
        if writing and strobe[2]:
            memory[address].next[24:16] = data[24:16]
        if writing and strobe[3]:
            memory[address].next[32:24] = data[32:24]

    # Never in the cycle of a write, so it does not matter what the memory would read then.
    fetch = register(clk, access.word, lambda: memory[address], reading)

    @always_seq(clk.posedge, reset=reset)
    def finish():
        done.next = access.select and not done

    answer = assign(access.ready, lambda: done)

    return instances()
