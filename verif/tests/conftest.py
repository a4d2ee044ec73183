# SPDX-License-Identifier: MIT
"""What the tests that simulate share: a directory of their own, and models built once for all of them."""

from __future__ import annotations

import os
import re
import shutil
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

import pytest

from raycaster.configuration import Configuration
from raycaster.convert.elaboration import forgetting
from raycaster.options import run_command
from raycaster.sim.job import Job
from raycaster.sim.simulator import MODELS_VARIABLE, build_model, run_bench

ROOT = Path(__file__).parents[2]
BUILD = ROOT / "build"
"""Models are shared with `make sim`."""

SMALL_SCENE = Path(__file__).with_name("small.toml")

Bench = Callable[..., Path]

# One store for all tests, for the commands that they run, and for both workers: what one has built all have.
os.environ.setdefault(MODELS_VARIABLE, str(BUILD / "model"))

SLOW = Path(__file__).with_name("slow.txt")


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Mark what `slow.txt` names, and refuse a line of it that is about no test of the files that were collected."""
    lines = [line for line in SLOW.read_text().splitlines() if not line.startswith("#")]
    names = {item: item.nodeid.rpartition("verif/tests/")[2] for item in items}
    for item, name in names.items():
        said = [line for line in lines if name.startswith(line.lstrip("!"))]
        if said and not said[-1].startswith("!"):
            item.add_marker("slow")
    if not any("::" in argument for argument in config.args):
        files = {name.partition("::")[0] for name in names.values()}
        for line in lines:
            of_it = line.lstrip("!")
            if of_it.partition("::")[0] in files and not any(name.startswith(of_it) for name in names.values()):
                raise pytest.UsageError(f"{SLOW.name}: no test begins with {of_it}")


@pytest.fixture(autouse=True)
def forgotten_signals() -> Iterator[None]:
    """Those of a test end with it: MyHDL would look at them in each later simulation, which took 40 times as long."""
    with forgetting():
        yield


@pytest.fixture
def output(request: pytest.FixtureRequest) -> Path:
    """An empty directory that outlives the test, for a person to look into."""
    directory = BUILD / "test" / re.sub(r"[^\w.-]+", "-", request.node.name).strip("-")
    shutil.rmtree(directory, ignore_errors=True)
    directory.mkdir(parents=True)
    return directory


@pytest.fixture
def bench(output: Path) -> Bench:
    """Runs a cocotb bench on a design and returns the directory of its results; fails where the bench does."""

    def run(
        module: str,
        configuration: Configuration,
        simulator: str,
        scene: Path | str = "",
        *,
        verilog: list[Path] | None = None,
        defines: Mapping[str, int] | None = None,
        seeds: tuple[int, ...] = (),
        plusargs: tuple[str, ...] = (),
    ) -> Path:
        model = build_model(configuration, simulator, build=BUILD, verilog=verilog, defines=defines)
        job = Job(
            configuration, scene=str(scene), output=str(output), reflections=configuration.reflections, seeds=seeds
        )
        run_bench(
            model,
            f"raycaster.{module}",
            job,
            output,
            plusargs=plusargs,
        )
        return output

    return run


@pytest.fixture
def refuses(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Callable[..., str]:
    """Runs a command's body that must end with one line on standard error, which it returns."""

    def refused(main: Callable[[], int | None], *options: str) -> str:
        monkeypatch.setattr("sys.argv", ["command", *options])
        with pytest.raises(SystemExit) as ended:
            run_command(main)
        assert ended.value.code == 2
        error = capsys.readouterr().err
        assert error.startswith("error: ")
        assert error.count("\n") == 1
        return error

    return refused


@pytest.fixture
def scenes() -> Path:
    """The directory of scene files."""
    return ROOT / "scenes"
