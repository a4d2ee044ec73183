# SPDX-License-Identifier: MIT
"""The lemmas hold, and each planted change has a counterexample that Python's arithmetic confirms."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from fractions import Fraction

import pytest
import z3

from raycaster.verif.formal.lemmas import LEMMAS, Lemma, prove_lemma

BY_LABEL = {lemma.label: lemma for lemma in LEMMAS}

# Right and wrong text of a hypothesis or the conclusion; None as the wrong text leaves the hypothesis out.
FAULTS = {
    "bounds": [("D*n <= (hi", "D*n < (hi"), ("e > 0", "e != 0"), ("(lo - E)*e", "(lo + E)*e")],
    "plane-ahead": [("n*e > 0", "n*e >= 0"), ("(n > 0)", "(n < 0)"), ("e != 0", None)],
    "turned-plane": [("(-E - 1)", "-E"), ("t*(-D)", "t*D")],
    "turned-bounds": [("-lo - 1", "-lo"), ("-hi - 1", "-lo - 1"), ("(-E - 1) + d*t <", "(-E - 1) - d*t <")],
    "passed-bound": [("near >= 0", "near <= 0"), ("far >= 0", "far >= 1"), ("d >= 0", None), ("e > 0", "e >= 0")],
    "nearer": [("n1*e2 < n2*e1", "n1*e2 <= n2*e1"), ("n1*e2 < n2*e1", "n1*e1 < n2*e2"), ("e2 > 0", "e2 != 0")],
    "kept-is-nearest": [("n1*e3 < n3*e1", "n1*e3 < n2*e1"), ("n2*e3 <= n3*e2", "n2*e3 <= n3*e2 + 1"),
                        ("e3 > 0", "e3 != 0")],
    "depth": [("(t1 < t2)", "(t1 <= t2)"), ("t1 >= 0", None), ("D != 0", None)],
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
    "slope-in-range": [("h*u <= M*(V + C + H)", "h*u < M*(V + C + H)"), ("V >= 0", None), ("+ c*r", "- c*c*r"),
                       ("-H <= h <= H", "-H - 1 <= h <= H")],
    "next-column": [("n*(D + R)", "n*(D - R)"), ("now + n*R", "now + R"), ("n*(D + R)", "n*(D + R + 1)")],
    "fold-at-a-mirror": [("(2*n - T)", "(2*n + T)"), ("-s*(X - E) +", "s*(X - E) +"), ("(2*n - T)", "(n - T)")],
    "fold-at-two-on-an-axis": [("2*(n - m)", "2*(m - n)"), ("x + 2", "-x + 2"), ("2*(n - m)", "(n - m)")],
    "folded-way": [("Tp*Da - s*z", "Tp*Da + s*z"), ("s*z*n*Dp", "n*Dp"), ("s*s == 1", None), ("+ Ta == n", "== n")],
    "folded-bounds": [("D*n + T*e <= (hi", "D*n <= (hi"), ("e > 0 and", "e > 1 and"), ("(lo <= C", "(lo < C")],
    "ahead-of-mirror": [("n > 0", "n > 1"), ("m > 0", "m >= 0"), ("d > 0", None)],
    "complement-adds-one": [("a + b + 1", "a + b"), ("== -b", "== b"), ("(-b - 1) + 1", "(-b - 1)")],
    "division": [("(k <= q)", "(k < q)"), ("r > 0", "r >= 0"), ("0 <= r < e", "0 <= r <= e"), ("q < k", "q <= k")],
    "division-step": [("2*r + b >= e", "2*r + b > e"), ("s < e", "s < e - 1"), ("- d*e", "+ d*e"),
                      ("0 <= b <= 1", "0 <= b <= 2")],
    "cell-number": [("(i + 1)", "i + 1"), ("0 <= j < c", "0 <= j <= c"), ("0 <= r < e", "0 <= r <= e")],
    "digits-appended": [("b*p + m*d", "p + m*d"), ("+ m*d", "+ m"), ("b*p + m*d", "b*p - m*d")],
    "quotient-truncated": [("x - q < 1", "x - q <= 0"), ("0 <= r < e", "0 <= r <= e"), ("w == e*q", "w == -e*q")],
    "quotient-nearest": [("2*(x - q) < 1", "2*(x - q) < 0"), ("-1 <=", "0 <="), ("0 <= r < 2*e", "0 <= r < 3*e")],
    "way-of-magnitudes": [("d*(A*n)", "A*n"), ("s*s == 1", None), ("t*(s*e) == s*n", "t*e == s*n")],
    "point-error": [("<= c*e + A*b + q*e", "<= c*e + A*b"), ("P == O + X", "P == O - X"),
                    ("<= D*(I - i) <=", "<= D*(I + i) <="), ("<= c*e + A*b + q*e", "<= c*e + b + q*e")],
    "between": [("x < y", "x + 1 < y"), ("i <= N", "i <= N + 1"), ("a + N*g < b", "a + N*g <= b")],
    "shares": [("(w - v)*s", "w*s"), ("(4 - m)*s", "(3 - m)*s"), ("4*v == w*m", "4*v == m")],
    "product-in-parts": [("c*(n*h)", "n*h"), ("l + c*h", "l - c*h"), ("n*l +", "l +")],
    "cell-parity": [("a != b", "a == b"), ("(c == 1)", "(c == 0)"), ("0 <= b <= 1", "0 <= b <= 2")],
    "from-the-light": [("S*s", "S"), ("(E - L)*e", "(E + L)*e"), ("+ D*n", "- D*n"), ("s*e == 1", "s*e == 2")],
    "before-the-point": [("n*e < d", "n*e <= d"), ("n*e < d", "n < d*e"), ("e > 0", "e != 0")],
    "lit-side": [("L < k)", "L <= k)"), ("(L - k) > 0", "(L - k) >= 0"), ("D < 0 and k < L", "D < 0 and L < k"),
                 ("t > 0", "t != 0")],
    "shadow-slope-in-range": [("S <= w*e", "S < w*e"), ("-w*e <=", "0 <="), ("0 <= L <= w", "-1 <= L <= w")],
}  # fmt: skip


def changed(lemma: Lemma, right: str, wrong: str | None) -> Lemma:
    """Return the lemma with this fault in the one hypothesis or conclusion that has the right text."""
    texts = [*lemma.given, lemma.then]
    places = [index for index, text in enumerate(texts) if right in text]
    assert len(places) == 1, f"{lemma.label} has {len(places)} places for {right}"
    if wrong is None:
        assert lemma.given[places[0]] == right
        return dataclasses.replace(lemma, given=tuple(text for text in lemma.given if text != right))
    texts[places[0]] = texts[places[0]].replace(right, wrong)
    return dataclasses.replace(lemma, given=tuple(texts[:-1]), then=texts[-1])


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


@pytest.mark.parametrize("label", BY_LABEL)
def test_holds(label, output):
    """Both solvers prove each lemma."""
    assert prove_lemma(BY_LABEL[label], output / "lemma", timeout=60) == ("proved", "")


@pytest.mark.parametrize("label", BY_LABEL)
def test_faults_are_found(label):
    """Some faults are in the conclusion, which shows that the hypotheses do not contradict each other."""
    lemma = BY_LABEL[label]
    in_conclusion = 0
    for right, wrong in FAULTS[label]:
        fault = changed(lemma, right, wrong)
        values = counterexample(fault, lemma.sorts())
        assert values is not None, f"{right} -> {wrong}: still holds"
        assert contradicted(fault, values), values
        assert not contradicted(lemma, values), values
        in_conclusion += fault.given == lemma.given
    assert in_conclusion


def test_a_fault_fails_the_proof(output):
    """The outcome names the solver, and the detail has the numbers."""
    outcome, detail = prove_lemma(changed(BY_LABEL["bounds"], "e > 0", "e != 0"), output / "lemma", timeout=60)
    assert outcome == "z3 failed"
    assert "(e " in detail


def test_every_lemma_has_a_fault():
    assert FAULTS.keys() == BY_LABEL.keys()
    assert len(BY_LABEL) == len(LEMMAS)
