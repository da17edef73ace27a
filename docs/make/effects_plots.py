"""Small plots for the page of effects: what an effect does to a standard run."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fogreduce.constants import MISSING_COUNT, SECONDS_PER_HOUR
from fogreduce.datasets.atomic import whole_file
from fogreduce.datasets.logs import TemperatureLog
from fogreduce.effects.model import Effect, Stage
from fogreduce.effects.selection import Action, action
from fogreduce.metadata.facts import RunFacts
from fogreduce.physics.quantization import raw_from_counts
from fogreduce.physics.scale_factor import rate_from_raw
from fogreduce.simulate.forward import ForwardRun
from fogreduce.simulate.nominal_noise import NoiseCoefficients

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Array = NDArray[np.float64]

RATE_HZ = 128.0
DURATION_S = 300.0
_COLOURS = ("#0b6e99", "#d1495b", "#66a182", "#8d6a9f")
_SAMPLE_STAGES = (Stage.BITS, Stage.REPEATS, Stage.SPIKES, Stage.DROPOUTS)

#: The published unit, rounded: a plot needs no more.
_CALIBRATION: dict[str, Any] = {
    "H": [[0.28917, 0.28923, 0.28761, 0.50173], [-0.00464, 0.70527, -0.70412, -0.00174],
          [0.81445, -0.40972, -0.41083, -0.00087]],
    "scale_factor_V_per_deg_s": [0.07523, 0.08964, 0.09189, 0.07455],
    "bias_V": [1.9e-4, 6.4e-4, 1.7e-4, -4.2e-4],
}  # fmt: skip
_RUN: dict[str, Any] = {
    "run_id": "standard",
    "unit": "TETRA-01",
    "started_at": "2014-05-12T13:00:00Z",
    "site": {"latitude_deg": -23.2},
    "table": {
        "axis": "x",
        "profile": [
            {"rate_deg_s": 5.0, "duration_s": 120.0},
            {"rate_deg_s": -5.0, "duration_s": 120.0},
            {"rate_deg_s": 0.0, "duration_s": 60.0},
        ],
    },
    "orientation": {"x": "up", "z": "north"},
    "capture": {"sample_rate_hz": RATE_HZ, "volts_per_count": 1e-7, "polarity": [1, -1, 1, 1]},
}
_QUIET = NoiseCoefficients([0.002] * 4, [0.03] * 4, [0.0] * 4)


def draw(effect: Effect, path: Path) -> None:
    """Write the plot of one effect."""
    import matplotlib as mpl

    mpl.use("Agg")
    from matplotlib import pyplot as plt

    figure, axes = plt.subplots(figsize=(5.6, 1.9), dpi=100, layout="constrained")
    axes.set_title(_caption(effect), fontsize=7.5, loc="left", color="0.3")
    if effect.stage == Stage.NOISE:
        _noise(axes, effect)
    elif effect.stage == Stage.STAMPS:
        _stamps(axes, effect)
    elif effect.stage in _SAMPLE_STAGES:
        _samples(axes, effect)
    else:
        _change(axes, effect)
    axes.tick_params(labelsize=7)
    axes.spines[["top", "right"]].set_visible(False)
    axes.xaxis.label.set_fontsize(7.5)
    axes.yaxis.label.set_fontsize(7.5)
    with whole_file(path) as temporary:
        figure.savefig(temporary, format="png", metadata={"Software": None})
    plt.close(figure)


def _caption(effect: Effect) -> str:
    def text(value: object) -> str:
        if isinstance(value, float):
            return f"{value:g}"
        if isinstance(value, tuple):
            return "[" + ", ".join(f"{part:g}" for part in value) + "]"
        return str(value)

    given = ", ".join(f"{name} = {text(value)}" for name, value in (effect.example or {}).items())
    return f"{effect.name}: {given}" if given else effect.name


def _action(effect: Effect) -> Action:
    channels = ["gyro2", "gyro3"][: effect.smallest_group] if effect.channels == "gyro" else [effect.channels]
    return action(effect.name, channels, ["standard"], effect.example or {}, 4)


def _capture(actions: list[Action], *, noise: bool) -> tuple[Array, NDArray[np.int32]]:
    """Stamps [s] and counts (4, N) of the standard run."""
    time = np.arange(0.0, DURATION_S + 1.0)
    warmed = 3.0 * -np.expm1(-time / 120.0)
    log = TemperatureLog(time, 31.0 + warmed, 25.0 + warmed)
    facts = RunFacts.of(_RUN, _CALIBRATION)
    blocks = list(ForwardRun(facts, _QUIET if noise else None, actions, log).blocks())
    stamps = np.concatenate([block.time_us for block in blocks]) * 1e-6
    return stamps, np.concatenate([block.counts for block in blocks], axis=1)


def _rates(counts: NDArray[np.int32]) -> Array:
    """Readings [deg/h], (4, N); NaN = no answer."""
    facts = RunFacts.of(_RUN, _CALIBRATION)
    volts = raw_from_counts(counts, facts.least_count)
    return rate_from_raw(volts, facts.scale_factor, facts.bias, facts.polarity) * SECONDS_PER_HOUR


def _label(axes: Axes, values: Array, what: str) -> float:
    """Label the ordinate in deg/h or, for large values, deg/s; the factor to plot with."""
    largest = float(np.nanmax(np.abs(values)))
    axes.set_xlabel("time / s")
    axes.set_ylabel(f"{what} / {'deg/s' if largest > 1000 else 'deg/h'}")
    return 1.0 / SECONDS_PER_HOUR if largest > 1000 else 1.0


def _change(axes: Axes, effect: Effect) -> None:
    """What changes in each gyro's reading, quarter-second means."""
    stamps, counts = _capture([_action(effect)], noise=False)
    change = _rates(counts) - _rates(_capture([], noise=False)[1])
    n = 32
    means = change[:, : len(stamps) // n * n].reshape(4, -1, n).mean(axis=2)
    factor = _label(axes, means, "change")
    for gyro, row in enumerate(means):
        touched = np.abs(row).max() > 0
        colour = _COLOURS[gyro] if touched else "0.8"
        axes.plot(
            (np.arange(len(row)) + 0.5) * n / RATE_HZ,
            row * factor,
            color=colour,
            lw=1.0,
            zorder=2 if touched else 1,
            label=f"gyro {gyro + 1}" if touched else None,
        )
    axes.legend(fontsize=6.5, frameon=False, loc="upper left", bbox_to_anchor=(1.0, 1.05))


def _noise(axes: Axes, effect: Effect) -> None:
    """The noise, second means, beside what it was; of several gyros 60 s together, to see what they share."""
    nothing = _rates(_capture([], noise=False)[1])
    acting = _action(effect)
    shown = slice(None) if len(acting.gyros) == 1 else slice(60)
    before = (_rates(_capture([], noise=True)[1]) - nothing).reshape(4, -1, 128).mean(axis=2)[:, shown]
    after = (_rates(_capture([acting], noise=True)[1]) - nothing).reshape(4, -1, 128).mean(axis=2)[:, shown]
    factor = _label(axes, after[list(acting.gyros)], "noise")
    time = np.arange(before.shape[1]) + 0.5
    if len(acting.gyros) == 1:
        axes.plot(time, before[acting.gyros[0]] * factor, color="0.75", lw=0.8, label="without")
    for gyro in acting.gyros:
        axes.plot(time, after[gyro] * factor, color=_COLOURS[gyro], lw=0.8, label=f"gyro {gyro + 1}")
    axes.legend(fontsize=6.5, frameon=False, loc="upper left", bbox_to_anchor=(1.0, 1.05))


def _stamps(axes: Axes, effect: Effect) -> None:
    """Stamp less true time."""
    stamps, counts = _capture([_action(effect)], noise=False)
    true = np.arange(counts.shape[1]) / RATE_HZ
    axes.plot(true, (stamps - true) * 1e3, color=_COLOURS[0], lw=1.0)
    axes.set_xlabel("true time / s")
    axes.set_ylabel("stamp - true / ms")


def _samples(axes: Axes, effect: Effect) -> None:
    """Single samples of gyro 2: half a second of them, or the whole run where the effect is rare."""
    _, counts = _capture([_action(effect)], noise=True)
    rare = effect.stage in (Stage.SPIKES, Stage.DROPOUTS)
    some = slice(None) if rare else slice(64 * 100, 64 * 101)
    rate, time = _rates(counts)[1, some], (np.arange(counts.shape[1]) / RATE_HZ)[some]
    before = _rates(_capture([], noise=True)[1])[1, some]
    factor = _label(axes, rate, "gyro 2")
    style = {"lw": 0.6} if rare else {"lw": 0.6, "marker": ".", "ms": 3.0}
    if not rare:
        axes.plot(time, before * factor, color="0.75", label="without", **style)
    axes.plot(time, rate * factor, color=_COLOURS[1], label="with", **style)
    missing = counts[1, some] == MISSING_COUNT
    if missing.any():
        low = np.full(int(missing.sum()), float(np.nanmin(rate)) * factor * 1.2)
        axes.plot(time[missing], low, "|", color="k", ms=4.0, label="no answer")
    axes.legend(fontsize=6.5, frameon=False, loc="upper left", bbox_to_anchor=(1.0, 1.05))
