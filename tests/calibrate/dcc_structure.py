"""The structure of a DCC 3.3.0, as PTB's schema (dcc.xsd 3.3.0, SI_Format.xsd 2.2) prescribes it.

The schema is published under the LGPL 3 and is not part of this repository. What stands here is what it says
of the elements that we write: their children in order, and the form of their text. An element that is not
listed is a fault.
"""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET

_PREFIX = {"https://ptb.de/dcc": "dcc", "https://ptb.de/si": "si"}

_TEXT = "dcc:content+"
_RICH = "dcc:name? (dcc:content|dcc:file|dcc:formula)*"
_HASH = (
    "dcc:referral dcc:referralID dcc:procedure dcc:value dcc:description? dcc:inValidityRange? "
    "dcc:traceable? dcc:linkedReport?"
)
_CONTACT = "dcc:name dcc:eMail? dcc:phone? dcc:fax? dcc:link? dcc:location dcc:descriptionData?"
_IDENTIFICATIONS = "dcc:identification+"
_RESULT_HEAD = "dcc:usedMethods? dcc:usedSoftware? dcc:measuringEquipments? dcc:influenceConditions?"

#: Element -> its children in order, as a regular expression of names.
CHILDREN = {
    "dcc:digitalCalibrationCertificate": "dcc:administrativeData dcc:measurementResults "
    "dcc:comment? dcc:document?",
    # xs:all: any order, each once; ours is the schema's own.
    "dcc:administrativeData": "dcc:dccSoftware dcc:refTypeDefinitions? dcc:coreData dcc:items "
    "dcc:calibrationLaboratory dcc:respPersons dcc:customer dcc:statements?",
    "dcc:dccSoftware": "dcc:software+",
    "dcc:usedSoftware": "dcc:software+",
    "dcc:software": "dcc:name dcc:release dcc:type? dcc:description?",
    "dcc:coreData": "dcc:countryCodeISO3166_1 dcc:usedLangCodeISO639_1+ dcc:mandatoryLangCodeISO639_1+ "
    "dcc:uniqueIdentifier dcc:identifications? dcc:receiptDate? dcc:beginPerformanceDate "
    "dcc:endPerformanceDate dcc:performanceLocation dcc:issueDate? dcc:reportAmendedSubstituted? "
    "dcc:previousReport?",
    "dcc:reportAmendedSubstituted": "dcc:typeOfChange dcc:replacedUniqueIdentifier",
    "dcc:previousReport": _HASH,
    "dcc:certificate": _HASH,
    "dcc:identifications": _IDENTIFICATIONS,
    "dcc:identification": "dcc:issuer dcc:value dcc:name?",
    "dcc:items": "dcc:name? dcc:equipmentClass* dcc:description? dcc:owner? dcc:manufacturer? "
    "dcc:identifications? dcc:item+",
    "dcc:item": "dcc:name dcc:equipmentClass* dcc:description? dcc:owner? dcc:installedSoftwares? "
    "dcc:manufacturer? dcc:model? dcc:identifications dcc:itemQuantities? dcc:subItems?",
    "dcc:calibrationLaboratory": "dcc:calibrationLaboratoryCode? dcc:contact dcc:cryptElectronicSeal? "
    "dcc:cryptElectronicSignature? dcc:cryptElectronicTimeStamp?",
    "dcc:contact": _CONTACT,
    "dcc:customer": _CONTACT,
    "dcc:person": _CONTACT.replace("dcc:location", "dcc:location?"),
    "dcc:location": "(dcc:city|dcc:countryCode|dcc:postCode|dcc:postOfficeBox|dcc:state|dcc:street"
    "|dcc:streetNo|dcc:further|dcc:positionCoordinates)+",
    "dcc:respPersons": "dcc:respPerson+",
    "dcc:respPerson": "dcc:person dcc:description? dcc:role? dcc:mainSigner? dcc:cryptElectronicSeal? "
    "dcc:cryptElectronicSignature? dcc:cryptElectronicTimeStamp?",
    "dcc:statements": "dcc:statement+",
    "dcc:statement": "dcc:name? dcc:description? dcc:countryCodeISO3166_1* dcc:convention? dcc:traceable? "
    "dcc:norm* dcc:reference* dcc:link* dcc:declaration? (dcc:valid|dcc:validXMLList)? dcc:date? dcc:period? "
    "dcc:respAuthority? (dcc:conformity|dcc:conformityXMLList)? dcc:data? dcc:nonSIDefinition? "
    "dcc:nonSIUnit? dcc:location?",
    "dcc:measurementResults": _RESULT_HEAD + " dcc:measurementMetaData? dcc:measurementResult+",
    "dcc:measurementResult": f"dcc:name dcc:description? {_RESULT_HEAD} dcc:results dcc:measurementMetaData?",
    "dcc:usedMethods": "dcc:usedMethod+",
    "dcc:usedMethod": "dcc:name dcc:description? dcc:norm* dcc:reference* dcc:link* "
    "dcc:usedMethodQuantities?",
    "dcc:measuringEquipments": "dcc:name? dcc:equipmentClass* dcc:description? dcc:owner? "
    "dcc:identifications? dcc:measuringEquipment+",
    "dcc:measuringEquipment": "dcc:name dcc:equipmentClass* dcc:description? dcc:certificate? "
    "dcc:manufacturer? dcc:model? dcc:identifications? dcc:measuringEquipmentQuantities? "
    "dcc:installedSoftware?",
    "dcc:influenceConditions": "dcc:influenceCondition+",
    "dcc:influenceCondition": "dcc:name dcc:description? dcc:status? dcc:certificate? dcc:data",
    "dcc:results": "dcc:result+",
    "dcc:result": "dcc:name dcc:description? dcc:data",
    "dcc:data": "(dcc:text|dcc:formula|dcc:byteData|dcc:xml|dcc:quantity|dcc:list)+",
    "dcc:quantity": "dcc:name? dcc:description? (dcc:noQuantity|dcc:charsXMLList|si:real|si:list|si:hybrid"
    "|si:complex|si:constant|si:realListXMLList|si:complexListXMLList) dcc:relativeUncertainty? "
    + _RESULT_HEAD
    + " dcc:measurementMetaData?",
    **dict.fromkeys(("dcc:name", "dcc:referral"), _TEXT),
    **dict.fromkeys(("dcc:description", "dcc:declaration", "dcc:further", "dcc:text"), _RICH),
    "si:realListXMLList": "si:labelXMLList? si:quantityTypeXMLList? si:valueXMLList si:unitXMLList "
    "si:significantDigitXMLList? si:dateTimeXMLList? "
    "(si:measurementUncertaintyUnivariateXMLList|si:expandedUncXMLList|si:coverageIntervalXMLList)? "
    "(si:measurementUncertaintyMultivariateXMLList|si:ellipsoidalRegionXMLList|si:rectangularRegionXMLList)?",
    "si:measurementUncertaintyUnivariateXMLList": "(si:standardMUXMLList|si:expandedMUXMLList"
    "|si:coverageIntervalMUXMLList)",
    "si:expandedMUXMLList": "si:valueExpandedMUXMLList si:coverageFactorXMLList "
    "si:coverageProbabilityXMLList si:distributionXMLList?",
    "si:ellipsoidalRegionXMLList": "si:covarianceMatrix si:coverageFactor si:coverageProbability "
    "si:distribution?",
    "si:covarianceMatrix": "si:column+",
    "si:column": "si:covariance+",
    "si:covariance": "si:value si:unit",
}

_NOT_EMPTY = r"[^\s]+(\s+[^\s]+)*"
_DECIMAL = r"[-+]?((\d*\.\d+)|(\d+\.\d*)|(\d+\.?))([Ee][-+]?\d+)?"
_NOT_NEGATIVE = _DECIMAL.replace("[-+]?", r"\+?", 1)
_FACTOR = r"\+?(([1-9]\d*\.\d*)|([1-9]\d*))"
#: PTB's Schematron rules for DCCs, which ask more than the schema: the release of software.
_RELEASE = r"[a-zA-Z] ?(\d{1,3}\.){0,3}\d{1,3}"
_PROBABILITY = r"\+?((0(\.\d*)?)|(1(\.0*)?))"
_DATE = r"\d{4}-\d{2}-\d{2}"
#: D-SI: names of units, each with an exponent where it is not 1.
_UNIT = r"(\\(volt|degree|hour|second|radian|one)(\\tothe\{-?\d+(\.\d+)?\})?)+"


def _list(pattern: str) -> str:
    return rf"({pattern})( ({pattern}))*"


#: Element without children -> the form of its text.
TEXT = {
    "dcc:content": r"[\s\S]*",
    "dcc:countryCodeISO3166_1": "[A-Z]{2}",
    "dcc:countryCode": "[A-Z]{2}",
    "dcc:usedLangCodeISO639_1": "[a-z]{2}",
    "dcc:mandatoryLangCodeISO639_1": "[a-z]{2}",
    "dcc:beginPerformanceDate": _DATE,
    "dcc:endPerformanceDate": _DATE,
    "dcc:performanceLocation": "laboratory|customer|laboratoryBranch|customerBranch|other",
    "dcc:release": _RELEASE,
    "dcc:typeOfChange": "amended|substituted",
    "dcc:type": "application|bios|driver|editor|firmware|library|os|other",
    "dcc:issuer": "manufacturer|calibrationLaboratory|customer|owner|other",
    "dcc:mainSigner": "true|false|0|1",
    **dict.fromkeys(("dcc:uniqueIdentifier", "dcc:replacedUniqueIdentifier", "dcc:referralID"), _NOT_EMPTY),
    **dict.fromkeys(("dcc:procedure", "dcc:value", "dcc:city", "dcc:street"), _NOT_EMPTY),
    "si:labelXMLList": _list(r"\S+"),
    "si:valueXMLList": _list(_DECIMAL),
    "si:unitXMLList": _list(_UNIT),
    "si:valueExpandedMUXMLList": _list(_NOT_NEGATIVE),
    "si:coverageFactorXMLList": _list(_FACTOR),
    "si:coverageProbabilityXMLList": _list(_PROBABILITY),
    "si:distributionXMLList": _list(r"\S+"),
    "si:coverageFactor": _FACTOR,
    "si:coverageProbability": _PROBABILITY,
    "si:distribution": r"[\s\S]*",
    "si:value": _DECIMAL,
    "si:unit": _UNIT,
}
ATTRIBUTES = {
    "dcc:digitalCalibrationCertificate": {"schemaVersion": r"3\.3\.0"},
    "dcc:content": {"lang": "[a-z]{2}"},
}


#: What PTB's Schematron rules for DCCs want in a measurementResult with quantities; the schema does not.
WANTED = ("dcc:usedMethods", "dcc:usedSoftware", "dcc:influenceConditions")


def faults(root: ET.Element) -> list[str]:
    """Where a document departs from the structure."""
    if _name(root) != "dcc:digitalCalibrationCertificate":
        return [f"root {_name(root)}"]
    found = [fault for element in root.iter() for fault in _faults(element)]
    for result in (element for element in root.iter() if _name(element) == "dcc:measurementResult"):
        found += [f"dcc:measurementResult: no {name}" for name in WANTED if name not in map(_name, result)]
    return found


def _faults(element: ET.Element) -> list[str]:
    name, found = _name(element), []
    children = "".join(f"{_name(child)} " for child in element)
    if name in CHILDREN:
        # A name with the space after it is one thing; spaces between names mean nothing.
        pattern = re.sub(r"\w+:\w+", r"(?:\g<0>_)", CHILDREN[name]).replace(" ", "").replace("_)", " )")
        if not re.fullmatch(pattern, children):
            found.append(f"{name}: children {children}")
    elif name not in TEXT:
        found.append(f"{name}: no such element")
    elif children or not re.fullmatch(TEXT[name], element.text or ""):
        found.append(f"{name}: {children or element.text!r}")
    known = ATTRIBUTES.get(name, {})
    for key, value in element.attrib.items():
        if not key.endswith("}schemaLocation") and not re.fullmatch(known.get(key, "(?!)"), value):
            found.append(f"{name}: attribute {key}={value}")
    return found + [
        f"{name}: no {key}" for key in known if key == "schemaVersion" and key not in element.attrib
    ]


def _name(element: ET.Element) -> str:
    namespace, _, name = element.tag.removeprefix("{").partition("}")
    return f"{_PREFIX.get(namespace, '?')}:{name}"
