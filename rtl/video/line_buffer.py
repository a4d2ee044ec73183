# SPDX-License-Identifier: MIT
"""A section of the double line buffer: the pixels of one ray unit."""

from myhdl import always_comb, block, instances

from raycaster.configuration import Configuration
from raycaster.hdl.signals import bits_for, unsigned
from raycaster.hdl.verbs import register
from raycaster.rtl.common.widths import pixel_bits


@block
def line_buffer(clk, write, line_buf_sel, write_offset, pixel_in, read_offset, pixel_out, config: Configuration):
    """Hold two rows of a ray unit's pixels: one half is written while the row before it is read from the other half.

    As the halves differ, no address is read while it is written.

    Args:
        write: strobe; stores pixel_in.
        line_buf_sel: flag; the half to write. The other half is read.
        write_offset: unsigned, below `config.groups`; number of the unit's pixel to write, read with write.
        pixel_in: unsigned, `pixel_bits` bits; read with write.
        read_offset: unsigned, below `config.groups`; number of the unit's pixel to read.
        pixel_out: unsigned, `pixel_bits` bits; output, a cycle after read_offset.
    """
    groups = config.groups
    address_width = bits_for(2 * groups)
    memory = [unsigned(pixel_bits(config)) for _ in range(2 * groups)]
    write_address, read_address = unsigned(address_width), unsigned(address_width)

    # The second half starts after the first one's last pixel.
    @always_comb
    def address():
        write_address.next, read_address.next = write_offset, read_offset
        if line_buf_sel:
            write_address.next = (write_offset + groups) % (1 << address_width)
        else:
            read_address.next = (read_offset + groups) % (1 << address_width)

    store = register(clk, memory[write_address], lambda: pixel_in, write)
    fetch = register(clk, pixel_out, lambda: memory[read_address])

    return instances()
