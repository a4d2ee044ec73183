# SPDX-License-Identifier: MIT
"""Outputs made from the register map: the C header, the page, and the constants in the Verilog."""

from __future__ import annotations

import html
import json
import re
import shutil
import subprocess
from pathlib import Path

import pytest
from conftest import called
from systemrdl.node import RegNode

from raycaster.configuration import configure
from raycaster.convert.write import write_verilog
from raycaster.register_views import HEADER, SOFTWARE, write_header, write_page
from raycaster.registers import SOURCE, compile_registers, register_map

ROOT = Path(__file__).parents[2]
RECTANGLES = 12


def test_the_header_has_not_drifted(tmp_path):
    write_header(RECTANGLES, tmp_path / HEADER)
    assert (ROOT / SOFTWARE / HEADER).read_text() == (tmp_path / HEADER).read_text(), "outdated; run make registers"


def test_drift_is_noticed(tmp_path, monkeypatch):
    moved = tmp_path / SOURCE.name
    text = SOURCE.read_text()
    assert "run[0:0]" in text
    moved.write_text(text.replace("run[0:0]", "run[2:2]"))
    monkeypatch.setattr("raycaster.registers.SOURCE", moved)
    with pytest.raises(AssertionError, match="make registers"):
        test_the_header_has_not_drifted(tmp_path)


@pytest.mark.parametrize("rectangles", [1, RECTANGLES, 32])
def test_c_finds_every_register_and_field(tmp_path, rectangles):
    """A C program that includes the header prints where everything is."""
    registers = register_map(rectangles)
    write_header(rectangles, tmp_path / HEADER)
    prints = []
    for name, register in registers.items():
        prints.append(f'printf("{name} %zu\\n", offsetof(ray_caster_t, {name}));')
        kind = re.sub(r"\[\d+\]|(?<=corner)_\d", "", name).replace(".", "__").upper()
        for field in register.fields:
            macro = f"RAY_CASTER__{kind}__{field.upper()}"
            prints.append(f'printf("{name}.{field} %u %u\\n", (unsigned){macro}_bp, (unsigned){macro}_bw);')
    program = tmp_path / "where.c"
    lines = "\n    ".join(prints)
    includes = f'#include <stddef.h>\n#include <stdio.h>\n#include "{HEADER}"\n'
    program.write_text(f"{includes}int main(void) {{\n    {lines}\n}}\n")
    compiler = shutil.which("gcc") or shutil.which("cc")
    subprocess.run([compiler, "-std=gnu11", "-Wall", "-Werror", "where.c", "-o", "where"], cwd=tmp_path, check=True)
    said = subprocess.run([tmp_path / "where"], capture_output=True, text=True, check=True).stdout.splitlines()
    expected = []
    for name, register in registers.items():
        expected.append(f"{name} {4 * register.address}")
        expected += [f"{name}.{field} {bits.lsb} {bits.width}" for field, bits in register.fields.items()]
    assert said == expected


def test_the_header_goes_with_the_verilog(tmp_path):
    write_verilog(configure(screen="tiny", units=1, rectangles=3, allow_underrun=True), tmp_path / "verilog")
    assert "rectangle[3];" in (tmp_path / "verilog" / HEADER).read_text()


def test_the_page_knows_every_register_and_field(tmp_path):
    """The page's data have every offset and all bits, with one rectangle standing for all."""
    nodes = json.loads((write_page(RECTANGLES, tmp_path / "page").parent / "data" / "ral-data-0.json").read_text())
    found = {}
    for node in nodes:
        owner = nodes[node["parent"]] if node["parent"] else {"name": "", "offset": "0"}
        bits = {field["name"]: (field["lsb"], field["msb"]) for field in node.get("fields", ())}
        if bits:
            place = int(node["offset"], 16) + int(owner["offset"], 16)
            found[f"{owner['name']}[0].{node['name']}" if owner["name"] else node["name"]] = place, bits
    wanted = {
        name: (4 * register.address, {field: (b.lsb, b.lsb + b.width - 1) for field, b in register.fields.items()})
        for name, register in register_map(1).items()
    }
    assert found == wanted


def test_the_page_has_every_text(tmp_path):
    page = write_page(RECTANGLES, tmp_path / "page")
    text = " ".join(html.unescape(path.read_text()) for path in page.parent.rglob("*.html"))
    words = " ".join(re.sub(r"<[^>]*>", " ", text).split())
    descriptions = re.findall(r'desc = "(.*?)"', SOURCE.read_text(), re.S)
    assert len(descriptions) > 30
    for description in descriptions:
        assert " ".join(description.split()) in words


def test_each_register_and_field_has_a_text():
    """All texts differ, except those of a rectangle's two corners, which share a type."""
    registers = [node for node in compile_registers(RECTANGLES).descendants() if isinstance(node, RegNode)]
    texts = {node.get_path(): node.get_property("desc") for node in registers}
    assert all(texts.values())
    assert len(set(texts.values())) == len(texts) - 1
    assert all(field.get_property("desc") for node in registers for field in node.fields())
    shadowed = {node.inst_name for node in registers if node.get_property("desc").startswith("Shadowed")}
    assert shadowed == {
        "control", "background", "camera", "forward", "right", "up", "light", "corner_0", "corner_1", "surface",
        "pattern",
    }  # fmt: skip


def test_the_verilog_decodes_what_the_map_says(tmp_path):
    config = configure(engine="exact", turn=True, light=True, screen="tiny", units=1, rectangles=3, allow_underrun=True)
    write_verilog(config, tmp_path / "verilog")
    text = "".join((tmp_path / "verilog" / f"{name}.v").read_text() for name in ("avalon_interface", "camera_mem"))
    found = {
        name: int(value)
        for name, value in re.findall(r"^localparam \[\d+:0\] (\w+)_address = \d+'d(\d+);$", text, re.M)
    }
    single = {name: register.address for name, register in register_map(3).items() if "." not in name}
    assert found == single


@pytest.mark.parametrize(
    ("options", "complaint"),
    [(("--rectangles", "33"), "error: rectangles: "), (("--rectangles", "x"), "error: rectangles: ")],
)
def test_bad_options_get_one_line(tmp_path, options, complaint):
    done = called("registers", *options, cwd=tmp_path)
    assert done.returncode == 2
    assert done.stderr.startswith(complaint)
    assert done.stderr.count("\n") == 1
    assert not any(tmp_path.iterdir())
