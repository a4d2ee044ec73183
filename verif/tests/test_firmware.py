# SPDX-License-Identifier: MIT
"""Run the firmware built for the PicoRV32 in an emulator, with a model of the registers."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
import unicorn
from conftest import called, faulty
from elftools.elf.elffile import ELFFile
from host_software import CONFIG, CORNER, FIRE, Registers, Session, compile_library
from unicorn import riscv_const

from raycaster.memory_map import BUTTONS, MEMORY, MEMORY_BYTES, RAY_TRACER, UART, UART_BUSY, c_header
from raycaster.registers import register_map
from raycaster.runs.tools import ToolError
from raycaster.sim.register_model import LiveScene
from raycaster.sw.firmware import FIRMWARE, SOURCES, START, Firmware, build_firmware, main
from raycaster.sw.play_script import DEMO, load

MAP = register_map(CONFIG.rectangles)
PAGE = 0x1000


@pytest.fixture(scope="module")
def firmware(tmp_path_factory) -> Firmware:
    return build_firmware(tmp_path_factory.mktemp("firmware") / "firmware")


class Machine:
    """Emulated system: memory from the image, the ray tracer's registers, buttons, and a UART busy after each byte.

    Attributes:
        said: text sent over the UART.
        frames: for each frame, from reading the buttons on, the words written to the ray tracer.
        instructions: number of instructions before the first frame, and in each frame with its wait for the next.
    """

    def __init__(self, words: Path, script: tuple[int, ...] = (), registers: Registers | None = None):
        self.uc = uc = unicorn.Uc(unicorn.UC_ARCH_RISCV, unicorn.UC_MODE_RISCV32)
        uc.mem_map(MEMORY, MEMORY_BYTES)
        memory = b"".join(int(line, 16).to_bytes(4, "little") for line in words.read_text().split())
        assert len(memory) == MEMORY_BYTES
        uc.mem_write(MEMORY, memory)
        uc.mmio_map(RAY_TRACER, PAGE, self._read_registers, None, self._write_registers, None)
        uc.mmio_map(BUTTONS, PAGE, self._read_rest, None, self._write_rest, None)
        uc.hook_add(unicorn.UC_HOOK_BLOCK, self._count)
        uc.hook_add(unicorn.UC_HOOK_MEM_READ | unicorn.UC_HOOK_MEM_WRITE, self._check_access)
        self.run(script, registers)

    def run(self, script: tuple[int, ...], registers: Registers | None = None) -> None:
        """Reset everything except the memory, and run until the script or main ends."""
        self._script = script
        self._registers = registers or Registers(CONFIG)
        self._busy = 0
        self._block = -1
        self.said = ""
        self.frames: list[list[tuple[int, int]]] = []
        self.instructions = [0]
        self.uc.emu_start(MEMORY, MEMORY_BYTES, count=20_000_000)

    def spoil(self, start: int) -> None:
        """Fill the memory from an address on, and the processor's registers, with garbage."""
        self.uc.mem_write(start, b"\xa5" * (MEMORY + MEMORY_BYTES - start))
        for register in range(riscv_const.UC_RISCV_REG_X1, riscv_const.UC_RISCV_REG_X31 + 1):
            self.uc.reg_write(register, 0x5A5A5A5A)

    def _count(self, uc, address, size, _) -> None:
        self.instructions[-1] += size // 4
        # The program ends in a jump to itself.
        if size == 4 and address == self._block:
            self.uc.emu_stop()
        self._block = address

    def _check_access(self, uc, access, address, size, value, _) -> None:
        # A PicoRV32 traps on unaligned accesses.
        assert address % size == 0

    def _read_registers(self, uc, offset, size, _) -> int:
        assert size == 4
        if offset == 4 * MAP["irq_pending"].address:
            self._registers.polls_to_frame = self._registers.polls_to_frame or 3
        return self._registers.read(offset)

    def _write_registers(self, uc, offset, size, word, _) -> None:
        assert size == 4
        self._registers.write(offset, word)

    def _read_rest(self, uc, offset, size, _) -> int:
        assert size == 4
        address = BUTTONS + offset
        if address == BUTTONS:
            if len(self.frames) == len(self._script):
                self.uc.emu_stop()
                return 0
            self._registers.written = []
            self.frames.append(self._registers.written)
            self.instructions.append(0)
            return self._script[len(self.frames) - 1]
        assert address == UART
        self._busy = max(self._busy - 1, 0)
        return UART_BUSY if self._busy else 0

    def _write_rest(self, uc, offset, size, word, _) -> None:
        assert (size, BUTTONS + offset) == (4, UART)
        assert not self._busy
        self._busy = 3
        self.said += chr(word & 0xFF)


def test_the_memory_map_for_c_is_up_to_date():
    assert (FIRMWARE / "system.h").read_text() == c_header(), "run make registers"


def test_the_demo_is_played_as_on_the_host(firmware, tmp_path):
    script, registers = load(DEMO)[:430], Registers(CONFIG)
    # A PicoRV32 polls every 25 cycles, and a frame is 420,000 cycles at 25 MHz.
    registers.polls_to_frame = 420_000 // 25
    machine = Machine(firmware.words, script, registers)
    assert (registers.file.live.run, registers.file.live.reflections) == (True, 1)
    version = MAP["version"].fields
    assert machine.said.splitlines() == [
        f"RayCaster {version['major'].reset}.{version['minor'].reset}, engine exact, units {CONFIG.units}, "
        "rectangles 12, rows 48, reflections 1, scale 1, fixed 0",
        "start",
        "level 2",
    ]
    assert len(machine.frames) == len(script)
    host = Session(compile_library(tmp_path, "raycaster.c", "game/game.c"))
    for number, (expected, written) in enumerate(zip(host.play(script), machine.frames, strict=True)):
        # The last three writes commit the picture, clear the errors, and acknowledge the next frame.
        assert written[:-3] == expected.written, f"frame {number}"
        assert written[-2][0] == 4 * MAP["status"].address
    # A PicoRV32 takes about five cycles per instruction.
    assert max(machine.instructions[1:]) < 420_000 / 5 / 2


def test_a_lost_game_is_reported(firmware):
    machine = Machine(firmware.words, (0, FIRE) + (CORNER,) * 700)
    assert re.search(r"^game over, score \d+\r$", machine.said, re.M)


VARIABLES = """
#include <stdint.h>

#include "system.h"

static volatile uint32_t letters[] = {'o', 'j'}, count, last;

int main(void) {
    volatile uint32_t *const uart = (volatile uint32_t *)SYSTEM_UART_BASE;
    for (; count < 2; count++) {
        while (*uart != 0) {
        }
        *uart = letters[count] + count + last;
        letters[count] = '!';
    }
    last = 1;
    return 0;
}
"""
"""Program that sends `ok` if its variables start with their initial values and with 0, and changes all of them."""


def after_reset(built: Firmware, before: tuple[int, ...] = (), script: tuple[int, ...] = ()) -> tuple[str, list]:
    """Return what a program says, and its frames, after a reset in the middle that leaves garbage in its variables."""
    machine = Machine(built.words, before)
    with built.elf.open("rb") as file:
        machine.spoil(ELFFile(file).get_section_by_name(".data")["sh_addr"])
    machine.run(script)
    return machine.said, machine.frames


def test_a_reset_starts_anew(firmware):
    """A game that is reset in the middle of another one is the same game as after power-up."""
    script = load(DEMO)[:120]
    fresh = Machine(firmware.words, script)
    assert "start" in fresh.said and len(fresh.frames) == len(script)
    assert after_reset(firmware, (0, FIRE) + (CORNER,) * 90, script) == (fresh.said, fresh.frames)


@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ("", ""),
        ("la t0, bss_start", "la t0, bss_end"),
        ("la t1, bss_end", "la t1, bss_start + 4"),
        ("sw zero, 0(t0)", "sw t0, 0(t0)"),
        ("la t0, data_start", "la t0, data_end"),
        ("la t1, data_end", "la t1, data_start + 4"),
        ("la t2, data_initial", "la t2, data_start"),
    ],
)
def test_variables_start_with_their_values(tmp_path, right, wrong):
    """At power-up and after a reset; a fault in the start-up code shows at the latest after the reset."""
    start, program = tmp_path / START.name, tmp_path / "variables.c"
    start.write_text(faulty(START.read_text(), right, wrong) if right else START.read_text())
    program.write_text(VARIABLES)
    built = build_firmware(tmp_path / "built", (start, program))
    assert built.sections[".data"] == built.sections["initial values of .data"] == 8
    said = [Machine(built.words).said, after_reset(built)[0]]
    assert (said == ["ok", "ok"]) == (right == wrong), said


@pytest.mark.parametrize(
    ("register", "fields", "complaint"),
    [
        ("id", {"magic": 0}, "no game: no ray tracer at this address"),
        ("engine", {"fixed": 2}, "no game: built into the hardware"),
        ("size", {"rectangles": 11}, "ray tracer: the rectangle's index is beyond the table"),
    ],
)
def test_errors_are_reported_once(firmware, register, fields, complaint):
    machine = Machine(firmware.words, (0,) * 5, Registers(CONFIG, **{register: fields}))
    assert machine.said.count(complaint) == 1
    assert machine.said.endswith(f"{complaint}\r\n")


def test_an_underrun_is_reported(firmware):
    """Underruns before the start are not reported, and those of successive frames are reported once."""

    class Late(Registers):
        def start_screen(self) -> LiveScene:
            self.file.agent.underrun |= self.file.agent.frame in (3, 4, 7)
            return super().start_screen()

    registers = Late(CONFIG)
    registers.file.agent.underrun = True
    machine = Machine(firmware.words, (0,) * 9, registers)
    assert machine.said.count("ray tracer: a row was not complete in time\r\n") == 2
    assert not registers.file.agent.underrun


def test_a_late_frame_delays_the_picture(firmware):
    """While a commit is not live yet, the game goes on, but neither draws nor commits, and there is no error."""

    class Late(Registers):
        def read(self, offset: int) -> int:
            commit = offset == 4 * MAP["control"].address and self.file.agent.frame % 2 == 0
            return super().read(offset) | MAP["control"].pack(commit=int(commit))

    machine = Machine(firmware.words, (0,) * 8, Late(CONFIG))
    acknowledge = 4 * MAP["irq_pending"].address
    late = [[offset for offset, _ in written] == [acknowledge] for written in machine.frames]
    assert late == [False, True] * 4
    assert "ray tracer:" not in machine.said


def test_the_image_is_the_program(firmware):
    """The image begins with the linked program, without compressed instructions, and is 0 after it."""
    words = firmware.words.read_text().split()
    assert len(words) == MEMORY_BYTES // 4
    program = firmware.sections[".text"] // 4
    assert all(int(word, 16) & 3 == 3 for word in words[:program])
    used = sum(firmware.sections.values())
    assert set(words[-(-used // 4) :]) == {"00000000"}
    assert firmware.elf.read_bytes()[:4] == b"\x7fELF"


def test_the_command(firmware, tmp_path):
    done = called("--output", "here", cwd=tmp_path, program=main)
    assert (done.returncode, done.stderr) == (0, "")
    assert "32,768 bytes of RAM" in done.stdout
    assert {path.name for path in (tmp_path / "here").glob("[!.]*")} == {"firmware.elf", "firmware.hex"}
    assert (tmp_path / "here" / "firmware.hex").read_bytes() == firmware.words.read_bytes()


@pytest.mark.parametrize(
    ("variable", "complaint"),
    [
        ("int unused;", "unused"),
        *((f"static volatile char full[{size}]; full[0] = 0;", "the stack needs 2048") for size in (24_000, 40_000)),
    ],
)
def test_a_program_that_does_not_compile(tmp_path, variable, complaint):
    start, program, *others = SOURCES
    broken = tmp_path / "broken.c"
    broken.write_text(faulty(program.read_text(), "int main(void) {", f"int main(void) {{ {variable}"))
    with pytest.raises(ToolError, match=rf"the compiler failed:\n.*{complaint}"):
        build_firmware(tmp_path / "output", (start, broken, *others))
    assert not (tmp_path / "output").exists()
