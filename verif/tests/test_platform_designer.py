# SPDX-License-Identifier: MIT
"""Run the Platform Designer component in a real Tcl with stand-in commands, and compare it with the Verilog."""

from __future__ import annotations

import json
import re
import subprocess
from itertools import pairwise
from pathlib import Path

import pytest
from conftest import ROOT
from tcl import run_tcl

from raycaster.configuration import Configuration, configure
from raycaster.convert.platform_designer import COMPONENT, NIOS_SYSTEM, READS_IN_FLIGHT, component, interfaces
from raycaster.convert.take_home import FILE_LIST, TOP
from raycaster.convert.write import write_verilog
from raycaster.fit.fixing import fix
from raycaster.hdl.hierarchy import Port
from raycaster.registers import register_map
from raycaster.tools import run_yosys

CONFIGURATIONS = [
    configure(screen="tiny", units=2, rectangles=2, allow_underrun=True),
    configure(screen="tiny", units=1, rectangles=32, colour_bits=4, fraction_bits=8, allow_underrun=True),
    configure(engine="beam", screen="tiny", rectangles=2, pixels=2),
    *(
        fix(
            ROOT / "scenes/boxes.toml", {"screen": "tiny", "units": 2, "allow_underrun": True}, scope
        ).design.configuration
        for scope in ("rects", "all")
    ),
]

COMMANDS = {
    "set_module_property": "property value",
    "set_module_assignment": "name {value {}}",
    "add_fileset": "name kind {callback {}} {display_name {}}",
    "set_fileset_property": "fileset property value",
    "add_fileset_file": "output_file file_type file_source path_or_contents {attributes {}}",
    "add_interface": "name type direction {associated_clock {}}",
    "set_interface_property": "interface property value",
    "add_interface_port": "interface port signal_type direction width",
}
"""Platform Designer commands that the component may use, with their arguments from its user guide."""

PATTERNS = {
    ("set_module_property", 0): "NAME|DISPLAY_NAME|DESCRIPTION|GROUP|VERSION|EDITABLE",
    ("set_module_assignment", 0): r"embeddedsw\.CMacro\.[A-Z][A-Z0-9_]*",
    ("set_module_assignment", 1): r'\d+|"[^"\\]*"',
    ("add_fileset", 1): "QUARTUS_SYNTH|SIM_VERILOG|SIM_VHDL|EXAMPLE_DESIGN",
    ("set_fileset_property", 1): "TOP_LEVEL",
    ("add_fileset_file", 1): "VERILOG",
    ("add_fileset_file", 2): "PATH|TEXT",
    ("add_interface", 0): r"[a-z]\w*",
    ("add_interface", 1): "clock|reset|avalon|interrupt|conduit",
    ("add_interface", 2): "end|start|sink|source|master|slave|sender|receiver",
    ("add_interface_port", 3): "Input|Output|Bidir",
    ("add_interface_port", 4): r"[1-9]\d*",
    ("create_system", 0): r"[a-z]\w*",
    ("set_project_property", 0): "DEVICE_FAMILY|DEVICE",
    ("add_connection", 0): r"\w+\.\w+",
    ("add_connection", 1): r"\w+\.\w+",
    ("set_connection_parameter_value", 0): r"\w+\.\w+/\w+\.\w+",
    ("set_connection_parameter_value", 1): "baseAddress|irqNumber",
    ("set_connection_parameter_value", 2): r"0x[0-9a-fA-F]{1,8}|\d+",
    ("save_system", 0): r"\w+\.qsys",
}
"""Pattern of each argument, by command and position."""

VALUES = {
    "NAME": r"[a-z]\w*",
    "VERSION": r"\d+(\.\d+)*",
    "EDITABLE": "true|false",
    "TOP_LEVEL": r"[a-z]\w*",
    "clockRate": r"\d+",
    "synchronousEdges": "NONE|DEASSERT|BOTH",
    "associatedClock": r"\w+",
    "associatedReset": r"\w+",
    "associatedAddressablePoint": r"\w+",
    "addressUnits": "WORDS|SYMBOLS",
    "bitsPerSymbol": r"[1-9]\d*",
    "maximumPendingReadTransactions": r"\d+",
    "readLatency": r"\d+",
    "isMemoryDevice": "true|false",
    "EXPORT_OF": r"\w+\.\w+",
    "clockFrequency": r"\d+",
    "resetSynchronousEdges": "NONE|DEASSERT|BOTH",
    "memorySize": r"\d+",
    "dataWidth": "8|16|32|64|128|256|512|1024",
    "direction": "Input|Output|InOut|Bidir",
    "width": r"[1-9]|[12]\d|3[0-2]",
}
"""Pattern of each value that is set, by property or parameter."""


def stand_ins(commands: dict[str, str]) -> str:
    """Return Tcl procedures that print each call as a line and, like the real ones, check the number of arguments."""
    return (
        "rename package real_package\n"
        "proc package {action exact name version} { record package $action $exact $name $version }\n"
        "proc record {args} { puts [join $args \\t] }\n"
    ) + "".join(f"proc {name} {{{taken}}} {{ record {{*}}[info level 0] }}\n" for name, taken in commands.items())


AVALON_ROLES = {
    "address", "read", "write", "writedata", "byteenable", "readdata", "readdatavalid", "waitrequest",
}  # fmt: skip
"""Signal roles of an agent with pipelined reads, from the Avalon Interface Specifications."""

Call = list[str]


def calls_of(done: subprocess.CompletedProcess[str]) -> list[Call]:
    """Return a script's calls in order, each a command and its arguments; assert that every argument is allowed."""
    assert (done.returncode, done.stderr) == (0, "")
    calls = [line.split("\t") for line in done.stdout.splitlines()]
    for command, *arguments in calls:
        for place, argument in enumerate(arguments):
            pattern = PATTERNS.get((command, place), r".*")
            assert re.fullmatch(pattern, argument), f"{command}: {argument} is not {pattern}"
        if command.startswith("set_") and command != "set_module_assignment" and arguments[-2] in VALUES:
            pattern = VALUES[arguments[-2]]
            assert re.fullmatch(pattern, arguments[-1]), f"{command}: {arguments[-2]} {arguments[-1]} is not {pattern}"
    return calls


def tcl(directory: Path) -> list[Call]:
    """Return the calls of the component in a directory."""
    return calls_of(run_tcl(directory, stand_ins(COMMANDS) + f"source {COMPONENT}\n"))


def declared_ports(calls: list[Call]) -> dict[str, tuple[str, int]]:
    """Return direction and width of each declared port; assert that none is declared twice."""
    found: dict[str, tuple[str, int]] = {}
    for command, *arguments in calls:
        if command == "add_interface_port":
            _, name, _, direction, width = arguments
            assert name not in found, f"{name} is declared twice"
            found[name] = direction.lower(), int(width)
    return found


def verilog_ports(directory: Path) -> dict[str, tuple[str, int]]:
    """Return direction and width of each port of the top, as Yosys reads the files of the file list."""
    sources = " ".join((directory / FILE_LIST).read_text().split())
    script = [f"read_verilog {sources}", f"hierarchy -check -top {TOP}", "proc", "write_json ports.json"]
    run_yosys(directory, "ports", script)
    ports = json.loads((directory / "ports.json").read_text())["modules"][TOP]["ports"]
    return {name: (port["direction"], len(port["bits"])) for name, port in ports.items()}


def check(directory: Path) -> None:
    assert declared_ports(tcl(directory)) == verilog_ports(directory)


@pytest.fixture(params=CONFIGURATIONS, ids=lambda config: config.name, scope="module")
def config(request) -> Configuration:
    return request.param


@pytest.fixture(scope="module")
def written(config, tmp_path_factory) -> Path:
    directory = tmp_path_factory.mktemp("component") / "verilog"
    write_verilog(config, directory)
    return directory


@pytest.mark.slow_sets("seed-tiny48-u1", "seed-tiny48-u2-r12", "seed-tiny48-u2-r9")
def test_ports_are_those_of_the_verilog(written):
    check(written)


@pytest.mark.slow_sets("seed-tiny48-u1")
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
    # Pixels at 25 MHz, with two clocks per pixel or two pixels per clock.
    assert properties["clock", "clockRate"] == ("50000000" if config.pixels == 1 else "12500000")
    assert properties["s0", "addressUnits"] == "WORDS"
    assert int(properties["s0", "maximumPendingReadTransactions"]) == READS_IN_FLIGHT
    roles = {call[2]: call[3] for call in calls if call[0] == "add_interface_port" and call[1] == "s0"}
    assert set(roles.values()) == AVALON_ROLES
    address_width = declared_ports(calls)["avs_s0_address"][1]
    last = max(register.address for register in register_map(config.table).values())
    assert 1 << address_width - 1 <= last < 1 << address_width


@pytest.mark.slow_sets("seed-tiny48-u1")
def test_files_are_those_of_the_file_list(written):
    calls = tcl(written)
    sources = (written / FILE_LIST).read_text().split()
    for fileset in ("QUARTUS_SYNTH", "SIM_VERILOG"):
        start = calls.index(["add_fileset", fileset.lower(), fileset, "", ""])
        assert calls[start + 1] == ["set_fileset_property", fileset.lower(), "TOP_LEVEL", TOP]
        listed = calls[start + 2 : start + 2 + len(sources)]
        assert listed == [["add_fileset_file", name, "VERILOG", "PATH", name] for name in sources]
    assert {call[1] for call in calls if call[0] == "add_fileset_file"} == set(sources)


@pytest.mark.slow_sets("seed-tiny48-u1", "seed-tiny48-u2-r", quick=["seed-tiny48-u2-r2"])
def test_software_gets_the_configuration(written, config):
    macros = {call[1].rpartition(".")[2]: call[2] for call in tcl(written) if call[0] == "set_module_assignment"}
    assert macros["RECTANGLES"] == str(config.rectangles)
    assert macros["ROUNDING"] == '"truncate"'
    assert macros["CULLING"] == str(int(config.culling))
    assert macros.get("FIXED") == (f'"{config.fixed.scope}"' if config.fixed else None)


@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ('ROUNDING {"truncate"}', "ROUNDING one two"),
        ('ROUNDING {"truncate"}', "ROUNDING truncate"),
        ("CULLING 1", "CULLING None"),
        ("EDITABLE false", "EDITABLE False"),
        ("synchronousEdges BOTH", "synchronousEdges Both"),
        ("add_interface irq interrupt end", "add_interface irq interrupt"),
        ("irq irq Output 1\n", "irq irq output 1\n"),
    ],
)
def test_an_argument_that_platform_designer_refuses_is_noticed(tmp_path, right, wrong):
    text = component(CONFIGURATIONS[0], [Port("irq", 1, False, True)], [f"{TOP}.v"])
    assert text.count(right) == 1
    (tmp_path / COMPONENT).write_text(text)
    tcl(tmp_path)
    (tmp_path / COMPONENT).write_text(text.replace(right, wrong))
    with pytest.raises(AssertionError):
        tcl(tmp_path)


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
    """Partition the text around a port's declaration, however it is padded."""
    squeezed = " ".join(declaration.split())
    for line in text.splitlines(keepends=True):
        if " ".join(line.split()) == squeezed:
            head, _, rest = text.partition(line)
            return head, line, rest
    return text, "", ""


def test_an_unknown_port_is_refused():
    with pytest.raises(ValueError, match="strange belongs to 0 interfaces"):
        component(CONFIGURATIONS[0], [Port("strange", 1, False, True)], [f"{TOP}.v"])


SYSTEM_COMMANDS = {
    "create_system": "{name {}}",
    "set_project_property": "property value",
    "add_instance": "name type {version {}}",
    "set_instance_parameter_value": "instance parameter value",
    "add_connection": "start {end {}}",
    "set_connection_parameter_value": "connection parameter value",
    "add_interface": "name type direction",
    "set_interface_property": "interface property value",
    "save_system": "{file {}}",
}
"""Platform Designer commands that a system's script may use, with their arguments."""

AGENT, HOST, CLOCK, RESET, SENDER, RECEIVER, CONDUIT = (
    "agent", "host", "clock", "reset", "interrupt sender", "interrupt receiver", "conduit",
)  # fmt: skip
ENDS = {
    "clock_source": {"clk": CLOCK, "clk_reset": RESET, "clk_in": "clock input", "clk_in_reset": "reset input"},
    "altera_nios2_gen2": {
        "clk": CLOCK, "reset": RESET, "instruction_master": HOST, "data_master": HOST, "debug_mem_slave": AGENT,
        "irq": RECEIVER,
    },
    "intel_niosv_m": {
        "clk": CLOCK, "reset": RESET, "instruction_manager": HOST, "data_manager": HOST, "dm_agent": AGENT,
        "timer_sw_agent": AGENT, "platform_irq_rx": RECEIVER,
    },
    "altera_avalon_onchip_memory2": {"clk1": CLOCK, "reset1": RESET, "s1": AGENT},
    "altera_avalon_pio": {"clk": CLOCK, "reset": RESET, "s1": AGENT, "external_connection": CONDUIT},
    "altera_avalon_jtag_uart": {"clk": CLOCK, "reset": RESET, "avalon_jtag_slave": AGENT, "irq": SENDER},
}  # fmt: skip
"""Interfaces of Intel's components, from their user guides."""

SPANS = {"memory.s1": 65536, "cpu.debug_mem_slave": 2048, "cpu.dm_agent": 65536, "cpu.timer_sw_agent": 64}
SPANS |= {"buttons.s1": 16, "serial.avalon_jtag_slave": 8}
"""Bytes that each agent occupies; the ray tracer's span follows from its registers."""


def own_ends(config: Configuration) -> dict[str, str]:
    """Return the ray tracer's interfaces by the names in its component."""
    kinds = {"clock": CLOCK, "reset": RESET, "avalon": AGENT, "interrupt": SENDER, "conduit": CONDUIT}
    return {interface.name: kinds[interface.kind.split()[0]] for interface in interfaces(config)}


def run_system(directory: Path, settings: str, script: str) -> subprocess.CompletedProcess[str]:
    (directory / NIOS_SYSTEM.name).write_text(script)
    return run_tcl(directory, stand_ins(SYSTEM_COMMANDS) + f"{settings}\nsource {NIOS_SYSTEM.name}\n")


def check_system(directory: Path, processor: str, script: str) -> None:
    """Check that every end exists and has a fitting connection, and that no two agents of a host share an address."""
    config = CONFIGURATIONS[0]
    calls = calls_of(run_system(directory, f"set processor {processor}\nset family {{MAX 10}}\nset device X", script))
    ends: dict[str, str] = {}
    for command, *arguments in calls:
        if command == "add_instance":
            name, kind = arguments
            ends |= {f"{name}.{end}": what for end, what in (own_ends(config) if kind == TOP else ENDS[kind]).items()}
    fits = {(CLOCK, CLOCK), (RESET, RESET), (HOST, AGENT), (RECEIVER, SENDER)}
    connections = [tuple(call[1:]) for call in calls if call[0] == "add_connection"]
    assert len(set(connections)) == len(connections)
    for source, sink in connections:
        assert (ends[source], ends[sink]) in fits, (source, sink)
    exported = {call[3] for call in calls if call[0] == "set_interface_property" and call[2] == "EXPORT_OF"}
    used = {end for pair in connections for end in pair} | exported
    assert used == set(ends), f"unconnected or unknown: {used ^ set(ends)}"
    last = max(register.address for register in register_map(config.rectangles).values())
    spans = SPANS | {"raycaster.s0": 4 << last.bit_length()}
    values = {(call[1], call[2]): call[3] for call in calls if call[0] == "set_connection_parameter_value"}
    ranges: dict[str, list[tuple[int, int]]] = {}
    for source, sink in connections:
        if ends[source] == HOST:
            base = int(values.pop((f"{source}/{sink}", "baseAddress")), 0)
            assert base % spans[sink] == 0
            ranges.setdefault(source, []).append((base, base + spans[sink]))
        elif ends[source] == RECEIVER:
            number = values.pop((f"{source}/{sink}", "irqNumber"))
            assert (number == "0") == (sink == "raycaster.irq")
    assert not values, "parameters of unknown connections"
    for taken in ranges.values():
        taken.sort()
        for (_, end), (start, _) in pairwise(taken):
            assert end <= start


@pytest.mark.parametrize("processor", ["nios2", "niosv"])
def test_a_nios_system_fits_together(tmp_path, processor):
    check_system(tmp_path, processor, NIOS_SYSTEM.read_text())


@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ("raycaster.s0 0x00040000", "raycaster.s0 0x00041000"),
        ("raycaster.clock raycaster.reset", "raycaster.clk raycaster.reset"),
        ("{raycaster.irq serial.irq}", "{serial.irq raycaster.irq}"),
        ("    vga conduit end raycaster.vga\n", ""),
        ("memory memorySize 65536", "memory memorySize {64 KiB}"),
        ("memory memorySize 65536", "memory memorySize 64 KiB"),
    ],
    ids=["overlap", "clock", "interrupt", "export", "value", "count"],
)
def test_a_nios_system_that_does_not_fit_is_noticed(tmp_path, right, wrong):
    script = NIOS_SYSTEM.read_text()
    assert script.count(right) == 1
    with pytest.raises((AssertionError, KeyError)):
        check_system(tmp_path, "nios2", script.replace(right, wrong))


@pytest.mark.parametrize(
    ("settings", "complaint"),
    [
        ("set processor nios2\nset family {MAX 10}", "device is not set; see the head of nios_system.tcl"),
        ("set processor arm\nset family x\nset device x", "processor: expected nios2 or niosv, got arm"),
    ],
)
def test_a_nios_system_says_what_it_needs(tmp_path, settings, complaint):
    done = run_system(tmp_path, settings, NIOS_SYSTEM.read_text())
    assert done.returncode
    assert done.stderr.startswith(f"{complaint}\n")
