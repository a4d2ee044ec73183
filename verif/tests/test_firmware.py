# SPDX-License-Identifier: MIT
"""Run the firmware built for the PicoRV32 in an emulator, with a model of the registers."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
import unicorn
from conftest import called
from host_software import CONFIG, FIRE, Registers, Session, compile_library

from raycaster.errors import UserError
from raycaster.memory_map import BUTTONS, MEMORY, MEMORY_BYTES, RAY_TRACER, UART, UART_BUSY, c_header
from raycaster.registers import register_map
from raycaster.sim.register_model import LiveScene
from raycaster.sw.firmware import FIRMWARE, SOURCES, Firmware, build_firmware, main
from raycaster.sw.play_script import DEMO, load
from raycaster.tools import ToolError

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

    def __init__(self, words: Path, script: tuple[int, ...], registers: Registers | None = None):
        self._script = script
        self._registers = registers or Registers(CONFIG)
        self._busy = 0
        self._block = -1
        self.said = ""
        self.frames: list[list[tuple[int, int]]] = []
        self.instructions = [0]
        self.uc = uc = unicorn.Uc(unicorn.UC_ARCH_RISCV, unicorn.UC_MODE_RISCV32)
        uc.mem_map(MEMORY, MEMORY_BYTES)
        memory = b"".join(int(line, 16).to_bytes(4, "little") for line in words.read_text().split())
        assert len(memory) == MEMORY_BYTES
        uc.mem_write(MEMORY, memory)
        uc.mmio_map(RAY_TRACER, PAGE, self._read_registers, None, self._write_registers, None)
        uc.mmio_map(BUTTONS, PAGE, self._read_rest, None, self._write_rest, None)
        uc.hook_add(unicorn.UC_HOOK_BLOCK, self._count)
        uc.hook_add(unicorn.UC_HOOK_MEM_READ | unicorn.UC_HOOK_MEM_WRITE, self._check_access)
        # Until the script or main ends.
        uc.emu_start(MEMORY, MEMORY_BYTES, count=20_000_000)

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
        self.said += chr(word)


def test_the_memory_map_for_c_is_up_to_date():
    assert (FIRMWARE / "system.h").read_text() == c_header(), "run make registers"


def test_the_demo_is_played_as_on_the_host(firmware, tmp_path):
    script = load(DEMO)[:430]
    machine = Machine(firmware.words, script)
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
    # A PicoRV32 takes about five cycles per instruction, and a frame is 420,000 cycles at 25 MHz.
    assert max(machine.instructions[1:]) < 420_000 / 5 / 2


def test_a_lost_game_is_reported(firmware):
    corner = 0b0101
    machine = Machine(firmware.words, (0, FIRE) + (corner,) * 700)
    assert re.search(r"^game over, score \d+\r$", machine.said, re.M)


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


@pytest.mark.parametrize(("frame", "reports"), [(0, 0), (3, 1)])
def test_an_underrun_is_reported(firmware, frame, reports):
    """Underruns before the start are not reported."""

    class Late(Registers):
        def start_screen(self) -> LiveScene:
            self.file.agent.underrun |= self.file.agent.frame == frame > 0
            return super().start_screen()

    registers = Late(CONFIG)
    registers.file.agent.underrun = frame == 0
    machine = Machine(firmware.words, (0,) * 9, registers)
    assert machine.said.count("ray tracer: a row was not complete in time\r\n") == reports
    assert not registers.file.agent.underrun


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


@pytest.mark.parametrize("missing", ["ziglang", "elftools"])
def test_a_missing_tool_is_one_line(tmp_path, monkeypatch, missing):
    monkeypatch.setattr("raycaster.sw.firmware.find_spec", lambda name: None if name == missing else name)
    with pytest.raises(UserError, match=rf"^{missing} is missing; it comes with the extra play: "):
        main(["--output", str(tmp_path / "output")])
    assert not any(tmp_path.iterdir())


def test_a_program_that_does_not_compile(firmware, tmp_path):
    start, program, *others = SOURCES
    broken = tmp_path / "broken.c"
    broken.write_text(program.read_text().replace("int main(void) {", "int main(void) { int unused;"))
    with pytest.raises(ToolError, match=r"the compiler failed:\n.*unused"):
        build_firmware(tmp_path / "output", (start, broken, *others))
    assert not (tmp_path / "output").exists()
