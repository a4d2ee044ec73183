# SPDX-License-Identifier: MIT
"""Tools of the web page: compilation to WebAssembly, and the browser in which pages are tested."""

from __future__ import annotations

from pathlib import Path

import pytest
from wasmtime import Instance, Module, Store

from raycaster.errors import UserError
from raycaster.sim.simulator import MODELS_VARIABLE
from raycaster.web import wasm
from raycaster.web.browser import browser_page
from raycaster.web.wasm import FREESTANDING, WASI, compile_wasm


@pytest.fixture
def program(tmp_path, monkeypatch):
    """Return a function that compiles `sum`, which adds a header's constant to its argument, in the test's folder."""
    monkeypatch.delenv(MODELS_VARIABLE)
    source, header = tmp_path / "sum.c", tmp_path / "sum.h"

    def compiled(constant: str, target: str = FREESTANDING, **options: object) -> Path:
        header.write_text(f"#define CONSTANT {constant}\n")
        source.write_text('#include "sum.h"\nint sum(int value) { return value + CONSTANT; }\n')
        return compile_wasm("sum", [source], target, headers=[header], exports=["sum"], build=tmp_path, **options)

    return compiled


@pytest.mark.slow_sets("wasm32-wasi")
@pytest.mark.parametrize("target", [FREESTANDING, WASI])
def test_is_called_function_by_function(program, target):
    path = program("30", target)
    assert path.name == "sum.wasm"
    store = Store()
    module = Module.from_file(store.engine, str(path))
    assert list(module.imports) == []
    exports = Instance(store, module, []).exports(store)
    assert exports["sum"](store, 12) == 42
    assert ("_initialize" in exports) == (target == WASI)


@pytest.mark.slow
def test_compiles_once(program):
    first = program("30")
    before = first.stat().st_mtime_ns
    assert program("30") == first
    assert first.stat().st_mtime_ns == before
    others = [program("31"), program("30", flags=["-O1"]), program("30", WASI)]
    assert len({first, *others}) == 4
    assert first.read_bytes() != others[0].read_bytes()


def test_compiler_errors(program):
    for _ in range(2):  # a failure does not count as compiled
        with pytest.raises(UserError, match=r"^the compiler failed on sum; its log is \S+\.log$") as refused:
            program("one")
        assert "'one'" in Path(str(refused.value).rpartition(" ")[2]).read_text()


def test_without_a_compiler(program, monkeypatch):
    monkeypatch.setattr(wasm, "find_spec", lambda name: None)
    with pytest.raises(UserError, match=r"^ziglang is missing; it comes with the extra play: .*$"):
        program("30")


def test_a_script_that_fails_is_noticed():
    with pytest.raises(AssertionError, match="nowhere is not defined"), browser_page() as page:
        page.set_content("<script>nowhere()</script>")


def test_without_a_browser(monkeypatch):
    monkeypatch.setattr("raycaster.web.browser.find", lambda tool: None)
    with pytest.raises(UserError, match=r"^Chromium is missing[;,] .*$"), browser_page():
        pass
