# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line reference, from the commands themselves."""

from typing import Any

import click

from .addon import command_group

HEAD = """# Command line

This page is made from the commands when the documentation is built; `stormfield COMMAND --help` says the same.

"""
TAIL = """
## Exit status

0
: done

2
: a fault in the input. One line on standard error says what is wrong, where, and the cure.

130
: stopped by Ctrl+C. Files that were being written are removed or can be continued with `--resume`.

1
: a fault of ours. Please report it with the text that is printed.
"""


def page() -> str:
    group = command_group()
    parts = [HEAD, "```text\nstormfield COMMAND [OPTIONS]\n```\n\n", escaped(group.help or ""), "\n\n"]
    parts += ["| command | what it does |\n|---|---|\n"]
    for name, command in sorted(group.commands.items()):
        parts.append(f"| [`stormfield {name}`](#stormfield-{name}) | {escaped(first_sentence(command.help))} |\n")
    parts += [section(name, command) for name, command in sorted(group.commands.items())]
    return "".join([*parts, TAIL])


def section(name: str, command: click.Command) -> str:
    arguments = [p for p in command.params if isinstance(p, click.Argument)]
    options = [p for p in command.params if isinstance(p, click.Option)]
    usage = " ".join(["stormfield", name, *(a.human_readable_name.upper() for a in arguments), "[OPTIONS]"])
    listed = "".join(f"{', '.join(f'`{o}`' for o in names(option))}\n: {said(option)}\n\n" for option in options)
    return f"\n## stormfield {name}\n\n```text\n{usage}\n```\n\n{escaped(command.help or '')}\n\n{listed}"


def names(option: click.Option) -> list[str]:
    """Every spelling, the value it takes after the first long one."""
    spelled = [*option.opts, *option.secondary_opts]
    if option.is_flag or option.count:
        return spelled
    value = "|".join(map(str, option.type.choices)) if isinstance(option.type, click.Choice) else _metavar(option)
    return [*spelled[:-1], f"{spelled[-1]} {value}"]


def said(option: click.Option) -> str:
    text = escaped(option.help or "")
    if option.required:
        text += " Required."
    if option.show_default and option.default is not None:
        text += f" Default: `{option.default}`."
    return text or "See above."


def first_sentence(text: str | None) -> str:
    return " ".join((text or "").split("\n\n")[0].split())


def escaped(text: str) -> str:
    """Text that Markdown shows as it is; `names` stay names."""
    parts = text.split("`")
    plain = parts[::2] if len(parts) % 2 else ["`".join(parts)]
    code = parts[1::2] if len(parts) % 2 else []
    for sign in "\\*_<>[]{}|#":
        plain = [each.replace(sign, "\\" + sign) for each in plain]
    joined = "".join(f"{each}`{name}`" for each, name in zip(plain, code, strict=False)) + plain[-1]
    return "\n".join(line.strip() for line in joined.splitlines())


def _metavar(option: Any) -> str:
    kinds = {"float": "NUMBER", "integer": "NUMBER", "path": "PATH", "text": "TEXT"}
    return option.metavar or kinds.get(option.type.name, option.type.name.upper())
