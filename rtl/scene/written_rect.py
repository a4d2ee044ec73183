# SPDX-License-Identifier: MIT
"""A rectangle as software writes it."""

from raycaster.configuration import Configuration
from raycaster.hdl.records import Record
from raycaster.hdl.signals import bits_for
from raycaster.registers import register_map
from raycaster.rtl.common.widths import RGB_BITS, WORD_BITS

REGISTERS = register_map(1)
CORNER = REGISTERS["rectangle[0].corner_0"]
SURFACE = REGISTERS["rectangle[0].surface"]
PATTERN = REGISTERS["rectangle[0].pattern"]


def surface_mask(config: Configuration) -> int:
    """Return the mask of the surface register's bits that a design has."""
    return SURFACE.implemented & ~(0 if config.materials else SURFACE.fields["mirror"].mask)


class WrittenRect(Record):
    """The registers of a rectangle, 32 bits each: two corners in any order, surface and, with patterns, pattern.

    x_0 ... z_1 are the corners' coordinates, 9 bits each; colour, enable; with materials mirror, 0..7; with patterns
    kind, cell and colour_2. Bits outside register fields are 0.
    """

    def __init__(self, config: Configuration):
        words = dict.fromkeys(("corner_0", "corner_1", "surface"), WORD_BITS) | {"pattern": WORD_BITS * config.patterns}
        lows = {name: sum(list(words.values())[place:]) for place, name in enumerate(words, 1)}
        parts = {
            f"{axis}_{number}": (lows[f"corner_{number}"] + field.lsb, field.width)
            for number in range(2)
            for axis, field in CORNER.fields.items()
        }
        mirror = SURFACE.fields["mirror"]
        parts["colour"] = lows["surface"] + SURFACE.fields["blue"].lsb, RGB_BITS
        parts["enable"] = lows["surface"] + SURFACE.fields["enable"].lsb, 1
        parts["mirror"] = lows["surface"] + mirror.lsb, mirror.width * config.materials
        parts["colour_2"] = PATTERN.fields["blue"].lsb, RGB_BITS * config.patterns
        for name in ("kind", "cell"):
            parts[name] = PATTERN.fields[name].lsb, PATTERN.fields[name].width * config.patterns
        super().__init__(words, parts)


def implemented_bits(config: Configuration) -> int:
    """Return the mask of a written rectangle's bits that a design has."""
    corner = CORNER.implemented
    words = {"corner_0": corner, "corner_1": corner, "surface": surface_mask(config), "pattern": PATTERN.implemented}
    return WrittenRect(config).pack(words)


BANKS = 3
"""Banks of a slot, for its shadow, pending and live copy."""

BANK_BITS = bits_for(BANKS)


class Copies(Record):
    """The banks of a slot's copies."""

    def __init__(self):
        super().__init__(dict.fromkeys(("shadow", "pending", "live"), BANK_BITS))
