"""Whether the compiled core is there, asked once: the panel says what is wrong and how to mend it."""

from functools import cache


@cache
def native_problem() -> str:
    """Empty when all is well, otherwise the reason and the cure in one sentence."""
    try:
        from .. import native

        native.check()
    except Exception as fault:
        return str(fault)
    return ""
