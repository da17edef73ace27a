"""Whatever stands in a record, a command ends with faults, not with a traceback and not in another folder."""

import json
import random

import pytest
from archived_lab import CAMPAIGN, describe, seal
from small_unit import call

RECORDS = (
    "data/archive.json",
    "data/ro-crate-metadata.json",
    f"data/results/{CAMPAIGN}/r1/manifest.json",
    f"data/results/{CAMPAIGN}/r1/outputs.json",
)
_ODD = (
    None,
    True,
    0,
    -1,
    1e308,
    2**70,
    "",
    "x",
    "../../../etc/hostname",
    "/etc/hostname",
    [],
    {},
    [[]],
    {"a": 1},
)


def spoil(data, draw):
    """Put something odd in a random place, take a key away, or double an entry of a list."""
    place = data
    while True:
        keys = list(place) if isinstance(place, dict) else list(range(len(place)))
        key = draw.choice(keys)
        inner = place[key]
        if isinstance(inner, dict | list) and inner and draw.random() < 0.8:
            place = inner
            continue
        what = draw.randrange(3)
        if what == 0:
            del place[key]
        elif what == 1 and isinstance(place, list):
            place.append(inner)
        else:
            place[key] = draw.choice(_ODD)
        return


@pytest.mark.parametrize("record", RECORDS)
@pytest.mark.parametrize("covered", [False, True])
def test_a_record_with_something_odd_in_it(bag, record, covered):
    draw = random.Random(f"{record} {covered}")
    path = bag / record
    sound = json.loads(path.read_text())
    for _ in range(12):
        data = json.loads(json.dumps(sound))
        spoil(data, draw)
        path.write_text(json.dumps(data))
        if covered and "crate" not in record:
            describe(bag)
        seal(bag)
        for command in (
            ("verify", bag),
            ("trace", bag, "r1:drift.csv:x@1:drift_deg_h"),
            ("history", bag, "--run", "r1"),
        ):
            status, out, err = call(*command)
            assert status in (0, 2), err
            assert "Traceback" not in err
            assert (status == 0) == (err == "")
            assert (status == 2) == (out == "")
