"""Faults a user can mend. The message is shown as it is: it names the element or file, and the cure."""


class InputError(ValueError):
    """The user's data or files cannot be used."""
