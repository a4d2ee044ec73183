# SPDX-License-Identifier: MIT
"""Show with z3 that a mutant is equivalent to its module."""

from __future__ import annotations

import re
import time
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

import z3

from raycaster.errors import UserError
from raycaster.tools import run_yosys

SECONDS = 60
"""Time limit per mutant; when it is over, the mutant is not known to be equivalent."""


class ContractError(UserError):
    """An invariant of a contract does not hold."""


class Comparison:
    """Compare a netlist with each mutant that it contains, by induction over its registers.

    Both start with equal registers. Bits that may differ one cycle later, for any inputs, are arbitrary in the mutant
    from then on; when no further bits can differ, the outputs must still be equal. If the module has a reset, bits of
    its registers that never change after it are known.

    Args:
        work: directory with Yosys's `<module>.smt2`, the netlist with all mutants and an input `mutsel` to choose one.
        module: name of the module.
        read: by output that is an input of a submodule, a mask of the bits that the submodule reads; the mutant may
            differ in the other bits.
        assumptions: Verilog expressions of the module's inputs that are assumed to hold always.
        invariants: Verilog expressions of the module's registers that hold from reset on, which is proved first.

    Raises:
        ContractError: an invariant does not hold, or an expression has an unknown name.
    """

    def __init__(
        self,
        work: Path,
        module: str,
        read: Mapping[str, int],
        assumptions: Sequence[str] = (),
        invariants: Sequence[str] = (),
    ):
        self._module = module
        self._model = (work / f"{module}.smt2").read_text()
        self._bits = _state_bits(self._model)
        number = re.escape(module) + r"#\d+"
        # Inputs and registers are fields of the state, which is one bit vector.
        fields = {
            match[1]: (int(match[2]), int(match[3]))
            for match in re.finditer(
                rf"^\(define-fun \|({number})\| [^;\n]*\(\(_ extract (\d+) (\d+)\) state\)(?: #b1\))?\) ; ",
                self._model,
                re.M,
            )
        }
        [selector] = re.findall(rf"^\(define-fun \|({number})\| [^;\n]* ; \\mutsel$", self._model, re.M)
        self._selector = fields[selector]
        # The next state of each register, and its field.
        self._registers = [
            (match[1], fields[match[2]])
            for match in re.finditer(rf"^  \(= (.+) \(\|({number})\| next_state\)\) ; ", self._model, re.M)
        ]
        outputs = re.findall(r"^; yosys-smt2-output (\S+) (\d+)$", self._model, re.M)
        # For each output, its width and the bits that count.
        self._outputs = {name: (int(width), read.get(name, -1) & (1 << int(width)) - 1) for name, width in outputs}
        inputs = re.findall(r"^; yosys-smt2-input (\S+) \d+$", self._model, re.M)
        self._resets = [name for name in ("reset", "reset_ray_caster") if name in inputs]
        self._constants: dict[int, tuple[int, int]] = {}
        self._contract: list[str] = []
        if assumptions or invariants:
            self._contract = self._translate(work, {"assumed": assumptions, "invariant": invariants})
        if invariants:
            self._prove_invariants()
        if self._resets:
            self._find_constants()

    def equivalent(self, mutant: int) -> bool:
        """True if the mutant is shown to behave as the netlist does."""
        deadline = time.monotonic() + SECONDS
        # For each register, the bits that are equal in both.
        equal = [(1 << high - low + 1) - 1 for _, (high, low) in self._registers]
        while True:
            text = self._both(mutant, equal)
            differ = []
            for index, (term, (high, low)) in enumerate(self._registers):
                width = high - low + 1
                apart = f"(bvxor {_at(term, 'module')} {_at(term, 'mutant')})"
                text += f"(declare-const apart{index} {_vector(width)})\n"
                text += f"(assert (= apart{index} (bvand {apart} (_ bv{equal[index]} {width}))))\n"
                differ.append(f"(not (= apart{index} (_ bv0 {width})))")
            model = _solve(f"{text}(assert (or false {' '.join(differ)}))", deadline) if differ else {}
            if model is None:
                return False
            if not model:
                break
            for index, _ in enumerate(equal):
                equal[index] &= ~model.get(f"apart{index}", 0)
        unequal = (
            f"(not (= {self._output(name, 'module')} {self._output(name, 'mutant')}))"
            for name, (_, mask) in self._outputs.items()
            if mask
        )
        return _solve(f"{self._both(mutant, equal)}(assert (or false {' '.join(unequal)}))", deadline) == {}

    def _output(self, name: str, state: str) -> str:
        """Return an output without the bits that do not count."""
        width, mask = self._outputs[name]
        value = f"(|{self._module}_n {name}| {state})"
        return value if mask == (1 << width) - 1 else f"(bvand {value} (_ bv{mask} {width}))"

    def _both(self, mutant: int, equal: Iterable[int]) -> str:
        """Declare a state of the module, and one of the mutant with the same inputs and the same bits `equal`."""
        sources = ["module"] * self._bits
        for (_, (high, low)), mask in zip(self._registers, equal, strict=True):
            for place in range(low, high + 1):
                if not mask >> place - low & 1:
                    sources[place] = "free"
        high, low = self._selector
        sources[low : high + 1] = ["selector"] * (high - low + 1)
        parts, end = [], self._bits - 1
        for place in range(self._bits - 1, -1, -1):
            if place == 0 or sources[place - 1] != sources[place]:
                whole = f"((_ extract {end} {place}) {sources[place]})"
                parts.append(f"(_ bv{mutant} {high - low + 1})" if sources[place] == "selector" else whole)
                end = place - 1
        text = self._state("module", 0) + f"(declare-const free {_vector(self._bits)})\n"
        text += f"(define-fun mutant () {_vector(self._bits)} (concat {' '.join(parts)}))\n"
        for kind in ("assumed", "invariant") if self._contract else ():
            text += f"(assert {self._holds(kind, 'module')})\n"
        return text + self._known()

    def _known(self) -> str:
        """Assert the module's constant bits."""
        text = ""
        for index, (mask, value) in self._constants.items():
            high, low = self._registers[index][1]
            width, place = high - low + 1, f"((_ extract {high} {low}) module)"
            text += f"(assert (= (bvand {place} (_ bv{mask} {width})) (_ bv{mask & value} {width})))\n"
        return text

    def _find_constants(self) -> None:
        """Start from the registers after reset, and drop the bits that reset does not set or that change afterwards."""
        after_reset = f"(assert (|{self._module}_n {self._resets[0]}| module))\n"
        widths = {index: high - low + 1 for index, (_, (high, low)) in enumerate(self._registers)}
        first = self._next_values(after_reset, "")
        self._constants = {index: ((1 << width) - 1, first.get(f"next{index}", 0)) for index, width in widths.items()}
        self._drop_changing(after_reset, known=False)
        self._drop_changing("", known=True)

    def _next_values(self, given: str, goal: str) -> dict[str, int]:
        """Return the next states of the registers, in any state that fits; empty if none does."""
        text = f"{self._state('module', 0)}{given}"
        for index, (term, (high, low)) in enumerate(self._registers):
            text += f"(declare-const next{index} {_vector(high - low + 1)})\n"
            text += f"(assert (= next{index} {_at(term, 'module')}))\n"
        model = _solve(text + goal, time.monotonic() + SECONDS)
        if model is None:
            self._constants = {}
        return model or {}

    def _drop_changing(self, given: str, known: bool) -> None:
        while self._constants:
            changes = []
            for index, (mask, value) in self._constants.items():
                high, low = self._registers[index][1]
                width = high - low + 1
                changes.append(f"(not (= (bvand next{index} (_ bv{mask} {width})) (_ bv{mask & value} {width})))")
            after = self._next_values(given + self._known() * known, f"(assert (or false {' '.join(changes)}))")
            if not after:
                return
            for index, (mask, value) in list(self._constants.items()):
                kept = mask & ~(after.get(f"next{index}", value) ^ value)
                self._constants[index] = kept, value
                if not kept:
                    del self._constants[index]

    def _state(self, name: str, selector: int) -> str:
        """Declare a state, and the signals of it that the contract uses."""
        high, low = self._selector
        text = self._model if name == "module" else ""
        text += f"(declare-const {name} {_vector(self._bits)})\n"
        text += f"(assert (= ((_ extract {high} {low}) {name}) (_ bv{selector} {high - low + 1})))\n"
        if self._contract:
            text += f"(declare-const {name}_seen |contract_s|)\n"
            for seen in self._contract:
                text += f"(assert (= (|contract_n {seen}| {name}_seen) (|{self._module}_n {seen}| {name})))\n"
        return text

    def _holds(self, kind: str, state: str) -> str:
        return f"(|contract_n {kind}_holds| {state}_seen)"

    def _translate(self, work: Path, expressions: dict[str, Sequence[str]]) -> list[str]:
        """Add the expressions to the model, as a separate module, and return the names that they use."""
        there = dict(re.findall(r"^; yosys-smt2-(?:input|output|wire|register) (\S+) (\d+)$", self._model, re.M))
        words = re.findall(r"(?<![\w'$])[A-Za-z_]\w*", " ".join([*expressions["assumed"], *expressions["invariant"]]))
        names = list(dict.fromkeys(words))
        if missing := [name for name in names if name not in there]:
            raise ContractError(f"the contract of {self._module} has unknown names: {', '.join(missing)}")
        ports = [f"input [{int(there[name]) - 1}:0] {name}" for name in names]
        ports += [f"output {kind}_holds" for kind in expressions]
        lines = [f"module contract({', '.join(ports)});"]
        for kind, texts in expressions.items():
            lines.append(f"assign {kind}_holds = {' && '.join(f'({text})' for text in texts) or 1};")
        (work / "contract.v").write_text("\n".join([*lines, "endmodule"]) + "\n")
        script = ["read_verilog contract.v", "hierarchy -top contract", "write_smt2 -stbv -wires contract.smt2"]
        run_yosys(work, "contract", script)
        self._model += (work / "contract.smt2").read_text()
        return names

    def _prove_invariants(self) -> None:
        starts = {f"(|{self._module}_n {name}| module)": "reset" for name in self._resets}
        starts[self._holds("invariant", "module")] = "the cycle before"
        for start, text in starts.items():
            query = (
                f"{self._state('module', 0)}{self._state('next', 0)}(assert (|{self._module}_t| module next))\n"
                f"(assert {start})\n(assert {self._holds('assumed', 'module')})\n"
                f"(assert {self._holds('assumed', 'next')})\n(assert (not {self._holds('invariant', 'next')}))\n"
            )
            if _solve(query, time.monotonic() + SECONDS) != {}:
                raise ContractError(f"an invariant of {self._module} does not follow from {text}")


def _vector(width: int) -> str:
    return f"(_ BitVec {width})"


def _at(term: str, state: str) -> str:
    return term.replace(" state", f" {state}")


def _state_bits(model: str) -> int:
    [bits] = re.findall(r"^\(define-sort \|[^|]+_s\| \(\) \(_ BitVec (\d+)\)\)", model, re.M)
    return int(bits)


def _solve(text: str, deadline: float) -> dict[str, int] | None:
    """Return values that fit, empty if none do; None if time ran out."""
    solver = z3.Solver(ctx=z3.Context())
    remaining = deadline - time.monotonic()
    if remaining <= 0:
        return None
    solver.set(timeout=int(remaining * 1000) + 1)
    solver.from_string(text)
    answer = solver.check()
    if answer.r < 0:
        return {}
    if answer.r == 0:
        return None
    model = solver.model()
    values = {entry.name(): model[entry] for entry in model.decls()}
    return {
        name: value.as_long() for name, value in values.items() if isinstance(value, (z3.BitVecNumRef, z3.IntNumRef))
    }
