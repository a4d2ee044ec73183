# SPDX-License-Identifier: MIT
"""The whole design as Verilog."""

import ast
import os
import re
import subprocess
import sys
from collections import Counter
from dataclasses import replace
from pathlib import Path
from unittest.mock import Mock

import pytest

from raycaster import rtl
from raycaster.convert import write
from raycaster.convert.digest import verilog_digest
from raycaster.convert.take_home import FILE_LIST
from raycaster.convert.write import write_verilog
from raycaster.design.decide import configure
from raycaster.hdl.errors import UserError
from raycaster.output import emptied

SMALL = configure(screen="tiny", units=2, rectangles=2, fraction_bits=1, allow_underrun=True)


@pytest.mark.parametrize("units", [1, 8])
def test_a_design_is_a_module_per_file(units, tmp_path):
    """A unit is one module and many instances. In the file list, each module follows those that it instantiates.
    Headers say what and never when."""
    config = replace(SMALL, units=units)
    files = write_verilog(config, tmp_path / "verilog")
    assert (tmp_path / "verilog" / FILE_LIST).read_text().split() == [path.name for path in files]
    assert files[-1].stem == "ray_caster_module"
    instances, known, given = Counter(), set(), set()
    for path in files:
        text = path.read_text()
        assert re.findall(r"^module (\w+)", text, re.M) == [path.stem]
        used = re.findall(r"^(\w+) \w+_i \($", text, re.M)
        assert path.stem not in known and set(used) <= known, path.name
        known.add(path.stem)
        instances.update(used)
        if path.stem in ("clock_gate", "by_axis"):
            given.add(path.stem)
            assert text == Path(rtl.__path__[0], "common", path.name).read_text()
            continue
        assert text.startswith(f"// RayCaster: {path.stem}\n// Configuration: {config.name}\n")
        assert "\n// SPDX-License-Identifier: MIT\n" in text
        assert not re.search(r"\b20\d\d-|(?<!\[)\b\d\d:\d\d|MyHDL|Generated", text)
    assert (instances["ray_unit"], instances["line_buffer"], len(given)) == (units, units, 2)


def test_comments_have_numbers(tmp_path):
    """Widths and latencies in comments are numbers, also those of other blocks."""
    files = write_verilog(configure(screen="tiny", engine="span", bus="uart", baud=9600, units=2), tmp_path / "verilog")
    comments = "\n".join(re.findall("//.*", "".join(path.read_text() for path in files)))
    assert "the run at read_place 2 cycles later" in comments and "strobe, at least 9 cycles after" in comments
    assert not re.findall(r"\b[A-Za-z]+_(?:bits|latency) (?:bits|cycles)|\b[A-Z]+_(?:BITS|CYCLES|LATENCY)\b", comments)


@pytest.mark.slow
def test_any_process_writes_the_same_bytes(tmp_path):
    """MyHDL iterates over Python sets, whose order depends on the hash seed."""

    def written(number: str) -> dict[Path, bytes]:
        command = [sys.executable, "-m", "raycaster.cli", "verilog", "--output", str(tmp_path / number)]
        command += ["--screen", "tiny", "--units", "4", "--rectangles", "5", "--allow-underrun"]
        subprocess.run(command, env={**os.environ, "PYTHONHASHSEED": number}, check=True, capture_output=True)
        files = [path for path in (tmp_path / number).rglob("*") if path.is_file()]
        return {path.relative_to(tmp_path / number): path.read_bytes() for path in files}

    assert written("1") == written("2") == written("3") == written("4") != {}


def test_a_directory_is_replaced_as_a_whole(tmp_path, monkeypatch):
    """A conversion that fails leaves what was there, and one that succeeds leaves nothing of it."""
    directory = emptied(tmp_path / "verilog")
    (directory / "yesterday.v").write_text("module yesterday;")
    with monkeypatch.context() as patch, pytest.raises(UserError):
        patch.setattr(write, "convert_hierarchy", Mock(side_effect=UserError("broken")))
        write_verilog(SMALL, directory)
    assert [path.name for path in directory.glob("*.v")] == ["yesterday.v"]
    files = write_verilog(SMALL, directory)
    assert {*directory.glob("*.v")} == {*files}
    assert [path.name for path in tmp_path.iterdir()] == ["verilog"], "nothing else is left"


def test_one_block_alone_has_logic_on_the_clock():
    """A board can replace this block with a register; all other blocks use only the clock's edge."""
    users = set()
    for path in Path(rtl.__file__).parent.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            decorators = " ".join(map(ast.unparse, getattr(node, "decorator_list", ())))
            if re.match(r"always|instance", decorators) or isinstance(node, ast.Lambda):
                lines = [node.body] if isinstance(node, ast.Lambda) else node.body
                names = {name.id for line in lines for name in ast.walk(line) if isinstance(name, ast.Name)}
                users |= {path.name} & ({path.name} if "clk" in names else set())
    assert users == {"pixel_clock.py"}


KEPT_DIGESTS = {"seed": "4861fc004366988f", "exact": "8b79b98a3789f561", "span": "ea3675ae6b0538a9"}
"""Digests of the default designs' Verilog without comments, made by CPython 3.11 with PYTHONHASHSEED unset."""


@pytest.mark.parametrize("engine", KEPT_DIGESTS)
def test_any_python_writes_the_same_verilog(engine):
    digest = verilog_digest(configure(engine=engine))
    assert digest == KEPT_DIGESTS[engine], "write the new digest here if the hardware is meant to have changed"
