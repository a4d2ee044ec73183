# SPDX-License-Identifier: MIT
"""Given Verilog, clocks that rest, and memories that are loaded stand in a design."""

import subprocess
from pathlib import Path

import pytest
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


def adder_of(source: Path, outputs: tuple[str, ...] = ("sum",)):
    @given_verilog(lambda: source, outputs)
    @block
    def adder(clk, value, sum, STEP, WIDTH):
        return ()

    return adder


@block
def two_adders(clk, value, first, second, doubled, adder):
    """Chain two instances of given Verilog and read the first sum in a process."""
    one = adder(clk, value, first, STEP=3, WIDTH=4)
    two = adder(clk, first, second, STEP=3, WIDTH=4)

    # A process reads an output of given Verilog.
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
    assert list(modules) == ["adder", "two_adders"], "two instances with equal parameters share a module"
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
    nibbles = {name: unsigned(4) for name in ("value", "steady", "resting")}
    return {"clk": bit(), "awake": bit(), **nibbles}


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
    if ($realtime > 0 && $realtime - rose != 5)
        $display("a pulse of %0d ns", $realtime - rose);
// Awake in cycles 2, 3 and 5 of 8, changing just after an edge, as a register does.
initial begin
    for (cycle = 0; cycle < 8; cycle = cycle + 1) begin
        #1 value = cycle;
        awake = cycle == 2 || cycle == 3 || cycle == 5;
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
    modules = converted(two_clocks(**two_clocks_arguments()), tmp_path / "verilog")
    gate = modules["clock_gate"].path
    gate.write_text(gate.read_text().replace("if (!clk)", f"if ({follows})"))
    (tmp_path / "bench.v").write_text(RESTING_BENCH)
    files = [str(module.path) for module in modules.values()]
    compiled = str(tmp_path / "bench")
    subprocess.run(["iverilog", "-g2005", *options, "-o", compiled, str(tmp_path / "bench.v"), *files], check=True)
    done = subprocess.run(["vvp", "-n", compiled], capture_output=True, text=True, check=True)
    lines = done.stdout.splitlines()
    assert set(said) <= set(lines), lines
    assert len(said) > 1 or lines == said


def test_a_clock_that_rests_goes_on_in_myhdl(tmp_path):
    leaf = Leaf(two_clocks, two_clocks_arguments, tmp_path)
    stimulus = [{"awake": value % 2, "value": value} for value in range(16)]
    outputs = leaf.run_both(stimulus, settled=1)
    assert [cycle["resting"] for cycle in outputs[1:]] == [cycle["steady"] for cycle in outputs[1:]] == [*range(15)]


@block
def adders(clk, value, first, second, one_adder, other_adder, steps):
    one = one_adder(clk, value, first, STEP=steps[0], WIDTH=4)
    two = other_adder(clk, value, second, STEP=steps[1], WIDTH=4)

    return one, two


def adders_of(one_adder, other_adder, steps=(3, 4)):
    return adders(bit(), unsigned(4), unsigned(4), unsigned(4), one_adder, other_adder, steps)


def test_given_verilog_takes_two_sets_of_parameters(tmp_path):
    source = tmp_path / "given.v"
    source.write_text(ADDER)
    adder = adder_of(source)
    modules = converted(adders_of(adder, adder), tmp_path / "verilog")
    assert list(modules) == ["adder", "adders"]
    text = modules["adders"].path.read_text()
    for number, step_by in enumerate((3, 4)):
        assert f"adder #(\n    .STEP({step_by}),\n    .WIDTH(4)\n) adder_{number}_i (" in text


def test_given_verilog_keeps_its_name(tmp_path):
    source = tmp_path / "given.v"
    source.write_text(ADDER)

    @block
    def adder(clk, value, sum, STEP, WIDTH):
        @always(clk.posedge)
        def work():
            sum.next = value

        return (work,)

    given = adder_of(source)
    modules = converted(adders_of(given, adder), tmp_path / "verilog")
    assert modules["adders"].instances == {"adder_0": "adder", "adder_1": "adder_1"}
    assert modules["adder"].path.read_text() == ADDER
    for others in ((adder, given), (given, adder_of(source))):
        with pytest.raises(UserError, match="adder is the name of given Verilog, which stays, and of"):
            converted(adders_of(*others), tmp_path / "verilog")


def test_a_top_does_not_take_the_name_of_given_verilog(tmp_path):
    source = tmp_path / "given.v"
    source.write_text(ADDER)
    given = adder_of(source)

    @block
    def adder(clk, value, sum):
        inner = given(clk, value, sum, STEP=1, WIDTH=4)
        return (inner,)

    with pytest.raises(UserError, match="adder is the name of given Verilog, which stays"):
        converted(adder(bit(), unsigned(4), unsigned(4)), tmp_path / "verilog")


def test_given_verilog_has_its_module(tmp_path):
    source = tmp_path / "given.v"
    source.write_text(ADDER.replace("module adder", "module adders"))
    with pytest.raises(UserError, match=r"given\.v has no module adder"):
        converted(two_adders_of(adder_of(source)), tmp_path / "verilog")


def test_an_output_of_given_verilog_must_be_an_argument(tmp_path):
    adder = adder_of(tmp_path / "given.v", ("sum", "carry"))
    with pytest.raises(UserError, match=r"adder: carry is listed as an output, but no argument"):
        converted(two_adders_of(adder), tmp_path / "verilog")


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
    assert text.count(f'// Initial contents of the memory.\ninitial $readmemh("{file}", words);\n') == 1
