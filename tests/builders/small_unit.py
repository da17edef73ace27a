"""A unit of four gyros with round numbers, a run of it as run.yaml, and the command line called by a test."""

import contextlib
import copy
import io

from fogreduce.cli.main import main

UNIT = "TETRA-01"
CALIBRATION = "TETRA-01@2012a"

RECORD = {
    "schema": "fogreduce/calibration/1",
    "unit": UNIT,
    "version": "2012a",
    "valid_from": "2012-06-01T00:00:00Z",
    "procedure": "certificate 7",
    "H": [[0.29, 0.29, 0.29, 0.5], [0.0, 0.71, -0.7, 0.0], [0.81, -0.41, -0.41, 0.0]],
    "scale_factor_V_per_deg_s": [0.075, 0.09, 0.092, 0.075],
    "bias_V": [1e-4, 6e-4, 2e-4, -4e-4],
}

_RUN = {
    "unit": UNIT,
    "started_at": "2014-05-12T13:00:00Z",
    "site": {"latitude_deg": -23.2},
    "orientation": {"x": "up", "z": "north"},
    "capture": {
        "file": "capture.fogcap",
        "format": "fogcap-1",
        "volts_per_count": 1e-7,
        "polarity": [1, -1, 1, 1],
    },
    "calibration": CALIBRATION,
}


def run_yaml(run_id, profile, rate_hz=16.0, **more):
    """run.yaml as plain data.

    Parameters
    ----------
    run_id : str
    profile : sequence of (float, float)
        Rates about x [deg/s], each with how long it lasts [s].
    rate_hz : float
        Sample rate.
    **more
        Keys that are added, or take the place of these.
    """
    data = {"schema": "fogreduce/run/1", "run_id": run_id} | copy.deepcopy(_RUN) | more
    steps = [{"rate_deg_s": rate, "duration_s": duration} for rate, duration in profile]
    data.setdefault("table", {"axis": "x", "profile": steps})
    data["capture"]["sample_rate_hz"] = rate_hz
    return data


def call(*arguments):
    """A command's exit status, standard output and standard error."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        status = main([str(argument) for argument in arguments])
    return status, out.getvalue(), err.getvalue()


def succeed(*arguments):
    """Standard output of a command that must succeed."""
    status, out, err = call(*arguments)
    assert status == 0, err
    return out
