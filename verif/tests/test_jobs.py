# SPDX-License-Identifier: MIT
"""Kept job results: an interrupted command does not compute finished jobs again."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from rich.console import Console

from raycaster.digests import digest
from raycaster.jobs import Kept, run_jobs


@pytest.fixture
def squares(tmp_path):
    """Return a function that squares numbers and returns the results and the numbers it computed."""

    def run(numbers, wrong=(), **options):
        computed = []

        def square(number):
            computed.append(number)
            if number in wrong:
                raise RuntimeError(number)
            return number**2

        kept = Kept(lambda number: tmp_path / f"{number}.pickle", **options)
        try:
            results = run_jobs("squares", square, numbers, lambda: ThreadPoolExecutor(1), Console(), kept=kept)
        except RuntimeError:
            results = None
        return results, computed

    return run


def test_kept_results_are_not_computed_again(squares, capsys):
    assert squares([1, 2, 3], wrong=[3]) == (None, [1, 2, 3])
    assert squares([0, 1, 2, 3]) == ([0, 1, 4, 9], [0, 3])
    assert "resumed: 2 of 4 squares are kept" in capsys.readouterr().out
    assert squares([0, 1, 2, 3], fresh=True) == ([0, 1, 4, 9], [0, 1, 2, 3])


def test_a_failure_is_retried(squares):
    def even(result):
        return result % 2 == 0

    assert squares([2, 3], complete=even)[1] == [2, 3]
    assert squares([2, 3], complete=even) == ([4, 9], [3])


def test_a_result_cut_off_is_computed_again(squares, tmp_path: Path):
    squares([5])
    whole = (tmp_path / "5.pickle").read_bytes()
    for cut in range(len(whole)):
        (tmp_path / "5.pickle").write_bytes(whole[:cut])
        assert squares([5]) == ([25], [5])


def test_a_digest_covers_values_and_contents(tmp_path: Path):
    (tmp_path / "a.v").write_text("module a;")
    before = digest("x", 1, tmp_path), digest(tmp_path / "a.v")
    assert digest("x", 2, tmp_path) != before[0]
    assert digest("x1", tmp_path) != digest("x", 1, tmp_path) == before[0]
    (tmp_path / "b.v").write_text("module b;")
    assert digest("x", 1, tmp_path) != before[0]
    assert digest(tmp_path / "a.v") == before[1]
