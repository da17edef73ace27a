"""Mistakes in the files of a good run: run.yaml, record, capture and logs."""

import numpy as np

#: Mistakes, each with a pattern of which something must stand in what is said.
MISTAKES = {}


def mistake(pattern):
    """Take a mistake into the table."""

    def take(function):
        MISTAKES[function.__name__] = (function, pattern)
        return function

    return take


# run.yaml: the table


@mistake(r"other way|sign")
def rates_of_the_other_sign(m):
    for step in m.steps:
        step["rate_deg_s"] *= -1


@mistake(r"segment 3\b.*(commanded|sign)")
def one_rate_of_the_other_sign(m):
    m.steps[2]["rate_deg_s"] *= -1


@mistake(r"factor of 60")
def rates_in_degrees_a_minute(m):
    for step in m.steps:
        step["rate_deg_s"] *= 60


@mistake(r"factor of 57\.29")
def rates_in_radians_a_second(m):
    for step in m.steps:
        step["rate_deg_s"] = float(np.radians(step["rate_deg_s"]))


@mistake(r"segment 2\b.*commanded")
def a_rate_off_by_one_percent(m):
    m.steps[1]["rate_deg_s"] *= 1.01


@mistake(r"segment 3\b.*commanded")
def a_rate_off_by_a_thousandth(m):
    m.steps[2]["rate_deg_s"] *= 1.001


@mistake(r"segment 4\b.*commanded")
def a_rate_with_its_digits_transposed(m):
    m.steps[3]["rate_deg_s"] = 4.09


@mistake(r"axis")
def another_axis(m):
    m.run["table"]["axis"] = "x"


@mistake(r"other way|sign|axis")
def an_axis_of_the_other_sense(m):
    m.run["table"]["axis"] = [0.0, 0.0, -1.0]


@mistake(r"axis|commanded|sine")
def an_axis_that_is_tilted_by_half_a_degree(m):
    m.run["table"]["axis"] = [0.0, float(np.sin(np.radians(0.5))), float(np.cos(np.radians(0.5)))]


@mistake(r"profile|shorter|longer|duration|stops|ends")
def a_step_that_is_too_long(m):
    m.steps[1]["duration_s"] += 10


@mistake(r"profile|shorter|longer|duration|beyond|after")
def a_step_that_is_too_short(m):
    m.steps[1]["duration_s"] -= 8


@mistake(r"profile|commanded")
def durations_of_two_steps_exchanged(m):
    m.steps[1]["duration_s"], m.steps[2]["duration_s"] = 22.0, 20.0


@mistake(r"profile|shorter|longer|duration")
def durations_in_minutes(m):
    for step in m.steps:
        step["duration_s"] /= 60


@mistake(r"profile|commanded")
def steps_in_another_order(m):
    m.steps[1], m.steps[2] = m.steps[2], m.steps[1]


@mistake(r"profile|shorter|longer|beyond|after")
def a_step_left_out(m):
    del m.steps[3]


# run.yaml: the capture


@mistake(r"sample_rate_hz|rate")
def a_sample_rate_that_is_doubled(m):
    m.run["capture"]["sample_rate_hz"] = 128.0


@mistake(r"sample_rate_hz|rate")
def a_sample_rate_off_by_one_percent(m):
    m.run["capture"]["sample_rate_hz"] = 64.64


@mistake(r"raw_unit")
def volts_taken_for_degrees_a_second(m):
    del m.run["capture"]["volts_per_count"]
    m.run["capture"] |= {"raw_unit": "deg/s", "least_count": 1e-7}


@mistake(r"gyro2.*(sign|polarity)|polarity")
def a_polarity_left_out(m):
    m.run["capture"]["polarity"] = [1, 1, 1, 1]


@mistake(r"polarity|sign|other way")
def every_polarity_turned(m):
    m.run["capture"]["polarity"] = [-1, 1, -1, -1]


# run.yaml: the site and the unit's attitude


@mistake(r"latitude")
def a_latitude_without_its_sign(m):
    m.run["site"]["latitude_deg"] = 23.2113


@mistake(r"latitude|commanded|sine")
def a_latitude_with_its_digits_transposed(m):
    m.run["site"]["latitude_deg"] = -32.2113


@mistake(r"latitude|commanded|sine")
def a_latitude_off_by_two_degrees(m):
    m.run["site"]["latitude_deg"] = -21.2113


@mistake(r"azimuth|orientation")
def an_azimuth_off_by_90_degrees(m):
    m.run["azimuth_deg"] += 90


@mistake(r"azimuth|orientation")
def an_azimuth_of_the_other_sense(m):
    m.run["azimuth_deg"] *= -1


@mistake(r"azimuth|orientation")
def an_azimuth_left_out(m):
    del m.run["azimuth_deg"]


@mistake(r"azimuth|orientation|commanded|sine")
def an_azimuth_off_by_three_degrees(m):
    m.run["azimuth_deg"] += 3


@mistake(r"orientation|azimuth")
def north_taken_for_south(m):
    m.run["orientation"] = {"z": "up", "x": "south"}


@mistake(r"orientation|sign|latitude")
def up_taken_for_down(m):
    m.run["orientation"] = {"z": "down", "x": "north"}


@mistake(r"orientation|azimuth")
def north_taken_for_east(m):
    m.run["orientation"] = {"z": "up", "x": "east"}


@mistake(r"axis z|frame_signs|sign")
def a_frame_sign_turned(m):
    m.run["frame_signs"] = [1, 1, -1]


@mistake(r"axis x|frame_signs|sign|azimuth|orientation")
def a_frame_sign_of_an_axis_at_right_angles_turned(m):
    m.run["frame_signs"] = [-1, 1, 1]


@mistake(r"started_at|valid")
def a_date_before_the_calibration(m):
    m.run["started_at"] = "2012-05-12T13:00:00Z"


# The calibration record


@mistake(r"factor|scale")
def scale_factors_a_tenth(m):
    m.record["scale_factor_V_per_deg_s"] = [c / 10 for c in m.record["scale_factor_V_per_deg_s"]]


@mistake(r"gyro1")
def a_scale_factor_ten_times(m):
    m.record["scale_factor_V_per_deg_s"][0] *= 10


@mistake(r"gyro2|scale|commanded")
def a_scale_factor_off_by_one_percent(m):
    m.record["scale_factor_V_per_deg_s"][1] *= 1.01


@mistake(r"bias|commanded|sine")
def a_bias_of_the_other_sign(m):
    m.record["bias_V"][1] *= -1


@mistake(r"bias|commanded")
def biases_in_millivolts(m):
    m.record["bias_V"] = [b * 1000 for b in m.record["bias_V"]]


@mistake(r"bias|commanded")
def biases_left_at_zero(m):
    m.record["bias_V"] = [0.0] * 4


@mistake(r"exchanged|H\b|gyro|axis|commanded")
def rows_of_H_exchanged(m):
    m.record["H"][0], m.record["H"][1] = m.record["H"][1], m.record["H"][0]


@mistake(r"exchanged|gyro|commanded")
def columns_of_H_exchanged(m):
    for row in m.record["H"]:
        row[1], row[2] = row[2], row[1]


@mistake(r"gyro|scale|commanded|bias")
def the_record_of_another_unit_under_this_ones_name(m):
    m.record["scale_factor_V_per_deg_s"] = [0.0741, 0.0912, 0.0893, 0.0771]
    m.record["bias_V"] = [-2.1e-4, 3.3e-4, -5.2e-4, 1.4e-4]


@mistake(r"unit")
def the_record_of_another_unit(m):
    m.run["unit"] = "TETRA-02"


# The capture


@mistake(r"exchanged|gyro|commanded")
def columns_of_two_gyros_exchanged(m):
    m.edit("capture.csv", lambda rows: rows[:, [0, 1, 3, 2, 4]])


@mistake(r"exchanged|gyro|commanded|polarity")
def columns_of_two_gyros_that_read_much_alike_exchanged(m):
    m.edit("capture.csv", lambda rows: rows[:, [0, 4, 2, 3, 1]])


@mistake(r"half|missing|ends|expected|shorter")
def half_a_file(m):
    m.edit("capture.csv", lambda rows: rows[: len(rows) // 2])


@mistake(r"half|missing|starts|expected|first|begins")
def the_first_quarter_cut_off(m):
    m.edit("capture.csv", lambda rows: rows[len(rows) // 4 :])


@mistake(r"time_zero|epoch|1970|Unix")
def stamps_since_1970(m):
    m.edit("capture.csv", lambda rows: rows + np.array([1399899600.0, 0, 0, 0, 0]))


@mistake(r"sample_rate_hz|unit|ms|millisecond|rate")
def stamps_in_milliseconds(m):
    m.edit("capture.csv", lambda rows: rows * [1000.0, 1, 1, 1, 1])


@mistake(r"time_zero|first|late|starts")
def a_clock_that_was_started_five_seconds_early(m):
    m.edit("capture.csv", lambda rows: rows + np.array([5.0, 0, 0, 0, 0]))


@mistake(r"segment|profile|commanded|edge|time_zero|turn")
def a_record_that_began_two_seconds_after_the_table(m):
    m.edit("capture.csv", lambda rows: rows[128:] - np.array([2.0, 0, 0, 0, 0]))


@mistake(r"factor|unit|volts|V\b|rail|large")
def readings_in_millivolts(m):
    m.edit("capture.csv", lambda rows: rows * [1, 1000.0, 1000.0, 1000.0, 1000.0])


@mistake(r"profile|commanded|shorter|missing|expected")
def the_capture_of_another_run(m):
    m.take("capture.csv")


# The logs


@mistake(r"temperature")
def the_temperature_log_of_a_shorter_run(m):
    m.take("temperature.csv")


@mistake(r"temperature")
def a_temperature_log_with_times_of_day(m):
    m.edit("temperature.csv", lambda rows: rows + np.array([46800.0, 0, 0]))


@mistake(r"temperature|degC")
def temperatures_in_kelvin(m):
    m.edit("temperature.csv", lambda rows: rows + np.array([0, 273.15, 273.15]))


@mistake(r"table")
def the_encoder_log_of_another_run(m):
    m.take("table.csv")


@mistake(r"table|encoder")
def an_encoder_of_the_other_sense(m):
    m.edit("table.csv", lambda rows: rows * [1, -1])


@mistake(r"table|encoder")
def an_encoder_log_in_radians(m):
    m.edit("table.csv", lambda rows: rows * [1, np.pi / 180])


@mistake(r"table|encoder")
def an_encoder_log_that_starts_ten_seconds_late(m):
    m.edit("table.csv", lambda rows: rows - np.array([10.0, 0]))


@mistake(r"table|encoder")
def half_an_encoder_log(m):
    m.edit("table.csv", lambda rows: rows[: len(rows) // 2])


@mistake(r"table|encoder")
def angles_that_start_anew_after_a_turn(m):
    m.edit("table.csv", lambda rows: np.column_stack([rows[:, 0], rows[:, 1] % 360.0]))


#: One of each kind, and small ones, in the quick suite; the rest is marked slow.
QUICK = {
    "rates_of_the_other_sign",
    "rates_in_degrees_a_minute",
    "a_rate_off_by_a_thousandth",
    "another_axis",
    "a_step_that_is_too_long",
    "steps_in_another_order",
    "a_sample_rate_off_by_one_percent",
    "volts_taken_for_degrees_a_second",
    "a_polarity_left_out",
    "a_latitude_without_its_sign",
    "a_latitude_off_by_two_degrees",
    "an_azimuth_off_by_90_degrees",
    "an_azimuth_off_by_three_degrees",
    "up_taken_for_down",
    "a_frame_sign_turned",
    "a_date_before_the_calibration",
    "a_scale_factor_ten_times",
    "a_bias_of_the_other_sign",
    "the_record_of_another_unit_under_this_ones_name",
    "columns_of_two_gyros_exchanged",
    "half_a_file",
    "stamps_since_1970",
    "a_clock_that_was_started_five_seconds_early",
    "the_temperature_log_of_a_shorter_run",
    "the_encoder_log_of_another_run",
}
