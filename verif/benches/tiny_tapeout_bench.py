# SPDX-License-Identifier: MIT
"""cocotb: a Tiny Tapeout project shows its scene on its pins; every pixel is compared with the golden model."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import cocotb
from cocotb.handle import HierarchyObject
from cocotb.triggers import ClockCycles

from raycaster.configuration import Configuration
from raycaster.sim import simulator
from raycaster.sim.harness import Viewer

RESET_CLOCKS = 10


@dataclass(frozen=True)
class PinsBench(simulator.Bench):
    """A bench with the ports of the project instead of those of the ray tracer."""

    top: str = "tiny_tapeout_bench"

    @property
    def sources(self) -> list[Path]:
        """Verilog files of the bench."""
        return [*super().sources[:-1], Path(__file__).with_suffix(".v")]

    def parameters(self, configuration: Configuration) -> dict[str, int]:
        """Return the parameters of the bench for a design."""
        parameters = super().parameters(configuration)
        return {name: parameters[name] for name in ("H_TOTAL", "HS_ACTIVE")}


@cocotb.test()
async def one_frame(bench: HierarchyObject) -> None:
    """The first whole frame after reset shows the job's scene; unused pins are inputs."""
    viewer = Viewer(bench, blanking=False)
    pins, monitor = viewer.bench, viewer.monitor
    pins.ena.value = 1
    pins.ui_in.value = 0b10100101
    pins.uio_in.value = 0b01011010
    pins.rst_n.value = 0
    await ClockCycles(pins.clk, RESET_CLOCKS)
    monitor.forget()
    pins.rst_n.value = 1
    await viewer.expect(viewer.scene, viewer.reflections, "the first frame")
    assert viewer.golden(viewer.scene, viewer.reflections).any(), "the expected picture is black"
    assert int(pins.uio_oe.value) == 0, "unused pins are driven"
    monitor.check_pins()
