"""Makes bench_lab.py importable, whatever folder the tests run from."""

import sys
from pathlib import Path

_BUILDERS = str(Path(__file__).parent)
if _BUILDERS not in sys.path:
    sys.path.insert(0, _BUILDERS)
