"""The core schema of YAML 1.2 (its section 10.3.2 gives the expressions and examples), and writing."""

import math

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from fogreduce.metadata.yaml12 import dump_yaml, load_yaml, resolve


@pytest.fixture
def read(tmp_path):
    def read(text: str) -> dict[str, object]:
        (tmp_path / "a.yaml").write_text(text, encoding="utf-8")
        return load_yaml(tmp_path / "a.yaml")

    return read


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1e-07", 1e-7),
        ("1.0e-7", 1e-7),
        ("-2E+05", -2e5),
        ("12e03", 12000.0),
        (".5", 0.5),
        ("0.", 0.0),
        ("-0.0", -0.0),
        ("+12.3", 12.3),
        ("0o17", 15),
        ("0x3A", 58),
        ("-19", -19),
        ("017", 17),  # octal in YAML 1.1
        ("true", True),
        ("FALSE", False),
        ("~", None),
        ("null", None),
        ("", None),
        # all of these are text, though YAML 1.1 reads them as something else
        ("yes", "yes"),
        ("on", "on"),
        ("No", "No"),
        ("y", "y"),
        ("13:00:00", "13:00:00"),
        ("2014-05-12", "2014-05-12"),
        ("2014-05-12T13:00:00Z", "2014-05-12T13:00:00Z"),
        ("1_000", "1_000"),
        ("0b11", "0b11"),
        ("<<", "<<"),
        ("=", "="),
        # and these are text in both
        ("1e", "1e"),
        ("tRUE", "tRUE"),
        ("0o8", "0o8"),
        (".", "."),
        ("-", "-"),
        ("1e5x", "1e5x"),
    ],
)
def test_plain_scalars(text, value):
    assert resolve(text) == value
    assert type(resolve(text)) is type(value)


def test_infinity_and_nan():
    assert resolve(".inf") == math.inf
    assert resolve("-.Inf") == -math.inf
    assert math.isnan(resolve(".NaN"))


def test_quoted_and_block_text_is_text(read):
    data = read("a: '1e-07'\nb: \"true\"\nc: |\n  5\nd: >-\n  null\n")
    assert data == {"a": "1e-07", "b": "true", "c": "5\n", "d": "null"}


def test_nesting_comments_and_byte_order_mark(read):
    data = read("\ufeff# head\na: {b: [1, {c: 2.5}]}  # tail\nd:\n  - e\n  -\n")
    assert data == {"a": {"b": [1, {"c": 2.5}]}, "d": ["e", None]}


TEXTS = st.text(st.characters(codec="utf-8", exclude_categories=["Cs"]), max_size=12) | st.sampled_from(
    [
        "yes",
        "off",
        "1e-07",
        "1e5",
        "13:00:00",
        "2014-05-12T13:00:00Z",
        "0o17",
        "017",
        "1_0",
        "~",
        "",
        "=",
        "<<",
        "a: b",
    ]
)
SCALARS = st.none() | st.booleans() | st.integers(-(10**20), 10**20) | st.floats(allow_nan=False) | TEXTS
DATA = st.dictionaries(
    TEXTS,
    st.recursive(SCALARS, lambda item: st.lists(item) | st.dictionaries(TEXTS, item), max_leaves=8),
    max_size=5,
)


@given(DATA)
def test_both_versions_read_what_is_written_alike(tmp_path_factory, data):
    text = dump_yaml(data)
    path = tmp_path_factory.mktemp("yaml") / "a.yaml"
    path.write_text(text, encoding="utf-8")
    assert load_yaml(path) == data
    assert yaml.safe_load(text) == data  # PyYAML: version 1.1
    assert list(load_yaml(path)) == list(data)  # keys in order


def test_layout():
    data = {"b": 1e-7, "a": {"y": [1, 2], "x": {"k": "v"}}}
    assert dump_yaml(data) == "b: 1.0e-07\na:\n  y: [1, 2]\n  x: {k: v}\n"
    assert dump_yaml({"b": 1, "a": "on"}) == "b: 1\na: 'on'\n"


def test_only_plain_data_is_written():
    with pytest.raises(TypeError, match="cannot write"):
        dump_yaml({"a": object()})
