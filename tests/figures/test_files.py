"""Figures as files: the same bytes again, nothing left half, nothing stale, faults in one line."""

from __future__ import annotations

import json
import shutil
import struct

import pytest

from fogreduce.cli.main import main
from fogreduce.figures.catalogue import STEMS


def png_chunks(data: bytes) -> list[str]:
    """Names of a PNG's chunks."""
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    place, names = 8, []
    while place < len(data):
        (length,) = struct.unpack_from(">I", data, place)
        names.append(data[place + 4 : place + 8].decode())
        place += 12 + length
    return names


@pytest.fixture
def out(campaign, tmp_path):
    """A copy of the run with spikes, whose figures may be drawn."""
    target = tmp_path / "spiked"
    shutil.copytree(campaign / "results" / "spiked", target)
    return target


def test_command_draws_all_and_again_the_same(campaign, out, capsys):
    run = campaign / "campaign" / "runs" / "spiked"
    assert main(["figures", "--out", str(out), "--run", str(run)]) == 0
    assert capsys.readouterr().out == ""
    folder = out / "figures"
    names = [f"{stem}.{kind}" for stem in STEMS for kind in ("png", "svg")]
    assert sorted(path.name for path in folder.iterdir()) == sorted([*names, "index.json"])
    first = {name: (folder / name).read_bytes() for name in names}
    assert main(["figures", "--out", str(out), "--run", str(run)]) == 0
    assert {name: (folder / name).read_bytes() for name in names} == first
    index = json.loads((folder / "index.json").read_text())
    version = json.loads((out / "manifest.json").read_text())["version_id"]
    assert index == {"version_id": version, "figures": names, "left_out": {}}
    for name, data in first.items():
        if name.endswith("png"):
            assert set(png_chunks(data)) <= {"IHDR", "pHYs", "IDAT", "IEND"}, name
        else:
            text = data.decode()
            assert f"version {version}" in text, name
            assert "<dc:date>" not in text
            assert len(data) < 400_000, name


def test_formats_and_stale_figures(campaign, out, capsys):
    run = campaign / "campaign" / "runs" / "spiked"
    assert main(["figures", "--out", str(out), "--run", str(run), "--formats", "svg"]) == 0
    (out / "figures" / "mine.png").write_bytes(b"not ours")
    assert main(["figures", "--out", str(out), "--formats", "png"]) == 0
    said = capsys.readouterr().out
    assert "temperature: left out, " in said
    assert "encoder: left out, " in said
    expected = {f"{stem}.png" for stem in STEMS if stem not in ("temperature", "encoder")}
    assert {path.name for path in (out / "figures").iterdir()} == expected | {"index.json", "mine.png"}


@pytest.mark.parametrize("formats", ["pdf", "", "png,jpg"])
def test_unknown_format(out, capsys, formats):
    assert main(["figures", "--out", str(out), "--formats", formats]) == 2
    error = capsys.readouterr().err
    assert error.startswith("--formats: found ")
    assert error.count("\n") == 1
    assert not (out / "figures").exists()


@pytest.mark.parametrize(
    "part",
    ["manifest.json", "datasets/bins.nc", "reports/fit.json", "reports/ingest.json", "tables/drift.csv"],
)
def test_missing_part(out, capsys, part):
    (out / part).unlink()
    assert main(["figures", "--out", str(out)]) == 2
    error = capsys.readouterr().err
    assert part in error
    assert error.count("\n") == 1


def test_parts_of_another_version(out, capsys):
    for part in ("fit", "ingest"):
        path = out / "reports" / f"{part}.json"
        kept = path.read_text()
        path.write_text(json.dumps(json.loads(kept) | {"version_id": "another"}))
        assert main(["figures", "--out", str(out)]) == 2
        assert f"{part}.json: version_id: found another" in capsys.readouterr().err
        path.write_text(kept)


def test_missing_log(campaign, out, capsys, tmp_path):
    assert main(["figures", "--out", str(out), "--run", str(tmp_path)]) == 2
    assert "temperature.csv" in capsys.readouterr().err


def test_a_users_own_settings_change_nothing(campaign, tmp_path):
    import matplotlib

    out = tmp_path / "one"
    shutil.copytree(campaign / "results" / "one", out)
    assert main(["figures", "--out", str(out), "--formats", "svg"]) == 0
    first = (out / "figures" / "flags.svg").read_bytes()
    with matplotlib.rc_context({"font.size": 20, "axes.facecolor": "black", "ytick.right": True}):
        assert main(["figures", "--out", str(out), "--formats", "svg"]) == 0
    assert (out / "figures" / "flags.svg").read_bytes() == first
