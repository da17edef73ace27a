"""What a capture says of itself, whatever its format; None where the format does not say."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class CaptureFacts:
    """Facts from a capture's own header.

    Attributes
    ----------
    n_gyros : int
    sample_rate_hz, least_count : float or None
    start_us : int or None
        Microseconds since 1970-01-01T00:00:00Z.
    unit : str or None
    raw_unit : str or None
        Of the readings, as `capture.raw_unit` of run.yaml names it.
    """

    n_gyros: int
    sample_rate_hz: float | None = None
    least_count: float | None = None
    start_us: int | None = None
    unit: str | None = None
    raw_unit: str | None = None
