# SPDX-License-Identifier: MIT
"""Netlists behave like the Verilog: a ray unit, a design in a frame, and multipliers with internal registers."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from collections import defaultdict
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest
from conftest import BUILD, ROOT, SMALL_SCENE, called, plant, refusal
from engine_vectors import check_ray_unit

from raycaster.design.decide import configure
from raycaster.fpga import multipliers
from raycaster.fpga.flows import FLOWS
from raycaster.fpga.multipliers import connect_register, register_products
from raycaster.fpga.netlist import write_netlist
from raycaster.output import emptied
from raycaster.rtl.seed.ray_unit import ray_unit
from raycaster.runs.tools import ToolError
from raycaster.scene import packaged_scenes
from raycaster.sim import netlist
from raycaster.sim import scenes as simulate
from raycaster.sim.netlist import (
    LIBRARIES,
    Netlist,
    NetlistError,
    as_verilog,
    cells_of,
    known_models,
    synthesise,
    with_their_cells,
)
from raycaster.sim.simulator import SIMULATORS, SimulationError, build_program, convert

LIGHT = "[light]\nposition = [60, 100, 300]\n"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("cells", "options", "light", "some"),
    [
        ("ecp5", "--units 4 --rectangles 3 --reflections 1", "", ("LUT4", "CCU2C", "MULT18X18D")),
        (
            "ice40", "--engine exact --rectangles 2 --units 4 --reflections 1 --light 1", LIGHT,
            ("SB_LUT4", "SB_MAC16", "SB_RAM40_4K"),
        ),
        (
            "ice40", "--engine span --rectangles 3 --reflections 1 --list 16384", "",
            ("SB_LUT4", "SB_MAC16", "SB_RAM40_4K", "SB_SPRAM256KA"),
        ),
        (
            "gowin", "--engine span --rectangles 3 --reflections 1", "",
            ("LUT4", "ALU", "DFFRE", "MULT18X18", "SDPX9B"),
        ),
        (
            "ecp5", "--engine span --rectangles 3 --reflections 1 --units 2", "",
            ("LUT4", "CCU2C", "MULT18X18D", "TRELLIS_DPR16X4", "DP16KD"),
        ),
    ],
    ids=["ecp5", "ice40", "single-port", "gowin", "units"],
)  # fmt: skip
def test_frame(tmp_path, cells, options, light, some):
    """The netlist that is placed draws every pixel: each engine, the exact one with a light, spans with two units.

    Nothing shades the floor but the post, so the wall is left out with a light, which needs most units.
    """
    scene, build = tmp_path / "small.toml", BUILD / "test" / f"netlist-{cells}-{'span' in options}"
    first, floor, wall, post = SMALL_SCENE.read_text().split("[[rect]]")
    scene.write_text("[[rect]]".join([first, floor, *([] if light else [wall]), post]) + light)
    ran = called("sim", "--gates", "--build", str(build), str(scene), "--cells", cells, *options.split(), cwd=ROOT)
    assert ran.returncode == 0, ran.stdout + ran.stderr
    # Results and netlists of an earlier version may be there, too.
    found = max(build.glob("gates*/small/result.json"), key=lambda path: path.stat().st_mtime)
    result = json.loads(found.read_text())
    assert (result["pixels"], result["wrong_vs_golden"]) == (128 * 96, 0)
    columns = [cell.rpartition("_")[2] for cell in some]  # headings have a line per part of a name
    for text in ("-tiny48-", "through the netlist", *columns):
        assert text in ran.stdout
    assert not (build / "sim").exists()
    newest = max(build.glob("model/*/netlist-*/made"), key=lambda mark: mark.stat().st_mtime).parent
    assert all(cells_of(newest / "ray_caster_module.json")[cell] > 0 for cell in some)
    longest = max(map(len, re.findall(r"\\(\S+)", (newest / "netlist.v").read_text())))
    assert longest <= 95, "Verilator's waveforms fail with longer names"


@pytest.mark.slow
@pytest.mark.parametrize("start", [1, 2])
@pytest.mark.parametrize(("cells", "engine"), [*((cells, "exact") for cells in LIBRARIES), ("ecp5", "span")])
def test_random_start(bench, tmp_path, cells, engine, start):
    """The flip-flops of a netlist start with random values, which have no effect after reset."""
    design = configure(engine=engine, screen="tiny", rectangles=3)
    models, placed = synthesise(convert(design, BUILD), BUILD / "test" / "netlists", family=cells).files
    text, found = re.subn(r"initial Q = \w+;", "", models.read_text())
    assert found
    random_models = tmp_path / "cells.v"
    random_models.write_text(text)
    bench("sim.frame_bench", design, "verilator", SMALL_SCENE, verilog=[random_models, placed],
          defines={"NETLIST": 1}, start=start)  # fmt: skip


def test_ray_unit(leaf_of, random, tmp_path):
    config = configure()
    leaf = leaf_of(ray_unit, config)
    made = synthesise(leaf.verilog, tmp_path / "netlist", top="ray_unit")
    assert made.cells["LUT4"] > 200
    assert made.cells["TRELLIS_FF"] > 100
    assert made.cells["MULT18X18D"] == 2
    leaf.verilog = made.files
    check_ray_unit(leaf, config, random, rays=100)


SMALL = """
module small (input clk, input [3:0] a, input [3:0] b, output reg [3:0] sum);
    always @(posedge clk) sum <= a + b;
endmodule
"""


def synthesise_small(text: str, directory: Path) -> Netlist:
    source = directory / "small.v"
    source.write_text(text)
    return synthesise([source], directory / "netlist", top="small")


@pytest.mark.slow
def test_synthesised_once(tmp_path):
    """Unchanged files are found, changed ones are not, and the same files give the same bytes elsewhere."""
    first = synthesise_small(SMALL, tmp_path)
    text = first.files[-1].read_bytes()
    assert first.fresh
    assert first.cells["TRELLIS_FF"] == 4
    assert not synthesise_small(SMALL, tmp_path).fresh
    changed = synthesise_small(SMALL.replace("a + b", "a - b"), tmp_path)
    assert changed.fresh
    assert changed.files[-1].read_bytes() != text
    again = synthesise_small(SMALL, emptied(tmp_path / "again"))
    assert again.fresh
    assert again.files[-1].read_bytes() == text


def test_cell_without_model(tmp_path):
    """An error is better than a netlist that no simulator can build."""
    library_cell = "EHXPLLL pll (.CLKI(clk), .CLKOP(sum[0]));"
    text = SMALL.replace("output reg [3:0] sum", "output [3:0] sum")
    text = re.sub(r"always.*;", library_cell + " assign sum[3:1] = 0;", text)
    for _ in range(2):
        with pytest.raises(NetlistError, match="has cells without a model: EHXPLLL"):
            synthesise_small(text, tmp_path)


def test_missing_yosys_gets_one_line(tmp_path, monkeypatch):
    monkeypatch.setattr(netlist, "find_spec", lambda name: None)
    error = refusal(tmp_path, "sim", "--gates", str(SMALL_SCENE))
    assert error.startswith("error: Yosys is missing; it comes with the extra formal: ")


def test_default_design():
    """By default one small design shows all plain scenes in time, each with its own number of reflections."""
    scenes = list(packaged_scenes(plain=True).values())
    runs = simulate.plan_runs(scenes, {}, simulate.GATES_OPTIONS)
    assert len(simulate.configurations(runs)) == 1
    assert runs[0].configuration.screen == "tiny"
    assert {run.reflections for run in runs} == {0, 1, 2}
    runs = simulate.plan_runs(scenes, {"units": "32", "reflections": "1"}, simulate.GATES_OPTIONS)
    assert {(run.configuration.units, run.reflections) for run in runs} == {(32, 1)}


# Models of cells, and the registers of the ECP5's multipliers ---------------------------------------------------------

HERE = Path(__file__).parent
CELLS, BENCH = HERE / "cells.v", HERE / "cells_bench.v"
"""Products and memories of all forms, and what compares their netlist with them."""

CYCLES = 100
"""Clock cycles of the bench in which it must know every output, at the least, if none differs."""

MODES = {
    "ecp5": {"DATA_WIDTH_A": "1 2 4 9 18 36", "DATA_WIDTH_B": "1 2 4 18 36", "RESETMODE": "ASYNC SYNC",
             "WRITEMODE_A": "NORMAL READBEFOREWRITE WRITETHROUGH", "REG_OUTPUT_CLK": "CLK0", "REG_INPUTA_CLK": "CLK0",
             "REG_INPUTB_CLK": "CLK0"},
    "gowin": {"BIT_WIDTH": "9 18 36", "BIT_WIDTH_0": "1 2 4 9 18 36", "WRITE_MODE": "0 1 2"},
    "ice40": {"READ_MODE": "0 1 2 3", "A_SIGNED": "0 1", "TOPOUTPUT_SELECT": "1 3"},
}  # fmt: skip
"""Values of parameters that the cells of each family's netlist must have, so that their models are tested with them."""

REGISTERED = 5
"""Products that only plain registers read: `plain`, `narrow`, `whole`, `negative`, `nine`."""


@pytest.fixture(scope="module")
def placed(tmp_path_factory) -> Callable[[str, Path], Path]:
    """Return a function that copies the netlist of `CELLS` to a place; without the change that a flow makes to it."""

    @cache
    def made(family: str) -> Path:
        directory = tmp_path_factory.mktemp(family)
        shutil.copy(CELLS, directory)
        return write_netlist(replace(FLOWS[family], after=None), [Path(CELLS.name)], "cells", 100, directory)

    return lambda family, directory: Path(shutil.copy(made(family), directory))


def values(netlist: Path) -> dict[str, set[str]]:
    """Return the values of each parameter of a netlist's cells, in decimal if it is a number."""
    found: dict[str, set[str]] = defaultdict(set)
    for cell in json.loads(netlist.read_text())["modules"]["cells"]["cells"].values():
        for name, value in cell["parameters"].items():
            found[name].add(str(int(value, 2)) if re.fullmatch("[01]+", value) else value.strip())
    return found


def unequal(files: Sequence[Path], directory: Path) -> int:
    """Return the number of output bits that differ between a netlist and its Verilog, in the first cycle with any."""
    wanted = directory / "wanted.v"
    wanted.write_text(CELLS.read_text().replace("module cells", "module wanted_cells"))
    command = build_program("cells", "cells_bench", [*files, wanted, BENCH], simulator="icarus", build=directory)
    said = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    found = re.search(r"^(\d+) bits differ; (\d+) cycles have no unknown bit$", said, re.MULTILINE)
    assert found, said
    bits, cycles = map(int, found.groups())
    assert bits or cycles > CYCLES
    return bits


@pytest.mark.slow_sets(quick=["ecp5"])
@pytest.mark.parametrize("family", LIBRARIES)
def test_cells(placed, tmp_path, family):
    """In all modes that Yosys uses, multipliers and block RAM do what the Verilog says."""
    netlist = placed(family, tmp_path)
    if (after := FLOWS[family].after) is not None:
        assert after(netlist) == REGISTERED
    found = values(netlist)
    for name, modes in MODES[family].items():
        assert found[name] >= set(modes.split()), name
    assert unequal(as_verilog(netlist, family), tmp_path) == 0


@pytest.mark.slow
@pytest.mark.parametrize(
    ("family", "right", "wrong"),
    [
        pytest.param(family, right, wrong, id=f"{family}-{name}")
        for family, name, right, wrong in (
            ("ecp5", "sign", "SIGNEDA & a[17]", "a[17]"),
            ("ecp5", "no-sign", "SIGNEDB & b[17]", "1'b0"),
            ("ecp5", "product-register", 'REG_OUTPUT_CLK == "NONE" ? product', 'REG_OUTPUT_CLK != "" ? product'),
            ("ecp5", "factor-a-register", 'REG_INPUTA_CLK == "NONE" ? given_a', 'REG_INPUTA_CLK != "" ? given_a'),
            ("ecp5", "factor-b-register", 'REG_INPUTB_CLK == "NONE" ? given_b', 'REG_INPUTB_CLK != "" ? given_b'),
            ("ecp5", "halves", "DATA_WIDTH_B == 36 ? from_b[17:0]", "DATA_WIDTH_B == 36 ? from_b[35:18]"),
            ("ecp5", "halves-written", ".data_a({to_b, to_a})", ".data_a({to_a, to_b})"),
            ("ecp5", "contents", "SLICES[20 * word +: 18]", "SLICES[18 * word +: 18]"),
            ("ecp5", "write-modes", 'WRITEMODE_A == "WRITETHROUGH" ? 1', 'WRITEMODE_A == "WRITETHROUGH" ? 2'),
            ("ecp5", "clock-enable", ".enable_b(CEB && ", ".enable_b("),
            ("ecp5", "byte-enables", "{{9{address[1]}}, {9{address[0]}}} <<", "{{9{address[0]}}, {9{address[1]}}} <<"),
            ("ecp5", "byte-place", "36: place = 0", "36: place = 9"),
            ("ecp5", "small-words", "address[2:0] / width", "address[1:0] / width"),
            ("ecp5", "reset-with-enable", "if (reset_b)", "if (reset_b && enable_b)"),
            ("ecp5", "no-change", "else if (enable_a && !(write_a && MODE_A == 0))", "else if (enable_a)"),
            ("ecp5", "old-word", "MODE_A == 1 ? changed_a", "MODE_A ? changed_a"),
            ("gowin", "sign", "b_signed & b[WIDTH-1]", "b[WIDTH-1]"),
            ("gowin", "contents", "INIT[BYTE * place", "INIT[8 * place"),
            ("gowin", "write-mode", "(9), .WIDTH_A(BIT_WIDTH), .MODE_A(WRITE_MODE)", "(9), .WIDTH_A(BIT_WIDTH)"),
            ("gowin", "selection", "select_b === SELECT_B", "select_b !== SELECT_B"),
        )
    ],
)
def test_a_faulty_model_is_noticed(placed, tmp_path, family, right, wrong):
    netlist = placed(family, tmp_path)
    register_products(netlist)
    files = as_verilog(netlist, family)
    plant(files[0], right, wrong)
    assert unequal(files, tmp_path) > 0


@pytest.mark.slow_sets(quick=["enable"])
@pytest.mark.parametrize(
    ("name", "value"),
    [
        pytest.param("_is_plain", lambda cell: cell["connections"]["LSR"] == ["0"], id="enable"),
        pytest.param("_is_plain", lambda cell: cell["parameters"]["CEMUX"].strip() == "1", id="reset"),
        pytest.param("connect_register", lambda multiplier, clock, place="OUTPUT": None, id="no-register"),
    ],
)
def test_a_faulty_rewrite_is_noticed(placed, tmp_path, monkeypatch, name, value):
    """A register moves into its multiplier only if that changes no output."""
    netlist = placed("ecp5", tmp_path)
    monkeypatch.setattr(multipliers, name, value)
    assert register_products(netlist) >= REGISTERED
    assert unequal(as_verilog(netlist, "ecp5"), tmp_path) > 0


@pytest.mark.slow
def test_a_register_for_all_products_is_noticed(placed, tmp_path):
    """A product that is also read without a register, or by several, would arrive a cycle late."""
    netlist = placed("ecp5", tmp_path)
    design = json.loads(netlist.read_text())
    module = design["modules"]["cells"]
    for cell in module["cells"].values():
        if cell["type"] == "MULT18X18D":
            connect_register(cell, *module["ports"]["clk"]["bits"])
    netlist.write_text(json.dumps(design))
    assert unequal(as_verilog(netlist, "ecp5"), tmp_path) > 0


@pytest.mark.slow
def test_a_collision_is_noticed(tmp_path):
    """With an option by which Yosys lets a read word be undefined while it is written, outputs are unknown."""
    shutil.copy(CELLS, tmp_path)
    careless = replace(FLOWS["ecp5"], synthesis="synth_ecp5 -no-rw-check", after=None)
    netlist = write_netlist(careless, [Path(CELLS.name)], "cells", 100, tmp_path)
    assert unequal(as_verilog(netlist, "ecp5"), tmp_path) > 0


@pytest.mark.parametrize("simulator", SIMULATORS)
@pytest.mark.parametrize(
    ("cell", "mode"),
    [
        ("MULT18X18D", '.REG_OUTPUT_CLK("CLK1")'),
        ("MULT18X18D", '.REG_PIPELINE_CLK("CLK0")'),
        ("DP16KD", '.REGMODE_B("OUTREG")'),
        ("DP16KD", ".DATA_WIDTH_A(8)"),
        ("MULT18X18", ".OUT_REG(1'b1)"),
        ("SDPX9B", ".READ_MODE(1'b1)"),
    ],
)
def test_an_unmodelled_mode_is_refused(tmp_path, simulator, cell, mode):
    """No simulation is built with a cell in a mode that its model does not have."""
    [(macros, models)] = [known for known in map(known_models, LIBRARIES) if cell in known[1]]
    source = tmp_path / "top.v"
    text = "".join(models[name] for name in with_their_cells([cell], models))
    source.write_text(f"{macros}{text}module top; {cell} #({mode}) cell_i (); endmodule\n")
    with pytest.raises(SimulationError) as error:
        build_program("refused", "top", [source], simulator=simulator, build=tmp_path, flags=("-Wno-PINMISSING",))
    log = Path(str(error.value).rpartition(" ")[2]).read_text()
    assert "unmodelled_parameter" in log


def test_an_unknown_parameter_is_refused(placed, tmp_path):
    netlist = placed("ecp5", tmp_path)
    netlist.write_text(netlist.read_text().replace('"REGMODE_A"', '"REGMODE_C"'))
    with pytest.raises(ToolError, match="REGMODE_C"):
        as_verilog(netlist, "ecp5")
