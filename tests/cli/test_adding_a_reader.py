"""The example reader of docs/adding-a-reader.md, taken from the page as it stands and put to use."""

import csv
import re
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest
from small_lab import RECORDS, START_US, VOLTS_PER_COUNT, csv_lines, records

from fogreduce.cli.main import main
from fogreduce.datasets.readers import READERS, open_capture

PAGE = Path(__file__).parents[2] / "docs" / "adding-a-reader.md"


@pytest.fixture
def labx(tmp_path, monkeypatch):
    """The page's example as an installer leaves it: the module, and what its pyproject.toml says of it."""
    page = PAGE.read_text()
    source = next(code for code in re.findall(r"```python\n(.*?)```", page, re.S) if "class" in code)
    project = tomllib.loads(re.search(r"```toml\n(.*?)```", page, re.S)[1])["project"]
    site = tmp_path / "site"
    about = site / "labx_reader-1.0.dist-info"
    about.mkdir(parents=True)
    (site / "labx.py").write_text(source)
    (about / "METADATA").write_text(
        f"Metadata-Version: 2.1\nName: {project['name']}\nVersion: {project['version']}\n"
    )
    points = project["entry-points"]["fogreduce.readers"]
    lines = [f"{name} = {place}" for name, place in points.items()]
    (about / "entry_points.txt").write_text("\n".join(["[fogreduce.readers]", *lines, ""]))
    monkeypatch.syspath_prepend(str(site))
    yield
    sys.modules.pop("labx", None)


def body(count: int = RECORDS) -> bytes:
    """The small laboratory's records as the logger of the page writes them."""
    good = records(count)
    table = np.zeros(count, [("time_s", "<f8"), ("volts", "<f4", (4,))])
    table["time_s"] = good["time"] / 1e6
    table["volts"] = good["counts"] * VOLTS_PER_COUNT
    return table.tobytes()


def write(lab, data: bytes, unit: str = "TETRA-01") -> Path:
    lab.capture.unlink()
    path = lab.run / "recording.labx"
    path.write_bytes(b"LABX 4\n" + unit.encode() + b"\n" + data)
    lab.write_run({"capture.file": path.name, "capture.format": "labx-1"})
    return path


def rates(lab) -> np.ndarray:
    with (lab.out / "tables" / "rate_fit.csv").open(newline="") as file:
        return np.array([[float(row["a_deg_s"]), float(row["sigma_deg_s"])] for row in csv.DictReader(file)])


def test_same_tables_as_csv(labx, small_lab):
    """A float32 carries 2^-24 of 20 mV, 1.2 nV; over 0.075 V/(deg/s) and H that is 5e-8 deg/s at most."""
    write(small_lab, body())
    assert main(["check", str(small_lab.run), "--calibrations", str(small_lab.calibrations)]) == 0
    assert main(small_lab.reduce()) == 0
    ours = rates(small_lab)
    (small_lab.run / "recording.labx").rename(small_lab.capture)
    small_lab.write_csv(csv_lines())
    assert main(small_lab.reduce()) == 0
    np.testing.assert_allclose(ours, rates(small_lab), rtol=0, atol=5e-8)


@pytest.mark.parametrize("size", [7, 960, 5000])
def test_blocks_do_not_depend_on_their_size(labx, small_lab, size):
    reader = open_capture(write(small_lab, body()), {"format": "labx-1", "sample_rate_hz": 16.0}, START_US)
    blocks = list(reader.blocks(size))
    whole = next(iter(reader.blocks(RECORDS)))
    assert [block.start for block in blocks] == list(range(0, RECORDS, size))
    assert whole.pulse is None  # the format numbers no records
    for name in ("time_us", "values"):
        joined = np.concatenate([getattr(block, name) for block in blocks], axis=-1)
        np.testing.assert_array_equal(joined, getattr(whole, name))


def test_a_torn_record_is_counted(labx, small_lab):
    write(small_lab, body()[:-10])
    assert main(small_lab.reduce()) == 0
    quality = (small_lab.out / "tables" / "quality.csv").read_text()
    assert f"records,{RECORDS - 1}," in quality
    assert "torn_bytes,14," in quality  # of the 24 bytes of a record


def test_its_faults_are_said_like_any_other(labx, small_lab, capsys):
    path = write(small_lab, body(), unit="TETRA-07")
    assert main(small_lab.reduce()) == 2
    expected = f"{path}: header: found unit TETRA-07; expected TETRA-01, as unit of run.yaml says\n"
    assert capsys.readouterr().err == expected
    path.write_bytes(b"LABX four\nTETRA-01\n")
    assert main(small_lab.reduce()) == 2
    assert capsys.readouterr().err == (
        f"{path}: line 1: found b'LABX four'; expected LABX and the number of gyros\n"
    )


def test_a_format_that_is_not_installed(small_lab, capsys):
    """Without its package the example is unknown, and the message lists what is known."""
    write(small_lab, body())
    assert main(small_lab.reduce()) == 2
    expected = "capture.format: found labx-1; expected one of " + ", ".join(READERS)
    assert capsys.readouterr().err == f"{small_lab.yaml}: {expected}\n"
