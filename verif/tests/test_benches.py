# SPDX-License-Identifier: MIT
"""Benches of the whole design beyond a single frame: engines, buses, random starts, resting clocks, planted faults.

Verilator runs the full scene memory; Icarus, some hundred times slower, gets a design and a scene of three rectangles.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from dataclasses import replace
from itertools import product
from typing import Any

import pytest
from conftest import BUILD, ROOT, SMALL_SCENE, TINY, Bench, broken

from raycaster.buses import BRIDGED, BUSES, OWN, most_baud
from raycaster.configuration import Configuration, ConfigurationError
from raycaster.convert.write import write_scene_system, write_system
from raycaster.design.decide import configure
from raycaster.rtl.engines import ENGINES, EXACT
from raycaster.scene import load_scene
from raycaster.sim.simulator import SIMULATORS, SimulationError, convert
from raycaster.verif.seeds import seed

EVERYTHING = dict.fromkeys(EXACT.facts.features, True)
FULL_SCENE = ROOT / "raycaster" / "scenes" / "mirror_room.toml"
DESIGNS = {
    **{engine: ("verilator", configure(engine=engine, screen="tiny"), FULL_SCENE) for engine in ENGINES},
    "small": ("verilator", TINY["exact"], SMALL_SCENE),
    "icarus": ("icarus", configure(screen="tiny", units=8, rectangles=3, culling=False), SMALL_SCENE),
    "everything": ("icarus", configure(engine="exact", screen="tiny", rectangles=3, **EVERYTHING), SMALL_SCENE),
}
"""Simulator, design and scene."""


def on_bus(config: Configuration, bus: str) -> Configuration:
    """Return a design with another bus; a serial one is as fast as the clock allows, to save time."""
    fast = {"baud": most_baud(config.screen_geometry.clock_hz)} if BUSES[bus].serial else {}
    return replace(config, bus=bus, **fast)


SMALL = {bus: on_bus(TINY["seed"], bus) for bus in (OWN, *BRIDGED)}
STARTED = {**SMALL, "exact": TINY["exact"], "span": TINY["span"]}
"""Designs that start with random registers, by bus or engine."""
BUS_BENCH, TRAFFIC_BENCH = "verif.benches.bus_bench", "verif.benches.traffic_bench"
UART_BENCH = "verif.benches.uart_bench"
GATED = {"CLOCK_GATING": 1}
"""Makes clocks rest in Icarus, as they do in Verilator's models; see `clock_gate`."""

Noticed = Callable[..., str]


@pytest.fixture
def noticed(bench: Bench, tmp_path) -> Noticed:
    """Return a function that plants a fault, runs a bench, which must fail, and returns its complaint."""

    def run(where, module, simulator="icarus", design=SMALL[OWN], scene=SMALL_SCENE, **options) -> str:
        files = broken(convert(design, BUILD), tmp_path, *where)
        with pytest.raises(SimulationError) as error:
            bench(module, design, simulator, scene, verilog=files, **options)
        return str(error.value)

    return run


@pytest.mark.slow_sets(quick=["register-small"])
@pytest.mark.parametrize("design", DESIGNS)
@pytest.mark.parametrize("name", ["register", "traffic"])
def test_bench(bench: Bench, name: str, design: str):
    """Registers and their effects on the picture; random traffic and resets, after which only whole frames change."""
    simulator, configuration, scene = DESIGNS[design]
    first = 100 * seed()
    seeds = (first, first + 1) if simulator == "verilator" else (first,)
    bench(f"verif.benches.{name}_bench", configuration, simulator, scene, seeds=seeds)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("simulator", "options"),
    [
        pytest.param("verilator", {"units": 4}, id="seed"),
        pytest.param("verilator", {"engine": "exact", "units": 2}, id="exact"),
        pytest.param("icarus", {"units": 4, "rectangles": 3, "divider_bits": 1, "culling": False}, id="icarus"),
    ],
)
def test_underrun(bench: Bench, simulator: str, options: dict[str, Any]):
    """Fewer units than the scene needs."""
    configuration = configure(**{"screen": "tiny", "allow_underrun": True} | options)
    bench("verif.benches.underrun_bench", configuration, simulator)


@pytest.mark.slow_sets(quick=["tiny"])
@pytest.mark.parametrize(
    "options",
    [
        pytest.param({"screen": "tiny"}, id="tiny"),
        pytest.param({"screen": "tiny", "list": 400}, id="full-list"),
        pytest.param({"screen": "tiny", "reflections": 4, "units": 2, "turn": True, "pixels": 2}, id="pairs"),
        pytest.param({"reflections": 4}, id="full-size"),
    ],
)
def test_late_frames(bench: Bench, options: dict[str, Any]):
    """A moving camera, and frames that take longer than a refresh: each picture is a whole earlier frame."""
    bench("verif.benches.late_bench", configure(engine="span", **options), "verilator", FULL_SCENE)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("module", "right", "wrong", "complaint"),
    [
        ("frame_switch", "hands_over = take_scene && ready;", "hands_over = start_screen;", "pixels are wrong"),
        ("frame_switch", "start_screen && (state == WAIT)", "start_screen", "commit reads"),
        ("frame_registers", "if (events_again)", "if (events_drawn)", "frames.counts"),
        ("frame_registers", "least <= 0;", "least <= 1;", "frames.left"),
        ("avalon_interface", "else if (progress_take_scene)", "else if (progress_start_screen)", "commit reads"),
    ],
)
def test_a_fault_with_late_frames_is_noticed(noticed: Noticed, module, right, wrong, complaint):
    design = configure(engine="span", screen="tiny")
    said = noticed((module, right, wrong), "verif.benches.late_bench", "verilator", design, FULL_SCENE)
    assert re.search(complaint, said)


@pytest.mark.slow_sets(quick=["axi4lite-icarus-exact", "wishbone-icarus-exact"])
@pytest.mark.parametrize(
    ("simulator", "engine"),
    [one for one in product(SIMULATORS, TINY) if one != ("icarus", "span")],
)
@pytest.mark.parametrize("bus", BRIDGED)
def test_bus(bench: Bench, bus, simulator, engine):
    """Random words with back-pressure, a frame, and cycles per access; in Icarus, registers start unknown."""
    first = seed()
    design = on_bus(TINY[engine], bus)
    bench(BUS_BENCH, design, simulator, SMALL_SCENE, seeds=(first, first + 1, first + 2))


@pytest.mark.slow_sets(quick=["axi4lite-s_axi"])
@pytest.mark.parametrize(
    ("bus", "right", "wrong", "complaint"),
    [
        ("axi4lite", "avm_m0_byteenable = s_axi_wstrb;", "avm_m0_byteenable = 15;", "reads 0x"),
        ("axi4lite", "s_axi_bresp = 0;", "s_axi_bresp = 2;", "got the response"),
        ("wishbone", "avm_m0_byteenable = wb_sel;", "avm_m0_byteenable = 15;", "reads 0x"),
        ("wishbone", "avm_m0_address = wb_adr;", "avm_m0_address = wb_adr | 1;", "reads 0x"),
        ("apb", "avm_m0_byteenable = s_apb_pstrb;", "avm_m0_byteenable = 15;", "reads 0x"),
        ("apb", "s_apb_paddr[", "s_apb_pwdata[", "reads 0x"),
        ("uart", "avm_m0_writedata = shown;", "avm_m0_writedata = head;", "reads 0x"),
        ("uart", "head <= shown;", "head <= shown ^ 1;", "SimTimeoutError"),
    ],
)
def test_a_fault_in_a_bridge_is_noticed(noticed: Noticed, bus, right, wrong, complaint):
    assert complaint in noticed((f"{bus}_bridge", right, wrong), BUS_BENCH, design=SMALL[bus], seeds=(seed(),))


SERIAL = on_bus(configure(engine="span", screen="tiny", reflections=2), "uart")


@pytest.mark.slow_sets(quick=["1"])
@pytest.mark.parametrize("seeds", [1, 24])
def test_serial_line(bench: Bench, seeds):
    """Hosts that are 3 per cent fast or slow, noise, cables that are pulled, and two hosts at once: no room is torn."""
    first = 100 * seed()
    output = bench(UART_BENCH, SERIAL, "verilator", seeds=tuple(range(first, first + seeds)))
    found = json.loads((output / "uart.json").read_text())
    assert all(found.values()), found


@pytest.mark.slow_sets(quick=["check"])
@pytest.mark.parametrize(
    ("module", "right", "wrong", "complaint"),
    [
        ("frame_reader", "(state == 32'hdebb20e3) && ", "", "pixels are wrong"),
        ("frame_reader", "count <= 0;\n            escaped", "escaped", "no answer"),
        ("bit_timer", "restart ? first", "restart ? 0", "no answer"),
        ("uart_bridge", "stop <= words;", "stop <= words - 1;", "no answer to the next frame"),
    ],
    ids=["check", "resync", "middle", "commit"],
)
def test_a_fault_on_a_serial_line_is_noticed(noticed: Noticed, module, right, wrong, complaint):
    assert complaint in noticed((module, right, wrong), UART_BENCH, "verilator", SERIAL, "", seeds=(1, 2))


FAULTS = {
    "a-lane-always": ("avalon_interface", "if (avs_s0_byteenable[2])", "if (1'b1)", "reads 0x"),
    "unmapped-aliases": ("rect_mem", "= pattern_word;", "= old_surface;", "reads 0x"),
    "answer-lost": (
        "avalon_interface", "readdatavalid <= reading;", "readdatavalid <= reading && !avs_s0_read;",
        "avs_s0_readdatavalid is 0, expected 1",
    ),
    "answered-after-reset": (
        "avalon_interface", "reading <= 0;", "reading <= reading;", "avs_s0_readdatavalid is X|is 1, expected 0",
    ),
    "waits-in-a-burst": (
        "avalon_interface", "wait_request <= 1'b0;", "wait_request <= avs_s0_write && bus_write;",
        "avs_s0_waitrequest is 1, expected 0",
    ),
    "live-in-mid-frame": (
        "scene_word", "if (bus_go_live)", "if (bus_go_live || bus_commit)", "pixels are wrong|cycles reads",
    ),
    "rectangles-too-early": ("rect_slot", "if (bus_go_live)", "if (bus_commit)", "pixels are wrong"),
    "over-another-copy": ("rect_mem", "bank = 2;", "bank = 1;", "pixels are wrong"),
    "restarts-too-early": (
        "video_generator", "x <= -32;\n                if", "x <= -31;\n                if", "irq is 1, expected 0",
    ),
}  # fmt: skip
"""Module, right and wrong Verilog, and the complaint."""

RESTING = {
    "the-other-way": ("clock_gate", "open = awake || reset;", "open = !awake;", "reads 0x"),
    "rendering": ("ray_caster_renderer", "enable || reset_ray_caster", "reset_ray_caster", "cycles reads"),
    "a-write": ("ray_caster_module", "bus_write || ", "", "reads 0x"),
    "a-commit": ("ray_caster_module", "|| bus_commit ", "", "pixels are wrong"),
    "start-screen": ("ray_caster_module", "|| bus_go_live ", "", "pixels are wrong"),
    "a-fetch": ("ray_caster_module", "|| progress_busy", "", "pixels are wrong"),
    "a-reset": ("clock_gate", "awake || reset", "awake", "reads 0x"),
}
"""Faults that let a clock rest too long: each reason to wake it is left out alone."""


@pytest.mark.slow_sets(
    "a-commit", "a-fetch", "answered-after-reset", "live-in-mid-frame", "over-another-copy", "rectangles-too-early",
    "start-screen", "unmapped-aliases", "waits-in-a-burst",
)  # fmt: skip
@pytest.mark.parametrize("fault", FAULTS | RESTING)
def test_a_fault_is_noticed_in_traffic(noticed: Noticed, fault):
    *where, complaint = (FAULTS | RESTING)[fault]
    place = r"(seed \d+|the frame after reset): .*" if fault in FAULTS else ""
    # In traffic, something else wakes the clock at nearly each StartScreen.
    module = "sim.frame_bench" if fault == "start-screen" else TRAFFIC_BENCH
    said = noticed(where, module, seeds=(1, 2), defines=GATED if fault in RESTING else None)
    assert re.search(f"{place}({complaint})", said)


@pytest.mark.slow
def test_icarus_takes_clocks_that_rest(bench: Bench):
    """Without a fault, clocks that rest change nothing in traffic."""
    bench(TRAFFIC_BENCH, SMALL[OWN], "icarus", seeds=(1,), defines=GATED)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("design", "start"), [(name, start) for name in STARTED for start in ((1, 2) if name in BRIDGED else (1, 2, 3, 4))]
)
def test_random_start(bench: Bench, design, start):
    """Registers and memories start with random values, as in all benches, which have no effect after reset."""
    bench("sim.frame_bench", STARTED[design], "verilator", SMALL_SCENE, start=start)


@pytest.mark.slow
def test_the_start_is_random(noticed: Noticed):
    """Without its reset, a counter starts at a different random value each time."""
    fault = "avalon_interface", "frame <= 0;", "frame <= frame;"
    complaints = {
        noticed(fault, TRAFFIC_BENCH, "verilator", seeds=(1,), start=start).partition(";")[0] for start in (1, 2, 3)
    }
    assert len(complaints) == 3
    assert all("status reads" in complaint for complaint in complaints)


def test_an_unknown_start_is_noticed(noticed: Noticed):
    """Without its reset, the pixel's position in Icarus starts unknown and stays so."""
    fault = "video_generator", "if (reset == 1) begin\n        x <=", "if (1'b0) begin\n        x <="
    said = noticed(fault, "sim.frame_bench")
    assert "no leading edge of HS" in said or "neither 0 nor 1" in said


def test_systems_with_their_own_host_refuse_other_buses(tmp_path):
    for write, *scene in ((write_system,), (write_scene_system, load_scene(SMALL_SCENE))):
        with pytest.raises(ConfigurationError, match=r"bus: a system with.* processor drives .*; leave out apb$"):
            write(SMALL["apb"], *scene, tmp_path / "verilog")
    assert not any(tmp_path.iterdir())
