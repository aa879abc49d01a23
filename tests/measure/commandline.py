"""The command line in this process: every command that there is, and what one prints."""

from __future__ import annotations

import ctypes
import io
import os
import sys
from contextlib import contextmanager
from unittest.mock import patch

import typer

from cyclosis import cli

WHOLE = typer.main.get_command(cli.app)
"""The command line, built once: building it takes longer than most of what is asked of it."""


def every(command=WHOLE, words=()):
    """Yield the words and the command of each command that does something, and of each group."""
    yield words, command
    for name, below in getattr(command, "commands", {}).items():
        yield from every(below, (*words, name))


COMMANDS = {" ".join(words): command for words, command in every() if not hasattr(command, "commands")}
"""Every command by its words, groups left out."""


def call(*arguments, encoding="utf-8"):
    """Run the command line; return its exit code, and the bytes that it wrote to output and errors."""
    kept = sys.argv, sys.stdout, sys.stderr
    out, err = io.BytesIO(), io.BytesIO()
    sys.argv = ["cyclosis", *map(str, arguments)]
    sys.stdout, sys.stderr = (io.TextIOWrapper(raw, encoding, write_through=True) for raw in (out, err))
    try:
        with patch("typer.main.get_command", lambda app: WHOLE):
            cli.main()
    except SystemExit as end:
        return end.code or 0, out.getvalue(), err.getvalue()
    finally:
        sys.argv, sys.stdout, sys.stderr = kept
    raise AssertionError("the command line ends with an exit code")


def said(*arguments):
    """Run the command line; return its exit code, its output, and its errors, as text."""
    code, out, err = call(*arguments)
    return code, out.decode(), err.decode()


@contextmanager
def mortal():
    """Obey the rights of files, also as root: on Linux without the capabilities to pass over them."""
    if getattr(os, "geteuid", lambda: 1)() != 0 or sys.platform != "linux":
        yield
        return
    libc, head, held = ctypes.CDLL(None), (ctypes.c_uint32 * 2)(0x20080522, 0), (ctypes.c_uint32 * 6)()
    libc.capget(head, held)
    kept = held[0]
    held[0] &= ~0b110  # CAP_DAC_OVERRIDE and CAP_DAC_READ_SEARCH, of those in effect
    libc.capset(head, held)
    try:
        yield
    finally:
        held[0] = kept
        libc.capset(head, held)
