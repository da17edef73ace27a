"""Makes simulated_runs.py and bench_lab.py importable, whatever folder the tests run from."""

import sys
from pathlib import Path

for _folder in ("simulate", "diagnosis"):
    _BUILDERS = str(Path(__file__).parents[1] / _folder)
    if _BUILDERS not in sys.path:
        sys.path.insert(0, _BUILDERS)
