"""Completion of a shell: commands, options of a command, choices of an option; files are the shell's own."""

from __future__ import annotations

import shutil
import subprocess

import pytest

from fogreduce.cli.completion import script
from fogreduce.cli.main import COMMANDS, NODES, main


def completed(*words: str) -> list[str]:
    """What bash proposes for the last of the words."""
    line = " ".join(f"'{word}'" for word in words)
    ask = (
        f"COMP_WORDS=({line}); COMP_CWORD={len(words) - 1}; _fogreduce; printf '%s\\n' \"${{COMPREPLY[@]}}\""
    )
    done = subprocess.run(
        ["bash", "-c", f"{script()}\n{ask}"], capture_output=True, text=True, check=True, timeout=60
    )
    assert done.stderr == ""
    return done.stdout.split()


@pytest.mark.parametrize(
    ("words", "proposed"),
    [
        (["fogreduce", "re"], ["reduce", "report", "restore"]),
        (["fogreduce", "check", "--c"], ["--calibrations"]),
        (["fogreduce", "check", "campaigns/a", "--c"], ["--calibrations"]),
        (["fogreduce", "trace", "--format", ""], ["text", "json", "prov"]),
        (["fogreduce", "calibrations", "d"], ["diff"]),
        (["fogreduce", "calibrations", "page", "--o"], ["--out"]),
        (["fogreduce", "check", "camp"], []),
    ],
)
def test_bash(words: list[str], proposed: list[str]) -> None:
    assert completed(*words) == proposed


def test_every_command_is_there() -> None:
    assert completed("fogreduce", "") == list(COMMANDS)
    for command in COMMANDS | NODES:
        assert "--help" in completed("fogreduce", command, "--h")


def test_zsh_reads_it(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["completion", "zsh"]) == 0
    said = capsys.readouterr().out
    assert said.splitlines()[1] == "autoload -U +X bashcompinit && bashcompinit"
    assert said.endswith(script())
    if (zsh := shutil.which("zsh")) is None:
        pytest.skip("no zsh here to read it")
    subprocess.run([zsh, "-n"], input=said, text=True, check=True)


def test_help_sets_the_nodes_apart(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["--help"])
    by_hand, by_workflow = capsys.readouterr().out.split("called by the workflow")
    for command in COMMANDS:
        assert f"\n    {command}" in by_hand
    for command in NODES:
        assert f"\n    {command} " not in by_hand
        assert f"\n  {command} " in by_workflow
