# SPDX-License-Identifier: MIT
"""Generated parts of the manual's page about `raycaster.hdl`."""

from __future__ import annotations

import inspect
import re
import runpy
from pathlib import Path
from tempfile import TemporaryDirectory

from raycaster.docs.refusals import refusal_table

ROOT = Path(__file__).resolve().parents[1]
EXAMPLE = ROOT / "examples" / "fifo" / "fifo.py"


def parts() -> dict[str, str]:
    """Return each part by its marker: a block of the example, its Verilog, the queue's Verilog, refusals."""
    names = runpy.run_path(str(EXAMPLE))
    with TemporaryDirectory() as directory:
        verilog = {path.stem: path.read_text() for path in names["convert"](Path(directory))}
    instances = re.search(r"^pointer pointer_0_i.*?^\);\n", verilog["fifo"], re.M | re.S)
    assert instances
    return {
        "hdl_source": f"```python\n{inspect.getsource(names['pointer'].func)}```",
        "hdl_verilog": f"```verilog\n{verilog['pointer'][verilog['pointer'].index('// Count') :]}```",
        "hdl_instance": f"```verilog\n{instances[0]}```",
        "hdl_refusals": refusal_table(),
    }
