"""The certificate on paper and as a DCC: structure, values against the record, bytes."""

from __future__ import annotations

import hashlib
import xml.etree.ElementTree as ET
from pathlib import Path
from types import SimpleNamespace

import dcc_structure
import numpy as np
import pytest
import yaml
from calibration_bench import Bench

from fogreduce.calibrate.certificate import temperature_in_words
from fogreduce.cli.main import main
from fogreduce.metadata.folder import read_calibration

ABOUT = {
    "laboratory": {"name": "Laboratory & Sons", "city": "São José", "country": "BR"},
    "responsible": "A. Person <a@b>",
    "customer": {"name": "A customer", "street": "Road 1"},
    "table": {
        "name": "Table $T_1$",
        "serial_number": "47",
        "certificate": "TC-1",
        "certificate_sha256": "0f" * 32,
    },
}
NS = {"dcc": "https://ptb.de/dcc", "si": "https://ptb.de/si"}


def derived(bench, out: Path, about: dict | None, campaign: Path) -> Path:
    data = {} if about is None else {"certificate": about}
    (campaign / "campaign.yaml").write_text(yaml.safe_dump(data))
    words = [
        "derive-calibration",
        str(campaign),
        "--calibrations",
        str(bench.calibrations),
        "--out",
        str(out),
    ]
    assert main(words) == 0
    return out / "UNIT" / "a-derived.yaml"


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A bench, and its campaign: one for all."""
    bench = Bench(tmp_path_factory.mktemp("certificate"))
    return bench, bench.simulate()


@pytest.fixture(scope="module")
def certified(made, tmp_path_factory):
    """With all that campaign.yaml may state."""
    bench, campaign = made
    path = derived(bench, tmp_path_factory.mktemp("full"), ABOUT, campaign)
    return path, ET.parse(path.with_suffix(".dcc.xml")).getroot()


def text(root: ET.Element, path: str) -> str:
    found = root.find(path, NS)
    assert found is not None, path
    return found.text or ""


def test_the_structure_is_that_of_the_schema(certified, made, tmp_path) -> None:
    assert dcc_structure.faults(certified[1]) == []
    bare = derived(made[0], tmp_path, None, made[1])
    root = ET.parse(bare.with_suffix(".dcc.xml")).getroot()
    assert dcc_structure.faults(root) == []
    assert text(root, ".//dcc:coreData/dcc:countryCodeISO3166_1") == "ZZ"
    assert root.find(".//dcc:certificate", NS) is None
    assert text(root, ".//dcc:influenceCondition/dcc:data/dcc:text/dcc:content") == "not logged"


def test_the_temperature_in_words() -> None:
    runs = [SimpleNamespace(temperature=one) for one in (np.array([0.1, -1.26]), None, np.array([0.4]))]
    expected = "logged in 2 of 3 runs; the sensors' changed by up to 1.3 degC from a run's start"
    assert temperature_in_words(runs) == expected


def test_what_the_check_of_structure_finds(certified) -> None:
    """An element out of order, one missing, one unknown, a number that is none, a unit that is none."""
    raw = ET.tostring(certified[1], encoding="unicode")
    for old, new in (
        ("<dcc:release>v0.1.0</dcc:release>", ""),
        ("<dcc:release>v0.1.0</dcc:release>", "<dcc:release>0.1.0</dcc:release>"),
        ("influenceConditions", "usedSoftware"),
        ("dcc:typeOfChange>", "dcc:typeOfChanges>"),
        (">substituted<", ">replaced<"),
        ("\\degree\\hour\\tothe{-1}", "deg/h"),
        ('schemaVersion="3.3.0"', 'schemaVersion="3.2.1"'),
    ):
        assert old in raw
        assert dcc_structure.faults(ET.fromstring(raw.replace(old, new)))


def test_what_is_superseded_and_what_it_is_traceable_to(certified, made) -> None:
    path, root = certified
    core = ".//dcc:coreData"
    assert text(root, f"{core}/dcc:uniqueIdentifier") == "UNIT@a-derived"
    assert text(root, f"{core}/dcc:reportAmendedSubstituted/dcc:replacedUniqueIdentifier") == "UNIT@a"
    earlier = hashlib.sha256((made[0].calibrations / "UNIT" / "a.yaml").read_bytes()).hexdigest()
    assert text(root, f"{core}/dcc:previousReport/dcc:value") == earlier
    assert (
        text(root, f"{core}/dcc:identifications//dcc:value") == hashlib.sha256(path.read_bytes()).hexdigest()
    )
    equipment = ".//dcc:measuringEquipment/dcc:certificate"
    assert text(root, f"{equipment}/dcc:referralID") == "TC-1"
    assert text(root, f"{equipment}/dcc:value") == "0f" * 32


def quantities(root: ET.Element) -> dict[str, ET.Element]:
    found = {}
    for quantity in root.iterfind(".//dcc:quantity", NS):
        numbers = quantity.find("si:realListXMLList", NS)
        assert numbers is not None
        found[text(quantity, "dcc:name/dcc:content")] = numbers
    return found


def numbers_of(element: ET.Element, name: str) -> np.ndarray:
    return np.array(text(element, f".//si:{name}").split(), float)


def test_numbers_are_the_records_in_the_units_that_stand_beside_them(certified) -> None:
    path, root = certified
    record, found = read_calibration(path), quantities(root)
    stated, scale = record.stated_uncertainty, found["scale factor"]
    # The candidate's axes are of length 1 but for rounding: C is the record's.
    assert numbers_of(scale, "valueXMLList") == pytest.approx(record.scale_factor, rel=1e-12)
    assert text(scale, "si:unitXMLList") == r"\volt\second\degree\tothe{-1}"
    expanded = 2 * np.abs(record.scale_factor) * stated.scale_factor_rel
    assert numbers_of(scale, "valueExpandedMUXMLList") == pytest.approx(expanded, rel=1e-12)
    bias = np.array(record.bias) / record.scale_factor * 3600
    assert numbers_of(found["bias"], "valueXMLList") == pytest.approx(bias, rel=1e-12)
    covariance = found["departures"]
    values = [float(one.text) for one in covariance.iterfind(".//si:covariance/si:value", NS)]
    assert record.covariance is not None
    assert np.array(values).reshape(16, 16) == pytest.approx(np.array(record.covariance.matrix).T)
    assert float(text(covariance, ".//si:coverageFactor")) == pytest.approx(5.128, abs=1e-3)  # chi2(0.95, 16)


def test_the_paper_has_no_date_and_no_software_in_it(certified) -> None:
    raw = certified[0].with_suffix(".pdf").read_bytes()
    assert raw.startswith(b"%PDF-1.4")
    assert b"CreationDate" not in raw
    assert b"Matplotlib" not in raw
    assert raw.count(b"/Type /Page\n") + raw.count(b"/Type /Page ") == 2


@pytest.mark.parametrize(
    ("about", "expected"),
    [
        (
            {"laboratory": {"name": "L", "country": "Brazil"}},
            "country: found the text 'Brazil'; expected two capital letters",
        ),
        (
            {"table": {"name": "T", "certificate": "1", "certificate_sha256": "12"}},
            "certificate_sha256: found",
        ),
        ({"table": {"name": "T"}}, "certificate.table.certificate: found nothing"),
        ({"signed": True}, "certificate.signed"),
    ],
)
def test_bad_input_names_the_key(made, tmp_path, capsys, about, expected) -> None:
    bench, campaign = made
    (campaign / "campaign.yaml").write_text(yaml.safe_dump({"certificate": about}))
    words = ["derive-calibration", str(campaign), "--calibrations", str(bench.calibrations)]
    assert main([*words, "--out", str(tmp_path / "out")]) == 2
    assert expected in capsys.readouterr().err
    assert not (tmp_path / "out").exists()
