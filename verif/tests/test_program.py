# SPDX-License-Identifier: MIT
"""The command line: help fits a screen, shells complete it, and suggested commands have the user's form."""

from __future__ import annotations

import importlib
import importlib.metadata
import json
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import ROOT, faulty, installed, make, refused, write_script

from raycaster.cli import __main__ as program
from raycaster.cli import completion
from raycaster.cli.commands import COMMANDS, Command, overview, verify_overview
from raycaster.design.for_scene import design_for
from raycaster.design.options import FROM_MAKE, command_line, run_command
from raycaster.errors import UserError
from raycaster.golden.engines import model_of
from raycaster.hdl.elaboration import elaboration
from raycaster.hdl.hierarchy import convert_hierarchy
from raycaster.hdl.signals import bit
from raycaster.rtl.common.records import Colour

SCREEN_LINES, MOST_LINES, COLUMNS = 24, 40, 80
VERSION = importlib.metadata.version("raycaster")


@pytest.mark.parametrize("text", [overview(), overview(from_make=True), verify_overview()])
def test_overview_fits_a_screen(text: str):
    lines = text.splitlines()
    assert len(lines) < SCREEN_LINES
    assert max(map(len, lines)) <= COLUMNS
    assert lines[0].startswith(("raycaster ", "make "))


@pytest.mark.parametrize("name", COMMANDS)
def test_help(name: str, monkeypatch):
    """Help begins with a valid example, fits a tall screen and leaves out rarely used options."""
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


def test_make_help_installs_nothing(tmp_path: Path):
    """It works in a clone without an environment and leaves the clone unchanged."""
    (tmp_path / "Makefile").write_text((ROOT / "Makefile").read_text())
    (tmp_path / "raycaster").symlink_to(ROOT / "raycaster")
    done = make("help", f"PYTHON3={sys.executable} -I -S", cwd=tmp_path)
    assert done.stdout == overview(from_make=True) + "\n", done.stderr
    assert {path.name for path in tmp_path.iterdir()} == {"Makefile", "raycaster"}


COMPLETE = """
source {script}
COMP_WORDS=({words}); COMP_CWORD=$((${{#COMP_WORDS[@]}} - 1))
_shtab_raycaster; printf '%s\\n' "${{COMPREPLY[@]}}"
"""


def test_bash_completion(tmp_path: Path, capsys):
    completion.main(["bash"])
    script = tmp_path / "raycaster.bash"
    script.write_text(capsys.readouterr().out)
    for words, expected in {
        "ver": {"verify", "verilog"},
        "verify so": {"soak"},
        "sim mirr": {"mirror_room"},
        "sim --frac": {"--fraction-bits"},
        "sim --engine sp": {"span"},
    }.items():
        asked = COMPLETE.format(script=script, words=f"raycaster {words}")
        done = subprocess.run(["bash", "-c", asked], capture_output=True, text=True, check=True)
        assert (set(done.stdout.split()), done.stderr) == (expected, ""), words


WITHOUT_EXTRAS = """
import sys
sys.modules.update(dict.fromkeys({missing}))
import importlib
from contextlib import suppress
from raycaster.cli import __main__ as program, completion
from raycaster.cli.commands import COMMANDS
for command in COMMANDS.values():
    if command.extra in ("", "formal", "fpga"):
        importlib.import_module(command.module)
for name in COMMANDS:
    with suppress(SystemExit):
        program.main([*name.split(), "--help"])
completion.main(["bash"])
"""
"""Imports of modules that are None fail, as if they were not installed."""


def test_help_and_completions_without_an_extra():
    """Each command shows its help without any package that only an extra installs.

    Commands that need no extra, or one without these packages, also import what they run.
    """
    missing = {
        "adjustText", "distributed", "elftools", "litex", "matplotlib", "playwright", "pygame",
        "pygraphviz", "sphinx", "wavedrom", "ziglang",
    }  # fmt: skip
    command = [sys.executable, "-c", WITHOUT_EXTRAS.format(missing=missing)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    for name, command in COMMANDS.items():
        example = importlib.import_module(command.module).command_parser().example
        assert f"{example}\n\n" in done.stdout, name
    assert re.search("raycaster_report_option_strings=.*--quick", done.stdout)


def test_help_without_the_hardware():
    """The list of commands does not load MyHDL and the blocks, which would take as long as everything else."""
    code = "import sys; sys.modules['myhdl'] = None; from raycaster.cli.__main__ import run; run()"
    done = subprocess.run([sys.executable, "-c", code, "--help"], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.parametrize(
    ("asked", "meant"),
    [("smi", "sim"), ("verify-al", "verify-all"), ("lnit", "lint")],
)
def test_make_suggests_a_target(asked: str, meant: str):
    done = make(asked, f"PYTHON3={sys.executable}")
    assert done.stderr.startswith(f"error: unknown command: {asked} (did you mean {meant}?); make help lists all\n")


GOOD = re.findall(r"```python\n(.*?)```", (ROOT / "docs/extend.md").read_text(), re.DOTALL)[0]


@pytest.mark.parametrize(
    ("right", "wrong", "fault"),
    [
        ("if dim:", "if dimm:", "33: dimm may have no value here; assign to it first"),
        (
            "dimmed.word.next = half",
            "dimmed.wrd.next = half",
            "34: 'Colour' object has no attribute 'wrd' (AttributeError)",
        ),
        ("unsigned(CHANNEL_BITS)", "unsinged(CHANNEL_BITS)", "21: name 'unsinged' is not defined (NameError)"),
        ("(red=red, ", "(", "29: Colour: red: missing, or no field (ValueError)"),
        ("dimmed.word.next = colour", "dimmed.word.next = brighter(colour", "36: '(' was never closed"),
    ],
)
def test_a_fault_in_a_block_is_one_line(right: str, wrong: str, fault: str, tmp_path: Path, monkeypatch):
    """The error names file, line and fault; the block is the example on the page about writing one."""
    path = tmp_path / "colour_dimmer.py"
    path.write_text(faulty(GOOD, right, wrong))
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delitem(sys.modules, "colour_dimmer", raising=False)

    def convert(_: list[str]) -> None:
        module = importlib.import_module("colour_dimmer")
        with elaboration():
            block = module.colour_dimmer(clk=bit(), dim=bit(), colour=Colour(), dimmed=Colour())
        convert_hierarchy(block, tmp_path, "// {module}")

    assert refused(convert).startswith(f"error: {path}:{fault}")


def test_a_fault_of_another_kind_keeps_its_traceback():
    with pytest.raises(ZeroDivisionError):
        run_command(lambda: 1 // 0)


def test_a_missing_extra_is_named(monkeypatch):
    monkeypatch.setitem(COMMANDS, "docs", Command("no_such_module", "build the manual", "docs"))
    with pytest.raises(UserError, match=r"no_such_module is missing; it comes with the extra docs"):
        program.main(["docs"])
    monkeypatch.setitem(COMMANDS, "docs", Command("raycaster.no_such_module", "build the manual", "docs"))
    with pytest.raises(ModuleNotFoundError):
        program.main(["docs"])


def test_make_gets_suggestions_in_its_form(monkeypatch):
    """`test_configuration.py` reads suggested options back; `mistakes/commands.txt` has complaints in both forms."""
    assert f"{FROM_MAKE}=1 " in make("-n", "sim").stdout
    monkeypatch.setenv(FROM_MAKE, "1")
    suggested = command_line("verify soak", "my scene.toml", {"pixel": "3,4", "stiff": True, "sim": "icarus"})
    assert suggested == "make soak SCENE='my scene.toml' PIXEL=3,4 STIFF=1 SIM=icarus"


def test_the_first_scene_of_the_readme_is_worth_seeing(tmp_path: Path):
    """Less than half of its picture is background, and floor, mirror and reflections have their own colours."""
    [text] = re.findall(r"```toml\n(.*?)```", (ROOT / "README.md").read_text(), re.DOTALL)
    (tmp_path / "mine.toml").write_text(text)
    design = design_for(tmp_path / "mine.toml", {})
    pixels = model_of(design.configuration).render(design.shown, design.configuration.screen_geometry).reshape(-1, 3)
    assert (pixels == design.scene.background).all(axis=1).mean() < 0.5
    assert len({tuple(pixel) for pixel in pixels.tolist()}) >= 6


@pytest.mark.parametrize(
    "value",
    ["x;touch bad", "$(shell touch bad)", "`touch bad`", 'it\'s  "q"', "a|b&c*", "two\nlines", "$HOME$$(x)", "#\\ a"],
)
def test_make_passes_values_on_unchanged(tmp_path: Path, value: str):
    """Neither make nor the shell expands or runs the value."""
    script = f"exec {sys.executable} -c 'import json, sys; print(json.dumps(sys.argv[4:]))' \"$@\""
    installed(tmp_path)
    write_script(tmp_path, "python", script)
    done = make("-s", "sim", f"SCENE={value}", "PYTHON=./python", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout) == [f"SCENE={value}"]
    assert not (tmp_path / "bad").exists()


def test_a_failing_line_of_a_recipe_ends_it(tmp_path: Path):
    """All lines of a recipe share a shell, which must stop at the first failure."""
    installed(tmp_path)
    write_script(tmp_path, "python", 'echo "$*"\nfalse')
    done = make("-s", "lint", "PYTHON=./python", cwd=tmp_path)
    assert (done.returncode, done.stdout) == (2, "-m ruff check\n")
