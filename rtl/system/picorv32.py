# SPDX-License-Identifier: MIT
"""PicoRV32, a RISC-V processor by Claire Xenia Wolf, from its own Verilog file (ISC licence, in that file)."""

import importlib.util
from pathlib import Path

from myhdl import block

from raycaster.errors import UserError, not_installed
from raycaster.hdl.given import given_verilog

PACKAGE = "pythondata_cpu_picorv32"


def picorv32_source() -> Path:
    """Return the path of the Verilog file in the package that contains it.

    Raises:
        UserError: the package is not installed.
    """
    package = importlib.util.find_spec(PACKAGE)
    if package is None or package.origin is None:
        raise UserError(not_installed("PicoRV32", "play"))
    return Path(package.origin).parent / "verilog" / "picorv32.v"


@given_verilog(picorv32_source, outputs=("mem_valid", "mem_addr", "mem_wdata", "mem_wstrb"))
@block
def picorv32(
    clk, resetn, mem_valid, mem_ready, mem_addr, mem_wdata, mem_wstrb, mem_rdata, pcpi_wr, pcpi_rd, pcpi_wait,
    pcpi_ready, irq, ENABLE_COUNTERS64: int, BARREL_SHIFTER: int, ENABLE_FAST_MUL: int, ENABLE_DIV: int,
):  # fmt: skip
    """Run RV32I with the extensions that the parameters enable; all other parameters keep their defaults.

    After reset the program starts at address 0, and must set the stack pointer itself. An illegal instruction or a
    misaligned access halts the processor until reset.

    Args:
        resetn: reset, synchronous, active low.
        mem_valid: flag; output, valid of `ProcessorBus`.
        mem_ready: flag; ready of `ProcessorBus`.
        mem_addr: unsigned, 32 bits; output, address of `ProcessorBus`.
        mem_wdata: unsigned, 32 bits; output, data of `ProcessorBus`.
        mem_wstrb: unsigned, 4 bits; output, strobe of `ProcessorBus`.
        mem_rdata: unsigned, 32 bits; word of `ProcessorBus`.
        pcpi_wr: 0, as there is no coprocessor.
        pcpi_rd: 0, 32 bits, as there is no coprocessor.
        pcpi_wait: 0, as there is no coprocessor.
        pcpi_ready: 0, as there is no coprocessor.
        irq: 32 bits; not enabled.
        ENABLE_COUNTERS64: 1 for counters of 64 bits.
        BARREL_SHIFTER: 1 for a barrel shifter.
        ENABLE_FAST_MUL: 1 for a multiplier that takes one cycle.
        ENABLE_DIV: 1 for division.
    """
    return ()
