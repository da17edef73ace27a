"""A run whose temperature log has one column: reduced, drawn and shown like any other."""

import h5py
import pytest

from fogreduce.cli.main import main


@pytest.mark.parametrize("column", ["sensor_degC", "electronics_degC"])
def test_one_temperature_is_enough(small_lab, column):
    log = small_lab.run / "temperature.csv"
    log.write_text(f"time_s,{column}\n0,20\n30,20.5\n60,22\n")
    small_lab.write_run({"temperature": log.name})
    assert main(["check", str(small_lab.run), "--calibrations", str(small_lab.calibrations)]) == 0
    assert main(small_lab.reduce()) == 0
    with h5py.File(small_lab.out / "datasets" / "ingest.nc") as file:
        assert list(file["sensor_temperature"][:]) == [20.0, 20.5, 22.0]
        assert ("electronics_temperature" in file) == (column == "electronics_degC")
    assert main(["figures", "--run", str(small_lab.run), "--out", str(small_lab.out)]) == 0
    assert any("temperature" in path.name for path in (small_lab.out / "figures").iterdir())
