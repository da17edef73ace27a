"""The command ``fogreduce``: one subcommand a module, imported only when it is called."""

from __future__ import annotations

import argparse
import errno
import importlib
import os
import signal
import sys
from collections.abc import Sequence
from pathlib import Path
from types import ModuleType

from fogreduce import __version__
from fogreduce.cli.out_of_memory import memory_fault, out_of_memory
from fogreduce.cli.workflow_end import end_with_workflow
from fogreduce.errors import BadInput, Fault, FogreduceError

#: Subcommand -> (module of `fogreduce.cli`, what it does).
COMMANDS = {
    "init": ("init", "start a run.yaml or a campaign from a capture"),
    "check": ("check", "validate runs, campaigns or calibration records: every fault, with file and key"),
    "reduce": ("reduce", "reduce one run, all stages in one process"),
    "simulate": ("simulate", "predict the captures of a campaign"),
    "diagnose": ("diagnose", "say where, why and how far a campaign departs from its prediction"),
    "derive-calibration": ("derive_calibration", "derive a calibration record from a campaign"),
    "calibrations": ("calibrations", "list, show, compare and validate calibration records"),
    "impact": ("impact", "list every result that used a calibration record"),
    "report": ("report", "write a unit's test report from a campaign, as page, PDF and document"),
    "plan": ("plan", "plan a campaign that determines every quantity of a test report"),
    "allan": ("allan", "Allan deviation and noise coefficients of a reduced run, as tables and a figure"),
    "curve": ("curve", "fit the mean curve of a reduced run with its rate free, by Levenberg-Marquardt"),
    "archive": ("archive", "archive reduced campaigns: a BagIt bag each, with all that is needed to redo it"),
    "verify": ("verify", "verify an archive: every byte, completeness, and that its records agree"),
    "trace": ("trace", "trace one cell of a table back to the bytes that it came from"),
    "restore": ("restore", "make a working folder of an archive, or compare results with it"),
    "history": ("history", "show the versions of a run's results, and what changed between them"),
    "selftest": ("selftest", "compute published numbers: a page of expected and obtained"),
    "completion": ("completion", "print what makes bash or zsh complete these commands"),
}
#: Those that the workflow calls, as its nodes; by hand they serve to look into one.
NODES = {
    "manifest": ("manifest", "write the manifest of a run"),
    "stage": ("stage", "run one stage of the reduction"),
    "figures": ("figures", "draw the figures of a reduced run"),
    "page": ("page", "write the page of a run, of a campaign or of all campaigns"),
    "checksums": ("checksums", "take the checksums of a run's results and keep that version"),
    "summary": ("summary", "gather the drift tables of many runs"),
    "server": ("server", "serve the commands of a workflow's jobs from one warm process"),
}


#: What the system refuses because of what the user asked for -> what was expected.
_EXPECTED = {
    errno.ENOENT: "a file or folder that is there",
    errno.EACCES: "permission to read or write it",
    errno.EPERM: "permission to read or write it",
    errno.EISDIR: "a file",
    errno.ENOTDIR: "a folder",
    errno.EEXIST: "a folder",
    errno.EROFS: "a disk that may be written",
    errno.ENOSPC: "room on the disk",
    errno.EDQUOT: "room in the quota",
    errno.EFBIG: "a limit on the size of files that lets it be written",
    errno.ENAMETOOLONG: "a shorter name",
    errno.ELOOP: "links that lead somewhere",
}


def parser_of(*names: str) -> tuple[argparse.ArgumentParser, dict[str, ModuleType]]:
    """The parser of these commands, their modules imported; where none is named, of all without arguments."""
    width = max(map(len, COMMANDS | NODES)) + 2
    nodes = (f"  {name:<{width}}{text}" for name, (_, text) in NODES.items())
    parser = argparse.ArgumentParser(
        prog="fogreduce",
        description="Reduce rate-table runs of gyro units; all campaigns at once: snakemake --cores 2.",
        epilog="\n".join(["called by the workflow, as its nodes:", *nodes]),
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--version", action="version", version=f"fogreduce {__version__}")
    subparsers = parser.add_subparsers(dest="command", metavar="COMMAND", required=True)
    modules, every = {}, COMMANDS | NODES
    for command in names or every:
        file, text = every[command]
        about = text[0].upper() + text[1:] + "."
        if command in COMMANDS:
            subparser = subparsers.add_parser(command, help=text, description=about)
        else:  # without `help` it is not listed
            subparser = subparsers.add_parser(command, description=about)
        if names:
            modules[command] = importlib.import_module(f"fogreduce.cli.{file}")
            modules[command].add_arguments(subparser)
    return parser, modules


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; returns the exit status: 0 done, 2 bad input or usage, 1 anything else."""
    arguments = list(sys.argv[1:] if arguments is None else arguments)
    parser, modules = parser_of(*(word for word in arguments[:1] if word in COMMANDS | NODES))
    parsed = parser.parse_args(arguments)
    try:
        _no_empty_value(arguments)
        return int(modules[parsed.command].run(parsed))
    except FogreduceError as error:
        print(error, file=sys.stderr)
        return error.exit_status
    except KeyboardInterrupt:
        print("stopped", file=sys.stderr)
        return 1
    except Exception as error:
        if out_of_memory(error):
            print(memory_fault(parsed.command), file=sys.stderr)
            return 1
        if isinstance(error, OSError):
            return system_error(error)
        raise


def _no_empty_value(arguments: Sequence[str]) -> None:
    """An argument of no characters, as an unset variable of the shell gives it, is a folder to nobody."""
    for before, word in zip(["", *arguments], arguments, strict=False):
        option, equals, value = word.partition("=")
        if word == "" or (option.startswith("--") and equals and not value):
            named = option or (before if before.startswith("-") else "an argument")
            raise BadInput.at(named, "", found="nothing", expected="a value")


def system_error(error: OSError) -> int:
    """A file that cannot be read or written: bad input where the user can mend it, else the machine."""
    if isinstance(error, BrokenPipeError):
        # Whoever read our output has gone; nothing is left to say.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1
    file, found = str(error.filename or "a file"), error.strerror or str(error)
    expected = _EXPECTED.get(error.errno or 0)
    if error.errno in (errno.ENOTDIR, errno.EEXIST):
        # Not the file that was asked for, but what stands in its way.
        file = next((str(path) for path in (Path(file), *Path(file).parents) if path.exists()), file)
        found = "a file"
    print(Fault(file, "", found, expected or "a file that can be read or written"), file=sys.stderr)
    return 2 if expected else 1


def console() -> None:
    """Entry point of the installed command."""
    # One thread of linear algebra: the matrices are small, and starting threads costs 80 ms.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    # Pydantic's plugins, of which there are none, are looked for in every installed package: 25 ms.
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")
    # Ended by a scheduler, as by Ctrl-C: what is half written is taken away.
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    # (The warm server does so by itself, and may have no second thread.)
    if "FOGREDUCE_WORKFLOW" in os.environ and sys.argv[1:2] != ["server"]:
        end_with_workflow()
    sys.exit(main())
