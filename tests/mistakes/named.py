"""What tests of mistakes share: a mistake is an error or a warning that names it."""

import re

import pytest


def in_turn(table, quick):
    """Names of a table of mistakes, those that are not quick marked slow."""
    assert quick <= set(table)
    return [pytest.param(name, marks=[] if name in quick else pytest.mark.slow) for name in table]


def assert_named(run, change, pattern, tmp_path):
    """Check or reduce say something of the changed run that the pattern finds, and do not break."""
    status, err = run.with_mistake(change, tmp_path)
    assert status in (0, 2)
    assert "Traceback" not in err
    assert err.strip(), "nothing is said of it"
    assert re.search(pattern, err), err
