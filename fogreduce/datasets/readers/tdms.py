"""Captures of format `tdms`: channels of a LabVIEW file as columns, by ``group/channel``.

Where the channels are waveforms (property ``wf_increment``) the file states its own sample rate.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fogreduce.datasets.readers.arrays import ArrayColumn, chunks_of, of_one_length
from fogreduce.datasets.readers.columns import Chunk, ColumnsReader, needs
from fogreduce.errors import BadInput

FORMAT = "tdms"


class TdmsReader(ColumnsReader):
    """Channels of a TDMS file, read in chunks."""

    def _open(self) -> Sequence[str]:
        library = needs("nptdms", "tdms", self.path)
        try:
            self._file = library.TdmsFile.open(self.path)
        except (OSError, ValueError, KeyError) as error:
            found = getattr(error, "strerror", None) or str(error)
            raise BadInput.at(self.path, "", found=found[:100], expected="a TDMS file") from None
        columns, increments = [], set()
        for group in self._file.groups():
            for channel in group.channels():
                if channel.dtype.kind in "fiubM" and len(channel):
                    columns.append(
                        ArrayColumn(f"{group.name}/{channel.name}", len(channel), _reader(channel))
                    )
                    increments.add(channel.properties.get("wf_increment"))
                    started = channel.properties.get("wf_start_time")
                    if isinstance(started, np.datetime64) and not np.isnat(started):
                        self.first_us = int(started.astype("datetime64[us]").astype(np.int64))
                    if unit := channel.properties.get("unit_string"):
                        self.units[f"{group.name}/{channel.name}"] = str(unit)
        self._columns = of_one_length(columns, self.capture, self.path)
        self.n_records = self._columns[0].records if self._columns else 0
        increment = increments.pop() if len(increments) == 1 else None
        if increment:
            self.sample_rate_hz = 1.0 / float(increment)
        return [column.name for column in self._columns]

    def _chunks(self, columns: Sequence[int], size: int) -> Iterator[Chunk]:
        yield from chunks_of(self._columns, columns, self.n_records, size)


def _reader(channel: Any) -> Any:
    def read(start: int, stop: int) -> NDArray[Any]:
        return np.asarray(channel[start:stop])

    return read
