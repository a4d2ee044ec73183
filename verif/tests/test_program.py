# SPDX-License-Identifier: MIT
"""The program's face: its help fits a screen, shells complete it, and what it tells to run is in the user's form."""

from __future__ import annotations

import importlib
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import ROOT

from raycaster.cli import __main__ as program
from raycaster.cli import completion
from raycaster.cli.commands import COMMANDS, NOT_OF_MAKE, Command, overview, verify_overview
from raycaster.docs.commands import outside_make
from raycaster.errors import UserError
from raycaster.options import FROM_MAKE, command_line

SCREEN_LINES, MOST_LINES, COLUMNS = 24, 40, 80


@pytest.mark.parametrize("text", [overview(), overview(from_make=True), verify_overview()])
def test_overview_fits_a_screen(text: str):
    lines = text.splitlines()
    assert len(lines) < SCREEN_LINES
    assert max(map(len, lines)) <= COLUMNS
    assert lines[0].startswith(("raycaster ", "make "))


def test_overview_has_every_command():
    for text, left_out in ((overview(), ()), (overview(from_make=True), NOT_OF_MAKE)):
        words = {word for name in COMMANDS for word in name.split()} - {"verify"}
        assert words & set(re.split(r"[\s,-]+", text)) == words - set(left_out)


@pytest.mark.parametrize("name", COMMANDS)
def test_help(name: str, monkeypatch):
    """It begins with an example that the command takes, and fits a tall screen; the seldom options are elsewhere."""
    monkeypatch.setenv("COLUMNS", str(COLUMNS))
    parser = importlib.import_module(COMMANDS[name].module).command_parser()
    example, blank, *lines = parser.format_help().splitlines()
    assert not blank
    assert len(lines) + 2 <= MOST_LINES
    assert max(map(len, lines)) <= COLUMNS
    words = shlex.split(example.partition(" > ")[0])
    assert words[: len(name.split()) + 1] == ["raycaster", *name.split()]
    assert parser.parse_args(words[len(name.split()) + 1 :])
    assert not any("--divider-bits" in line for line in lines)


def test_options_lists_the_rest(capsys):
    assert program.main(["options"]) == 0
    assert "--divider-bits" in capsys.readouterr().out


def test_make_help_installs_nothing(tmp_path: Path):
    """In a clone without an environment it answers, and leaves the clone as it is."""
    (tmp_path / "Makefile").write_text((ROOT / "Makefile").read_text())
    (tmp_path / "cli").symlink_to(ROOT / "cli")
    command = ["make", "help", f"PYTHON3={sys.executable} -I -S"]
    done = subprocess.run(command, cwd=tmp_path, env=outside_make(), capture_output=True, text=True, check=False)
    assert done.stdout == overview(from_make=True) + "\n", done.stderr
    assert {path.name for path in tmp_path.iterdir()} == {"Makefile", "cli"}


def completions(script: Path, *words: str) -> set[str]:
    """What bash offers for the last of these words."""
    ask = f"""
        source {shlex.quote(str(script))}
        COMP_WORDS=({" ".join(map(shlex.quote, words))}); COMP_CWORD={len(words) - 1}
        _shtab_raycaster; printf '%s\\n' "${{COMPREPLY[@]}}"
    """
    done = subprocess.run(["bash", "-c", ask], capture_output=True, text=True, check=True)
    return set(done.stdout.split())


def test_bash_completion(tmp_path: Path, capsys):
    completion.main(["bash"])
    script = tmp_path / "raycaster.bash"
    script.write_text(capsys.readouterr().out)
    subprocess.run(["bash", "-n", script], check=True)
    assert completions(script, "raycaster", "ver") == {"verify", "verilog"}
    assert completions(script, "raycaster", "verify", "so") == {"soak"}
    assert completions(script, "raycaster", "sim", "mirr") == {"mirror_room"}
    assert completions(script, "raycaster", "sim", "--frac") == {"--fraction-bits"}
    assert completions(script, "raycaster", "sim", "--engine", "b") == {"beam"}


@pytest.mark.parametrize("shell", ["zsh", "tcsh"])
def test_other_completions(shell: str, capsys):
    completion.main([shell])
    assert "mirror_room" in capsys.readouterr().out


def test_completion_without_an_extra(monkeypatch):
    """A command that cannot be loaded still has its name."""
    monkeypatch.setitem(COMMANDS, "docs", Command("no_such_module", "build the manual", "docs"))
    assert ",docs," in completion.whole_parser().format_usage()


def test_a_missing_extra_is_named(monkeypatch):
    monkeypatch.setitem(COMMANDS, "docs", Command("no_such_module", "build the manual", "docs"))
    with pytest.raises(UserError, match=r"no_such_module is missing; it comes with the extra docs"):
        program.main(["docs"])
    monkeypatch.setitem(COMMANDS, "docs", Command("raycaster.no_such_module", "build the manual", "docs"))
    with pytest.raises(ModuleNotFoundError):
        program.main(["docs"])


def test_what_to_run_next_is_in_the_users_form(monkeypatch):
    monkeypatch.delenv(FROM_MAKE, raising=False)
    asked = {"pixel": "3,4", "fraction_bits": "4", "stiff": True, "sim": "icarus"}
    told = command_line("verify soak", "my scene.toml", asked)
    assert told == ("raycaster verify soak 'my scene.toml' --pixel 3,4 --fraction-bits 4 --stiff --simulator icarus")
    monkeypatch.setenv(FROM_MAKE, "1")
    told = command_line("verify soak", "my scene.toml", asked)
    assert told == "make soak SCENE='my scene.toml' PIXEL=3,4 FRACTION_BITS=4 STIFF=1 SIM=icarus"


def test_complaints_are_in_the_users_form(tmp_path: Path):
    """Of the same wrong variable, by the program and by the Makefile's way of calling it."""

    def complaint(variables: dict[str, str]) -> str:
        command = [sys.executable, "-m", "raycaster.cli", "sim", "SEEDS=3"]
        environment = os.environ | {FROM_MAKE: ""} | variables
        done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
        assert done.returncode == 2
        return done.stderr

    assert complaint({}) == "error: SEEDS: raycaster sim does not take it; see raycaster sim --help\n"
    from_make = complaint({FROM_MAKE: "1"})
    assert from_make == "error: SEEDS: make sim does not take it; see .venv/bin/raycaster sim --help\n"
    recipes = subprocess.run(
        ["make", "-n", "sim"], cwd=ROOT, env=outside_make(), capture_output=True, text=True, check=True
    )
    assert f"{FROM_MAKE}=1 " in recipes.stdout


def make_with(directory: Path, script: str, *words: str) -> subprocess.CompletedProcess[str]:
    """Run make in a directory where everything is installed, and a script stands for Python."""
    for name in ("Makefile", "pyproject.toml", "constraints.txt"):
        shutil.copy(ROOT / name, directory)
    (directory / ".venv").mkdir(exist_ok=True)
    for name in ("base", *re.findall(r": EXTRAS := ([\w,]+)$", (ROOT / "Makefile").read_text(), re.MULTILINE)):
        (directory / ".venv" / name).touch()
    python = directory / "python"
    python.write_text(script)
    python.chmod(0o755)
    command = ["make", "-s", *words, "PYTHON=./python"]
    return subprocess.run(command, cwd=directory, env=outside_make(), capture_output=True, text=True, check=False)


@pytest.mark.parametrize(
    "value",
    ["x;touch bad", "$(shell touch bad)", "`touch bad`", 'it\'s  "q"', "a|b&c*", "two\nlines", "$HOME$$(x)", "#\\ a"],
)
def test_make_hands_on_what_was_typed(tmp_path: Path, value: str):
    """Neither make nor the shell expands it, in a recipe and in the recipe of a make below; nothing runs."""
    script = f"#!{sys.executable}\nimport json, sys\nprint(json.dumps(sys.argv[4:]))\n"
    for target, more in (("sim", []), ("flash", ["FLASH=1"])):
        done = make_with(tmp_path, script, target, f"SCENE={value}")
        assert done.returncode == 0, done.stderr
        assert json.loads(done.stdout) == [f"SCENE={value}", *more]
    assert not (tmp_path / "bad").exists()


def test_a_failing_line_of_a_recipe_ends_it(tmp_path: Path):
    """All lines of a recipe share a shell, which must not go on after one that fails."""
    done = make_with(tmp_path, '#!/bin/sh\necho "$*"\nfalse\n', "lint")
    assert (done.returncode, done.stdout) == (2, "-m ruff check\n")
