# SPDX-License-Identifier: MIT
"""`python -m raycaster.verif.text_lint`: find turns of phrase that CONTRIBUTING.md's writing rules replace.

Only patterns without false alarms are here, so each finding is to be rewritten.
"""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]

COUNTED = "pixel|bit|cycle|clock|frame|rectangle|file|sample|ray|scene|module|point|unit|adder|job|test|run|beat|line"
PER = "second|clock|frame|cycle|unit|module|line|row|pixel|channel|ray|time|scene|run|block|topic|group|view|design"

START = r"(?:^|[.;:] |\"\"\"|# |// |\| )"
PATTERNS = {
    START + r"Of (?!course\b)[a-z]": "start with the subject",
    r"(?:^|[.;] |\"\"\"|# |// )Where [a-z]": "start with the subject, or write 'if' or 'when'",
    r'"""(?:What|Where|How|Whether|Who)\b': "a docstring starts with a verb or a noun phrase",
    rf"\b(?:{COUNTED})s? an? (?:{PER})\b": "rates take 'per'",
    r"\bfore(?:tell|told)\b": "predicted, estimated",
    r"\bbut\ for\b": "except",
    r"\bin\ (?:the\ )?place\ of\b": "instead of",
    r"\bof\ one's\ own\b": "your own",
    r"\bh(?:old|olds|eld) [a-z ]*against\b": "compare with",
    r"\b(?:at\ hand|in\ earnest)\b": "leave it out",
}  # fmt: skip
"""Regular expressions, each with the remedy."""

KINDS = ".md", ".py", ".v", ".rdl", ".c", ".h", ".js", ".toml", ".cpp", ".html"
LEFT_OUT = "results", "web/page/vendor"
"""Folders with kept figures and with other people's files."""


def findings(text: str) -> list[tuple[int, str, str]]:
    """Return the line number, the phrase and the remedy of each finding."""
    return [
        (number, found[0].strip(), remedy)
        for number, line in enumerate(text.splitlines(), 1)
        for pattern, remedy in PATTERNS.items()
        for found in re.finditer(pattern, line)
    ]


def main() -> int:
    """Check the files that git tracks; return 1 if there are findings."""
    listed = subprocess.run(["git", "-C", str(ROOT), "ls-files", "-z"], capture_output=True, text=True, check=True)
    count = 0
    for name in sorted(set(listed.stdout.split("\0"))):
        path = ROOT / name
        if path.suffix not in KINDS or path.is_symlink() or not path.is_file() or name.startswith(LEFT_OUT):
            continue
        for number, phrase, remedy in findings(path.read_text()):
            print(f"{name}:{number}: {phrase!r}: {remedy}")
            count += 1
    return int(count > 0)


if __name__ == "__main__":
    sys.exit(main())
