# SPDX-License-Identifier: MIT
"""Refuse to build from a copy whose symbolic links are lost; everything else is in pyproject.toml."""

import runpy
import sys
from pathlib import Path

from setuptools import setup

ROOT = Path(__file__).resolve().parent

if said := runpy.run_path(str(ROOT / "raycaster" / "places.py"))["links_complaint"](ROOT):
    sys.exit(f"error: {said}")
setup()
