"""What a capture says of itself against what run.yaml says of it."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING

from fogreduce.datasets.readers import Reader, open_capture
from fogreduce.datasets.readers.facts import CaptureFacts
from fogreduce.errors import BadInput, Fault
from fogreduce.metadata.facts import RunFacts
from fogreduce.units import instant_of

if TYPE_CHECKING:
    from fogreduce.metadata.run import Run

_SAME = 1e-9  # relative: a number printed with ten digits still agrees with its double


def open_run_capture(folder: Path, run: Run, facts: RunFacts) -> Reader:
    """The capture of a run in its folder.

    Raises
    ------
    BadInput
        As `open_capture`; a capture that contradicts run.yaml or the calibration record.
    """
    path = folder / run.capture.file
    reader = open_capture(path, run.capture.model_dump(mode="json"), facts.start_us)
    if wrong := contradictions(reader.facts, facts, path):
        raise BadInput(*wrong)
    return reader


def contradictions(capture: CaptureFacts, run: RunFacts, path: Path) -> list[Fault]:
    """Every contradiction between a capture's header and run.yaml or the calibration record.

    Parameters
    ----------
    capture : CaptureFacts
        From the capture's reader.
    run : RunFacts
        From run.yaml and calibration record.
    path : Path
        The capture, for the messages.
    """
    faults = []

    def compare(what: str, found: object, expected: object, key: str, same: bool) -> None:
        if found is not None and not same:
            faults.append(
                Fault(str(path), "header", f"{what} {found}", f"{expected}, as {key} of run.yaml says")
            )

    compare(
        "number of gyros", capture.n_gyros, run.n_gyros, "capture.polarity", capture.n_gyros == run.n_gyros
    )
    step = "volts_per_count" if run.raw_unit.name == "V" else "least_count"
    for what, found, expected, key in (
        ("sample rate", capture.sample_rate_hz, run.sample_rate_hz, "capture.sample_rate_hz"),
        (step.replace("_", " "), capture.least_count, run.capture_least_count, f"capture.{step}"),
    ):
        same = found is None or math.isclose(found, expected, rel_tol=_SAME)
        compare(what, found, expected, key, same)
    same = capture.raw_unit == run.captured_in
    compare("raw unit", capture.raw_unit, run.captured_in, "capture.raw_unit", same)
    compare("unit", capture.unit, run.unit, "unit", capture.unit == run.unit)
    if capture.start_us is not None and capture.start_us != run.start_us:
        faults.append(
            Fault(
                str(path),
                "header",
                f"start {_instant(capture.start_us)}",
                f"{_instant(run.start_us)}, as started_at of run.yaml says",
            )
        )
    return faults


def _instant(start_us: int) -> str:
    try:
        return instant_of(start_us).isoformat()
    except OverflowError:
        return f"{start_us} us since 1970"
