# SPDX-License-Identifier: MIT
"""What the exact engine rests on beyond its Verilog: facts of numbers of any size, each proved by two solvers.

The proofs at full width compare the hardware's products and comparisons with the specification's, and know nothing of
multiplication. These facts lead from there to the definition, which is of rational numbers.
"""

from __future__ import annotations

import ast
import importlib
import subprocess
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

from raycaster.output import emptied
from raycaster.tools import run_program

SOLVERS = ("z3", "cvc5")


@dataclass(frozen=True)
class Lemma:
    """A fact of numbers.

    `given` and `then` are written with Python's operators: what is proved, what a test evaluates and what a page shows
    is one text. == between two conditions is "if and only if"; there is no division.

    Attributes:
        label: its name.
        claim: in a few words.
        variables: separated by spaces.
        given: the hypotheses.
        then: the conclusion.
        integers: whether the variables are integers; else they are real numbers, so integers and rationals too.
        truths: variables that are true or false.
    """

    label: str
    claim: str
    variables: str
    given: tuple[str, ...]
    then: str
    integers: bool = False
    truths: str = ""

    name: ClassVar[str] = "lemmas"
    modules: ClassVar[tuple[str, ...]] = ()
    cut: ClassVar[tuple[str, ...]] = ()
    induction: ClassVar[int] = 0
    small: ClassVar[bool] = True

    def smt(self) -> str:
        """SMT-LIB that is unsatisfiable where the lemma holds."""
        sort = "Int" if self.integers else "Real"
        names = {name: sort for name in self.variables.split()} | {name: "Bool" for name in self.truths.split()}
        lines = ["(set-logic ALL)", "(set-option :produce-models true)"]
        lines += [f"(declare-const {name} {sort})" for name, sort in names.items()]
        lines += [f"(assert {self._translated(text)})" for text in self.given]
        lines += [f"(assert (not {self._translated(self.then)}))", "(check-sat)", f"(get-value ({' '.join(names)}))"]
        return "\n".join(lines) + "\n"

    def _translated(self, text: str) -> str:
        return _smt(ast.parse(text, mode="eval").body, "" if self.integers else ".0")


OPERATORS = {
    ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.And: "and", ast.Or: "or", ast.Not: "not", ast.USub: "-",
    ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">=", ast.Eq: "=", ast.NotEq: "distinct",
}  # fmt: skip


def _smt(node: ast.expr, point: str) -> str:
    """SMT-LIB of an expression, whose constants end with `point`."""
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
    raise ValueError(f"{ast.unparse(node)} is nothing that a lemma has")


def prove_lemma(lemma: Lemma, directory: Path, timeout: float) -> tuple[str, str]:
    """Have both solvers prove it.

    Args:
        lemma: what to prove.
        directory: replaced; holds what the solvers read.
        timeout: seconds that either may take.

    Returns:
        "proved", or which solver did what instead; and what the solver found, where that is a counterexample.
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
    # After "unsat" there are no values, and it complains.
    verdict, _, model = done.stdout.partition("\n")
    return verdict, model


def _cvc5(path: Path, timeout: float) -> tuple[str, str]:
    cvc5: Any = importlib.import_module("cvc5")  # an optional package, which says nothing of its types
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


# E is the eye, D the slope, t the ray's parameter, P = E + D t; k is a plane, n and e are such that t = n/e; lo and hi,
# near and far are bounds. An axis that is turned around has its coordinates complemented: ~x = -x - 1.
LEMMAS: tuple[Lemma, ...] = (
    Lemma(
        "bounds", "lo <= E + D n/e <= hi is (lo - E) e <= D n <= (hi - E) e",
        "lo hi E D n e t", ("e > 0", "t*e == n"),
        "(lo <= E + D*t <= hi) == ((lo - E)*e <= D*n <= (hi - E)*e)",
    ),
    Lemma(
        "plane-ahead", "a plane is ahead, t > 0, where n and e have one sign; with e > 0, where n > 0",
        "n e t", ("e != 0", "t*e == n"),
        "((t > 0) == (n*e > 0)) and (not e > 0 or (t > 0) == (n > 0))",
    ),
    Lemma(
        "turned-plane", "with D[a] < 0, complemented: n = ~k - ~E[a] and e = -D[a] give the same t",
        "k E D t", ("D < 0", "E + D*t == k"),
        "t*(-D) == (-k - 1) - (-E - 1)",
    ),
    Lemma(
        "turned-bounds", "with D[u] = -d, complemented: the bounds change places, and P = E + D t becomes ~E + d t",
        "lo hi E d P t", ("P == E + -d*t",),
        "(lo <= P <= hi) == (-hi - 1 <= (-E - 1) + d*t <= -lo - 1)",
    ),
    Lemma(
        "passed-bound", "a near bound behind the eye is passed; none is within a far bound behind it",
        "near far n e d", ("n > 0", "e > 0", "d >= 0"),
        "(near >= 0 or near*e <= d*n) and (far >= 0 or not d*n <= far*e)",
    ),
    Lemma(
        "nearer", "n1/e1 < n2/e2 is n1 e2 < n2 e1, and equal where those are",
        "n1 e1 t1 n2 e2 t2", ("e1 > 0", "e2 > 0", "t1*e1 == n1", "t2*e2 == n2"),
        "((t1 < t2) == (n1*e2 < n2*e1)) and ((t1 == t2) == (n1*e2 == n2*e1))",
    ),
    Lemma(
        "kept-is-nearest", "what takes the kept hit's place is nearer than all that the kept one was no further than",
        "n1 e1 t1 n2 e2 t2 n3 e3 t3",
        ("e1 > 0", "e2 > 0", "e3 > 0", "t1*e1 == n1", "t2*e2 == n2", "t3*e3 == n3", "n1*e2 < n2*e1", "n2*e3 <= n3*e2"),
        "n1*e3 < n3*e1",
    ),
    Lemma(
        "depth", "of two hits the nearer along x is that of the lesser t, where D[x] is not 0",
        "D t1 t2", ("D != 0", "t1 >= 0", "t2 >= 0"),
        "(D*t1*(D*t1) < D*t2*(D*t2)) == (t1 < t2)",
    ),
    Lemma(
        "slope-ratios", "a slope c times as long meets each point at t/c, in the same order",
        "E D c t1 s1 t2 s2", ("c > 0", "s1*c == t1", "s2*c == t2"),
        "E + D*c*s1 == E + D*t1 and (s1 < s2) == (t1 < t2)",
    ),
    Lemma(
        "mirrored-eye", "reflected at k = E + D m: after s more, the ray is where the one from 2k - E, -D is at m + s",
        "E D k m s", ("k == E + D*m",),
        "k + -D*s == (2*k - E) + -D*(m + s)",
    ),
    Lemma(
        "mirrored-distance", "the mirror is as far from the mirrored eye as from the eye, on the other side",
        "E k", (),
        "k - (2*k - E) == -(k - E)",
    ),
    Lemma(
        "beyond-on-the-same-axis", "planes n and m on one axis: t = n/e is beyond m/e where n > m",
        "n m e t s", ("e > 0", "t*e == n", "s*e == m"),
        "((t > s) == (n > m)) and ((t == s) == (n == m))",
    ),
    Lemma(
        "beyond-on-another-axis", "beyond a mirror m ahead on u, t > m/d, where d n > m e; in its plane where equal",
        "n e t m d s", ("e > 0", "d > 0", "t*e == n", "s*d == m"),
        "((t > s) == (d*n > m*e)) and ((t == s) == (d*n == m*e))",
    ),
    Lemma(
        "order-kept", "two distances compare as their products with one e > 0",
        "a b e", ("e > 0",),
        "((a < b) == (a*e < b*e)) and ((a == b) == (a*e == b*e))",
    ),
    Lemma(
        "corner-rule", "t > s, or t = s on an axis not met there, is m e <= d n but for equality on one that was met",
        "n e t m d s", ("e > 0", "d > 0", "t*e == n", "s*d == m"),
        "(t > s or (t == s and not met)) == (m*e <= d*n and not (met and m*e == d*n))",
        truths="met",
    ),
    Lemma(
        "eye-in-range", "after r mirrors -w r <= E <= w (r + 1) and no plane is further than w (r + 1); then for r + 1",
        "E k w r", ("r >= 0", "w >= 0", "-w*r <= E <= w*(r + 1)", "0 <= k <= w"),
        "-w*(r + 1) <= 2*k - E <= w*(r + 2) and -w*(r + 1) <= k - E <= w*(r + 1)",
    ),
    Lemma(
        "product-fits", "a factor up to a and one up to b have a product up to a b, which A B values hold",
        "x y A B", ("0 <= x < A", "0 <= y < B"),
        "0 <= x*y < A*B",
        integers=True,
    ),
    Lemma(
        "product-in-range", "of factors no further from 0 than A and B the product is no further than A B",
        "x y A B", ("-A <= x <= A", "-B <= y <= B"),
        "-A*B <= x*y <= A*B",
    ),
    Lemma(
        "slope-in-range", "a slope of parts no further from 0 than M is no further than M times the sum of its factors",
        "f r u V c h C H M", ("V >= 0", "-C <= c <= C", "-H <= h <= H", "-M <= f <= M", "-M <= r <= M", "-M <= u <= M"),
        "-M*(V + C + H) <= V*f + c*r + h*u <= M*(V + C + H)",
    ),
    Lemma(
        "next-column", "the product at the next column is the product and its growth, R times the distance",
        "n D R now next", ("now == n*D", "next == now + n*R"),
        "next == n*(D + R)",
    ),
    Lemma(
        "fold-at-a-mirror", "of x - E = s (X - E) + T a mirror at n makes 2 n - (x - E), with -s and 2 n - T",
        "X E s T n", ("s*s == 1",),
        "2*n - (s*(X - E) + T) == -s*(X - E) + (2*n - T)",
    ),
    Lemma(
        "fold-at-two-on-an-axis", "mirrors at the distances m and then n on one axis move the room by 2 (n - m)",
        "x m n", (),
        "2*n - (2*m - x) == x + 2*(n - m)",
    ),
    Lemma(
        "folded-way", "where s t D[a] + T[a] = n, D[a] (z t D[p] + T[p]) = s z n D[p] + T[p] D[a] - s z T[a] D[p]",
        "s z t Da Dp Ta Tp n", ("s*s == 1", "s*t*Da + Ta == n"),
        "Da*(z*t*Dp + Tp) == s*z*n*Dp + (Tp*Da - s*z*Ta*Dp)",
    ),
    Lemma(
        "folded-bounds", "with E = C + T: lo <= E + D n/e <= hi is (lo - C) e <= D n + T e <= (hi - C) e, or turned",
        "lo hi C T D n e t", ("e != 0", "t*e == n"),
        "(lo <= C + T + D*t <= hi) == ((e > 0 and (lo - C)*e <= D*n + T*e <= (hi - C)*e)"
        " or (e < 0 and (hi - C)*e <= D*n + T*e <= (lo - C)*e))",
    ),
    Lemma(
        "ahead-of-mirror", "what is beyond a mirror that is ahead, m/d > 0, or in its plane, is ahead",
        "n e m d", ("e > 0", "d > 0", "m > 0", "m*e <= d*n"),
        "n > 0",
    ),
    Lemma(
        "complement-adds-one", "a + b + 1 = a - ~b, and ~w + 1 = -w",
        "a b", (),
        "a + b + 1 == a - (-b - 1) and (-b - 1) + 1 == -b",
    ),
    Lemma(
        "division", "with w = e q + r, 0 <= r < e: k e <= w is k <= q; k e < w, and w <= k e, look at r where k = q",
        "w e q r k", ("w == e*q + r", "0 <= r < e"),
        "((k*e <= w) == (k <= q)) and ((k*e < w) == (k < q or (k == q and r > 0)))"
        " and ((w <= k*e) == (q < k or (q == k and r == 0)))",
        integers=True,
    ),
    Lemma(
        "division-step", "a bit more of the dividend: 2 r + b is compared with e, and is left as it is or e less",
        "p e q r b d s", ("p == e*q + r", "0 <= r < e", "0 <= b <= 1", "0 <= d <= 1", "(d == 1) == (2*r + b >= e)",
                          "s == 2*r + b - d*e"),
        "2*p + b == e*(2*q + d) + s and 0 <= s < e",
        integers=True,
    ),
    Lemma(
        "cell-number", "floor(w/(e c)) = floor(floor(w/e)/c), so the cell of P = w/e is that of the whole part of P",
        "w e q r c i j", ("w == e*q + r", "0 <= r < e", "q == c*i + j", "0 <= j < c"),
        "e*c*i <= w < e*c*(i + 1)",
        integers=True,
    ),
    Lemma(
        "cell-parity", "i + j is odd where just one of i and j is",
        "i j f g a b h c",
        ("i == 2*f + a", "j == 2*g + b", "i + j == 2*h + c", "0 <= a <= 1", "0 <= b <= 1", "0 <= c <= 1"),
        "(c == 1) == (a != b)",
        integers=True,
    ),
    Lemma(
        "digits-appended", "with digits of value m appended to n, b n + m, its product p with d is b p + m d",
        "n d p b m", ("p == n*d",),
        "(b*n + m)*d == b*p + m*d",
    ),
    Lemma(
        "quotient-truncated", "with w = e q + r, 0 <= r < e, the quotient q is less than 1 below w/e",
        "w e q r x", ("w == e*q + r", "0 <= r < e", "x*e == w"),
        "0 <= x - q < 1",
    ),
    Lemma(
        "quotient-nearest", "with 2 w + e = 2 e q + r, 0 <= r < 2 e, the quotient q is at most a half from w/e",
        "w e q r x", ("2*w + e == 2*e*q + r", "0 <= r < 2*e", "x*e == w"),
        "-1 <= 2*(x - q) < 1",
    ),
    Lemma(
        "way-of-magnitudes", "ahead n and e have one sign s, so D n/e is the quotient of magnitudes, with D's sign",
        "A n e t s d", ("s*s == 1", "d*d == 1", "e > 0", "t*(s*e) == s*n"),
        "(d*A)*t*e == d*(A*n)",
    ),
    Lemma(
        "point-error", "an origin off by c, along a by b, and a quotient off by q: the point is off by c + b A/e + q",
        "O o I i D A k e X Y P p b c q",
        ("e > 0", "X*e == D*(k - I)", "Y*e == D*(k - i)", "P == O + X", "-c <= o - O <= c", "-A*b <= D*(I - i) <= A*b",
         "-q <= p - (o + Y) <= q"),
        "-(c*e + A*b + q*e) <= (p - P)*e <= c*e + A*b + q*e",
    ),
    Lemma(
        "between", "what grows evenly and is less than another at both ends of a row is less between them",
        "x y a g b h N i",
        ("0 <= i <= N", "a < b", "a + N*g < b + N*h", "x == a + i*g", "y == b + i*h"),
        "x < y",
    ),
    Lemma(
        "shares", "of m quarters of a mirror: a weight's worth is what the mirror keeps of it and what it passes on",
        "w v m s T U", ("4*T == (4 - m)*s + m*U", "4*v == w*m"),
        "w*T == (w - v)*s + v*U",
    ),
    Lemma(
        "product-in-parts", "a product is that of the low part of a factor, and c times that of the high part",
        "n e l h c", ("e == l + c*h",),
        "n*e == n*l + c*(n*h)",
    ),
)  # fmt: skip
