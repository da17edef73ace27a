"""``fogreduce simulate`` as its user sees it."""

from __future__ import annotations

import importlib
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fogreduce.cli.main import main
from fogreduce.datasets.readers.fogcap import FogcapReader, read_header
from fogreduce.datasets.sole_writer import WORKFLOW
from fogreduce.metadata.folder import list_runs, load_campaign, load_run
from fogreduce.metadata.yaml12 import load_yaml
from fogreduce.simulate.capture import write_capture

ROOT = Path(__file__).parents[2]
CALIBRATIONS = str(ROOT / "calibrations")


@pytest.fixture
def campaign(tmp_path: Path) -> Path:
    """Two short runs out of the bundled ones."""
    folder = tmp_path / "short"
    for run_id in ("1-x-plus", "8-still"):
        here = folder / "runs" / run_id
        shutil.copytree(ROOT / "campaigns" / "three-axes" / "runs" / run_id, here)
        text = (here / "run.yaml").read_text().replace("duration_s: 300", "duration_s: 20")
        (here / "run.yaml").write_text(text)
    shutil.copy(ROOT / "campaigns" / "three-axes" / "campaign.yaml", folder)
    return folder


def simulate(campaign: Path, out: Path, *options: str) -> int:
    return main(["simulate", str(campaign), "--calibrations", CALIBRATIONS, "--out", str(out), *options])


def captures(folder: Path) -> dict[str, bytes]:
    return {path.parent.name: path.read_bytes() for path in sorted(folder.glob("runs/*/capture.fogcap"))}


def effects(folder: Path, *entries: str) -> str:
    file = folder / "effects.yaml"
    file.write_text("schema: fogreduce/effects/1\neffects:\n" + "".join(f"  - {e}\n" for e in entries))
    return str(file)


def test_the_output_is_a_campaign_folder(campaign: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    assert simulate(campaign, out) == 0
    assert main(["check", str(out), "--calibrations", CALIBRATIONS]) == 0
    kept = load_campaign(out)
    assert kept.label == load_campaign(campaign).label
    assert kept.captures_from is None  # the captures are there: nothing may make them again
    for folder in list_runs(out):
        run = load_run(folder)
        header = read_header(folder / "capture.fogcap")
        assert (header.unit, header.start_us, header.n_gyros) == ("TETRA-01", run.start_us, 4)
        assert FogcapReader(folder / "capture.fogcap").n_records == 2560
        original = campaign / "runs" / folder.name
        for name in ("run.yaml", "temperature.csv"):
            assert (folder / name).read_bytes() == (original / name).read_bytes()
    assert sorted(path.name for path in out.iterdir()) == ["campaign.yaml", "runs"]


def test_what_was_injected_stands_beside_the_folder_not_in_it(campaign: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    file = effects(
        tmp_path, "{effect: bias_offset, channels: [gyro2], runs: ['*'], parameters: {deg_h: 7.123456}}"
    )
    assert simulate(campaign, out, "--effects", file, "--draw-uncertainties", "--seed", "3") == 0
    injected = load_yaml(tmp_path / "out.injected.yaml")
    assert injected["seed"] == 3
    assert injected["effects"] == [
        {"effect": "bias_offset", "channels": ["gyro2"], "runs": ["*"], "parameters": {"deg_h": 7.123456}}
    ]
    # two runs x (table, latitude, heading) + four gyros x (scale factor, bias, axis, two turn-on biases)
    assert isinstance(injected["drawn"], list)
    assert len(injected["drawn"]) == 2 * 3 + 4 * (3 + 2)
    for path in out.rglob("*"):
        assert "injected" not in path.name
        assert path.is_dir() or b"7.123456" not in path.read_bytes()


def test_what_was_drawn_is_what_the_captures_hold(campaign: Path, tmp_path: Path) -> None:
    """Put in again as effects, the draws give the same captures; noise has its own streams."""
    assert simulate(campaign, tmp_path / "drawn", "--draw-uncertainties", "--no-noise") == 0
    drawn = load_yaml(tmp_path / "drawn.injected.yaml")["drawn"]
    from fogreduce.metadata.yaml12 import dump_yaml

    file = tmp_path / "again.yaml"
    file.write_text(dump_yaml({"schema": "fogreduce/effects/1", "effects": drawn}))
    assert simulate(campaign, tmp_path / "again", "--effects", str(file), "--no-noise") == 0
    assert captures(tmp_path / "again") == captures(tmp_path / "drawn")
    assert simulate(campaign, tmp_path / "plain", "--no-noise") == 0
    assert captures(tmp_path / "plain") != captures(tmp_path / "drawn")


def test_draws_have_the_stated_size(campaign: Path) -> None:
    """Over 200 seeds: scale factor 20 ppm, turn-on bias 0.05 deg/h, azimuth 0.05 deg (5 deviations: 25 %)."""
    from fogreduce.simulate.plan import Options, prepare

    sizes: dict[str, list[float]] = {}
    for seed in range(200):
        plan = prepare(campaign, ROOT / "calibrations", Options(draw_uncertainties=True, seed=seed))
        for entry in plan.drawn:
            if entry.channels[0] in ("gyro1", "table") and entry.runs[0] == "1-x-plus":
                values = np.ravel(next(iter(entry.parameters.values())))  # type: ignore[call-overload]
                sizes.setdefault(entry.effect, []).append(float(np.linalg.norm(values)))
    found = {name: float(np.sqrt(np.mean(np.square(values)))) for name, values in sizes.items()}
    expected = {
        "table_rate_error": 5.0,
        "latitude_error": 0.001,
        "heading_error": 0.05,
        "scale_factor_error": 20.0,
        "bias_offset": 1e-9 / 7.5229e-2 * 3600,
        "axis_misalignment": 0.02 * np.sqrt(2),  # two directions
        "turn_on_bias": 0.05,
    }
    assert found == pytest.approx(expected, rel=0.25)


def test_the_seed(campaign: Path, tmp_path: Path) -> None:
    made = {}
    for name, options in {"a": [], "b": ["--seed", "2"], "c": ["--seed", "3"]}.items():
        assert simulate(campaign, tmp_path / name, *options) == 0
        made[name] = captures(tmp_path / name)
    assert made["a"] == made["b"]  # campaign.yaml says 2
    assert made["a"]["8-still"] != made["c"]["8-still"]
    (campaign / "campaign.yaml").unlink()
    assert simulate(campaign, tmp_path / "d") == 0
    assert simulate(campaign, tmp_path / "e", "--seed", "0") == 0
    assert captures(tmp_path / "d") == captures(tmp_path / "e")  # the default is 0
    assert not (tmp_path / "d" / "campaign.yaml").exists()


def test_only_some_runs_give_the_same_bytes(campaign: Path, tmp_path: Path) -> None:
    assert simulate(campaign, tmp_path / "all") == 0
    assert simulate(campaign, tmp_path / "one", "--only-runs", "8-still") == 0
    assert captures(tmp_path / "one") == {"8-still": captures(tmp_path / "all")["8-still"]}
    assert simulate(campaign, tmp_path / "one", "--only-runs", "1-x-plus") == 0
    assert captures(tmp_path / "one") == captures(tmp_path / "all")


def test_a_run_that_is_added_changes_no_other(campaign: Path, tmp_path: Path) -> None:
    assert simulate(campaign, tmp_path / "two") == 0
    shutil.rmtree(campaign / "runs" / "1-x-plus")
    assert simulate(campaign, tmp_path / "one") == 0
    assert captures(tmp_path / "one")["8-still"] == captures(tmp_path / "two")["8-still"]


def test_an_older_output_is_replaced_where_that_is_asked_for(
    campaign: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    assert simulate(campaign, out, "--seed", "8") == 0
    before = captures(out)
    capsys.readouterr()
    assert simulate(campaign, out, "--seed", "9") == 2
    assert capsys.readouterr().err.splitlines() == [
        f"{out / 'runs' / '1-x-plus' / 'capture.fogcap'}: found 2 captures of an earlier simulation; "
        "expected another --out, or --overwrite"
    ]
    assert captures(out) == before
    assert load_yaml(tmp_path / "out.injected.yaml")["seed"] == 8
    assert simulate(campaign, out, "--seed", "9", "--overwrite") == 0
    assert captures(out) != before
    assert [path.name for path in tmp_path.iterdir() if path.name.startswith(".")] == []


def test_a_failure_half_way_leaves_the_older_output(
    campaign: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    out = tmp_path / "out"
    assert simulate(campaign, out, "--seed", "8") == 0
    before = captures(out)
    from fogreduce.simulate import campaign as module

    calls = []

    def failing(*arguments: object) -> None:
        calls.append(arguments)
        if len(calls) == 2:
            raise OSError(28, "No space left on device")
        write(*arguments)  # type: ignore[arg-type]

    write = module.write_capture
    monkeypatch.setattr(module, "write_capture", failing)
    assert simulate(campaign, out, "--seed", "9", "--overwrite") == 2
    assert captures(out) == before
    assert [path.name for path in tmp_path.iterdir() if path.name.startswith(".")] == []
    assert load_yaml(tmp_path / "out.injected.yaml")["seed"] == 8


def test_csv_captures_can_be_made_too(campaign: Path, tmp_path: Path) -> None:
    here = campaign / "runs" / "8-still" / "run.yaml"
    here.write_text(here.read_text().replace("capture.fogcap", "capture.csv").replace("fogcap-1", "csv-1"))
    (here.parent.parent / "1-x-plus").rename(tmp_path / "away")
    file = effects(
        tmp_path, "{effect: dropouts, channels: [gyro2], runs: ['*'], parameters: {fraction: 0.1}}"
    )
    assert simulate(campaign, tmp_path / "csv", "--effects", file) == 0
    assert main(["check", str(tmp_path / "csv"), "--calibrations", CALIBRATIONS]) == 0
    lines = (tmp_path / "csv" / "runs" / "8-still" / "capture.csv").read_text().splitlines()
    assert lines[0] == "time_s,gyro1_V,gyro2_V,gyro3_V,gyro4_V"
    assert len(lines) == 2561
    here.write_text(here.read_text().replace("capture.csv", "capture.fogcap").replace("csv-1", "fogcap-1"))
    assert simulate(campaign, tmp_path / "fogcap", "--effects", file) == 0
    reader = FogcapReader(tmp_path / "fogcap" / "runs" / "8-still" / "capture.fogcap")
    (block,) = reader.blocks(10_000)
    for k in (0, 1, 2000):
        fields = lines[k + 1].split(",")
        assert float(fields[0]) * 1e6 == pytest.approx(block.time_us[k], abs=1e-3)
        for gyro, field in enumerate(fields[1:]):
            count = block.counts[gyro, k]
            assert (field == "") if count == -(2**31) else round(float(field) / 1e-7) == count


@pytest.mark.parametrize(
    ("options", "told"),
    [
        (
            ["--effects", "EFFECTS: {effect: telegraph}"],
            "found telegraph; expected an effect of the catalogue",
        ),
        (
            ["--effects", "EFFECTS: {effect: bias_offset, channels: [gyro7], parameters: {deg_h: 1}}"],
            "effects[0].channels[0]: found gyro7",
        ),
        (
            [
                "--effects",
                "EFFECTS: {effect: bias_offset, channels: [gyro1], runs: [r9], parameters: {deg_h: 1}}",
            ],
            "effects[0].runs[0]: found r9",
        ),
        (
            ["--effects", "EFFECTS: {effect: bias_offset, channels: [gyro1], parameters: {ppm: 1}}"],
            "effects[0].parameters.ppm",
        ),
        (
            [
                "--effects",
                "EFFECTS: {effect: bias_ramp, channels: [gyro1], parameters: {deg_h_per_h: .nan}}",
            ],
            "effects[0].parameters.deg_h_per_h: found nan; expected a finite number",
        ),
        (
            ["--effects", "EFFECTS: {effect: bias_ramp, channels: [gyro1], parameters: {deg_h_per_h: }}"],
            "effects[0].parameters.deg_h_per_h: found nothing; expected a number, true or false, text, or",
        ),
        (["--effects", "/nowhere/effects.yaml"], "no such file"),
        (["--seed", "-1"], "--seed: found -1"),
        (["--only-runs", "r9"], "--only-runs: found r9; expected one of 1-x-plus, 8-still"),
    ],
)
def test_bad_usage_is_one_clear_error(
    options: list[str], told: str, campaign: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    options = [
        effects(tmp_path, option.removeprefix("EFFECTS: ")) if option.startswith("EFFECTS") else option
        for option in options
    ]
    assert simulate(campaign, tmp_path / "out", *options) == 2
    error = capsys.readouterr().err
    assert told in error
    assert "Traceback" not in error
    assert ".float" not in error  # a name of pydantic's
    assert not (tmp_path / "out").exists()
    assert not (tmp_path / "out.injected.yaml").exists()


def test_temperature_effects_need_a_log(
    campaign: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    here = campaign / "runs" / "8-still" / "run.yaml"
    here.write_text(here.read_text().replace("temperature: temperature.csv\n", ""))
    file = effects(
        tmp_path,
        "{effect: temperature_bias, channels: [gyro1], runs: ['*'], parameters: {deg_h_per_degC: 1}}",
    )
    assert simulate(campaign, tmp_path / "out", "--effects", file) == 2
    assert "run 8-still without a temperature log" in capsys.readouterr().err


def test_the_campaign_itself_is_never_overwritten(campaign: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert simulate(campaign, campaign) == 2
    assert "the campaign itself" in capsys.readouterr().err
    assert captures(campaign) == {}


def test_another_campaigns_output_is_not_mixed_in(
    campaign: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "out" / "runs" / "other").mkdir(parents=True)
    assert simulate(campaign, tmp_path / "out") == 2
    assert "other" in capsys.readouterr().err


def test_measured_captures_are_never_overwritten(
    campaign: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Another campaign with the same runs, whether it was measured or changed since it was simulated."""
    out = tmp_path / "out"
    assert simulate(campaign, out) == 0
    for options in (["--seed", "8"], ["--only-runs", "1-x-plus"], ["--seed", "9"]):
        # its own output, as often as one asks for it
        assert simulate(campaign, out, *options, "--overwrite") == 0
    (out / "runs" / "8-still" / "capture.fogcap").write_bytes(b"measured")
    before = captures(out)
    capsys.readouterr()
    assert simulate(campaign, out, "--seed", "9", "--overwrite") == 2
    assert captures(out) == before
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert "runs/8-still/capture.fogcap: found a capture that no `fogreduce simulate` wrote" in said
    # the other is left alone
    assert simulate(campaign, out, "--only-runs", "1-x-plus", "--overwrite") == 0
    (tmp_path / "out.injected.yaml").unlink()
    before = captures(out)
    assert simulate(campaign, out) == 2
    assert captures(out) == before
    assert not (tmp_path / "out.injected.yaml").exists()


def test_runs_simulated_at_once_are_all_listed(
    campaign: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """One run's simulation begins and ends while another's goes on: both are jobs of a workflow."""
    monkeypatch.setenv(WORKFLOW, str(os.getpid()))
    out, write = tmp_path / "out", write_capture

    def meanwhile(*arguments: Any) -> None:
        monkeypatch.setattr(importlib.import_module("fogreduce.simulate.campaign"), "write_capture", write)
        assert simulate(campaign, out, "--only-runs", "8-still") == 0
        write(*arguments)

    monkeypatch.setattr(importlib.import_module("fogreduce.simulate.campaign"), "write_capture", meanwhile)
    assert simulate(campaign, out, "--only-runs", "1-x-plus") == 0
    # both are listed as simulated: they may be written over
    assert simulate(campaign, out, "--seed", "9", "--only-runs", "1-x-plus,8-still", "--overwrite") == 0


def test_a_folder_in_the_campaign_is_refused(campaign: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert simulate(campaign, campaign / "runs" / "predicted") == 2
    assert "found a folder in the campaign" in capsys.readouterr().err
    assert sorted(path.name for path in (campaign / "runs").iterdir()) == ["1-x-plus", "8-still"]


def test_captures_from_curves_take_no_effects(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert simulate(ROOT / "campaigns" / "published", tmp_path / "out", "--seed", "1") == 2
    assert "captures_from.curves" in capsys.readouterr().err


def test_a_missing_out_is_usage(campaign: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["simulate", str(campaign), "--calibrations", CALIBRATIONS]) == 2
    assert "--out" in capsys.readouterr().err


def test_what_simulating_imports(campaign: Path, tmp_path: Path) -> None:
    """Start-up is part of the time a user waits: no figures, no xarray, no scipy."""
    code = (
        "import sys\n"
        "from fogreduce.cli.main import main\n"
        f"assert main(['simulate', {str(campaign)!r}, '--calibrations', {CALIBRATIONS!r},"
        f" '--out', {str(tmp_path / 'out')!r}]) == 0\n"
        "heavy = {'matplotlib', 'xarray', 'scipy', 'h5py', 'pandas', 'tqdm'} & set(sys.modules)\n"
        "assert not heavy, heavy\n"
    )
    environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1"}
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=environment)
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""  # no progress bar where it is piped
