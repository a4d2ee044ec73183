# SPDX-License-Identifier: MIT
"""Where the live scene is kept: shadow, pending and live words, and the rectangles as engines want them."""
