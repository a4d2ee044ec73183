# SPDX-License-Identifier: MIT
"""Facts about numbers of any size that the engines rely on beyond their Verilog, each proved by two solvers.

The proofs at full width compare products and comparisons in the hardware with those in the specification, and know
nothing about multiplication. These facts lead from there to the definition, which uses rational numbers.
"""

from __future__ import annotations

import ast
import importlib
import re
import subprocess
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

from raycaster.output import emptied
from raycaster.runs.tools import run_program

SOLVERS = ("z3", "cvc5")


@dataclass(frozen=True)
class Lemma:
    """A fact about numbers.

    `given` and `then` are written with Python's operators: the same text is proved, evaluated by a test and shown on a
    page. == between two conditions is "if and only if"; there is no division.

    Attributes:
        label: name of the lemma.
        claim: the claim in a few words.
        given: the hypotheses.
        then: the conclusion.
        integers: True if the variables are integers; else they are real numbers, which include integers and rationals.
    """

    label: str
    claim: str
    given: tuple[str, ...]
    then: str
    integers: bool = False

    name: ClassVar[str] = "lemmas"
    modules: ClassVar[tuple[str, ...]] = ()
    cut: ClassVar[tuple[str, ...]] = ()
    induction: ClassVar[int] = 0
    small: ClassVar[bool] = True

    def sorts(self) -> dict[str, str]:
        """Return the variables and their sorts in SMT-LIB; an operand of `and`, `or` and `not` is true or false."""
        nodes = [node for text in (*self.given, self.then) for node in ast.walk(ast.parse(text, mode="eval"))]
        operands = [node.values for node in nodes if isinstance(node, ast.BoolOp)]
        operands += [[node.operand] for node in nodes if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not)]
        truths = {one.id for several in operands for one in several if isinstance(one, ast.Name)}
        sort = "Int" if self.integers else "Real"
        return {node.id: "Bool" if node.id in truths else sort for node in nodes if isinstance(node, ast.Name)}

    def smt(self) -> str:
        """Return SMT-LIB that is unsatisfiable if the lemma holds."""
        sorts = self.sorts()
        lines = ["(set-logic ALL)", "(set-option :produce-models true)"]
        lines += [f"(declare-const {name} {sort})" for name, sort in sorts.items()]
        lines += [f"(assert {self._translated(text)})" for text in self.given]
        lines += [f"(assert (not {self._translated(self.then)}))", "(check-sat)", f"(get-value ({' '.join(sorts)}))"]
        return "\n".join(lines) + "\n"

    def _translated(self, text: str) -> str:
        return _smt(ast.parse(text, mode="eval").body, "" if self.integers else ".0")


OPERATORS = {
    ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.And: "and", ast.Or: "or", ast.Not: "not", ast.USub: "-",
    ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">=", ast.Eq: "=", ast.NotEq: "distinct",
}  # fmt: skip


def _smt(node: ast.expr, point: str) -> str:
    """Translate an expression to SMT-LIB; constants end with `point`."""
    match node:
        case ast.Name(name):
            return name
        case ast.Constant(int(value)):
            return f"{value}{point}"
        case ast.UnaryOp(operator, operand):
            return f"({OPERATORS[type(operator)]} {_smt(operand, point)})"
        case ast.BinOp(left, operator, right):
            return f"({OPERATORS[type(operator)]} {_smt(left, point)} {_smt(right, point)})"
        case ast.BoolOp(operator, values):
            return f"({OPERATORS[type(operator)]} {' '.join(_smt(value, point) for value in values)})"
        case ast.Compare(left, operators, rights):
            sides = [_smt(side, point) for side in (left, *rights)]
            pairs = zip(operators, sides, sides[1:], strict=False)
            parts = [f"({OPERATORS[type(operator)]} {one} {other})" for operator, one, other in pairs]
            return parts[0] if len(parts) == 1 else f"(and {' '.join(parts)})"
    raise ValueError(f"{ast.unparse(node)} is not allowed in a lemma")


def prove_lemma(lemma: Lemma, directory: Path, timeout: float) -> tuple[str, str]:
    """Prove a lemma with both solvers.

    Args:
        lemma: the lemma to prove.
        directory: replaced; holds the input of the solvers.
        timeout: time limit of each solver in seconds.

    Returns:
        "proved", or the solver that did not prove it and why; and its counterexample, if it found one.
    """
    emptied(directory)
    path = directory / "lemma.smt2"
    path.write_text(lemma.smt())
    for solver, solve in zip(SOLVERS, (_z3, _cvc5), strict=True):
        verdict, model = solve(path, timeout)
        if verdict != "unsat":
            return f"{solver} {'failed' if verdict == 'sat' else 'not finished'}", model if verdict == "sat" else ""
    return "proved", ""


def _z3(path: Path, timeout: float) -> tuple[str, str]:
    try:
        done = run_program(["z3", path.name], path.parent, timeout)
    except subprocess.TimeoutExpired:
        return "timeout", ""
    # After "unsat" there are no values, and z3 reports an error.
    verdict, _, model = done.stdout.partition("\n")
    return verdict, model


def _cvc5(path: Path, timeout: float) -> tuple[str, str]:
    cvc5: Any = importlib.import_module("cvc5")  # an optional package without type information
    solver = cvc5.Solver()
    solver.setOption("tlimit-per", str(round(timeout * 1000)))
    parser = cvc5.InputParser(solver)
    parser.setFileInput(cvc5.InputLanguage.SMT_LIB_2_6, str(path))
    verdict = ""
    while not (command := parser.nextCommand()).isNull():
        said = str(command.invoke(solver, parser.getSymbolManager())).strip()
        if command.getCommandName() == "check-sat":
            verdict = said
            if verdict != "sat":
                break
        elif command.getCommandName() == "get-value":
            return verdict, said
    return verdict, ""


# E is the eye, D the slope, t the ray's parameter, P = E + D t; k is a plane, and t = n/e; lo and hi, near and far are
# bounds. On an axis that is turned around, coordinates are complemented: ~x = -x - 1.
TEXT = """\
bounds: lo <= E + D n/e <= hi is equivalent to (lo - E) e <= D n <= (hi - E) e
  given e > 0, t*e == n
  then (lo <= E + D*t <= hi) == ((lo - E)*e <= D*n <= (hi - E)*e)
plane-ahead: a plane is ahead, t > 0, if n and e have the same sign; with e > 0, if n > 0
  given e != 0, t*e == n
  then ((t > 0) == (n*e > 0)) and (not e > 0 or (t > 0) == (n > 0))
turned-plane: with D[a] < 0, complemented: n = ~k - ~E[a] and e = -D[a] give the same t
  given D < 0, E + D*t == k
  then t*(-D) == (-k - 1) - (-E - 1)
turned-bounds: with D[u] = -d, complemented: the bounds are swapped, and P = E + D t becomes ~E + d t
  given P == E + -d*t
  then (lo <= P <= hi) == (-hi - 1 <= (-E - 1) + d*t <= -lo - 1)
passed-bound: every point is past a near bound behind the eye, and none is within a far bound behind it
  given n > 0, e > 0, d >= 0
  then (near >= 0 or near*e <= d*n) and (far >= 0 or not d*n <= far*e)
nearer: n1/e1 < n2/e2 is equivalent to n1 e2 < n2 e1, and so are their equalities
  given e1 > 0, e2 > 0, t1*e1 == n1, t2*e2 == n2
  then ((t1 < t2) == (n1*e2 < n2*e1)) and ((t1 == t2) == (n1*e2 == n2*e1))
kept-is-nearest: a hit that replaces the kept one is nearer than all hits that were no nearer than that
  given e1 > 0, e2 > 0, e3 > 0, t1*e1 == n1, t2*e2 == n2, t3*e3 == n3, n1*e2 < n2*e1, n2*e3 <= n3*e2
  then n1*e3 < n3*e1
depth: the nearer of two hits along x has the smaller t, if D[x] is not 0
  given D != 0, t1 >= 0, t2 >= 0
  then (D*t1*(D*t1) < D*t2*(D*t2)) == (t1 < t2)
slope-ratios: a slope c times as long meets each point at t/c, in the same order
  given c > 0, s1*c == t1, s2*c == t2
  then E + D*c*s1 == E + D*t1 and (s1 < s2) == (t1 < t2)
mirrored-eye: reflected at k = E + D m: after s more, the ray is where that from 2k - E with -D is at m + s
  given k == E + D*m
  then k + -D*s == (2*k - E) + -D*(m + s)
mirrored-distance: the mirror is as far from the mirrored eye as from the eye, on the other side
  then k - (2*k - E) == -(k - E)
beyond-on-the-same-axis: planes n and m on one axis: t = n/e is beyond m/e if n > m
  given e > 0, t*e == n, s*e == m
  then ((t > s) == (n > m)) and ((t == s) == (n == m))
beyond-on-another-axis: beyond a mirror m ahead on u, t > m/d, if d n > m e; in its plane if equal
  given e > 0, d > 0, t*e == n, s*d == m
  then ((t > s) == (d*n > m*e)) and ((t == s) == (d*n == m*e))
order-kept: two distances compare as their products with the same e > 0
  given e > 0
  then ((a < b) == (a*e < b*e)) and ((a == b) == (a*e == b*e))
corner-rule: t > s, or t = s on an axis not met there, is m e <= d n, except equality on a met axis
  given e > 0, d > 0, t*e == n, s*d == m
  then (t > s or (t == s and not met)) == (m*e <= d*n and not (met and m*e == d*n))
eye-in-range: if -w r <= E <= w (r + 1) after r mirrors, no plane is further than w (r + 1); so for r + 1
  given r >= 0, w >= 0, -w*r <= E <= w*(r + 1), 0 <= k <= w
  then -w*(r + 1) <= 2*k - E <= w*(r + 2) and -w*(r + 1) <= k - E <= w*(r + 1)
product-fits: the product of one factor below A and one below B is below A B
  integers, given 0 <= x < A, 0 <= y < B
  then 0 <= x*y < A*B
product-in-range: the product of factors no further from 0 than A and B is no further from 0 than A B
  given -A <= x <= A, -B <= y <= B
  then -A*B <= x*y <= A*B
slope-in-range: a slope of parts up to M in magnitude is at most M times the sum of its factors
  given V >= 0, -C <= c <= C, -H <= h <= H, -M <= f <= M, -M <= r <= M, -M <= u <= M
  then -M*(V + C + H) <= V*f + c*r + h*u <= M*(V + C + H)
next-column: the product at the next column is the product plus its growth, R times the distance
  given now == n*D, next == now + n*R
  then next == n*(D + R)
complement-adds-one: a + b + 1 = a - ~b, and ~w + 1 = -w
  then a + b + 1 == a - (-b - 1) and (-b - 1) + 1 == -b
division: with w = e q + r, 0 <= r < e: k e <= w is k <= q; k e < w and w <= k e depend on r if k = q
  integers, given w == e*q + r, 0 <= r < e
  then ((k*e <= w) == (k <= q)) and ((k*e < w) == (k < q or (k == q and r > 0))) and ((w <= k*e) == (q < k
    or (q == k and r == 0)))
division-step: for the next bit b of the dividend, 2 r + b is the new remainder, less e if it is at least e
  integers, given p == e*q + r, 0 <= r < e, 0 <= b <= 1, 0 <= d <= 1, (d == 1) == (2*r + b >= e), s == 2*r + b - d*e
  then 2*p + b == e*(2*q + d) + s and 0 <= s < e
cell-number: floor(w/(e c)) = floor(floor(w/e)/c), so P = w/e is in the same cell as its whole part
  integers, given w == e*q + r, 0 <= r < e, q == c*i + j, 0 <= j < c
  then e*c*i <= w < e*c*(i + 1)
cell-parity: i + j is odd if exactly one of i and j is
  integers, given i == 2*f + a, j == 2*g + b, i + j == 2*h + c, 0 <= a <= 1, 0 <= b <= 1, 0 <= c <= 1
  then (c == 1) == (a != b)
digits-appended: appending digits of value m to n gives b n + m; a product p with d becomes b p + m d
  given p == n*d
  then (b*n + m)*d == b*p + m*d
quotient-truncated: with w = e q + r, 0 <= r < e, the quotient q is less than 1 below w/e
  given w == e*q + r, 0 <= r < e, x*e == w
  then 0 <= x - q < 1
quotient-nearest: with 2 w + e = 2 e q + r, 0 <= r < 2 e, the quotient q is at most one half from w/e
  given 2*w + e == 2*e*q + r, 0 <= r < 2*e, x*e == w
  then -1 <= 2*(x - q) < 1
way-of-magnitudes: if n and e have the same sign s, D n/e is the quotient of the magnitudes, with D's sign
  given s*s == 1, d*d == 1, e > 0, t*(s*e) == s*n
  then (d*A)*t*e == d*(A*n)
point-error: an origin off by c, along a by b, and a quotient off by q: the point is off by c + b A/e + q
  given e > 0, X*e == D*(k - I), Y*e == D*(k - i), P == O + X, -c <= o - O <= c, -A*b <= D*(I - i) <= A*b,
    -q <= p - (o + Y) <= q
  then -(c*e + A*b + q*e) <= (p - P)*e <= c*e + A*b + q*e
between: a linear value that is less than another at both ends of a row is less between them
  given 0 <= i <= N, a < b, a + N*g < b + N*h, x == a + i*g, y == b + i*h
  then x < y
shares: if m quarters are mirrored, a weight is the sum of what the mirror keeps and what it passes on
  given 4*T == (4 - m)*s + m*U, 4*v == w*m
  then w*T == (w - v)*s + v*U
sign-change: a line of growth -g from f = y, or g from f = -y - 1, keeps its sign for the next floor(y/g) columns
  integers, given g > 0, y >= 0, y == g*q + r, 0 <= r < g, i >= 0
  then ((y - i*g >= 0) == (i <= q)) and ((-y - 1 + i*g < 0) == (i <= q))
one-is-before: of two lines A - s and -A - t, with s + t = 1, exactly one is not negative
  integers, given 0 <= s <= 1, s + t == 1
  then (A - s >= 0) != (-A - t >= 0)
before-by-index: N2 e1 - N1 e2 - s >= 0: hit 1 is nearer, or as near and s = 0
  integers, given 0 <= s <= 1, A == n2*e1 - n1*e2
  then (A - s >= 0) == (n1*e2 < n2*e1 or (n1*e2 == n2*e1 and s == 0))
from-the-light: S = (E - L) e + D n leads from the light L to the point E + D n/e, which it meets at 1/e
  given t*e == n, s*e == 1, S == (E - L)*e + D*n
  then L + S*s == E + D*t
before-the-point: n/d is before 1/e if n e < d
  given d > 0, e > 0, t*d == n, s*e == 1
  then (t < s) == (n*e < d)
lit-side: eye and light are strictly on the same side of the plane k if the ray passes L before k
  given t > 0, D != 0, E + D*t == k
  then ((E - k)*(L - k) > 0) == ((D > 0 and L < k) or (D < 0 and k < L))
shadow-slope-in-range: with point and light in the world, 0 to w, the slope S = (P - L) e is within w e
  given e > 0, 0 <= P <= w, 0 <= L <= w, S == (P - L)*e
  then -w*e <= S <= w*e
"""
"""The lemmas: a name and the claim, then the hypotheses, separated by commas, and the conclusion."""


def _lemmas(text: str) -> Iterator[Lemma]:
    for entry in re.split(r"\n(?=\S)", text.strip()):
        title, body = re.sub(r"\n +", "\n", entry).split("\n", 1)
        label, _, claim = title.partition(": ")
        given, _, then = body.replace("\n", " ").partition("then ")
        integers = given.startswith("integers")
        given = given.removeprefix("integers, ").removeprefix("given ").strip()
        yield Lemma(label, claim, tuple(given.split(", ")) if given else (), then, integers)


LEMMAS = tuple(_lemmas(TEXT))
