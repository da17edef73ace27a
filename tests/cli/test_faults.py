"""Bad input: each fault answered by its own one line and exit status 2, and nothing half written."""

import faults_of_captures
import faults_of_metadata
import faults_of_options
import faults_of_stages
import pytest

from fogreduce.cli.main import main

CASES = [
    *faults_of_captures.FOGCAP,
    *faults_of_captures.CSV,
    *faults_of_metadata.RUN_YAML,
    *faults_of_metadata.CALIBRATION,
    *faults_of_options.LOGS,
    *faults_of_options.OPTIONS,
    *faults_of_stages.STAGES,
]


def files_below(folder) -> dict:
    """Every file below a folder with its bytes."""
    if not folder.is_dir():
        return {}
    return {path: path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_fault(case, small_lab, capsys):
    """The message is the whole of standard error; the results hold no more than before."""
    given = case.spoil(small_lab)
    arguments = given if isinstance(given, list) else small_lab.reduce()
    before = files_below(small_lab.root)
    status = main(arguments)
    said = capsys.readouterr()
    assert said.err == case.expected(small_lab) + "\n"
    assert said.out == ""
    assert status == 2
    assert files_below(small_lab.root) == before


def test_the_laboratory_itself_is_fine(small_lab, capsys):
    """Without a fault the same commands work: it is the fault that the table's messages answer."""
    assert main(small_lab.reduce()) == 0
    assert main(small_lab.manifest()) == 0
    # Its readings are made up, and so do not follow its command: that alone is said.
    assert all(line.startswith("red flag:") for line in capsys.readouterr().err.splitlines())


def test_forty_faults_at_least():
    names = [case.name for case in CASES]
    assert len(set(names)) == len(names) >= 40
