# SPDX-License-Identifier: MIT
"""Records are words with fields."""

import re

from myhdl import always, always_comb, block

from raycaster.hdl.leaf import Leaf
from raycaster.hdl.records import Record
from raycaster.hdl.signals import Signed, bit, signed, unsigned


class Packed(Record):
    """Record with one field of each kind."""

    def __init__(self):
        super().__init__({"flag": 1, "count": 3, "offset": Signed(5)})


@block
def records(clk, packed, index, kept, sum, negative):
    """Store and copy records, and read signed and unsigned fields."""
    memory = [unsigned(len(packed.word)) for _ in range(4)]

    @always(clk.posedge)
    def store():
        if packed.flag:
            memory[index].next = packed.word
        kept.word.next = memory[index]

    @always_comb
    def compute():
        sum.next = kept.offset + packed.offset
        negative.next = kept.offset < 0

    return store, compute


def test_a_record_is_one_word(tmp_path, random):
    leaf = Leaf(
        records,
        lambda: {
            "clk": bit(), "packed": Packed(), "index": unsigned(2), "kept": Packed(), "sum": signed(6),
            "negative": bit(),
        },
        tmp_path,
    )  # fmt: skip
    text = leaf.verilog[-1].read_text()
    assert re.search(r"^    input  wire \[8:0\] +packed_word,$", text, re.M)
    assert "wire signed [4:0] kept_offset = kept_word[4:0];" in text
    assert "kept_flag" not in text, "fields that are not read are left out"
    stimulus = [{"packed_flag": 1, "packed_count": index, "packed_offset": index, "index": index} for index in range(4)]
    stimulus += [
        {name: int(random.integers(1 << bits)) for name, bits in
         (("packed_flag", 1), ("packed_count", 3), ("packed_offset", 5), ("index", 2))}
        for _ in range(200)
    ]  # fmt: skip
    memory: dict[int, int] = {}
    kept = None
    for cycle, (inputs, outputs) in enumerate(zip(stimulus, leaf.run_both(stimulus, settled=5), strict=True)):
        if kept is not None and cycle >= 5:
            assert outputs["kept_offset"] == kept
            first, second = (value - 32 * (value > 15) for value in (kept, inputs["packed_offset"]))
            assert outputs["sum"] == (first + second) % 64
            assert outputs["negative"] == (first < 0)
        kept = memory.get(inputs["index"])
        if inputs["packed_flag"]:
            memory[inputs["index"]] = inputs["packed_offset"]
