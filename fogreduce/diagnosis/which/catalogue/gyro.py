"""What the catalogue's effects at a gyro would change in block means."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from fogreduce.diagnosis.inference.candidate import EVERY, Array, Candidate
from fogreduce.diagnosis.which.catalogue.builder import Builder
from fogreduce.effects.table import EFFECTS
from fogreduce.physics.frames import across

#: One number scales these: parameter, and the small step of the finite difference.
LINEAR_GYRO = {
    "bias_offset": ("deg_h", 1.0),
    "bias_ramp": ("deg_h_per_h", 10.0),
    "temperature_bias": ("deg_h_per_degC", 1.0),
    "temperature_rate_bias": ("deg_h_per_degC_per_min", 1.0),
    "temperature_scale_factor": ("ppm_per_degC", 1.0),
    "scale_factor_error": ("ppm", 1.0),
    "scale_factor_asymmetry": ("ppm", 1.0),
    "scale_factor_nonlinearity": ("ppm_at_10_deg_s", 1.0),
    "acceleration_bias": ("deg_h_per_g", 1.0),
}
_TAUS = 12


def gyro_candidates(build: Builder) -> Iterator[Candidate]:
    """What one gyro alone may have, and offset and scale factor of all of them alike."""
    for effect, (name, step) in LINEAR_GYRO.items():
        if effect not in build.allowed or (EFFECTS[effect].needs_temperature and not build.warm):
            continue
        one = build.per_gyro(effect, {name: step})
        for i in range(build.n):
            white = build.gyro_columns(i, [one])[:, None, :]
            yield build.at_gyro(effect, i, white, scales=(name,), steps=np.array([[step]]))
        if effect in ("bias_offset", "scale_factor_error") and build.n > 1:
            yield Candidate(
                effect,
                tuple(build.names),
                EVERY,
                slice(0, build.whiten.rows.total),
                build.whiten(one[:, None])[:, None, :],
                ({},),
                (name,),
                np.array([[step]]),
                share=0.05,
            )
    yield from _shaped(build)
    yield from _turn_on_and_steps(build)
    yield from _late(build)


def _shaped(build: Builder) -> Iterator[Candidate]:
    longest = max(one.scene.blocks.count * one.scene.blocks.length_s for one in build.inputs)
    taus = np.geomspace(longest / 60.0, 2.0 * longest, _TAUS)
    if "warm_up" in build.allowed:
        columns = [build.per_gyro("warm_up", {"deg_h": 1.0, "tau_s": tau}) for tau in taus.tolist()]
        grid = tuple({"tau_s": tau} for tau in taus.tolist())
        for i in range(build.n):
            white = build.gyro_columns(i, columns)[:, :, None]
            yield build.at_gyro("warm_up", i, white, scales=("deg_h",), grid=grid)
    if "magnetic_bias" in build.allowed:
        field_columns = [
            build.per_gyro("magnetic_bias", {"deg_h": 1.0, "field_direction": tuple(f)})
            for f in np.eye(3).tolist()
        ]
        names = tuple(f"field[{k}]" for k in range(3))
        for i in range(build.n):
            yield build.at_gyro(
                "magnetic_bias", i, build.gyro_columns(i, field_columns)[:, None, :], scales=names
            )
    if "axis_misalignment" in build.allowed:
        tips = [across(axis) for axis in build.inputs[0].facts.axes]
        both = [
            build.difference(
                [
                    ("axis_misalignment", [name], {"mrad": tuple((0.1 * tip[k]).tolist())})
                    for name, tip in zip(build.names, tips, strict=True)
                ]
            )
            for k in range(2)
        ]
        for i in range(build.n):
            yield build.at_gyro(
                "axis_misalignment",
                i,
                build.gyro_columns(i, both)[:, None, :],
                scales=("tip[0]", "tip[1]"),
                steps=np.full((1, 2), 0.1),
                extra={"tips": tips[i]},
            )


def _turn_on_and_steps(build: Builder) -> Iterator[Candidate]:
    rows, runs = build.whiten.rows, len(build.ids)
    stepped: dict[int, Array] = {}
    for i in range(build.n):
        for r, run_id in enumerate(build.ids):
            matrix = build.whiten.filters[i, r]
            if "turn_on_bias" in build.allowed:
                one = matrix.sum(axis=1)[:, None, None]
                yield build.at_gyro(
                    "turn_on_bias",
                    i,
                    one,
                    runs=(run_id,),
                    rows=rows.of(i, r),
                    scales=("deg_h",),
                    share=1.0 / build.n / runs,
                )
            if "bias_step" in build.allowed and len(matrix) > 2:
                if id(matrix) not in stepped:
                    # a unit step at each block's start, whitened: sums of the filter's columns from there
                    # on
                    stepped[id(matrix)] = np.cumsum(matrix[:, ::-1], axis=1)[:, ::-1][:, 1:]
                length = build.inputs[r].scene.blocks.length_s
                times = ((np.arange(len(matrix) - 1) + 1) * length).tolist()
                yield build.at_gyro(
                    "bias_step",
                    i,
                    stepped[id(matrix)][:, :, None],
                    runs=(run_id,),
                    rows=rows.of(i, r),
                    grid=tuple({"time_s": time} for time in times),
                    scales=("deg_h",),
                    share=1.0 / build.n / runs,
                )


def _late(build: Builder) -> Iterator[Candidate]:
    wanted = [e for e in ("latency", "low_pass") if e in build.allowed]
    if not wanted:
        return
    late = build.per_gyro("latency", {"ms": 10.0})
    if not np.any(np.abs(late) > 1e-9):
        return
    for i in range(build.n):
        white = build.gyro_columns(i, [late])[:, None, :]
        # a filter of a given time constant delays what is slower than itself by that much
        for effect, name in (("latency", "ms"), ("low_pass", "time_constant_ms")):
            if effect in wanted:
                yield build.at_gyro(effect, i, white, scales=(name,), steps=np.array([[10.0]]), positive=True)


def crosstalk_candidates(build: Builder) -> Iterator[Candidate]:
    """Crosstalk into each gyro from each other one."""
    if "crosstalk" not in build.allowed:
        return
    for shift in range(1, build.n):
        sources = [build.names[(i + shift) % build.n] for i in range(build.n)]
        one = build.difference(
            [
                ("crosstalk", [name], {"ppm": 1.0, "source": source})
                for name, source in zip(build.names, sources, strict=True)
            ]
        )
        for i, source in enumerate(sources):
            yield build.at_gyro(
                "crosstalk",
                i,
                build.gyro_columns(i, [one])[:, None, :],
                scales=("ppm",),
                grid=({"source": source},),
                share=1.0 / build.n / (build.n - 1),
                extra={"source": source},
            )
