# SPDX-License-Identifier: MIT
"""The proofs hold, and each fails when a fault is planted: in the Verilog for a property, in its text for a lemma."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction

import pytest
import z3
from conftest import faulty, refused

from raycaster.runs.outcomes import kept_outcome
from raycaster.verif.formal.faults import model_with_faults, outcome
from raycaster.verif.formal.lemmas import LEMMAS, Lemma, prove_lemma
from raycaster.verif.formal.properties import PROPERTIES
from raycaster.verif.formal.prove import main
from raycaster.verif.formal.prover import Result, prove

FAULTY = [proof for proof in PROPERTIES if proof.faults]
"""Properties with planted faults, each of a design that is proved quickly."""

[HOST] = [proof for proof in PROPERTIES if (proof.name, proof.label) == ("host-transfers", "6 bits, 1 and 2 cycles")]


@pytest.mark.slow_sets(
    quick=["apb", "axi4lite", "host-transfers", "line-sections", "played-lines", "run-order", "tester-exact-1 bits",
           "video-timing-toy", "whole-frames", "wishbone"]
)  # fmt: skip
@pytest.mark.parametrize("proof", [proof for proof in FAULTY if proof.small], ids=str)
def test_a_property_holds(proof, output):
    """Quick properties that have planted faults are proved without them; `make prove` proves all of them."""
    result = prove(proof, output / "proof", timeout=250)
    assert result.proved, f"{result.outcome}: {result.detail}; trace {result.trace}"


@pytest.mark.slow_sets(
    quick=["apb", "axi4lite", "host-transfers", "line-sections", "tester-exact", "video-timing-toy", "wishbone"]
)  # fmt: skip
@pytest.mark.parametrize("proof", FAULTY, ids=str)
def test_faults_in_the_hardware_are_found(proof, output, record_property):
    """A run from reset contradicts the property; a failing induction step would not show that it can happen."""
    model_with_faults(proof, output / "planted")
    found = {fault: outcome(proof, output / "planted", fault, timeout=300) for fault in proof.faults}
    assert found == dict.fromkeys(proof.faults, "failed")
    record_property("planted", len(found))


def test_every_proof_has_a_fault():
    """A property that no fault contradicts may claim nothing."""
    assert {proof.name for proof in FAULTY} == {proof.name for proof in PROPERTIES}
    assert sorted(LEMMA_FAULTS) == sorted(lemma.label for lemma in LEMMAS)


def test_an_unknown_property_is_refused():
    assert "invalid choice: 'no-such' (choose from 'video-timing'" in refused(main, "--property", "no-such")


def test_a_proof_is_kept_until_its_property_changes(output, monkeypatch, names_for_digests):
    """The changed property is one that no longer holds, as the prover says; the kept figures list it."""
    kept, changed = output / "kept.json", replace(HOST, parameters={**HOST.parameters, "MOST_WAIT": 2})
    for proof, code in ((HOST, 0), (HOST, 0), (changed, 1)):
        monkeypatch.setattr("raycaster.verif.formal.prove.PROOFS", [proof])
        assert main(["--jobs", "1", "--output", str(output / "proofs"), "--keep", str(kept)]) == code
        failed = Result(proof, "step failed", 1, 0)
        monkeypatch.setattr("raycaster.verif.formal.prove.prove", lambda *_, failed=failed, **__: failed)
    assert kept_outcome(kept).figures["failures"] == [f"host-transfers, {HOST.label}: step failed"]


LEMMA_FAULTS = {
    "bounds": [("D*n <= (hi", "D*n < (hi"), ("e > 0", "e != 0"), ("(lo - E)*e", "(lo + E)*e")],
    "plane-ahead": [("n*e > 0", "n*e >= 0"), ("(n > 0)", "(n < 0)"), ("e != 0", "0 == 0")],
    "turned-plane": [("(-E - 1)", "-E"), ("t*(-D)", "t*D")],
    "turned-bounds": [("-lo - 1", "-lo"), ("-hi - 1", "-lo - 1"), ("(-E - 1) + d*t <", "(-E - 1) - d*t <")],
    "passed-bound": [("near >= 0", "near <= 0"), ("far >= 0", "far >= 1"), ("d >= 0", "0 == 0"), ("e > 0", "e >= 0")],
    "nearer": [("n1*e2 < n2*e1", "n1*e2 <= n2*e1"), ("n1*e2 < n2*e1", "n1*e1 < n2*e2"), ("e2 > 0", "e2 != 0")],
    "kept-is-nearest": [("n1*e3 < n3*e1", "n1*e3 < n2*e1"), ("n2*e3 <= n3*e2", "n2*e3 <= n3*e2 + 1"),
                        ("e3 > 0", "e3 != 0")],
    "depth": [("(t1 < t2)", "(t1 <= t2)"), ("t1 >= 0", "0 == 0"), ("D != 0", "0 == 0")],
    "slope-ratios": [("E + D*c*s1", "E + D*s1"), ("(s1 < s2)", "(s1 <= s2)"), ("c > 0", "c != 0")],
    "mirrored-eye": [("(2*k - E)", "(2*k + E)"), ("-D*(m + s)", "-D*s"), ("-D*(m + s)", "D*(m + s)")],
    "mirrored-distance": [("-(k - E)", "k - E"), ("2*k - E", "2*k - E - 1")],
    "beyond-on-the-same-axis": [("(n > m)", "(n >= m)"), ("e > 0", "e != 0"), ("(n == m)", "(n >= m)")],
    "beyond-on-another-axis": [("d*n > m*e", "d*n >= m*e"), ("d*n == m*e", "d*m == n*e"), ("d > 0", "d != 0")],
    "order-kept": [("a*e < b*e", "a*e <= b*e"), ("e > 0", "e >= 0"), ("(a < b)", "(a < b + 1)")],
    "corner-rule": [("m*e <= d*n", "m*e < d*n"), ("not met)", "met)"), ("t > s", "t >= s")],
    "eye-in-range": [("<= w*(r + 2)", "<= w*(r + 1)"), ("2*k - E", "2*k + E"), ("0 <= k <= w", "0 <= k <= w + 1"),
                     ("k - E <= w*(r + 1)", "k - E <= w*(r + 1) - 1")],
    "product-fits": [("x*y < A*B", "x*y < A*B - A"), ("0 <= x < A", "x < A"), ("0 <= y < B", "0 <= y <= B")],
    "product-in-range": [("x*y <= A*B", "x*y < A*B"), ("-B <= y <= B", "-B <= y <= B + 1"), ("-A*B <= x", "0 <= x")],
    "slope-in-range": [("h*u <= M*(V + C + H)", "h*u < M*(V + C + H)"), ("V >= 0", "0 == 0"), ("+ c*r", "- c*c*r"),
                       ("-H <= h <= H", "-H - 1 <= h <= H")],
    "next-column": [("n*(D + R)", "n*(D - R)"), ("now + n*R", "now + R"), ("n*(D + R)", "n*(D + R + 1)")],
    "complement-adds-one": [("a + b + 1", "a + b"), ("== -b", "== b"), ("(-b - 1) + 1", "(-b - 1)")],
    "division": [("(k <= q)", "(k < q)"), ("r > 0", "r >= 0"), ("0 <= r < e", "0 <= r <= e"), ("q < k", "q <= k")],
    "division-step": [("2*r + b >= e", "2*r + b > e"), ("s < e", "s < e - 1"), ("- d*e", "+ d*e"),
                      ("0 <= b <= 1", "0 <= b <= 2")],
    "cell-number": [("(i + 1)", "i + 1"), ("0 <= j < c", "0 <= j <= c"), ("0 <= r < e", "0 <= r <= e")],
    "digits-appended": [("b*p + m*d", "p + m*d"), ("+ m*d", "+ m"), ("b*p + m*d", "b*p - m*d")],
    "quotient-truncated": [("x - q < 1", "x - q <= 0"), ("0 <= r < e", "0 <= r <= e"), ("w == e*q", "w == -e*q")],
    "quotient-nearest": [("2*(x - q) < 1", "2*(x - q) < 0"), ("-1 <=", "0 <="), ("0 <= r < 2*e", "0 <= r < 3*e")],
    "way-of-magnitudes": [("d*(A*n)", "A*n"), ("s*s == 1", "0 == 0"), ("t*(s*e) == s*n", "t*e == s*n")],
    "point-error": [("<= c*e + A*b + q*e", "<= c*e + A*b"), ("P == O + X", "P == O - X"),
                    ("<= D*(I - i) <=", "<= D*(I + i) <="), ("<= c*e + A*b + q*e", "<= c*e + b + q*e")],
    "between": [("x < y", "x + 1 < y"), ("i <= N", "i <= N + 1"), ("a + N*g < b", "a + N*g <= b")],
    "shares": [("(w - v)*s", "w*s"), ("(4 - m)*s", "(3 - m)*s"), ("4*v == w*m", "4*v == m")],
    "cell-parity": [("a != b", "a == b"), ("(c == 1)", "(c == 0)"), ("0 <= b <= 1", "0 <= b <= 2")],
    "sign-change": [("y - i*g >= 0", "y - i*g > 0"), ("-y - 1 + i*g", "-y + i*g"), ("0 <= r < g", "0 <= r <= g")],
    "one-is-before": [("(A - s >= 0)", "(A >= 0)"), ("-A - t >= 0", "-A - t > 0"), ("s + t == 1", "s + t == 0")],
    "before-by-index": [("n1*e2 < n2*e1 or", "n1*e2 <= n2*e1 or"), ("s == 0)", "s == 1)"),
                        ("0 <= s <= 1", "0 <= s <= 2")],
    "from-the-light": [("S*s", "S"), ("(E - L)*e", "(E + L)*e"), ("+ D*n", "- D*n"), ("s*e == 1", "s*e == 2")],
    "before-the-point": [("n*e < d", "n*e <= d"), ("n*e < d", "n < d*e"), ("e > 0", "e != 0")],
    "lit-side": [("L < k)", "L <= k)"), ("(L - k) > 0", "(L - k) >= 0"), ("D < 0 and k < L", "D < 0 and L < k"),
                 ("t > 0", "t != 0")],
    "shadow-slope-in-range": [("S <= w*e", "S < w*e"), ("-w*e <=", "0 <="), ("0 <= L <= w", "-1 <= L <= w")],
}  # fmt: skip
"""By lemma, right and wrong texts of a hypothesis or the conclusion; 0 == 0 stands for no hypothesis."""

every_lemma = pytest.mark.parametrize("lemma", LEMMAS, ids=lambda lemma: lemma.label)


def changed(lemma: Lemma, right: str, wrong: str) -> Lemma:
    """Return the lemma with this fault in the one hypothesis or conclusion that has the right text."""
    texts = [*lemma.given, lemma.then]
    [place] = [index for index, text in enumerate(texts) if right in text]
    texts[place] = faulty(texts[place], right, wrong)
    return replace(lemma, given=tuple(texts[:-1]), then=texts[-1])


def contradicted(lemma: Lemma, values: Mapping[str, Fraction | bool]) -> bool:
    """Return True if the values of all variables, in Python, satisfy the hypotheses but not the conclusion."""
    *given, then = (bool(eval(text, {}, dict(values))) for text in (*lemma.given, lemma.then))
    return all(given) and not then


def counterexample(lemma: Lemma, sorts: Mapping[str, str]) -> dict[str, Fraction | bool] | None:
    """Return values of these variables that contradict a lemma, from z3's Python interface, or None."""
    solver = z3.Solver()
    solver.set("timeout", 60_000)
    solver.from_string(lemma.smt().partition("(check-sat)")[0])
    verdict = solver.check()
    assert verdict != z3.unknown, lemma.label
    if verdict == z3.unsat:
        return None
    make = {"Bool": z3.Bool, "Int": z3.Int, "Real": z3.Real}
    values = {name: solver.model().eval(make[sort](name), model_completion=True) for name, sort in sorts.items()}
    return {name: z3.is_true(value) if z3.is_bool(value) else Fraction(str(value)) for name, value in values.items()}


@every_lemma
def test_a_lemma_holds(lemma, output):
    """Both solvers prove each lemma."""
    assert prove_lemma(lemma, output / "lemma", timeout=60) == ("proved", "")


@every_lemma
def test_faults_in_a_lemma_are_found(lemma, record_property):
    """Python's arithmetic confirms each counterexample.

    Some faults are in the conclusion, which shows that the hypotheses do not contradict each other.
    """
    in_conclusion = 0
    for right, wrong in LEMMA_FAULTS[lemma.label]:
        fault = changed(lemma, right, wrong)
        values = counterexample(fault, lemma.sorts())
        assert values is not None, f"{right} -> {wrong}: still holds"
        assert contradicted(fault, values), values
        assert not contradicted(lemma, values), values
        in_conclusion += fault.given == lemma.given
    assert in_conclusion
    record_property("planted", len(LEMMA_FAULTS[lemma.label]))


def test_a_fault_fails_the_proof_of_a_lemma(output):
    """The outcome names the solver, and the detail has the numbers."""
    [lemma] = [lemma for lemma in LEMMAS if lemma.label == "bounds"]
    outcome, detail = prove_lemma(changed(lemma, "e > 0", "e != 0"), output / "lemma", timeout=60)
    assert outcome == "z3 failed"
    assert "(e " in detail
