"""What a row of the tables of faults is."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from string import Template

from small_lab import SmallLab


@dataclass(frozen=True)
class Case:
    """One fault.

    Attributes
    ----------
    name : str
        What is wrong, for the test's id.
    spoil : function
        Puts the fault into a good laboratory; returns the command's arguments, anything else to reduce
        the run.
    message : str
        All that standard error says, one line a fault; ``$capture``, ``$yaml``, ``$record``, ``$run``,
        ``$out``, ``$root``, ``$campaign`` stand for paths, ``$version`` for the manifest's version and
        ``$stale`` for that of the dataset of ingest.
    """

    name: str
    spoil: Callable[[SmallLab], object]
    message: str

    def expected(self, lab: SmallLab) -> str:
        """The message with the laboratory's own paths."""
        names = ("capture", "yaml", "record", "run", "out", "root", "campaign")
        paths = {name: getattr(lab, name) for name in names}
        return Template(self.message).substitute(paths, **lab.versions())
