"""Numbers on pages."""

from __future__ import annotations

import pytest

from fogreduce.pages.numbers import apart, minus_signs, number, plus_minus, rounding, signed


@pytest.mark.parametrize(
    ("values", "texts"),
    [
        ([0.0, 0.1, 0.2], ["0", "0.1", "0.2"]),
        ([9.12296, 9.12304, 9.12312], ["9.12296", "9.12304", "9.12312"]),
        ([-20.0791, -20.079], ["\u221220.0791", "\u221220.079"]),
        ([5.0, 5.0], ["5", "5"]),
        ([], []),
    ],
)
def test_ticks_are_told_apart(values, texts):
    assert apart(values) == texts


def test_noughts_at_the_end_stand_where_digits_are_counted():
    found = [number(value, 2, noughts=True) for value in (0.004, 0.0043, 12.0, -0.3)]
    assert found == ["0.0040", "0.0043", "12", "−0.30"]


def test_rounding_is_no_number():
    """What 10 deg/s leave in deg/h where they are subtracted from themselves."""
    commanded = 36_000.0
    assert [number(rounding(value, commanded)) for value in (3e-17, -7e-12, 0.0)] == ["0", "0", "0"]
    assert rounding(1e-9, commanded) == 1e-9
    assert rounding(None, commanded) is None


def test_negative_numbers_in_words_have_a_minus_sign_and_names_keep_their_hyphens():
    said = "x-one-turn 2014-05-12: rows from -0.5 to 3e-5 s (-10 deg/s)"
    assert minus_signs(said) == "x-one-turn 2014-05-12: rows from \u22120.5 to 3e-5 s (\u221210 deg/s)"


def test_what_is_above_nought_has_a_plus_where_a_sign_is_asked_for():
    texts = [plus_minus(value, 0.5) for value in (1.2, -1.2, 0.0)] + [
        "(\u22120.6 \u00b1 1.1) \u00b7 10\u207b\u2075"
    ]
    assert [signed(text)[:2] for text in texts] == ["+1", "\u22121", "0.", "(\u2212"]


def test_a_value_and_its_error_end_at_the_same_digit():
    assert plus_minus(-0.0161, 0.0281) == "\u22120.016 \u00b1 0.028"
    assert plus_minus(0.0, 0.5) == "0.00 \u00b1 0.50"
    assert plus_minus(-6e-6, 1.1e-5) == "(\u22120.6 \u00b1 1.1) \u00b7 10\u207b\u2075"


@pytest.mark.parametrize(
    ("value", "error", "text"),
    [
        (-0.26581, 0.01595, "\u22120.266 \u00b1 0.016"),
        (-152168.0, 5319.0, "\u2212152200 \u00b1 5300"),
        (40.12, 1.04, "40.1 \u00b1 1.0"),
        (5, 0.0, "5"),
        (3.25, None, "3.25"),
    ],
)
def test_numbers_to_what_their_errors_allow(value, error, text):
    assert plus_minus(value, error) == text
    assert plus_minus(value, error, "ppm") == f"{text} ppm"
