# SPDX-License-Identifier: MIT
"""cocotb: random bus traffic, with resets at any time, compared with a model of the registers in every clock."""

from __future__ import annotations

import random
from collections.abc import Iterator

import cocotb
from cocotb.handle import HierarchyObject
from cocotb.simtime import get_sim_time
from cocotb.triggers import FallingEdge

from raycaster.program import scene_fields
from raycaster.sim.harness import RESET_CLOCKS, Harness
from raycaster.sim.register_model import EVERY_LANE, LiveScene, RegisterFile, Request
from raycaster.verif.random_scenes import random_scene

FRAMES = 2
"""Number of whole frames that are checked per seed after its reset in mid-frame."""

FRAMES_WITH_LISTS = 8
"""The same for a design that shows a scene later, once its frame is drawn."""


class Traffic:
    """The bus master, which may drive reset and any request at any clock, and the model that predicts every answer."""

    def __init__(self, harness: Harness, seed: int):
        self.model = RegisterFile(harness.configuration)
        self.transfers = self.answers = 0
        self._harness = harness
        self._bench = harness.bench
        self._rng = random.Random(seed)
        self._requests = self._endless()
        self._request: Request | None = None
        self._known = False  # until the first clock edge under reset

    async def clock(self, reset: bool = False) -> None:
        """Check the outputs before the next clock edge, and drive the inputs for that edge."""
        bench, model = self._bench, self.model
        await FallingEdge(bench.clk)
        if self._known:
            self._check()
        self._known = True
        if self._request is None and not reset:
            self._request = next(self._requests)
        request = self._request
        bench.reset.value = int(reset)
        bench.avs_s0_read.value = int(request is not None and request.word is None)
        bench.avs_s0_write.value = int(request is not None and request.word is not None)
        if request is not None:
            bench.avs_s0_address.value = request.address
            bench.avs_s0_writedata.value = request.word or 0
            bench.avs_s0_byteenable.value = request.lanes
        if model.clock(reset, request):
            self.transfers += 1
            self._request = None

    async def reset(self) -> None:
        """Reset, whatever is on the bus: a request stays there, and is accepted only after reset."""
        for _ in range(RESET_CLOCKS):
            await self.clock(reset=True)
        self._harness.monitor.forget()
        await self.clock()

    def _check(self) -> None:
        bench, agent = self._bench, self.model.agent
        expected = {
            "avs_s0_waitrequest": int(agent.waiting),
            "avs_s0_readdatavalid": agent.answer[0],
            "irq": int(agent.irq_enable and agent.irq_pending),
        }
        for name, level in expected.items():
            seen = str(getattr(bench, name).value)
            assert seen == str(level), f"{name} is {seen}, expected {level}, {self.model.clocks} clocks into a frame"
        if agent.answer[0]:
            self.answers += 1
            self.model.check_answer(int(bench.avs_s0_readdata.value))

    def _endless(self) -> Iterator[Request | None]:
        """Yield bursts of one kind each: silence, reads and writes with or without gaps, or a scene and a commit."""
        rng, configuration = self._rng, self._harness.configuration
        registers = self.model.agent.registers
        addresses = list(range(1 << len(self._bench.avs_s0_address)))
        names = ["id", "version", "status", "cycles", "irq_enable", "irq_pending"]
        if configuration.facts.whole_frames:  # few addresses are mapped
            addresses = 8 * [register.address for register in registers.values()] + addresses
            names += [name for name in registers if name.startswith("frames.")]
        quiet = [registers[name].address for name in names]
        while True:
            kind = rng.choice(("silence", "reads", "mixture", "gaps", "shadow", "scene"))
            if kind == "scene":
                scene = random_scene(
                    rng.randrange(1 << 16), configuration.rectangles, configuration.most_reflections,
                    configuration.features,
                )  # fmt: skip
                for name, fields in scene_fields(scene, configuration):
                    yield Request(registers[name].address, registers[name].pack(**fields))
                    if rng.random() < 0.2:
                        yield rng.choice((None, Request(rng.choice(addresses))))
                control = registers["control"]
                yield Request(control.address, control.pack(run=1, commit=1, reflections=scene.reflections))
                continue
            for _ in range(rng.randrange(1, 80)):
                read = Request(rng.choice(addresses))
                # Writes that do not change the committed picture: outside the scene, or with no byte enabled.
                lanes = rng.randrange(EVERY_LANE + 1)
                write = rng.choice(
                    (
                        Request(rng.choice(quiet), rng.getrandbits(32), lanes),
                        Request(rng.choice(addresses), rng.getrandbits(32), 0),
                    )
                )
                match kind:
                    case "silence":
                        yield None
                    case "reads":
                        yield read
                    case "mixture":
                        yield rng.choice((read, write))
                    case "gaps":
                        yield rng.choice((read, write, None, None))
                    case "shadow":  # anything anywhere, sometimes a commit
                        yield Request(rng.choice(addresses), rng.getrandbits(32), lanes)


@cocotb.test()
async def traffic(bench: HierarchyObject) -> None:
    """For each of the job's seeds, frames after a reset during random traffic show what was committed."""
    harness = Harness(bench)
    transfers = answers = 0
    for seed in harness.job.seeds:
        try:
            player = await _play(harness, seed)
        except AssertionError as error:
            raise AssertionError(f"seed {seed}: {error}") from None
        transfers, answers = transfers + player.transfers, answers + player.answers
    harness.monitor.check_pins()
    assert transfers > answers > 0
    bench._log.info("%d transfers, %d of them reads that were answered", transfers, answers)


async def _play(harness: Harness, seed: int) -> Traffic:
    player = Traffic(harness, seed)
    rng = random.Random(~seed)
    await player.reset()
    for _ in range(rng.randrange(harness.screen.frame_cycles)):
        await player.clock()
    while not player.model.in_flight and rng.random() < 0.9:
        await player.clock()

    # Usually reads are in flight here; none of them may be answered after reset.
    await player.reset()
    watching = cocotb.start_soon(_watch(harness, player.model, get_sim_time("ns")))
    while not watching.done():
        await player.clock()
    await watching
    return player


async def _watch(harness: Harness, model: RegisterFile, released_ns: float) -> None:
    """Check that the frames after a reset come at the right time and show what they do in the model."""
    live: list[LiveScene | None] = []

    def remember(visible: int) -> None:
        if visible == 1:
            live.append(model.shown)

    seen = await harness.frame_after_reset(released_ns, remember)
    harness.expect_picture(seen, harness.golden_live(live[-1]), "the frame after reset")
    for number in range(1, FRAMES_WITH_LISTS if harness.configuration.facts.whole_frames else FRAMES):
        seen = await harness.monitor.frame(remember)
        harness.expect_picture(seen, harness.golden_live(live[-1]), f"frame {number} after reset")
