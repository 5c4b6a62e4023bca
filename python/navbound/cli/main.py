"""The command line. What its exit statuses mean stands in exit_status.py."""

from __future__ import annotations

import errno
import itertools
import os
import sys
from collections.abc import Callable
from typing import Annotated, Any

import typer

import navbound
from navbound import _core
from navbound.cli import (
    analyze,
    assess,
    calls,
    compare,
    demo,
    evaluate,
    example,
    export,
    fly,
    interrupt,
    lists,
    live,
    maps,
    predict,
    procedures,
    schema,
    show,
    study,
    verify,
    workbench,
)
from navbound.cli.parts import err_console
from navbound.errors import FormatError, InputError, InternalError, NavboundError, visible
from navbound.exit_status import OUR_BUG, STOPPED, UNREADABLE, USAGE, listed


def _version(value: bool) -> None:
    if value:
        sys.stdout.write(f"navbound {navbound.__version__}\n")
        raise typer.Exit


def _about(
    context: typer.Context,
    version: Annotated[bool, typer.Option("--version", help="Print the version, nothing else.", callback=_version, is_eager=True)] = False,
    python: Annotated[
        bool, typer.Option("--python", help=f"Before {', '.join(calls.COMMANDS)}: print the Python that does the same, and do nothing.")
    ] = False,
) -> None:
    del version
    if python:
        if context.invoked_subcommand not in calls.COMMANDS:
            raise InputError("--python", context.invoked_subcommand, domain=f"one of the commands {', '.join(calls.COMMANDS)} behind it")
        calls.print_calls()


_COMMANDS: dict[str, Callable[..., None]] = {
    "demo": demo.demo_command,
    "example": example.example_command,
    "fly": fly.fly_command,
    "analyze": analyze.analyze_command,
    "evaluate": evaluate.evaluate_command,
    "study": study.study_command,
    "methods": lists.methods_command,
    "levels": lists.levels_command,
    "scenarios": lists.scenarios_command,
    "schema": schema.schema_command,
    "verify": verify.verify_command,
    "show": show.show_command,
    "compare": compare.compare_command,
    "export": export.export_command,
    "map": maps.map_command,
    "predict": predict.predict_command,
    "open": workbench.open_command,
}
_GROUPS = {"procedures": procedures.app, "live": live.app, "assess": assess.app}


def _with(commands: dict[str, Callable[..., None]], groups: dict[str, typer.Typer]) -> typer.Typer:
    """The command line with these commands and groups of commands."""
    whole = typer.Typer(
        help=f"How wrong an aircraft's position may be, and when that is not good enough.\n\nExit status: {listed()}.",
        no_args_is_help=True,
        add_completion=False,
        pretty_exceptions_enable=False,
        rich_markup_mode=None,
    )
    whole.callback()(_about)
    for name, command in commands.items():
        whole.command(name)(command)
    for name, group in groups.items():
        whole.add_typer(group, name=name)
    return whole


app = _with(_COMMANDS, _GROUPS)


def _of(arguments: list[str]) -> typer.Typer:
    """The command line as far as these arguments need it: the options of a command that is not named are not read."""
    named = next((word for word in arguments if word != "--python"), "")
    if named in _COMMANDS:
        return _with({named: _COMMANDS[named]}, {})
    return _with({}, {named: _GROUPS[named]}) if named in _GROUPS else app


_FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
"""A disk that is full is no fault of ours, wherever it shows."""


def main() -> None:
    """Entry point: every refusal is a sentence, every surprise is ours."""
    interrupt.watch()
    try:
        status = _of(sys.argv[1:])(standalone_mode=False)
        if status == STOPPED:
            # The parser of the command line makes this status of a Ctrl-C.
            raise KeyboardInterrupt
        sys.exit(status if isinstance(status, int) else 0)
    except (typer.Abort, KeyboardInterrupt):
        err_console.print(interrupt.words(), markup=False, highlight=False, soft_wrap=True)
        sys.exit(STOPPED)
    except InternalError as e:
        if os.environ.get("NAVBOUND_TRACEBACK"):
            raise
        _die(f"{e} (set NAVBOUND_TRACEBACK=1 for the traceback)", OUR_BUG)
    except FormatError as e:
        _die(str(e), UNREADABLE)
    except InputError as e:
        _die(visible(e.words(_option)), USAGE)
    except NavboundError as e:
        _die(str(e), USAGE)
    except MemoryError:
        _die("the data need more memory than there is", UNREADABLE)
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    except (Exception, _core.PanicException) as e:
        _end_by(e)


def _end_by(surprise: BaseException) -> None:
    """A usage error of the parser, a full disk, or a fault of ours."""
    if isinstance(surprise, OSError) and surprise.errno in _FULL:
        _die(f"{surprise.filename or 'a file that was to be written'}: {surprise.strerror}", UNREADABLE)
    if hasattr(surprise, "format_message"):
        _die(_of_parser(surprise), USAGE)
    if os.environ.get("NAVBOUND_TRACEBACK"):
        raise surprise
    what = f"{type(surprise).__name__}: {surprise}"
    _die(f"this is a bug in navbound, please report it: {what} (set NAVBOUND_TRACEBACK=1 for the traceback)", OUR_BUG)


def _of_parser(refusal: Any) -> str:
    """The parser's refusal, with the value that was typed where it names none, and with what the argument is."""
    text: str = refusal.format_message()
    parameter: Any = getattr(refusal, "param", None)
    meant = getattr(parameter, "help", None)
    if not meant:
        return text
    typed = _typed(parameter.opts)
    if type(refusal).__name__ == "MissingParameter" or typed is None or typed in text:
        return f"{text.removesuffix('.')}: {meant}"
    number = _NUMBERS.get(getattr(getattr(parameter, "type_descriptor", None), "annotation", None))
    allowed = f": {text.partition(': ')[2] or text}" if number is None else f"; expected {number}"
    return f"{parameter.opts[0]} = {typed} is not accepted{allowed}; it is: {meant}"


_NUMBERS: dict[Any, str] = {float: "a number", int: "a whole number"}
"""What is allowed of an option, by its type."""


def _typed(options: list[str]) -> str | None:
    """What stands behind an option on the command line; None where it does not stand there exactly once."""
    arguments = sys.argv[1:]
    behind = [value for word, value in itertools.pairwise(arguments) if word in options]
    joined = [word.partition("=")[2] for word in arguments if word.partition("=")[0] in options and "=" in word]
    values = [*behind, *joined]
    return values[0] if len(values) == 1 else None


def _option(argument: str) -> str:
    """An argument as the command that runs has it: `--truth` for `truth`; unchanged where it is none of its options."""
    command: Any = typer.main.get_command(_of(sys.argv[1:]))
    for word in sys.argv[1:]:
        if word not in getattr(command, "commands", {}):
            break
        command = command.commands[word]
    # A group whose first word may be no command.
    command = getattr(command, "commands", {}).get(getattr(command, "unnamed", ""), command)
    names: dict[str, str] = {opt.removeprefix("--").replace("-", "_"): opt for parameter in command.params for opt in parameter.opts}
    names |= {parameter.name: parameter.opts[0] for parameter in command.params}
    return names.get({"columns": "column"}.get(argument, argument), argument)


def _die(message: str, status: int) -> None:
    err_console.print(f"navbound: {message}", markup=False, highlight=False, soft_wrap=True)
    sys.exit(status)
