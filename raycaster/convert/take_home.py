# SPDX-License-Identifier: MIT
"""Write the files that let the Verilog build in other people's flows.

These are file lists, constraints, waivers, and a first test bench.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from fnmatch import fnmatch
from importlib.metadata import version
from pathlib import Path

from raycaster.buses import BUSES, OWN
from raycaster.configuration import Configuration
from raycaster.convert.platform_designer import COMPONENT, NIOS_SYSTEM, component
from raycaster.convert.register_views import HEADER, write_header
from raycaster.design.decide import OPTIONS
from raycaster.hdl.hierarchy import Module, prefixed
from raycaster.registers import address_bits, register_map
from raycaster.rtl.bus.avalon_interface import engine_word, size_word, version_word
from raycaster.serial_frames import LEAD, access, framed

TOP = "ray_caster_module"
PREFIX = "ray_caster_"
"""Prefix of module names in Verilog that is written for others; the top has it anyway."""

FILE_LIST = f"{TOP}.f"
SMOKE_BENCH = Path(__file__).with_name("smoke_bench.v")
BENCH_NS = 20
"""Period of its clock."""

BENCHES = "bench"
"""Folder for test benches, so that all Verilog files outside it are hardware."""

WAIVERS = Path(__file__).with_name("waivers.vlt")


def write_take_home(config: Configuration, prefix: str, modules: Sequence[Module], directory: Path) -> None:
    """Write the files that tools need next to the Verilog.

    Args:
        config: the generated design.
        prefix: prefix of the modules' names.
        modules: its modules, each after those that it instantiates; the top is the last.
        directory: directory of its files.
    """
    sources, top = [module.path.name for module in modules], modules[-1].name
    (directory / f"{top}.f").write_text("".join(f"{name}\n" for name in sources))
    (directory / f"{top}.qip").write_text(_quartus_list(config, top, sources))
    (directory / f"{top}.sdc").write_text(_constraints(config, top, prefixed("pixel_clock", prefix)))
    (directory / f"{top}.core").write_text(_core(config, top, sources))
    if config.bus == "avalon":
        (directory / COMPONENT).write_text(component(config, modules[-1].ports, sources))
        (directory / NIOS_SYSTEM.name).write_text(NIOS_SYSTEM.read_text().replace(TOP, top))
    write_header(config.table, directory / HEADER)
    (directory / f"{top}.vlt").write_text(waivers(sources, prefix))
    (directory / BENCHES).mkdir()
    (directory / BENCHES / SMOKE_BENCH.name).write_text(_bench(config, top))
    path = directory / f"{top}.v"
    path.write_text(path.read_text().replace(f"{config.name}\n", f"{config.name}\n{_description(config)}", 1))


def waivers(sources: Sequence[str], prefix: str = "") -> str:
    """Return Verilator's waivers for these files alone; a pattern of file names would also match a user's files.

    Args:
        sources: names of the design's files.
        prefix: prefix of most of them, which `WAIVERS` leaves out.
    """
    head, *paragraphs = WAIVERS.read_text().rstrip("\n").split("\n\n")
    for paragraph in paragraphs:
        lines = []
        for line in paragraph.splitlines():
            if not line.startswith("lint_off"):
                lines.append(line)
                continue
            before, pattern, after = re.split(r'-file "(.*?)"', line)
            own = (name for name in sources if fnmatch(name, pattern) or fnmatch(name, prefixed(pattern, prefix)))
            # A file's name may be given with or without a folder.
            lines += [f'{before}-file "{place}{name}"{after}' for name in own for place in ("", "*/")]
        if lines[-1].startswith("lint_off"):
            head += "\n\n" + "\n".join(lines)
    return head + "\n"


def _bench(config: Configuration, top: str) -> str:
    """Return the bench, whose parameters have the values of the design."""
    horizontal = config.screen_geometry.beats
    parameters = {
        "ADDRESS_BITS": address_bits(*config.map),
        "COLOUR_BITS": config.colour_bits * config.pixels,
        "H_TOTAL": horizontal.total,
        "H_SYNC": horizontal.sync,
        "HS_ACTIVE": int(horizontal.active_high),
        "SIZE": size_word(config),
    }
    if BUSES[config.bus].serial:
        registers = register_map(*config.map)
        known = [registers["id"].reset, version_word(config), engine_word(config), size_word(config)]
        asked = access(registers["id"].address, read=len(known))
        frames = {"ASKED": bytes([LEAD]) + framed(asked), "ANSWER": framed([*asked, *known])}
        parameters["BIT_NS"] = round(BENCH_NS * config.screen_geometry.clock_hz / config.baud)
        parameters |= {name: f"{8 * len(data)}'h{int.from_bytes(data, 'little'):x}" for name, data in frames.items()}
    text = SMOKE_BENCH.read_text().replace(TOP, top)
    for name, value in parameters.items():
        text = re.sub(rf"(parameter {name} =) 0(,?) *( //)", rf"\g<1> {value}\g<2> \g<3>", text)
    bus = f"BUS_{config.bus.upper()}"
    return text if config.bus == OWN else f"`define {bus}\n{text}`undef {bus}\n"


def _description(config: Configuration) -> str:
    """Return the configuration as comment lines, without options that do not apply to the design."""
    values = {name: getattr(config, name) for name in OPTIONS}
    values = {name: int(value) if isinstance(value, bool) else value for name, value in values.items()}
    if config.fixed:
        values["fixed"] = config.fixed.name
    if not config.facts.whole_frames:
        del values["scale"], values["pixels"]
    if not config.facts.whole_frames:
        del values["list"]
    pad = max(map(len, values))
    return "".join(f"//     {name:<{pad}}  {value}\n" for name, value in values.items())


def clock_period(config: Configuration) -> str:
    """Return the period of the clock, in ns."""
    return f"{1e9 / config.screen_geometry.clock_hz:.3f}"


def _quartus_list(config: Configuration, top: str, sources: Sequence[str]) -> str:
    """Return Quartus's list of files, relative to the list."""
    files = "".join(
        f'set_global_assignment -name VERILOG_FILE [file join $::quartus(qip_path) "{name}"]\n' for name in sources
    )
    return f"""# SPDX-License-Identifier: MIT
# {top}, {config.name}.
# {top}.sdc is not in this list, as it only applies if this module is the top of the design.
{files}"""


def _constraints(config: Configuration, top: str, pixel_clock: str) -> str:
    screen = config.screen_geometry
    divided = screen.clocks_per_pixel > 1
    made = f"divided by {screen.clocks_per_pixel}" if divided else "inverted"
    forwarded = "" if divided else f"# For a pin, replace the module {pixel_clock} by the chip's DDR output register.\n"
    relation = f"-divide_by {screen.clocks_per_pixel}" if divided else "-invert"
    return f"""# SPDX-License-Identifier: MIT
# {top}, {config.name}.
# There is one clock. The VGA outputs are registers that change at the falling edge of vga_clk, which is clk {made}, and
# are taken at its rising edge half a pixel later.
create_clock -name clk -period {clock_period(config)} [get_ports clk]
create_generated_clock -name vga_clk -source [get_ports clk] {relation} [get_ports vga_clk]
{forwarded}
# If the ports are pins, give the board's requirements here; inside a system, the other side's constraints apply.
# set_output_delay -clock vga_clk -max 2.0 [get_ports {{vga_r[*] vga_g[*] vga_b[*] vga_hs vga_vs vga_blank_n}}]
"""


def _core(config: Configuration, top: str, sources: Sequence[str]) -> str:
    """Return a FuseSoC core (CAPI2) that lints, simulates and synthesises the files in place."""
    files = "".join(f"      - {name}\n" for name in sources)
    return f"""CAPI=2:
# SPDX-License-Identifier: MIT
name: raycaster::{top}:{version("raycaster")}
description: RayCaster, a real-time ray tracer, as {config.name}

filesets:
  rtl:
    files:
{files}    file_type: verilogSource-2005
  constraints:
    files:
      - {top}.sdc: {{file_type: SDC}}
  waivers:
    files:
      - {top}.vlt: {{file_type: vlt}}
  bench:
    files:
      - {BENCHES}/{SMOKE_BENCH.name}: {{file_type: verilogSource-2005}}

targets:
  default: &default
    filesets: [rtl, constraints]
    toplevel: {top}
  lint:
    <<: *default
    description: Lint with Verilator's -Wall and the waivers
    filesets: [rtl, waivers]
    default_tool: verilator
    tools:
      verilator:
        mode: lint-only
        verilator_options: [-Wall]
  sim:
    description: Check that the bus answers and that lines have the right length
    filesets: [rtl, bench]
    toplevel: {SMOKE_BENCH.stem}
    default_tool: icarus
    tools:
      icarus:
        iverilog_options: [-g2005]
        vvp_options: [-N]
      verilator:
        mode: binary
        verilator_options: [--timing, -Wno-fatal, -CFLAGS, -fcoroutines]
  synth:
    <<: *default
    description: Synthesise with Yosys for an ECP5
    filesets: [rtl]
    default_tool: yosys
    tools:
      yosys:
        arch: ecp5
        output_format: json
"""
