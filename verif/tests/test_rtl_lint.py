# SPDX-License-Identifier: MIT
"""Lint of the hardware's sources: the sources are clean, and each rule catches its faults."""

import ast
import re
import subprocess
import sys
from pathlib import Path
from textwrap import indent

import pytest

import raycaster.rtl
from raycaster.errors import UserError
from raycaster.hdl.lint import Finding, check, main, processes

RTL = Path(raycaster.rtl.__path__[0])

BLOCK = '''
from myhdl import always, always_comb, always_seq, block, instance, intbv
from raycaster.rtl.common.widths import WORD_BITS
from raycaster.hdl.signals import bit, unsigned


@block
def planted(clk, a, b, result, memory, config: Configuration, gain=2):
    """A block's own docstring is welcome."""
    width = len(result)
    lines, last = config.lines, width - 1
    halves = [result(4, 0), result(8, 4)]
    total = unsigned(width)

    # What it does.
    @{decorator}
    def process():
{body}

    return (process,)
'''


def findings(tmp_path: Path, body: str, decorator: str = "always_comb") -> list[Finding]:
    source = tmp_path / "planted.py"
    source.write_text(BLOCK.format(body=indent(body, " " * 8), decorator=decorator))
    return check(source)


@pytest.mark.slow
def test_the_hardware_is_clean():
    files = sorted(RTL.rglob("*.py"))
    assert len(files) > 20
    assert [finding for path in files for finding in check(path)] == []


def test_one_block_alone_has_logic_on_the_clock():
    """A board can replace this block with a register; all other blocks use only the clock's edge."""
    users = []
    for path in sorted(RTL.rglob("*.py")):
        made = processes(ast.parse(path.read_text()))
        names = [node for one in made for line in one.body for node in ast.walk(line) if isinstance(node, ast.Name)]
        if any(name.id == "clk" for name in names):
            users.append(path.name)
    assert users == ["pixel_clock.py"]


@pytest.mark.parametrize(
    ("body", "rule"),
    [
        ("result.next = max(a, b)", "call"),
        ("result.next = min(a, b)", "call"),
        ("result.next = abs(a)", "call"),
        ("result.next = blend(a, b)", "call"),
        ("result.next = config.blend(a)", "call"),
        ("result.next = sum([a, b])", "call"),
        ("if (a + b) > last:\n    result.next = 0", "arithmetic"),
        ("result.next = a + b > 3", "arithmetic"),
        ("result.next = (a + b) >> 1", "arithmetic"),
        ("result.next = a + b + 1", "arithmetic"),
        ("result.next = a + b * gain", "arithmetic"),
        ("result.next = a - (-b)", "arithmetic"),
        ("result.next = (a + b) % last", "arithmetic"),
        ("result.next = (a + b + 1) % (1 << width)", "arithmetic"),
        ("result.next = (a + b) % (1 << width) + 1", "arithmetic"),
        ("result.next = (a + b) & 3", "arithmetic"),
        ("result.next = concat(a + b, a)", "arithmetic"),
        ("result.next = intbv(a - b)", "arithmetic"),
        ("result.next = memory[a - b]", "arithmetic"),
        ("result.next[a + b] = 1", "arithmetic"),
        ("result.next = a if a + b else b", "arithmetic"),
        ("result.next = halves[0] + halves[1] + total", "arithmetic"),
        ("while a - b:\n    result.next = 0", "arithmetic"),
        ("for i in range(4):\n    if a + i == b:\n        result.next = i", "arithmetic"),
        ("if a:\n    if b:\n        result.next = 0\n    elif (a << 1) == b:\n        result.next = 1", "arithmetic"),
        ("result.next = (a & b)[4:]", "slice"),
        ("result.next = concat(a, b)[4:]", "slice"),
        ("result.next = (a + b)[0]", "slice"),
        ('"""Its purpose."""\nresult.next = a', "docstring"),
        ("if a:\n    return\nresult.next = b", "return"),
        ("def helper(c):\n    pass\nresult.next = a", "call"),
        ("result.next = [a, b][0]", "slice"),
    ],
)
@pytest.mark.parametrize("decorator", ["always_comb", "always(clk.posedge)", "always_seq(clk.posedge, reset=None)"])
def test_wrong_conversions_are_caught(body, rule, decorator, tmp_path):
    found = findings(tmp_path, body, decorator)
    assert rule in {finding.rule for finding in found}, found
    for finding in found:
        assert re.fullmatch(rf"{tmp_path}/planted\.py:\d+: \w+: .+", str(finding))


def test_instances_are_processes_too(tmp_path):
    assert {finding.rule for finding in findings(tmp_path, "yield clk.posedge\nresult.next = abs(a)", "instance")} == {
        "call"
    }


@pytest.mark.parametrize(
    "call",
    [
        "always_comb(process)",
        "always(clk.posedge)(process)",
        "always_seq(clk.posedge, reset=None)(process)",
        "instance(process)",
        "myhdl.always_comb(process)",
        "always(clk.posedge)(process) if gain else always_comb(process)",
    ],
)
def test_a_process_that_a_call_makes_is_checked(tmp_path, call):
    text = BLOCK.replace("@{decorator}", "#").replace("return (process,)", f"made = {call}\n    return made")
    source = tmp_path / "planted.py"
    source.write_text(text.format(body="        result.next = (a + b) >> 1"))
    assert [finding.rule for finding in check(source)] == ["arithmetic"]


@pytest.mark.parametrize("call", ["always_comb(helpers.process)", "always(clk.posedge)(imported)", "instance(make())"])
def test_a_process_of_another_file_is_refused(tmp_path, call):
    source = tmp_path / "planted.py"
    source.write_text(BLOCK.format(body="        result.next = a", decorator="always_comb") + f"    other = {call}\n")
    assert [finding.rule for finding in check(source)] == ["process"]


@pytest.mark.parametrize(
    "body",
    [
        "result.next = a + b",
        "result.next = a - 1",
        "result.next = -a",
        "result.next = a * gain",
        "result.next = (a + b) % (1 << width)",
        "result.next = (a + 1) % (1 << WORD_BITS)",
        "result.next = a[width - 1 : 2 * gain] + b[4:]",
        "result.next[width:4] = a << 1",
        "result.next = memory[a]",
        "result.next = memory[last - 1 - gain]",
        "for i in range(lines - 1):\n    if a[lines - 1 - i]:\n        result.next[i + 1] = b[2 * i]",
        "if (a < b) and not (a == last - 1):\n    result.next = concat(a, b[3])",
        "result.next = (a & ~b) | 3",
        "result.next = intbv(0)[8:]",
        "result.next = a[8:].signed()",
        "for i in range(config.groups):\n    result.next = len(a) - 1 - i",
    ],
)
def test_good_conversions_are_not_caught(body, tmp_path):
    # MyHDL's own examples often slice a cast literal, which is a constant.
    assert findings(tmp_path, body) == []


def test_a_hazard_in_the_hardware_is_caught(tmp_path):
    source = tmp_path / "ray_generator.py"
    text = (RTL / "engine" / source.name).read_text()
    source.write_text(
        text.replace("column.next = group_start + column_base", "column.next = group_start + column_base + 1")
    )
    assert [finding.rule for finding in check(source)] == ["arithmetic"]


def test_code_outside_processes_is_free(tmp_path):
    source = tmp_path / "free.py"
    source.write_text("@block\ndef free(a, b):\n    x = max(len(a) + len(b) + 1, 2)\n    return helper(x + x * 2)\n")
    assert check(source) == []


def test_a_finding_names_its_line(tmp_path):
    (finding,) = findings(tmp_path, "result.next = a\ntotal.next = a * b - 1")
    assert finding.path.read_text().splitlines()[finding.line - 1].strip() == "total.next = a * b - 1"


def test_the_command(tmp_path):
    command = [sys.executable, "-m", "raycaster.hdl.lint", str(RTL)]
    clean = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (clean.returncode, clean.stdout) == (0, "")
    findings(tmp_path, "result.next = max(a, b)\ntotal.next = a + b + 1")
    dirty = subprocess.run([*command[:3], str(tmp_path)], capture_output=True, text=True, check=False)
    assert dirty.returncode == 1
    assert re.findall(r"planted\.py:\d+: (\w+): ", dirty.stdout) == ["call", "arithmetic"]
    assert "--help" in subprocess.run([*command, "--help"], capture_output=True, text=True, check=True).stdout


@pytest.mark.parametrize("text", [b"def (", b"\xff", None])
def test_a_file_that_is_not_python_is_reported(text, tmp_path):
    source = tmp_path / "source.py"
    if text is not None:
        source.write_bytes(text)
    with pytest.raises(UserError, match=r"source\.py"):
        main([str(source)])
