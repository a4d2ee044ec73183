# SPDX-License-Identifier: MIT
"""Fixtures shared by tests that simulate: output directories, and models that are built once for all of them."""

from __future__ import annotations

import contextlib
import io
import os
import re
import shutil
import subprocess
import sysconfig
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rich.console import Console
from vectors import Bench as LeafBench

from raycaster.cli.__main__ import main
from raycaster.configuration import Configuration
from raycaster.convert import digest
from raycaster.design.decide import configure
from raycaster.design.options import outside_make, run_command
from raycaster.hdl.elaboration import forgetting
from raycaster.hdl.leaf import Leaf
from raycaster.hdl.verilog_style import without_power_up
from raycaster.output import MARK
from raycaster.sim import ensure_tools
from raycaster.sim.job import Job
from raycaster.sim.simulator import MODELS_VARIABLE, VERILATOR_FLAGS, build_model, convert, find_tool, run_bench
from raycaster.verif.recording import RECORD_VARIABLE, record_test
from raycaster.verif.seeds import repeat, seed

ROOT = Path(__file__).parents[2]
BUILD = ROOT / "build"
"""Models are shared with `make sim`."""

KEPT = Path(__file__).with_name("kept")
"""Texts as they were reviewed."""

SMALL_SCENE = Path(__file__).with_name("small.toml")

FLOOR_SCENE = """
[camera]
position = [20, 256, 100]
[[rect]]
corners = [[0, 0, 0], [511, 511, 0]]
colour = "#c8c8b4"
"""
TURNED_SCENE = FLOOR_SCENE.replace("100]", "100]\nyaw = 20")
PATTERNED_SCENE = FLOOR_SCENE + 'pattern = "rows"\ncolour2 = "#000000"'

TINY = {
    "seed": configure(engine="seed", screen="tiny", units=8, rectangles=3),
    "exact": configure(engine="exact", screen="tiny", rectangles=3),
    "span": configure(engine="span", screen="tiny", rectangles=3),
}
"""Designs for the small scene, by engine, for tests to which the design does not matter."""

_LOOKS = {"screen": "tiny", "materials": True, "patterns": True, "reflections": 2}
PAGE_MODELS = {
    "plain": {"engine": "span", "screen": "tiny", "turn": True},
    "full": {"engine": "span", "turn": True, "light": True, **_LOOKS, "reflections": 4, "rectangles": 32},
    "exact": {"engine": "exact", "turn": True, "light": True, **_LOOKS},
    "seed-0": {"engine": "seed", "units": 16, "divider_bits": 3, **_LOOKS},
}
"""Options of small models for the web page, by the names of the page's own."""

Bench = Callable[..., Path]

# One store for all tests, the commands that they run and all workers, so that each model is built once.
os.environ.setdefault(MODELS_VARIABLE, str(BUILD / "model"))

FEW_CYCLES = 1500
"""Cycles of a leaf test in MyHDL if slow tests are left out."""

WITH_MYHDL = pytest.StashKey[bool]()
"""True if the leaves of a test are simulated in MyHDL too."""


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Mark slow parameter sets, and choose the set of each test whose leaves are simulated in MyHDL too.

    Raises:
        pytest.UsageError: a mark matches no set of its test, and whole files were collected.
    """
    in_myhdl: dict[str, pytest.Item] = {}
    unused: dict[tuple[str, str], bool] = {}
    for item in items:
        test, _, sets = item.nodeid.partition("[")
        for mark in item.iter_markers("slow_sets"):
            slow, quick = mark.args, mark.kwargs.get("quick", ())
            for begin in (*slow, *quick):
                unused[test, begin] = unused.get((test, begin), True) and not sets.startswith(begin)
            if sets.startswith(slow or "") and not sets.startswith(tuple(quick)):
                item.add_marker("slow")
        # The last set that is not slow.
        if test not in in_myhdl or not item.get_closest_marker("slow"):
            in_myhdl[test] = item
    for item in items:
        item.stash[WITH_MYHDL] = "/leaves/" not in item.nodeid or item is in_myhdl[item.nodeid.partition("[")[0]]
    if any(unused.values()) and not any("::" in argument for argument in config.args):
        said = ", ".join(f"{test}: {begin}" for (test, begin), of_none in unused.items() if of_none)
        raise pytest.UsageError(f"slow_sets: no parameter set begins so: {said}")


@pytest.fixture(autouse=True)
def one_set_in_myhdl(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Simulate MyHDL for one parameter set of each leaf test, or for all that are recorded; the Verilog for all.

    With all cases of the long tests, and all cycles in MyHDL, unless slow tests are left out.
    """
    recorded = RECORD_VARIABLE in os.environ
    few = not recorded and request.config.option.markexpr == "not slow"
    monkeypatch.setattr(LeafBench, "few", few)
    monkeypatch.setattr(Leaf, "most_in_myhdl", FEW_CYCLES if few else None)
    monkeypatch.setattr(Leaf, "with_myhdl", recorded or request.node.stash.get(WITH_MYHDL, True))
    monkeypatch.setattr(Leaf, "recorder", record_test if recorded else None)


@pytest.fixture(autouse=True)
def forgotten_signals() -> Iterator[None]:
    """Forget a test's signals when it ends: MyHDL would search them in later simulations, 40 times as slowly."""
    with forgetting():
        yield


@pytest.fixture(autouse=True)
def reported_seed(request: pytest.FixtureRequest) -> None:
    """Let the report of a failing test say how to repeat it with the same random numbers."""
    request.node.add_report_section("setup", "random numbers", repeat())


@pytest.fixture
def random() -> np.random.Generator:
    """Random numbers, the same for each test."""
    return np.random.default_rng(seed())


@pytest.fixture
def leaf_of(tmp_path: Path) -> Callable[..., LeafBench]:
    """Return a function that makes the bench of a block; its arguments are those of `Bench` without the directory."""
    return lambda block, config=None, **given: LeafBench(block, tmp_path, config, **given)


@pytest.fixture
def names_for_digests(monkeypatch: pytest.MonkeyPatch) -> None:
    """Do not digest designs in a test that keeps figures: the name of a design replaces the digest of its Verilog."""
    monkeypatch.setattr(digest, "digest_of", lambda configuration: configuration.name)


@pytest.fixture
def output(request: pytest.FixtureRequest) -> Path:
    """Empty directory that is kept after the test, for inspection."""
    directory = BUILD / "test" / re.sub(r"[^\w.-]+", "-", request.node.name).strip("-")
    shutil.rmtree(directory, ignore_errors=True)
    directory.mkdir(parents=True)
    return directory


@pytest.fixture
def bench(output: Path, tmp_path_factory: pytest.TempPathFactory) -> Bench:
    """Return a function that runs a cocotb bench on a design and returns the directory of its results.

    All registers and memories start unknown in Icarus, and with random values in Verilator, chosen by `start`.
    """

    def run(
        module: str,
        configuration: Configuration,
        simulator: str,
        scene: Path | str = "",
        *,
        verilog: list[Path] | None = None,
        defines: Mapping[str, int] | None = None,
        flags: Sequence[str] = VERILATOR_FLAGS,
        seeds: tuple[int, ...] = (),
        start: int = 1,
    ) -> Path:
        files = verilog or convert(configuration, BUILD)
        directory = tmp_path_factory.mktemp("unknown")
        verilog = [directory / file.name for file in files]
        for file, copy in zip(files, verilog, strict=True):
            copy.write_text(without_power_up(file.read_text()))
        model = build_model(configuration, simulator, build=BUILD, verilog=verilog, defines=defines, flags=flags)
        job = Job(
            configuration, scene=str(scene), output=str(output), reflections=configuration.most_reflections, seeds=seeds
        )
        plusargs = ("+verilator+rand+reset+2", f"+verilator+seed+{start + seed()}")
        run_bench(model, f"raycaster.{module}", job, output, plusargs=plusargs if simulator == "verilator" else ())
        return output

    return run


def called(*words: str, cwd: Path, program: Callable[[list[str]], int | None] = main) -> subprocess.CompletedProcess:
    """Run a command line in a directory, as a shell would, but in this process, where everything is loaded."""
    out, err = io.StringIO(), io.StringIO()
    with (
        contextlib.chdir(cwd),
        contextlib.redirect_stdout(out),
        contextlib.redirect_stderr(err),
        pytest.raises(SystemExit) as ended,
    ):
        run_command(lambda: program(list(words)))
    return subprocess.CompletedProcess(words, ended.value.code, out.getvalue(), err.getvalue())


def refused(program: Callable[[list[str]], int | None], *words: str, cwd: Path = Path()) -> str:
    """Call a command's function, which must fail with one line, and return the line."""
    done = called(*words, cwd=cwd, program=program)
    assert (done.returncode, done.stderr[:7], done.stderr.count("\n")) == (2, "error: ", 1), done
    return done.stderr


def refusal(directory: Path, *words: str) -> str:
    """Run a command in a directory, where it must fail with one line and change no file; return all that it prints.

    Work may have been announced before the line.
    """

    def files() -> dict[Path, int]:
        return {path: path.stat().st_mtime_ns for path in directory.rglob("*") if path.is_file() and path.name != MARK}

    before = files()
    done = called(*words, cwd=directory)
    *announced, error, end = (done.stdout + done.stderr).split("\n")
    assert (done.returncode, end) == (2, ""), done
    assert error.startswith("error: ") and error.isprintable(), done
    assert not any(line.startswith(("error", "Traceback")) for line in announced), done
    assert files() == before
    return "\n".join([*announced, error])


def compare_kept(path: Path, text: str) -> None:
    """Compare a text with the file of a reviewed one, which it replaces with `KEEP=1` in the environment."""
    if os.environ.get("KEEP"):
        path.write_text(text)
    assert text == path.read_text(), f"if {path.name} should be so, pytest with KEEP=1 in its environment keeps it"


def run_tool(directory: Path, *command: str, **variables: str) -> subprocess.CompletedProcess[str]:
    """Run a program in a directory, with all tools on the path, and return what it said on both outputs together."""
    environment = os.environ | dict(find_tool("verilator").environment)
    path = f"{sysconfig.get_path('scripts')}{os.pathsep}{environment['PATH']}"
    return subprocess.run(
        command,
        cwd=directory,
        env=environment | {"PATH": path} | variables,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )


def installed(directory: Path) -> None:
    """Let make find its files in a directory, and take everything for installed there."""
    for name in ("Makefile", "pyproject.toml", "constraints.txt"):
        shutil.copy(ROOT / name, directory)
    (directory / "raycaster").symlink_to(ROOT / "raycaster")
    (directory / ".venv").mkdir()
    for name in ("base", *re.findall(r": EXTRAS := ([\w,]+)$", (ROOT / "Makefile").read_text(), re.MULTILINE)):
        (directory / ".venv" / name).touch()


def make(*words: str, cwd: Path = ROOT) -> subprocess.CompletedProcess[str]:
    """Run make as a person would, even if another make runs the tests."""
    command = ["make", *words]
    return subprocess.run(command, cwd=cwd, env=outside_make(), capture_output=True, text=True, check=False)


def faulty(text: str, right: str, wrong: str) -> str:
    """Return a text with a fault. The right text must be there exactly once, so that no fault is lost unnoticed."""
    assert text.count(right) == 1, f"the text has {right!r} {text.count(right)} times"
    return text.replace(right, wrong)


def plant(path: Path, right: str, wrong: str) -> None:
    """Plant a fault in a file, as in `faulty`."""
    path.write_text(faulty(path.read_text(encoding="utf-8"), right, wrong), encoding="utf-8", errors="surrogateescape")


def broken(files: Iterable[Path], directory: Path, module: str, right: str, wrong: str) -> list[Path]:
    """Copy a design's Verilog into a directory, which must exist, and plant a fault in one module."""
    copies = [Path(shutil.copy(file, directory)) for file in files]
    [path] = [copy for copy in copies if copy.stem == module]
    plant(path, right, wrong)
    return copies


def write_script(directory: Path, name: str, text: str = "exit 1") -> None:
    """Write a shell script that stands for a program."""
    directory.mkdir(exist_ok=True)
    path = directory / name
    path.write_text(f"#!/bin/sh\n{text}\n")
    path.chmod(0o755)


@pytest.fixture(scope="session")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Write the web page with small models."""
    from raycaster.web.site import Model, write_site  # noqa: PLC0415 - only tests of the page need it

    output = tmp_path_factory.mktemp("site") / "web"
    models = [
        Model(name, options, draws=options["engine"] == "span", taps=options["engine"] != "span")
        for name, options in PAGE_MODELS.items()
    ]
    write_site(output, BUILD, Console(quiet=True), models=models, test=True)
    return output


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    """Page of a browser that the tests of a file share; `said` has what scripts write on the console."""
    from playwright.sync_api import sync_playwright  # noqa: PLC0415 - only tests of pages need it

    chromium = ensure_tools.find("chromium")
    if chromium is None:
        raise ensure_tools.missing("chromium")
    flags = ("--disable-gpu", "--disable-quic")
    with sync_playwright() as playwright, playwright.chromium.launch(executable_path=chromium, args=flags) as browser:
        page, errors = browser.new_page(), []
        page.set_default_timeout(60_000)
        page.said = []
        page.on("console", lambda message: page.said.append(message.text))
        page.on("pageerror", lambda error: errors.append(str(error)))
        yield page
        assert not errors, errors


@pytest.fixture
def page(browser: Any) -> Iterator[Any]:
    """Empty page, on whose console nothing may be written."""
    browser.said.clear()
    browser.goto("about:blank")
    yield browser
    assert browser.said == []


def page_state(page: Any, tab: str) -> dict:
    """Return the state of a tab of the web page once it has a result."""
    page.wait_for_function(f"RayCaster.state.{tab}?.done || RayCaster.state.{tab}?.error")
    return page.evaluate(f"RayCaster.state.{tab}")
