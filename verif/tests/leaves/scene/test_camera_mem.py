# SPDX-License-Identifier: MIT
"""`camera_mem`: the position, the basis and the light, after writes to their words and to neighbouring addresses."""

import pytest
from scene_vectors import CYCLES, random_bus, sized
from vectors import basis_inputs, by_axis, named

from raycaster.configuration import WORLD_SIZE
from raycaster.registers import address_bits, register_map
from raycaster.rtl.scene.camera_mem import camera_mem
from raycaster.scene import UNTURNED
from raycaster.sim.register_model import AXES, CameraWords
from raycaster.verif.random_world import EXTREMES


@pytest.mark.parametrize("light", [False, True], ids=["no light", "light"])
@pytest.mark.parametrize("turn", [False, True], ids=["not turned", "turned"])
def test_camera_mem(turn, light, leaf_of, random):
    config = sized(12, engine="exact", turn=turn, light=light)
    leaf = leaf_of(camera_mem, config)
    registers = register_map(12)
    addresses = [registers[name].address for name in ("camera", "forward", "right", "up", "light")]
    neighbours = [address ^ 1 << place for address in addresses for place in range(address_bits(12))]
    model, bases, lights = CameraWords(config), set(), set()
    for cycle in range(4 * CYCLES):
        place = {axis: int(random.choice([*EXTREMES, random.integers(WORLD_SIZE)])) for axis in AXES}
        data = registers["camera"].pack(**place) if random.random() < 0.5 else None
        inputs = random_bus(random, addresses * 10 + neighbours, data)
        inputs["reset"] = int(cycle == 0 or random.random() < 0.01)
        leaf.case(inputs)
        word = model.by_address.get(inputs["bus_address"])
        wanted = by_axis("camera_", model.position) | {"readback": word.shadow if word else None}
        wanted |= basis_inputs(model.basis) if turn else {}
        if light:
            live = registers["light"].unpack(model["light"].live)
            wanted |= named("camera_light", live)
            lights.add(tuple(live.values()))
        leaf.expect(wanted)
        bases.add(model.basis)
        for address, word in model.by_address.items():
            if inputs["reset"]:
                word.reset()
            else:
                word.clock(inputs, inputs["bus_address"] == address)
    assert set(leaf.seen) == set(leaf.expected[0])
    leaf.check(settled=1)
    assert UNTURNED in bases
    assert (len(bases) > 50) == turn
    assert (len(lights) > 50) == light
