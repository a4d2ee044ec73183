# SPDX-License-Identifier: MIT
"""MyHDL's own examples convert to modules that do what MyHDL's flat Verilog does, or are refused in one line.

They come with the source distribution of the pinned MyHDL; nothing of it is kept here.
"""

import importlib.metadata
import inspect
import re
import runpy
import subprocess
import sys
import tarfile
from collections.abc import Callable
from functools import cache, partial
from pathlib import Path
from types import SimpleNamespace

import pytest
from myhdl import BlockError, ResetSignal, Signal, block

from raycaster.docs.hdl import PAGE
from raycaster.hdl.elaboration import elaboration
from raycaster.hdl.errors import UserError
from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import bit, signed, unsigned


@pytest.fixture(scope="module")
def examples(tmp_path_factory) -> Path:
    """Download the examples."""
    directory = tmp_path_factory.mktemp("myhdl")
    package = f"myhdl=={importlib.metadata.version('myhdl')}"
    command = [sys.executable, "-m", "pip", "download", "--no-deps", "--no-build-isolation", "--no-binary", ":all:"]
    done = subprocess.run([*command, package], cwd=directory, capture_output=True, text=True, check=False)
    if done.returncode:
        pytest.skip(f"no source of {package}: {done.stderr[-200:]}")
    [archive] = directory.glob("*.tar.gz")
    # Python 3.11.4 brought the filter, which 3.14 has by default.
    with tarfile.open(archive) as source:
        source.extractall(directory, **({"filter": "data"} if hasattr(tarfile, "data_filter") else {}))
    return next(directory.glob("*/example"))


def reset() -> ResetSignal:
    return ResetSignal(0, active=0, isasync=True)


def words(ports: str) -> dict[str, Callable]:
    """Return a maker for each port, such as `clk`, or `count:8`, or `angle:-18`, which is signed."""
    found = {}
    for name, _, width in (port.partition(":") for port in ports.split()):
        kind = signed if width.startswith("-") else unsigned
        found[name] = partial(kind, abs(int(width))) if width else bit
    return found


STATE = {"state": None}
"""A signal for the first state of an example's own enumeration."""

GRAY = {**words("graycnt:8 enable clock"), "reset": reset, "width": lambda: 8}
SETTINGS = partial(SimpleNamespace, baud_rate=9600, n_bits=8, parity=None, n_stops=1)
DESIGNS = {
    "manual/bin2gray.py": ("bin2gray", words("B:8 G:8")),
    "manual/inc.py": ("inc", {**words("count:8 enable clock"), "reset": reset}),
    "manual/gray_inc.py": ("gray_inc", GRAY),
    "manual/gray_inc_reg.py": ("gray_inc_reg", GRAY),
    "manual/mux.py": ("mux", words("z:8 a:8 b:8 sel")),
    "manual/ram.py": ("ram", {**words("dout:8 din:8 addr:7 we clk"), "depth": lambda: 128}),
    "manual/rom.py": ("rom", {**words("dout:8 addr:2"), "CONTENT": lambda: (17, 134, 52, 9)}),
    "cookbook/dff/dff.py": ("dff", words("q d clk")),
    "cookbook/dffa/dffa.py": ("dffa", words("q d clk rst")),
    "cookbook/latch/latch.py": ("latch", words("q d g")),
    "cookbook/johnson/jc2.py": ("jc2", words("goLeft goRight stop clk q:4")),
    "cookbook/stopwatch/TimeCount.py": ("TimeCount", words("tens:4 ones:4 tenths:4 startstop reset clock")),
    "cookbook/stopwatch/bcd2led.py": ("bcd2led", words("led:7 bcd:4 clock")),
    "cookbook/stopwatch/StopWatch.py": ("StopWatch", words("tens_led:7 ones_led:7 tenths_led:7 startstop reset clock")),
    "cookbook/johnson/jc2_alt.py": ("jc2_alt", words("goLeft goRight stop clk q:4")),
    "cookbook/sinecomp/SineComputer.py": ("SineComputer", words("cos_z0:-18 sin_z0:-18 done z0:-18 start clock reset")),
    "manual/bin2gray2.py": ("bin2gray", {**words("B:8 G:8"), "width": lambda: 8}),
    "manual/bin2gray_wrong.py": ("bin2gray", words("B:8 G")),
    "manual/mux2.py": ("Mux", words("z:8 a:8 b:8 sel")),
    "manual/shadow.py": ("arbiter", words("grant_vector:8 request_vector:8")),
    "manual/custom.py": ("inc_comb", {**words("nextCount:8 count:8"), "n": lambda: 256}),
    "manual/fsm.py": ("framer_ctrl", {**words("sof"), **STATE, **words("sync_flag clk"), "reset_n": reset}),
    "manual/fsm2.py": ("FramerCtrl", FRAMER := {**words("SOF"), **STATE, **words("syncFlag clk reset_n")}),
    "manual/fsm3.py": ("FramerCtrl", FRAMER),
    "uart_tx/uart_tx.py": ("uart_tx", UART := words("tx_bit tx_valid tx_byte:8 tx_clk tx_rst")),
    "uart_tx/uart_tx.py:2": ("uart_tx_2", {**UART, "tx_rst": reset}),
    "rs232/rs232_tx.py": ("rs232_tx", {**words("tx data:8"), "cfg": SETTINGS}),
    "rs232/rs232_rx.py": ("rs232_rx", {**words("rx actual:8"), "cfg": SETTINGS}),
    "arith_lib/Dec.py": ("Dec", ARITHMETIC := {"width": lambda: 8, "speed": lambda: 0, **words("A:8 Z:8")}),
    "arith_lib/LeadZeroDet.py": ("LeadZeroDet", ARITHMETIC),
    "arith_lib/PrefixAnd.py": ("PrefixAnd", {"width": lambda: 8, "speed": lambda: 0, **words("PI:8 PO:8")}),
    "cookbook/bitonic/bitonic.py": ("Array8Sorter", words(" ".join(f"{kind}{n}:4" for kind in "az" for n in range(8)))),
}
OUTCOMES = {
    file: outcome
    for outcome, files in re.findall(r"^\| (equal|refused: .*?) \| (.*) \|$", PAGE.read_text(), re.M)
    for file in re.findall("`(.*?)`", files)
}
"""Outcome of each example, by its file, from the manual's table: equal or refused."""


def test_the_manual_has_each_example():
    assert {*OUTCOMES} == {file.partition(":")[0] for file in DESIGNS}


@cache
def loaded(path: Path) -> dict:
    """Run a file, and make blocks of its functions and of those that it imports: older examples lack the decorator."""
    sys.path.insert(0, str(path.parent))
    try:
        names = runpy.run_path(str(path))
    finally:
        sys.path.remove(str(path.parent))
    for function in [one for one in names.values() if inspect.isfunction(one)]:
        for name, value in [*function.__globals__.items()]:
            if inspect.isfunction(value) and re.search(r"^    @(always|instance)", inspect.getsource(value), re.M):
                function.__globals__[name] = block(value)
    return names


@pytest.mark.slow_sets(quick=["cookbook/bitonic", "cookbook/stopwatch/bcd2led", "manual", "rs232", "uart_tx"])
@pytest.mark.parametrize("file", DESIGNS)
def test_an_example_converts_as_myhdl_does(file, examples, tmp_path, random, monkeypatch):
    monkeypatch.chdir(tmp_path)  # some examples convert themselves when they are imported
    name, makers = DESIGNS[file]
    path, _, _ = file.partition(":")
    outcome, names = OUTCOMES[path], loaded(examples / path)
    function = names[name] if hasattr(names[name], "func") else block(names[name])

    def arguments() -> dict:
        states = names.get("t_state") or names.get("t_State")
        return {port: make() if make else Signal(states.SEARCH) for port, make in makers.items()}

    if outcome.startswith("refused: "):
        reason = re.escape(outcome.removeprefix("refused: "))
        with pytest.raises((UserError, BlockError), match=rf"^(\S+\.py:\d+: )?{reason}"):
            Leaf(function, arguments, tmp_path)
        return
    leaf = Leaf(function, arguments, tmp_path)
    stimulus = []
    for cycle in range(200):
        inputs = {port: int(random.integers(1 << shape.width)) for port, shape in leaf.inputs.items()}
        active = name in ("StopWatch", "TimeCount", "SineComputer")
        inputs |= {port: int((cycle > 2) != active) for port in inputs if port in ("reset", "rst", "reset_n", "tx_rst")}
        inputs |= {port: inputs[port] % 10 for port in inputs if port == "bcd"}
        inputs |= {port: max(inputs[port], 1) for port in inputs if port == "A"}  # a decrement below 0 is out of range
        clocks = [port for port in inputs if port in ("clock", "tx_clk")]
        stimulus += [inputs | dict.fromkeys(clocks, phase) for phase in (0, 1)]
    modules = leaf.run_verilog(stimulus)
    flat = tmp_path / "flat"
    flat.mkdir()
    with elaboration():
        function(**arguments()).convert(hdl="Verilog", path=str(flat), initial_values=True)
    leaf.verilog = [flat / f"{name}.v"]
    # MyHDL gives outputs no initial values.
    for seen, ours in zip(leaf.run_verilog(stimulus), modules, strict=True):
        assert all(value in (None, ours[port]) for port, value in seen.items())
    # In Verilog, where signals begin unknown, the start is an edge of this design's reset, but not in MyHDL.
    start = name == "uart_tx"
    for seen, expected in zip(modules[start:], leaf.run_myhdl(stimulus)[start:], strict=True):
        assert all(value in (None, expected[port]) for port, value in seen.items())
    assert any(None not in cycle.values() for cycle in modules)
