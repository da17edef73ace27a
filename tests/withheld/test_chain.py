"""The chain of the contract against arithmetic by hand."""

import struct

import numpy as np
import pytest
from bench import SCALE, campaign, run, unit, world

from withheld.chain.attitude import earth_deg_s, room_to_unit, rotation, seen_from_table
from withheld.chain.capture_file import encode, microseconds, read_capture, write_capture
from withheld.chain.injector import run_counts
from withheld.chain.motion import commanded
from withheld.errors import BadInput

EARTH_DEG_H = np.rad2deg(7.2921151467e-5) * 3600.0


def test_earths_rate_is_fifteen_degrees_an_hour():
    assert np.linalg.norm(earth_deg_s(37.0)) * 3600 == pytest.approx(15.0410671, abs=1e-6)
    assert earth_deg_s(90.0) * 3600 == pytest.approx([0, 0, EARTH_DEG_H], abs=1e-12)


def test_orientation_completes_a_right_handed_triad():
    u0 = room_to_unit((("x", "up"), ("z", "north")), 0.0)
    # x up, z north; y = z cross x = north cross up = east
    assert u0 == pytest.approx(np.array([[0, 0, 1], [1, 0, 0], [0, 1, 0]]))
    assert np.linalg.det(room_to_unit((("y", "west"), ("x", "south")), 33.0)) == pytest.approx(1.0)


def test_azimuth_turns_clockwise_seen_from_above():
    # an axis that pointed north points east after a quarter turn clockwise
    u0 = room_to_unit((("x", "up"), ("z", "north")), 90.0)
    assert u0[2] == pytest.approx([1, 0, 0], abs=1e-15)


def test_a_room_vector_turns_backwards_on_the_table():
    axis, vector = np.array([0.0, 0.6, 0.8]), np.array([0.3, -1.0, 2.0])
    for angle in (0.1, 2.0, -4.0):
        expected = rotation(axis, -angle) @ vector
        assert seen_from_table(vector, axis, np.array([angle]))[0] == pytest.approx(expected, abs=1e-15)


def test_rates_hold_up_to_not_including_their_end():
    one = run(profile=((2.0, 10.0), (-1.0, 5.0)))
    rate, angle = commanded(one, np.array([-1.0, 0.0, 9.999, 10.0, 14.0, 15.0, 99.0]))
    assert rate == pytest.approx([0, 2, 2, -1, -1, 0, 0])
    assert angle == pytest.approx([0, 0, 19.998, 20, 16, 15, 15])


def test_counts_of_a_standstill_by_hand():
    # x up at the equator: Earth's rate lies north, along z; y is east.
    _, counts = run_counts(world(campaign()), run())
    assert (counts[:, :2] == 0).all()
    assert (counts[:, 2] == round(EARTH_DEG_H / 3600 * SCALE / 1e-7)).all()


def test_counts_of_a_turn_by_hand():
    one = run(rate=9.0, duration=20.0, polarity=(1, -1, 1))
    of = campaign(one, bias=(1e-4, 2e-4, 0.0))
    _, counts = run_counts(world(of), one)
    # after 10 s the table has turned by 90 deg about x (up): z now points where y (east) turned from ...
    # north seen from the unit is R(x, -90 deg) z = y
    at = counts[640]
    assert at[0] == round((9.0 * SCALE + 1e-4) / 1e-7)
    assert at[1] == -round((EARTH_DEG_H / 3600 * SCALE + 2e-4) / 1e-7)
    assert at[2] == 0


def test_frame_signs_turn_what_an_axis_reads():
    one = run(frame_signs=(1, 1, -1))
    _, counts = run_counts(world(campaign(one)), one)
    assert (counts[:, 2] == -round(EARTH_DEG_H / 3600 * SCALE / 1e-7)).all()


def test_stamps_are_whole_microseconds():
    one = run(sample_rate_hz=128.0)
    stamps, _ = run_counts(world(campaign(one)), one)
    assert stamps[:4].tolist() == [0, 7812, 15625, 23438]


def test_bytes_of_a_capture(tmp_path):
    one, counts = run(), np.array([[1, -2, -2147483648], [3, 4, 5]])
    content = encode(one, unit(), np.array([0, 15625], dtype=np.uint64), counts)
    assert content[:16] == b"FOGCAP1\n" + struct.pack("<IHH", 64, 3, 24)
    assert content[16:40] == struct.pack("<ddq", 64.0, 1e-7, 1767225600000000)
    assert content[40:64] == b"T-1" + b"\0" * 21
    assert content[64:88] == struct.pack("<QIiii", 0, 0, 1, -2, -2147483648)
    assert content[88:] == struct.pack("<QIiii", 15625, 1, 3, 4, 5)
    write_capture(tmp_path / "c", one, unit(), np.array([0, 15625], dtype=np.uint64), counts)
    back = read_capture(tmp_path / "c")
    assert (back.counts == counts).all()
    assert (back.unit, back.sample_rate_hz, back.start_us) == ("T-1", 64.0, 1767225600000000)


def test_start_with_fraction_and_a_bad_one():
    assert microseconds("1970-01-01T00:00:01.5Z") == 1_500_000
    with pytest.raises(BadInput, match="expected a UTC time"):
        microseconds("yesterday")
