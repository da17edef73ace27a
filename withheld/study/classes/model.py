"""What a class of campaigns is: its cells, and how a campaign is drawn for one of them."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from withheld.study.plan import Drawn, Plan
from withheld.study.protocol import Protocol

# Effects that the plan fixes, and the target SNR that it fixes (0: none).
Cell = tuple[tuple[str, ...], float]


@dataclass(frozen=True)
class CampaignClass:
    """A class of campaigns.

    Parameters
    ----------
    title : str
        As a table of scores is headed.
    draw : (protocol, plan, rng) -> Drawn
    cells : list of Cell
        What is cycled through, in a drawn order, for as many campaigns as are asked for.
    """

    title: str
    draw: Callable[[Protocol, Plan, np.random.Generator], Drawn]
    cells: tuple[Cell, ...] = (((), 0.0),)

    def spread(self, campaigns: int, rng: np.random.Generator) -> list[Cell]:
        """A cell for each of that many campaigns: every cell once before any comes twice."""
        order = [k for _ in range(-(-campaigns // len(self.cells))) for k in rng.permutation(len(self.cells))]
        return [self.cells[k] for k in order[:campaigns]]
