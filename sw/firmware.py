# SPDX-License-Identifier: MIT
"""`python -m raycaster.sw.firmware`: build the game for a PicoRV32, as an ELF file and as words for `$readmemh`."""

from __future__ import annotations

import argparse
import struct
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

from raycaster.design.options import run_command
from raycaster.errors import UserError, not_installed
from raycaster.memory_map import MEMORY, MEMORY_BYTES
from raycaster.output import Console, Table, printable, replaced
from raycaster.runs.tools import ToolError, run_program

SOFTWARE = Path(__file__).parent
FIRMWARE = SOFTWARE / "firmware"
START, DRIVER = FIRMWARE / "start.S", SOFTWARE / "raycaster.c"
"""Sources of every program."""

SOURCES = (START, FIRMWARE / "main.c", SOFTWARE / "game" / "game.c", DRIVER)

COMPILER = ("-m", "ziglang", "cc", "-target", "riscv32-freestanding-none", "-mcpu=generic_rv32+m")
"""Python's arguments to run clang for RV32IM, without compressed instructions and without a C library."""

STRICT = ("-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror")
TIMEOUT = 300


@dataclass(frozen=True)
class Firmware:
    """The files of a built program."""

    elf: Path
    """The program with debug information."""

    words: Path
    """The whole RAM, one 32-bit word per line, in hexadecimal."""

    sections: dict[str, int]
    """Bytes of each section that takes up RAM."""


def build_firmware(output: Path, sources: Sequence[Path] = SOURCES, headers: Sequence[Path] = ()) -> Firmware:
    """Compile and link the game, or another program for the same memory.

    Args:
        output: the output directory, replaced as a whole.
        sources: the program's sources, with the start-up code and the driver.
        headers: directories with more headers.

    Raises:
        UserError: the compiler is missing, or rejected the sources.
    """
    for module in ("ziglang", "elftools"):
        if find_spec(module) is None:
            raise UserError(not_installed(module, "play"))
    with replaced(output) as work, tempfile.TemporaryDirectory(prefix="raycaster-") as scratch:
        script = Path(scratch) / "link.ld"
        _compile("-E", "-P", "-x", "c", FIRMWARE / "link.ld", "-o", script)
        _compile(
            *STRICT, "-Os", "-g", "-ffunction-sections", f"-I{SOFTWARE}", f"-I{FIRMWARE}",
            *(f"-I{path}" for path in headers), f"-Wl,-T,{script}", "-Wl,--gc-sections", *sources,
            "-o", work / "firmware.elf",
        )  # fmt: skip
        memory, sections = _read_elf(work / "firmware.elf")
        lines = (f"{word:08x}\n" for (word,) in struct.iter_unpack("<I", memory))
        (work / "firmware.hex").write_text("".join(lines))
    return Firmware(output / "firmware.elf", output / "firmware.hex", sections)


def _compile(*arguments: str | Path) -> None:
    done = run_program([sys.executable, *COMPILER, *map(str, arguments)], SOFTWARE, TIMEOUT)
    if done.returncode:
        raise ToolError(f"the compiler failed:\n{done.stderr.strip()}")


def _read_elf(path: Path) -> tuple[bytes, dict[str, int]]:
    """Read the RAM's initial contents, and the sizes of the sections in it."""
    # Only this command needs it.
    from elftools.elf.constants import SH_FLAGS  # noqa: PLC0415
    from elftools.elf.elffile import ELFFile  # noqa: PLC0415

    memory = bytearray(MEMORY_BYTES)
    with path.open("rb") as file:
        elf = ELFFile(file)
        for segment in elf.iter_segments("PT_LOAD"):
            start = segment["p_paddr"] - MEMORY
            memory[start : start + segment["p_filesz"]] = segment.data()
        sections = [section for section in elf.iter_sections() if section["sh_flags"] & SH_FLAGS.SHF_ALLOC]
        sizes = {section.name: section["sh_size"] for section in sections}
        return bytes(memory), sizes | {"initial values of .data": sizes[".data"]}


def show(sections: dict[str, int], console: Console) -> None:
    """Print the RAM usage."""
    table = Table("section", "bytes", "share", title=f"{MEMORY_BYTES:,} bytes of RAM")
    rest = MEMORY_BYTES - sum(sections.values())
    for name, size in (*sections.items(), ("left for the stack", rest)):
        table.add_row(name, size, f"{size / MEMORY_BYTES:.1%}")
    console.print(table)


def main(argv: Sequence[str] | None = None) -> None:
    """Run the command.

    Args:
        argv: its arguments (default: those of the process).
    """
    parser = argparse.ArgumentParser(prog="python -m raycaster.sw.firmware", description=__doc__)
    parser.add_argument(
        "--output", type=Path, default=Path("build/firmware"), help="output directory (default: %(default)s)"
    )
    arguments = parser.parse_args(argv)
    console = Console()
    # The compiler runs in another directory.
    built = build_firmware(arguments.output.absolute())
    show(built.sections, console)
    print(printable(f"{arguments.output / built.elf.name} and {arguments.output / built.words.name}"))


if __name__ == "__main__":
    run_command(main)
