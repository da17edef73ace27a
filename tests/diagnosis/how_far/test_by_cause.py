"""What each cause and each kind of cause closes."""

from __future__ import annotations

import pytest
from bench_lab import diagnosed, lab, simulated


def test_kinds_close_what_their_causes_do_and_open_into_them(tmp_path) -> None:
    """Offsets of two gyros and a ramp of a third: parts that touch nothing of each other add up."""
    lab(tmp_path)
    put = [
        {"effect": name, "channels": [gyro], "runs": ["*"], "parameters": {unit: size}}
        for name, gyro, unit, size in (
            ("bias_offset", "gyro1", "deg_h", 2.0),
            ("bias_offset", "gyro2", "deg_h", -1.5),
            ("bias_ramp", "gyro3", "deg_h_per_h", 120.0),
        )
    ]
    out = diagnosed(tmp_path, simulated(tmp_path, put))
    assert sorted((c["effect"], c["channels"][0]) for c in out["causes"]) == sorted(
        (e["effect"], e["channels"][0]) for e in put
    )
    kinds = {k["effect"]: k for k in out["closure"]["kinds"]}
    assert [k["rank"] for k in out["closure"]["kinds"]] == [1, 2]
    for effect, kind in kinds.items():
        members = [c["closure"] for c in out["causes"] if c["effect"] == effect]
        assert kind["removed"] == pytest.approx(sum(m["removed"] for m in members), abs=0.02)
        assert kind["alone"] == pytest.approx(sum(m["alone"] for m in members), abs=0.02)
    assert out["closure"]["kinds"][-1]["cumulative"] == pytest.approx(out["closure"]["fraction"])
    page = (tmp_path / "out-bench" / "index.html").read_text()
    part = page[page.index("Kind by kind") :]
    opened = part[part.index("<details>") :].split("</details>")[:2]
    assert sorted("gyro1" in text and "gyro2" in text for text in opened) == [False, True]
    drawn = (tmp_path / "out-bench" / "figures" / "waterfall.svg").read_text()
    for name in (
        "before, noise in it",
        "bias offset, 2 places",
        "what noise explains",
        "what is left of the gap",
    ):
        assert name in drawn
