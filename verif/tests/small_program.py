# SPDX-License-Identifier: MIT
"""A small program for the processor, assembled here: it shows a scene, moves the camera by buttons, and prints text."""

from __future__ import annotations

from pathlib import Path

from raycaster.configuration import Configuration
from raycaster.memory_map import BUTTONS, INTERRUPT_BIT, MEMORY_WORDS, RAY_TRACER, UART
from raycaster.program import scene_words
from raycaster.registers import register_map
from raycaster.scene import Scene, load_scene

REGISTERS = {f"x{number}": number for number in range(32)}
_I, _LOAD, _STORE, _BRANCH, _R = 0x13, 0x03, 0x23, 0x63, 0x33
_IMMEDIATE = {"addi": 0, "andi": 7, "slli": 1, "srli": 5}
_ARITHMETIC = {"add": (0, 0), "sub": (0x20, 0), "or": (0, 6), "mul": (1, 0), "divu": (1, 5)}
_LOADS, _STORES = {"lw": 2}, {"sw": 2, "sb": 0}
_BRANCHES = {"beq": 0, "bne": 1}

Line = tuple[str | int, ...]


def assemble(lines: list[Line]) -> list[int]:
    """Assemble RV32IM instructions, one per line, from address 0 on.

    `("label", name)` and `("word", value)` make no instruction; `("li", x, value)` makes two. Memory accesses are
    (name, value, offset, address); branches and `("jal", x, label)` name a label, which `li` may take for a value.
    """
    places: dict[str, int] = {}
    address = 0
    for name, *operands in lines:
        if name == "label":
            places[str(operands[0])] = address
        else:
            address += 8 if name == "li" else 4
    words: list[int] = []
    for name, *operands in lines:
        if name == "label":
            continue
        values = [
            REGISTERS[operand] if operand in REGISTERS else places[operand] if isinstance(operand, str) else operand
            for operand in operands
        ]
        words += _encode(str(name), values, 4 * len(words))
    return words


def _encode(name: str, values: list[int], here: int) -> list[int]:
    if name == "word":
        return values
    if name == "li":
        target, value = values
        low = (value + 0x800 & 0xFFF) - 0x800
        high = value - low & 0xFFFFFFFF
        return [high | target << 7 | 0x37, *_encode("addi", [target, target, low], here)]
    if name in _IMMEDIATE:
        target, source, value = values
        word = (value & 0xFFF) << 20 | source << 15 | _IMMEDIATE[name] << 12 | target << 7 | _I
    elif name in _ARITHMETIC:
        (high, low), (target, first, second) = _ARITHMETIC[name], values
        word = high << 25 | second << 20 | first << 15 | low << 12 | target << 7 | _R
    elif name in _LOADS:
        target, offset, base = values
        word = (offset & 0xFFF) << 20 | base << 15 | _LOADS[name] << 12 | target << 7 | _LOAD
    elif name in _STORES:
        source, offset, base = values
        word = (offset >> 5 & 0x7F) << 25 | source << 20 | base << 15
        word |= _STORES[name] << 12 | (offset & 31) << 7 | _STORE
    elif name in _BRANCHES:
        first, second, place = values
        way = place - here
        high, low = (way >> 12 & 1) << 6 | way >> 5 & 0x3F, way & 0x1E | way >> 11 & 1
        word = high << 25 | second << 20 | first << 15 | _BRANCHES[name] << 12 | low << 7 | _BRANCH
    else:
        assert name == "jal"
        target, place = values
        way = place - here
        bits = (way >> 20 & 1) << 19 | (way >> 1 & 0x3FF) << 9 | (way >> 11 & 1) << 8 | way >> 12 & 0xFF
        word = bits << 12 | target << 7 | 0x6F
    return [word]


def send(register: str) -> list[Line]:
    """Send a byte to the serial port, whose address is in x8 and which waits by itself."""
    return [("sw", register, 0, "x8")]


def small_program(scene: Scene, config: Configuration) -> list[int]:
    """Return the words of a program that sends `RAYC`, as read from the registers, and shows the scene; sends `M` and
    `E`, if its memory and arithmetic work, then `go` and a newline. Then, in each frame, it moves the camera sideways
    by the held buttons, and sends these as a letter from `@` on.

    Left and right move by 8 along y.
    """
    registers = register_map(config.table)
    camera, control, pending, enable = (
        4 * registers[name].address for name in ("camera", "control", "irq_pending", "irq_enable")
    )
    y_bit = registers["camera"].fields["y"].lsb
    load = scene_words(scene, config)
    start = load[-1][1]
    x, y, z = scene.camera.position
    still = registers["camera"].pack(x=x, z=z)
    lines: list[Line] = [
        # x8: serial port; x9: buttons; x10: ray tracer; x11: the scene's words; x12: their end
        ("li", "x8", UART),
        ("li", "x9", BUTTONS),
        ("li", "x10", RAY_TRACER),
        ("lw", "x5", 0, "x10"),
        ("addi", "x6", "x0", 4),
        ("label", "name"),  # highest byte first
        ("srli", "x7", "x5", 24),
        *send("x7"),
        ("slli", "x5", "x5", 8),
        ("addi", "x6", "x6", -1),
        ("bne", "x6", "x0", "name"),
        # Pairs of address and word.
        ("li", "x11", "scene"),
        ("li", "x12", "end"),
        ("label", "next"),
        ("lw", "x5", 0, "x11"),
        ("lw", "x6", 4, "x11"),
        ("sw", "x6", 0, "x5"),
        ("addi", "x11", "x11", 8),
        ("bne", "x11", "x12", "next"),
        ("addi", "x5", "x0", 1),
        ("sw", "x5", enable, "x10"),
        # Write a byte into the last word of the memory; an unmapped address ignores writes and reads 0.
        ("li", "x13", 4 * MEMORY_WORDS - 4),
        ("sw", "x0", 0, "x13"),
        ("addi", "x5", "x0", ord("M")),
        ("sb", "x5", 1, "x13"),
        ("lw", "x6", 0, "x13"),
        ("srli", "x6", "x6", 8),
        ("lw", "x7", 8, "x9"),
        ("sw", "x5", 8, "x9"),
        ("or", "x6", "x6", "x7"),
        *send("x6"),
        # 7 * 13 - 200 / 9 is the letter E.
        ("addi", "x5", "x0", 7),
        ("addi", "x6", "x0", 13),
        ("mul", "x5", "x5", "x6"),
        ("addi", "x6", "x0", 200),
        ("addi", "x7", "x0", 9),
        ("divu", "x6", "x6", "x7"),
        ("sub", "x5", "x5", "x6"),
        *send("x5"),
        *(line for letter in b"go\n" for line in (("addi", "x5", "x0", letter), *send("x5"))),
        # x14: y; x15: the camera's other fields; x16: word that commits; x17: 1
        ("li", "x14", y),
        ("li", "x15", still),
        ("li", "x16", start),
        ("addi", "x17", "x0", 1),
        ("label", "frame"),
        ("lw", "x5", 0, "x9"),
        ("andi", "x6", "x5", 1 << INTERRUPT_BIT),
        ("beq", "x6", "x0", "frame"),
        ("sw", "x17", pending, "x10"),
        ("andi", "x5", "x5", 31),
        ("andi", "x6", "x5", 1),
        ("slli", "x6", "x6", 3),
        ("sub", "x14", "x14", "x6"),
        ("andi", "x6", "x5", 2),
        ("slli", "x6", "x6", 2),
        ("add", "x14", "x14", "x6"),
        ("slli", "x6", "x14", y_bit),
        ("or", "x6", "x6", "x15"),
        ("sw", "x6", camera, "x10"),
        ("sw", "x16", control, "x10"),
        ("addi", "x5", "x5", ord("@")),
        *send("x5"),
        ("jal", "x0", "frame"),
        ("label", "scene"),
        *(("word", value) for address, word in load for value in (RAY_TRACER + 4 * address, word)),
        ("label", "end"),
    ]
    return assemble(lines)


def write_program(scene: Path, configuration: Configuration, directory: Path) -> Path:
    """Write the program for a scene and a design as a file from which a memory is loaded."""
    words = small_program(load_scene(scene, configuration.rectangles), configuration)
    program = directory / "small.hex"
    program.write_text("".join(f"{word:08x}\n" for word in words))
    return program
