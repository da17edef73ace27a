"""A batch of cases on disk: what a diagnoser may see, and, elsewhere, what it may not."""

from pathlib import Path

from withheld.atomic import write_json
from withheld.chain.injector import write_campaign
from withheld.errors import BadInput
from withheld.study.cases import draw_case, label, plans
from withheld.study.plan import Plan
from withheld.study.protocol import FIRST_STUDY_SEED, Protocol


def batch_plans(protocol: Protocol, number: int, size: int) -> list[Plan]:
    """The cases of one batch, from 0."""
    chosen = plans(protocol)[number * size : (number + 1) * size]
    if not chosen:
        raise BadInput(f"batch {number} of {size} cases: the study has {protocol.cases} cases")
    return chosen


def make_batch(protocol: Protocol, chosen: list[Plan], folder: Path, labels: Path) -> None:
    """Campaigns, calibration records and public.json into `folder`; what is wrong with them into `labels`.

    public.json says for each case which effects its diagnoser is to leave out of the catalogue, no more.
    """
    sealed = []
    for plan in chosen:
        drawn = draw_case(protocol, plan)
        write_campaign(drawn.world, folder / "campaigns" / plan.name, folder / "calibrations")
        sealed.append(label(protocol, plan, drawn))
    write_json(folder / "public.json", {plan.name: {"without": list(plan.without)} for plan in chosen})
    write_json(labels, sealed)


def check_training(seed: int) -> None:
    """A training set has a seed below every study's."""
    if not 0 <= seed < FIRST_STUDY_SEED:
        raise BadInput(
            f"training seed {seed}: expected 0 to {FIRST_STUDY_SEED - 1}; higher ones are for studies"
        )


def check_study(seed: int) -> None:
    """A study has a seed above every training set's."""
    if seed < FIRST_STUDY_SEED:
        raise BadInput(f"study seed {seed}: expected {FIRST_STUDY_SEED} or more; lower ones are for training")
