# SPDX-License-Identifier: MIT
"""`avalon_interface`: any transfers, resets and counts of cycles; all outputs are those of the register model."""

from scene_vectors import EVERY_BIT, sized
from vectors import designs

from raycaster.registers import address_bits
from raycaster.rtl.bus.avalon_interface import avalon_interface
from raycaster.rtl.common.interfaces import AvalonPort
from raycaster.rtl.common.widths import CYCLE_BITS, WORD_BITS
from raycaster.sim.register_model import Agent


@designs(
    sized(12),
    sized(1, reflections=0, fraction_bits=8, rounding="nearest", divider_bits=3, colour_bits=4),
    sized(32, reflections=2, units=320, rows=200),
    sized(2, engine="exact", turn=True, patterns=True),
    sized(2, engine="exact", materials=True),
    sized(100, engine="span"),
)
def test_avalon_interface(config, leaf_of, random):
    width = address_bits(*config.map)
    words = dict.fromkeys(("camera_readback", "rect_readback"), WORD_BITS)
    leaf, agent = leaf_of(avalon_interface, config, avs_s0=lambda: AvalonPort(width), **words), Agent(config)
    registers = [one.address for name, one in agent.registers.items() if not name.startswith(("rectangle", "frames"))]
    elsewhere = agent.registers["frames.cycles"].address if config.facts.whole_frames else 1 << width
    control = agent.registers["control"]
    row, group, committing = 0, 0, False
    for cycle in range(7500):
        # Counts mostly stay near the previous ones, a little above or below.
        row, group = (max(0, value + int(random.integers(-9, 10))) % (1 << CYCLE_BITS) for value in (row, group))
        if random.random() < 0.05:
            row = int(random.choice([0, 1, random.integers(1 << CYCLE_BITS), (1 << CYCLE_BITS) - 1]))
            group = int(random.integers(1 << int(random.integers(1, CYCLE_BITS + 1))))
        # After 3000 cycles: enough frames without a reset to change the counter's upper bits.
        busy_bus = cycle < 3000
        address = int(random.choice([*registers, control.address, int(random.integers(elsewhere))]))
        # Ones and zeros in the write-1-to-clear bits, and often a commit.
        data = int(random.choice([0, 1, 2, 4, 6, 0x303, 0x102, EVERY_BIT, random.integers(1 << WORD_BITS)]))
        transfer = random.choice(["read", "write", "none"], p=[0.4, 0.4, 0.2])
        # Reset often while a commit is in flight.
        reset = random.random() < (0.1 if committing else 0.003)
        committing = transfer == "write" and address == control.address
        inputs = {
            "reset": int(cycle < 2 or (busy_bus and reset)),
            "avs_s0_address": address,
            "avs_s0_read": transfer == "read",
            "avs_s0_write": transfer == "write",
            "avs_s0_writedata": data,
            "avs_s0_byteenable": int(random.choice([0, 1, 2, 4, 8, 15, 15, 15])),
            "camera_readback": int(random.integers(1 << WORD_BITS)),
            "rect_readback": int(random.integers(1 << WORD_BITS)),
            "bad_rectangle": int(random.random() < 0.3),
            "progress_start_screen": int(random.random() < (0.05 if busy_bus else 0.95)),
            "progress_busy": int(random.integers(2)),
            "progress_underrun": int(random.random() < 0.05),
            "progress_row_cycles": row,
            "progress_group_cycles": group,
        }
        if config.facts.whole_frames:
            inputs["progress_take_scene"] = int(inputs["progress_start_screen"] and random.random() < 0.7)
            inputs = {name: value for name, value in inputs.items() if name in leaf.given}
        waits = cycle and leaf.stimulus[-1]["reset"]
        leaf.case(inputs, agent.outputs(inputs) | {"avs_s0_waitrequest": waits})
        agent.clock(inputs)
    assert set(leaf.seen) == set(leaf.expected[0])
    leaf.check(settled=1)
