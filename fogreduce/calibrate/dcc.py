"""The certificate of a candidate record as a Digital Calibration Certificate (DCC 3.3.0, XML).

Source: PTB, schema of the DCC, https://ptb.de/dcc/v3.3.0/dcc.xsd, with numbers and units as D-SI has them
(https://ptb.de/si). PTB's Schematron rules for DCCs are kept but one: a DCC wants a country and contacts,
and where campaign.yaml states none, `ZZ` (ISO 3166-1, user-assigned: unknown, which those rules do not list)
and "not stated" stand. It is not signed and names no day of issue: a person does.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.special import chdtri

from fogreduce.calibrate.certificate import COVERAGE_FACTOR, COVERAGE_PROBABILITY, NOT_STATED, Facts
from fogreduce.datasets.atomic import write_text
from fogreduce.metadata.certificate import Party
from fogreduce.physics.raw_quantity import RawUnitName

Array = NDArray[np.float64]

VERSION = "3.3.0"
_DCC, _SI = "https://ptb.de/dcc", "https://ptb.de/si"
_SCHEMA_LOCATION = "{http://www.w3.org/2001/XMLSchema-instance}schemaLocation"
_UNKNOWN_COUNTRY = "ZZ"

#: Units in D-SI form; exponents by \tothe, since \per divides by one unit only.
_DEG_H, _RADIAN, _ONE = r"\degree\hour\tothe{-1}", r"\radian", r"\one"
_RAW_PER_DEG_S: dict[RawUnitName, str] = {
    "V": r"\volt\second\degree\tothe{-1}",
    "count": r"\second\degree\tothe{-1}",
    "deg/s": _ONE,
    "deg/h": r"\second\hour\tothe{-1}",
    "rad/s": r"\radian\degree\tothe{-1}",
}
#: Parameters of the covariance, as the record names them -> unit.
_COVARIANCE_UNITS = {
    "bias_deg_h": _DEG_H,
    "scale_factor_rel": _ONE,
    "axis1_rad": _RADIAN,
    "axis2_rad": _RADIAN,
}
#: Probability of the region that a covariance is given with, and its factor for one parameter alone.
_REGION_PROBABILITY = 0.95


def write_dcc(facts: Facts, path: Path) -> None:
    """Write the certificate."""
    ET.register_namespace("dcc", _DCC)
    ET.register_namespace("si", _SI)
    ET.register_namespace("xsi", "http://www.w3.org/2001/XMLSchema-instance")
    root = dcc(facts)
    ET.indent(root, " ")
    text = ET.tostring(root, encoding="unicode")
    write_text(path, f'<?xml version="1.0" encoding="UTF-8"?>\n{text}\n')


def dcc(facts: Facts) -> ET.Element:
    """The certificate's root element."""
    root = ET.Element(f"{{{_DCC}}}digitalCalibrationCertificate", schemaVersion=VERSION)
    root.set(_SCHEMA_LOCATION, f"{_DCC} {_DCC}/v{VERSION}/dcc.xsd")
    data = _add(root, "administrativeData")
    _software(_add(data, "dccSoftware"), facts)
    _core(_add(data, "coreData"), facts)
    item = _add(_add(data, "items"), "item")
    _words(item, "name", f"unit {facts.record.unit} of {facts.record.n} gyros")
    identification = _add(_add(item, "identifications"), "identification")
    _leaf(identification, "issuer", "owner")
    _leaf(identification, "value", facts.record.unit)
    _contact(_add(_add(data, "calibrationLaboratory"), "contact"), facts.about.laboratory)
    person = _add(_add(data, "respPersons"), "respPerson")
    _words(_add(person, "person"), "name", facts.about.responsible or NOT_STATED)
    _leaf(person, "mainSigner", "true")
    _contact(_add(data, "customer"), facts.about.customer)
    _statements(_add(data, "statements"), facts)
    result = _add(_add(root, "measurementResults"), "measurementResult")
    _words(result, "name", f"coefficients of {facts.record.record_id}")
    # Inside the result, where PTB's Schematron rules look for them; the schema would have them outside, too.
    method = _add(_add(result, "usedMethods"), "usedMethod")
    _words(method, "name", "multi-position rate-table test, one weighted least-squares solution")
    _words(method, "description", facts.procedure)
    _software(_add(result, "usedSoftware"), facts)
    _equipment(result, facts)
    condition = _add(_add(result, "influenceConditions"), "influenceCondition")
    _words(condition, "name", "temperature")
    _words(_add(condition, "data"), "text", facts.temperature)
    _results(_add(result, "results"), facts)
    return root


def _add(parent: ET.Element, name: str, namespace: str = _DCC) -> ET.Element:
    return ET.SubElement(parent, f"{{{namespace}}}{name}")


def _leaf(parent: ET.Element, name: str, text: str, namespace: str = _DCC) -> None:
    _add(parent, name, namespace).text = text


def _words(parent: ET.Element, name: str, text: str) -> None:
    """A text in English."""
    content = _add(_add(parent, name), "content")
    content.set("lang", "en")
    content.text = text


def _software(parent: ET.Element, facts: Facts) -> None:
    name, _, release = facts.software.partition(" ")
    software = _add(parent, "software")
    _words(software, "name", name)
    _leaf(software, "release", f"v{release}")  # those rules want a letter before the number
    _leaf(software, "type", "application")
    pedigree = facts.record.pedigree
    if pedigree is not None:
        _words(software, "description", f"SHA-256 of its code: {pedigree.code_sha256}")


def _core(core: ET.Element, facts: Facts) -> None:
    laboratory = facts.about.laboratory
    country = laboratory.country if laboratory is not None else None
    _leaf(core, "countryCodeISO3166_1", country or _UNKNOWN_COUNTRY)
    _leaf(core, "usedLangCodeISO639_1", "en")
    _leaf(core, "mandatoryLangCodeISO639_1", "en")
    _leaf(core, "uniqueIdentifier", facts.record.record_id)
    identification = _add(_add(core, "identifications"), "identification")
    _leaf(identification, "issuer", "calibrationLaboratory")
    _leaf(identification, "value", facts.record_sha256)
    _words(identification, "name", "SHA-256 of the calibration record")
    _leaf(core, "beginPerformanceDate", f"{facts.first:%Y-%m-%d}")
    _leaf(core, "endPerformanceDate", f"{facts.last:%Y-%m-%d}")
    _leaf(core, "performanceLocation", "other" if laboratory is None else "laboratory")
    amended = _add(core, "reportAmendedSubstituted")
    _leaf(amended, "typeOfChange", "substituted")
    _leaf(amended, "replacedUniqueIdentifier", facts.present_id)
    _hash(core, "previousReport", "calibration record", facts.present_id, facts.present_sha256)


def _hash(parent: ET.Element, name: str, what: str, number: str, digest: str) -> None:
    referred = _add(parent, name)
    _words(referred, "referral", what)
    _leaf(referred, "referralID", number)
    _leaf(referred, "procedure", "SHA-256")
    _leaf(referred, "value", digest)


def _contact(contact: ET.Element, party: Party | None) -> None:
    _words(contact, "name", NOT_STATED if party is None else party.name)
    location = _add(contact, "location")
    places = (
        {} if party is None else {"city": party.city, "countryCode": party.country, "street": party.street}
    )
    for name, text in places.items():
        if text is not None:
            _leaf(location, name, text)
    if not any(places.values()):
        _words(location, "further", NOT_STATED)


def _statements(statements: ET.Element, facts: Facts) -> None:
    fit = f"Chi-square {facts.chi2:.1f} for {facts.freedom:.0f} degrees of freedom, p = {facts.p_value:.4g}."
    for name, text in (
        (
            "uncertainty",
            f"Expanded uncertainties are {COVERAGE_FACTOR:g} standard deviations. They include noise within "
            "runs, turn-on scatter between runs, and azimuth, latitude and table rate as far as they are "
            "stated uncertain; not departures of the scale factor from a straight line, nor change after the "
            "calibration.",
        ),
        ("goodness of fit", fit),
        ("validity", f"From {facts.record.valid_from:%Y-%m-%dT%H:%M:%SZ} on, once signed and named."),
    ):
        statement = _add(statements, "statement")
        _words(statement, "name", name)
        _words(statement, "declaration", text)


def _equipment(results: ET.Element, facts: Facts) -> None:
    table = facts.about.table
    equipment = _add(_add(results, "measuringEquipments"), "measuringEquipment")
    _words(equipment, "name", "rate table" if table is None else table.name)
    if table is None:
        _words(equipment, "description", f"certificate {NOT_STATED}")
        return
    _hash(equipment, "certificate", "calibration certificate", table.certificate, table.certificate_sha256)
    if table.serial_number is not None:
        identification = _add(_add(equipment, "identifications"), "identification")
        _leaf(identification, "issuer", "manufacturer")
        _leaf(identification, "value", table.serial_number)


def _results(results: ET.Element, facts: Facts) -> None:
    found, record = facts.coefficients, facts.record
    scale_unit = _RAW_PER_DEG_S[record.raw_unit.name]
    scale_std = np.abs(found.scale_factor) * found.scale_factor_std_rel
    _quantity(results, "bias", found.bias_deg_h, _DEG_H, found.bias_std_deg_h)
    _quantity(results, "scale factor", found.scale_factor, scale_unit, scale_std)
    for k, axis in enumerate("xyz"):
        # A component moves by the pointing error times the sine of the axis' angle with it.
        sine = np.sqrt(np.clip(1 - found.axes[:, k] ** 2, 0, None))
        _quantity(results, f"input axis, {axis}", found.axes[:, k], _ONE, found.axis_std_rad * sine)
    _quantity(results, "turn-on bias, one standard deviation", found.turn_on_bias_deg_h, _DEG_H)
    noise = record.stated_noise
    for name, values, unit in (
        ("angle random walk", noise.angle_random_walk_deg_sqrt_h, r"\degree\hour\tothe{-0.5}"),
        ("bias instability", noise.bias_instability_deg_h, _DEG_H),
        ("rate random walk", noise.rate_random_walk_deg_h_sqrt_h, r"\degree\hour\tothe{-1.5}"),
    ):
        _quantity(results, name, np.array(values), unit)
    if record.covariance is not None:
        _covariance(results, record.covariance.parameters, np.array(record.covariance.matrix))


def _quantity(parent: ET.Element, name: str, values: Array, unit: str, stds: Array | None = None) -> None:
    """A result of one value a gyro, with expanded uncertainties where it has standard deviations."""
    result = _add(parent, "result")
    _words(result, "name", f"{name} of each gyro")
    quantity = _add(_add(result, "data"), "quantity")
    _words(quantity, "name", name)
    numbers = _add(quantity, "realListXMLList", _SI)
    _leaf(numbers, "labelXMLList", " ".join(f"gyro{i + 1}" for i in range(len(values))), _SI)
    _leaf(numbers, "valueXMLList", _list(values), _SI)
    _leaf(numbers, "unitXMLList", unit, _SI)
    if stds is None:
        return
    univariate = _add(numbers, "measurementUncertaintyUnivariateXMLList", _SI)
    expanded = _add(univariate, "expandedMUXMLList", _SI)
    _leaf(expanded, "valueExpandedMUXMLList", _list(COVERAGE_FACTOR * stds), _SI)
    _leaf(expanded, "coverageFactorXMLList", f"{COVERAGE_FACTOR:.1f}", _SI)
    _leaf(expanded, "coverageProbabilityXMLList", f"{COVERAGE_PROBABILITY}", _SI)
    _leaf(expanded, "distributionXMLList", "normal", _SI)


def _covariance(results: ET.Element, parameters: Sequence[str], matrix: Array) -> None:
    """Covariance of all parameters, as departures from what stands above: values of 0."""
    result = _add(results, "result")
    _words(result, "name", "covariance of all coefficients")
    _words(
        result,
        "description",
        "Departures from the values above, so 0 with their covariance: bias, scale factor (relative), and "
        "pointing of the axis in two directions at right angles to it, which the record names.",
    )
    quantity = _add(_add(result, "data"), "quantity")
    _words(quantity, "name", "departures")
    units = [_COVARIANCE_UNITS[name.partition(".")[2]] for name in parameters]
    numbers = _add(quantity, "realListXMLList", _SI)
    _leaf(numbers, "labelXMLList", " ".join(parameters), _SI)
    _leaf(numbers, "valueXMLList", " ".join(["0.0"] * len(parameters)), _SI)
    _leaf(numbers, "unitXMLList", " ".join(units), _SI)
    region = _add(numbers, "ellipsoidalRegionXMLList", _SI)
    columns = _add(region, "covarianceMatrix", _SI)
    for j in range(len(parameters)):
        column = _add(columns, "column", _SI)
        for i in range(len(parameters)):
            covariance = _add(column, "covariance", _SI)
            _leaf(covariance, "value", repr(float(matrix[i, j])), _SI)
            _leaf(covariance, "unit", _product(units[i], units[j]), _SI)
    factor = float(np.sqrt(chdtri(len(parameters), 1 - _REGION_PROBABILITY)))
    _leaf(region, "coverageFactor", f"{factor:.4f}", _SI)
    _leaf(region, "coverageProbability", f"{_REGION_PROBABILITY}", _SI)
    _leaf(region, "distribution", "normal", _SI)


def _product(one: str, other: str) -> str:
    """Product of two of the covariance's units."""
    if _ONE in (one, other):
        return other if one == _ONE else one
    if one == other:
        return r"\radian\tothe{2}" if one == _RADIAN else r"\degree\tothe{2}\hour\tothe{-2}"
    return _DEG_H + _RADIAN


def _list(values: Array) -> str:
    return " ".join(repr(float(value)) for value in values)
