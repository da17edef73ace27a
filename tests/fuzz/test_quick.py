"""Some hundred spoilt files, the same ones each time; `ten_thousand.py` and `coverage_guided.py` try more."""

import pytest
from hypothesis import HealthCheck, Phase, given, settings
from targets import TARGETS, made_ready, try_one

EXAMPLES = 4


@pytest.mark.parametrize("name", TARGETS)
def test_each_kind_of_file(name, fuzz_lab, csv_lab):
    """Refused with its one line, or accepted because the contract allows it; nothing half written."""
    lab, target = csv_lab if name == "csv-1" else fuzz_lab, TARGETS[name]
    made_ready(lab, target)

    @settings(
        max_examples=EXAMPLES * (1 + target.weight),
        derandomize=True,
        database=None,
        deadline=None,
        phases=[Phase.generate, Phase.shrink],
        suppress_health_check=list(HealthCheck),
    )
    @given(target.spoil(lab))
    def one(example):
        assert try_one(lab, target, example) == []

    one()
