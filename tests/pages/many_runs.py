"""A campaign of many runs as results: overviews and what goes with them, without captures or datasets.

``python tests/pages/many_runs.py DIR [N]`` writes ``DIR/many``.
"""

import json
import math
import random
import sys
from datetime import UTC, datetime, timedelta
from pathlib import Path

from fogreduce.pages.overview import OVERVIEW, SCHEMA


def overview(campaign, run_id, number, rng):
    """A run of a unit whose bias moves a little with each turn-on; its 610th run is off."""
    rate = rng.choice([10.0, -10.0, 0.06, 0.0])
    drift = {
        axis: {"value": rng.gauss(0.0, 0.03), "error": rng.uniform(0.01, 0.04), "stated": 0.012}
        for axis in "xyz"
    }
    bias = {"x": 0.2, "y": -0.1, "z": 0.0}
    jump = 1.5 if number == 610 else 0.0
    offset = {
        axis: {
            "value": bias[axis] + rng.gauss(0.0, 0.05) + jump,
            "error": rng.uniform(0.01, 0.04),
            "stated": 0.5,
        }
        for axis in "xyz"
    }
    began = datetime(2020, 1, 6, 8, tzinfo=UTC) + timedelta(days=1.5 * number)
    warm = 22.0 + 4.0 * math.sin(number / 40.0) + rng.gauss(0.0, 0.3)
    flagged = {"spurious_gyro2": rng.randrange(1, 40), "unstable_intervals": 1} if rng.random() < 0.1 else {}
    return {
        "schema": SCHEMA,
        "version_id": f"{rng.getrandbits(64):016x}",
        "campaign": campaign,
        "run_id": run_id,
        "label": "made up",
        "unit": "TETRA-01",
        "started_at": began.strftime("%Y-%m-%dT%H:%M:%SZ"),
        "calibration": "TETRA-01@2012a",
        "software": "0.1.0",
        "code": "04458e1e1809c071",
        "axis": rng.choice("xyz"),
        "rates_deg_s": [rate],
        "duration_s": rng.choice([300.0, 600.0, 6000.0]),
        "records": 38400,
        "expected": 38400,
        "flagged": flagged,
        "drift": drift,
        "offset": offset,
        "noise": {f"gyro{k}": rng.gauss(0.0020 + 1e-4 * k, 2e-5) for k in range(1, 5)},
        "temperature": {"mean": warm, "low": warm - 0.8, "high": warm + 0.9},
    }


def many_runs(results, number, campaign="many", failing=20):
    """Results of so many runs; every so manyth failed."""
    rng = random.Random(1)
    for k in range(1, number + 1):
        run_id = f"run-{k:04d}"
        folder = results / campaign / run_id
        data = overview(campaign, run_id, k, rng)
        if k % failing == 0:
            (folder / "logs").mkdir(parents=True, exist_ok=True)
            said = f"many/runs/{run_id}/capture.fogcap: byte 0: found NOT A CAPTURE; expected FOGCAP1\n"
            (folder / "logs" / "ingest.log").write_text(said)
            continue
        for name in ("tables", "reports"):
            (folder / name).mkdir(parents=True, exist_ok=True)
        (folder / "manifest.json").write_text(json.dumps({"version_id": data["version_id"]}))
        (folder / "tables" / "drift.csv").write_text("")
        (folder / OVERVIEW).write_text(json.dumps(data))
        (folder / "index.html").write_text("")
    return results / campaign


if __name__ == "__main__":
    many_runs(Path(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 1000)
