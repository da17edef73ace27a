"""Plausible mistakes on a good run: each is an error or a warning that names it, by check or by reduce.

The run: 80 s at 64 Hz, standing, at 10, -24 and 4 deg/s about the vertical, standing again, of a unit whose
record states 20 ppm, 20 urad and 0.05 deg/h; its true values are drawn from these.

What no examination of one run can find, because another truth would give the same files:

- a start that is hours off within the record's validity (nothing in a csv-1 capture says when it was made);
- a temperature log of another run of the same length (any temperature is possible);
- a latitude, azimuth, rate or scale factor that is off by less than its stated uncertainty lets expect.

The smallest that were found on these runs: latitude 1 to 2 deg, azimuth 1 to 2 deg, a step's duration 0.02 to
0.05 s; a rate of 24 deg/s 100 ppm off was with four gyros and was not with three.
"""

import pytest
from mistakes_of_files import MISTAKES, QUICK
from named import assert_named, in_turn


@pytest.mark.parametrize("name", in_turn(MISTAKES, QUICK))
def test_a_mistake_is_named(good, tmp_path, name):
    assert_named(good, *MISTAKES[name], tmp_path)


def test_of_the_good_run_nothing_is_said(good, tmp_path):
    assert good.with_mistake(lambda m: None, tmp_path) == (0, "")
