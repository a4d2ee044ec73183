# SPDX-License-Identifier: MIT
"""Parts of MyHDL that it does not publish, under the names by which this package uses them.

No other file of the package imports them. They may change with any version of MyHDL, so its version is pinned, and
tests check what the package relies on.
"""

import importlib

from myhdl._block import _Block as Block
from myhdl._enum import EnumItemType
from myhdl._extractHierarchy import _UserVerilogCode as UserVerilog
from myhdl._instance import _Instantiator as Process
from myhdl._ShadowSignal import _ShadowSignal as ShadowSignal
from myhdl._ShadowSignal import _SliceSignal as SliceSignal
from myhdl._Signal import Constant
from myhdl._Signal import _Signal as SignalType
from myhdl._simulator import _signals as all_signals
from myhdl._Waiter import _SignalWaiter as SignalWaiter
from myhdl.conversion._toVerilog import _ToVerilogConvertor as VerilogConvertor
from myhdl.conversion._toVerilog import toVerilog as verilog_printer

util, waiter = map(importlib.import_module, ("myhdl._util", "myhdl._Waiter"))
"""Modules in which `raycaster.hdl.elaboration` replaces functions."""

__all__ = [
    "Block", "Constant", "EnumItemType", "Process", "ShadowSignal", "SignalType", "SignalWaiter",
    "SliceSignal", "UserVerilog", "VerilogConvertor", "all_signals", "util", "verilog_printer", "waiter",
]  # fmt: skip
