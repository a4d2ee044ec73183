# SPDX-License-Identifier: MIT
"""The contract of the conversion with its hierarchy kept, which rests on MyHDL's internals."""

import filecmp
import importlib.metadata
import inspect
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from myhdl import ConcatSignal, Signal, always, always_comb, block, intbv
from myhdl._simulator import _signals

from raycaster.configuration import configure
from raycaster.convert import write
from raycaster.convert.elaboration import elaboration
from raycaster.convert.hierarchy import HierarchyError, Module, Port, convert_hierarchy
from raycaster.convert.take_home import FILE_LIST
from raycaster.convert.write import write_verilog
from raycaster.rtl.common.given import given_verilog, load_words
from raycaster.rtl.common.interfaces import Interface
from raycaster.rtl.common.records import Record
from raycaster.rtl.common.ties import Signed, tied, unconnected
from raycaster.rtl.common.widths import bit, signed, unsigned
from raycaster.verif.leaf import Leaf
from raycaster.verif.seeds import repeat, seed


class Pair(Interface):
    """Two nibbles."""

    def __init__(self):
        self.high, self.low = unsigned(4), unsigned(4)


@block
def swap(pair, swapped):
    """The nibbles the other way round."""

    @always_comb
    def cross():
        swapped.high.next = pair.low
        swapped.low.next = pair.high

    return (cross,)


@block
def step(clk, value, step_by, stepped, wrapped, gain=1):
    """stepped = value + gain * step_by, a cycle and, for step_by, two late; wrapped: what did not fit."""
    width = len(stepped)
    limit = 1 << width
    product = unsigned(width)
    total = unsigned(width + 1)

    # The step, in a register: what is constant triggers no combinational process.
    @always(clk.posedge)
    def multiply():
        product.next = (step_by * gain) % limit

    # Keep the carry.
    @always_comb
    def add():
        total.next = value + product

    # A register.
    @always(clk.posedge)
    def keep():
        stepped.next = total[width:]
        wrapped.next = total[width]

    return multiply, add, keep


@block
def everything(clk, word, pair, joined, swapped, count):
    """Each way to connect a block: by slices, lists, interfaces, constants and not at all."""
    halves = [unsigned(4) for _ in range(2)]
    carries = [unconnected(1), unconnected(1)]
    lower, upper = word(4, 0), word(8, 4)
    amounts = [tied(3, 4), tied(15, 4)]
    one = tied(1, 4)
    both = ConcatSignal(*reversed(halves))
    carry = bit()
    total = unsigned(4)

    first = step(clk, lower, amounts[0], halves[0], carries[0])
    second = step(clk, upper, amounts[1], halves[1], carries[1])
    third = step(clk, total, one, count, carry)
    crossing = swap(pair, swapped)

    # Both halves side by side.
    @always_comb
    def join():
        joined.next = both

    # What a process reads of an instance.
    @always_comb
    def choose():
        if carry:
            total.next = 0
        else:
            total.next = word[4:]

    return first, second, third, crossing, join, choose


def everything_arguments() -> dict:
    signals = {"clk": bit(), "word": unsigned(8), "pair": Pair(), "joined": unsigned(8), "swapped": Pair()}
    return signals | {"count": unsigned(4)}


def converted(top, directory: Path) -> dict[str, Module]:
    directory.mkdir(exist_ok=True)
    return {module.name: module for module in convert_hierarchy(top, directory, "// {module}")}


def test_every_kind_of_connection_works(tmp_path):
    leaf = Leaf(everything, everything_arguments, tmp_path)
    random = np.random.default_rng(seed())
    names = {"word": 256, "pair_high": 16, "pair_low": 16}
    stimulus = [{name: int(random.integers(limit)) for name, limit in names.items()} for _ in range(200)]
    outputs = leaf.run_both(stimulus, settled=4)
    for cycle in range(4, 200):
        word, pair = stimulus[cycle - 1]["word"], stimulus[cycle]
        joined = (word + 3) % 16 | ((word >> 4) + 15) % 16 << 4
        assert outputs[cycle]["joined"] == joined, repeat()
        assert outputs[cycle]["swapped_high"] == pair["pair_low"], repeat()
        assert outputs[cycle]["swapped_low"] == pair["pair_high"], repeat()
        # The carry of the cycle before clears what is counted from.
        carried = outputs[cycle - 1]["count"] == 0
        assert outputs[cycle]["count"] == (1 if carried else (word % 16 + 1) % 16), repeat()


def test_modules_ports_and_instances(tmp_path):
    modules = converted(everything(**everything_arguments()), tmp_path)
    assert list(modules) == ["step", "swap", "everything"], "each after those that it instantiates, equal ones once"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["everything.v", "step.v", "swap.v"]
    assert modules["everything"].instances == {"step_0": "step", "step_1": "step", "step_2": "step", "swap": "swap"}
    assert modules["step"].instances == {}
    assert set(modules["everything"].ports) == {
        Port("clk", 1, False, False),
        Port("word", 8, False, False),
        Port("pair_high", 4, False, False),
        Port("pair_low", 4, False, False),
        Port("joined", 8, False, True),
        Port("swapped_high", 4, False, True),
        Port("swapped_low", 4, False, True),
        Port("count", 4, False, True),
    }
    text = modules["everything"].path.read_text()
    assert re.findall(r"^(\w+) (\w+_i) \($", text, re.M) == [
        ("step", "step_0_i"),
        ("step", "step_1_i"),
        ("step", "step_2_i"),
        ("swap", "swap_i"),
    ]
    assert text.count(".wrapped()") == 2, "nobody reads two of the carries"
    assert "// A register.\nalways @(posedge clk) begin" in modules["step"].path.read_text()


def test_a_signed_port_is_signed(tmp_path):
    @block
    def double(value, doubled):
        @always_comb
        def add():
            doubled.next = value + value

        return (add,)

    modules = converted(double(signed(4), signed(5)), tmp_path)
    assert modules["double"].ports == (Port("value", 4, True, False), Port("doubled", 5, True, True))


def test_a_block_converts_alike_wherever_it_stands(tmp_path):
    within = converted(everything(**everything_arguments()), tmp_path / "within")
    alone = converted(step(bit(), unsigned(4), unsigned(4), unsigned(4), bit()), tmp_path / "alone")
    again = converted(everything(**everything_arguments()), tmp_path / "again")
    assert within["step"].path.read_text() == alone["step"].path.read_text()
    for name, module in within.items():
        assert module.path.read_text() == again[name].path.read_text()


@block
def two_steps(clk, value, by, first, second, gains, widths):
    steps = [
        step(clk, value, by, out, unconnected(1), gain=gain)
        for out, gain, _ in zip((first, second), gains, widths, strict=True)
    ]

    return (steps,)


def two_steps_of(gains: tuple[int, int], widths: tuple[int, int]):
    outputs = [unsigned(width) for width in widths]
    return two_steps(bit(), unsigned(4), unsigned(4), *outputs, gains, widths)


def test_one_name_is_one_module(tmp_path):
    assert list(converted(two_steps_of((2, 2), (4, 4)), tmp_path)) == ["step", "two_steps"]


@pytest.mark.parametrize(("gains", "widths"), [((1, 2), (4, 4)), ((1, 1), (4, 5))])
def test_one_block_with_two_meanings_is_two_modules(gains, widths, tmp_path):
    leaf = Leaf(
        two_steps,
        lambda: {
            "clk": bit(), "value": unsigned(4), "by": unsigned(4), "first": unsigned(widths[0]),
            "second": unsigned(widths[1]), "gains": gains, "widths": widths,
        },
        tmp_path,
    )  # fmt: skip
    assert [module.name for module in leaf.modules] == ["step", "step_1", "two_steps"]
    assert leaf.modules[-1].instances == {"step_0": "step", "step_1": "step_1"}
    outputs = leaf.run_both([{"value": 9, "by": 7}] * 4, settled=3)
    assert outputs[-1] == {
        name: (9 + 7 * gain % (1 << width)) % (1 << width)
        for name, gain, width in zip(("first", "second"), gains, widths, strict=True)
    }


def another_step():
    """A block of one's own that happens to be called, and to look, like `step`."""

    @block
    def step(clk, value, step_by, stepped, wrapped, gain=1):
        @always(clk.posedge)
        def keep():
            stepped.next = value ^ step_by
            wrapped.next = False

        return (keep,)

    return step


@block
def two_kinds(clk, value, by, first, second, other):
    """Both of them."""
    ours = step(clk, value, by, first, unconnected(1))
    theirs = other(clk, value, by, second, unconnected(1))

    return ours, theirs


def test_two_blocks_of_one_name_are_two_modules(tmp_path):
    other = another_step()
    leaf = Leaf(
        two_kinds,
        lambda: {
            "clk": bit(), "value": unsigned(4), "by": unsigned(4), "first": unsigned(4), "second": unsigned(4),
            "other": other,
        },
        tmp_path,
    )  # fmt: skip
    assert leaf.modules[-1].instances == {"step_0": "step", "step_1": "step_1"}
    assert leaf.run_both([{"value": 6, "by": 3}] * 4, settled=3)[-1] == {"first": 9, "second": 5}


class Mirrored(Pair):
    """The same nibbles, but for a block that decides by the class."""


@block
def halve(pair, half):
    """The high nibble, or of a `Mirrored` the low one."""
    chosen = pair.low if isinstance(pair, Mirrored) else pair.high

    @always_comb
    def choose():
        half.next = chosen

    return (choose,)


@block
def halve_both(pair, mirrored, first, second):
    """One of each class."""
    one = halve(pair, first)
    other = halve(mirrored, second)

    return one, other


def test_the_class_of_an_interface_tells_modules_apart(tmp_path):
    leaf = Leaf(
        halve_both,
        lambda: {"pair": Pair(), "mirrored": Mirrored(), "first": unsigned(4), "second": unsigned(4)},
        tmp_path,
    )
    assert [module.name for module in leaf.modules] == ["halve", "halve_1", "halve_both"]
    assert leaf.run_both([{"pair_high": 3, "mirrored_low": 12}])[-1] == {"first": 3, "second": 12}


class Packed(Record):
    """A record of one field of each kind."""

    def __init__(self):
        super().__init__({"flag": 1, "count": 3, "offset": Signed(5)})


@block
def records(clk, packed, index, kept, sum, negative):
    """A memory of records, a copy, and fields of both signs read."""
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


def test_a_record_is_one_word(tmp_path):
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
    assert "kept_flag" not in text, "only the fields that are read are there"
    random = np.random.default_rng(seed())
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
            assert outputs["kept_offset"] == kept, repeat()
            first, second = (value - 32 * (value > 15) for value in (kept, inputs["packed_offset"]))
            assert outputs["sum"] == (first + second) % 64, repeat()
            assert outputs["negative"] == (first < 0), repeat()
        kept = memory.get(inputs["index"])
        if inputs["packed_flag"]:
            memory[inputs["index"]] = inputs["packed_offset"]


@block
def careless(clk, value, result, undriven, unread):
    """Where asked to, it reads a signal that nobody drives, or drives one that nobody reads."""
    nothing, lost = unsigned(4), unsigned(4)

    @always(clk.posedge)
    def copy():
        result.next = value

    if undriven:

        @always(clk.posedge)
        def work():
            result.next = value ^ nothing

    elif unread:

        @always(clk.posedge)
        def work():
            lost.next = value

    else:
        return (copy,)

    return (work,) if undriven else (copy, work)


@block
def careless_parent(clk, value, result, undriven, unread):
    """The same, where the signal is between instances."""
    nothing, carry = unsigned(4), bit()
    given = nothing if undriven else value
    lost = carry if unread else unconnected(1)
    stepping = step(clk, value, given, result, lost)

    return (stepping,)


@pytest.mark.parametrize("function", [careless, careless_parent])
@pytest.mark.parametrize(
    ("undriven", "unread", "complaint"),
    [(True, False, "not driven"), (False, True, "not read"), (False, False, None)],
)
def test_a_signal_without_a_driver_or_reader_is_refused(function, undriven, unread, complaint, tmp_path):
    top = function(bit(), unsigned(4), unsigned(4), undriven, unread)
    if complaint is None:
        converted(top, tmp_path)
    else:
        with pytest.raises(HierarchyError, match=f"{function.__name__}: .*{complaint}"):
            converted(top, tmp_path)


def test_a_connection_without_a_name_is_refused(tmp_path):
    @block
    def nameless(clk, value, result):
        # The first one's result is known to no variable.
        first = step(clk, value, value, unsigned(4), unconnected(1))
        second = step(clk, value, value, result, unconnected(1))

        return first, second

    with pytest.raises(HierarchyError, match=r"nameless: what step\.stepped connects to has no name"):
        converted(nameless(bit(), unsigned(4), unsigned(4)), tmp_path)


ADDER = """// Adds, a cycle late.
module adder #(parameter STEP = 1, parameter WIDTH = 8) (
    input clk, input [3:0] value, output reg [WIDTH-1:0] sum, output unused
);
always @(posedge clk) sum <= value + STEP;
endmodule
"""


def adder_of(source: Path, outputs: tuple[str, ...] = ("sum",)):
    @given_verilog(lambda: source, outputs)
    @block
    def adder(clk, value, sum, STEP, WIDTH):
        return ()

    return adder


@block
def two_adders(clk, value, first, second, doubled, adder):
    """Given Verilog beside a process; one sum goes on into the other."""
    one = adder(clk, value, first, STEP=3, WIDTH=4)
    two = adder(clk, first, second, STEP=3, WIDTH=4)

    # What a process reads of it.
    @always_comb
    def double():
        doubled.next = first + first

    return one, two, double


def two_adders_of(adder):
    return two_adders(bit(), unsigned(4), unsigned(4), unsigned(4), unsigned(5), adder)


def test_given_verilog_stands_in_the_design_as_it_is(tmp_path):
    source = tmp_path / "given.v"
    source.write_text(ADDER)
    modules = converted(two_adders_of(adder_of(source)), tmp_path / "verilog")
    assert list(modules) == ["adder", "two_adders"], "two instances of equal parameters are one module"
    assert modules["adder"].path.read_text() == ADDER
    assert modules["adder"].parameters == (("STEP", "3"), ("WIDTH", "4"))
    assert modules["adder"].ports == (
        Port("clk", 1, False, False), Port("value", 4, False, False), Port("sum", 4, False, True),
    )  # fmt: skip
    assert modules["two_adders"].instances == {"adder_0": "adder", "adder_1": "adder"}
    text = modules["two_adders"].path.read_text()
    assert "adder #(\n    .STEP(3),\n    .WIDTH(4)\n) adder_0_i (\n    .clk(clk),\n    .value(value)," in text
    (tmp_path / "bench.v").write_text(
        """module bench;
reg clk = 0;
wire [3:0] first, second;
wire [4:0] doubled;
two_adders dut (.clk(clk), .value(4'd5), .first(first), .second(second), .doubled(doubled));
initial begin
    repeat (4) #1 clk = ~clk;
    $display("%0d %0d %0d", first, second, doubled);
end
endmodule
"""
    )
    files = [str(module.path) for module in modules.values()]
    compiled = str(tmp_path / "bench")
    subprocess.run(["iverilog", "-g2005", "-o", compiled, str(tmp_path / "bench.v"), *files], check=True)
    done = subprocess.run(["vvp", "-n", compiled], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["8", "11", "16"]


def test_an_output_of_given_verilog_must_be_an_argument(tmp_path):
    adder = adder_of(tmp_path / "given.v", ("sum", "carry"))
    with pytest.raises(HierarchyError, match=r"adder: carry is said to be an output, and is no argument"):
        converted(two_adders_of(adder), tmp_path / "verilog")


@block
def word_table(clk, index, word, values, file):
    """A memory with a file's words, which are values."""
    words = [Signal(intbv(value)[8:]) for value in values]

    loading = load_words(words, file)

    @always(clk.posedge)
    def fetch():
        word.next = words[index]

    return loading, fetch


def test_a_memory_holds_a_files_words(tmp_path):
    values, file = [7, 250, 0, 99], tmp_path / "words.hex"
    file.write_text("".join(f"{value:x}\n" for value in values))
    leaf = Leaf(
        word_table,
        lambda: {"clk": bit(), "index": unsigned(2), "word": unsigned(8), "values": values, "file": str(file)},
        tmp_path,
    )
    outputs = leaf.run_both([{"index": index} for index in (3, 0, 1, 2, 0)], settled=1)
    assert [output["word"] for output in outputs[1:]] == [99, 7, 250, 0]
    text = leaf.verilog[-1].read_text()
    assert text.count(f'// What the memory holds from the start.\ninitial $readmemh("{file}", words);\n') == 1


@block
def sliced_elsewhere(clk, pair, swapped, narrow):
    """One instance reads a slice of what another, which has the whole interface, does not look at."""
    crossing = swap_low(pair, swapped)
    stepping = step(clk, pair.high(2, 0), pair.high(2, 0), narrow, unconnected(1))

    return crossing, stepping


@block
def swap_low(pair, swapped):
    """Half of swap."""

    @always_comb
    def cross():
        swapped.high.next = pair.low

    return (cross,)


def test_a_slice_elsewhere_is_no_port_here(tmp_path):
    modules = converted(sliced_elsewhere(bit(), Pair(), Pair(), unsigned(2)), tmp_path)
    assert [port.name for port in modules["swap_low"].ports] == ["pair_low", "swapped_high"]


def test_elaboration_leaves_nothing_behind():
    before = inspect.stack
    slow = [(frame[0], frame[3]) for frame in inspect.stack()]
    known = len(_signals)
    with elaboration():
        assert inspect.stack is not before
        # What MyHDL reads of a frame.
        assert [(frame[0], frame[3]) for frame in inspect.stack()] == slow
        signal = bit()
        assert _signals[-1] is signal
    assert inspect.stack is before
    assert len(_signals) == known


def test_myhdl_is_the_version_that_this_was_written_for():
    pins = [line for line in importlib.metadata.requires("raycaster") if line.startswith("myhdl")]
    assert pins == [f"myhdl=={importlib.metadata.version('myhdl')}"]


# The whole design ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("units", [1, 8])
def test_a_unit_is_one_module_and_many_instances(units, tmp_path):
    config = configure(units=units, screen="tiny", rectangles=2, allow_underrun=True)
    files = write_verilog(config, tmp_path / "verilog")
    names = [path.stem for path in files]
    assert len(set(names)) == len(names)
    for module in ("ray_unit", "line_buffer"):
        assert names.count(module) == 1
        instances = [re.findall(rf"^{module} {module}(_\d+)?_i \($", path.read_text(), re.M) for path in files]
        assert sum(map(len, instances)) == units
    defined = {path: re.findall(r"^module (\w+)", path.read_text(), re.M) for path in files}
    assert defined == {path: [path.stem] for path in files}
    assert names[-1] == "ray_caster_module"
    assert (tmp_path / "verilog" / FILE_LIST).read_text().split() == [path.name for path in files]


def test_every_module_is_made_of_nothing_unknown(tmp_path):
    """In the order of the file list, each module stands after those that it instantiates."""
    files = write_verilog(configure(screen="tiny", units=2, rectangles=2, allow_underrun=True), tmp_path / "verilog")
    known = set()
    for path in files:
        used = set(re.findall(r"^(\w+) \w+_i \($", path.read_text(), re.M))
        assert used <= known, path.name
        known.add(path.stem)


def test_the_header_says_what_and_never_when(tmp_path):
    config = configure(screen="tiny", units=2, rectangles=2, fraction_bits=1, allow_underrun=True)
    for path in write_verilog(config, tmp_path / "verilog"):
        lines = path.read_text().splitlines()
        assert lines[:2] == [f"// RayCaster: {path.stem}", f"// Configuration: {config.name}"]
        assert "// SPDX-License-Identifier: MIT" in lines
        assert not re.search(r"\b20\d\d-|(?<!\[)\b\d\d:\d\d|MyHDL|Generated", path.read_text())


def test_two_processes_write_the_same_bytes(tmp_path):
    # Python's sets, of which MyHDL makes use, come in another order with another hash seed.
    for number in ("1", "2"):
        command = [sys.executable, "-m", "raycaster.cli", "verilog", "--output", str(tmp_path / number)]
        command += ["--screen", "tiny", "--units", "4", "--rectangles", "5", "--allow-underrun"]
        subprocess.run(command, env={**os.environ, "PYTHONHASHSEED": number}, check=True, capture_output=True)
    first, second = (
        sorted(str(path.relative_to(tmp_path / number)) for path in (tmp_path / number).rglob("*") if path.is_file())
        for number in ("1", "2")
    )
    assert first == second != []
    assert filecmp.cmpfiles(tmp_path / "1", tmp_path / "2", first, shallow=False) == (first, [], [])


def test_a_directory_is_replaced_as_a_whole(tmp_path):
    directory = tmp_path / "verilog"
    directory.mkdir()
    (directory / "ray_unit_of_yesterday.v").write_text("module ray_unit;")
    config = configure(screen="tiny", units=2, rectangles=2, allow_underrun=True)
    write_verilog(config, directory)
    assert not list(directory.glob("*yesterday*"))
    assert [path.name for path in tmp_path.iterdir()] == ["verilog"], "nothing else is left"


def test_a_conversion_that_fails_leaves_what_was_there(tmp_path, monkeypatch):
    directory = tmp_path / "verilog"
    directory.mkdir()
    (directory / "kept.v").write_text("module kept;")

    def fail(*_):
        raise HierarchyError("broken")

    monkeypatch.setattr(write, "convert_hierarchy", fail)
    with pytest.raises(HierarchyError):
        write_verilog(configure(screen="tiny", units=2, rectangles=2, allow_underrun=True), directory)
    assert [path.name for path in directory.iterdir()] == ["kept.v"]
    assert [path.name for path in tmp_path.iterdir()] == ["verilog"]
