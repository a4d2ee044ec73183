# SPDX-License-Identifier: MIT
"""A page in the system's Chromium, without a window, for tests and measurements in a browser."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from raycaster.errors import UserError, not_installed
from raycaster.sim.ensure_tools import find, missing

if TYPE_CHECKING:
    from playwright.sync_api import Page

FLAGS = ("--disable-gpu", "--disable-quic")
"""Flags in addition to those of Playwright, which has no window, sandbox or background traffic by default."""


@contextmanager
def browser_page() -> Iterator[Page]:
    """Yield an empty page; the browser closes with the context.

    Raises:
        UserError: Chromium or Playwright is missing; the message says what to install.
        AssertionError: the page's scripts left errors uncaught; raised at the end.
    """
    try:
        from playwright.sync_api import sync_playwright  # noqa: PLC0415 - needed only with a browser
    except ImportError:
        raise UserError(not_installed("Playwright", "test")) from None
    chromium = find("chromium")
    if chromium is None:
        raise missing("chromium")
    with sync_playwright() as playwright, playwright.chromium.launch(executable_path=chromium, args=FLAGS) as browser:
        page = browser.new_page()
        errors: list[str] = []
        page.on("pageerror", lambda error: errors.append(str(error)))
        yield page
        assert not errors, errors
