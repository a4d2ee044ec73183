# SPDX-License-Identifier: MIT
"""A rectangle as software writes it."""

from raycaster.registers import register_map
from raycaster.rtl.common.records import Field, Record
from raycaster.rtl.common.widths import RGB_BITS, WORD_BITS

REGISTERS = register_map(1)
CORNER = REGISTERS["rectangle[0].corner_0"]
SURFACE = REGISTERS["rectangle[0].surface"]


class WrittenRect(Record):
    """The three registers of a rectangle, 32 bits each: two corners in any order, and colour and enable bit.

    x_0 ... z_1 are the corners' coordinates, 9 bits each. Bits that no register field has are 0.
    """

    def __init__(self):
        super().__init__(dict.fromkeys(("corner_0", "corner_1", "surface"), WORD_BITS))
        for number, low in enumerate((2 * WORD_BITS, WORD_BITS)):
            for axis, field in CORNER.fields.items():
                name = f"{axis}_{number}"
                setattr(self, name, Field(self.word, name, low + field.lsb, field.width))
        self.colour = Field(self.word, "colour", SURFACE.fields["blue"].lsb, RGB_BITS)
        self.enable = Field(self.word, "enable", SURFACE.fields["enable"].lsb, 1)
