"""budget.nc: obsarray's convention as it is written, and as obsarray reads it."""

from __future__ import annotations

import numpy as np
import pytest
import xarray

PARTS = ("noise", "calibration_record", "turn_on", "azimuth", "latitude", "table_rate")


@pytest.fixture
def there_and_back(bench):
    return bench.reduce(bench.run(n=4, profile=((1.2, 300.0), (-1.2, 300.0)), sample_rate_hz=16.0))


def combined_of_table(reduced, quantity: str) -> np.ndarray:
    """(segments, axes): combined standard uncertainty by budget.csv."""
    rows = {
        (row["segment"], row["channel"]): float(row["u_combined"])
        for row in reduced.table("budget")
        if row["quantity"] == quantity
    }
    segments = list(dict.fromkeys(segment for segment, _ in rows))
    return np.array([[rows[segment, axis] for axis in "xyz"] for segment in segments])


def test_the_attributes_are_those_of_the_convention(there_and_back) -> None:
    with xarray.open_dataset(there_and_back.dataset("budget")) as data:
        assert data["segment"].values.tolist() == ["1", "2", "all"]
        for quantity in ("drift", "integral", "mean_rate", "a"):
            measurand = data[quantity]
            components = measurand.attrs["unc_comps"]
            # those that are more than rounding: of drift neither a bias nor, over whole turns, the latitude
            assert set(components) <= {f"u_{part}_{quantity}" for part in PARTS}
            assert {f"u_noise_{quantity}", f"u_calibration_record_{quantity}"} <= set(components)
            assert (f"u_turn_on_{quantity}" in components) == (quantity != "drift")
            assert measurand.attrs["ancillary_variables"].split() == components
            squares = sum(data[name] ** 2 for name in components)
            found = np.sqrt(squares.values)[: 3 if quantity != "a" else 2]
            np.testing.assert_allclose(found, combined_of_table(there_and_back, quantity), rtol=1e-12)
            for name in components:
                about = data[name].attrs
                assert data[name].dims == measurand.dims
                assert about["err_corr_1_dim"] == ["segment", "axis"]
                assert about["pdf_shape"] == "gaussian"
                assert about["units"] == measurand.attrs["units"]
                if about["err_corr_1_form"] == "err_corr_matrix":
                    matrix = data[about["err_corr_1_params"]].values
                    assert np.linalg.eigvalsh(matrix)[0] > -1e-9
                    np.testing.assert_allclose(np.diag(matrix), 1.0)


def test_a_unit_of_two_gyros_has_its_curves(bench) -> None:
    reduced = bench.reduce(bench.run(n=2, profile=((1.2, 60.0),), sample_rate_hz=16.0))
    with xarray.open_dataset(reduced.dataset("budget")) as data:
        assert "drift" not in data
        assert data["u_noise_gyro_a"].attrs["err_corr_1_form"] == "random"
        assert data["gyro_a"].attrs["unc_comps"] in (["u_noise_gyro_a"], "u_noise_gyro_a")


def test_obsarray_reads_the_covariance(there_and_back) -> None:
    """The covariance of x, y, z that obsarray builds is that of correlations.csv."""
    pytest.importorskip(
        "obsarray", reason="obsarray is not among the test requirements: it brings scikit-learn with it"
    )
    with xarray.open_dataset(there_and_back.dataset("budget")) as data:
        data.load()
    whole = data.unc["drift"][2:, :].total_err_cov_matrix().values
    errors = combined_of_table(there_and_back, "drift")[2]
    np.testing.assert_allclose(np.sqrt(np.diag(whole)), errors, rtol=1e-9)
    for row in there_and_back.table("correlations"):
        if (row["quantity"], row["segment"]) == ("drift", "all"):
            i, j = ("xyz".index(row[name]) for name in ("channel_1", "channel_2"))
            stated = float(row["covariance_stated"])
            # noise is given by one correlation for all segments
            expected = stated + float(row["covariance_noise"])
            assert whole[i, j] == pytest.approx(expected, abs=0.02 * errors[i] * errors[j])
