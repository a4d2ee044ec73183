# SPDX-License-Identifier: MIT
"""Blocks become modules, connected as in MyHDL; records become words with fields."""

import re

import pytest
from hdl_blocks import Packed, converted, everything, everything_arguments, random_inputs, step
from myhdl import always, always_comb, block

from raycaster.hdl.hierarchy import Port
from raycaster.hdl.internals import bits_of
from raycaster.hdl.leaf import Leaf
from raycaster.hdl.records import Record
from raycaster.hdl.signals import Signed, bit, signed, unsigned
from raycaster.hdl.verbs import assign, less, minus, plus, register, times
from raycaster.sim.simulator import find_tool


@pytest.mark.slow_sets("verilator")
@pytest.mark.parametrize("simulator", ["icarus", "verilator"])
def test_every_kind_of_connection_works(simulator, tmp_path, monkeypatch, random):
    """Both simulators of Verilog agree with MyHDL."""
    for name, value in find_tool("verilator").environment.items():
        monkeypatch.setenv(name, value)
    monkeypatch.setattr(Leaf, "simulator", simulator)
    leaf = Leaf(everything, everything_arguments, tmp_path)
    stimulus = random_inputs(leaf, random, 200)
    outputs = leaf.run_both(stimulus, settled=4)
    for cycle in range(4, 200):
        word, pair = stimulus[cycle - 1]["word"], stimulus[cycle]
        joined = (word + 3) % 16 | ((word >> 4) + 15) % 16 << 4
        assert outputs[cycle]["joined"] == joined
        assert outputs[cycle]["swapped_high"] == pair["pair_low"]
        assert outputs[cycle]["swapped_low"] == pair["pair_high"]
        # The previous cycle's carry clears the counter's input.
        carried = outputs[cycle - 1]["count"] == 0
        assert outputs[cycle]["count"] == (1 if carried else (word % 16 + 1) % 16)


def test_modules_ports_and_instances(tmp_path):
    modules = converted(everything(**everything_arguments()), tmp_path)
    # Each follows those that it instantiates, equal ones once.
    assert [*modules] == ["step", "step_1", "chosen_part", "swap", "inverted", "passed_on", "everything"]
    assert modules["everything"].instances == {
        "step_0": "step", "step_1": "step", "step_2": "step", "step_3": "step_1", "chosen_part": "chosen_part",
        "swap": "swap", "inverted_0": "inverted", "passed_on": "passed_on", "inverted_1": "inverted",
        "inverted_2": "inverted",
    }  # fmt: skip
    assert modules["step"].instances == {}
    inputs = {"clk": 1, "word": 8, "pair_high": 4, "pair_low": 4}
    outputs = {"joined": 8, "count": 4, "part": 4, "narrow": 2, "swapped_high": 4, "swapped_low": 4}
    outputs |= {f"inverses_{index}": 8 for index in range(4)}
    assert {*modules["everything"].ports} == {
        Port(name, width, False, ports is outputs) for ports in (inputs, outputs) for name, width in ports.items()
    }
    text = modules["everything"].path.read_text()
    assert re.findall(r"^\w+ (\w+)_i \($", text, re.M) == list(modules["everything"].instances)
    assert text.count(".wrapped()") == 3, "three of the carries are not read"
    assert [port.name for port in modules["chosen_part"].ports] == ["part", "group_high"], "others are not read"
    alone = converted(step(bit(), unsigned(4), unsigned(4), unsigned(4), bit()), tmp_path / "alone")
    assert alone["step"].path.read_text() == modules["step"].path.read_text(), "it is the same wherever it stands"


@block
def records(clk, packed, kept, sum, negative):
    """Copy records, and read signed and unsigned fields."""

    @always(clk.posedge)
    def store():
        if packed.flag:
            kept.word.next = packed.word

    @always_comb
    def compute():
        sum.next = kept.offset + packed.offset
        negative.next = kept.offset < 0

    return store, compute


def records_arguments() -> dict:
    return {"clk": bit(), "packed": Packed(), "kept": Packed(), "sum": signed(6), "negative": bit()}


def test_a_record_is_one_word(tmp_path, random):
    leaf = Leaf(records, records_arguments, tmp_path)
    text = leaf.verilog[-1].read_text()
    assert re.search(r"^    input  wire \[8:0\] +packed_word,$", text, re.M)
    assert "wire signed [4:0] kept_offset = kept_word[4:0];" in text
    assert "kept_flag" not in text, "fields that are not read are left out"
    stimulus = [{"packed_flag": 1, "packed_count": 3, "packed_offset": 16}, *random_inputs(leaf, random, 200)]
    outputs = leaf.run_both(stimulus, settled=1)
    kept = 16
    for inputs, seen in zip(stimulus[1:], outputs[1:], strict=True):
        first, second = ((offset ^ 16) - 16 for offset in (kept, inputs["packed_offset"]))
        assert seen["kept_offset"] == kept
        assert (seen["sum"], seen["negative"]) == ((first + second) % 64, first < 0)
        kept = inputs["packed_offset"] if inputs["packed_flag"] else kept


@pytest.mark.parametrize(
    "made",
    [lambda record: record.twin(), lambda record: record.tie({"low": 3}), lambda record: record.cut(unsigned(16), 1)],
)
def test_fields_and_parts_belong_to_the_word(made):
    """Parts, as fields, are bits of a record's present word, also after it was tied, cut or copied."""
    record = Record({"high": 4, "absent": 0, "low": 4}, {"middle": (2, 4), "none": (0, 0)})
    found = made(record)
    places = {name: bits_of(getattr(found, name)) for name in ("high", "middle", "low")}
    assert places == {"high": (found.word, 7, 4), "middle": (found.word, 5, 2), "low": (found.word, 3, 0)}
    assert (len(found.none), int(found.none.val), int(found.absent.val)) == (1, 0, 0)


@block
def with_verbs(a, b, behind, product, copied):
    """Compute with verbs only."""
    total, add = plus(a, b, 5)
    difference, subtract = minus(a, b, Signed(5))
    tripled, multiply = times(total, 3, 7)
    is_less, compare = less(difference, 0)
    # The result
    # of two lines.
    see = assign(
        behind,
        lambda: is_less,
    )
    show = assign(product, lambda: tripled)
    again = assign(copied, lambda: tripled)

    return add, subtract, multiply, compare, see, show, again


def test_verbs(tmp_path, random):
    """A verb is an assignment to a signal with the name of the block's variable."""
    arguments = {"a": lambda: unsigned(4), "b": lambda: unsigned(4), "behind": bit, "product": lambda: unsigned(7)}
    arguments["copied"] = arguments["product"]
    leaf = Leaf(with_verbs, lambda: {name: made() for name, made in arguments.items()}, tmp_path)
    stimulus = random_inputs(leaf, random, 50)
    for inputs, outputs in zip(stimulus, leaf.run_both(stimulus), strict=True):
        a, b = inputs["a"], inputs["b"]
        assert outputs == {"behind": a < b, "product": 3 * (a + b), "copied": 3 * (a + b)}
    text = (tmp_path / "with_verbs.v").read_text()
    assert re.findall(r"assign (.*);", text) == [
        "total = a + b", "difference = a - b", "tripled = total * 3", "is_less = difference < 0",
        "behind = is_less", "product = tripled", "copied = tripled",
    ]  # fmt: skip
    assert "\n// The result of two lines.\nassign behind = is_less;\n\nassign product = tripled;\nassign copied" in text


@block
def with_registers(clk, place, word, write, shown, count, late, former, less):
    """Write a memory on request, and read it and count in each cycle; keep the last two words that were written."""
    memory = [unsigned(4) for _ in range(4)]
    total, one, other = unsigned(4), unsigned(4), unsigned(4)
    # Before the memory.
    keep = register(clk, memory[place], lambda: word, write)
    fetch = register(clk, shown, lambda: memory[place])
    counting = register(clk, total, lambda: (total + 1) % 16, write)
    # Two at a time.
    pair = register(
        clk,
        (one, other),
        lambda: (word, one),
        write,
    )
    show = assign((count, late, former, less), lambda: (total, one, other, one < other))
    return keep, fetch, counting, pair, show


def test_registers(tmp_path, random):
    widths = {"place": 2, "word": 4, "shown": 4, "count": 4, "late": 4, "former": 4}
    leaf = Leaf(
        with_registers,
        lambda: (
            {name: bit() for name in ("clk", "write", "less")} | {one: unsigned(bits) for one, bits in widths.items()}
        ),
        tmp_path,
    )
    stimulus = random_inputs(leaf, random, 50)
    memory, shown, count, late, former = [0] * 4, 0, 0, 0, 0
    for inputs, outputs in zip(stimulus, leaf.run_both(stimulus), strict=True):
        kept = {"late": late, "former": former, "less": late < former}
        assert outputs == {"shown": shown, "count": count} | kept
        shown = memory[inputs["place"]]
        if inputs["write"]:
            memory[inputs["place"]], count = inputs["word"], (count + 1) % 16
            late, former = inputs["word"], late
    text = (tmp_path / "with_registers.v").read_text()
    assert (
        "// Before the memory.\nalways @(posedge clk) begin\n    if (write) begin\n        memory[place] <= word;"
        in text
    )
    assert "// Two at a time.\nalways @(posedge clk) begin\n    if (write) begin\n        one <= word;\n" in text


def test_a_line_has_one_lambda():
    """A process is known by the line of its lambda."""
    target, other, source = bit(), bit(), bit()
    with pytest.raises(SyntaxError, match="one lambda in a line"):
        assign(target, lambda: source), assign(other, lambda: not source)


@pytest.mark.parametrize(
    "made",
    [
        lambda clk, one, other: assign((one, other), lambda: clk),
        lambda clk, one, other: assign(one, lambda: (clk, other)),
        lambda clk, one, other: register(clk, (one, one), lambda: (clk, other)),
    ],
)
def test_each_signal_of_a_call_has_a_value(made):
    with pytest.raises(SyntaxError, match="expected different signals, and a value for each"):
        made(bit(), bit(), bit())
