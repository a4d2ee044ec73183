# SPDX-License-Identifier: MIT
"""cocotb: the registers of a design with a built-in scene."""

from __future__ import annotations

import cocotb
from cocotb.handle import HierarchyObject

from raycaster.sim.harness import Harness

EVERY_BIT = (1 << 32) - 1


@cocotb.test()
async def what_is_fixed_ignores_writes(bench: HierarchyObject) -> None:
    """Fixed state is reported as fixed and reads 0, and the picture never changes, whatever is written."""
    harness = Harness(bench)
    bus, config, scene, asked = harness.bus, harness.configuration, harness.scene, harness.reflections
    assert config.fixed is not None
    everything = config.fixed.camera is not None
    await harness.reset()
    assert (await bus.read("engine"))["fixed"] == (2 if everything else 1)
    assert (await bus.read("size"))["rectangles"] == 0
    assert not any(name.startswith("rectangle") for name in bus.registers)

    await harness.load(scene, asked)
    await harness.expect(scene, asked, "the scene")
    kept = 0 if everything else asked
    await harness.commit(reflections=kept)
    assert (await bus.read("control"))["reflections"] == kept
    mapped = {register.address: name for name, register in bus.registers.items()}
    for address in range(1 << bus.address_bits):
        if address not in mapped or (everything and mapped[address] in ("camera", "background")):
            await bus.write_word(address, EVERY_BIT)
            assert await bus.read_word(address) == 0, f"{address} is fixed or unmapped, and reads 0"
    await harness.monitor.frame()
    await harness.expect(scene, asked, "after writes to fixed registers")
    assert await bus.read("status") | {"busy": 0, "frame": 0} == {
        "busy": 0, "underrun": 0, "bad_rectangle": 0, "frame": 0,
    }  # fmt: skip
