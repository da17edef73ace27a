"""How a good file is spoilt: strategies of bytes, of text, and of the values of a YAML file."""

from __future__ import annotations

import copy
import json
import re
import struct
from collections.abc import Callable
from typing import Any

from hypothesis import strategies as st

Edit = Callable[[bytes], bytes]

_PLACE = st.integers(0, 2**20 - 1)
_NUMBERS = [
    *(struct.pack("<d", x) for x in (float("nan"), float("inf"), -1.0, 0.0, 1e308, 5e-324, -float("inf"))),
    *(struct.pack("<q", x) for x in (0, -1, 2**63 - 1, -(2**63), 2**32, 10**15)),
    *(struct.pack("<i", x) for x in (0, -1, 2**31 - 1, -(2**31), 64, 1)),
    *(struct.pack("<h", x) for x in (0, -1, 2**15 - 1, -(2**15), 1)),
    b"\x00",
    b"\xff",
    b"\x80",
]

#: Pieces of text that readers of numbers, CSV and YAML are known to stumble over.
TOKENS = [
    *("nan", "NaN", ".nan", "inf", "-inf", ".inf", "Infinity", "1e999", "-1e999", "1e-400", "0", "-0", "-1"),
    *("1e400", "1_000", "0x10", "0o17", "1e", "+", "-", ".", "1.", ".5", "--1", "1,5", "1 2", "\u0661"),
    *("\uff11", "90.0001", "-90.0001"),
    *("9" * 25, "9" * 400, "1" + "0" * 18, "true", "null", "~", "", "yes", "2014-05-12", "13:00:00"),
    *("!!python/object/apply:os.system [id]", "!!float 1", "&a x", "*a", "<<: *a", "---\n", "...\n"),
    *("%YAML 1.1\n", "? a\n"),
    *("{", "}", "[", "]", ": ", "- ", "? ", "#", "|\n", ">\n", "'", '"', "\t", "\n", "\r\n", "\r", ","),
    *(",,", ";"),
    *("\x00", "\ufeff", "\u2028", "\x85", "\x1b[2J", "\ud7ff", "\U0001f600", "../x"),
    *("/etc/passwd", "a/b", "..", "x" * 300),
]  # fmt: skip
_WORD = re.compile(rb"[A-Za-z_]+|[-+0-9.eE]+|[^\sA-Za-z0-9]")


def _at(place: int, data: bytes) -> int:
    return place % (len(data) + 1)


def _put(place: int, piece: bytes) -> Edit:
    def edit(data: bytes) -> bytes:
        at = _at(place, data)
        return data[:at] + piece + data[at + len(piece) :]

    return edit


def _insert(place: int, piece: bytes) -> Edit:
    def edit(data: bytes) -> bytes:
        at = _at(place, data)
        return data[:at] + piece + data[at:]

    return edit


def _flip(place: int, bit: int) -> Edit:
    def edit(data: bytes) -> bytes:
        if not data:
            return data
        at = place % len(data)
        return data[:at] + bytes([data[at] ^ (1 << bit)]) + data[at + 1 :]

    return edit


def _cut(place: int, length: int) -> Edit:
    def edit(data: bytes) -> bytes:
        at = _at(place, data)
        return data[:at] + data[at + length :]

    return edit


def _repeat(place: int, length: int, times: int) -> Edit:
    def edit(data: bytes) -> bytes:
        at = _at(place, data)
        return data[:at] + data[at : at + length] * times + data[at:]

    return edit


def _truncate(place: int) -> Edit:
    return lambda data: data[: _at(place, data)]


def _word(place: int, token: str) -> Edit:
    def edit(data: bytes) -> bytes:
        words = list(_WORD.finditer(data))
        if not words:
            return token.encode()
        found = words[place % len(words)]
        return data[: found.start()] + token.encode() + data[found.end() :]

    return edit


_LENGTH = st.sampled_from([1, 2, 3, 4, 8, 28, 64, 500, 4096])
_HEAD = st.one_of(st.integers(0, 127), _PLACE)  # half of all places in the head, where the structure lies
BYTE_EDITS = st.one_of(
    st.builds(_flip, _HEAD, st.integers(0, 7)),
    st.builds(_put, _HEAD, st.sampled_from(_NUMBERS)),
    st.builds(_put, _HEAD, st.binary(min_size=1, max_size=16)),
    st.builds(_insert, _HEAD, st.binary(min_size=1, max_size=40)),
    st.builds(_cut, _HEAD, _LENGTH),
    st.builds(_repeat, _HEAD, _LENGTH, st.integers(1, 3)),
    st.builds(_truncate, _HEAD),
)
TEXT_EDITS = st.one_of(
    st.builds(_word, _PLACE, st.sampled_from(TOKENS)),
    st.builds(_insert, _PLACE, st.sampled_from([token.encode() for token in TOKENS])),
    BYTE_EDITS,
)
#: Often one: two faults hide each other.
_HOW_MANY = st.sampled_from([1, 1, 1, 2, 4])


@st.composite
def edited(draw: st.DrawFn, base: bytes, edits: st.SearchStrategy[Edit]) -> bytes:
    """`base` after one to four edits."""
    data = base
    for _ in range(draw(_HOW_MANY)):
        data = draw(edits)(data)
    return data


#: Values that a key may not have, or only just; `Plain` is written as it stands.
class Plain(str):
    """A plain scalar of YAML."""


_ODD_VALUES: list[Any] = [
    *map(Plain, (".nan", ".inf", "-.inf", "0", "-0.0", "-1", "1e308", "1e-320", "1e999", "90.0001", "10001")),
    *map(Plain, ("true", "null", "1", "1.0", "1.5", "9" * 29, "2014-05-12T13:00:00")),
    *map(Plain, ("0001-01-01T00:00:00+14:00", "y", "north")),
    *map(Plain, ("9999-12-31T23:59:59-14:00", "2014-02-30T00:00:00Z", "2014-05-12T13:00:00.1234567Z")),
    *("", " ", "x", "nan", "1", "../x", "a/b", ".", "..", "x" * 70, "gyro1", "gyro9", "table"),
    *("*", "\u0661", "a\nb"),
    *([], {}, [[]], [1], [Plain(".nan")] * 4, [1, 1, 1, 1, 1], [0.0, 0.0, 0.0], {"x": 1}, [[1, 0, 0, 0]] * 3),
]  # fmt: skip


def _paths(value: Any, path: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    found = [path] if path else []
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, item in items:
        found += _paths(item, (*path, key))
    return found


@st.composite
def revalued(draw: st.DrawFn, base: dict[str, Any]) -> bytes:
    """`base` with one to three values replaced, keys taken out, renamed or added, as YAML."""
    data = copy.deepcopy(base)
    for _ in range(draw(_HOW_MANY)):
        paths = _paths(data)
        if not paths:
            break
        *parents, key = draw(st.sampled_from(paths))
        place: Any = data
        for parent in parents:
            place = place[parent]
        what = draw(st.sampled_from(["value", "value", "value", "drop", "add", "rename", "repeat"]))
        odd = copy.deepcopy(draw(st.sampled_from(_ODD_VALUES)))
        if what == "value":
            old = place[key]
            near = isinstance(old, float) and draw(st.booleans())
            place[key] = old * draw(st.floats(-2.0, 2.0)) if near else odd
        elif what == "drop":
            del place[key]
        elif isinstance(place, list):
            place.insert(key, copy.deepcopy(place[key]) if what == "repeat" else odd)
        elif what == "rename":
            place[key + "_"] = place.pop(key)
        else:
            place[draw(st.sampled_from(["latitude", "H2", "Schema", "x", "parameters", "", "\u00e9"]))] = odd
    return flow(data).encode() + b"\n"


def flow(value: Any) -> str:
    """Plain data as one flow mapping of YAML."""
    if isinstance(value, Plain):
        return str(value)
    if isinstance(value, dict):
        return "{" + ", ".join(f"{json.dumps(key)}: {flow(item)}" for key, item in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(flow, value)) + "]"
    return json.dumps(value)
