"""``fogreduce completion bash|zsh``: a script that completes commands, options and their choices.

It is made of the parsers themselves, and printed: a shell that has read it starts nothing to complete a word.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator

from fogreduce.cli.main import COMMANDS, NODES, parser_of

_SCRIPT = """\
# fogreduce's commands and options, for bash (and zsh, by its bashcompinit).
_fogreduce() {{
    local current=${{COMP_WORDS[COMP_CWORD]}} previous=${{COMP_WORDS[COMP_CWORD-1]}} words=
    if [ "$COMP_CWORD" -eq 1 ]; then
        words="{commands}"
    else
        case "${{COMP_WORDS[1]}} $previous" in
{choices}
        *)
            # What is no option is a file or folder.
            case "${{COMP_WORDS[1]}} $current" in
{options}
            esac
            ;;
        esac
    fi
    COMPREPLY=($(compgen -W "$words" -- "$current"))
}}
complete -o default -F _fogreduce fogreduce
"""
_ZSH = "autoload -U +X compinit && compinit\nautoload -U +X bashcompinit && bashcompinit\n"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments."""
    parser.add_argument(
        "shell",
        choices=("bash", "zsh"),
        help='the shell; in its start-up file: eval "$(fogreduce completion bash)"',
    )


def run(arguments: argparse.Namespace) -> int:
    """Print the script."""
    print((_ZSH if arguments.shell == "zsh" else "") + script(), end="")
    return 0


def script() -> str:
    """The script for bash."""
    parsers = _commands(parser_of(*COMMANDS, *NODES)[0])
    choices, options = [], []
    for name, parser in parsers.items():
        words = " ".join(_words(parser))
        options.append(f'            "{name} -"*) words="{words}" ;;')
        for action in _actions(parser):
            if action.choices and action.option_strings:
                asked = " | ".join(f'"{name} {option}"' for option in action.option_strings)
                choices.append(f'        {asked}) words="{_all(action)}" ;;')
            elif action.choices:
                choices.append(f'        "{name} {name}") words="{_all(action)} {words}" ;;')
    return _SCRIPT.format(commands=" ".join(COMMANDS), choices="\n".join(choices), options="\n".join(options))


def _all(action: argparse.Action) -> str:
    return " ".join(map(str, action.choices or ()))


def _actions(parser: argparse.ArgumentParser) -> Iterator[argparse.Action]:
    """Every argument of a command, and those of the commands below it."""
    for action in parser._actions:
        yield action
        if isinstance(action, argparse._SubParsersAction):
            for below in action.choices.values():
                yield from (deeper for deeper in _actions(below) if deeper.option_strings)


def _words(parser: argparse.ArgumentParser) -> list[str]:
    """Options of a command, and of the commands below it."""
    long = (option for action in _actions(parser) for option in action.option_strings if option[:2] == "--")
    return list(dict.fromkeys(long))


def _commands(parser: argparse.ArgumentParser) -> dict[str, argparse.ArgumentParser]:
    """Parsers of the commands, by name."""
    (commands,) = (action for action in parser._actions if isinstance(action, argparse._SubParsersAction))
    return dict(commands.choices)
