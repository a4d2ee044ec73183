# SPDX-License-Identifier: MIT
"""Given Verilog, clocks that rest, and memories that are loaded stand in a design."""

import pytest
from conftest import run_tool
from hdl_blocks import converted
from myhdl import Signal, always, always_comb, block, intbv

from raycaster.hdl.errors import UserError
from raycaster.hdl.given import given_verilog, load_words
from raycaster.hdl.hierarchy import Port
from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import bit, unsigned
from raycaster.rtl.common.clock_gate import clock_gate, rests_on

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
def two_adders(clk, value, first, second, doubled, adder, other, steps):
    """Chain two instances, and read the first sum in a process."""
    one = adder(clk, value, first, STEP=steps[0], WIDTH=4)
    two = other(clk, first, second, STEP=steps[1], WIDTH=4)

    @always_comb
    def double():
        doubled.next = first + first

    return one, two, double


def arguments(adder, other=None, steps=(3, 3)) -> dict:
    words = {name: unsigned(4) for name in ("value", "first", "second")}
    return {"clk": bit(), **words, "doubled": unsigned(5), "adder": adder, "other": other or adder, "steps": steps}


@pytest.mark.parametrize(("steps", "sums"), [((3, 3), (8, 11, 16)), ((3, 4), (8, 12, 16))])
def test_given_verilog_stands_in_the_design_as_it_is(adder, steps, sums, tmp_path):
    """Instances with equal or different parameters share the file, and a process reads an output of it."""
    given = adder()
    leaf = Leaf(two_adders, lambda: arguments(given, steps=steps), tmp_path)
    first, top = leaf.modules
    assert first.path.read_text() == ADDER
    assert (first.name, first.parameters) == ("adder", (("STEP", "3"), ("WIDTH", "4")))
    assert first.ports == (
        Port("clk", 1, False, False), Port("value", 4, False, False), Port("sum", 4, False, True),
    )  # fmt: skip
    assert (top.name, top.instances) == ("two_adders", {"adder_0": "adder", "adder_1": "adder"})
    for number, step_by in enumerate(steps):
        head = f"adder #(\n    .STEP({step_by}),\n    .WIDTH(4)\n) adder_{number}_i (\n    .clk(clk),\n    .value("
        assert head in top.path.read_text()
    assert tuple(leaf.run_verilog([{"value": 5}] * 3)[-1].values()) == sums


@block
def hold(clk, value, held):
    @always(clk.posedge)
    def take():
        held.next = value

    return take


@block
def two_clocks(clk, awake, value, steady, resting):
    """A register on the free-running clock, and one on a gated clock."""
    resting_clk = bit()
    going_on = hold(clk, value, steady)
    at_rest = hold(clk, value, resting)
    gate = clock_gate(clk, awake, resting_clk)
    rests_on(resting_clk, at_rest)

    return going_on, at_rest, gate


def two_clocks_arguments():
    return {"clk": bit(), "awake": bit()} | {name: unsigned(4) for name in ("value", "steady", "resting")}


RESTING_BENCH = """`timescale 1ns / 1ns
module bench;
reg clk = 0, awake = 0;
wire [3:0] steady, resting;
reg [3:0] value;
integer cycle;
two_clocks dut (.clk(clk), .awake(awake), .value(value), .steady(steady), .resting(resting));
realtime rose;
always @(posedge dut.resting_clk) rose = $realtime;
always @(negedge dut.resting_clk)
    if ($realtime > 0 && $realtime - rose != 5) $display("a pulse of %0d ns", $realtime - rose);
// Awake in cycles 2, 3 and 5 of 8, changing just after an edge, as a register does.
initial begin
    for (cycle = 0; cycle < 8; cycle = cycle + 1) begin
        #1 value = cycle; awake = cycle == 2 || cycle == 3 || cycle == 5;
        #4 clk = 0;
        #5 clk = 1;
    end
    #1 $display("%0d %0d", steady, resting);
end
endmodule
"""


@pytest.mark.parametrize(
    ("options", "follows", "said"),
    [
        pytest.param((), "!clk", ["7 7"], id="goes-on"),
        pytest.param(("-DCLOCK_GATING",), "!clk", ["7 5"], id="rests"),
        pytest.param(("-DCLOCK_GATING",), "1'b1", ["a pulse of 4 ns", "a pulse of 1 ns"], id="cut"),
    ],
)
def test_a_clock_rests(tmp_path, options, follows, said):
    modules = converted(two_clocks(**two_clocks_arguments()), tmp_path)
    gate = modules["clock_gate"].path
    gate.write_text(gate.read_text().replace("if (!clk)", f"if ({follows})"))
    (tmp_path / "bench.v").write_text(RESTING_BENCH)
    files = [module.path.name for module in modules.values()]
    run_tool(tmp_path, "iverilog", "-g2005", *options, "-o", "bench", "bench.v", *files)
    lines = run_tool(tmp_path, "vvp", "-n", "bench").stdout.splitlines()
    assert set(said) <= set(lines), lines
    assert len(said) > 1 or lines == said


def test_a_clock_that_rests_goes_on_in_myhdl(tmp_path):
    leaf = Leaf(two_clocks, two_clocks_arguments, tmp_path)
    outputs = leaf.run_both([{"awake": value % 2, "value": value} for value in range(16)], settled=1)
    assert [cycle["resting"] for cycle in outputs[1:]] == [cycle["steady"] for cycle in outputs[1:]] == [*range(15)]


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
def word_table(clk, index, word, values, file):
    """A memory whose initial words come from a file; `values` has the same words."""
    words = [Signal(intbv(value)[8:]) for value in values]

    loading = load_words(words, file)

    @always(clk.posedge)
    def fetch():
        word.next = words[index]

    return loading, fetch


def test_a_memory_holds_a_files_words(tmp_path):
    file = tmp_path / "words.hex"
    file.write_text("7\nfa\n0\n63\n")
    words = {"values": [7, 250, 0, 99], "file": str(file)}
    leaf = Leaf(word_table, lambda: {"clk": bit(), "index": unsigned(2), "word": unsigned(8), **words}, tmp_path)
    outputs = leaf.run_both([{"index": index} for index in (3, 0, 1, 2, 0)], settled=1)
    assert [output["word"] for output in outputs[1:]] == [99, 7, 250, 0]
    text = leaf.verilog[-1].read_text()
    assert text.count(f'// Initial contents of the memory.\ninitial $readmemh("{file}", words);\n') == 1
