# SPDX-License-Identifier: MIT
"""The ray tracer in a LiteX SoC: a VexRiscv runs the C driver, and the display matches the golden model."""

from __future__ import annotations

import json
import re
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import BUILD, ROOT, faulty, run_tool
from litex.build.generic_platform import GenericPlatform, Pins, Subsignal
from litex.gen.fhdl import verilog
from litex.soc.cores.video import video_data_layout
from litex.soc.integration.export import get_csr_json
from litex.soc.integration.soc_core import SoCCore
from migen import ClockDomain
from migen.genlib.io import CRG

from raycaster.configuration import Configuration
from raycaster.convert import litex as litex_module
from raycaster.convert.litex import add_ray_caster
from raycaster.convert.take_home import TOP
from raycaster.design.decide import configure
from raycaster.errors import UserError
from raycaster.golden.exact import ExactModel
from raycaster.golden.frames import screens_before
from raycaster.golden.picture import shown
from raycaster.registers import register_map
from raycaster.scene import load_scene
from raycaster.sim.simulator import build_program, convert

SCENE = load_scene(ROOT / "docs" / "three_rectangles.toml")
"""Scene drawn by examples/litex_soc.c."""

VIDEO = ("video", 0, Subsignal("valid", Pins(1)), *(Subsignal(name, Pins(width)) for name, width in video_data_layout))

# The scene goes live at the second interrupt. A frame that shows it ends at a vertical sync. A reset in the middle of a
# frame comes first.
BENCH = """
`timescale 1ns/1ns
module soc_bench;
reg clk = 0, reset = 1;
wire [COLOUR_BITS-1:0] r, g, b;
wire [7:0] leds, video_r, video_g, video_b;
wire hs, vs, blank_n, vga_clk, valid, hsync, vsync, de;
integer frames = 0, wrong_syncs = 0;
soc soc (.clk(clk), .reset(reset), .leds(leds), .vga_r(r), .vga_g(g), .vga_b(b), .vga_hs(hs), .vga_vs(vs),
    .vga_blank_n(blank_n), .vga_sync_n(), .vga_clk(vga_clk), .video_valid(valid), .video_hsync(hsync),
    .video_vsync(vsync), .video_de(de), .video_r(video_r), .video_g(video_g), .video_b(video_b));
always #10 clk = ~clk;
initial begin
    #100 reset = 0;
    @(posedge leds[0]) #123456 reset = 1;
    $display("reset");
    frames = 0;
    #100 reset = 0;
    if (leds) $display("leds are lit after reset");
end
always @(negedge vs) if (!reset) begin
    frames = frames + 1;
    $display("frame %0d, wrong syncs %0d", leds, wrong_syncs);
    if (leds >= SHOWN_AT || frames == 10) $finish;
end
always @(posedge vga_clk) if (!reset && blank_n) $display("pins %h", {r, g, b});
always @(negedge clk) if (!reset && valid) begin
    if (de) $display("stream %h", {video_r, video_g, video_b});
    if (hsync == hs || vsync == vs) wrong_syncs = wrong_syncs + 1;
end
endmodule
"""


def pixels(text: str, name: str, shape: tuple[int, int], colour_bits: int) -> np.ndarray:
    """Read a frame's pixels, each a word of three channels."""
    words = np.array([int(word, 16) for word in re.findall(rf"^{name} (\w+)$", text, re.MULTILINE)]).reshape(shape)
    channels = [words >> shift * colour_bits & (1 << colour_bits) - 1 for shift in (2, 1, 0)]
    return np.stack(channels, axis=-1) << 8 - colour_bits


@pytest.mark.slow_sets("axi4lite")
@pytest.mark.parametrize(
    "options",
    [{"bus": "wishbone", "engine": "exact"}, {"bus": "axi4lite", "engine": "span", "colour_bits": 5}],
    ids=["wishbone", "axi4lite"],
)
def test_a_frame_is_golden(options, tmp_path, monkeypatch):
    """VGA pins and video stream show the golden picture; the driver finds the registers and receives interrupts."""
    monkeypatch.syspath_prepend(ROOT / "examples")
    example = import_module("litex_soc")
    config = configure(screen="tiny", rectangles=3, **options)
    soc = example.make_soc(config, tmp_path, [VIDEO])
    video = soc.platform.request("video")
    source = soc.ray_caster.source
    soc.comb += [getattr(video, name).eq(getattr(source, name)) for name in ("valid", *dict(video_data_layout))]
    files = example.write(soc, tmp_path)
    # LiteX's comments contain the time; without them a built model is found again.
    files[-1].write_text(re.sub(r"^//.*\n", "", files[-1].read_text(), flags=re.MULTILINE))
    bench = tmp_path / "soc_bench.v"
    shown_at = 2 + screens_before(SCENE, config)
    bench.write_text(BENCH.replace("COLOUR_BITS", str(config.colour_bits)).replace("SHOWN_AT", str(shown_at)))
    # The processor's registers have no reset; random initial values reveal reads before the first write.
    flags = ("--x-assign", "unique", "--x-initial", "unique", "-Wno-lint", "-Wno-style")
    command = build_program(f"litex-{config.name}", bench.stem, [*files, bench], build=BUILD, flags=flags)
    done = run_tool(tmp_path, *command, "+verilator+rand+reset+2")
    assert "leds are lit" not in done.stdout
    *_, last, end, _ = re.split(r"^frame (.*)\n", done.stdout.partition("reset\n")[2], flags=re.MULTILINE)
    assert end == f"{shown_at}, wrong syncs 0", done.stdout
    screen = config.screen_geometry
    shape = screen.vertical.visible, screen.horizontal.visible
    expected = shown(ExactModel().render(SCENE, screen), config)
    assert len(np.unique(expected.reshape(-1, 3), axis=0)) == 1 + len(SCENE.rect)
    assert np.array_equal(pixels(last, "pins", shape, config.colour_bits), expected)
    assert np.array_equal(pixels(last, "stream", shape, 8), expected)


AXI_FIELDS = {"aw": ["addr"], "w": ["data", "strb"], "b": ["resp"], "ar": ["addr"], "r": ["data", "resp"]}
CONNECTED = {
    "wishbone": {f"wb_{name}": f"bus_{name}" for name in ("cyc", "stb", "we", "sel", "dat_w", "ack", "dat_r")}
    | {"wb_adr": "bus_adr[4:0]", "1'b0": "bus_err"},
    "axi4lite": {f"s_axi_{name}{end}": f"{name}_{end}" for name in AXI_FIELDS for end in ("valid", "ready")}
    | {f"s_axi_{name}{field}": f"{name}_payload_{field}" for name, fields in AXI_FIELDS.items() for field in fields}
    | {f"s_axi_{name}addr": f"{name}_payload_addr[11:0]" for name in ("aw", "ar")},
}
"""Names in LiteX by the ports of a design with three rectangles, with AXI4-Lite of one with lists of frames."""

UNUSED = {
    "source_first", "source_last", "source_ready", "bus_bte", "bus_cti",
    *(f"{channel}_{name}" for channel in AXI_FIELDS for name in ("first", "last", "payload_prot")),
}  # fmt: skip

WRAPPED = {
    "low": ({"bus": "wishbone", "screen": "tiny", "engine": "exact"}, "!", "!", "!vga_clk"),
    "low-and-high": ({"bus": "wishbone", "rows": 200, "engine": "exact"}, "!", "", "!vga_clk"),
    "high": ({"bus": "axi4lite", "rows": 180, "engine": "span", "colour_bits": 5}, "", "", "1'b1"),
}
"""Options; the polarities of HS and VS, from VESA's and CTA's standards, as operators; when a pixel is valid."""

WRAPPER_BENCH = """
module bench;
{signals}
wrapper wrapper (.*);
integer step, wrong = 0;
task check(input [255:0] name, input [63:0] seen, input [63:0] expected);
    if (seen !== expected) begin $display("%0s is %h, expected %h", name, seen, expected); wrong = wrong + 1; end
endtask
initial for (step = 0; step < 100 && !wrong; step = step + 1) begin
    {random}
    #1;
    {checks}
end
endmodule
"""


def ports(text: str, module: str) -> dict[str, tuple[str, str]]:
    """Return the direction and the range of each port of a module."""
    [header] = re.findall(rf"^module {module} \(.*?^\);", text, re.M | re.S)
    found = re.findall(r"^ *(input|output) +(?:wire|reg) +(\[\d+:0\])? *(\w+),?$", header, re.M)
    return {name: (direction, width) for direction, width, name in found}


def wrapper_of(config: Configuration, directory: Path, right: str, wrong: str) -> str:
    """Return the Verilog of the LiteX module, which may get a fault, without the design's."""
    source = Path(litex_module.__file__).read_text()
    module: dict[str, Any] = {"__name__": "faulty"}
    exec(faulty(source, right, wrong) if right else source, module)
    module["write_verilog"] = lambda *given: []
    wrapper = module["RayCaster"](GenericPlatform("none", []), config, directory)
    wrapper.cd_sys = ClockDomain()
    channels = [wrapper.bus] if config.bus == "wishbone" else [getattr(wrapper.bus, name) for name in AXI_FIELDS]
    signals = [*wrapper.vga.values(), wrapper.ev.frame.trigger, wrapper.cd_sys.clk, wrapper.cd_sys.rst]
    ios = {*signals, *(signal for one in (wrapper.source, *channels) for signal in one.flatten())}
    return verilog.convert(wrapper, ios=ios, name="wrapper").main_source


def unlike_the_tables(kind: str, directory: Path, right: str = "", wrong: str = "") -> str:
    """Compare all ports of the LiteX module and of a stand-in for the design in it with `CONNECTED` and `WRAPPED`,
    while random values are on all inputs; return what differs."""
    options, hs, vs, valid = WRAPPED[kind]
    config = configure(rectangles=3, **options)
    wrapper, *_, design = wrapper_of(config, directory, right, wrong), *convert(config, BUILD)
    [header] = re.findall(rf"^module {TOP} \(.*?^\);", design.read_text(), re.M | re.S)
    outer, inner = ports(wrapper, "wrapper"), ports(header, TOP)
    known = CONNECTED[config.bus] | {name: name for name in inner if name.startswith("vga_")}
    known |= {"clk": "sys_clk", "reset": "sys_rst", "irq": "trigger"}
    assert known.keys() - {"1'b0"} == inner.keys()
    checks = [(theirs, f"wrapper.{TOP}.{ours}" if ours in inner else ours) for ours, theirs in known.items()]
    checks += [("source_payload_hsync", f"{hs}driven_vga_hs"), ("source_payload_vsync", f"{vs}driven_vga_vs")]
    checks += [("source_valid", valid), ("source_payload_de", "driven_vga_blank_n")]
    checks += [(f"source_payload_{name}", f"driven_vga_{name} << {8 - config.colour_bits}") for name in "rgb"]
    assert {theirs.partition("[")[0] for theirs, _ in checks} | UNUSED >= outer.keys()
    driven = [name for name, (way, _) in inner.items() if way == "output"]
    given = {name: width for name, (way, width) in outer.items() if way == "input"}
    given |= {f"driven_{name}": inner[name][1] for name in driven}
    outputs = (f"wire {width} {name};" for name, (way, width) in outer.items() if way == "output")
    bench = WRAPPER_BENCH.format(
        signals="\n".join([*(f"reg {width} {name};" for name, width in given.items()), *outputs]),
        random=" ".join(f"{name} = $random;" for name in given),
        checks=" ".join(f'check("{name}", {name}, {expected});' for name, expected in checks),
    )
    stand_in = [header, *(f"assign {name} = bench.driven_{name};" for name in driven), "endmodule"]
    (directory / "all.v").write_text("\n".join([bench, wrapper, *stand_in]))
    done = run_tool(directory, "iverilog", "-g2012", "-Wall", "-Wno-timescale", "-s", "bench", "-o", "bench", "all.v")
    return done.stdout or run_tool(directory, "vvp", "-n", "bench").stdout


@pytest.mark.parametrize("kind", WRAPPED)
def test_every_connection(kind, tmp_path):
    assert unlike_the_tables(kind, tmp_path) == ""


@pytest.mark.parametrize(
    ("kind", "right", "wrong", "complaint"),
    [
        ("low-and-high", "screen.vertical.active_high", "screen.horizontal.active_high", "source_payload_vsync"),
        ("low", "i_reset=ResetSignal()", "i_reset=0", "sys_rst is"),
        ("low", "i_clk=ClockSignal()", "i_clk=~ClockSignal()", "sys_clk is"),
        ("low", "o_irq=self.ev.frame.trigger", "o_irq=Signal()", "trigger is"),
        ("low", '~vga["clk"]', 'vga["clk"]', "source_valid is"),
        ("low", "adr[:words]", "adr[1 : words + 1]", "bus_adr"),
        ("low", "adr[:words]", "adr", "expects 5 bits, got 30"),
        ("high", "addr[: words + 2]", "addr[:words]", "expects 12 bits, got 10"),
        ("high", '"aw": ["addr"], "w": ["data", "strb"]', '"w": ["data"], "aw": ["addr"]', "(s_axi_wstrb) floating"),
        ("high", "CHANNEL_BITS - config.colour_bits", "0", "source_payload_r"),
        ("high", 'for name in "rgb")', 'for name in "rg")', "source_payload_b"),
    ],
)
def test_a_fault_of_the_module_is_noticed(kind, right, wrong, complaint, tmp_path):
    assert complaint in unlike_the_tables(kind, tmp_path, right, wrong)


@pytest.mark.slow_sets("wishbone")
@pytest.mark.parametrize(("bus", "standard"), [("wishbone", "axi-lite"), ("axi4lite", "wishbone")])
def test_the_map_is_that_of_the_registers(bus, standard, tmp_path):
    """A SoC without a processor and with another bus standard has each register at its offset in the map."""
    platform = GenericPlatform("none", [("clk", 0, Pins(1))])
    soc = SoCCore(platform, 50e6, bus_standard=standard, cpu_type=None, with_uart=False, with_timer=False)
    soc.crg = CRG(platform.request("clk"))
    config = configure(engine="exact", screen="tiny", rectangles=3, bus=bus)
    add_ray_caster(soc, config, tmp_path / "verilog", name="tracer", origin=0x8000_0000)
    soc.finalize()
    exported = json.loads(get_csr_json(soc.csr_regions, soc.constants, soc.mem_regions))
    assert exported["memories"]["tracer"] == {"base": 0x8000_0000, "size": 128, "type": "io"}
    expected = {
        "tracer_" + re.sub(r"\[(\d+)\]\.", r"_\1_", name).replace(".", "_") + "_offset": 4 * register.address
        for name, register in register_map(*config.map).items()
    }
    assert {name: value for name, value in exported["constants"].items() if name.endswith("_offset")} == expected


@pytest.mark.parametrize(
    ("options", "clock", "complaint"),
    [
        ({"bus": "apb"}, 50e6, "bus: LiteX takes wishbone or axi4lite, not apb"),
        ({"bus": "wishbone"}, 48e6, r"clock: seed-tiny.* needs 50 MHz, and the SoC has 48"),
        ({"bus": "wishbone", "engine": "span", "pixels": 2}, 12.5e6, "pixels: LiteX's video has 1 per clock, not 2"),
    ],
)
def test_bad_options_get_one_line(options, clock, complaint, tmp_path):
    soc = SoCCore(GenericPlatform("none", []), clock, cpu_type=None, with_uart=False, with_timer=False)
    with pytest.raises(UserError, match=rf"^{complaint}$"):
        add_ray_caster(soc, configure(screen="tiny", rectangles=3, **options), tmp_path / "verilog")
    assert not any(tmp_path.iterdir())
