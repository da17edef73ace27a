"""fogcap-1: layout by hand, round trip, torn records, and every fault of a header with its place."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from fogreduce.datasets.block import RawBlock
from fogreduce.datasets.readers import open_capture
from fogreduce.datasets.readers.fogcap import CaptureWriter, FogcapReader, Header, read_header
from fogreduce.errors import BadInput

MISSING = -(2**31)


def header_bytes(**changes) -> bytes:
    """The 64 bytes of capture.md, written from its table alone."""
    values = {
        "magic": b"FOGCAP1\n",
        "header": 64,
        "n": 2,
        "record": 20,
        "rate": 128.0,
        "volts": 1e-7,
        "start": 1_399_899_600_000_000,  # 2014-05-12T13:00:00Z
        "unit": b"TETRA-01",
    } | changes
    return struct.pack("<8sIHHddq24s", *values.values())


def record_bytes(time_us: int, pulse: int, *counts: int) -> bytes:
    return struct.pack(f"<QI{len(counts)}i", time_us, pulse, *counts)


RECORDS = [(0, 0, 1, -1), (7812, 1, MISSING, 2**31 - 1), (2**40, 2**32 - 1, -(2**31) + 1, 0)]


@pytest.fixture
def capture(tmp_path) -> Path:
    path = tmp_path / "capture.fogcap"
    path.write_bytes(header_bytes() + b"".join(record_bytes(*record) for record in RECORDS))
    return path


def whole(path: Path, size: int = 100) -> RawBlock:
    blocks = list(FogcapReader(path).blocks(size))
    assert [block.start for block in blocks] == list(range(0, size * len(blocks), size))
    return RawBlock(
        0,
        np.concatenate([block.time_us for block in blocks]),
        np.concatenate([block.pulse for block in blocks]),
        np.concatenate([block.counts for block in blocks], axis=1),
        None,
    )


@pytest.mark.parametrize("size", [1, 2, 3, 100])
def test_a_capture_written_by_hand_is_read(capture: Path, size: int) -> None:
    """Bytes from the contract's table: stamps of 64 bits, pulse numbers to 2^32 - 1, counts with their
    signs."""
    reader = FogcapReader(capture)
    assert (reader.n_records, reader.torn_bytes) == (3, 0)
    facts = reader.facts
    assert (facts.n_gyros, facts.sample_rate_hz, facts.least_count) == (2, 128.0, 1e-7)
    assert (facts.start_us, facts.unit) == (1_399_899_600_000_000, "TETRA-01")
    block = whole(capture, size)
    np.testing.assert_array_equal(block.time_us, [0, 7812, 2**40])
    np.testing.assert_array_equal(block.pulse, [0, 1, 2**32 - 1])
    np.testing.assert_array_equal(block.counts, [[1, MISSING, -(2**31) + 1], [-1, 2**31 - 1, 0]])


def test_the_writer_writes_the_contracts_bytes(capture: Path, tmp_path) -> None:
    target = tmp_path / "written.fogcap"
    times, pulses, *counts = (np.array(column) for column in zip(*RECORDS, strict=True))
    with CaptureWriter(target, Header(2, 128.0, 1e-7, 1_399_899_600_000_000, "TETRA-01")) as writer:
        writer.append(times[:1], pulses[:1], np.array(counts, np.int32)[:, :1])
        assert not target.exists()
        writer.append(times[1:], pulses[1:], np.array(counts, np.int32)[:, 1:])
    assert target.read_bytes() == capture.read_bytes()


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None, max_examples=50)
@given(data=st.data(), n=st.integers(1, 6), size=st.integers(1, 40), block=st.integers(1, 50))
def test_round_trip(tmp_path, data, n: int, size: int, block: int) -> None:
    path = tmp_path / "capture.fogcap"
    seed = data.draw(st.integers(0, 2**32 - 1))
    generator = np.random.default_rng(seed)
    times = generator.integers(0, 2**62, size)
    pulses = generator.integers(0, 2**32, size)
    counts = generator.integers(-(2**31), 2**31, (n, size)).astype(np.int32)
    with CaptureWriter(path, Header(n, 64.5, 3e-6, -5, "U")) as writer:
        writer.append(times, pulses, counts)
    assert read_header(path) == Header(n, 64.5, 3e-6, -5, "U")
    block_read = whole(path, block)
    np.testing.assert_array_equal(block_read.time_us, times)
    np.testing.assert_array_equal(block_read.pulse, pulses)
    np.testing.assert_array_equal(block_read.counts, counts)


@pytest.mark.parametrize("torn", range(1, 20))
def test_a_torn_last_record_is_counted_and_not_read(capture: Path, torn: int) -> None:
    capture.write_bytes(capture.read_bytes()[:-torn])
    reader = FogcapReader(capture)
    assert (reader.n_records, reader.torn_bytes) == (2, 20 - torn)
    assert whole(capture).pulse.tolist() == [0, 1]
    assert reader.place(reader.n_records) == "byte 104"


FAULTS = [
    ({"magic": b"FOGCAP2\n"}, "byte 0", "FOGCAP1"),
    ({"header": 60}, "byte 8", "64"),
    ({"n": 0, "record": 12}, "byte 12", "at least 1"),
    ({"record": 24}, "byte 14", "20 for 2 gyros"),
    ({"rate": 0.0}, "byte 16", "0.01 to 10000 Hz"),
    ({"rate": float("nan")}, "byte 16", "0.01 to 10000 Hz"),
    ({"rate": 10_001.0}, "byte 16", "0.01 to 10000 Hz"),
    ({"volts": 0.0}, "byte 24", "a positive number"),
    ({"volts": float("inf")}, "byte 24", "a positive number"),
    ({"volts": -1e-7}, "byte 24", "a positive number"),
    ({"unit": b""}, "byte 40", "ASCII"),
    ({"unit": b"TETRA\xff"}, "byte 40", "ASCII"),
    ({"unit": b"TE\0TRA"}, "byte 40", "ASCII"),
]


@pytest.mark.parametrize(("changes", "where", "expected"), FAULTS)
def test_each_fault_of_a_header_has_its_byte(tmp_path, changes: dict, where: str, expected: str) -> None:
    path = tmp_path / "capture.fogcap"
    path.write_bytes(header_bytes(**changes) + record_bytes(*RECORDS[0]))
    with pytest.raises(BadInput) as error:
        open_capture(path, {"format": "fogcap-1", "sample_rate_hz": 128.0}, 0)
    (fault,) = error.value.faults
    assert (fault.file, fault.where) == (str(path), where)
    assert expected in fault.expected


def test_all_faults_of_a_header_at_once(tmp_path) -> None:
    path = tmp_path / "capture.fogcap"
    path.write_bytes(header_bytes(record=21, rate=-1.0, volts=0.0))
    with pytest.raises(BadInput) as error:
        read_header(path)
    assert [fault.where for fault in error.value.faults] == ["byte 14", "byte 16", "byte 24"]


@pytest.mark.parametrize(
    ("content", "where", "found"),
    [
        (b"", "", "an empty file"),
        (header_bytes()[:40], "byte 40", "the end of the file"),
        (header_bytes(), "byte 64", "no whole record"),
        (header_bytes() + b"\0" * 19, "byte 64", "no whole record"),
    ],
)
def test_files_that_end_too_early(tmp_path, content: bytes, where: str, found: str) -> None:
    path = tmp_path / "capture.fogcap"
    path.write_bytes(content)
    with pytest.raises(BadInput) as error:
        open_capture(path, {"format": "fogcap-1", "sample_rate_hz": 128.0}, 0)
    assert (error.value.faults[0].where, error.value.faults[0].found) == (where, found)


def test_a_file_that_shrinks_while_it_is_read(capture: Path) -> None:
    reader = FogcapReader(capture)
    blocks = reader.blocks(1)
    next(blocks)
    capture.write_bytes(capture.read_bytes()[:84])
    with pytest.raises(BadInput, match="byte 84"):
        next(blocks)


def test_no_such_file_a_folder_and_an_unknown_format(tmp_path) -> None:
    for path, name, part in (
        (tmp_path / "none", "fogcap-1", "No such file"),
        (tmp_path, "fogcap-1", "a directory"),
        (tmp_path / "none", "fogcap-9", "one of fogcap-1, csv-1"),
    ):
        with pytest.raises(BadInput, match=part):
            open_capture(path, {"format": name, "sample_rate_hz": 128.0}, 0)


def test_an_aborted_capture_does_not_appear(tmp_path) -> None:
    path = tmp_path / "capture.fogcap"
    header = Header(1, 1.0, 1.0, 0, "U")
    with pytest.raises(RuntimeError), CaptureWriter(path, header) as writer:  # noqa: PT012
        writer.append(np.arange(3), np.arange(3), np.zeros((1, 3), np.int32))
        raise RuntimeError
    assert list(tmp_path.iterdir()) == []


def test_a_name_too_long_for_the_header() -> None:
    with pytest.raises(BadInput, match="at most 24"):
        Header(1, 1.0, 1.0, 0, "U" * 25).pack()
    assert len(Header(1, 1.0, 1.0, 0, "U" * 24).pack()) == 64
