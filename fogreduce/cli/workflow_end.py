"""No command outlives the workflow that it belongs to, however that ends."""

from __future__ import annotations

import os
import select
import signal
import sys
import threading

from fogreduce.datasets.sole_writer import WORKFLOW


def end_with_workflow() -> None:
    """Stop this process, as Ctrl-C does, as soon as the workflow that it belongs to is gone."""
    workflow = os.environ.get(WORKFLOW, "")
    if not workflow.isdecimal() or sys.platform != "linux":
        return
    try:
        handle = os.pidfd_open(int(workflow))
    except ProcessLookupError:
        sys.exit("stopped: its workflow is gone")
    except OSError:
        return  # a system without
    threading.Thread(target=_wait, args=(handle,), daemon=True).start()


def _wait(handle: int) -> None:
    select.select([handle], [], [])
    os.kill(os.getpid(), signal.SIGTERM)
