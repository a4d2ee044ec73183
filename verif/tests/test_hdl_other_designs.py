# SPDX-License-Identifier: MIT
"""MyHDL's own examples convert to modules that do what MyHDL's flat Verilog does, or are refused in one line.

They come with the source distribution of the pinned MyHDL; nothing of it is kept here.
"""

import importlib.metadata
import runpy
import subprocess
import sys
import tarfile
from collections.abc import Callable
from functools import cache
from pathlib import Path

import pytest
from myhdl import ResetSignal, block

from raycaster.hdl.elaboration import elaboration
from raycaster.hdl.errors import UserError
from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import bit, unsigned

CYCLES = 200


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


def words(**widths: int) -> dict[str, Callable]:
    return {name: (lambda width=width: unsigned(width)) if width > 1 else bit for name, width in widths.items()}


GRAY = {**words(graycnt=8, enable=1, clock=1), "reset": reset, "width": lambda: 8}
DESIGNS = {
    "manual/bin2gray.py": ("bin2gray", words(B=8, G=8)),
    "manual/inc.py": ("inc", {**words(count=8, enable=1, clock=1), "reset": reset}),
    "manual/gray_inc.py": ("gray_inc", GRAY),
    "manual/gray_inc_reg.py": ("gray_inc_reg", GRAY),
    "manual/mux.py": ("mux", words(z=8, a=8, b=8, sel=1)),
    "manual/ram.py": ("ram", {**words(dout=8, din=8, addr=7, we=1, clk=1), "depth": lambda: 128}),
    "manual/rom.py": ("rom", {**words(dout=8, addr=2), "CONTENT": lambda: (17, 134, 52, 9)}),
    "cookbook/dff/dff.py": ("dff", words(q=1, d=1, clk=1)),
    "cookbook/dffa/dffa.py": ("dffa", words(q=1, d=1, clk=1, rst=1)),
    "cookbook/latch/latch.py": ("latch", words(q=1, d=1, g=1)),
    "cookbook/johnson/jc2.py": ("jc2", words(goLeft=1, goRight=1, stop=1, clk=1, q=4)),
    "cookbook/stopwatch/TimeCount.py": ("TimeCount", words(tens=4, ones=4, tenths=4, startstop=1, reset=1, clock=1)),
    "cookbook/stopwatch/bcd2led.py": ("bcd2led", words(led=7, bcd=4, clock=1)),
    "cookbook/bitonic/bitonic.py": ("Array8Sorter", words(**{f"{kind}{n}": 4 for kind in "az" for n in range(8)})),
}
REFUSED = {"cookbook/bitonic/bitonic.py": "List of signals as a port is not supported"}
"""Beginnings of the reasons for which a design is refused, by its file."""

UNKNOWN = {"cookbook/johnson/jc2.py"}
"""Designs without a reset, whose Verilog stays unknown, as MyHDL's own does by default."""


@cache
def block_of(path: Path, name: str) -> Callable:
    sys.path.insert(0, str(path.parent))
    try:
        function = runpy.run_path(str(path))[name]
    finally:
        sys.path.remove(str(path.parent))
    # Older examples lack the decorator.
    return function if hasattr(function, "func") else block(function)


@pytest.mark.parametrize("file", DESIGNS)
def test_an_example_converts_as_myhdl_does(file, examples, tmp_path, random, monkeypatch):
    monkeypatch.chdir(tmp_path)  # some examples convert themselves when they are imported
    name, makers = DESIGNS[file]
    function = block_of(examples / file, name)

    def arguments() -> dict:
        return {port: make() for port, make in makers.items()}

    if file in REFUSED:
        with pytest.raises(UserError, match=rf"^\S+\.py:\d+: {REFUSED[file]}"):
            Leaf(function, arguments, tmp_path)
        return
    leaf = Leaf(function, arguments, tmp_path)
    stimulus = []
    for cycle in range(CYCLES):
        inputs = {port: int(random.integers(1 << shape.width)) for port, shape in leaf.inputs.items()}
        inputs |= {port: int(cycle > 2) for port in inputs if port in ("reset", "rst")}
        inputs |= {port: inputs[port] % 10 for port in inputs if port == "bcd"}
        clocks = [port for port in inputs if port == "clock"]
        stimulus += [inputs | dict.fromkeys(clocks, phase) for phase in (0, 1)]
    modules = leaf.run_verilog(stimulus)
    flat = tmp_path / "flat"
    flat.mkdir()
    with elaboration():
        function(**arguments()).convert(hdl="Verilog", path=str(flat), initial_values=False)
    leaf.verilog = [flat / f"{name}.v"]
    assert leaf.run_verilog(stimulus) == modules
    for seen, expected in zip(modules, leaf.run_myhdl(stimulus), strict=True):
        assert all(value in (None, expected[port]) for port, value in seen.items())
    assert any(None not in cycle.values() for cycle in modules) == (file not in UNKNOWN)
