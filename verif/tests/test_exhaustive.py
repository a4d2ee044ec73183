# SPDX-License-Identifier: MIT
"""Short runs of the compiled arithmetic benches: they pass on the design and catch planted faults."""

import re

import pytest

from raycaster.errors import UserError
from raycaster.verif.exhaustive import run as exhaustive
from raycaster.verif.exhaustive.run import Bench, Mismatch, benches, build_bench, main, run
from raycaster.verif.seeds import repeat, seed

VECTORS = 200_000
BENCHES = {bench.label: bench for bench in benches(24 * VECTORS, VECTORS, 4)}


def run_briefly(bench: Bench, spoil=str) -> exhaustive.Outcome:
    return run(build_bench(bench, spoil), bench, seed())


@pytest.mark.slow_sets("divider-f0t-d1", "intersection-f0t-d3")
@pytest.mark.parametrize("label", ["divider-f0t-d1", "divider-f0n-d2", "intersection-f0t-d3", "intersection-f8n-d2"])
def test_a_part_of_the_vectors(label):
    outcome = run_briefly(BENCHES[label])
    assert outcome.vectors == VECTORS, repeat()
    assert VECTORS // 5 < outcome.valid < VECTORS, "expected quotients both with and without overflow"
    assert outcome.wrong == 0, repeat()


def test_every_operand_of_a_narrow_unit():
    bench = BENCHES["reduced-w3-f1n-d3"]
    outcome = run_briefly(bench)
    assert outcome.vectors == bench.total == 1 << (3 * 4 + 2 * 4)
    assert outcome.valid > bench.total // 8


def test_every_division_is_in_the_full_run():
    full = benches(1, 0, 4)
    assert [bench.total for bench in full if bench.kind == "divider"] == [67_592 * 512] * 6


@pytest.mark.slow_sets("divider-f0n-d2", "divider-f0t-d3", "intersection-f1t", "intersection-f4n")
@pytest.mark.parametrize(
    ("label", "before", "after"),
    [
        # The smallest quotient that overflows.
        ("divider-f0t-d1", r"too_large <= (.*) >= (\w+);", r"too_large <= \1 > \2;"),
        ("divider-f0n-d2", r"twice_remainder >= divisor_held", r"twice_remainder > divisor_held"),
        ("divider-f0t-d3", r"difference < 0", r"difference <= 0"),
        ("intersection-f0t-d1", r"stored_negative = stored_word", r"stored_negative = started_word"),
        ("intersection-f4n-d3", r"stored_towards && !overflow", r"stored_towards"),
        ("intersection-f1t-d2", r"stored_distance = stored_word", r"stored_distance = started_word"),
        ("reduced-w4-f0t-d2", r"backward = a - quotient", r"backward = a + quotient"),
    ],
)
def test_planted_faults_are_caught(label, before, after):
    spoilt = []

    def spoil(text: str) -> str:
        text, count = re.subn(before, after, text)
        spoilt.append(count)
        return text

    with pytest.raises(Mismatch, match=r"mismatch .*hardware .*expected .*; [1-9]\d* are wrong$"):
        run_briefly(BENCHES[label], spoil)
    assert sum(spoilt) == 1, "the fault must change exactly one place"


def test_the_command_reports(capsys):
    assert main(["--only", "divider-f0t-d3", "--divisions", str(VECTORS), "--seed", "7"]) == 0
    report = capsys.readouterr().out
    assert re.search(rf"divider-f0t-d3 +{VECTORS:,} +[\d,]+ +0 ", report)
    assert "--only divider-f0t-d3" in report and "--seed 7" in report


def test_the_command_fails_at_a_mismatch(monkeypatch, capsys):
    # Forked workers inherit the patch.
    monkeypatch.setattr(
        exhaustive, "build_bench", lambda bench: build_bench(bench, lambda text: text.replace("difference < 0", "1"))
    )
    assert main(["--only", "divider-f0t-d3", "--divisions", str(VECTORS), "--seed", "7"]) == 1
    complaint = capsys.readouterr().err
    assert re.match(r"divider-f0t-d3: mismatch \d+ / \d+: hardware", complaint)
    assert "repeat with: raycaster verify exhaustive --only divider-f0t-d3" in complaint


@pytest.mark.parametrize("arguments", [["--only", "adder"], ["--count", "0"], ["--divisions", "-1"], ["--seed", "-1"]])
def test_bad_options_are_refused(arguments):
    with pytest.raises(UserError):
        main(arguments)
