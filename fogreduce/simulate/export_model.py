"""The unit's model as JSON, for people who build it into their own attitude simulator.

Nominal: the calibration record with its stated uncertainties as a covariance. Augmented: with effects in it,
from an effects file, or from a diagnosis, whose causes carry standard deviations.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fogreduce.effects.gyro_names import gyro_name
from fogreduce.effects.selection import Action, action, select
from fogreduce.errors import BadInput
from fogreduce.metadata.calibration import CalibrationRecord
from fogreduce.metadata.effects_file import EffectEntry
from fogreduce.metadata.facts import RunFacts
from fogreduce.metadata.yaml12 import load_yaml
from fogreduce.physics.frames import AXES, across
from fogreduce.simulate.nominal_noise import NoiseCoefficients
from fogreduce.simulate.orbit import (
    ORBIT_S,
    RATE_DEG_S,
    Orbit,
    attitude_error,
    carried_into_orbit,
    coefficients,
    noise_covariance,
)
from fogreduce.simulate.plan import Plan

Array = NDArray[np.float64]

_CHAIN = (
    "w [deg/s] is the unit's rate in x, y, z. Gyro i reads M_i = G_i . w plus its errors; raw readings are "
    "v_i = polarity_i (C_i M_i + B_i); rates come back as H M, M_i = (polarity_i v_i - B_i) / C_i. Effects "
    "are departures from this chain, by the names and equations of docs/effects.md."
)
_NOISE = (
    "angle_random_walk N: white noise of N / 60 sqrt(rate) deg/s a sample; bias_instability B: one-sided "
    "density B^2 / (pi f) (deg/h)^2/Hz from 1e-5 Hz up; rate_random_walk K: steps of K / 60 sqrt(dt) deg/h"
)
_ORBIT = (
    "attitude from the gyros alone over one orbit, the unit turning once about the axis named; the error at "
    "its end as angles about x, y, z [deg]. mean_deg: from the effects; sigma_deg: one standard deviation "
    "from noise and uncertainties. errors_turn_with_body: to first order; each_axis_by_itself: the paper's"
)


@dataclass(frozen=True)
class Uncertain:
    """A parameter of the model: `step` is an effect that moves it by `step_size`, in the model's own unit."""

    name: str
    unit: str
    value: float
    sigma: float
    step: Action
    step_size: float


def model_document(plan: Plan, diagnosis: Path | None = None) -> dict[str, Any]:
    """The model of a campaign's unit, as plain data."""
    record, facts, run_ids = _unit_of(plan)
    causes, sigmas = _causes(diagnosis, run_ids, record.n) if diagnosis else ([], [])
    actions = [*plan.actions, *causes]
    parameters = _stated(record, facts)
    for cause, sigma in zip(causes, sigmas, strict=True):
        parameters += _of_cause(cause, sigma, record.n)
    noise = NoiseCoefficients.of(record.stated_noise.model_dump())
    kept = [one for one in actions if not carried_into_orbit(one, run_ids)]
    levels = Orbit(facts, "x").forward(_in_orbit(kept, facts)).noise_levels(noise)
    model = coefficients(levels)
    return {
        "schema": "fogreduce/model/1",
        "kind": "augmented" if actions else "nominal",
        "campaign": plan.folder.absolute().name,
        "unit": record.unit,
        "calibration": record.record_id,
        "chain": _CHAIN,
        "H": record.H,
        "G": facts.axes.tolist(),
        record.raw_unit.scale_factor_key: record.scale_factor,
        record.raw_unit.bias_key: record.bias,
        "noise": {
            "meaning": _NOISE,
            "angle_random_walk_deg_sqrt_h": list(model.white_deg_sqrt_h),
            "bias_instability_deg_h": list(model.flicker_deg_h),
            "rate_random_walk_deg_h_sqrt_h": list(model.walk_deg_h_sqrt_h),
            "white_correlation": _correlation(np.array([level.mixing for level in levels])),
        },
        "effects": [_plain(one) for one in actions],
        "parameters": [
            {"name": p.name, "unit": p.unit, "value": p.value, "sigma": p.sigma} for p in parameters
        ],
        "covariance": np.diag([p.sigma**2 for p in parameters]).tolist(),
        "attitude_error_per_orbit": {
            "meaning": _ORBIT,
            "orbit_s": ORBIT_S,
            "rate_deg_s": RATE_DEG_S,
            "left_out": [
                {"effect": one.effect.name, "why": why}
                for one in actions
                if (why := carried_into_orbit(one, run_ids))
            ],
            "about": {axis: _about(facts, axis, kept, parameters, noise) for axis in AXES},
        },
    }


def model_text(plan: Plan, diagnosis: Path | None = None) -> str:
    """`model_document` as JSON text."""
    return json.dumps(model_document(plan, diagnosis), indent=1, allow_nan=False) + "\n"


def _unit_of(plan: Plan) -> tuple[CalibrationRecord, RunFacts, list[str]]:
    """The one unit and record of a campaign; x, y, z are needed."""
    if len(plan.records) != 1:
        found = ", ".join(plan.records)
        raise BadInput.at(
            plan.folder, "calibration", found=found, expected="one record for the whole campaign"
        )
    (record,) = plan.records.values()
    if record.H is None:
        raise BadInput.at(
            record.record_id,
            "H",
            found=f"{record.n} gyros without H",
            expected="a unit that gives x, y and z",
        )
    return record, plan.facts(next(iter(plan.runs))), list(plan.runs)


def _stated(record: CalibrationRecord, facts: RunFacts) -> list[Uncertain]:
    """The stated uncertainties of the unit itself, each as an effect that moves it."""
    stated, found = record.stated_uncertainty, []

    def add(
        name: str, unit: str, sigma: float, effect: str, gyro: str, size: float, **parameters: Any
    ) -> None:
        step = action(effect, [gyro], [facts.run_id], parameters, record.n)
        found.append(Uncertain(f"{gyro}.{name}", unit, 0.0, sigma, step, size))

    for i, scale in enumerate(record.scale_factor):
        gyro = gyro_name(i)
        bias = stated.bias[i] / abs(scale) * 3600.0
        add("scale_factor", "ppm", stated.scale_factor_rel[i] * 1e6, "scale_factor_error", gyro, 1.0, ppm=1.0)
        add("bias", "deg/h", bias, "bias_offset", gyro, 1.0, deg_h=1.0)
        add("turn_on_bias", "deg/h", stated.turn_on_bias_deg_h[i], "turn_on_bias", gyro, 1.0, deg_h=1.0)
        for k, direction in enumerate(across(facts.axes[i])):
            mrad = tuple((1e-3 * direction).tolist())
            add(f"axis_{k + 1}", "rad", stated.axis_rad[i], "axis_misalignment", gyro, 1e-6, mrad=mrad)
    return found


def _about(
    facts: RunFacts,
    axis: str,
    actions: Sequence[Action],
    parameters: Sequence[Uncertain],
    noise: NoiseCoefficients,
) -> dict[str, Any]:
    """Attitude error of an orbit about one axis, both ways of accounting."""
    orbit = Orbit(facts, axis)
    here = _in_orbit(actions, facts)
    wrong, levels = orbit.wrong(here), orbit.forward(here).noise_levels(noise)
    moved = [(orbit.wrong([*here, *_in_orbit([p.step], facts)]) - wrong) / p.step_size for p in parameters]
    found = {}
    for key, weights in (
        ("errors_turn_with_body", orbit.turning),
        ("each_axis_by_itself", orbit.each_by_itself),
    ):
        by_noise = noise_covariance(weights, levels)
        uncertain = np.zeros((3, 3))
        for parameter, change in zip(parameters, moved, strict=True):
            slope = attitude_error(weights, change) * parameter.sigma
            uncertain += np.outer(slope, slope)
        covariance = sum(by_noise.values(), start=uncertain)
        found[key] = {
            "mean_deg": attitude_error(weights, wrong).tolist(),
            "sigma_deg": np.sqrt(np.diag(covariance)).tolist(),
            "covariance_deg2": covariance.tolist(),
            "sigma_by_source_deg": {
                **{name: np.sqrt(np.diag(part)).tolist() for name, part in by_noise.items()},
                "parameters": np.sqrt(np.diag(uncertain)).tolist(),
            },
        }
    return found


def _in_orbit(actions: Sequence[Action], facts: RunFacts) -> list[Action]:
    """The same actions, acting in the one run that an orbit is."""
    return [
        Action(one.effect, one.gyros, frozenset({facts.run_id}), one.parameters, one.ordinal)
        for one in actions
    ]


def _causes(
    file: Path, run_ids: list[str], n_gyros: int
) -> tuple[list[Action], list[dict[str, list[float]]]]:
    """A diagnosis' causes as actions, and their parameters' standard deviations."""
    # JSON is YAML 1.2, so that the same reader gives the same clear errors.
    data = load_yaml(file)
    if data.get("schema") != "fogreduce/diagnosis/1" or not isinstance(data.get("causes"), list):
        raise BadInput.at(
            file, "schema", found=data.get("schema"), expected="fogreduce/diagnosis/1, with a list of causes"
        )
    entries, sigmas = [], []
    causes: Any = data["causes"]
    for k, cause in enumerate(causes):
        try:
            parameters = cause["parameters"]
            values = {
                name: stated["value"] if isinstance(stated, Mapping) else stated
                for name, stated in parameters.items()
            }
            sigmas.append({name: _std(stated) for name, stated in parameters.items()})
            document = {
                "effect": cause["effect"],
                "channels": cause["channels"],
                "runs": cause["runs"],
                "parameters": values,
            }
        except (KeyError, TypeError, ValueError, AttributeError):
            raise BadInput.at(
                file,
                f"causes[{k}]",
                found="a cause that cannot be read",
                expected="effect, channels, runs, parameters with value and std",
            ) from None
        entries.append(EffectEntry.from_data(document, file))
    return select(entries, run_ids, n_gyros, file), sigmas


def _std(stated: Any) -> list[float]:
    """A parameter's standard deviations: one for a number, three for a vector, none where none is stated."""
    std = stated.get("std") if isinstance(stated, Mapping) else None
    if isinstance(std, list | tuple):
        return [float(part) for part in std]
    return [] if std is None else [float(std)]


def _of_cause(cause: Action, sigmas: Mapping[str, list[float]], n_gyros: int) -> list[Uncertain]:
    """The uncertain sizes of a cause: moving one is the cause once more, by its standard deviation.

    A further entry of the same effect adds to what is there. How an effect's shape (a time constant, say)
    moves its error is not carried on.
    """
    channels = [gyro_name(i) for i in cause.gyros] or [cause.effect.channels]
    found = []
    for parameter in cause.effect.parameters:
        std = sigmas.get(parameter.name, [])
        if parameter.kind not in ("number", "vector") or parameter.off not in (0.0, (0.0, 0.0, 0.0)):
            continue
        value = np.atleast_1d(cause.parameters[parameter.name])
        for k, (size, sigma) in enumerate(zip(value, std, strict=False)):
            moved = np.zeros(len(value))
            moved[k] = sigma or 1.0
            given = {name: stated for name, stated in cause.parameters.items() if stated is not None}
            given[parameter.name] = float(moved[0]) if parameter.kind == "number" else tuple(moved.tolist())
            step = action(cause.effect.name, channels, cause.runs, given, n_gyros)
            name = f"{'+'.join(channels)}.{cause.effect.name}.{parameter.name}"
            if parameter.kind == "vector":
                name += f".{AXES[k]}"
            found.append(Uncertain(name, parameter.unit, float(size), sigma, step, float(moved[k])))
    return found


def _given(cause: Action) -> dict[str, Any]:
    return {name: value for name, value in cause.parameters.items() if value is not None}


def _plain(one: Action) -> dict[str, Any]:
    return {
        "effect": one.effect.name,
        "channels": [gyro_name(i) for i in one.gyros] or [one.effect.channels],
        "runs": sorted(one.runs),
        "parameters": _given(one),
    }


def _correlation(mixing: Array) -> list[list[float]]:
    """Correlation of the gyros' white noises."""
    correlation: list[list[float]] = (mixing @ mixing.T).tolist()
    return correlation
