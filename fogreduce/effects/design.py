"""What a diagnosis needs of an effect beside its forward function: its design columns and its departures.

Columns are finite differences of the simulator with the effect in it
(`fogreduce.diagnosis.which.catalogue`); an effect says here which parameter they scale, at which step it is
linear, and over which grid the others are searched.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

#: Points of a grid: from the length of the longest run [s], or from the largest reading [deg/h] for what acts
#: on the reading alone, to values of the parameters that nothing scales.
Grid = Callable[[float], tuple[Mapping[str, Any], ...]]


def one_point(longest_s: float) -> tuple[Mapping[str, Any], ...]:
    """The grid of an effect that is linear in all its numbers."""
    return ({},)


@dataclass(frozen=True)
class Design:
    """How an effect is looked for in block means.

    Attributes
    ----------
    scaled : str
        The parameter that its columns scale; empty for one that is there or not.
    step : float
        Size of it at which the finite difference is made.
    grid : callable
        The other parameters at which it is looked for.
    steps : tuple of float
        Where it is not linear in what is scaled: sizes at which differences are made, each a point by itself.
    rarer : float
        Prior share of each of `steps` but the first; 0: all are alike.
    vector : str
        What is scaled is a vector: ``unit``, its three components; ``across``, two at right angles to the
        gyro's axis; ``room``, a number along the direction `along`.
    along : str
        The parameter that is the direction of ``room``.
    wave : str
        The phase that makes a cosine and a sine of it.
    exact : str
        Differences of given sizes: ``switch``, there or not; ``reading``, what a function of the reading
        alone does, over `grid`; ``range``, limits, as shares `grid` of the largest raw reading; and
        ``volts``, scaled, what a function of the raw reading adds, over such shares.
    one_run : bool
        New in each run: it is looked for in one run at a time.
    begins : str
        The parameter that says when it begins; from then on it is constant.
    alike : bool
        Whether all gyros may have one amount of it.
    positive : bool
        It has no negative size.
    turning : bool
        Only a table that turns shows it.
    like : (str, str) or None
        Another effect and its parameter, whose columns it has in block means.
    least_deg_h : float
        Columns that are smaller everywhere are none [deg/h].
    shown : mapping or None
        Of its grid, the values at which its detectable amplitude is listed; None: the middle.
    """

    scaled: str = ""
    step: float = 1.0
    grid: Grid = one_point
    steps: tuple[float, ...] = ()
    rarer: float = 0.0
    vector: str = ""
    along: str = ""
    wave: str = ""
    exact: str = ""
    one_run: bool = False
    begins: str = ""
    alike: bool = False
    positive: bool = False
    turning: bool = False
    like: tuple[str, str] | None = None
    least_deg_h: float = 0.0
    shown: Mapping[str, tuple[float, ...]] | None = None


@dataclass(frozen=True)
class Departures:
    """How far a real effect may be from its formula: engineering estimates.

    Attributes
    ----------
    wanders : bool
        Whether its size may wander slowly in a run; what is there or not, or as wide as it is, does not.
    relative : float
        Of a full-rate effect's first number, relative: a filter's second pole, a line that drifts.
    bursts : float
        By how much the number of struck samples scatters more than single ones' would: they come in bursts.
    knee : float
        Of a limit, by how much what is beyond it still rises, relative; 0 for what is no limit.
    """

    wanders: bool = True
    relative: float = 0.0
    bursts: float = 1.0
    knee: float = 0.0


#: Those of most effects.
USUAL = Departures()
