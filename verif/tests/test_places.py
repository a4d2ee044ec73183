# SPDX-License-Identifier: MIT
"""Odd places and environments: what users have works, or one line names what is odd before anything is made there."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import ROOT, called, make

from raycaster.design.options import FROM_MAKE
from raycaster.errors import UserError
from raycaster.places import clone_complaint, links_complaint
from raycaster.sim import simulator
from raycaster.sim.simulator import MODELS_VARIABLE

CLONES = {
    "my projects": "a space", "it's": "an apostrophe", "a$x": "a dollar sign", 'a"b': "a quotation mark", "a\\b": "\\",
    "100%": "%", "a:b": ":", "a;b": ";", "two\nlines": "a line's end", "tab\t": "\\t", "old\udcff": "not UTF-8",
}  # fmt: skip
"""Names of a clone's folder that are refused, and the name of the character in the message."""


@pytest.mark.parametrize("name", CLONES)
def test_make_refuses_a_folder_before_it_installs(tmp_path: Path, name: str):
    clone = tmp_path / name
    (clone / "raycaster").mkdir(parents=True)
    for file in ("Makefile", "pyproject.toml", "constraints.txt", "raycaster/places.py"):
        shutil.copy(ROOT / file, clone / file)
    (clone / "raycaster" / "cli").symlink_to(ROOT / "raycaster" / "cli")
    done = make("sim", f"PYTHON3={sys.executable}", cwd=clone)
    error = done.stderr.splitlines()[0]
    assert error.startswith("error: ") and f"the path has {CLONES[name]}" in error.replace("a byte that is ", "")
    assert not (clone / ".venv").exists()


@pytest.mark.parametrize("name", ["projects", "raycaster-1.0", "schön", "日本", "a+b=c,d@e~1"])
def test_other_folders_are_good(name: str):
    assert clone_complaint(Path("/home/me") / name) == ""


def test_make_from_elsewhere_is_one_line(tmp_path: Path):
    done = make("-f", str(ROOT / "Makefile"), "sim", cwd=tmp_path)
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)
    assert f"make must run in the folder of {ROOT}/Makefile" in " ".join(done.stderr.split())


def test_a_copy_without_links_is_not_installed(tmp_path: Path):
    """Such as from a ZIP file; pip and make say which links are lost. What pip itself packs has folders instead."""
    (tmp_path / "raycaster").mkdir()
    for file in ("setup.py", "pyproject.toml", "README.md", "raycaster/places.py", "rtl/__init__.py"):
        (tmp_path / file).parent.mkdir(exist_ok=True)
        shutil.copy(ROOT / file, tmp_path / file)
    build = [sys.executable, "-c", "from setuptools import build_meta; build_meta.get_requires_for_build_wheel()"]
    for lost in (lambda link: None, lambda link: link.write_text("../rtl")):
        lost(tmp_path / "raycaster" / "rtl")
        assert links_complaint(tmp_path).endswith("git clone -c core.symlinks=true")
        done = subprocess.run(build, cwd=tmp_path, capture_output=True, text=True, check=False)
        *_, error = done.stderr.splitlines()
        assert done.returncode and error.startswith("error: ") and "rtl: must be symbolic links" in error, done.stderr
    assert links_complaint(ROOT) == ""
    (tmp_path / "raycaster" / "rtl").unlink()
    (tmp_path / "raycaster" / "rtl").mkdir()
    assert links_complaint(tmp_path) == ""


def test_the_program_reports_lost_links(tmp_path: Path):
    shutil.copytree(ROOT / "raycaster", tmp_path / "raycaster", symlinks=True)
    for link in filter(Path.is_symlink, (tmp_path / "raycaster").iterdir()):
        link.unlink()
        (tmp_path / link.name).mkdir()
        (tmp_path / link.name / "__init__.py").touch()
    options = [sys.executable, "-m", "raycaster.cli", "options"]
    done = subprocess.run(options, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1), done.stderr
    assert done.stderr.startswith("error: ") and done.stderr.endswith("git clone -c core.symlinks=true\n")


ODD = "it's my $x é%(1);&#*?[a]{b}!`~=,<|>"
"""Name of a directory in which all that users run works."""


@pytest.mark.slow_sets("verilator")
@pytest.mark.parametrize("tool", ["icarus", "verilator"])
def test_a_working_directory_may_have_odd_characters(tmp_path: Path, tool: str, monkeypatch):
    monkeypatch.delenv(MODELS_VARIABLE)
    directory = tmp_path / ODD
    directory.mkdir()
    shutil.copy(ROOT / "verif/tests/small.toml", directory / f"{ODD[:-3]}.toml")
    words = ["--screen", "tiny", "--engine", "exact", "--rectangles", "3", "--simulator"]
    done = called("sim", f"{ODD[:-3]}.toml", *words, tool, cwd=directory)
    assert (done.returncode, "0 of " in done.stdout) == (0, True), done


@pytest.mark.parametrize(("name", "found"), [("a\\b", "\\"), ('a"b', "a quotation mark"), ("a\nb", "a line's end")])
def test_a_directory_in_which_tools_fail_is_refused(tmp_path: Path, name: str, found: str):
    with pytest.raises(UserError, match="the path has") as error, simulator.made(tmp_path / name, "model", (), ()):
        pass
    assert f"the path has {found}" in str(error.value)
    assert not any(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("said", "free", "complaint"),
    [
        ("/usr/bin/ld: final link failed: No space left on device", 1 << 30, "no space left on device"),
        ("cc1plus: error writing to x.s: Disk quota exceeded", 1 << 30, "disk quota exceeded"),
        ("", 0, "no space left on device"),
        ("g++: fatal error: Killed signal terminated program cc1plus", 1 << 30, "too little memory"),
        ("fatal error: zlib.h: No such file or directory", 1 << 30, "header zlib.h is missing"),
    ],
)
def test_a_failed_build_names_its_cause(tmp_path: Path, monkeypatch, said: str, free: int, complaint: str):
    monkeypatch.setattr(shutil, "disk_usage", lambda place: shutil._ntuple_diskusage(1 << 40, 0, free))
    log = tmp_path / "model.log"
    log.write_text(said)
    error = simulator._build_failure("model", "verilator", log)
    assert isinstance(error, UserError) and complaint in str(error) and str(log) in str(error)


def test_a_failed_build_without_a_known_cause_has_its_log(tmp_path: Path):
    (tmp_path / "model.log").write_text("error: expected ';'")
    assert isinstance(simulator._build_failure("model", "verilator", tmp_path / "model.log"), simulator.SimulationError)


def program(*words: str, **variables: str) -> subprocess.CompletedProcess[str]:
    """Run Python with these arguments, as a service manager does, with only these environment variables."""
    environment = {"PYTHONPATH": str(ROOT)} | variables
    return subprocess.run([sys.executable, *words], env=environment, capture_output=True, text=True, check=False)


@pytest.mark.parametrize("words", [["-O", "-m", "raycaster.cli"], ["-OO", "-m", "raycaster.cli"]])
def test_python_without_checks_or_texts_is_refused(words: list[str]):
    done = program(*words, "options")
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)
    assert "PYTHONOPTIMIZE leave out checks, and texts" in done.stderr


@pytest.mark.parametrize("name", ["picture_frame", "amaranth_picture_frame", "litex_soc", "fifo/fifo"])
def test_an_example_without_arguments_prints_its_usage(name: str):
    done = program(str(ROOT / "examples" / f"{name}.py"), PATH=os.environ["PATH"])
    assert (done.returncode, done.stderr[:6], "Traceback" in done.stderr) == (2, "usage:", False)


def test_what_make_does_not_take_may_be_in_the_environment(tmp_path, monkeypatch):
    """Neither do options count that are given, or that a program started by this one inherits."""
    monkeypatch.setenv(FROM_MAKE, "1")
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setenv("ENGINE", "span")
    words = "ENGINE=exact", "SCREEN=tiny", "RECTANGLES=1", f"OUTPUT={tmp_path / 'verilog'}"
    assert called("verilog", *words, cwd=tmp_path).returncode == 0
    assert called("verilog", *words[1:], cwd=tmp_path).returncode == 0
