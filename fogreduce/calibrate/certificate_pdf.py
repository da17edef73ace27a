"""The certificate of a candidate record on paper: pages of A4 to print and to sign.

The same facts give the same bytes: the file names no date and no software.
"""

from __future__ import annotations

from pathlib import Path

from fogreduce.calibrate.certificate import COVERAGE_FACTOR, COVERAGE_PROBABILITY, NOT_STATED, Facts
from fogreduce.metadata.certificate import Party
from fogreduce.pages.numbers import number, plus_minus
from fogreduce.plotting.paper import Paper, paper

_SIZE_PT, _SMALL_PT = 9.0, 7.5
_WIDTHS = (0.08, 0.20, 0.26, 0.32, 0.14)  # of the columns of coefficients
_RUNS_SHOWN = 12


def write_pdf(facts: Facts, path: Path) -> None:
    """Write the certificate.

    Parameters
    ----------
    facts : Facts
    path : Path
    """
    record_id = facts.record.record_id
    with paper(path, f"Calibration certificate {record_id}", record_id, _SIZE_PT) as pages:
        _first_page(pages, facts)
        pages.turn()
        _results(pages, facts)
        _pedigree(pages, facts)


def _first_page(pages: Paper, facts: Facts) -> None:
    about, record = facts.about, facts.record
    pages.title("Calibration certificate")
    pages.text(f"{record.record_id}: candidate, in force once it is signed and named by a run or a campaign")
    pages.rule()
    pages.heading("Calibrated item")
    pages.pair("Unit", f"{record.unit}, {record.n} gyro{'' if record.n == 1 else 's'}")
    pages.pair("Customer", _party(about.customer))
    pages.heading("Calibration")
    pages.pair("Laboratory", _party(about.laboratory))
    pages.pair("Carried out", f"{facts.first:%Y-%m-%d %H:%M} to {facts.last:%Y-%m-%d %H:%M} UTC")
    pages.pair("Procedure", facts.procedure)
    pages.pair("Campaign", facts.campaign)
    table = about.table
    if table is None:
        pages.pair("Rate table", NOT_STATED)
    else:
        serial = f", serial number {table.serial_number}" if table.serial_number else ""
        pages.pair("Rate table", table.name + serial)
        pages.pair("Its certificate", f"{table.certificate}, SHA-256 {table.certificate_sha256}")
    pages.pair("Software", facts.software)
    fit = f"chi-square {facts.chi2:.0f} for {facts.freedom:.0f} degrees of freedom"
    pages.pair("Goodness of fit", f"{fit}, p = {number(facts.p_value)}")
    pages.heading("Records")
    pages.pair("This record", f"{record.record_id}, SHA-256 {facts.record_sha256}")
    pages.pair("Supersedes", f"{facts.present_id}, SHA-256 {facts.present_sha256}")
    pages.pair("Valid from", f"{record.valid_from:%Y-%m-%d %H:%M} UTC")
    pages.heading("Uncertainty")
    pages.text(
        f"± is the expanded uncertainty, {COVERAGE_FACTOR:g} standard deviations, which holds "
        f"{COVERAGE_PROBABILITY:.2%} of a normal quantity. It includes noise within runs, turn-on scatter "
        "between runs, and azimuth, latitude and table rate as far as they are stated uncertain. It does not "
        "include departures of the scale factor from a straight line, nor change after the calibration. The "
        "full covariance is in the record."
    )
    pages.heading("Signature")
    pages.pair("Responsible", about.responsible or NOT_STATED)
    pages.down(3.5)
    pages.rule(0.0, 0.43)
    pages.rule(0.55, 1.0)
    pages.down(0.3)
    pages.put(0.0, "place and date", size=_SMALL_PT)
    pages.put(0.55, "signature", size=_SMALL_PT)


def _results(pages: Paper, facts: Facts) -> None:
    found, raw = facts.coefficients, facts.record.raw_unit.name
    pages.heading("Results")
    rows = []
    for i in range(facts.record.n):
        scale = found.scale_factor[i]
        rows.append(
            [
                f"gyro{i + 1}",
                plus_minus(found.bias_deg_h[i], COVERAGE_FACTOR * found.bias_std_deg_h[i]),
                plus_minus(scale, COVERAGE_FACTOR * abs(scale) * found.scale_factor_std_rel[i]),
                "[" + ", ".join(f"{one:.6f}" for one in found.axes[i]) + "]",
                f"± {number(COVERAGE_FACTOR * found.axis_std_rad[i] * 1e3, 2)}",
            ]
        )
    scale_unit = f"scale factor [{raw}/(deg/s)]"
    heads = ("gyro", "bias [deg/h]", scale_unit, "input axis [x, y, z] in the unit frame", "pointing [mrad]")
    pages.table(heads, _WIDTHS, rows, _SMALL_PT)


def _pedigree(pages: Paper, facts: Facts) -> None:
    pages.down(0.5)
    pages.text(
        "pointing: of the axis, in each of two directions at right angles to it; bias: by the scale factor "
        "beside it."
    )
    turn_on, noise = facts.coefficients.turn_on_bias_deg_h, facts.record.stated_noise
    pages.heading("Repeatability and noise, one standard deviation")
    for i in range(facts.record.n):
        pages.pair(
            f"gyro{i + 1}",
            f"turn-on bias {number(turn_on[i], 2)} deg/h; angle random walk "
            f"{number(noise.angle_random_walk_deg_sqrt_h[i], 3)} deg/√h; bias instability "
            f"{number(noise.bias_instability_deg_h[i], 3)} deg/h; rate random walk "
            f"{number(noise.rate_random_walk_deg_h_sqrt_h[i], 3)} deg/h/√h",
        )
    runs = facts.record.pedigree.runs if facts.record.pedigree is not None else ()
    pages.heading("Runs")
    shown = runs[:_RUNS_SHOWN]
    for run in shown:
        pages.pair(run.run_id, f"capture SHA-256 {run.capture_sha256}")
    if len(runs) > len(shown):
        pages.text(f"and {len(runs) - len(shown)} more, in the record's pedigree")


def _party(party: Party | None) -> str:
    if party is None:
        return NOT_STATED
    return ", ".join(filter(None, (party.name, party.street, party.city, party.country)))
