# SPDX-License-Identifier: MIT
"""Leaf tests of `camera_mem`: MyHDL and converted Verilog match the expected values on the same vectors."""

from __future__ import annotations

import pytest
from scene_vectors import CYCLES, random_bus, sized
from vectors import ports

from raycaster.configuration import WORLD_SIZE
from raycaster.golden.random_world import EXTREMES
from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import unsigned
from raycaster.registers import address_bits, register_map
from raycaster.rtl.common.interfaces import SceneBus
from raycaster.rtl.common.records import camera_of
from raycaster.rtl.common.widths import WORD_BITS
from raycaster.rtl.scene.camera_mem import camera_mem
from raycaster.scene import UNTURNED
from raycaster.sim.register_model import AXES, CameraWords


@pytest.mark.parametrize("light", [False, True], ids=["no light", "light"])
@pytest.mark.parametrize("turn", [False, True], ids=["not turned", "turned"])
def test_camera_mem(turn, light, tmp_path, random):
    config = sized(12, engine="exact", turn=turn, light=light)
    leaf = Leaf(camera_mem, lambda: ports(
        "clk reset", bus=SceneBus(address_bits(12)), readback=unsigned(WORD_BITS), camera=camera_of(config),
        config=config
    ), tmp_path)  # fmt: skip
    addresses = [register_map(12)[name].address for name in ("camera", "forward", "right", "up", "light")]
    position = register_map(12)["camera"]
    neighbours = [address ^ 1 << place for address in addresses for place in range(address_bits(12))]
    stimulus = []
    for cycle in range(3 * CYCLES):
        place = {axis: int(random.choice([*EXTREMES, random.integers(WORLD_SIZE)])) for axis in AXES}
        data = position.pack(**place) if random.random() < 0.5 else None
        bus = random_bus(random, addresses * 10 + neighbours, data)
        stimulus.append({**bus, "reset": int(cycle == 0 or random.random() < 0.01)})
    outputs = leaf.run_both(stimulus, settled=1)
    model = CameraWords(config)
    bases, lights = set(), set()
    for cycle, (inputs, output) in enumerate(zip(stimulus, outputs, strict=True)):
        if cycle:
            expected = {f"camera_{axis}": value for axis, value in zip(AXES, model.position, strict=True)}
            if word := model.by_address.get(inputs["bus_address"]):
                expected["readback"] = word.shadow
            if turn:
                for name, vector in zip(("forward", "right", "up"), model.basis, strict=True):
                    # Negative components are in two's complement.
                    expected |= {f"camera_{name}_{axis}": part % 1024 for axis, part in zip(AXES, vector, strict=True)}
            if light:
                live = register_map(12)["light"].unpack(model["light"].live)
                expected |= {f"camera_light_{name}": value for name, value in live.items()}
                lights.add(tuple(live.values()))
            assert {name: output[name] for name in expected} == expected, cycle
            assert set(output) == {*expected, "readback"}
            bases.add(model.basis)
        for address, word in model.by_address.items():
            if inputs["reset"]:
                word.reset()
            else:
                word.clock(inputs, inputs["bus_address"] == address)
    assert UNTURNED in bases
    assert (len(bases) > 50) == turn
    assert (len(lights) > 50) == light
