# SPDX-License-Identifier: BSD-3-Clause
"""Pictures and files of fields and surfaces; nothing here knows how a field came about.

Nothing is imported by the package itself: who writes a file need not wait for what draws.
"""
