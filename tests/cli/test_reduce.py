"""`fogreduce reduce` given what is no run."""

from __future__ import annotations

from pathlib import Path

import pytest

from fogreduce.cli.main import main


@pytest.mark.parametrize(
    ("given", "found", "campaigns"), [("lab", "a campaign", "."), (".", "a folder of campaigns", ".")]
)
def test_a_campaign_is_told_what_to_call(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], given: str, found: str, campaigns: str
) -> None:
    run = tmp_path / "lab" / "runs" / "r1"
    run.mkdir(parents=True)
    (run / "run.yaml").write_text("")
    folder, out = tmp_path / given, tmp_path / "out"
    assert main(["reduce", str(folder), "--out", str(out)]) == 2
    assert capsys.readouterr().err == (
        f"{folder}: found {found}; expected the folder of one run, such as {run}; "
        f"for all of them: snakemake --cores 2 --config campaigns_dir={tmp_path / campaigns}\n"
    )
    assert not out.exists()


def test_calibrations_have_a_default(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    for command in ("reduce", "manifest", "check", "simulate", "diagnose", "trace", "archive", "impact"):
        with pytest.raises(SystemExit):
            main([command, "--help"])
        assert "(default: calibrations)" in " ".join(capsys.readouterr().out.split()), command
