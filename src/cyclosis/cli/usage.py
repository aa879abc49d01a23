"""How a command line is parsed, how mistakes in it are reported, and how help is laid out."""

from __future__ import annotations

import re
from contextvars import ContextVar
from itertools import pairwise
from typing import Any

import typer
from typer.core import TyperCommand, TyperGroup

from ..model.errors import InputError, closest
from .terminal import writable

USAGE_ERROR: Any = typer.BadParameter.__mro__[1]
"""The parser's exception for a mistake on the command line."""
OUTPUT = "Output"
"""The group of options about what is written and printed."""


_asked: ContextVar[dict[str, Any]] = ContextVar("asked")


def asked() -> dict[str, Any]:
    """Return the command that is running, by its name, and the values of its options."""
    return _asked.get()


class Command(TyperCommand):
    """A command whose options never take another option as their value, and whose help is grouped."""

    def invoke(self, ctx: Any) -> Any:
        """Run the command, and remember what was asked."""
        _asked.set({"command": " ".join(ctx.command_path.split()[1:]), **ctx.params})
        return super().invoke(ctx)

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Parse the arguments of a command line. Raises `InputError` for a value that is not allowed."""
        words = self._apart(list(args))
        try:
            return super().parse_args(ctx, list(words))
        except USAGE_ERROR as error:
            error.ctx = error.ctx or ctx
            if isinstance(error, typer.BadParameter) and error.message and error.param is not None:
                raise _unusable(error, words) from error
            raise

    def format_options(self, ctx: Any, formatter: Any) -> None:
        """Write the options in their groups: those without a group first, the output last."""
        groups: dict[str, list[tuple[str, str]]] = {"Arguments": [], "Options": []}
        for param in self.get_params(ctx):
            record = param.get_help_record(ctx)
            if record is not None:
                argument = param.param_type_name == "argument"
                name = getattr(param, "rich_help_panel", None) or ("Arguments" if argument else "Options")
                shown = (param.metavar or param.name) if argument else record[0]
                groups.setdefault(name, []).append((shown, _spoken(record[1])))
        groups[OUTPUT] = groups.pop(OUTPUT, [])
        for name, records in groups.items():
            if records:
                with formatter.section(name):
                    formatter.write_dl(records)

    def collect_usage_pieces(self, ctx: Any) -> list[str]:
        """Return the arguments after the name of the command in the usage line."""
        return [_bare(piece) for piece in super().collect_usage_pieces(ctx)]

    def get_help(self, ctx: Any) -> str:
        """Return the help in characters that the terminal has."""
        return writable(super().get_help(ctx))

    def _apart(self, words: list[str]) -> list[str]:
        """Return the arguments with values of flags resolved, and refuse options given as values."""
        options: dict[str, Any] = {}
        for param in self.params:
            if param.param_type_name == "option":
                options |= dict.fromkeys([*param.opts, *param.secondary_opts], param)
        out: list[str] = []
        while words:
            word = words.pop(0)
            if word == "--":
                return [*out, word, *words]
            name, given, value = word.partition("=")
            option = options.get(name)
            if option is None or (given and not option.is_flag):
                out.append(word)
            elif option.is_flag:
                if option.secondary_opts and not given and words and words[0].lower() in ("true", "false"):
                    given, value = "=", words.pop(0)
                out.append(_flag(option, name, value) if given and option.secondary_opts else word)
            elif words and words[0].startswith("--"):
                remedy = f"give a value, written {name}=VALUE if it begins with two dashes"
                raise InputError(name, words[0], "a value and no further option", remedy)
            else:
                out += [word, *words[:1]]
                del words[:1]
        return out


class Group(TyperGroup):
    """A group of commands that suggests the closest one for a misspelt name."""

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """Return the command that the first word names. Raises `InputError` if there is none."""
        known = self.list_commands(ctx)
        if args[0] not in known and not ctx.resilient_parsing:
            raise InputError("command", args[0], "one of " + ", ".join(known), closest(args[0], known))
        return super().resolve_command(ctx, args)

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """Write every command with the whole first sentence of its help."""
        found = [(name, self.get_command(ctx, name)) for name in self.list_commands(ctx)]
        with formatter.section("Commands"):
            formatter.write_dl([(name, each.get_short_help_str(1000)) for name, each in found if each])

    def get_help(self, ctx: Any) -> str:
        """Return the help in characters that the terminal has."""
        return writable(super().get_help(ctx))


def sentence(error: Any) -> str:
    """Return one sentence for a mistake on the command line."""
    command = error.ctx.command_path if error.ctx is not None else "cyclosis"
    name = getattr(error, "option_name", None)
    if name is not None and hasattr(error, "possibilities"):
        known = [option for param in error.ctx.command.params for option in param.opts] if error.ctx else []
        remedy = _elsewhere(error.ctx, name) or closest(name, known)
        return str(InputError("option", name, f"an option of `{command}`", remedy))
    text = " ".join(error.format_message().split()).rstrip(".")
    return f"{text[:1].lower()}{text[1:]}; `{command} --help` shows the usage."


def _elsewhere(ctx: Any, name: str) -> str:
    """Return which commands of the same group take an option, in words, or "" if there are none."""
    group = ctx.parent.command if ctx is not None and ctx.parent is not None else None
    if not isinstance(group, TyperGroup):
        return ""
    siblings = [(each, group.get_command(ctx.parent, each)) for each in group.list_commands(ctx.parent)]
    found = [each for each, one in siblings if one and any(name in param.opts for param in one.params)]
    commands = [f"`{ctx.parent.command_path} {each}`" for each in found]
    if not commands:
        return ""
    *others, last = commands
    return f"leave it out; it belongs to {', '.join(others)}{' and ' if others else ''}{last}"


def asks_for_help(error: Any) -> bool:
    """Return whether a group of commands was called without arguments and shows its help."""
    return type(error).__name__ == "NoArgsIsHelpError"


def _spoken(text: str) -> str:
    """Return the help of an option with its range in words."""
    text = re.sub(r"([\w.+-]+)<=x<=([\w.+-]+)", r"from \1 to \2", text)
    return re.sub(r"x>=([\w.+-]+)", r"at least \1", text)


def _flag(option: Any, name: str, value: str) -> str:
    """Return the argument for a flag that was given a value."""
    if value.lower() not in ("true", "false"):
        remedy = f"write {option.opts[0]} alone, or {option.secondary_opts[0]}"
        raise InputError(option.name.rpartition("__")[2], value, "true or false", remedy)
    means = (name in option.opts) == (value.lower() == "true")
    word: str = option.opts[0] if means else option.secondary_opts[0]
    return word


def _unusable(error: Any, words: list[str]) -> InputError:
    """Return the error for a value that is not of the kind that its option takes."""
    names = error.param.opts
    given = [b for a, b in pairwise(words) if a in names]
    given += [word.partition("=")[2] for word in words if word.partition("=")[0] in names and "=" in word]
    text = " ".join(error.message.split()).partition(", unable")[0].rstrip(".")
    rule = text.removeprefix("Input should be ").rpartition(" is not ")[2]
    remedy = f"see `{error.ctx.command_path} --help`"
    return InputError(names[0], given[-1] if given else None, rule, remedy)


def _bare(piece: str) -> str:
    bare = piece.removesuffix("...")
    return bare[1:-1] + piece[len(bare) :] if bare[:1] == "{" and bare[-1:] == "}" else piece
