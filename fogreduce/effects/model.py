"""What an effect is: a named departure from the capture contract's chain, of one shape whatever it does.

An effect acts at one stage of the chain. Its forward function takes the value that the stage works on, and
returns it changed: ``forward(value, parameters, at) -> value``. Inputs are never changed in place.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import IntEnum
from typing import TYPE_CHECKING, Any

from fogreduce.effects.design import USUAL, Departures, Design

if TYPE_CHECKING:
    from fogreduce.effects.at import At

#: A parameter's value as validated: a number, three numbers (a tuple), or a word.
Value = float | int | str | tuple[float, ...] | None
Parameters = Mapping[str, Any]
#: The same where an effect's parameters are numbers alone.
Numbers = Mapping[str, float]
Forward = Callable[[Any, Any, "At"], Any]


class Stage(IntEnum):
    """Where in the chain an effect acts, in the order in which they act; and the value that it is handed."""

    MOTION = 0  #: table, site, mounting: `fogreduce.effects.motion.Motion`
    AXES = 1  #: direction of the gyro's input axis in the unit frame, (3,)
    BIAS = 2  #: the gyro's reading M_i [deg/s], (N,)
    SCALE = 3  #: M_i [deg/s], (N,)
    CROSSTALK = 4  #: M_i [deg/s], (N,); all gyros' readings before crosstalk in ``at.columns``
    DEAD_ZONE = 5  #: M_i [deg/s], (N,)
    LATENCY = 6  #: age of the gyro's answer [s], a number
    NOISE = 7  #: `fogreduce.effects.noise.NoiseLevels` of the gyro
    INTERFERENCE = 8  #: what is added to the noise [deg/s], (N,)
    FILTER = 9  #: raw readings v_i [raw unit], (N,)
    CONVERTER = 10  #: v_i [V], (N,)
    CLIPPING = 11  #: v_i [V], (N,)
    BITS = 12  #: counts, (N,) int32
    REPEATS = 13  #: counts, (N,) int32
    SPIKES = 14  #: counts, (N,) int32
    DROPOUTS = 15  #: counts, (N,) int32
    COLUMNS = 16  #: counts, (N,) int32; all gyros' counts before it in ``at.columns``
    POLARITY = 17  #: counts, (N,) int32
    STAMPS = 18  #: what the clock shows at each sample [s], (N,)


@dataclass(frozen=True)
class Parameter:
    """A parameter of an effect, in the words of the effects contract.

    Attributes
    ----------
    name, unit, meaning : str
        `unit` is empty for a pure number or a word.
    off : value or None
        The value at which the effect does nothing; None for a parameter of shape (a time constant, say).
    default : value or None
        Stands in where the parameter is not given; None for a parameter that must be given, or that is drawn
        for each run (`drawn`).
    low, high : float
        Bounds of what is accepted.
    realistic : (float, float) or None
        Sizes met in tactical-grade units (of the absolute value).
    kind : str
        ``number``, ``integer``, ``vector`` (three numbers), ``gyro`` (a gyro's name) or ``choice``.
    choices : tuple of str
        The words of a ``choice``.
    drawn : bool
        Where not given, it is drawn afresh in each run.
    words : str
        What stands before its value where it is not the effect's size: "time constant", say.
    frame : str
        Of a vector: ``unit`` (x, y, z) or ``room`` (east, north, up).
    bends : float or None
        In which the effect is not linear: the relative step of its finite difference, 0 for an instant.
    """

    name: str
    unit: str
    meaning: str
    off: Value = None
    default: Value = None
    low: float = -1e12
    high: float = 1e12
    realistic: tuple[float, float] | None = None
    kind: str = "number"
    choices: tuple[str, ...] = ()
    drawn: bool = False
    words: str = ""
    frame: str = ""
    bends: float | None = None

    def unit_in(self, raw_unit: str) -> str:
        """Its unit for gyros that are read in `raw_unit`, which then stands in place of V."""
        return raw_unit if self.unit == "V" else self.unit

    @property
    def required(self) -> bool:
        """Whether an entry has to give it."""
        return self.default is None and not self.drawn


#: A phase that is drawn for each run where it is not given.
PHASE = Parameter(
    "phase_rad", "rad", "phase at t = 0 (drawn for each run if not given)", drawn=True, words="phase"
)


@dataclass(frozen=True)
class Effect:
    """One effect of the catalogue.

    Attributes
    ----------
    name : str
        The contract's.
    stage : Stage
        Where it acts.
    equation : str
        What changes, in the contract's symbols.
    words : str
        The same for who does not know the symbols: the end of a sentence that begins with the channel.
    design : Design or None
        How a diagnosis looks for it in block means; None where it shows at the full rate alone.
    departures : Departures
        How far a real one may be from the formula.
    drifts : bool
        Whether a few of it together imitate a random process.
    of_record : bool
        Whether it is an error of what a calibration record states, which goes stale as a whole.
    process : (str, str) or None
        Of a random process: its kind (``flicker`` or ``walk``) and the parameter that is its size.
    unlogged : str
        What a temperature that nobody logged makes of it: ``warmth`` or ``warming``, ``gain`` before it where
        it goes with the reading.
    sheet : str
        The key of a part file (`fogreduce.metadata.part.Part`) that states the sizes of it.
    parameters : tuple of Parameter
    forward : callable
        ``forward(value, parameters, at) -> value``.
    source : str
        Where the realistic ranges come from.
    example : mapping
        Parameters of the catalogue page's plot: plain to see, not necessarily realistic.
    channels : str
        ``gyro``, ``table`` or ``clock``: what an entry's channels may name.
    needs_temperature : bool
        Whether the run must have a temperature log.
    mutual : str
        The parameter that names another gyro on which the effect acts alike, the two exchanged.
    smallest_group : int
        How many gyros an entry has to name at least.
    """

    name: str
    stage: Stage
    equation: str
    forward: Forward
    source: str
    parameters: tuple[Parameter, ...] = ()
    example: Mapping[str, Any] | None = None
    channels: str = "gyro"
    needs_temperature: bool = False
    mutual: str = ""
    smallest_group: int = 1
    words: str = ""
    design: Design | None = None
    departures: Departures = USUAL
    drifts: bool = False
    of_record: bool = False
    process: tuple[str, str] | None = None
    unlogged: str = ""
    sheet: str = ""

    @property
    def title(self) -> str:
        """Its name in words."""
        return self.name.replace("_", " ")

    @property
    def other(self) -> str:
        """The parameter that names another gyro; empty where none does."""
        return next((p.name for p in self.parameters if p.kind == "gyro"), "")

    @property
    def needs_pair(self) -> bool:
        """Whether it takes two gyros."""
        return bool(self.other) or self.smallest_group > 1

    @property
    def off(self) -> dict[str, Any] | None:
        """Parameters at which the effect does nothing; None where only its absence is nothing."""
        if not any(parameter.off is not None for parameter in self.parameters):
            return None
        values = dict(self.example or {})
        values.update({p.name: p.off for p in self.parameters if p.off is not None})
        return values
