"""``snakemake --lint``, two of its wishes aside.

All rules share one software environment.  And the folder of a run is written as a pattern, not derived from
an output by a function: Snakemake calls that for each job, at a third of a millisecond.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

ASIDE = (
    "Specify a conda environment or container for each rule.",
    "Param out is a prefix of input or output file but hardcoded",
)


def main() -> int:
    """Exit status 0 where nothing but the aside is wished for."""
    snakemake = Path(sys.executable).with_name("snakemake")
    done = subprocess.run([snakemake, "--lint"], capture_output=True, text=True, check=False)
    text = done.stdout + done.stderr
    if "Lints for" not in text and "Congratulations" not in text:
        print(text, file=sys.stderr)
        return 1
    place, wishes = "", []
    for line in text.splitlines():
        if line.startswith("Lints for "):
            place = line.removeprefix("Lints for ")
        elif line.startswith("    * ") and not any(wish in line for wish in ASIDE):
            wishes.append(f"{place} {line.strip(' *')}")
    print("\n".join(wishes) or "snakemake --lint: nothing to wish for", file=sys.stderr)
    return 1 if wishes else 0


if __name__ == "__main__":
    sys.exit(main())
