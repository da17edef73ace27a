"""Entries of an effects file: a wrong effect, channel, run or parameter is one clear error."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from fogreduce.effects.selection import select
from fogreduce.errors import BadInput
from fogreduce.metadata.effects_file import EffectEntry, EffectsFile

RUNS = ["1-xp", "2-xm", "still"]


def fault_of(**entry: Any) -> str:
    with pytest.raises(BadInput) as raised:
        select([EffectEntry(**entry)], RUNS, 4, "effects.yaml")
    text = str(raised.value)
    assert text.startswith("effects.yaml: effects[0].")
    assert "\n" not in text
    return text


@pytest.mark.parametrize(
    ("entry", "told"),
    [
        ({"effect": "telegraph"}, "effect: found telegraph"),
        ({"effect": "bias_rampp"}, "did you mean bias_ramp?"),
        (
            {"effect": "bias_ramp", "channels": ("gyro5",), "parameters": {"deg_h_per_h": 1.0}},
            "gyro1 to gyro4",
        ),
        ({"effect": "bias_ramp", "channels": ("gyro0",), "parameters": {"deg_h_per_h": 1.0}}, "found gyro0"),
        ({"effect": "bias_ramp", "channels": ("table",), "parameters": {"deg_h_per_h": 1.0}}, "found table"),
        (
            {"effect": "bias_ramp", "channels": ("gyro1", "gyro1"), "parameters": {"deg_h_per_h": 1.0}},
            "gyro1 again",
        ),
        (
            {"effect": "latitude_error", "channels": ("gyro1",), "parameters": {"deg": 1.0}},
            "expected [table]",
        ),
        ({"effect": "clock_error", "channels": ("table",), "parameters": {"ppm": 1.0}}, "expected [clock]"),
        ({"effect": "bias_ramp", "channels": ("gyro1",)}, "parameters.deg_h_per_h: found nothing"),
        (
            {"effect": "bias_ramp", "channels": ("gyro1",), "parameters": {"deg_h": 1.0, "deg_h_per_h": 1.0}},
            "did you mean deg_h_per_h?",
        ),
        ({"effect": "rotation_sense", "channels": ("table",), "parameters": {"ppm": 1.0}}, "none at all"),
        ({"effect": "bias_ramp", "channels": ("gyro1",), "parameters": {"deg_h_per_h": "2"}}, "a number"),
        ({"effect": "bias_ramp", "channels": ("gyro1",), "parameters": {"deg_h_per_h": True}}, "a number"),
        ({"effect": "spikes", "channels": ("gyro1",), "parameters": {"fraction": 1.5}}, "0 to 1"),
        ({"effect": "spikes", "channels": ("gyro1",), "parameters": {"fraction": -0.1}}, "0 to 1"),
        ({"effect": "lost_bits", "channels": ("gyro1",), "parameters": {"bits": 2.5}}, "a whole number"),
        ({"effect": "lost_bits", "channels": ("gyro1",), "parameters": {"bits": 32}}, "0 to 31"),
        ({"effect": "mount_rotation", "channels": ("table",), "parameters": {"mrad": 1.0}}, "three numbers"),
        (
            {"effect": "mount_rotation", "channels": ("table",), "parameters": {"mrad": (1.0, 2.0)}},
            "three numbers",
        ),
        (
            {
                "effect": "magnetic_bias",
                "channels": ("gyro1",),
                "parameters": {"deg_h": 1.0, "field_direction": (0.0, 0.0, 0.0)},
            },
            "a vector with a direction",
        ),
        (
            {"effect": "dead_zone", "channels": ("gyro1",), "parameters": {"deg_h": 1.0, "kind": "soft"}},
            "threshold, subtractive",
        ),
        (
            {"effect": "crosstalk", "channels": ("gyro1",), "parameters": {"ppm": 1.0, "source": "gyro1"}},
            "another gyro",
        ),
        (
            {"effect": "crosstalk", "channels": ("gyro1",), "parameters": {"ppm": 1.0, "source": "gyro9"}},
            "found gyro9",
        ),
        ({"effect": "channel_swap", "channels": ("gyro1",), "parameters": {"with": "gyro1"}}, "another gyro"),
        (
            {"effect": "channel_swap", "channels": ("gyro1", "gyro2"), "parameters": {"with": "gyro3"}},
            "one gyro",
        ),
        (
            {"effect": "common_noise", "channels": ("gyro1",), "parameters": {"correlation": 0.5}},
            "at least 2",
        ),
        ({"effect": "common_noise", "parameters": {"correlation": -0.5}}, "at least -0.333333 for 4 gyros"),
        ({"effect": "low_pass", "channels": ("gyro1",), "parameters": {"time_constant_ms": -1.0}}, "0 to"),
        (
            {
                "effect": "bias_ramp",
                "channels": ("gyro1",),
                "runs": ("9-zz",),
                "parameters": {"deg_h_per_h": 1.0},
            },
            "a run of the campaign",
        ),
    ],
)
def test_one_clear_error(entry: dict[str, Any], told: str) -> None:
    assert told in fault_of(**entry)


def test_every_fault_is_told_at_once() -> None:
    entries = [
        EffectEntry(effect="bias_ramp", channels=("gyro7",), parameters={}),
        EffectEntry(effect="nonsense"),
    ]
    with pytest.raises(BadInput) as raised:
        select(entries, RUNS, 4, "effects.yaml")
    assert [fault.where for fault in raised.value.faults] == [
        "effects[0].channels[0]",
        "effects[0].parameters.deg_h_per_h",
        "effects[1].effect",
    ]


def test_runs_by_name_pattern_and_all() -> None:
    def runs(*patterns: str) -> frozenset[str]:
        entry = EffectEntry(effect="rotation_sense", channels=("table",), runs=patterns)
        return select([entry], RUNS, 4, "effects.yaml")[0].runs

    assert runs("*") == set(RUNS)
    assert runs("still") == {"still"}
    assert runs("?-x*") == {"1-xp", "2-xm"}


def test_all_gyros_by_star() -> None:
    entry = EffectEntry(effect="bias_offset", parameters={"deg_h": 1.0})
    assert select([entry], RUNS, 4, "effects.yaml")[0].gyros == (0, 1, 2, 3)


def test_the_contracts_example(tmp_path: Path) -> None:
    file = tmp_path / "effects.yaml"
    file.write_text(
        "schema: fogreduce/effects/1\n"
        "effects:\n"
        '  - {effect: bias_ramp, channels: [gyro2], runs: ["*"], parameters: {deg_h_per_h: 1.2}}\n'
        '  - {effect: table_rate_error, channels: [table], runs: ["*"], parameters: {ppm: 35}}\n'
    )
    ramp, table = select(EffectsFile.from_yaml(str(file)).effects, RUNS, 4, file)
    assert (ramp.gyros, ramp.parameters) == ((1,), {"deg_h_per_h": 1.2})
    assert (table.gyros, table.parameters) == ((), {"ppm": 35.0})
