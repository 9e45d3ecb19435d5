# SPDX-License-Identifier: GPL-3.0-or-later
"""Faults that the user can correct. Messages are shown as they are: they name the element or file, and the cure."""


class InputError(ValueError):
    """The user's data or files cannot be used. Loaded by native.py, the compiled core raises it too."""


class MissingPackageError(InputError):
    """A Python package that reads the file is not installed."""

    def __init__(self, message: str, package: str) -> None:
        super().__init__(message)
        self.package = package
