"""Begin a warm server beside a workflow, and put its client first on the PATH of the workflow's jobs."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from fogreduce.warm import client

#: Set to anything, it keeps every command cold.
OFF = "FOGREDUCE_COLD"
#: Unix sockets have paths of at most 107 bytes.
_LONGEST_PATH = 100

#: The server's standard input: it stays open as long as this process lives, however that ends.
_servers: list[subprocess.Popen[bytes]] = []


def start() -> Path | None:
    """Start a server for the commands of this process's jobs.

    Returns
    -------
    Path or None
        Its private folder; None where it cannot be had or is not wanted: inside a Slurm job, with
        FOGREDUCE_COLD set, or where the machine does not offer what it needs. Commands then run cold, with
        the same results.
    """
    real = shutil.which("fogreduce")
    if (
        OFF in os.environ
        or "SLURM_JOB_ID" in os.environ
        or real is None
        or not sys.platform.startswith("linux")
    ):
        return None
    parent = _parent()
    try:
        sweep(parent)
        folder = Path(tempfile.mkdtemp(prefix=f"{_prefix()}{os.getpid()}-", dir=parent))  # mode 0700
    except OSError:
        return None
    if not _made(folder / "fogreduce", Path(real).absolute()):
        shutil.rmtree(folder, ignore_errors=True)
        return None
    with (folder / "log").open("wb") as log:
        server = subprocess.Popen(
            [real, "server", folder],
            stdin=subprocess.PIPE,
            stdout=log,
            stderr=log,
            start_new_session=True,  # Ctrl-C is for the workflow to pass on
        )
    _servers.append(server)
    os.environ["PATH"] = os.pathsep.join([str(folder), os.environ.get("PATH", os.defpath)])
    return folder


def _made(script: Path, real: Path) -> bool:
    """Write the client; False where it, or a socket beside it, would not work."""
    if len(os.fsencode(script)) > _LONGEST_PATH or re.search(r"\s", sys.executable):
        return False
    source = Path(client.__file__).read_text(encoding="utf-8")
    try:
        script.write_text(f"#!{sys.executable} -IS\n{source}", encoding="utf-8")
        script.chmod(0o700)
        script.with_name(client.REAL).symlink_to(real)
    except OSError:
        return False
    return os.access(script, os.X_OK)  # not where nothing may be executed


def _parent() -> Path:
    return Path(os.environ.get("XDG_RUNTIME_DIR") or tempfile.gettempdir())


def _prefix() -> str:
    return f"fogreduce-{os.getuid()}-"


def sweep(parent: Path) -> None:
    """Remove the folders that servers left behind whose workflow is dead."""
    for folder in parent.glob(f"{_prefix()}*"):
        pid = folder.name.removeprefix(_prefix()).split("-")[0]
        is_ours = not folder.is_symlink() and folder.is_dir() and folder.stat().st_uid == os.getuid()
        if is_ours and pid.isdigit() and not Path("/proc", pid).exists():
            shutil.rmtree(folder, ignore_errors=True)
