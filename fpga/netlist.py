# SPDX-License-Identifier: MIT
"""Make the netlist that nextpnr places: the commands of Yosys, and the changes that follow."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from pathlib import Path

from raycaster.fpga.flows import Flow
from raycaster.runs.tools import run_yosys

DECIDES = ("fpga/flows.py", "fpga/multipliers.py", "fpga/netlist.py")
"""Sources that decide a netlist, besides the Verilog."""


def write_netlist(flow: Flow, sources: Sequence[Path], top: str, multipliers: int, work: Path) -> Path:
    """Synthesise a design as for a bitstream; a simulation of the result therefore covers what is placed.

    Args:
        flow: the chip's flow.
        sources: Verilog files, relative to the working directory.
        top: top module.
        multipliers: number of the chip's multipliers; excess products become logic.
        work: working directory.

    Returns:
        The JSON netlist, named after the top, in the working directory.

    Raises:
        ToolError: Yosys is missing, or did not accept the files.
    """
    made = work / f"{top}.json"
    synthesis = f"{flow.synthesis} -top {top}"
    script = [*(f"read_verilog {source}" for source in sources), f"{synthesis} -run :coarse"]
    script += [*flow.before, "proc", "flatten", "opt_expr", "opt_clean", "wreduce"]
    script.append("rename -enumerate -pattern product_% t:$mul")
    run_yosys(work, "products", [*script, "write_rtlil products.il"])
    spared = left_to_logic((work / "products.il").read_text(), multipliers, flow.factor_bits)
    # Yosys's mapping gives this type to products that become logic.
    script += [f"chtype -set $__soft_mul c:{name}" for name in spared]
    run_yosys(work, "synthesis", [*script, f"{synthesis} -run coarse: -json {made.name}"])
    if flow.after is not None:
        flow.after(made)
    return made


def left_to_logic(netlist: str, most: int, factor_bits: int) -> list[str]:
    """List the smallest products, as many as exceed the chip's multipliers.

    By default, Yosys uses hard multipliers for all products, and nextpnr then cannot place some of them.

    Args:
        netlist: RTLIL, before multipliers are mapped; products have public names.
        most: number of the chip's multipliers.
        factor_bits: width of their factors.
    """
    products = []
    for cell in re.finditer(r"^  cell \$mul \\(\S+)\n((?:    .*\n)*)", netlist, re.MULTILINE):
        widths = [int(width) for width in re.findall(r"parameter \\[AB]_WIDTH (\d+)", cell[2])]
        products.append((math.prod(widths), cell[1], math.prod(-(-width // factor_bits) for width in widths)))
    products.sort()
    wanted = sum(taken for *_, taken in products)
    spared = []
    while wanted > most:
        _, name, taken = products[len(spared)]
        spared.append(name)
        wanted -= taken
    return spared
