"""What a certificate of a candidate record says, gathered once for the printed one and the digital one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from typing import Any

import numpy as np

import fogreduce
from fogreduce.calibrate.coefficients import Coefficients
from fogreduce.calibrate.derive import Derivation
from fogreduce.calibrate.readings import Readings
from fogreduce.metadata.calibration import CalibrationRecord, record_in
from fogreduce.metadata.certificate import Certificate

#: Expanded uncertainties are so many standard deviations; of a normal quantity 95.45 % lie inside (GUM 6.3).
COVERAGE_FACTOR, COVERAGE_PROBABILITY = 2.0, 0.9545
#: What stands where campaign.yaml says nothing.
NOT_STATED = "not stated"


@dataclass(frozen=True)
class Facts:
    """A certificate's content.

    Attributes
    ----------
    record : CalibrationRecord
        The candidate.
    record_sha256 : str
        Of its file.
    present_id, present_sha256 : str
        The record that it supersedes.
    coefficients : Coefficients
    about : Certificate
        Of campaign.yaml.
    campaign : str
    first, last : datetime
        From the first run's start to the last run's end.
    chi2, freedom, p_value : float
        Of the solution.
    procedure : str
        How it was calibrated, in words.
    temperature : str
        What is known of the temperature in the runs, in words.
    """

    record: CalibrationRecord
    record_sha256: str
    present_id: str
    present_sha256: str
    coefficients: Coefficients
    about: Certificate
    campaign: str
    first: datetime
    last: datetime
    chi2: float
    freedom: float
    p_value: float
    procedure: str
    temperature: str
    software: str


def certificate_facts(
    derivation: Derivation,
    record: dict[str, Any],
    record_sha256: str,
    present_sha256: str,
    about: Certificate,
    p_value: float,
) -> Facts:
    """The facts of a candidate record.

    Parameters
    ----------
    derivation : Derivation
    record : dict
        The record as plain data (`fogreduce.calibrate.record`).
    record_sha256, present_sha256 : str
        Of its file, and of the present record's.
    about : Certificate
    p_value : float
        Of the solution's chi-square.
    """
    one = derivation.readings[0]
    model = record_in(one.facts.raw_unit.name).from_data(record, "candidate record")
    starts = [reading.run.started_at for reading in derivation.readings]
    ends = [
        reading.run.started_at + timedelta(seconds=float(reading.facts.profile.end_s))
        for reading in derivation.readings
    ]
    assert model.pedigree is not None
    return Facts(
        record=model,
        record_sha256=record_sha256,
        present_id=one.record.record_id,
        present_sha256=present_sha256,
        coefficients=Coefficients.of(model),
        about=about,
        campaign=model.pedigree.campaign,
        first=min(starts).astimezone(UTC),
        last=max(ends).astimezone(UTC),
        chi2=derivation.solution.chi2,
        freedom=derivation.solution.freedom,
        p_value=p_value,
        procedure=(
            f"{len(starts)} runs on a rate table. Bias, scale factor and input axis of every gyro in one "
            "weighted least-squares solution over all runs, Earth's rate in the model; azimuth, latitude and "
            "table rate solved for within their stated uncertainties; turn-on scatter between runs estimated "
            "apart from noise within runs."
        ),
        temperature=temperature_in_words(derivation.readings),
        software=f"fogreduce {fogreduce.__version__}",
    )


def temperature_in_words(readings: Sequence[Readings]) -> str:
    """What is known of the temperature in the runs."""
    changes = [one.temperature for one in readings if one.temperature is not None]
    if not changes:
        return "not logged"
    most = max(float(np.abs(change).max()) for change in changes)
    logged = f"logged in {len(changes)} of {len(readings)} runs"
    return f"{logged}; the sensors' changed by up to {most:.1f} degC from a run's start"
