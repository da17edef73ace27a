"""Many campaigns diagnosed in one process: imports and tables are paid for once, and one campaign that cannot
be diagnosed stops no other.
"""

from __future__ import annotations

import sys
import traceback
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from fogreduce.cli.main import system_error
from fogreduce.effects.table import EFFECTS
from fogreduce.errors import BadInput, Fault, FogreduceError
from fogreduce.metadata.folder import list_campaigns
from fogreduce.metadata.yaml12 import load_yaml
from fogreduce.progress import progress


@dataclass(frozen=True)
class OfCampaign:
    """What holds for one campaign alone: effects taken out of the catalogue, runs to keep (empty: all)."""

    without: tuple[str, ...] = ()
    only_runs: tuple[str, ...] = ()


def campaign_folders(given: Sequence[Path]) -> list[Path] | None:
    """The campaigns meant; None where one campaign is given by itself, so that its results need no folder of
    their own.

    Each path is a campaign (it holds a folder ``runs``) or a folder of campaigns.

    Raises
    ------
    BadInput
        Where a folder holds no campaign, or two campaigns have one name.
    """
    found: list[Path] = []
    for path in given:
        if (path / "runs").is_dir() or not path.is_dir():
            found.append(path)
            continue
        inside = list_campaigns(path)
        if not inside and len(given) == 1:
            return None  # one folder, not a campaign: what it lacks is said as for any campaign
        if not inside:
            raise BadInput.at(path, "", found="no campaign", expected="a campaign or a folder of campaigns")
        found += inside
    if len(given) == 1 and found == [given[0]]:
        return None
    names = [path.resolve().name for path in found]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise BadInput(
            *(Fault(name, "", "two campaigns of this name", "a name of its own for each") for name in twice)
        )
    return found


def read_each(path: Path, campaigns: Sequence[str]) -> dict[str, OfCampaign]:
    """A file of what holds for single campaigns, YAML or JSON: name -> {without: [...], only_runs: [...]}."""
    faults: list[Fault] = []
    out: dict[str, OfCampaign] = {}
    for name, entry in load_yaml(path).items():
        if name not in campaigns:
            faults.append(Fault(str(path), str(name), "no such campaign", "one of those to be diagnosed"))
            continue
        if not isinstance(entry, Mapping):
            faults.append(Fault(str(path), str(name), repr(entry), "a mapping with without, only_runs"))
            continue
        for key, value in entry.items():
            if key not in ("without", "only_runs"):
                faults.append(Fault(str(path), f"{name}.{key}", "this key", "without or only_runs"))
            elif not isinstance(value, list) or not all(isinstance(one, str) for one in value):
                faults.append(Fault(str(path), f"{name}.{key}", repr(value), "a list of names"))
            elif key == "without":
                faults += [
                    Fault(str(path), f"{name}.{key}[{k}]", effect, "an effect of the catalogue")
                    for k, effect in enumerate(value)
                    if effect not in EFFECTS
                ]
        if not faults:
            out[str(name)] = OfCampaign(*(tuple(entry.get(key, ())) for key in ("without", "only_runs")))
    if faults:
        raise BadInput(*faults)
    return out


def diagnose_each(campaigns: Sequence[Path], one: Callable[[Path], None]) -> int:
    """Call `one` for every campaign; the exit status: 0 all done, 2 bad input somewhere, 1 anything worse.

    What is wrong with a campaign is said on standard error, its folder first; the others go on.
    """
    status = 0
    with progress(len(campaigns), "campaigns") as advance:
        for done, campaign in enumerate(campaigns, start=1):
            try:
                one(campaign)
            except FogreduceError as error:
                print(error, file=sys.stderr)
                status = status if status == 1 else error.exit_status
            except OSError as error:
                said = system_error(error)
                status = status if status == 1 else said
            except Exception:
                # a fault of ours in one campaign is no reason to leave out the rest
                print(f"{campaign}: not diagnosed", file=sys.stderr)
                traceback.print_exc()
                status = 1
            advance(done)
    return status
