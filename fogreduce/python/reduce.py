"""`fogreduce.reduce`: one run, all stages."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fogreduce.errors import BadInput
from fogreduce.metadata.raw_folder import refuse_raw
from fogreduce.pages.summary_line import summary_line
from fogreduce.provenance.manifest import manifest
from fogreduce.stages.read_tables import COLUMNS, read_rows
from fogreduce.stages.reduce_into import reduce_into
from fogreduce.stages.setup import Setup

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr
    from matplotlib.figure import Figure

    from fogreduce.characterise.allan_result import Allan

Folder = str | os.PathLike[str]


@dataclass(frozen=True)
class Reduction:
    """A reduced run.

    Attributes
    ----------
    out : Path
        Its results folder.
    run : Path
        The run's folder.
    """

    out: Path
    run: Path

    @property
    def _setup(self) -> Setup:
        return Setup.read(self.out)

    def __repr__(self) -> str:
        setup = self._setup
        warnings = len(read_rows(self.out, "warnings", setup.version_id, setup.facts.raw_unit))
        return f"Reduction of {self.run.name}: {summary_line(setup, warnings)}"

    def open(self) -> xr.Dataset:
        """The stages' data, lazily; see `fogreduce.open_run`."""
        from fogreduce.datasets.view import open_run

        return open_run(self.out)

    def table(self, name: str) -> pd.DataFrame:
        """A table of results, for instance ``drift``, ``rates``, ``gyro_fit``, ``quality``."""
        import pandas as pd

        if name not in COLUMNS:
            raise ValueError(f"no table {name}; expected one of {', '.join(COLUMNS)}")
        return pd.read_csv(self.out / "tables" / f"{name}.csv")

    def allan(self) -> Allan:
        """Its Allan deviations; see `fogreduce.allan`."""
        from fogreduce.characterise.allan_run import allan_of_run

        return allan_of_run(self.out)

    def plot(self, figure: str = "rates") -> Figure:
        """A figure by its name: ``rates``, ``angles``, ``residuals_axes`` and others."""
        from fogreduce.figures.catalogue import plan
        from fogreduce.figures.results import Results
        from fogreduce.plotting.style import style

        drawn = plan(Results.read(self.out), self.run).drawn
        if figure not in drawn:
            raise ValueError(f"no figure {figure}; expected one of {', '.join(drawn)}")
        with style():
            return drawn[figure]()


def reduce(run: Folder, calibrations: Folder, out: Folder, **parameters: Any) -> Reduction:
    """Reduce one run: raw readings to rates, mean curves and drift, as ``fogreduce reduce`` does.

    Parameters
    ----------
    run : path
        The run's folder, with its run.yaml.
    calibrations : path
        Folder of the calibration records.
    out : path
        Folder for the results.
    **parameters
        Of the reduction, as in the configuration (``edge_guard_s=1.0``).

    Returns
    -------
    Reduction

    Raises
    ------
    BadInput
        One clear message for each thing wrong with the input.
    """
    folder, results = Path(run), Path(out)
    if not folder.is_dir():
        found = "a file" if folder.exists() else "no such folder"
        raise BadInput.at(folder, "", found=found, expected="a run's folder")
    refuse_raw("out", results)
    records = Path(calibrations)
    reduce_into(Setup(manifest(folder, records, parameters), results), folder, records)
    return Reduction(results, folder)
