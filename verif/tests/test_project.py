# SPDX-License-Identifier: MIT
"""The project's own papers: its version stands in three places, and its hooks work."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import sysconfig
import tomllib
from pathlib import Path

from conftest import ROOT

from raycaster.registers import register_map

HOOKS = ROOT / ".pre-commit-config.yaml"


def pre_commit(*arguments: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    """Run it, with its cache and git's settings away from this user's."""
    variables = {
        "PRE_COMMIT_HOME": str(cwd / "cache"),
        "GIT_CONFIG_GLOBAL": os.devnull,
        "GIT_CONFIG_SYSTEM": os.devnull,
    }
    command = [sys.executable, "-m", "pre_commit", *arguments]
    return subprocess.run(command, cwd=cwd, env=os.environ | variables, capture_output=True, text=True, check=False)


def test_version():
    """What the register tells, what pip installs, and what the changelog has last."""
    version = register_map(1)["version"]
    told = version.unpack(version.reset)
    numbers = f"{told['major']}.{told['minor']}"
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    assert project["version"] == f"{numbers}.0"
    assert re.findall(r"^## \[(\d+\.\d+)\]", (ROOT / "CHANGELOG.md").read_text(), re.MULTILINE)[0] == numbers


def test_hooks_of_config(tmp_path: Path):
    done = pre_commit("validate-config", str(HOOKS), cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr


def test_hooks(tmp_path: Path):
    """In a repository with one good file and a bad one for each hook, without a network."""
    (tmp_path / HOOKS.name).write_text(HOOKS.read_text())
    (tmp_path / "pyproject.toml").write_text((ROOT / "pyproject.toml").read_text())
    (tmp_path / ".venv").symlink_to(Path(sysconfig.get_path("scripts")).parent, target_is_directory=True)
    files = {
        "good.py": '"""Good."""\n',
        "ruff_check.py": "import os\n",
        "ruff_format.py": '"""Bad."""\nX  =  1\n',
        "end.md": "no newline",
        "spaces.md": "spaces  \n",
        "lines.md": "carriage\r\nreturn\n",
        "broken.toml": "a = \n",
    }
    for name, text in files.items():
        (tmp_path / name).write_bytes(text.encode())
    subprocess.run(["git", "init", "-q"], cwd=tmp_path, check=True)
    subprocess.run(["git", "add", "--", *files, HOOKS.name, "pyproject.toml"], cwd=tmp_path, check=True)
    said = pre_commit("run", "--all-files", cwd=tmp_path).stdout
    for name in files:
        assert (name in said) == (name != "good.py"), said
    assert (tmp_path / "end.md").read_text() == "no newline\n"
    assert (tmp_path / "lines.md").read_bytes() == b"carriage\nreturn\n"
    assert re.search(r"no marks of a merge\.+Passed", said)
