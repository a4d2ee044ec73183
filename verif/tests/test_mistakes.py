# SPDX-License-Identifier: MIT
"""Mistakes of users: each gets one line without a traceback, and no file is written, changed or removed.

`mistakes/` has the commands, `$ raycaster sim scen` or as for make, in a copy of `mistakes/files`, each after the edits
of these files, `file: text -> text`, and before what it prints. Escapes are Python's; `((x)){9}` is x nine times.
"""

from __future__ import annotations

import re
import shlex
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from conftest import ROOT, compare_kept, plant, refusal

from raycaster.design.options import FROM_MAKE
from raycaster.sim.simulator import MODELS_VARIABLE
from raycaster.verif.seeds import VARIABLE

MISTAKES = Path(__file__).with_name("mistakes")


def meant(text: str) -> str:
    """Return a text without escapes and repetitions."""
    text = text.encode("ascii").decode("unicode_escape")
    return re.sub(r"\(\((.*?)\)\)\{(\d+)\}", lambda repeated: repeated[1] * int(repeated[2]), text, flags=re.DOTALL)


def cases(path: Path) -> Iterator[tuple[str, list[tuple[str, str, str]], str]]:
    """Yield a file's cases: the text of the edits, file, text and replacement of each, and the command."""
    for case in path.read_text().strip().split("\n\n"):
        edits, command = re.match(r"((?:(?!\$).*\n)*)\$ (.*)", case).groups()
        each = (re.fullmatch(r"(\S+): (.*) -> (.*)", edit).groups() for edit in edits.splitlines())
        yield edits, [(name, meant(right), meant(wrong)) for name, right, wrong in each], command


def said(command: str, directory: Path) -> str:
    """Return what a refused command line prints, which may begin with variables of the environment."""
    words = shlex.split(meant(command))
    start = next(place for place, word in enumerate(words) if word in ("raycaster", "make"))
    with pytest.MonkeyPatch.context() as patch:
        for name in (MODELS_VARIABLE, VARIABLE, FROM_MAKE, "KEEP"):
            patch.delenv(name, raising=False)
        for name, value in (word.split("=") for word in words[:start]):
            patch.setenv(name, value)
        if words[start] == "make":
            patch.setenv(FROM_MAKE, "1")
        printed = refusal(directory, *words[start + 1 :])
    for found, meant_by in ((f"{ROOT}/", "CLONE/"), (r" 0:00:\d\d", "")):
        printed = re.sub(found, meant_by, printed)
    return printed


@pytest.mark.parametrize("path", sorted(MISTAKES.glob("*.txt")), ids=lambda path: path.stem)
def test_a_mistake_gets_one_line(path: Path, tmp_path: Path):
    found = []
    for number, (text, edits, command) in enumerate(cases(path)):
        directory = shutil.copytree(MISTAKES / "files", tmp_path / str(number))
        for name, right, wrong in edits:
            plant(directory / name, right, wrong)
        found.append(f"{text}$ {command}\n{said(command, directory)}\n")
        shutil.rmtree(directory)
    compare_kept(path, "\n".join(found))


@pytest.mark.parametrize(
    ("simulator", "present", "missing"),
    [
        ("icarus", "", "Icarus Verilog is missing; install it"),
        ("verilator", "perl", "g++ is missing"),
        ("verilator", "g++", "perl is missing"),
    ],
)
def test_missing_programs_are_named(tmp_path, tmp_path_factory, monkeypatch, simulator, present, missing):
    monkeypatch.delenv(MODELS_VARIABLE)
    tools = tmp_path_factory.mktemp("bin")
    for tool in present.split():
        (tools / tool).symlink_to(shutil.which(tool))
    monkeypatch.setenv("PATH", str(tools))
    assert missing in refusal(tmp_path, "sim", "floor", "--simulator", simulator)
