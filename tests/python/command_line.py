# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line as tests call it, in this process."""

from stormfield.cli import main


def run(capsys, *arguments):
    """Exit status, standard output, standard error."""
    status = main([str(argument) for argument in arguments])
    captured = capsys.readouterr()
    return status, captured.out, captured.err


def refused(capsys, *arguments):
    """The one line of a user fault."""
    status, out, err = run(capsys, *arguments)
    assert status == 2 and out == ""
    assert err.count("\n") == 1 and err.startswith("stormfield: ")
    return err
