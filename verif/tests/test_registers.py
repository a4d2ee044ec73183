# SPDX-License-Identifier: MIT
"""The register map's texts, and the C header made from it, with which `test_driver.py` compiles the driver."""

from __future__ import annotations

from conftest import ROOT
from systemrdl.node import RegNode

from raycaster.configuration import configure
from raycaster.convert.write import write_verilog
from raycaster.register_views import HEADER, SOFTWARE, write_header
from raycaster.registers import compile_registers

RECTANGLES = 12


def test_the_header_has_not_drifted(tmp_path):
    write_header(RECTANGLES, tmp_path / HEADER)
    assert (ROOT / SOFTWARE / HEADER).read_text() == (tmp_path / HEADER).read_text(), "outdated; run make registers"


def test_the_header_goes_with_the_verilog(tmp_path):
    write_verilog(configure(screen="tiny", units=1, rectangles=3, allow_underrun=True), tmp_path / "verilog")
    assert "rectangle[3];" in (tmp_path / "verilog" / HEADER).read_text()


def test_each_register_and_field_has_a_text():
    """All texts differ, except those of a rectangle's two corners, which share a type."""
    registers = [node for node in compile_registers(RECTANGLES).descendants() if isinstance(node, RegNode)]
    texts = {node.get_path(): node.get_property("desc") for node in registers}
    assert all(texts.values())
    assert len(set(texts.values())) == len(texts) - 1
    assert all(field.get_property("desc") for node in registers for field in node.fields())
