"""Captures of format `fogcap-1`: the layout, a streaming reader and a writer (capture contract).

Little endian: a header of 64 bytes, then records of 12 + 4 n bytes with nothing between them. The link
has no checksum, and the last record may be torn.
"""

from __future__ import annotations

import math
import os
import struct
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fogreduce.datasets.atomic import TemporaryFile
from fogreduce.datasets.block import RawBlock
from fogreduce.datasets.readers.facts import CaptureFacts
from fogreduce.errors import BadInput, Fault

FORMAT = "fogcap-1"
MAGIC = b"FOGCAP1\n"
HEADER_BYTES = 64
_LAYOUT = struct.Struct("<8sIHHddq24s")
_OFFSETS = {"magic": 0, "header": 8, "n": 12, "record": 14, "rate": 16, "volts": 24, "start": 32, "unit": 40}
_UNIT_BYTES = 24
_STAMP_WORDS = 3  # a record is 32-bit words: time stamp (2), pulse number (1), then a count a gyro


@dataclass(frozen=True)
class Header:
    """What the header of a capture says.

    Attributes
    ----------
    n_gyros : int
    sample_rate_hz, volts_per_count : float
    start_us : int
        Start, microseconds since 1970-01-01T00:00:00Z.
    unit : str
    """

    n_gyros: int
    sample_rate_hz: float
    volts_per_count: float
    start_us: int
    unit: str

    @property
    def record_bytes(self) -> int:
        """Bytes in a record."""
        return 12 + 4 * self.n_gyros

    def pack(self) -> bytes:
        """The 64 bytes that stand at the head of a capture."""
        unit = self.unit.encode("ascii").ljust(_UNIT_BYTES, b"\0")
        if len(unit) > _UNIT_BYTES:
            raise BadInput.at(
                "capture header", "unit", found=self.unit, expected=f"at most {_UNIT_BYTES} characters"
            )
        return _LAYOUT.pack(
            MAGIC,
            HEADER_BYTES,
            self.n_gyros,
            self.record_bytes,
            self.sample_rate_hz,
            self.volts_per_count,
            self.start_us,
            unit,
        )

    @classmethod
    def unpack(cls, data: bytes, file: str) -> Header:
        """From the first bytes of `file`; BadInput naming the byte offset of each fault."""

        def fault(key: str, found: object, expected: object) -> Fault:
            return Fault(file, f"byte {_OFFSETS[key]}", str(found), str(expected))

        if len(data) < HEADER_BYTES:
            raise BadInput.at(
                file, f"byte {len(data)}", found="the end of the file", expected="a header of 64 bytes"
            )
        magic, header, n, record, rate, volts, start, unit = _LAYOUT.unpack(data[:HEADER_BYTES])
        if magic != MAGIC:
            raise BadInput(fault("magic", repr(magic), f"the magic {MAGIC!r} of {FORMAT}"))
        faults = []
        if header != HEADER_BYTES:
            faults.append(fault("header", f"header length {header}", HEADER_BYTES))
        if n < 1:
            faults.append(fault("n", f"{n} gyros", "at least 1"))
        if record != 12 + 4 * n:
            faults.append(fault("record", f"record length {record}", f"{12 + 4 * n} for {n} gyros"))
        if not (math.isfinite(rate) and 0.01 <= rate <= 10_000):
            faults.append(fault("rate", f"sample rate {rate} Hz", "0.01 to 10000 Hz"))
        if not (math.isfinite(volts) and volts > 0):
            faults.append(fault("volts", f"{volts} volts per count", "a positive number"))
        name = unit.rstrip(b"\0")
        if not name or not all(33 <= byte < 127 for byte in name):
            faults.append(fault("unit", f"unit name {name!r}", "ASCII characters, padded with NUL"))
        if faults:
            raise BadInput(*faults)
        return cls(n, rate, volts, start, name.decode("ascii"))


def read_header(path: Path) -> Header:
    """The header of a capture; BadInput with the byte offset where it is not one."""
    try:
        with path.open("rb") as file:
            data = file.read(HEADER_BYTES)
    except OSError as error:
        raise BadInput.at(path, "", found=error.strerror, expected="a readable capture file") from None
    if not data:
        raise BadInput.at(path, "", found="an empty file", expected=f"a {FORMAT} capture")
    return Header.unpack(data, str(path))


class FogcapReader:
    """A capture, read in blocks.

    Attributes
    ----------
    facts : CaptureFacts
        What the header says.
    n_records : int
        Whole records in the file.
    torn_bytes : int
        Bytes of a last record that was cut off (0: none).
    """

    def __init__(self, path: Path, capture: Mapping[str, Any] | None = None, start_us: int = 0) -> None:
        # The header says itself what run.yaml says.
        self.path = path
        header = read_header(path)
        self.facts = CaptureFacts(
            header.n_gyros, header.sample_rate_hz, header.volts_per_count, header.start_us, header.unit
        )
        self._words = _STAMP_WORDS + header.n_gyros
        body = path.stat().st_size - HEADER_BYTES
        self.n_records, self.torn_bytes = divmod(body, header.record_bytes)
        if self.n_records == 0:
            raise BadInput.at(
                path, f"byte {HEADER_BYTES}", found="no whole record", expected="at least one record"
            )

    def place(self, record: int) -> str:
        """Where a record lies in the file, for a message."""
        return f"byte {HEADER_BYTES + 4 * self._words * record}"

    def blocks(self, size: int) -> Iterator[RawBlock]:
        """The records in file order, `size` at a time (the last block may be shorter)."""
        with self.path.open("rb", buffering=0) as file:
            file.seek(HEADER_BYTES)
            for start in range(0, self.n_records, size):
                count = min(size, self.n_records - start)
                words = np.fromfile(file, "<i4", count * self._words).reshape(-1, self._words)
                if len(words) != count:
                    raise BadInput.at(
                        self.path,
                        self.place(start + len(words)),
                        found="the end of the file",
                        expected=f"{self.n_records} records, as there were when it was opened",
                    )
                yield RawBlock(
                    start=start,
                    time_us=np.ascontiguousarray(words[:, :2]).view("<i8")[:, 0],
                    pulse=np.ascontiguousarray(words[:, 2]).view("<u4").astype(np.int64),
                    counts=np.ascontiguousarray(words[:, _STAMP_WORDS:].T),
                    values=None,
                )


class CaptureWriter:
    """Writes a capture block by block; it appears under its name when the `with` block ends well."""

    def __init__(self, path: Path, header: Header) -> None:
        self._target = TemporaryFile(path)
        self._header = header

    def __enter__(self) -> CaptureWriter:
        self._file = self._target.path.open("wb", buffering=0)
        self._write(self._header.pack())
        return self

    def append(
        self, time_us: NDArray[np.integer], pulse: NDArray[np.integer], counts: NDArray[np.int32]
    ) -> None:
        """Add records: stamps [us] (N,), pulse numbers (N,), counts (n, N)."""
        words = np.empty((len(time_us), _STAMP_WORDS + self._header.n_gyros), "<i4")
        words[:, :2] = time_us.astype("<i8").view("<i4").reshape(-1, 2)
        words[:, 2] = pulse.astype("<u4").view("<i4")
        words[:, _STAMP_WORDS:] = counts.T
        self._write(words.data.cast("B"))

    def _write(self, data: bytes | memoryview) -> None:
        view = memoryview(data)
        while len(view):
            view = view[os.write(self._file.fileno(), view) :]

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._file.close()
        self._target.finish(keep=kind is None)
