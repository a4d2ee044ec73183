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
from pathlib import Path

import pytest
from conftest import BUILD, ROOT, called, make

from raycaster.design.options import CommandParser
from raycaster.docs import drawings, facts, pages, proofs, spans, tables, timing
from raycaster.docs.hdl import parts
from raycaster.errors import UserError
from raycaster.golden.exact import ExactModel
from raycaster.rtl import engine
from raycaster.runs import outcomes

EVERY_PAGE = "".join(page.read_text() for page in pages.PAGES)
BLOCKS = re.findall(r"^```sh\n(.*?)^```", EVERY_PAGE, re.M | re.S)
COMMANDS = {line.partition(" #")[0].strip(): None for block in BLOCKS for line in block.splitlines()}


@pytest.mark.parametrize("command", COMMANDS)
def test_command(command: str):
    """The Makefile has its target, the program accepts its variables or options, and its files exist."""
    words, lines = shlex.split(command), [command]
    if words[0] == "make":
        done = make("-n", *words[1:])
        assert done.returncode == 0, done.stderr
        for word in (word for word in words if "=" in word):
            without = make("-n", *(other for other in words[1:] if other != word))
            assert without.stdout != done.stdout, f"{word} changes nothing"
        lines = done.stdout.splitlines()
    else:
        assert shutil.which(Path(words[0]).name, path=sysconfig.get_path("scripts")), f"{words[0]} is not installed"
        # Tests that a page explains how to write are not in the repository.
        written = set(re.findall(r"`(verif/tests/\S+\.py)`:", (ROOT / "docs" / "extend.md").read_text()))
        assert all((ROOT / word).is_file() for word in words if word.endswith(".py") and word not in written)
    for line in lines:
        if found := re.match(r"(?:RAYCASTER_FROM_MAKE=1 )?\S*(?:python3? -m raycaster\.cli|raycaster) (.*)", line):
            # The program checks its arguments before it prints its help.
            assert called(*shlex.split(found[1]), "--help", cwd=ROOT).stderr == ""


def test_every_module_is_on_the_page_of_the_structure():
    """The list of modules has every hardware file with a block of the same name, and nothing else."""
    listed = re.search(r"^```\n(ray_caster_module .*?)^```", (ROOT / "docs/structure.md").read_text(), re.M | re.S)[1]
    named = {word for word in re.findall(r"\w+", listed) if "_" in word}
    there = {path.stem for path in (ROOT / "rtl").rglob("*.py") if f"@block\ndef {path.stem}(" in path.read_text()}
    assert named == {name for name in there if "_" in name}
    assert all(re.search(rf"\b{name}\b", listed) for name in there)


def test_the_example_module_works(leaf_of, random, tmp_path: Path, monkeypatch):
    """The module and the leaf test in `docs/extend.md` work as described."""
    page = (ROOT / "docs/extend.md").read_text()
    module, _, leaf = re.findall(r"^```python\n(.*?)^```", page, re.M | re.S)
    texts = {"rtl/engine/colour_dimmer.py": module, "verif/tests/leaves/engine/test_colour_dimmer.py": leaf}
    for place, text in texts.items():
        (tmp_path / Path(place).name).write_text(text)
    # The test finds the module where the page says that it is.
    monkeypatch.setattr(engine, "__path__", [*engine.__path__, str(tmp_path)])
    monkeypatch.syspath_prepend(tmp_path)
    importlib.import_module("test_colour_dimmer").test_colour_dimmer(leaf_of, random)


def test_the_example_row_is_drawn_so():
    """The exact model draws the runs that the page about spans follows by hand."""
    picture, start = ExactModel().render(spans.SCENE, spans.SCREEN), 0
    for end, colour in spans.example_row().result.runs:
        assert (picture[spans.ROW, start:end] == colour).all()
        start = end


@pytest.mark.slow
def test_timing_diagrams_match_the_design():
    """The kept diagrams match the converted Verilog, lane by lane."""
    BUILD.mkdir(exist_ok=True)
    drawn = dict(timing.simulate(BUILD))
    assert set(drawn) == {path.stem for path in timing.SOURCES.iterdir()}
    for name, lanes in drawn.items():
        assert timing.kept(name).splitlines() == lanes.splitlines(), f"{name}: run make docs to redraw it"


def test_the_pages_have_the_generated_texts(monkeypatch):
    """Text between markers is the generated text, except marks of stale figures, and all of it is on a page."""
    monkeypatch.setattr(tables, "is_stale", lambda kept: False)
    values, used = facts.facts() | tables.tables() | proofs.proofs() | parts(), set()
    for page in pages.PAGES:
        text = page.read_text()
        used |= set(re.findall(r"<!--(\w+)-->", text))
        fresh = text.replace(", **stale**", "")
        assert pages.rendered(fresh, values, page.name) == fresh, f"{page.name}: raycaster results --render writes it"
    assert used == set(values)


@pytest.mark.parametrize("page", pages.PAGES, ids=lambda page: page.name)
def test_a_page_by_itself(page: Path):
    """No measured number is typed outside commands and examples; a forge shows the page, and its links hold."""
    text = re.sub(r"^```(?!\{).*?^```$", "", page.read_text(), flags=re.M | re.S)
    found = re.findall(r"\d,\d{3}\b|\d+\.\d+ (?:MHz|ms|%)", pages.MADE.sub("", text))
    specified = {f"{mhz} MHz" for mhz in ("25.125", "25.175", "25.18", "25.2", "74.25")}
    assert set(found) <= specified, "only these are specified, not measured"
    # A marker must not turn its line into an HTML block.
    assert not re.search(r"\{\{|^```\{|^<!--\w*-->.|^<!--/-->.", text, re.M)
    for target in re.findall(r"\]\((?!https?:|#)([^)#]+)", text):
        assert (page.parent / target).exists(), target


def test_figures_are_kept(tmp_path: Path, monkeypatch):
    """Figures are kept once for each command, with any seed, with the digest of the Verilog; not without `--keep`."""
    monkeypatch.chdir(tmp_path)
    parser = CommandParser("area", "Cells.", "")
    outcomes.add_keep_option(parser)
    for option in ("--seed", "--units"):
        parser.add_argument(option)
    outcomes.keep(parser.parse_args([]), {"cells": 3}, lambda arguments: "12ab")
    assert not list(tmp_path.iterdir())
    path = Path("results/one.json")
    for cells, words in enumerate(["", "UNITS=2", "SEED=3", "UNITS=2 SEED=4"]):
        arguments = parser.parse_args([f"KEEP={path}", *words.split()])
        outcomes.keep(arguments, {"cells": cells}, lambda arguments: "12ab", left_out="clocks")
    first, second = outcomes.kept_outcomes(path)
    assert (first.command, first.figures, first.verilog) == ("raycaster area --seed 3", {"cells": 2}, "12ab")
    assert (second.command, second.figures) == ("raycaster area --units 2 --seed 4", {"cells": 3})
    assert first.tools["myhdl"] == importlib.metadata.version("myhdl")
    with pytest.raises(UserError, match="expected one outcome, got 2"):
        outcomes.kept_outcome(path)
    for other in ("<<<<<<< HEAD\n[]", '{"cells": 3}', '[{"cells": 3}]'):
        path.write_text(other)
        with pytest.raises(UserError, match="expected a list of kept figures"):
            parser.parse_args([f"KEEP={path}"])


def test_pages(tmp_path: Path):
    """All pages build without a warning, and their directory appears only when complete; fonts may differ.

    The kept diagrams have the words of newly drawn ones, also the ends of each arrow; positions may differ.
    """

    def kept() -> dict[str, str]:
        return {path.name: path.read_text() for path in drawings.DIAGRAMS.glob("*.svg")}

    output, diagrams = tmp_path / "site", kept()
    done = subprocess.run(
        [sys.executable, "-m", "raycaster.cli", "docs", "--keep-timing", "--no-web", "--output", str(output)],
        cwd=ROOT, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert kept() == diagrams, "the command has drawn diagrams that differ"
    assert all(drawings.words(svg) for svg in diagrams.values())
    exact = diagrams["exact.svg"]
    assert drawings.words(exact.replace("exact_control", "other")) != drawings.words(exact)
    written = {page.with_suffix(".html").name for page in pages.PAGES if page.parent == pages.HERE}
    assert written | {"python_api.html"} <= {path.name for path in output.iterdir()}
    assert {path.name for path in output.glob("_images/*.svg")} == {*diagrams, "view.svg"}, "each is on a page"
    assert (output / "register_map" / "index.html").is_file()
