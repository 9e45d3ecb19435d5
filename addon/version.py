# SPDX-License-Identifier: GPL-3.0-or-later
"""The version of the package, in a module that imports nothing."""

VERSION = "0.2.0"
