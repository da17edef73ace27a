"""YAML 1.2 in and out, and only the plain part of it: mappings, lists, text, numbers, true/false, null.

PyYAML reads YAML 1.1, in which ``1e-07`` is text, ``on`` a truth value and ``13:00:00`` a number. So only its
event parser is used, and plain scalars are resolved here by the core schema of YAML 1.2. Tags, anchors and
aliases are refused: metadata need none of them, and they are how a YAML file runs code or fills the memory.
"""

from __future__ import annotations

import os
import re
import stat
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import yaml

from fogreduce.errors import BadInput
from fogreduce.metadata.words import kind_of

_Parser: type = getattr(yaml, "CSafeLoader", yaml.SafeLoader)

#: Metadata are small; anything larger is a mistake (a capture named in place of its run.yaml, say).
LARGEST_FILE_BYTES = 16 * 1024 * 1024
DEEPEST_NESTING = 32
LONGEST_INTEGER = 30

_CONSTANTS: dict[str, bool | None] = {
    **dict.fromkeys(("", "~", "null", "Null", "NULL"), None),
    **dict.fromkeys(("true", "True", "TRUE"), True),
    **dict.fromkeys(("false", "False", "FALSE"), False),
}
_DECIMAL = re.compile(r"[-+]?[0-9]+")
_OCTAL = re.compile(r"0o[0-7]+")
_HEXADECIMAL = re.compile(r"0x[0-9a-fA-F]+")
_FLOAT = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?")
_INFINITE = re.compile(r"[-+]?\.(inf|Inf|INF)")
#: Control characters and what one version or the other takes for a line's end.
_NOT_PLAIN = re.compile(r"[\x00-\x1f\x7f-\x9f\u2028\u2029\ufeff]")
_NAN = re.compile(r"\.(nan|NaN|NAN)")


def load_yaml(path: str | os.PathLike[str]) -> dict[str, object]:
    """Read one YAML 1.2 file whose top level is a mapping.

    Raises
    ------
    BadInput
        With file, line and column: not there, a folder, no permission, not UTF-8, empty, broken syntax,
        duplicate key, tag, anchor or alias, several documents, top level not a mapping.
    """
    file = os.fspath(path)
    return _Reader(file, _text_of(file)).mapping()


def resolve(text: str) -> object:
    """The value of a plain (unquoted) scalar in the core schema of YAML 1.2."""
    if text in _CONSTANTS:
        return _CONSTANTS[text]
    if _DECIMAL.fullmatch(text):
        return int(text)
    if _OCTAL.fullmatch(text):
        return int(text[2:], 8)
    if _HEXADECIMAL.fullmatch(text):
        return int(text[2:], 16)
    if _FLOAT.fullmatch(text):
        return float(text)
    if _INFINITE.fullmatch(text):
        return float("-inf" if text.startswith("-") else "inf")
    if _NAN.fullmatch(text):
        return float("nan")
    return text


def dump_yaml(data: Mapping[str, object]) -> str:
    """Text that YAML 1.1 and YAML 1.2 parsers read alike, keys in the order given.

    Innermost lists and mappings stand on one line; floats carry a point and a signed exponent (``1.0e-07``);
    text that either version would take for something else is quoted.
    """
    text: str = yaml.dump(
        _plain(data),
        Dumper=_Dumper,
        sort_keys=False,
        allow_unicode=True,
        width=10_000,
        default_flow_style=None,
    )
    return text


def _text_of(file: str) -> str:
    """The file's text, or BadInput."""
    try:
        status = Path(file).stat()
        if not stat.S_ISREG(status.st_mode):
            found = "a folder" if stat.S_ISDIR(status.st_mode) else "something that is not a plain file"
            raise BadInput.at(file, "", found=found, expected="a YAML file")
        if status.st_size > LARGEST_FILE_BYTES:
            raise BadInput.at(
                file,
                "",
                found=f"{status.st_size} bytes",
                expected=f"a YAML file of at most {LARGEST_FILE_BYTES}",
            )
        raw = Path(file).read_bytes()
    except FileNotFoundError:
        raise BadInput.at(file, "", found="no such file", expected="a YAML file") from None
    except PermissionError:
        raise BadInput.at(file, "", found="no permission to read it", expected="a readable file") from None
    except (OSError, ValueError) as error:  # ValueError: a NUL in the path
        raise BadInput.at(file, "", found=f"unreadable file ({error})", expected="a YAML file") from None
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = raw.count(b"\n", 0, error.start) + 1
        found = f"byte 0x{raw[error.start]:02x}, not UTF-8"
        raise BadInput.at(file, f"line {line}", found=found, expected="UTF-8 text") from None


def _in_words(problem: str) -> str:
    """What the parser says of broken syntax, as it stands after the word "found"."""
    problem = re.sub(r"^(did|could) not find expected ", "no ", problem)
    problem = re.sub(r"^found (character )?", lambda said: "a character " if said[1] else "", problem)
    problem = re.sub(r" (is|are) not allowed", r" that \1 not allowed", problem)
    return re.sub(r"^expected (.+), but found (.+)$", r"\2 in place of \1", problem)


class _Reader:
    """Builds plain values from the parser's events; one use."""

    def __init__(self, file: str, text: str) -> None:
        self.file = file
        self.events: Iterator[Any] = yaml.parse(text, Loader=_Parser)

    def mapping(self) -> dict[str, object]:
        """The document's top level."""
        try:
            next(self.events)  # the stream's start
            event = next(self.events)
            if isinstance(event, yaml.StreamEndEvent):
                raise BadInput.at(
                    self.file, "", found="an empty file", expected="a mapping of keys to values"
                )
            first = next(self.events)
            value = self._value(first, depth=0)
            next(self.events)  # the document's end
            event = next(self.events)
        except yaml.MarkedYAMLError as error:
            mark = error.problem_mark or error.context_mark
            problem = error.problem or error.context or "broken syntax"
            raise self._fault(mark, _in_words(problem), "YAML 1.2") from None
        except yaml.YAMLError as error:
            reason = getattr(error, "reason", None) or str(error)
            raise BadInput.at(self.file, "", found=reason, expected="YAML 1.2") from None
        if not isinstance(event, yaml.StreamEndEvent):
            raise self._fault(event.start_mark, "a second document", "one document a file")
        if not isinstance(value, dict):
            found = "an empty document" if value is None else kind_of(value)
            raise self._fault(first.start_mark, found, "a mapping of keys to values")
        return value

    def _fault(self, mark: Any, found: str, expected: str) -> BadInput:
        where = f"line {mark.line + 1}, column {mark.column + 1}" if mark else ""
        return BadInput.at(self.file, where, found=found, expected=expected)

    def _value(self, event: Any, depth: int) -> object:
        if isinstance(event, yaml.AliasEvent):
            raise self._fault(event.start_mark, f"the alias *{event.anchor}", "the value itself, written out")
        if event.anchor is not None:
            raise self._fault(event.start_mark, f"the anchor &{event.anchor}", "a value without an anchor")
        if event.tag is not None:
            raise self._fault(event.start_mark, f"the tag {event.tag}", "a value without a tag")
        if depth > DEEPEST_NESTING:
            raise self._fault(event.start_mark, f"nesting deeper than {DEEPEST_NESTING}", "a few levels")
        if isinstance(event, yaml.ScalarEvent):
            return self._scalar(event)
        if isinstance(event, yaml.SequenceStartEvent):
            items: list[object] = []
            while not isinstance(item := next(self.events), yaml.SequenceEndEvent):
                items.append(self._value(item, depth + 1))
            return items
        pairs: dict[str, object] = {}
        while not isinstance(start := next(self.events), yaml.MappingEndEvent):
            key = self._value(start, depth + 1)
            if not isinstance(key, str):
                raise self._fault(start.start_mark, f"{kind_of(key)} as a key", "text as a key")
            if key in pairs:
                raise self._fault(start.start_mark, f"the key {key} a second time", "each key once")
            pairs[key] = self._value(next(self.events), depth + 1)
        return pairs

    def _scalar(self, event: Any) -> object:
        text: str = event.value
        if not event.implicit[0]:  # quoted, or a block of text
            return text
        if len(text) > LONGEST_INTEGER and re.fullmatch(r"[-+]?[0-9]+|0[ox][0-9a-fA-F]+", text):
            raise self._fault(event.start_mark, f"a whole number of {len(text)} digits", "a number in use")
        return resolve(text)


def _plain(value: object) -> object:
    """`value` in the types that the dumper knows; subclasses of float, int, str become just that."""
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    if isinstance(value, bool) or value is None:
        return value
    for kind in (int, float, str):
        if isinstance(value, kind):
            return kind(value)
    raise TypeError(f"cannot write {value!r} as YAML")


class _Dumper(yaml.SafeDumper):
    """Quotes what either version of YAML would not read as text; writes no aliases."""

    def ignore_aliases(self, data: object) -> bool:
        return True

    def serialize(self, node: Any) -> None:
        node.flow_style = False  # the top level always has a line a key
        super().serialize(node)


def _represent_text(dumper: yaml.SafeDumper, text: str) -> yaml.ScalarNode:
    style = None if isinstance(resolve(text), str) else "'"
    if _NOT_PLAIN.search(text):
        style = '"'  # with escapes, on one line
    return dumper.represent_scalar("tag:yaml.org,2002:str", text, style=style)


_Dumper.add_representer(str, _represent_text)
