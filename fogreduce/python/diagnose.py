"""`fogreduce.diagnose`: where, why and how far a campaign departs from its prediction."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fogreduce.diagnosis.diagnose import Diagnosis
from fogreduce.diagnosis.diagnose import diagnose as diagnose_folder
from fogreduce.diagnosis.report.words import announced, in_detail, in_words
from fogreduce.diagnosis.report.write import write
from fogreduce.metadata.folder import load_campaign

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Folder = str | os.PathLike[str]


@dataclass(frozen=True)
class Diagnosed:
    """A diagnosed campaign; `document` is what diagnosis.json holds."""

    campaign: Path
    diagnosis: Diagnosis

    @property
    def document(self) -> dict[str, Any]:
        """Verdict, places, causes, closure, the next run."""
        return self.diagnosis.document

    @property
    def verdict(self) -> str:
        """``no_gap``, ``explained``, ``partly_explained`` or ``unexplained``."""
        return str(self.document["verdict"])

    def __repr__(self) -> str:
        lines = [f"Diagnosis of {self.campaign.name}: {announced(self.document)}"]
        return "\n  ".join(lines + in_detail(self.document))

    def write(self, out: Folder) -> Path:
        """Write diagnosis.json, the effects found and the page into a folder."""
        write(self.diagnosis, Path(out), load_campaign(self.campaign).label)
        return Path(out)

    def plot(self) -> Figure:
        """Probability of each cause, and of its group where it is not told from rivals."""
        from fogreduce.plotting import style

        causes = self.document["causes"]
        label = load_campaign(self.campaign).label or ""
        identity = style.Identity(self.campaign.name, self.verdict, "none", label)
        with style.style():
            height = max(1.0, 0.45 * len(causes))
            figure, ((axes,),) = style.panels(identity, "Causes", 1, height, left_margin=4.2)
            if not causes:
                style.say_empty(axes, "no cause")
                return figure
            names = [in_words(cause) for cause in causes]
            places = range(len(causes))
            axes.barh(
                places, [one["group_probability"] for one in causes], color=style.BAND, label="its group"
            )
            axes.barh(
                places, [one["probability"] for one in causes], height=0.4, color=style.MEAN, label="itself"
            )
            axes.set_yticks(list(places), names)
            axes.invert_yaxis()
            axes.set_xlim(0.0, 1.0)
            axes.set_xlabel("probability")
            axes.legend(loc="lower right")
        return figure


def diagnose(
    campaign: Folder,
    calibrations: Folder,
    *,
    without: Sequence[str] = (),
    only_runs: Sequence[str] = (),
) -> Diagnosed:
    """Diagnose a campaign with captures, as ``fogreduce diagnose`` does; nothing is written.

    Parameters
    ----------
    campaign : path
        Campaign folder.
    calibrations : path
        Folder of the calibration records.
    without : sequence of str
        Effects to be taken out of the catalogue.
    only_runs : sequence of str
        Ids; empty: all.

    Returns
    -------
    Diagnosed
    """
    folder = Path(campaign)
    return Diagnosed(folder, diagnose_folder(folder, Path(calibrations), tuple(without), tuple(only_runs)))
