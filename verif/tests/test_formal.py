# SPDX-License-Identifier: MIT
"""The proofs hold for the design, and each fails when a fault is planted in the Verilog."""

from __future__ import annotations

import json
from dataclasses import replace

import pytest
from conftest import refused

from raycaster.errors import UserError
from raycaster.verif.formal.faults import model_with_faults, outcome
from raycaster.verif.formal.properties import PROPERTIES
from raycaster.verif.formal.prove import main
from raycaster.verif.formal.prover import Property, Result, prove
from raycaster.verif.formal.wrapper import completed, constants

FAULTY = [proof for proof in PROPERTIES if proof.faults]
"""Properties with planted faults, each of a design that is proved quickly."""


def chosen(name: str, label: str) -> Property:
    """Return the property with this name for the design with this label."""
    [found] = [proof for proof in PROPERTIES if (proof.name, proof.label) == (name, label)]
    return found


HOST = chosen("host-transfers", "6 bits, 1 and 2 cycles")


@pytest.mark.slow_sets(
    "avalon-agent", "beam-tester-products-beam-vga240-s2-u1-r2-m1-c8 folded", "finder-quotients", "fold-exact",
    "fixed-rects", "fold-products", "line-start", "turned-walks",
)  # fmt: skip
@pytest.mark.parametrize("proof", [proof for proof in FAULTY if proof.small], ids=str)
def test_holds(proof, output):
    """Quick properties that have planted faults are proved without them; `make prove` proves all of them."""
    result = prove(proof, output / "proof", timeout=250)
    assert result.proved, f"{result.outcome}: {result.detail}; trace {result.trace}"


@pytest.mark.slow_sets(
    quick=[
        "apb", "axi4lite", "blend-exact", "cell-products", "contest-products", "eye-exact",
        "fold-products-beam-vga240-s2-u1-r2-m1", "group-safe", "host-transfers", "line-sections", "nearest-products",
        "row-setup-exact", "shadow-order", "shadow-products", "shares-exact", "slope-exact", "tester-exact",
        "video-timing-toy", "walked-products", "wishbone",
    ]
)  # fmt: skip
@pytest.mark.parametrize("proof", FAULTY, ids=str)
def test_faults_are_found(proof, output):
    """A run from reset contradicts the property; a failing induction step would not show that it can happen."""
    model_with_faults(proof, output / "planted")
    found = {fault: outcome(proof, output / "planted", fault, timeout=300) for fault in proof.faults}
    assert found == dict.fromkeys(proof.faults, "failed")


def test_no_fault_is_chosen(output):
    """Planting changes nothing unless a fault is chosen."""
    model_with_faults(HOST, output / "planted")
    assert outcome(HOST, output / "planted", "", timeout=60) == "passed"


def test_a_fault_that_no_run_from_reset_shows_is_not_found(output):
    """A host that waits has an access in every run, so that this changes nothing that reset leads to."""
    never = replace(HOST, faults=("avalon_host.waiting and access_select",))
    model_with_faults(never, output / "planted")
    assert outcome(never, output / "planted", never.faults[0], timeout=60) == "passed"


def test_a_place_that_does_not_exist_is_refused(output):
    """A fault that the hardware no longer has a place for must not be lost."""
    with pytest.raises(ValueError, match=r"avalon_host\.pausing 0: 'pausing'"):
        model_with_faults(replace(HOST, faults=("avalon_host.pausing 0",)), output / "planted")


def test_a_name_that_the_hardware_does_not_have_is_refused(output, monkeypatch):
    """Otherwise the property would read an arbitrary value."""
    text = HOST.text.replace("host.waiting", "host.pausing")
    monkeypatch.setattr("raycaster.verif.formal.prover.source", lambda name: text)
    with pytest.raises(UserError, match=r"host\.pausing' is implicitly declared"):
        prove(HOST, output / "proof")


INNER = """module inner (
    input  wire       clk,
    // [3:2] high, [1:0] low.
    input  wire [3:0] pair_word,
    output wire       same
);
reg signed [1:0] kept;
endmodule
"""


def test_declarations_follow_from_the_modules():
    """A property may use ports, fields of records, names inside an instance, and facts."""
    body = "inner dut (.*);\nalways @* assert (same == (pair_high == LIMIT) && dut.kept == 0);\nendmodule\n"
    text = f"module claim;\n{body}"
    assert constants(text, "claim") == ["LIMIT"]
    assert (
        completed(text, "claim", ["inner"], {"inner.v": INNER}, {"LIMIT": 2})
        == f"""`default_nettype none
module claim (input clk, input [3:0] pair_word);
localparam LIMIT = 2;
wire same;
wire [1:0] pair_high = pair_word[3:2];
(* hierconn *) wire signed [1:0] \\dut.kept ;
{body}"""
    )


def test_every_property_has_a_fault():
    """A property that no fault contradicts may claim nothing."""
    assert {proof.name for proof in FAULTY} == {proof.name for proof in PROPERTIES}


def test_unknown_property():
    """The error lists the known properties."""
    assert "got no-such, expected one of video-timing" in refused(main, "--property", "no-such")


def test_kept_proofs_are_not_repeated(output, monkeypatch, names_for_digests):
    """A proof is repeated only on request or if its Verilog or property changes; the kept figures list failures."""
    monkeypatch.setattr("raycaster.verif.formal.prove.PROOFS", [HOST])
    kept = output / "kept.json"

    def outcome(*options: str) -> tuple[int, dict]:
        code = main(["--jobs", "1", "--output", str(output / "proofs"), "--keep", str(kept), *options])
        return code, json.loads(kept.read_text())["figures"]

    label = f"host-transfers, {HOST.label}"
    assert outcome() == (0, {"proved": 1, "proofs": 1, "properties": 1, "properties_proved": 1, "lemmas": 0,
                             "lemmas_proved": 0, "failures": []})  # fmt: skip
    monkeypatch.setattr(
        "raycaster.verif.formal.prove.prove", lambda proof, *_, **__: Result(proof, "step failed", 1, 0)
    )
    assert outcome()[0] == 0
    assert outcome("--fresh") == (1, {"proved": 0, "proofs": 1, "properties": 1, "properties_proved": 0, "lemmas": 0,
                                      "lemmas_proved": 0, "failures": [f"{label}: step failed"]})  # fmt: skip
    changed = replace(HOST, parameters={**HOST.parameters, "MOST_WAIT": 2})
    monkeypatch.setattr("raycaster.verif.formal.prove.PROOFS", [changed])
    assert outcome()[0] == 1
