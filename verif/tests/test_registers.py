# SPDX-License-Identifier: MIT
"""Outputs made from the register map: the C header, the page, and the constants in the Verilog."""

from __future__ import annotations

import html
import re
from pathlib import Path

import pytest
from conftest import called
from host_software import run_c
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
    includes = f'#include <stddef.h>\n#include <stdio.h>\n#include "{HEADER}"\n'
    said = run_c(tmp_path, f"{includes}int main(void) {{ {' '.join(prints)} }}\n").splitlines()
    expected = []
    for name, register in registers.items():
        expected.append(f"{name} {4 * register.address}")
        expected += [f"{name}.{field} {bits.lsb} {bits.width}" for field, bits in register.fields.items()]
    assert said == expected


def test_the_header_goes_with_the_verilog(tmp_path):
    write_verilog(configure(screen="tiny", units=1, rectangles=3, allow_underrun=True), tmp_path / "verilog")
    assert "rectangle[3];" in (tmp_path / "verilog" / HEADER).read_text()


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


@pytest.mark.parametrize("rectangles", ["33", "x"])
def test_bad_options_get_one_line(tmp_path, rectangles):
    done = called("registers", "--rectangles", rectangles, cwd=tmp_path)
    assert done.returncode == 2
    assert done.stderr.startswith("error: rectangles: ")
    assert done.stderr.count("\n") == 1
    assert not any(tmp_path.iterdir())
