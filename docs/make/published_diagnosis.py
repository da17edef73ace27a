"""The published run's gap, accounted for.

``python docs/make/published_diagnosis.py campaigns calibrations docs`` writes
``docs/published-diagnosis.md`` and its figure from the paper's curves alone, without noise, so that the
numbers are the same wherever it runs; a test holds the page against them. Its last section is what a
diagnosis of the reconstruction says (some ten seconds). Everything is in deg/h.
"""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fogreduce.constants import EARTH_RATE_RAD_S, SECONDS_PER_HOUR
from fogreduce.datasets.atomic import write_text
from fogreduce.diagnosis.diagnose import diagnose
from fogreduce.diagnosis.next.runs import Proposal, as_input
from fogreduce.diagnosis.observe.capture import RunInput, read_inputs
from fogreduce.diagnosis.report.words import closed, headline, percent, sizes, titled
from fogreduce.effects.selection import action
from fogreduce.effects.table import EFFECTS
from fogreduce.metadata.curves import Curves
from fogreduce.pages import svg
from fogreduce.physics.frames import across
from fogreduce.simulate.campaign import write_campaign
from fogreduce.simulate.from_curves import curve_volts
from fogreduce.simulate.plan import Options, prepare

Array = NDArray[np.float64]
Spec = tuple[str, str, dict[str, Any]]  # effect, channel, parameters at which its column is taken

PAGE, FIGURE = "published-diagnosis.md", "figures/published-gap.svg"
_TEMPLATE = Path(__file__).with_name("published_diagnosis_template.md")
#: Runs that are weighed: the one that was made, and what is near at hand.
_MADE = (
    ("x", "up", 0.06), ("x", "up", -0.06), ("x", "up", 0.0), ("x", "down", 0.06), ("y", "up", 0.06),
    ("z", "up", 0.06),
)  # fmt: skip
#: Errors of Table 5's offsets a [deg/s], printed: the noise a sample that they imply is not the gyros'.
TABLE_5_A_ERR = (1.230761024856e-06, 9.810948406971e-07, 1.5849701946751e-06)


@dataclass(frozen=True)
class Account:
    """The run, its residual curves, and what readings make of the paper's numbers.

    Attributes
    ----------
    one : RunInput
    curves : Curves
        The paper's Table 4.
    residual : (n, blocks) array
        Measured less predicted [deg/h].
    basis : (blocks, 4) array
        Constant, cos, sin of one turn, hours: the paper's mean curve.
    """

    one: RunInput
    curves: Curves
    residual: Array
    basis: Array

    @classmethod
    def of(cls, campaign: Path, calibrations: Path) -> Account:
        """From the bundled campaign; it needs no capture."""
        (one,) = read_inputs(campaign, calibrations, need_capture=False)
        curves = Curves.from_yaml(campaign / "curves.yaml")
        blocks, t = one.scene.blocks, one.scene.blocks.centre_s
        measured = blocks.means(one.scene.rates(curve_volts(curves, blocks.time_s)))
        turn = float(curves.c_rad_s[0]) * t
        basis = np.column_stack([np.ones_like(t), np.cos(turn), np.sin(turn), t / SECONDS_PER_HOUR])
        return cls(one, curves, measured - one.scene.block_means(), basis)

    @property
    def hours(self) -> float:
        """Length of the run."""
        return self.one.run.duration_s / SECONDS_PER_HOUR

    def parts(self, readings: Array) -> Array:
        """Of x, y, z: offset at the start, wave's and slope's part of the drift [deg/h]; (3, 3).

        The paper's drift is that of the curve moved so that it starts at the commanded rate: over one turn a
        cosine of size C gives -C, a slope E gives E T / 2.
        """
        assert self.one.facts.projection is not None
        fitted = np.linalg.lstsq(self.basis, (self.one.facts.projection @ readings).T, rcond=None)[0]
        return np.column_stack([fitted[0] + fitted[1], -fitted[1], fitted[3] * self.hours / 2.0])

    def column(self, one: RunInput, spec: Spec) -> Array:
        """What an effect at its small size changes in a run, (n, blocks) [deg/h]."""
        effect, channel, parameters = spec
        does = action(effect, [channel], [one.facts.run_id], parameters, one.facts.n_gyros)
        return np.asarray(one.scene.block_means([does]) - one.scene.block_means())

    def fitted(self, specs: Sequence[Spec]) -> tuple[Array, Array]:
        """Multiples of the columns that fit the residual best, and what they then change (n, blocks)."""
        weight = 1.0 / np.array(self.one.record.stated_noise.angle_random_walk_deg_sqrt_h)[:, None]
        columns = [self.column(self.one, spec) for spec in specs]
        a = np.column_stack([(c * weight).ravel() for c in columns])
        size = np.linalg.lstsq(a, (self.residual * weight).ravel(), rcond=1e-9)[0]
        change: Array = np.tensordot(size, np.array(columns), axes=1)
        return np.asarray(size, np.float64), change


OFFSET, SCALE, RAMP = "`bias_offset`", "`scale_factor_error`", "`bias_ramp`"
TIP, FIELD = "`axis_misalignment`", "`magnetic_bias`"


def sets(account: Account) -> dict[str, list[Spec]]:
    """Candidates, each a set of one kind: what it is called, and its columns."""
    gyros = [f"gyro{i + 1}" for i in range(account.one.facts.n_gyros)]
    tips: list[Spec] = [
        ("axis_misalignment", name, {"mrad": (0.01 * tip).tolist()})
        for name, axis in zip(gyros, account.one.facts.axes, strict=True)
        for tip in across(axis)
    ]
    # east and north: a field's upward part is constant here, as an offset is
    fields: list[Spec] = [
        ("magnetic_bias", name, {"deg_h": 1.0, "field_direction": way})
        for name in gyros
        for way in np.eye(3)[:2].tolist()
    ]
    turns: list[Spec] = [("mount_rotation", "table", {"mrad": way}) for way in (0.01 * np.eye(3)).tolist()]
    return {
        OFFSET: [("bias_offset", name, {"deg_h": 1.0}) for name in gyros],
        SCALE: [("scale_factor_error", name, {"ppm": 1.0}) for name in gyros],
        RAMP: [("bias_ramp", name, {"deg_h_per_h": 1.0}) for name in gyros],
        TIP: tips,
        FIELD: fields,
        "`mount_rotation`": turns,
        "`heading_error`": [("heading_error", "table", {"deg": 0.01})],
        "`latitude_error`": [("latitude_error", "table", {"deg": 0.01})],
        "`table_rate_error`": [("table_rate_error", "table", {"ppm": 1.0})],
    }


def together(account: Account, keys: Sequence[str]) -> dict[str, Array]:
    """Sizes of several sets fitted together, by set."""
    every = sets(account)
    size, _ = account.fitted([spec for key in keys for spec in every[key]])
    ends = np.cumsum([len(every[key]) for key in keys])
    return dict(zip(keys, np.split(size, ends[:-1]), strict=True))


def changed(account: Account, one: RunInput, sizes: dict[str, Array]) -> dict[str, Array]:
    """What sets of given sizes change in a run, (n, blocks) each [deg/h]."""
    every = sets(account)
    return {
        key: np.tensordot(size, np.array([account.column(one, spec) for spec in every[key]]), axes=1)
        for key, size in sizes.items()
    }


def text(account: Account, blind: str) -> str:
    """The page; `blind`: what the diagnosis says."""
    return _TEMPLATE.read_text(encoding="utf-8").format(
        gyros=_gyros(account),
        parts=_parts(account),
        together=_together(account),
        alone=_alone(account),
        sizes=_sizes(account),
        earth=_earth(account),
        noise=_noise(account),
        runs=_runs(account),
        blind=blind,
    )


def _row(*cells: str) -> str:
    return "| " + " | ".join(cells) + " |"


def _table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    return "\n".join([_row(*head), _row(*("---" for _ in head)), *(_row(*row) for row in rows)])


def _gyros(account: Account) -> str:
    fitted = np.linalg.lstsq(account.basis, account.residual.T, rcond=None)[0]
    rows = [
        [f"gyro {i + 1}", f"{c[0]:+.2f}", f"{c[1]:+.2f}", f"{c[2]:+.2f}", f"{c[3]:+.2f}"]
        for i, c in enumerate(fitted.T)
    ]
    return _table(["", "constant [deg/h]", "cos alpha [deg/h]", "sin alpha [deg/h]", "slope [deg/h/h]"], rows)


def _parts(account: Account) -> str:
    rows = [
        [name, f"{start:+.2f}", f"{wave + slope:+.2f}", f"{wave:+.2f}", f"{slope:+.2f}"]
        for name, (start, wave, slope) in zip("xyz", account.parts(account.residual).tolist(), strict=True)
    ]
    head = ["", "offset at the start [deg/h]", "drift [deg/h]", "of it the wave", "of it the slope"]
    return _table(head, rows)


def _shares(account: Account, change: Array) -> list[str]:
    parts = account.parts(change)
    offsets = ", ".join(_signed(v) for v in parts[:, 0])
    return [offsets, ", ".join(_signed(v) for v in parts[:, 1] + parts[:, 2])]


def _signed(value: float) -> str:
    """Two decimals with a sign; nothing is +0.00."""
    return f"{round(float(value), 2) + 0.0:+.2f}"


def _left(account: Account, change: Array) -> str:
    return f"{float(np.sqrt(np.mean((account.residual - change) ** 2))):.2f}"


def _together(account: Account) -> str:
    sizes = together(account, [OFFSET, RAMP, FIELD])
    change = changed(account, account.one, sizes)
    words = {OFFSET: "constant", RAMP: "growing with time", FIELD: "going round with the table"}
    rows = [[words[key], key, *_shares(account, part)] for key, part in change.items()]
    rows.append(["**all three**", "", *_shares(account, sum(change.values(), np.zeros(1)))])
    rows.append(["**the run**", "", *_shares(account, account.residual)])
    return _table(["part", "such as", "offsets x, y, z", "drifts x, y, z"], rows)


def _alone(account: Account) -> str:
    rows = []
    for name, specs in sets(account).items():
        if name == RAMP:
            continue
        _, change = account.fitted(specs)
        rows.append([name, *_shares(account, change), _left(account, change)])
    rows.append(["nothing", "", "", _left(account, np.zeros(1))])
    return _table(["alone", "offsets x, y, z", "drifts x, y, z", "left, root mean square"], rows)


def _sizes(account: Account) -> str:
    sizes = together(account, [OFFSET, RAMP, FIELD])
    scale = together(account, [SCALE, RAMP, FIELD])[SCALE]
    level = np.hypot(sizes[FIELD][0::2], sizes[FIELD][1::2])
    rows = [
        [OFFSET, "deg/h", *(f"{v:+.2f}" for v in sizes[OFFSET])],
        [f"or {SCALE}", "%", *(f"{v * 1e-4:+.2f}" for v in scale)],
        [RAMP, "deg/h/h", *(f"{v:+.2f}" for v in sizes[RAMP])],
        [f"{FIELD}, level part", "deg/h", *(f"{v:.2f}" for v in level)],
    ]
    return _table(["", "unit", *(f"gyro {i + 1}" for i in range(len(account.residual)))], rows)


def _earth(account: Account) -> str:
    facts = account.one.facts
    earth = np.degrees(EARTH_RATE_RAD_S) * SECONDS_PER_HOUR * np.sin(np.radians(facts.latitude_deg))
    mean = np.linalg.lstsq(account.basis, account.residual.T, rcond=None)[0][0]
    assert facts.projection is not None
    offset = float(facts.projection[0] @ mean)
    other = offset + 2.0 * earth
    rows = [
        ["as eq. 6 has it", f"{earth:+.2f}", f"{offset:+.2f}", f"{0.06 + offset / SECONDS_PER_HOUR:.4f}"],
        ["turned", f"{-earth:+.2f}", f"{other:+.2f}", f"{0.06 + other / SECONDS_PER_HOUR:.4f}"],
    ]
    return _table(["sign of Earth's part in x", "Earth in x [deg/h]", "left in x [deg/h]", "x [deg/s]"], rows)


def _noise(account: Account) -> str:
    facts, samples = account.one.facts, account.one.facts.n_expected
    assert facts.projection is not None
    own = np.array(account.curves.sigma_V) / facts.scale_factor
    independent = np.sqrt(facts.projection**2 @ own**2)
    time = np.arange(0.0, samples) / facts.sample_rate_hz
    turn = account.curves.c_rad_s[0] * time
    basis = np.column_stack([np.ones(samples), np.sin(turn), np.cos(turn), time])
    factor = float(np.sqrt(np.linalg.inv(basis.T @ basis)[0, 0]))
    rows = [
        [name, f"{printed / factor:.3g}", f"{here:.3g}", f"{printed / factor / here:.2f}"]
        for name, printed, here in zip("xyz", TABLE_5_A_ERR, independent.tolist(), strict=True)
    ]
    return _table(["", "Table 5's errors imply [deg/s]", "independent gyros give [deg/s]", "ratio"], rows)


def _runs(account: Account) -> str:
    pairs = [([OFFSET, RAMP, FIELD], [SCALE, RAMP, FIELD]), ([OFFSET, RAMP, TIP], [OFFSET, RAMP, FIELD])]
    explained = [[together(account, keys) for keys in pair] for pair in pairs]
    earth = np.degrees(EARTH_RATE_RAD_S) * SECONDS_PER_HOUR
    vertical = abs(earth * np.sin(np.radians(account.one.facts.latitude_deg)))
    turn = account.one.run.duration_s
    rows = []
    for axis, way, rate in _MADE:
        here = as_input([account.one], Proposal(axis, way, rate, turn))
        cells = []
        for pair in explained:
            one, other = (sum(changed(account, here, s).values(), np.zeros(1)) for s in pair)
            cells.append(f"{float(np.max(np.sqrt(np.mean((one - other) ** 2, axis=1)))):.1f}")
        # an offset stays where Earth's part in x goes to 0 or turns
        cells.append(
            f"{2.0 * vertical * {'up': 0.0, 'down': 2.0}[way] if axis == 'x' else 2.0 * vertical:.1f}"
        )
        motion = "standstill" if rate == 0.0 else f"{rate:+g} deg/s"
        rows.append([f"{axis} {way}, {motion}", *cells])
    head = ["run of 100 minutes", "offsets or scale factors", "tips or fields", "sign of Earth in x"]
    return _table(head, rows)


def blind(account: Account, campaign: Path, calibrations: Path) -> str:
    """What the diagnosis of the reconstruction says: verdict, causes with their rivals, and what they do."""
    with tempfile.TemporaryDirectory() as scratch:
        made = Path(scratch) / campaign.name
        write_campaign(prepare(campaign, calibrations, Options()), made)
        found = diagnose(made, calibrations)
    d = found.document
    slow = [c for c in d["causes"] if EFFECTS[c["effect"]].design is not None]
    parts = [f"It says: {headline(d)}."]
    if d["closure"] is not None and d["causes"]:
        parts.append(
            f"In the simulator, {closed(d['closure'])} of the gap closes on what the fit did not see."
        )
    parts.append(f"That something unknown takes part: {percent(d['unknown_probability'])}.")
    rows = [
        [titled(c), "; ".join(sizes(c, d["raw_unit"])), percent(c["probability"]), _rivals(c)] for c in slow
    ]
    out = [" ".join(parts)]
    if rows:
        out += ["", _table(["cause", "size", "probability", "or"], rows)]
    others = sorted({EFFECTS[c["effect"]].title for c in d["causes"] if c not in slow})
    if others:
        out += ["", f"Beside these, of the link and the noise: {', '.join(others)}."]
    return "\n".join([*out, "", *_done(account, found.effects)])


def _rivals(cause: dict[str, Any]) -> str:
    """What else it may be."""
    others = [
        m for m in cause["group"] if (m["effect"], m["channels"]) != (cause["effect"], cause["channels"])
    ]
    return ", ".join(f"{titled(m)} ({percent(m['probability'])})" for m in others) or "nothing else"


def _done(account: Account, effects: Sequence[dict[str, Any]]) -> list[str]:
    """Constant and slope of each gyro, as the run has them and as the causes named make them."""
    here, ids = account.one, [account.one.facts.run_id]
    actions = [
        action(e["effect"], e["channels"], ids, e["parameters"], here.facts.n_gyros)
        for e in effects
        if EFFECTS[e["effect"]].design is not None
    ]
    change = here.scene.block_means(actions) - here.scene.block_means()
    run, causes = (np.linalg.lstsq(account.basis, r.T, rcond=None)[0] for r in (account.residual, change))
    rows = [
        [f"gyro {i + 1}", *(f"{v:+.2f}" for v in (run[0, i], causes[0, i], run[3, i], causes[3, i]))]
        for i in range(len(change))
    ]
    head = ["", "offset [deg/h]", "of it by the causes", "slope [deg/h/h]", "of it by the causes"]
    words = "What these causes do together in each gyro, beside what the run shows:"
    return [words, "", _table(head, rows), "", *_judgement(effects)]


def _judgement(effects: Sequence[dict[str, Any]]) -> list[str]:
    """How far the names agree with the account above."""
    gyros = {
        name for e in effects if e["effect"] in ("bias_offset", "turn_on_bias") for name in e["channels"]
    }
    if len(gyros) == 4:
        return ["Offsets and slopes are named as such, as above."]
    return [
        "So the curves are closed, but not by what the account above calls credible: offsets are not named "
        "as biases at every gyro. One run at a constant rate leaves that open, and what stands in their "
        "place takes sizes that no unit of the class shows. Which runs would settle it stands above."
    ]


def figure(account: Account) -> str:
    """Residual curves of the gyros and of x, y, z."""
    assert account.one.facts.projection is not None
    names = [f"gyro{i + 1}" for i in range(len(account.residual))]
    xyz = account.one.facts.projection @ account.residual
    change = sum(changed(account, account.one, together(account, [OFFSET, RAMP])).values(), np.zeros(1))
    left = account.residual - change
    panels: list[tuple[str, Array | None, Array | None]] = [
        (name, before, after)
        for name, before, after in [
            *zip(names, account.residual, left, strict=True),
            *zip("xyz", xyz, account.one.facts.projection @ left, strict=True),
        ]
    ]
    runs = [(account.one.facts.run_id, account.residual.shape[1])]
    return svg.traces(panels, runs, "deg/h", "the published run's curves less what was predicted")


def write(campaigns: Path, calibrations: Path, docs: Path) -> None:
    """Write page and figure."""
    account = Account.of(campaigns / "published", calibrations)
    write_text(docs / FIGURE, figure(account))
    write_text(docs / PAGE, text(account, blind(account, campaigns / "published", calibrations)))


if __name__ == "__main__":
    write(*(Path(word) for word in sys.argv[1:4]))
