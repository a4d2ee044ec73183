# SPDX-License-Identifier: MIT
"""The Platform Designer component, run by a real Tcl against stand-ins of its commands, held against the Verilog."""

from __future__ import annotations

import json
import shutil
import subprocess
from pathlib import Path

import pytest

from raycaster.configuration import Configuration, configure
from raycaster.registers import register_map
from raycaster.rtl.convert import write_verilog
from raycaster.rtl.hierarchy import Port
from raycaster.rtl.platform_designer import COMPONENT, READS_IN_FLIGHT, component
from raycaster.rtl.take_home import FILE_LIST, TOP
from raycaster.tools import run_yosys

CONFIGURATIONS = [
    configure(screen="tiny", units=2, rectangles=2, allow_underrun=True),
    configure(screen="tiny", units=1, rectangles=32, colour_bits=4, fraction_bits=8, allow_underrun=True),
]

COMMANDS = (
    "set_module_property", "set_module_assignment", "add_fileset", "set_fileset_property", "add_fileset_file",
    "add_interface", "set_interface_property", "add_interface_port",
)  # fmt: skip
"""Those of Platform Designer that the component may use; Tcl refuses any other."""

STAND_INS = (
    "rename package real_package\n"
    "proc package {action args} { record package $action {*}$args }\n"
    "proc record {args} { puts [join $args \\t] }\n"
    + "".join(f"proc {name} {{args}} {{ record {name} {{*}}$args }}\n" for name in COMMANDS)
)

AVALON_ROLES = {
    "address", "read", "write", "writedata", "byteenable", "readdata", "readdatavalid", "waitrequest",
}  # fmt: skip
"""Those of an agent with pipelined reads, from the Avalon Interface Specifications."""

Call = list[str]


def tcl(directory: Path) -> list[Call]:
    """What the component in a directory calls, in order: the command and its arguments."""
    if not shutil.which("tclsh"):
        pytest.skip("no tclsh here: Debian's package tcl")
    (directory / "stand_ins.tcl").write_text(STAND_INS)
    (directory / "main.tcl").write_text(f"source stand_ins.tcl\nsource {COMPONENT}\n")
    done = subprocess.run(["tclsh", "main.tcl"], cwd=directory, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    return [line.split("\t") for line in done.stdout.splitlines()]


def declared_ports(calls: list[Call]) -> dict[str, tuple[str, int]]:
    """Direction and width of each declared port; none is declared twice."""
    found: dict[str, tuple[str, int]] = {}
    for command, *arguments in calls:
        if command == "add_interface_port":
            _, name, _, direction, width = arguments
            assert name not in found, f"{name} is declared twice"
            found[name] = direction.lower(), int(width)
    return found


def verilog_ports(directory: Path) -> dict[str, tuple[str, int]]:
    """Direction and width of each port of the top, as Yosys reads the files of the file list."""
    sources = " ".join((directory / FILE_LIST).read_text().split())
    script = [f"read_verilog {sources}", f"hierarchy -check -top {TOP}", "proc", "write_json ports.json"]
    run_yosys(directory, "ports", script)
    ports = json.loads((directory / "ports.json").read_text())["modules"][TOP]["ports"]
    return {name: (port["direction"], len(port["bits"])) for name, port in ports.items()}


def check(directory: Path) -> None:
    assert declared_ports(tcl(directory)) == verilog_ports(directory)


@pytest.fixture(params=CONFIGURATIONS, ids=lambda config: config.name)
def config(request) -> Configuration:
    return request.param


@pytest.fixture
def written(config, tmp_path) -> Path:
    write_verilog(config, tmp_path / "verilog")
    return tmp_path / "verilog"


def test_ports_are_those_of_the_verilog(written):
    check(written)


def test_interfaces(written, config):
    calls = tcl(written)
    kinds = {call[1]: call[2:] for call in calls if call[0] == "add_interface"}
    assert kinds == {
        "clock": ["clock", "end"],
        "reset": ["reset", "end"],
        "s0": ["avalon", "end"],
        "irq": ["interrupt", "end"],
        "vga": ["conduit", "end"],
    }
    properties = {(call[1], call[2]): call[3] for call in calls if call[0] == "set_interface_property"}
    for (name, what), value in properties.items():
        if what.startswith("associated"):
            assert list(kinds).index(value) < list(kinds).index(name), f"{name} refers to {value}, which comes later"
    assert properties["clock", "clockRate"] == "50000000"
    assert properties["s0", "addressUnits"] == "WORDS"
    assert int(properties["s0", "maximumPendingReadTransactions"]) == READS_IN_FLIGHT
    roles = {call[2]: call[3] for call in calls if call[0] == "add_interface_port" and call[1] == "s0"}
    assert set(roles.values()) == AVALON_ROLES
    address_width = declared_ports(calls)["avs_s0_address"][1]
    last = max(register.address for register in register_map(config.rectangles).values())
    assert 1 << address_width - 1 <= last < 1 << address_width


def test_files_are_those_of_the_file_list(written):
    calls = tcl(written)
    sources = (written / FILE_LIST).read_text().split()
    for fileset in ("QUARTUS_SYNTH", "SIM_VERILOG"):
        start = calls.index(["add_fileset", fileset.lower(), fileset, "", ""])
        assert calls[start + 1] == ["set_fileset_property", fileset.lower(), "TOP_LEVEL", TOP]
        listed = calls[start + 2 : start + 2 + len(sources)]
        assert listed == [["add_fileset_file", name, "VERILOG", "PATH", name] for name in sources]
    assert {call[1] for call in calls if call[0] == "add_fileset_file"} == set(sources)


def test_software_gets_the_configuration(written, config):
    macros = {call[1].rpartition(".")[2]: call[2] for call in tcl(written) if call[0] == "set_module_assignment"}
    assert macros["RECTANGLES"] == str(config.rectangles)
    assert macros["ROUNDING"] == '"truncate"'


@pytest.mark.parametrize(
    ("file", "right", "wrong"),
    [
        (COMPONENT, "add_interface_port irq irq irq Output 1\n", ""),
        (COMPONENT, "avs_s0_readdata readdata Output 32", "avs_s0_readdata readdata Output 31"),
        (COMPONENT, "avs_s0_write write Input", "avs_s0_write write Output"),
        (f"{TOP}.v", "output wire       vga_sync_n,", "output wire       vga_sync,"),
        (f"{TOP}.v", "input  wire [3:0] avs_s0_byteenable,", "input  wire [7:0] avs_s0_byteenable,"),
    ],
)
def test_a_broken_port_is_noticed(tmp_path, file, right, wrong):
    directory = tmp_path / "verilog"
    write_verilog(CONFIGURATIONS[0], directory)
    text = (directory / file).read_text()
    head, found, rest = text.partition(right) if file == COMPONENT else _partition_port(text, right)
    assert found
    (directory / file).write_text(head + wrong + rest)
    with pytest.raises(AssertionError):
        check(directory)


def _partition_port(text: str, declaration: str) -> tuple[str, str, str]:
    """Around a port's declaration, however it is padded."""
    squeezed = " ".join(declaration.split())
    for line in text.splitlines(keepends=True):
        if " ".join(line.split()) == squeezed:
            head, _, rest = text.partition(line)
            return head, line, rest
    return text, "", ""


def test_an_unknown_port_is_refused():
    with pytest.raises(ValueError, match="strange belongs to 0 interfaces"):
        component(CONFIGURATIONS[0], [Port("strange", 1, False, True)], [f"{TOP}.v"])
