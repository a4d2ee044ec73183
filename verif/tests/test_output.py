# SPDX-License-Identifier: MIT
"""Output of commands: user files are never removed, text is shown literally, and system errors are one line."""

from __future__ import annotations

import errno
import os
import re
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import SMALL_SCENE, called, refusal, refused

from raycaster import output
from raycaster.output import emptied, printable, replaced
from raycaster.scene import load_scene

HOSTILE = "[bold]x[/nope]\x1b[31m :smile: [link=http://x]y\x9b2J\u202e\nz"
"""A two-line name with broken markup and control sequences."""

ESCAPED = r"[bold]x[/nope]\x1b[31m :smile: [link=http://x]y\x9b2J\u202e\nz"

FULL = "No space left on device; free some space, or choose another place for the output"


def raycaster(*words: str, cwd: Path, **options: object) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "raycaster.cli", *words]
    return subprocess.run(command, cwd=cwd, check=False, **({"capture_output": True, "text": True} | options))


@pytest.fixture
def hostile_scene(tmp_path: Path) -> Path:
    """Return a scene file whose title and first rectangle are named `HOSTILE`."""
    name = "".join(f"\\u{ord(one):04x}" for one in HOSTILE)
    title, floor = (f'{key} = "{name}"' for key in ("title", "name"))
    lines = SMALL_SCENE.read_text().splitlines()
    lines = [title if line.startswith("title") else floor if line == 'name = "floor"' else line for line in lines]
    path = tmp_path / "[bold]hostile[x].toml"
    covered = ["[[rect]]", floor, "corners = [[0, 100, 0], [9, 109, 0]]", 'colour = "#000000"']
    path.write_text("\n".join([*lines, *covered]))
    scene = load_scene(path)
    assert scene.title == scene.rect[0].name == HOSTILE
    return path


def test_only_what_a_command_made_is_removed(tmp_path: Path):
    made = emptied(tmp_path / "made")
    (made / "old").touch()
    assert not (emptied(made) / "old").exists()
    with replaced(made) as filled:
        (filled / "new").touch()
    assert {path.name for path in made.iterdir()} == {"new", output.MARK}

    kept = tmp_path / "kept"
    kept.mkdir()
    emptied(kept)  # there was nothing in it
    (kept / output.MARK).unlink()
    (kept / "thesis").touch()
    (tmp_path / "link").symlink_to(made)
    for name in ("kept", "link", "kept/thesis", "..", ".", "made/.."):
        with pytest.raises(output.UserError):
            emptied(tmp_path / name)
        with pytest.raises(output.UserError), replaced(tmp_path / name):
            raise AssertionError("it must be refused before anything is lost")
    assert (kept / "thesis").exists()
    assert (made / "new").exists()


@pytest.mark.parametrize("name", ["...toml", "..toml", "a\x1b[31m.toml", "a\nb.toml", "a\udcff.toml"])
@pytest.mark.parametrize("command", ["sim", "trace PIXEL=1,1", "verilog FIX=all", "game FRAMES=1"])
def test_a_scene_file_has_a_name_for_its_outputs(tmp_path: Path, name: str, command: str):
    (tmp_path / name).write_text(SMALL_SCENE.read_text())
    (tmp_path / "build" / "sim").mkdir(parents=True)
    (tmp_path / "build" / "thesis").touch()
    word, *options = command.split()
    reason = "has a name that is not UTF-8" if "\udcff" in name else "expected a name"
    assert refusal(tmp_path, word, name, *options).startswith(f"error: {printable(name)}: {reason}")


def test_text_is_shown_as_it_is():
    assert printable(HOSTILE) == ESCAPED
    assert printable("ä 語 [x]") == "ä 語 [x]"
    assert printable("a\nb\x07\udcff", lines=True) == "a\nb\\x07\\xff"


@pytest.mark.slow_sets("trace")
@pytest.mark.parametrize(
    "words",
    [
        ("trace", "PIXEL=32,40", "SCREEN=tiny", "UNITS=16", "RECTANGLES=4", "SIM=icarus"),
        ("verilog", "--fix", "all", "--output", "[/nope]"),
        ("game", "ROWS=240x[/nope]"),
        ("fit", "--error", "[/nope]\x1b"),
        ("bitstream", "--board", "[/nope]\x1b"),
        ("area", "--only", "[/nope]\x1b"),
        ("[/nope]\x1b",),
    ],
    ids=lambda words: words[0],
)
def test_commands_show_text_as_it_is(hostile_scene: Path, words: tuple[str, ...]):
    """No command that takes a name or a path shows a traceback or sends a control character to the terminal."""
    done = called(*words[0].split(), hostile_scene.name, *words[1:], cwd=hostile_scene.parent)
    said = done.stdout + done.stderr
    assert said
    assert "Traceback" not in said
    assert all(line.isprintable() for line in said.splitlines()), said
    if words[0] == "trace":
        assert done.returncode == 0, said
        assert ESCAPED in done.stdout
        assert hostile_scene.name in done.stdout
    if words[0] == "verilog":
        assert "[bold]x[/nope]" in done.stdout  # the table wraps the rest


def test_a_full_disk(tmp_path: Path, monkeypatch):
    """The directory stays unchanged, and nothing else is left."""
    kept = emptied(tmp_path / "kept")
    (kept / "old").touch()

    def write() -> None:
        with replaced(kept):
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    assert refused(lambda words: write()) == f"error: {kept}: {FULL}\n"
    assert (kept / "old").exists()
    assert [path.name for path in tmp_path.iterdir()] == ["kept"]


@pytest.mark.parametrize(("words", "unbuffered"), [("scenes", ""), ("scenes", "1"), ("--help", "1")])
def test_standard_output_that_takes_nothing(words: str, unbuffered: str, tmp_path: Path):
    """Writing fails at once, or when buffered text is flushed, which Python itself does once more when it ends."""
    reader, writer = os.pipe()
    os.close(reader)
    environment = os.environ | {"PYTHONUNBUFFERED": unbuffered}
    given = {"cwd": tmp_path, "env": environment, "capture_output": False, "stderr": subprocess.PIPE}
    with open("/dev/full", "w") as full:
        done = raycaster(words, stdout=full, **given)
    assert done.returncode == 2
    assert re.fullmatch(f"error: (standard )?output: {FULL}\n", done.stderr)
    done = raycaster(words, stdout=writer, **given)
    os.close(writer)
    assert (done.returncode, done.stderr) == (128 + signal.SIGPIPE, "")
    done = raycaster(words, preexec_fn=lambda: os.close(1), **given)
    assert (done.returncode, done.stderr) == (0, "")


def test_a_terminal_without_the_character(tmp_path: Path):
    done = raycaster("sim", "größe", cwd=tmp_path, env=os.environ | {"PYTHONIOENCODING": "ascii"})
    assert done.returncode == 2
    assert done.stderr.startswith(r"error: gr\xf6\xdfe: no such file")
