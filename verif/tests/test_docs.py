# SPDX-License-Identifier: MIT
"""The documentation: drawings match the design, pages are consistent, and commands exist."""

from __future__ import annotations

import importlib.metadata
import json
import re
import shlex
import shutil
import subprocess
import sys
import sysconfig
from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest
from conftest import BUILD, ROOT, called, installed, make
from rich.console import Console

from raycaster import outcomes
from raycaster.configuration import configure
from raycaster.convert import provenance
from raycaster.convert.take_home import TOP
from raycaster.digests import code_digest, uncommented
from raycaster.docs import __main__ as manual
from raycaster.docs import blocks, commands, drawings, engine_figures, facts, pages, proofs, scaling, tables, timing
from raycaster.docs.commands import commands_of
from raycaster.docs.results import main as results
from raycaster.engines import ENGINES
from raycaster.errors import UserError
from raycaster.fpga.cells import Area
from raycaster.golden.picture import shown
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


def test_commands_are_run(tmp_path: Path, monkeypatch, capsys):
    """Each command runs once, except those skipped for a reason; failures are reported."""
    page = tmp_path / "page.md"
    blocks_of_page = ("sh\necho well # so it is\nmake test\nmake quartus\n", "\nexit 1\n", "sh\nexit 3\necho well\n")
    page.write_text("".join(f"```{block}```\n\n" for block in blocks_of_page))
    monkeypatch.setattr(commands, "PAGES", (page,))
    monkeypatch.setattr(commands, "ROOT", tmp_path)
    monkeypatch.setattr(commands, "find_program", lambda name: None)
    logs = tmp_path / "logs"
    assert commands.main(["--output", str(logs)]) == 1
    assert {path.name: path.read_text() for path in logs.iterdir()} == {"00.log": "well\n", "03.log": ""}
    assert capsys.readouterr().out.count("left out") == 2
    assert commands.main(["--output", str(logs), "--only", "echo"]) == 0
    with pytest.raises(UserError, match="only: no command in the manual contains 'sing'"):
        commands.main(["--output", str(logs), "--only", "sing"])


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


@pytest.fixture(scope="module")
def values():
    """All generated texts, by their names in the pages' markers."""
    return facts.facts() | tables.tables() | proofs.proofs()


def test_every_generated_text_is_on_a_page(values):
    text = "".join(page.read_text() for page in pages.PAGES)
    assert {name for name in values if f"<!--{name}-->" not in text} == set()


every_page = pytest.mark.parametrize("page", pages.PAGES, ids=lambda page: page.name)


@every_page
def test_the_page_has_the_generated_texts(page: Path, values):
    """The text between markers is the generated text; a manual edit there is noticed."""
    text = page.read_text()
    assert pages.rendered(text, values, page.name) == text, "raycaster results --render writes it"
    if made := [found for found in pages.MADE.finditer(text) if found[2].strip()]:
        middle = (made[0].start(2) + made[0].end(2)) // 2
        assert pages.rendered(text[:middle] + "7" + text[middle:], values, page.name) == text


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


def test_what_is_missing(monkeypatch, tmp_path: Path):
    with pytest.raises(UserError, match=r"nothing\.json: cannot be read: .*; raycaster docs draws it"):
        timing.kept("nothing")
    with pytest.raises(UserError, match=r"page: unknown marker nothing; expected one of a, b"):
        pages.rendered("<!--nothing-->0<!--/-->", {"a": "1", "b": "2"}, "page")
    with pytest.raises(UserError, match=r"nothing\.json: cannot be read: .*; a command with --keep"):
        outcomes.kept_outcome(tmp_path / "nothing.json")
    monkeypatch.setattr(tables, "outcomes", dict)
    with pytest.raises(UserError, match=r"engines: .*engines\.json is missing; a command with --keep writes it"):
        tables.tables()


def test_figures_are_kept(tmp_path: Path, monkeypatch):
    """Figures are kept with the command, the design and the date; without `--keep`, nothing is written."""
    monkeypatch.chdir(tmp_path)
    parser = CommandParser("area", "Cells.", "")
    outcomes.add_keep_option(parser)
    config = configure(engine="exact", culling=True)
    scope = outcomes.scope_of(config)

    def decided(arguments):
        return provenance.Provenance([config], ["golden/exact.py"], ["myhdl"])

    parser.add_argument("--family")
    outcomes.keep(parser.parse_args([]), {"cells": 3}, scope, decided)
    assert not list(tmp_path.iterdir())
    words = ["KEEP=results/one.json", "--family", "ecp5"]
    outcomes.keep(parser.parse_args(words), {"cells": 3}, scope, decided, left_out="clocks")
    kept = outcomes.kept_outcome(tmp_path / "results" / "one.json")
    assert kept.command == "raycaster area --family ecp5"
    assert kept.figures == {"cells": 3}
    assert (kept.scope["engine"], kept.scope["culling"], kept.scope["left_out"]) == ("exact", True, "clocks")
    assert kept.provenance["tools"] == {"myhdl": importlib.metadata.version("myhdl")}
    assert kept.provenance["designs"] == {config.name: provenance.verilog_digest(config)}
    assert re.fullmatch(r"\d{4}-\d\d-\d\d", kept.date)


@pytest.mark.parametrize(
    ("ending", "plain", "dressed", "changed"),
    [
        ("py", 'def f(a):\n    return a + "#1"\n', '# A.\ndef f(a):\n    """Add."""\n\n    return a + "#1"  # one\n',
         'def f(a):\n    return a + "#2"\n'),
        ("v", "assign a = b + c;\n", "// A sum.\nassign a = b + c; // all of it\n\n", "assign a = b - c;\n"),
        ("toml", 'a = "#1"\n', '# One.\n\na = "#1"\n', 'a = "#2"\n'),
        ("c", "int a = 1;\n", "// One.\n\nint a = 1;\n", "int a = 2;\n"),
    ],
)  # fmt: skip
def test_comments_make_no_figure_stale(tmp_path: Path, ending, plain, dressed, changed):
    """Comments, docstrings and empty lines do not change a digest; everything else does."""
    path = tmp_path / f"file.{ending}"

    def digest(text: str) -> str:
        path.write_text(text)
        return provenance.files_digest([path]) if ending == "v" else code_digest(path, tmp_path)

    assert digest(plain) == digest(dressed) != digest(changed)


def test_only_what_decides_a_figure_makes_it_stale(monkeypatch):
    """A change to a block of the exact engine changes no digest of the other engines."""
    designs = [configure(engine=name, screen="tiny", rectangles=1, reflections=0, culling=False) for name in ENGINES]
    before = [provenance.verilog_digest(design) for design in designs]
    changed = "module nearest_hit", "module nearest_hit_of_all"
    monkeypatch.setattr(provenance, "uncommented", lambda verilog: uncommented(verilog.replace(*changed)))
    after = [provenance.verilog_digest(design) for design in designs]
    assert [then == now for then, now in zip(before, after, strict=True)] == [True, False, True]
    then = {"designs": {"a": "1", "gone": "2"}, "sources": {"golden": "3"}, "tools": {}}
    now = {"designs": {"a": "1", "new": "2"}, "sources": {"golden": "4"}, "tools": {"myhdl": "0"}}
    assert tables._changed(then, then) == []
    assert tables._changed(then, now) == ["gone", "new", "golden", "myhdl"]
    assert tables._changed({}, now) == ["a", "new", "golden", "myhdl"]
    assert tables._changed(then, "no such scene") == ["the command, which is refused: no such scene"]


@pytest.mark.slow_sets("all")
@pytest.mark.parametrize("measured", ["raycaster verify all", "all"])
def test_stored_digests_are_those_of_the_designs(measured):
    """A new clone takes them for granted as long as the hardware's code is the same."""
    described = [
        tables._described(one.command) for one in tables.outcomes().values() if measured in (one.command, "all")
    ]
    designs = {design.name: design for each in described for design in getattr(each, "designs", ())}
    stored = json.loads(tables.DIGESTS.read_text())["designs"]
    assert len(designs) == (3 if measured != "all" else len(stored))
    assert {name: tables._digested(design) for name, design in designs.items()}.items() <= stored.items()


def test_stored_figures_are_listed(monkeypatch, capsys):
    """--list has the date, commit and digest of each figure; --stale has the commands of those that do not hold."""
    kept = outcomes.Outcome("area", "raycaster area", "2026-11-24", "1234567", {}, {}, {"designs": {"a": "1"}})
    other = replace(kept, name="fit", command="raycaster fit", provenance={"designs": {"a": "2"}}, changed=["a", "b"])
    monkeypatch.setattr("raycaster.docs.results.outcomes", lambda: {one.name: one for one in (kept, other)})
    assert results(["--list"]) == 0
    lines = capsys.readouterr().out.splitlines()
    [first], [second] = ([line.split() for line in lines if line.split()[:1] == [name]] for name in ("area", "fit"))
    assert first == ["area", "2026-11-24", "1234567", first[3], "holds"]
    assert second == ["fit", "2026-11-24", "1234567", second[3], "stale"] and first[3] != second[3]
    assert results(["--stale"]) == 0
    shown = " ".join(capsys.readouterr().out.split())
    assert "fit a, b raycaster fit --keep results/fit.json 1 of 2 are stale." in shown and "area" not in shown


def test_digests_are_stored(monkeypatch, tmp_path: Path):
    """Commands are described again after any change, designs are digested again only after one to the hardware.

    A new clone takes the kept digests of designs.
    """
    versions, asked = {tables.DECIDING: 0, tables.HARDWARE: 0}, []

    def run(what, function, jobs, *_):
        asked.append((what, len(jobs)))
        return list(map(function, jobs))

    def found(*changed) -> tuple[str, ...]:
        """Return the design's digest after changes to these sources, and the work that it took."""
        versions.update((places, versions[places] + 1) for places in changed)
        asked.clear()
        return tables._current(["area"])["area"]["designs"][configure().name], *asked

    kept = outcomes.Outcome("area", "area", "", "", {}, {}, {})
    monkeypatch.setattr(tables, "STORE", tmp_path / "build" / "provenance.json")
    monkeypatch.setattr(tables, "DIGESTS", tmp_path / "digests")
    monkeypatch.setattr(tables, "outcomes", lambda: {"area": kept})
    monkeypatch.setattr(tables, "run_jobs", run)
    monkeypatch.setattr(tables, "_state", lambda places, packages: [str(versions[places])])
    monkeypatch.setattr(tables, "_described", lambda command: provenance.Provenance([configure()]))
    monkeypatch.setattr(tables, "_digested", lambda design: f"digest {versions[tables.HARDWARE]}")
    assert found() == ("digest 0", ("commands", 1), ("designs", 1))
    assert found() == ("digest 0",)
    assert found(tables.DECIDING) == ("digest 0", ("commands", 1), ("designs", 0))
    assert found(tables.DECIDING, tables.HARDWARE) == ("digest 1", ("commands", 1), ("designs", 1))
    tables.keep_digests()
    tables.STORE.unlink()
    assert found() == ("digest 1", ("commands", 1), ("designs", 0))


def test_one_design_has_one_count():
    """All tables have the same LUT4 count for a design; stale figures are marked, and are left out here."""
    found: dict[str, set[tuple[str, int]]] = {}
    for kept in tables.outcomes().values():
        for name, count in counts_of(kept):
            found.setdefault(name, set()).add((kept.name, count))
    for name, counts in found.items():
        assert len({count for table, count in counts if not tables.outcomes()[table].changed}) <= 1, name
    # Counts are really compared: a design of this name is in several tables.
    assert {table for table, _ in found[configure(engine="exact").name]} >= {"engines", "features", "scaling", "report"}


def counts_of(kept: outcomes.Outcome) -> Iterator[tuple[str, int]]:
    """Yield the name and the ECP5 LUT4 count of each whole design in a kept file."""
    figures = kept.figures
    if kept.name == "area":
        for units, area in figures["families"]["ecp5"]["units"].items():
            yield configure(units=int(units), allow_underrun=True).name, area["tables"]
    elif kept.name == "fit":
        yield from ((one["configuration"], one["luts"]) for designs in figures.values() for one in designs)
    elif kept.name in ("engines", "features", "scaling", "report"):
        for row in figures["designs"]:
            whole = row.get("found", True) and row.get("module", TOP) == TOP and "refused" not in row
            # The resolution is a series of the scaling figures, but no option.
            if whole and row.get("option") != "resolution":
                options = row.get("options", {}) | ({row["option"]: row["value"]} if "option" in row else {})
                options |= {"engine": row["engine"]} if "engine" in row else {}
                yield configure(allow_underrun=True, **options).name, row.get("luts", row.get("tables"))


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
    there |= {"scaling.svg", "error_and_time.svg", "view.svg"}
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


def test_the_measured_designs_drew_the_right_pictures():
    designs = tables.outcomes()["engines"].figures["designs"]
    assert [design["options"] for design in designs] == list(map(dict, engine_figures.DESIGNS))
    for design in designs:
        assert design["wrong_vs_golden"] == 0
        assert (design["wrong_vs_exact"] > 0) == (design["options"]["engine"] == "seed")


def test_the_scaling_figures(tmp_path: Path, monkeypatch):
    """Every design has a row, refused ones too; a design in two series is counted once."""
    counted = []

    def count(config, family, directory):
        counted.append(config.name)
        return Area(100 * config.rectangles, 7, 0, 3, 0)

    series = [scaling.Series("beam", "rectangles", (2, 12)), scaling.Series("beam", "reflections", (1, 5))]
    monkeypatch.setattr(scaling, "SERIES", series)
    monkeypatch.setattr(scaling, "measure", count)
    monkeypatch.setattr(scaling, "frame_time", lambda config, build: 9.0)
    rows = scaling.measure_scaling(tmp_path, tmp_path, Console())
    assert sorted(counted) == ["beam-vga240-s2-u1-r12-m1-c8", "beam-vga240-s2-u1-r2-m1-c8"]
    assert [(row["option"], row["value"], row.get("tables")) for row in rows] == [
        ("rectangles", 2, 200), ("rectangles", 12, 1200), ("reflections", 1, 1200), ("reflections", 5, None),
    ]  # fmt: skip
    assert rows[0]["frame_cycles"] == 640 * 480
    assert rows[3]["refused"].startswith("reflections: ")


@pytest.mark.slow
def test_a_frame_is_timed(monkeypatch):
    """The timed scene fills the table, and wrong pixels are noticed."""
    config = configure(engine="beam", screen="tiny", rectangles=14)
    assert len(scaling.scene_for(config).rect) == 14
    assert 0 <= scaling.frame_time(config, BUILD) < 1000
    monkeypatch.setattr(scaling, "shown", lambda picture, config: 255 - shown(picture, config))
    with pytest.raises(AssertionError, match="wrong pixels"):
        scaling.frame_time(config, BUILD)


def test_the_scaling_plot():
    """The plot shows the figures of the tables."""
    plot = (pages.HERE / "scaling.svg").read_text()
    assert f"measured {tables.outcomes()['scaling'].date}" in plot
    assert set(drawings.words(plot)) > {*ENGINES, "rectangles", "reflections", "LUT4"}
