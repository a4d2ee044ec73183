# SPDX-License-Identifier: MIT
"""Web page that simulates the hardware in the browser."""
