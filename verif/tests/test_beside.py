# SPDX-License-Identifier: MIT
"""Comparisons: software that draws the right picture, a small third-party design, and our own designs."""

from __future__ import annotations

import pytest

from raycaster.docs import beside
from raycaster.docs.beside import Other, checkouts_of, measure_beside, measure_other, measure_ours, measure_software
from raycaster.errors import UserError
from raycaster.fpga.cells import Area
from raycaster.output import Console
from raycaster.scene import load_scene, packaged_scenes
from raycaster.screens import SCREENS
from raycaster.sim.simulator import MODELS_VARIABLE, SimulationError

TINY = SCREENS["tiny", 48]
VERILOG = """
module stripes (input clk, input reset, output reg [5:0] shown);
    always @(posedge clk) shown <= reset ? 0 : shown * 3 + `STEP;
endmodule
"""
STRIPES = Other(
    "Stripes", "https://example.org/stripes", "stripes", ("step.v", "stripes.v"),
    {"CLOCK": "clk", "RESET": "reset", "IN_RESET": "1", "SHOWN": "shown"}, "stripes",
)  # fmt: skip


def test_the_software_draws_every_scene(tmp_path):
    """Pictures are compared with the golden model before the time counts."""
    scenes = [load_scene(path) for path in packaged_scenes().values()]
    assert len(scenes) > 10
    for scene in scenes:
        assert all(one["frame_s"] > 0 for one in measure_software(scene, TINY, tmp_path))


def test_software_that_draws_something_else(tmp_path, monkeypatch):
    """A fault that shows in any scene stops the measurement."""
    text, right = beside.SOFTWARE.read_text(), "n * best_e >= best_n * e"
    assert right in text
    changed = tmp_path / "golden.cpp"
    changed.write_text(text.replace(right, "n * best_e > best_n * e"))
    monkeypatch.setattr(beside, "SOFTWARE", changed)
    monkeypatch.delenv(MODELS_VARIABLE)
    with pytest.raises(UserError, match=r"^golden.cpp: draws \d+ pixels unlike the golden model$"):
        for path in packaged_scenes().values():
            measure_software(load_scene(path), TINY, tmp_path)


@pytest.fixture
def checkout(tmp_path, monkeypatch):
    """A checkout of the small third-party design; slow placing and routing is replaced, as tests of area cover it."""
    monkeypatch.setattr(beside, "route_netlist", lambda directory, clock_mhz, seed: {"routed_mhz": 99.5})
    directory = tmp_path / "stripes"
    directory.mkdir()
    (directory / "step.v").write_text("`define STEP 6'd5\n")
    (directory / "stripes.v").write_text(VERILOG)
    return directory


def test_a_third_party_design(checkout, tmp_path):
    found = measure_other(STRIPES, checkout, tmp_path / "out")
    assert found["registers"] == 6
    assert found["luts"] > 0
    assert found["routed_mhz"] == 99.5
    assert 0 < found["frame_s"] < 10
    assert found["commit"] == ""


@pytest.mark.parametrize("engine", ["exact", "beam"])
def test_our_design(engine, tmp_path, monkeypatch):
    """The design starts and shows a picture; slow counting and routing are replaced, as tests of area cover them."""
    monkeypatch.setattr(beside, "measure", lambda config, family, directory: Area(100, 50, 100, 2, 1))
    monkeypatch.setattr(beside, "route", lambda config, directory, seed: {"routed_mhz": 88.0})
    found = measure_ours({"engine": engine, "screen": "tiny"}, packaged_scenes()["boxes"], tmp_path)
    assert 0 < found["frame_s"] < 10
    assert (found["luts"], found["routed_mhz"]) == (100, 88.0)


def test_a_design_that_shows_nothing(checkout, tmp_path):
    text = checkout / "stripes.v"
    text.write_text(text.read_text().replace("reset ? 0", "1 ? 0"))
    with pytest.raises(UserError, match=r"^Stripes: shows nothing in simulation$"):
        measure_other(STRIPES, checkout, tmp_path / "out")


def test_a_wrong_checkout(tmp_path):
    checkouts = checkouts_of([f"racing_the_beam={tmp_path / 'nowhere'}"])
    with pytest.raises(UserError, match=r"nowhere/Pano.v: not found; give a checkout of https://github.com/tomv"):
        measure_beside("boxes", checkouts, tmp_path / "out", Console(quiet=True))
    assert not (tmp_path / "out").exists()


def test_a_design_that_fails_does_not_lose_the_others(tmp_path, monkeypatch, capsys):
    def ours(options, scene, directory):
        if options["engine"] in broken:
            raise SimulationError("its log is there")
        return software | {"design": options["engine"]}

    software = {"design": "software", "draws": "", "commit": "", "pixels": 1, "frame_s": 1.0}
    broken = ["beam"]
    monkeypatch.setattr(beside, "measure_software", lambda *_: [software])
    monkeypatch.setattr(beside, "measure_ours", ours)
    rows, failures = measure_beside("boxes", {}, tmp_path / "out", Console())
    assert [row["design"] for row in rows] == ["software", "exact"]
    assert failures == ["beam: its log is there"]
    assert "not measured: beam: its log is there\n" in capsys.readouterr().out
    monkeypatch.setattr(beside, "measure_software", lambda *_: ours({"engine": "beam"}, "", tmp_path))
    broken.append("exact")
    with pytest.raises(UserError, match=r"^nothing was measured; software: its log is there$"):
        measure_beside("boxes", {}, tmp_path / "out", Console(quiet=True))


@pytest.mark.parametrize("given", ["racing_the_beam", "racing_the_beam=", "quake=../quake"])
def test_an_unknown_design(given):
    with pytest.raises(UserError, match=rf"^beside: {given.partition('=')[0]}: expected racing_the_beam=CHECKOUT or "):
        checkouts_of([given])
