# SPDX-License-Identifier: MIT
"""A queue of items, in MyHDL with records, interfaces and a Verilog module for each block: python fifo.py DIRECTORY."""

import argparse
from pathlib import Path

from myhdl import always, always_comb, always_seq, block, instances

from raycaster.hdl.elaboration import elaboration
from raycaster.hdl.hierarchy import convert_hierarchy
from raycaster.hdl.records import Interface, Record
from raycaster.hdl.signals import bit, reset_signal, unsigned


class Item(Record):
    """A byte of a packet, and a flag for the last one."""

    def __init__(self):
        super().__init__({"last": 1, "data": 8})


class Stream(Interface):
    """Items that move in cycles in which valid and ready are high.

    Attributes:
        valid: there is an item.
        ready: the receiver takes it.
        item: the item.
    """

    def __init__(self):
        self.valid, self.ready, self.item = bit(), bit(), Item()


@block
def pointer(clk, reset, step, place):
    """Count the places of a queue, in a circle.

    Args:
        clk: the clock.
        reset: synchronous, active high.
        step: strobe; go to the next place.
        place: output register.
    """
    places = 1 << len(place)

    @always_seq(clk.posedge, reset=reset)
    def count():
        if step:
            place.next = (place + 1) % places

    return instances()


@block
def item_memory(clk, write, stored, write_place, read_place, shown):
    """Keep an item in each place.

    Args:
        clk: the clock.
        write: strobe; store an item.
        stored: `Item` to store.
        write_place: its place.
        read_place: place of the item that is shown.
        shown: output `Item`, in the same cycle.
    """
    items = [unsigned(len(stored.word)) for _ in range(1 << len(write_place))]

    @always(clk.posedge)
    def store():
        if write:
            items[write_place].next = stored.word

    @always_comb
    def show():
        shown.word.next = items[read_place]

    return instances()


@block
def fifo(clk, reset, source, sink, place_bits=2):
    """Queue items in order.

    Args:
        clk: the clock.
        reset: synchronous, active high; empties the queue.
        source: `Stream`; input.
        sink: `Stream`; output.
        place_bits: log2 of the number of places.
    """
    write_place, read_place, level = unsigned(place_bits), unsigned(place_bits), unsigned(place_bits + 1)
    put, take, places = bit(), bit(), 1 << place_bits
    writing = pointer(clk, reset, put, write_place)
    reading = pointer(clk, reset, take, read_place)
    memory = item_memory(clk, put, source.item, write_place, read_place, sink.item)

    @always_comb
    def offer():
        source.ready.next = level != places
        sink.valid.next = level != 0
        put.next = source.valid and level != places
        take.next = sink.ready and level != 0

    @always_seq(clk.posedge, reset=reset)
    def count():
        if put and not take:
            level.next = level + 1
        elif take and not put:
            level.next = level - 1

    return writing, reading, memory, offer, count


def ports(place_bits: int = 2) -> dict:
    """Return new arguments for `fifo`."""
    return {"clk": bit(), "reset": reset_signal(), "source": Stream(), "sink": Stream(), "place_bits": place_bits}


def convert(directory: Path) -> list[Path]:
    """Write the Verilog, and return its files; the top is the last."""
    directory.mkdir(parents=True, exist_ok=True)
    with elaboration():
        return [module.path for module in convert_hierarchy(fifo(**ports()), directory, "// {module}")]


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description="Write the Verilog of a first-in, first-out buffer.")
    parser.add_argument("directory", type=Path, help="directory for the Verilog")
    for path in convert(parser.parse_args().directory):
        print(path)
