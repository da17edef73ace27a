"""Which figures a run gets, and why one is left out."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from fogreduce.datasets.logs import read_table_log, read_temperature
from fogreduce.figures import (
    allan,
    angles,
    encoder,
    flags,
    gyro_raw,
    rates,
    residuals,
    temperature,
)
from fogreduce.figures.results import Results

#: Names of all figures, in the order in which a report shows them.
STEMS = (
    "gyro_volts",
    "rates",
    "angles",
    "residuals_gyros",
    "residuals_axes",
    "allan",
    "temperature",
    "encoder",
    "flags",
)

_ALWAYS: dict[str, Callable[[Results], Figure]] = {
    "gyro_volts": gyro_raw.draw,
    "residuals_gyros": residuals.draw_gyros,
    "allan": allan.draw,
    "flags": flags.draw,
}
_WITH_AXES: dict[str, Callable[[Results], Figure]] = {
    "rates": rates.draw,
    "angles": angles.draw,
    "residuals_axes": residuals.draw_axes,
}
#: Figure -> (key of run.yaml that names its log, reader, draw).
_WITH_LOG: dict[str, tuple[str, Callable[[Path], Any], Callable[..., Figure]]] = {
    "temperature": ("temperature", read_temperature, temperature.draw),
    "encoder": ("table_log", read_table_log, encoder.draw),
}


@dataclass(frozen=True)
class Plan:
    """Figures to be drawn, by name, and for each that is left out the reason."""

    drawn: dict[str, Callable[[], Figure]]
    left_out: dict[str, str]


def plan(results: Results, run_dir: Path | None) -> Plan:
    """What can be drawn of a run; `run_dir` holds its logs (None: figures of logs are left out)."""
    drawn: dict[str, Callable[[], Figure]] = {}
    left_out: dict[str, str] = {}
    for stem in STEMS:
        if stem in _ALWAYS:
            # Raw readings in another unit are not called volts, here as in the datasets.
            name = stem.replace("volts", results.setup.facts.raw_unit.variable)
            drawn[name] = partial(_ALWAYS[stem], results)
        elif stem in _WITH_AXES:
            if results.axes is None:
                left_out[stem] = "a unit of one or two gyros gives no x, y, z"
            else:
                drawn[stem] = partial(_WITH_AXES[stem], results)
        else:
            key, read, draw = _WITH_LOG[stem]
            name = results.setup.manifest["run"].get(key)
            if name is None:
                left_out[stem] = f"run.yaml names no {key}"
            elif run_dir is None:
                left_out[stem] = f"{name} is in the run's folder, which --run did not give"
            else:
                drawn[stem] = partial(draw, results, read(run_dir / name))
    return Plan(drawn, left_out)
