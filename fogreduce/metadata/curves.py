"""A curves file (schema fogreduce/curves/1): mean curves from which a capture is reconstructed.

For runs whose raw data were never published but whose fitted curves were: each gyro's raw volts are
``a + b sin(c t + d) + e t`` (the paper's eq. 7), plus white noise, with the imperfections of a real link.
"""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, Strict, model_validator

from fogreduce.metadata.base import Model, NotNegative, NotNegatives, Reals
from fogreduce.metadata.faults import contradictions


class UnstableInterval(Model):
    """A stretch of time in which some gyros are noisier."""

    start_s: NotNegative = Field(description="its start, from the run's start [s]")
    end_s: float = Field(description="its end [s]")
    gyros: Annotated[tuple[Annotated[int, Field(ge=1)], ...], Strict(False)] = Field(
        min_length=1, description="the gyros concerned, counted from 1"
    )
    noise_factor: float = Field(gt=0, description="their noise in it, relative to outside")


class Curves(Model):
    """Mean curves and imperfections of every gyro; the lists hold one value a gyro."""

    schema_id: Literal["fogreduce/curves/1"] = Field(alias="schema", description="format of this file")
    source: str | None = Field(default=None, description="where the numbers come from")
    a_V: Reals = Field(description="offset [V]")
    b_V: Reals = Field(description="amplitude of the sine [V]")
    c_rad_s: Reals = Field(description="angular rate of the sine [rad/s]")
    d_rad: Reals = Field(description="phase of the sine [rad]")
    e_V_s: Reals = Field(description="slope [V/s]")
    sigma_V: NotNegatives = Field(
        description="standard deviation of the noise a sample [V], whole record, unstable intervals included"
    )
    seed: int = Field(default=0, ge=0, description="seed of the noise")
    missing_fraction: float = Field(
        default=0.0, ge=0, lt=1, description="fraction of answers that are missing"
    )
    spurious_fraction: float = Field(
        default=0.0, ge=0, lt=1, description="fraction of counts that are spurious"
    )
    unstable: Annotated[tuple[UnstableInterval, ...], Strict(False)] = Field(
        default=(), description="intervals in which gyros are noisier"
    )

    @property
    def n(self) -> int:
        """Number of gyros."""
        return len(self.a_V)

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        wrong = []
        for key in ("b_V", "c_rad_s", "d_rad", "e_V_s", "sigma_V"):
            if len(values := getattr(self, key)) != self.n:
                wrong.append((key, f"{len(values)} values", f"{self.n}, as many as a_V"))
        for k, interval in enumerate(self.unstable):
            if interval.end_s <= interval.start_s:
                wrong.append(
                    (f"unstable[{k}].end_s", repr(interval.end_s), f"more than {interval.start_s!r}")
                )
            if max(interval.gyros) > self.n:
                wrong.append(
                    (f"unstable[{k}].gyros", f"gyro {max(interval.gyros)}", f"one of {self.n} gyros")
                )
        if wrong:
            raise contradictions(wrong)
        return self
