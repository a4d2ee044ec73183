# SPDX-License-Identifier: MIT
"""The browser in which pages are tested."""

from __future__ import annotations

import pytest

from raycaster.sim.ensure_tools import UserError
from raycaster.web.browser import browser_page


def test_a_script_that_fails_is_noticed():
    with pytest.raises(AssertionError, match="nowhere is not defined"), browser_page() as page:
        page.set_content("<script>nowhere()</script>")


def test_without_a_browser(monkeypatch):
    monkeypatch.setattr("raycaster.web.browser.find", lambda tool: None)
    with pytest.raises(UserError, match=r"^Chromium is missing[;,] .*$"), browser_page():
        pass
