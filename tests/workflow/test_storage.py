"""An engine without a shared file system: each job gets what it says that it reads, and nothing else."""

from __future__ import annotations

import importlib.util
import shutil
import subprocess
from pathlib import Path

import pytest
from small_campaign import ASIDE, BIN, PATIENCE_S, ROOT, write_captures

needs_the_plugin = pytest.mark.skipif(
    importlib.util.find_spec("snakemake_storage_plugin_fs") is None or shutil.which("rsync") is None,
    reason="needs snakemake-storage-plugin-fs and rsync, which the README's commands do not install",
)


def contents(results: Path) -> dict[str, bytes]:
    """Results, but for what is kept in place alone: earlier versions, and notes beside simulated captures."""
    return {
        path.relative_to(results).as_posix(): path.read_bytes()
        for path in results.rglob("*")
        if path.is_file()
        and not {*ASIDE, "versions"} & set(path.relative_to(results).parts)
        and not path.name.endswith(".injected.yaml")
    }


def test_a_worker_has_the_table_of_runs_and_no_campaigns(tmp_path: Path) -> None:
    """What Snakemake brings to a worker is its sources and configuration: the table of runs among them."""
    write_captures(tmp_path, ("a", "b"))
    shutil.copytree(ROOT / "calibrations", tmp_path / "calibrations")
    call = [BIN / "snakemake", "--cores", "2", "--snakefile", ROOT / "Snakefile"]
    subprocess.run([*call, "--dry-run"], cwd=tmp_path, check=True, capture_output=True)
    (table,) = (tmp_path / ".snakemake" / "fogreduce").iterdir()
    worker = tmp_path / "worker"
    shutil.copytree(tmp_path / ".snakemake" / "fogreduce", worker / ".snakemake" / "fogreduce")
    part = ["--mode", "remote", "--shared-fs-usage", "none", "--list-rules"]
    listed = subprocess.run([*call, *part], cwd=worker, check=True, capture_output=True, text=True)
    assert "remove_earth" in listed.stdout
    (worker / table.relative_to(tmp_path)).unlink()
    without = subprocess.run([*call, *part], cwd=worker, check=False, capture_output=True, text=True)
    assert without.returncode == 2
    assert "campaigns: found no such folder" in without.stderr


@needs_the_plugin
@pytest.mark.slow
def test_results_are_those_of_a_shared_file_system(tmp_path: Path) -> None:
    """A captured campaign and one whose captures are made, with figures."""
    write_captures(tmp_path, ("a", "b"))
    shutil.copytree(ROOT / "calibrations", tmp_path / "calibrations")
    made = ROOT / "campaigns" / "three-axes"
    shutil.copytree(made, tmp_path / "campaigns" / "made")
    for run in (tmp_path / "campaigns" / "made" / "runs").iterdir():
        if run.name not in ("1-x-plus", "8-still"):
            shutil.rmtree(run)
    common = [BIN / "snakemake", "--cores", "2", "--snakefile", ROOT / "Snakefile"]
    apart = ["--default-storage-provider", "fs", "--shared-fs-usage", "none"]
    for settings, results in (([], "shared"), (apart, "apart")):
        done = subprocess.run(
            [*common, *settings, "--config", f"results_dir={results}"],
            cwd=tmp_path,
            capture_output=True,
            text=True,
            timeout=PATIENCE_S,
            check=False,
        )
        assert done.returncode == 0, done.stderr[-3000:]
    expected, found = contents(tmp_path / "shared"), contents(tmp_path / "apart")
    assert sorted(found) == sorted(expected)
    assert [name for name in expected if found[name] != expected[name]] == []
