# SPDX-License-Identifier: MIT
"""The documentation: drawings match the design, pages are consistent, and commands exist."""

from __future__ import annotations

import importlib.metadata
import re
import shlex
import shutil
import subprocess
import sys
import sysconfig
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest
from conftest import BUILD, ROOT, called, installed, make

from raycaster import outcomes
from raycaster.convert import digest
from raycaster.digests import uncommented
from raycaster.docs import __main__ as manual
from raycaster.docs import blocks, commands, drawings, facts, pages, proofs, tables, timing
from raycaster.docs.commands import commands_of
from raycaster.docs.results import main as results
from raycaster.errors import UserError
from raycaster.options import CommandParser
from raycaster.rtl import engine

COMMANDS = commands_of(commands.PAGES)


@cache
def accepts(words: tuple[str, ...]) -> str:
    """Return the program's complaint about these words, which it checks before it prints its help."""
    return called(*words, "--help", cwd=ROOT).stderr


@pytest.mark.parametrize("command", COMMANDS)
def test_command(command: str):
    """The Makefile has its target, the program accepts its variables or options, and its files exist."""
    words = shlex.split(command)
    lines = [command]
    if words[0] == "make":
        done = make("-n", *words[1:])
        assert done.returncode == 0, done.stderr
        for word in (word for word in words if "=" in word):
            without = make("-n", *(other for other in words[1:] if other != word))
            assert without.stdout != done.stdout, f"{word} changes nothing"
            if word.endswith(".toml"):
                assert (ROOT / word.partition("=")[2]).is_file()
        lines = done.stdout.splitlines()
    else:
        assert shutil.which(Path(words[0]).name, path=sysconfig.get_path("scripts")), f"{words[0]} is not installed"
        # Tests that a page explains how to write are not in the repository.
        written = set(re.findall(r"`(verif/tests/\S+\.py)`:", (ROOT / "docs" / "extend.md").read_text()))
        assert all((ROOT / word).is_file() for word in words if word.endswith(".py") and word not in written)
    for line in lines:
        if found := re.match(r"(?:RAYCASTER_FROM_MAKE=1 )?\S*(?:python3? -m raycaster\.cli|raycaster) (.*)", line):
            assert accepts(tuple(shlex.split(found[1]))) == ""


@pytest.mark.parametrize("command", ["make verilog ENGINE=exact RECTANGLES=20", "make registers"])
def test_quick_command(command: str, tmp_path: Path):
    """Run a command as a reader would, but in another directory and with the existing environment.

    `make commands` runs all of them.
    """
    assert command in COMMANDS
    installed(tmp_path)
    done = make(*shlex.split(command)[1:], f"PYTHON={sys.executable}", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    written = re.search(r"build/\S+?(?=[/,;]? |/?$)", done.stdout, re.MULTILINE)
    assert written, done.stdout
    assert (tmp_path / written[0]).exists()


def test_every_module_is_on_the_page_of_the_structure():
    """The list of modules has every hardware file with a block of the same name, and nothing else."""
    listed = re.search(r"^```\n(ray_caster_module .*?)^```", (ROOT / "docs/structure.md").read_text(), re.M | re.S)[1]
    named = {word for word in re.findall(r"\w+", listed) if "_" in word}
    there = {path.stem for path in (ROOT / "rtl").rglob("*.py") if f"@block\ndef {path.stem}(" in path.read_text()}
    assert named == {name for name in there if "_" in name}
    assert all(re.search(rf"\b{name}\b", listed) for name in there)


def test_the_example_module_works(leaf_of, random, tmp_path: Path, monkeypatch):
    """The module and the leaf test in `docs/extend.md` work as described and follow the project's rules."""
    page = (ROOT / "docs/extend.md").read_text()
    module, _, leaf = re.findall(r"^```python\n(.*?)^```", page, re.M | re.S)
    texts = {"rtl/engine/colour_dimmer.py": module, "verif/tests/leaves/engine/test_colour_dimmer.py": leaf}
    for place, text in texts.items():
        for rule in (["check"], ["format", "--check"]):
            command = [sys.executable, "-m", "ruff", *rule, "--stdin-filename", ROOT / place, "-"]
            done = subprocess.run(command, input=text, cwd=ROOT, capture_output=True, text=True, check=False)
            assert done.returncode == 0, done.stdout
        (tmp_path / Path(place).name).write_text(text)
    # The test finds the module where the page says that it is.
    monkeypatch.setattr(engine, "__path__", [*engine.__path__, str(tmp_path)])
    monkeypatch.syspath_prepend(tmp_path)
    importlib.import_module("test_colour_dimmer").test_colour_dimmer(leaf_of, random)


def test_timing_diagrams_match_the_design():
    """The kept diagrams match the converted Verilog, lane by lane."""
    BUILD.mkdir(exist_ok=True)
    drawn = dict(timing.simulate(BUILD))
    assert set(drawn) == {path.stem for path in timing.SOURCES.iterdir()}
    for name, lanes in drawn.items():
        assert timing.kept(name).splitlines() == lanes.splitlines(), f"{name}: run make docs to redraw it"


def test_timing_diagrams_match_the_configuration():
    """Cycles counted in the simulation equal those computed for the row budget."""
    cycles = {
        (diagram.name, start, end): measured
        for diagram in timing.DIAGRAMS
        for start, end, measured in timing.measured(diagram, timing.kept(diagram.name))
    }
    config = timing.CONFIGURATION
    assert cycles["renderer_and_ray_unit", "done", "done"] == config.group_cycles
    assert cycles["ray_control_and_ray_unit", "find_intersection", "find_intersection"] == config.rect_cycles
    a_ray = config.rectangles * config.rect_cycles + config.pass_latency
    assert cycles["ray_control_and_ray_unit", "add_colour", "add_colour"] == a_ray
    assert cycles["video_and_counters", "start_screen", "start_row"] == config.screen_geometry.row_cycles


every_page = pytest.mark.parametrize("page", pages.PAGES, ids=lambda page: page.name)


def test_the_pages_have_the_generated_texts(monkeypatch):
    """Text between markers is the generated text, except marks of stale figures, and all of it is on a page."""
    monkeypatch.setattr(tables, "is_stale", lambda kept: False)
    values, used = facts.facts() | tables.tables() | proofs.proofs(), set()
    for page in pages.PAGES:
        text = page.read_text()
        used |= set(re.findall(r"<!--(\w+)-->", text))
        fresh = text.replace(", **stale**", "")
        assert pages.rendered(fresh, values, page.name) == fresh, f"{page.name}: raycaster results --render writes it"
        assert pages.rendered(pages.MADE.sub(r"<!--\1-->7<!--/-->", fresh), values, page.name).count("7<!--/-->") < 2
    assert used == set(values)


@every_page
def test_no_measured_number_is_typed(page: Path):
    """Long counts, clocks and shares appear only between markers, or in commands and examples."""
    typed = re.sub(r"^```.*?^```$", "", pages.MADE.sub("", page.read_text()), flags=re.MULTILINE | re.DOTALL)
    found = re.findall(r"\d,\d{3}\b|\d+\.\d+ (?:MHz|ms|%)", typed)
    specified = {f"{mhz} MHz" for mhz in ("25.125", "25.175", "25.18", "25.2", "74.25")}
    assert set(found) <= specified, "only these are specified, not measured"


@every_page
def test_a_forge_shows_the_page(page: Path):
    """The page needs no Sphinx, its pictures and pages exist, and no marker turns its line into an HTML block."""
    text = re.sub(r"^```(?!\{).*?^```$", "", page.read_text(), flags=re.MULTILINE | re.DOTALL)
    assert not re.search(r"\{\{|^```\{|^<!--\w*-->.|^<!--/-->.", text, re.MULTILINE)
    for target in re.findall(r"\]\((?!https?:|#)([^)#]+)", text):
        assert (page.parent / target).exists(), target


def test_figures_are_kept(tmp_path: Path, monkeypatch):
    """Figures are kept with the command, the date and the digest of the Verilog; without `--keep`, nothing is."""
    monkeypatch.chdir(tmp_path)
    parser = CommandParser("area", "Cells.", "")
    outcomes.add_keep_option(parser)
    outcomes.keep(parser.parse_args([]), {"cells": 3}, lambda arguments: "12ab")
    assert not list(tmp_path.iterdir())
    path = Path("results/one.json")
    outcomes.keep(parser.parse_args([f"KEEP={path}"]), {"cells": 3}, lambda arguments: "12ab", left_out="clocks")
    kept = outcomes.kept_outcome(path)
    assert (kept.command, kept.figures, kept.verilog, kept.left_out) == (
        "raycaster area",
        {"cells": 3},
        "12ab",
        "clocks",
    )
    assert kept.tools["myhdl"] == importlib.metadata.version("myhdl")
    assert re.fullmatch(r"\d{4}-\d\d-\d\d", kept.date)
    with pytest.raises(UserError, match=r"nothing\.json: cannot be read: .*; a command with --keep"):
        outcomes.kept_outcome(tmp_path / "nothing.json")


def test_only_other_verilog_makes_a_figure_stale(monkeypatch, capsys):
    """Comments in the Verilog do not count; a module of the exact engine is not in the beam engine's Verilog."""
    begin = outcomes.Outcome("soak", "raycaster verify soak --screen tiny", "2026-11-24", "1234567", {}, "12ab", "", {})

    def stale(engine: str, before: str, after: str) -> bool:
        """Return True if a figure is stale after a change of all Verilog files."""
        command = f"{begin.command} --engine {engine}"
        now = tables.current_digest.__wrapped__(command)
        monkeypatch.setattr(digest, "uncommented", lambda verilog: uncommented(verilog.replace(before, after)))
        digest.digest_of.cache_clear()
        changed = tables.current_digest.__wrapped__(command)
        monkeypatch.undo()
        digest.digest_of.cache_clear()
        return now != changed

    assert stale("exact", "module nearest_hit", "module nearest_of_all")
    assert not stale("beam", "module nearest_hit", "module nearest_of_all")
    assert not stale("exact", "module nearest_hit", "// A comment.\nmodule nearest_hit")
    assert tables.is_stale(replace(begin, command="raycaster verify soak --engine gone"))
    monkeypatch.setattr("raycaster.docs.results.outcomes", lambda: [begin])
    monkeypatch.setattr("raycaster.docs.results.is_stale", lambda one: True)
    results(["--stale"])
    assert f"soak 2026-11-24 1234567 stale {begin.command}" in " ".join(capsys.readouterr().out.split())


def test_the_diagrams_match_the_design():
    """The kept diagrams have the words of newly drawn ones, also the ends of each arrow; positions may differ."""
    there = {path.stem: path.read_text() for path in drawings.DIAGRAMS.glob("*.svg")}
    now = drawings.drawn()
    assert there.keys() == now.keys()
    for name, svg in now.items():
        assert drawings.words(there[name]) == drawings.words(svg) != [], f"{name}: make docs draws it"
    assert drawings.words(now["exact"].replace("exact_control", "other")) != drawings.words(now["exact"])


def test_pages(tmp_path: Path):
    """All pages build without a warning, and their directory appears only when complete; fonts may differ."""
    output = tmp_path / "site"
    done = subprocess.run(
        [sys.executable, "-m", "raycaster.cli", "docs", "--keep-timing", "--no-web", "--output", str(output)],
        cwd=ROOT, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["site"]
    text = "".join(path.read_text() for path in output.glob("*.html"))
    written = {page.with_suffix(".html").name for page in pages.PAGES if page.parent == pages.HERE}
    assert written | {"python_api.html"} <= {path.name for path in output.iterdir()}
    assert "raycaster.golden.model.Model.trace" in text, "the library's reference"
    assert "<p>0, 1 or 2: the first of x, y, z that is the same in both corners.</p>" in text
    assert not re.search("model_config|ConfigDict|Create a new model", (output / "python_api.html").read_text())
    assert "The RayCaster authors" in text
    there = {f"{drawing.name}.svg" for drawing in (*blocks.DRAWINGS, *timing.DIAGRAMS)}
    there |= {"error_and_time.svg", "view.svg"}
    assert {path.name for path in output.glob("_images/*.svg")} == there, "each is on a page"
    assert (output / "register_map" / "index.html").is_file()


def test_pages_with_a_fault(tmp_path: Path, monkeypatch, capfd):
    """A warning counts as a fault too, and no page is left."""
    (tmp_path / "docs").mkdir()
    shutil.copy(pages.HERE / "conf.py", tmp_path / "docs")
    shutil.copytree(pages.HERE / "style", tmp_path / "docs" / "style")
    for name, text in (("index", "## Guides\n\n- [a](registers.md)\n"), ("registers", "[nowhere](nowhere.md)\n")):
        (tmp_path / "docs" / f"{name}.md").write_text(f"# {name}\n\n{text}")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(manual, "HERE", tmp_path / "docs")
    monkeypatch.setattr(manual, "REFERENCE", ())
    monkeypatch.setattr(manual, "draw_all", list)
    with pytest.raises(UserError, match="the pages have faults, listed above"):
        manual.main(["--keep-timing", "--no-web"])
    assert "registers.md:3: WARNING" in capfd.readouterr().err
    assert [path.name for path in (tmp_path / "build").iterdir()] == []
