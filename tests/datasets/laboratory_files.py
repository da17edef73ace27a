"""Files as laboratories' loggers write them: one recording of three gyros, in every format, unit and time.

The unit's axes stand up, east and north at latitude 48, and the table turns it about x: what the gyros read
follows from that by hand (Earth's rate about a turning axis), with white noise on it.
"""

import gzip
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import h5py
import numpy as np

RATE_HZ = 50.0
RECORDS = 2000
DURATION_S = RECORDS / RATE_HZ
LATITUDE_DEG = 48.0
TURN_DEG_S = 3.0
LEAST_DEG_S = 1e-6  # of the digits that a file carries

#: 2025-05-12T13:00:00Z in Unix seconds; GPS seconds count from 1980-01-06 and are 18 leap seconds ahead.
UNIX_S = 1_747_054_800
GPS_S = UNIX_S - 315_964_800 + 18

DEG = np.pi / 180


@dataclass(frozen=True)
class Recording:
    """Stamps [us] since the start, and what the gyros read, in whole steps of 1e-6 deg/s, (3, N)."""

    time_us: np.ndarray
    steps: np.ndarray

    @property
    def deg_s(self):
        return self.steps * LEAST_DEG_S

    @property
    def time_s(self):
        return self.time_us / 1e6


def recording(seed=0, turn_deg_s=TURN_DEG_S):
    time_us = np.arange(RECORDS) * round(1e6 / RATE_HZ)
    alpha = turn_deg_s * DEG * time_us / 1e6
    earth = 15.041067 / 3600  # deg/s
    vertical, horizontal = np.sin(LATITUDE_DEG * DEG), np.cos(LATITUDE_DEG * DEG)
    rates = earth * np.array([vertical + 0 * alpha, horizontal * np.sin(alpha), horizontal * np.cos(alpha)])
    rates[0] += turn_deg_s
    noise = 0.003 * np.random.default_rng(seed).standard_normal(rates.shape)
    return Recording(time_us, np.rint((rates + noise) / LEAST_DEG_S).astype(np.int64))


def text(header, columns, formats, delimiter=",", end="\n", before=""):
    """Delimited text: `before`, a header line where there is one, a line a record."""
    rows = [
        delimiter.join(f(v) for f, v in zip(formats, row, strict=True)) for row in zip(*columns, strict=True)
    ]
    head = [] if header is None else [header]
    return before + end.join([*head, *rows]) + end


def digits(places):
    return lambda value: f"{value:.{places}f}"


def stamps_as_dates(recording, suffix="Z", separator="T"):
    start = np.datetime64(UNIX_S, "s")
    stamps = start + recording.time_us.astype("timedelta64[us]")
    return [str(stamp).replace("T", separator) + suffix for stamp in stamps]


# ------------------------------------------------------------------------------------------- text


def plain(folder, data):
    path = folder / "log.csv"
    path.write_text(
        text("t,gx [deg/s],gy [deg/s],gz [deg/s]", (data.time_s, *data.deg_s), (digits(2), *[digits(6)] * 3))
    )
    return path


def german(folder, data):
    """Semicolons, decimal commas, comment lines, a byte order mark, CRLF, names in another tongue."""
    path = folder / "Messung.csv"
    comma = [lambda value, f=f: f(value).replace(".", ",") for f in (digits(3), *[digits(6)] * 3)]
    path.write_bytes(
        text(
            "Zeit [s];Drehrate X [°/s];Drehrate Y [°/s];Drehrate Z [°/s]",
            (data.time_s, *data.deg_s),
            comma,
            delimiter=";",
            end="\r\n",
            before="\ufeff# Prüfling 7; Tisch 2\r\n# alles in Ordnung\r\n",
        ).encode()
    )
    return path


def latin_1(folder, data):
    """The degree sign as one byte, as Windows writes it."""
    path = folder / "alt.txt"
    written = text(
        "Time (ms)\tRate X (°/s)\tRate Y (°/s)\tRate Z (°/s)",
        (data.time_us / 1e3, *data.deg_s),
        (digits(0), *[digits(6)] * 3),
        delimiter="\t",
    )
    path.write_bytes(written.encode("latin-1"))
    return path


def packed_without_header(folder, data):
    """Columns of blanks, no header, gzipped; the user names columns by number."""
    path = folder / "log.dat.gz"
    columns = (np.arange(RECORDS), data.time_us // 1000, *data.deg_s)
    written = text(None, columns, (str, str, *[lambda v: f"{v:12.6f}"] * 3), delimiter="  ")
    path.write_bytes(gzip.compress(written.encode()))
    return path


def dates(folder, data):
    path = folder / "recorder.csv"
    columns = (stamps_as_dates(data), *data.deg_s)
    path.write_text(text("timestamp,gyro_x_dps,gyro_y_dps,gyro_z_dps", columns, (str, *[digits(6)] * 3)))
    return path


def dates_with_blank(folder, data):
    """Dates as a database exports them: a blank for the T, no zone, quotes about fields."""
    path = folder / "export.csv"
    columns = (stamps_as_dates(data, "", " "), *data.deg_s)
    quoted = [lambda value, f=f: f'"{f(value)}"' for f in (str, *[digits(6)] * 3)]
    path.write_text(text('"time","wx_deg_s","wy_deg_s","wz_deg_s"', columns, quoted, delimiter=", "))
    return path


def unix_seconds(folder, data):
    path = folder / "imu.csv"
    stamps = [f"{UNIX_S + t // 1_000_000}.{t % 1_000_000:06d}" for t in data.time_us.tolist()]
    columns = (stamps, *(data.deg_s * DEG))
    path.write_text(
        text("unix_time,gyro_x (rad/s),gyro_y (rad/s),gyro_z (rad/s)", columns, (str, *[digits(10)] * 3))
    )
    return path


def ros(folder, data):
    """A robot's topic: nanoseconds since 1970 and rad/s by the names of the message, other fields around."""
    path = folder / "imu_data.csv"
    nanoseconds = UNIX_S * 10**9 + data.time_us * 1000
    zeros = np.zeros(RECORDS)
    header = "seq,header.stamp,frame_id,orientation.x,orientation.y,orientation.z,orientation.w,"
    header += ",".join(f"angular_velocity.{axis}" for axis in "xyz") + ","
    header += ",".join(f"linear_acceleration.{axis}" for axis in "xyz")
    columns = (
        *(np.arange(RECORDS), nanoseconds, ["imu"] * RECORDS, zeros, zeros, zeros, zeros + 1),
        *(*(data.deg_s * DEG), zeros, zeros, zeros + 9.81),
    )
    formats = (str, str, str, *[digits(3)] * 4, *[lambda v: f"{v:.12g}"] * 3, *[digits(4)] * 3)
    path.write_text(text(header, columns, formats))
    return path


def gps_seconds(folder, data):
    path = folder / "ins.txt"
    columns = (GPS_S + data.time_s, *(data.deg_s * 3600))
    path.write_text(
        text("gps_time_s gyro_x_deg_h gyro_y_deg_h gyro_z_deg_h", columns, (digits(2), *[digits(4)] * 3), " ")
    )
    return path


def counter(folder, data):
    """Ticks of 0.1 ms that do not begin at 0, and whole counts."""
    path = folder / "fog.csv"
    columns = (12345 + data.time_us // 100, *data.steps)
    path.write_text(text("ticks,gyro1_count,gyro2_count,gyro3_count", columns, (str,) * 4))
    return path


def no_time(folder, data):
    path = folder / "rates.csv"
    path.write_text(text("gx_dps,gy_dps,gz_dps", data.deg_s, [digits(6)] * 3))
    return path


def preamble(folder, data):
    """What a logger says of itself stands before the header, units in a line of their own below it."""
    path = folder / "daq.csv"
    before = "Logger 3000\nSerial;4711\nDate;2025-05-12\n\n"
    columns = (data.time_s, *data.deg_s)
    written = text(
        "Time;Gx;Gy;Gz\ns;deg/s;deg/s;deg/s", columns, (digits(2), *[digits(6)] * 3), ";", before=before
    )
    path.write_text(written)
    return path


def wide(folder, data):
    """Thirty columns of which four matter, two temperatures and the table's angle, words for no answer."""
    path = folder / "everything.csv"
    noise = np.random.default_rng(1)
    others = {f"adc{k} [V]": noise.standard_normal(RECORDS) for k in range(10)}
    columns = {
        "index": np.arange(RECORDS),
        **others,
        "acc_x [g]": noise.standard_normal(RECORDS),
        "acc_y [g]": noise.standard_normal(RECORDS),
        "acc_z [g]": noise.standard_normal(RECORDS),
        "mag_x [uT]": noise.standard_normal(RECORDS),
        "omega_x [deg/s]": data.deg_s[0],
        "omega_y [deg/s]": data.deg_s[1],
        "omega_z [deg/s]": data.deg_s[2],
        "sensor temperature [degC]": 25 + 0.01 * data.time_s,
        "electronics temperature [degC]": 31 + 0.01 * data.time_s,
        "table angle [deg]": TURN_DEG_S * data.time_s,
        "status": ["OK"] * RECORDS,
        "time [s]": data.time_s,
    }
    formats = [str if name in ("index", "status") else digits(6) for name in columns]
    path.write_text(text(",".join(columns), columns.values(), formats))
    return path


def increments(folder, data):
    path = folder / "delta.csv"
    columns = (data.time_us, *(data.deg_s * DEG / RATE_HZ))
    header = "time_us,dtheta_x [rad],dtheta_y [rad],dtheta_z [rad]"
    path.write_text(text(header, columns, (str, *[lambda v: f"{v:.12e}"] * 3)))
    return path


# ----------------------------------------------------------------------------------------- binary


def hdf5(folder, data):
    path = folder / "run.h5"
    with h5py.File(path, "w") as file:
        group = file.create_group("imu")
        group["time"] = data.time_s
        group["time"].attrs["units"] = "s"
        group["gyro"] = data.deg_s.T
        group["gyro"].attrs["units"] = "deg/s"
        group["temperature"] = 25 + 0.01 * data.time_s[::50]
        file["serial"] = np.arange(7)
    return path


def matlab_5(folder, data):
    """A struct in a struct, as Simulink's `To File` and most scripts leave them."""
    from scipy.io import savemat

    path = folder / "run.mat"
    rates = {"wx": data.deg_s[0][:, None], "wy": data.deg_s[1][:, None], "wz": data.deg_s[2][:, None]}
    rec = {"t": data.time_s[:, None], "rate_dps": rates, "operator": "nobody"}
    savemat(path, {"rec": rec, "version": 3.0}, do_compression=True)
    return path


def matlab_73(folder, data):
    """HDF5 with MATLAB's 512 bytes before it; MATLAB's columns are HDF5's rows."""
    path = folder / "run73.mat"
    with h5py.File(path, "w", userblock_size=512) as file:
        group = file.create_group("data")
        group.attrs["MATLAB_class"] = np.bytes_("struct")
        for name, values in (("time_ms", data.time_us / 1e3), ("gyro_deg_h", data.deg_s * 3600)):
            group[name] = np.atleast_2d(values)
            group[name].attrs["MATLAB_class"] = np.bytes_("double")
    with path.open("r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM")
    return path


def npy(folder, data):
    """A plain matrix: nothing in it says what its columns are."""
    path = folder / "matrix.npy"
    np.save(path, np.column_stack([data.time_s, *data.deg_s]))
    return path


def npy_fields(folder, data):
    path = folder / "fields.npy"
    table = np.zeros(RECORDS, [("stamp_us", "<i8"), ("gyro", "<i4", (3,)), ("crc", "<u2")])
    table["stamp_us"], table["gyro"] = data.time_us, data.steps.T
    np.save(path, table)
    return path


def npz(folder, data):
    path = folder / "arrays.npz"
    np.savez_compressed(
        path, time_s=data.time_s, dtheta_deg=(data.deg_s / RATE_HZ).T, note=np.array("bench 2")
    )
    return path


def tdms(folder, data):
    """Channels with their increment and unit as LabVIEW's waveforms have them; no time channel."""
    from nptdms import ChannelObject, TdmsWriter

    path = folder / "run.tdms"
    start = np.datetime64(UNIX_S, "s").astype("datetime64[us]")
    about = {"wf_increment": 1 / RATE_HZ, "wf_start_time": start, "unit_string": "deg/s"}
    with TdmsWriter(path) as writer:
        for part in range(0, RECORDS, 500):
            writer.write_segment(
                [
                    ChannelObject("Rates", f"Gyro {a}", data.deg_s[k][part : part + 500], about)
                    for k, a in enumerate("XYZ")
                ]
            )
    return path


def parquet(folder, data):
    """Instants as parquet's own type; float32 rates would lose digits, so float64."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    path = folder / "run.parquet"
    stamps = np.datetime64(UNIX_S, "s").astype("datetime64[ns]") + data.time_us.astype("timedelta64[us]")
    columns = {"time": pa.array(stamps), "label": pa.array(["a"] * RECORDS)}
    columns |= {f"rate_{axis}_deg_h": data.deg_s[k] * 3600 for k, axis in enumerate("xyz")}
    pq.write_table(pa.table(columns), path, row_group_size=700)
    return path


# ------------------------------------------------------------------------------------------ cases


@dataclass(frozen=True)
class Case:
    """A file: its writer, what the user has to say of it, its unit, and the steps [deg/s] of its digits."""

    write: Callable[[Path, Recording], Path]
    format: str
    raw_unit: str
    options: tuple[str, ...] = ()
    #: Half of the last digit that the file carries, in deg/s.
    half_digit_deg_s: float = 1e-15
    started_at: str | None = None
    name: str = field(default="")

    def __str__(self):
        return self.write.__name__


START = "2025-05-12T13:00:00Z"
CASES = (
    Case(plain, "table", "deg/s"),
    Case(german, "table", "deg/s"),
    Case(latin_1, "table", "deg/s"),
    Case(
        packed_without_header,
        "table",
        "deg/s",
        ("--columns", "time=2,gyros=3:5", "--time-unit", "ms", "--unit", "deg/s"),
    ),
    Case(dates, "table", "deg/s", started_at=START),
    Case(dates_with_blank, "table", "deg/s", started_at=START),
    Case(unix_seconds, "table", "rad/s", half_digit_deg_s=0.5e-10 / DEG, started_at=START),
    Case(ros, "table", "rad/s", ("--unit", "rad/s"), 0.5e-13 / DEG, started_at=START),
    Case(gps_seconds, "table", "deg/h", half_digit_deg_s=0.5e-4 / 3600, started_at=START),
    Case(counter, "table", "count", ("--time-unit", "ticks", "--tick", "1e-4")),
    Case(no_time, "table", "deg/s", ("--rate", "50")),
    Case(preamble, "table", "deg/s"),
    Case(wide, "table", "deg/s"),
    Case(increments, "table", "rad", half_digit_deg_s=0.5e-13 * RATE_HZ / DEG),
    Case(hdf5, "hdf5", "deg/s"),
    Case(matlab_5, "mat", "deg/s"),
    Case(matlab_73, "mat", "deg/h"),
    Case(npy, "npy", "deg/s", ("--columns", "time=1,gyros=2:4", "--time-unit", "s", "--unit", "deg/s")),
    Case(npy_fields, "npy", "count", ("--unit", "count")),
    Case(npz, "npz", "deg"),
    Case(tdms, "tdms", "deg/s", started_at=START),
    Case(parquet, "parquet", "deg/h", started_at=START),
)
