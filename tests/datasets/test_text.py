"""What is a number in a laboratory's text: not all that Python's `float` takes for one."""

import pytest

from fogreduce.datasets.readers.text import number_in


@pytest.mark.parametrize(
    ("text", "value"),
    [
        *(("1", 1.0), ("-0.5", -0.5), ("+3.", 3.0), (".25", 0.25), ("1e3", 1000.0), ("-2.5E-03", -0.0025)),
        *((" 7 ", 7.0), ("\t7", 7.0), ("007", 7.0), ("1e-999", 0.0)),
    ],
)
def test_numbers(text, value):
    assert number_in(text) == value


@pytest.mark.parametrize(
    "text",
    [
        *(
            "",
            " ",
            ".",
            "-",
            "e5",
            "1e",
            "1e+",
            "1 2",
            "1,5",
            "1.2.3",
            "--1",
            "1_0",
            "1e1_0",
            "0x10",
            "1d5",
            "1f",
        ),
        *(
            "nan",
            "NaN",
            "inf",
            "-inf",
            "Infinity",
            "1e999",
            "٣",
            "１",
            "²",
            "1٣",
            "½",
            "1\u00a0",
            "1\n2",
            "True",
        ),
    ],
)
def test_what_is_none(text):
    assert number_in(text) is None


def test_a_decimal_comma():
    assert number_in("-1,25e3", decimal=",") == -1250.0
    assert number_in("12", decimal=",") == 12.0
    assert number_in("1.25", decimal=",") is None
    assert number_in("1.000,5", decimal=",") is None
    assert number_in("1,000,5", decimal=",") is None
