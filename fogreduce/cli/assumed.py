"""What `fogreduce check` says of values that nobody stated: a line each, however many runs leave it out."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

from fogreduce.errors import BadInput
from fogreduce.metadata.assumed import assumed_of_record, assumed_of_run
from fogreduce.metadata.folder import find_runs, load_calibration, load_run, read_calibration


def assumed_lines(path: Path, calibrations: Path) -> list[str]:
    """The assumed values of sound runs or of a calibration record; none for other files.

    Parameters
    ----------
    path : Path
        What was checked: a run, a campaign, a folder of campaigns, a file.
    calibrations : Path
        Folder of the calibration records.
    """
    if path.is_file() and path.name != "run.yaml":
        try:
            record = read_calibration(path)
        except BadInput:
            return []  # another kind of file
        return [str(item) for item in assumed_of_record(record)]
    path = path.parent if path.is_file() else path
    if (path / "run.yaml").exists():
        runs = [path]
    else:
        of_several = [runs.parent for runs in sorted(path.glob("*/runs"))]
        campaigns = [path] if (path / "runs").exists() else of_several
        runs = [run for campaign in campaigns for run in find_runs(campaign)[0]]
    loaded = [load_run(folder, need_capture=False) for folder in runs]
    of_records = [
        str(item)
        for record_id in sorted({run.calibration for run in loaded})
        for item in assumed_of_record(load_calibration(calibrations, record_id)[0])
    ]
    of_runs = Counter(str(item) for run in loaded for item in assumed_of_run(run))
    return of_records + [
        line if len(runs) == 1 else f"{line} ({times} of {len(runs)} runs)" for line, times in of_runs.items()
    ]
