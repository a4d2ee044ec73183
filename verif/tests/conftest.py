# SPDX-License-Identifier: MIT
"""What the tests that simulate share: a directory of their own, and models built once for all of them."""

from __future__ import annotations

import re
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from raycaster.configuration import Configuration
from raycaster.options import run_command
from raycaster.sim.job import Job
from raycaster.sim.simulator import build_model, run_bench

ROOT = Path(__file__).parents[2]
BUILD = ROOT / "build"
"""Models are shared with `make sim`."""

SMALL_SCENE = Path(__file__).with_name("small.toml")

Bench = Callable[..., Path]


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
        seeds: tuple[int, ...] = (),
        plusargs: tuple[str, ...] = (),
    ) -> Path:
        # A broken model is a test's own: another worker would replace it.
        variant = f"broken-{output.name}" if verilog else ""
        model = build_model(configuration, simulator, build=BUILD, verilog=verilog, variant=variant)
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
