# SPDX-License-Identifier: MIT
# What MyHDL is, as far as this project uses it: its own decorators say nothing of what they take and return.
from collections.abc import Callable
from typing import Any, ParamSpec

from myhdl._always import always as always
from myhdl._always_comb import always_comb as always_comb
from myhdl._always_seq import ResetSignal as ResetSignal
from myhdl._always_seq import always_seq as always_seq
from myhdl._block import _Block
from myhdl._concat import concat as concat
from myhdl._delay import delay as delay
from myhdl._instance import instance as instance
from myhdl._intbv import intbv as intbv
from myhdl._misc import downrange as downrange
from myhdl._misc import instances as instances
from myhdl._ShadowSignal import ConcatSignal as ConcatSignal
from myhdl._Signal import Constant as Constant
from myhdl._Signal import _Signal
from myhdl._Simulation import Simulation as Simulation
from myhdl.conversion import toVerilog as toVerilog

_P = ParamSpec("_P")

def block(func: Callable[_P, object]) -> Callable[_P, _Block]: ...
def enum(*names: str, encoding: str | None = None) -> Any: ...
def Signal(val: object = None, delay: int | None = None) -> _Signal: ...

class StopSimulation(Exception): ...
class ToVerilogWarning(Warning): ...
