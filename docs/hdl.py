# SPDX-License-Identifier: MIT
"""Generated parts of the manual's page about `raycaster.hdl`: `python -m raycaster.docs.hdl` writes them."""

from __future__ import annotations

import inspect
import re
import runpy
from pathlib import Path
from tempfile import TemporaryDirectory

from raycaster.docs.refusals import refusal_table

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "hdl.md"
EXAMPLE = ROOT / "examples" / "fifo" / "fifo.py"


def parts() -> dict[str, str]:
    """Return each generated part by its name: a block of the example, its Verilog, the queue's Verilog, refusals."""
    names = runpy.run_path(str(EXAMPLE))
    with TemporaryDirectory() as directory:
        verilog = {path.stem: path.read_text() for path in names["convert"](Path(directory))}
    instances = re.search(r"^pointer pointer_0_i.*?^\);\n", verilog["fifo"], re.M | re.S)
    assert instances
    return {
        "source": f"```python\n{inspect.getsource(names['pointer'].func)}```",
        "verilog": f"```verilog\n{verilog['pointer'][verilog['pointer'].index('// Count') :]}```",
        "instance": f"```verilog\n{instances[0]}```",
        "refusals": refusal_table(),
    }


def rendered(page: str) -> str:
    """Return a page with its generated parts, which stand between HTML comments with their names, written again."""
    for name, text in parts().items():
        begin = f"<!--hdl {name}-->"
        page = re.sub(rf"{begin}.*?<!--/-->", lambda _, text=f"{begin}\n\n{text}\n\n<!--/-->": text, page, flags=re.S)
    return page


if __name__ == "__main__":
    PAGE.write_text(rendered(PAGE.read_text()))
