# SPDX-License-Identifier: MIT
"""Project metadata: the version agrees in three places, and dependencies point one way."""

from __future__ import annotations

import ast
import importlib.metadata
import re
import shutil
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import pytest
from conftest import ROOT

from raycaster.registers import register_map
from raycaster.rtl.engines import ENGINES

MAY_IMPORT = {
    "hdl": (),
    "raycaster": ("hdl",),
    "scenes": (),
    "runs": ("raycaster",),
    "golden": ("raycaster",),
    "rtl": ("hdl", "raycaster"),
    "design": ("hdl", "raycaster", "runs", "rtl"),
    "cli": ("raycaster", "runs", "golden", "rtl", "design"),
    "sw": ("raycaster", "runs", "design"),
    "fit": ("raycaster", "golden", "design"),
    "convert": ("hdl", "raycaster", "runs", "rtl", "design", "fit"),
    "fpga": ("hdl", "raycaster", "runs", "golden", "rtl", "design", "sw", "fit", "convert"),
    "sim": ("hdl", "raycaster", "runs", "golden", "rtl", "design", "fit", "convert", "fpga"),
    "debug": ("hdl", "raycaster", "golden", "rtl", "design", "fit", "convert", "sim"),
    "play": ("raycaster", "runs", "golden", "rtl", "design", "sw", "convert", "sim"),
    "web": ("raycaster", "runs", "golden", "rtl", "design", "sw", "fpga", "sim", "debug", "play"),
    "verif": ("hdl", "raycaster", "runs", "golden", "rtl", "design", "fit", "convert", "fpga", "sim"),
    "report": ("raycaster", "runs", "golden", "rtl", "design", "convert", "fpga", "sim", "verif"),
    "docs": (
        "hdl", "raycaster", "runs", "golden", "rtl", "design", "cli", "convert", "fpga", "sim", "debug", "web", "verif",
        "report",
    ),
}  # fmt: skip
"""Other folders that each folder may import from, without direct or indirect cycles."""

MAY_IMPORT_IN_RTL = {
    "common": (),
    "dvi": (),
    "scene": ("common",),
    "video": ("common",),
    "bus": ("common", "scene"),
    "engine": ("common",),
    "cull": ("common", "engine"),
    "buffered": ("common", "video", "engine", "cull"),
    **dict.fromkeys(ENGINES, ("common", "video", "engine", "buffered")),
    "engines.py": ("engine", "buffered", *ENGINES),
    "system": ("common", "dvi", "scene", "bus", "engines.py"),
}
"""Other folders of rtl/, and the list of engines, that each of them there may import from."""


def test_version():
    """The version register, the installed package and the latest changelog entry agree."""
    version = register_map(1)["version"]
    fields = version.unpack(version.reset)
    numbers = f"{fields['major']}.{fields['minor']}"
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    assert importlib.metadata.version("raycaster") == project["version"] == f"{numbers}.0"
    assert re.findall(r"^## \[(\d+\.\d+)\]", (ROOT / "CHANGELOG.md").read_text(), re.MULTILINE)[0] == numbers


LINKED = "docs", "fpga", "golden", "rtl", "sw", "verif"
"""Folders at the top that are linked into the package."""

ORDERS = {"": MAY_IMPORT, "rtl": MAY_IMPORT_IN_RTL}


def imported_folders(path: Path, inside: str) -> set[str]:
    """Return the folders, inside of a folder of this project or of all of it, that a file imports from."""
    names = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            names |= {f"{node.module}.{alias.name}" for alias in node.names}
    start = f"raycaster.{inside}." if inside else "raycaster."
    found = {name.removeprefix(start).split(".")[0] for name in names if f"{name}.".startswith(start)}
    # A file, not a folder, belongs to the package itself, unless it is listed.
    listed, own = ORDERS[inside], inside or "raycaster"
    return {next((one for one in (name, f"{name}.py") if one in listed), own) for name in found}


def files_of(folder: str, inside: str = "") -> list[Path]:
    """Return the Python files of a folder, without those of the folders in it that are listed, and without tests."""
    home = ROOT / "raycaster" / inside / ("" if folder == "raycaster" else folder)
    if home.suffix:
        return [home]
    others = {ROOT / "raycaster" / name for name in MAY_IMPORT} if folder == "raycaster" else {home / "tests"}
    return [path for path in home.rglob("*.py") if not others & {*path.parents}]


@pytest.mark.parametrize(("inside", "folder"), [(inside, folder) for inside in ORDERS for folder in ORDERS[inside]])
def test_dependencies_point_one_way(inside, folder):
    """A folder imports only from folders that are listed before it. Tests may import everything."""
    listed, allowed = list(ORDERS[inside]), ORDERS[inside][folder]
    assert set(allowed) <= set(listed[: listed.index(folder)])
    assert files_of(folder, inside)
    for path in files_of(folder, inside):
        assert imported_folders(path, inside) <= {folder, *allowed}, path


def asked_names(path: Path) -> list[str]:
    """Return the lines of a file that compare something with an engine's name, or have a table keyed by such names."""
    asked = []
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Compare):
            texts, most = [node.left, *node.comparators], 0
        elif isinstance(node, ast.Dict):
            texts, most = node.keys, 1  # a single name may mean something else, such as a seed
        else:
            continue
        if sum(isinstance(text, ast.Constant) and text.value in ENGINES for text in texts) > most:
            asked.append(f"{path}:{node.lineno}")
    return asked


def test_nothing_outside_an_engine_asks_for_its_name():
    """An engine's abilities are its properties. Tests may ask for names."""
    files = [path for folder in MAY_IMPORT for path in files_of(folder)]
    outside = [path for path in files if path.parent.name not in ENGINES]
    assert [line for path in outside for line in asked_names(path)] == []


def test_each_folder_is_listed_and_linked():
    """An import of raycaster.golden finds golden/, in an editor too."""
    folders = {path.parent.name for path in (ROOT / "rtl").glob("*/__init__.py")}
    assert folders | {"engines.py"} == set(MAY_IMPORT_IN_RTL)
    links = {path.name: path.readlink() for path in (ROOT / "raycaster").iterdir() if path.is_symlink()}
    assert links == {folder: Path("..", folder) for folder in LINKED}
    assert {path.name for path in (ROOT / "raycaster").iterdir() if path.is_dir()} - {"__pycache__"} == {
        *MAY_IMPORT
    } - {"raycaster"}


@pytest.mark.parametrize("folder", ["rtl", "golden", "fpga"])
def test_each_module_has_one_name(folder):
    """What is imported as raycaster.rtl cannot be imported as rtl too, even where the clone is on Python's path."""
    command = [sys.executable, "-c", f"import {folder}"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert f"ImportError: {folder} is a part of raycaster; import raycaster.{folder}" in done.stderr


def test_the_wheel_has_every_file(tmp_path: Path):
    """The wheel has every module and every file that code reads from its folder, but no tests."""
    tracked = subprocess.run(
        ["git", "ls-files", "raycaster", *LINKED], cwd=ROOT, capture_output=True, text=True, check=True
    )
    names = {name for name in tracked.stdout.split() if not name.startswith("verif/tests/")}
    wanted = {name for name in names if not (ROOT / name).is_symlink()}
    for name in names | {"pyproject.toml", "README.md", "LICENSE"}:
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, tmp_path / name, follow_symlinks=False)
    (tmp_path / "verif" / "tests" / "leaves" / "span").mkdir(parents=True)
    for name in ("data.toml", "conftest.py", "leaves/data.toml", "leaves/vectors.py", "leaves/span/test_look_up.py"):
        (tmp_path / "verif" / "tests" / name).touch()
    command = [sys.executable, "-c", "import setuptools; setuptools.setup()", "-q", "bdist_wheel", "-d", "wheel"]
    subprocess.run(command, cwd=tmp_path, check=True, capture_output=True)
    [wheel] = (tmp_path / "wheel").glob("*.whl")
    with zipfile.ZipFile(wheel) as archive:
        names = {name for name in archive.namelist() if ".dist-info/" not in name}
    assert names == {name if name.startswith("raycaster/") else f"raycaster/{name}" for name in wanted}
