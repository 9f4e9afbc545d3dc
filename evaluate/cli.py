"""The command line `manipuzzle`, assembled from `evaluate.commands`.

A command's module is imported when the command is called, so that the list of commands appears at once.

Output: results on stdout, as a table or with `--json` as exactly one JSON document; everything else on stderr.
Exit status: 0 done, 1 a clean negative (something is not solved, not valid, not solvable), 2 bad input or usage, with
one line `error: ...` on stderr and nothing on stdout; 130 after Ctrl-C, which keeps the files written so far.
"""

import os
import sys
from importlib import import_module
from io import TextIOWrapper
from typing import Annotated, Any, NoReturn, cast

import typer
import typer.core
import typer.main

from evaluate.commands.options import application

COMMANDS = {
    "generate": "Generate solvable levels.",
    "compare-generators": "Compare the random baseline with the policies.",
    "train": "Train a policy that makes levels.",
    "levels": "Report on levels: solvable, statistics, duplicates.",
    "convert": "Convert levels and scenes to scene files.",
    "check": "Check scenes in a 2D physics preview.",
    "solve": "Plan, and verify the plans.",
    "verify": "Check a plan independently of the planner.",
    "render": "Draw levels, scenes and plans.",
    "export": "Export plans as tables over time or as PDDL.",
    "demonstrate": "Write down where a person would put the objects.",
    "space": "Draw free space, grasps and shortest paths.",
    "subgoals": "Draw the subgoals that a method proposes.",
    "tree": "Draw the search tree of a method.",
    "study": "Solve many scenes with many methods and seeds.",
    "report": "Tables, plots and a page of a study.",
    "trials": "List the trials of a study; write and verify their plans.",
    "merge": "Merge the results of several studies.",
    "diff": "Compare the results of two studies.",
    "bench": "Time the parts, with peers beside them.",
    "corpus": "Build the corpus of 360 levels, check it, plot it.",
    "data": "Print where the puzzles, policies and studies are.",
}
"""Names, with what the list of commands says of them; the module of `a-b` is `evaluate.commands.a_b`."""

NEGATIVE = 1
BAD_INPUT = 2
BROKEN_PIPE = 141
"""What a shell reports of a program that a closed pipe ended: 128 + SIGPIPE."""


class _ClosedPipe(Exception):  # noqa: N818  # no error
    """Whoever reads stdout has stopped."""


class _Command(typer.core.TyperCommand):
    """Stands for a command in the list, and imports it when it is called."""

    def make_context(self, info_name: str | None, *args: Any, **kwargs: Any) -> Any:
        module = import_module(f"evaluate.commands.{str(self.name).replace('-', '_')}")
        return typer.main.get_command(module.app).make_context(info_name, *args, **kwargs)


class _Commands(typer.core.TyperGroup):
    """Turns every way in which a command can end into an exit status and at most one line on stderr."""

    def main(self, *args: Any, **kwargs: Any) -> Any:
        try:
            status = super().main(*args, **{**kwargs, "standalone_mode": False})
            sys.stdout.flush()
        except ValueError as error:
            from pcg.errors import InputError  # noqa: PLC0415  # takes half a second, which help does not need

            if not isinstance(error, InputError):
                raise
            _fail(str(error))
        except typer.TyperException as error:
            _fail(error.format_message())
        except (BrokenPipeError, _ClosedPipe):
            # Python flushes stdout once more at its end, which would fail again.
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
            sys.exit(BROKEN_PIPE)
        except MemoryError as error:
            _fail(f"not enough memory: {error}".removesuffix(": "))
        except OSError as error:
            _fail(f"{error.filename}: {error.strerror}" if error.filename else str(error))
        sys.exit(status)

    def invoke(self, ctx: Any) -> int:
        try:
            return NEGATIVE if super().invoke(ctx) is False else 0
        except BrokenPipeError:
            # Typer would end with status 1, which says something else here.
            raise _ClosedPipe from None


def _fail(message: str) -> NoReturn:
    from pcg.printable import one_line  # noqa: PLC0415  # as above

    typer.echo(f"error: {one_line(message)}", err=True)
    sys.exit(BAD_INPUT)


app = application(
    cls=_Commands, pretty_exceptions_enable=False, context_settings={"help_option_names": ["-h", "--help"]}
)


def main() -> None:
    """Entry point of the `manipuzzle` program."""
    for stream in (sys.stdout, sys.stderr):
        # A name that the terminal's encoding lacks must not end the program.
        cast("TextIOWrapper", stream).reconfigure(errors="replace")
    app()


@app.callback(invoke_without_command=True)
def manipuzzle(
    context: typer.Context,
    *,
    version: Annotated[bool, typer.Option("--version", help="Print the version.")] = False,
) -> None:
    """Generate, convert, check, solve and evaluate sequential manipulation puzzles."""
    if version:
        from importlib.metadata import version as version_of  # noqa: PLC0415  # slow, and seldom needed

        typer.echo(version_of("manipuzzle"))
    elif context.invoked_subcommand is None:
        typer.echo(context.get_help())


for name, summary in COMMANDS.items():
    app.command(name, cls=_Command, short_help=summary)(lambda: None)
