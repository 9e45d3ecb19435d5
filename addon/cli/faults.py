# SPDX-License-Identifier: GPL-3.0-or-later
"""Faults → one line and an exit status."""

import sys
from collections.abc import Callable

import click

from ..model.errors import InputError

DONE, OUR_FAULT, USER_FAULT, CANCELLED = 0, 1, 2, 130


class UnfinishedError(Exception):
    """What other machines had to do is not there: neither our fault nor one of the input. Ends with status 1."""


def as_exit_status(command: Callable[[], object]) -> int:
    try:
        status = command()
    except (KeyboardInterrupt, click.Abort):
        return _print_line("cancelled; what was finished is kept", CANCELLED)
    except click.ClickException as fault:
        return _print_line(fault.format_message(), USER_FAULT)
    except MemoryError:
        return _print_line("not enough memory; use fewer samples or a coarser mesh", USER_FAULT)
    except Exception as fault:
        kind = _kind(fault)
        if kind is None:
            raise
        return _print_line(str(fault), kind)
    return status if isinstance(status, int) else DONE


def _kind(fault: Exception) -> int | None:
    """The exit status of a fault that one line describes; None for mistakes in the program."""
    from ..native import NativeError

    if isinstance(fault, UnfinishedError):
        return OUR_FAULT
    if isinstance(fault, (InputError, NativeError)):
        return USER_FAULT
    # Exceptions of the compiled core, known by their names: asking the core would load it.
    names = {cls.__name__ for cls in type(fault).__mro__ if cls.__module__ == "stormfield_native"}
    if "Cancelled" in names:
        return CANCELLED
    return OUR_FAULT if "SolverError" in names else None


def _print_line(message: str, status: int) -> int:
    print("stormfield:", " ".join(message.split()), file=sys.stderr)
    return status
