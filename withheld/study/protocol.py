"""What a study will do, fixed before any label exists: numbers of cases, laws, thresholds, metrics."""

import hashlib
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from withheld.effects.catalogue import NAMES as CATALOGUE
from withheld.effects.strangers import NAMES as STRANGERS
from withheld.errors import BadInput
from withheld.study.designs import DESIGNS
from withheld.study.laws import LAWS

# Training seeds lie below, study seeds from here on; and the two never share a random stream.
FIRST_STUDY_SEED = 1_000_000


@dataclass(frozen=True)
class Thresholds:
    """Where a score draws its lines.

    Parameters
    ----------
    group_below : separation below which two causes cannot be told apart: the true group
    group_never : a group that holds a member separated by this much is impure
    stranger_keeps : an effect outside the catalogue counts as misattributed only where it keeps this
        separation from its best catalogue rival; below, it is indistinguishable
    named_snr, named_distance : an entry of this SNR that keeps this separation from every rival, each with
        the campaign's other entries beside it, must be named
    closure_within, effect_closure_within : how near a stated closure has to come to the oracle's
    explained_reaches : `explained` is wrong where the closure's 95 % interval ends below this
    """

    group_below: float = 4.0
    group_never: float = 6.0
    stranger_keeps: float = 5.0
    named_snr: float = 8.0
    named_distance: float = 6.0
    closure_within: float = 0.03
    effect_closure_within: float = 0.05
    explained_reaches: float = 0.97


@dataclass(frozen=True)
class Protocol:
    """A study: its name, seed, what it draws and how it is scored.

    Parameters
    ----------
    once : a study whose labels may be scored only once for a candidate; the small one that tries the path is
    not
    nothing_wrong, pairs, triples : numbers of cases
    singles_each, without_each, strangers_each : cases for each effect of the catalogue, for each effect
        taken out of it, and for each effect that never was in it
    singles_total : at most so many cases of each of these three kinds, evenly over the effects; 0: all
    snr_low, snr_high : the range of target signal-to-noise ratios, even in the logarithm
    wobble_most : largest rms departure from the catalogue's shape, relative to the effect
    departure_most : the same relative to the effect's SNR, in the clairvoyant's metric; a wobble that
        exceeds it is reduced (a slow wobble on an effect whose constant part is all but hidden by a stated
        uncertainty would be the larger signal)
    noise_level_rel : 1-sigma doubt of a record's white noise level, relative
    link_fault : chance that a healthy link loses or spoils a sample
    temperature_share : share of campaigns with a temperature log
    classes : numbers of campaigns of each class of `withheld.study.classes`
    decoy_share : share of other cases in which some innocent effect is taken out of the catalogue
    """

    name: str
    seed: int
    once: bool
    nothing_wrong: int
    singles_each: int
    pairs: int
    triples: int
    without_each: int
    strangers_each: int
    singles_total: int = 0
    snr_low: float = 3.0
    snr_high: float = 40.0
    wobble_most: float = 0.04
    departure_most: float = 0.08
    noise_level_rel: float = 0.02
    link_fault: float = 1e-6
    temperature_share: float = 0.75
    decoy_share: float = 0.1
    classes: dict[str, int] = field(default_factory=dict)
    thresholds: Thresholds = field(default_factory=Thresholds)

    @property
    def cases(self) -> int:
        """How many campaigns the study has."""
        each = [
            (self.singles_each, len(CATALOGUE)),
            (self.without_each, len(CATALOGUE)),
            (self.strangers_each, len(STRANGERS)),
        ]
        effects = sum(self.singles_total or number * size for number, size in each)
        return self.nothing_wrong + effects + self.pairs + self.triples + sum(self.classes.values())

    @property
    def domain(self) -> str:
        """The word that keeps studies' random streams from those for training."""
        return "study" if self.seed >= FIRST_STUDY_SEED else "training"


METRICS = (
    "right cause: the first cause is the truth by effect, channels and (for what sits in one run) run",
    "right by group: the truth is in the first cause's group and every other member is separated from it by "
    "less than group_never",
    "false alarm: nothing wrong and the verdict is not no_gap",
    "verdict right: explained for a catalogued cause; unexplained or partly_explained for one outside",
    "outside the catalogue: flagged at the right place; misattributed (explained, and the truth keeps "
    "stranger_keeps against its best catalogue rival); missed (no_gap); indistinguishable (explained, and a "
    "rival is closer than that)",
    "reliability: stated probability against the share that was right, closed and open set apart",
    "pulls: (value - truth) / std of each parameter of a right cause; a phase modulo a turn, a magnetic "
    "bias without the sign that its direction takes up",
    "closure: stated fraction less the oracle's",
    "named: an entry of SNR named_snr that keeps named_distance from every rival, the campaign's other "
    "entries beside each, is a cause by name; another of that SNR is one, stands in a group, or a cause of "
    "its true group stands for it",
    "stray: a cause that is no entry and in no entry's true group (separated by less than group_below)",
    "culprit: it is a cause or stands in a group, or a cause is of its true group",
    "named once: as many causes as entries, each entry or one of its true group among them",
    "closures of single effects: alone, removed, cumulative of right causes less the oracle's",
    "overstated: explained, and the closure's 95 % interval ends below explained_reaches",
    "kin: unknown in its place and the first that it resembles is its kin, or its kin is a cause on its gyro "
    "and the remainder shows a departure there",
    "groups: size, and the share of members separated from the truth by less than group_below",
)


def study(kind: str, seed: int) -> Protocol:
    """`small`: twenty cases that try the path; `full`: 1,216 campaigns of the first kinds, 400 with nothing
    wrong; `whole`: 1,500 of the first kinds and of every class; `quarter`: 386 of the same.
    """
    if kind == "small":
        return Protocol("small", seed, False, 6, 1, 1, 1, 1, 1, singles_total=4)
    if kind == "full":
        return Protocol("full", seed, True, 400, 10, 88, 24, 4, 12)
    if kind == "whole":
        classes = {
            "stale": 174, "stale_culprit": 90, "strong": 240, "link_slow": 60, "mixed_quiet": 60, "mixed": 40,
            "slow_log": 36, "long_run": 24, "near": 44,
        }  # fmt: skip
        return Protocol("whole", seed, True, 300, 5, 60, 20, 2, 6, classes=classes)
    if kind == "quarter":
        classes = {
            "stale": 44, "stale_culprit": 22, "strong": 60, "link_slow": 15, "mixed_quiet": 15, "mixed": 10,
            "slow_log": 9, "long_run": 12, "near": 12,
        }  # fmt: skip
        return Protocol("quarter", seed, True, 75, 1, 15, 5, 1, 1, classes=classes)
    raise BadInput(f"withheld study {kind}: expected small, quarter, full or whole")


def code_hash() -> str:
    """Digest of the sources that make and judge: injector, effects, cases, clairvoyant, scorer."""
    root = Path(__file__).resolve().parents[1]
    digest = hashlib.sha256()
    parts = ("chain", "effects", "study", "clairvoyant", "score")
    for path in sorted(path for part in parts for path in (root / part).rglob("*.py")):
        digest.update(path.relative_to(root).as_posix().encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()


def protocol_document(protocol: Protocol) -> dict[str, Any]:
    """Everything that is fixed beforehand, as plain values."""
    laws = {
        name: {"parameter": law.main, "first": law.first, "low": law.low, "high": law.high, "seat": law.seat}
        for name, law in LAWS.items()
    }
    return {
        "schema": "withheld/protocol/1",
        "study": asdict(protocol),
        "metrics": list(METRICS),
        "designs": DESIGNS,
        "laws": laws,
        "code_sha256": code_hash(),
    }


def protocol_from(document: dict[str, Any]) -> Protocol:
    """The study in a protocol document."""
    try:
        values = dict(document["study"])
        return Protocol(**{**values, "thresholds": Thresholds(**values["thresholds"])})
    except (KeyError, TypeError) as error:
        raise BadInput(f"not a protocol of the bench ({error})") from error
