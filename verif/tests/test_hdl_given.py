# SPDX-License-Identifier: MIT
"""Given Verilog, clocks that rest, and memories that are loaded stand in a design."""

import pytest
from hdl_blocks import converted, random_inputs
from myhdl import Signal, always, always_comb, block, intbv

from raycaster.hdl.errors import UserError
from raycaster.hdl.given import given_verilog, load_words
from raycaster.hdl.hierarchy import Port
from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import bit, derived_clock, unsigned
from raycaster.rtl.common.clock_gate import clock_gate

ADDER = """// Adds, a cycle late.
module adder #(parameter STEP = 1, parameter WIDTH = 8) (
    input clk, input [3:0] value, output reg [WIDTH-1:0] sum, output unused
);
always @(posedge clk) sum <= value + STEP;
endmodule
"""


@pytest.fixture
def adder(tmp_path):
    """Return a function that makes a block of given Verilog."""

    def make(text: str = ADDER, outputs: tuple[str, ...] = ("sum",)):
        source = tmp_path / "given.v"
        source.write_text(text)

        @given_verilog(lambda: source, outputs)
        @block
        def adder(clk, value, sum, STEP, WIDTH):
            return ()

        return adder

    return make


@block
def two_adders(clk, value, first, second, doubled, adder, other):
    """Chain two instances, and read the first sum in a process."""
    one = adder(clk, value, first, STEP=3, WIDTH=4)
    two = other(clk, first, second, STEP=4, WIDTH=4)

    @always_comb
    def double():
        doubled.next = first + first

    return one, two, double


def arguments(adder, other=None) -> dict:
    words = {name: unsigned(4) for name in ("value", "first", "second")}
    return {"clk": bit(), **words, "doubled": unsigned(5), "adder": adder, "other": other or adder}


def test_given_verilog_stands_in_the_design_as_it_is(adder, tmp_path):
    """Instances with different parameters share the file, and a process reads an output of it."""
    given = adder()
    leaf = Leaf(two_adders, lambda: arguments(given), tmp_path)
    first, top = leaf.modules
    assert first.path.read_text() == ADDER
    assert (first.name, first.parameters) == ("adder", (("STEP", "3"), ("WIDTH", "4")))
    assert first.ports == (
        Port("clk", 1, False, False), Port("value", 4, False, False), Port("sum", 4, False, True),
    )  # fmt: skip
    assert (top.name, top.instances) == ("two_adders", {"adder_0": "adder", "adder_1": "adder"})
    for number, step_by in enumerate((3, 4)):
        head = f"adder #(\n    .STEP({step_by}),\n    .WIDTH(4)\n) adder_{number}_i (\n    .clk(clk),\n    .value("
        assert head in top.path.read_text()
    assert tuple(leaf.run_verilog([{"value": 5}] * 3)[-1].values()) == (8, 12, 16)


@block
def hold(clock, value, held):
    @always(clock.posedge)
    def take():
        held.next = value

    return take


@block
def two_clocks(clk, reset, awake, value, steady, resting):
    """A register on the free-running clock, and one on a clock that rests in the cycle after one without `awake`."""
    awake_now, resting_clk = bit(), derived_clock(clk)
    waking = hold(clk, awake, awake_now)
    going_on = hold(clk, value, steady)
    at_rest = hold(resting_clk, value, resting)
    gate = clock_gate(clk, reset, awake_now, resting_clk)

    return waking, going_on, at_rest, gate


def test_a_clock_rests(tmp_path, random):
    """It rests in Verilog with CLOCK_GATING only, and never during reset."""
    widths = dict.fromkeys(("clk", "reset", "awake"), 1) | dict.fromkeys(("value", "steady", "resting"), 4)
    leaf = Leaf(two_clocks, lambda: {name: unsigned(w) if w > 1 else bit() for name, w in widths.items()}, tmp_path)
    stimulus = [{"awake": 1, "value": 0}, *random_inputs(leaf, random, 50)]
    outputs = leaf.run_both(stimulus, settled=1)
    assert all(cycle["resting"] == cycle["steady"] for cycle in outputs)
    (tmp_path / "gating.v").write_text("`define CLOCK_GATING\n")
    leaf.verilog = [tmp_path / "gating.v", *leaf.verilog]
    taken = 0
    for before, inputs, after in zip(stimulus[:-2], stimulus[1:-1], leaf.run_verilog(stimulus)[2:], strict=True):
        taken = inputs["value"] if before["awake"] or inputs["reset"] else taken
        assert after["resting"] == taken


@block
def ours(clk, value, sum, STEP=1, WIDTH=4, given=hold):
    """Contain the given block, or a register."""
    inner = given(clk, value, sum, **({} if given is hold else {"STEP": STEP, "WIDTH": WIDTH}))

    return (inner,)


ours.func.__name__ = "adder"


def test_given_verilog_keeps_its_name(adder, tmp_path):
    given = adder()
    modules = converted(two_adders(**arguments(given, ours)), tmp_path / "verilog")
    assert modules["two_adders"].instances == {"adder_0": "adder", "adder_1": "adder_1"}
    assert modules["adder"].path.read_text() == ADDER


@pytest.mark.parametrize(
    ("design", "said"),
    [
        (lambda make: two_adders(**arguments(ours, make())), "adder is the name of given Verilog, which stays, and of"),
        (lambda make: two_adders(**arguments(make(), make())), "adder is the name of given Verilog, which stays, and"),
        (lambda make: ours(bit(), unsigned(4), unsigned(4), given=make()), "adder is the name of given Verilog"),
        (lambda make: two_adders(**arguments(make(ADDER.replace("module adder", "module adders")))),
         r"given\.v has no module adder"),
        (lambda make: two_adders(**arguments(make(outputs=("sum", "carry")))),
         "adder: carry is listed as an output, but no argument"),
    ],
    ids=["ours-first", "given-twice", "top", "module", "output"],
)  # fmt: skip
def test_wrong_use_of_given_verilog_is_refused(design, said, adder, tmp_path):
    with pytest.raises(UserError, match=said):
        converted(design(adder), tmp_path / "verilog")


@block
def word_table(clk, index, word, file):
    """A memory whose initial words come from a file; in MyHDL they are here."""
    words = [Signal(intbv(value)[8:]) for value in (7, 250, 0, 99)]

    loading = load_words(words, file)

    @always(clk.posedge)
    def fetch():
        word.next = words[index]

    return loading, fetch


def test_a_memory_holds_a_files_words(tmp_path):
    file = tmp_path / "words.hex"
    file.write_text("7\nfa\n0\n63\n")
    leaf = Leaf(
        word_table, lambda: {"clk": bit(), "index": unsigned(2), "word": unsigned(8), "file": str(file)}, tmp_path
    )
    outputs = leaf.run_both([{"index": index} for index in (3, 0, 1, 2, 0)], settled=1)
    assert [output["word"] for output in outputs[1:]] == [99, 7, 250, 0]
    text = leaf.verilog[-1].read_text()
    assert text.count(f'// Initial contents of the memory.\ninitial $readmemh("{file}", words);\n') == 1
