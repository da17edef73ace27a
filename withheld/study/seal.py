"""Seals: lists of hashes, public before what they cover is looked at."""

from pathlib import Path

from withheld.atomic import sha256, write_text
from withheld.errors import BadInput


def write_seal(out: Path, files: list[Path], root: Path) -> None:
    """One line a file, `digest  path under root`, in order of path: the form that `sha256sum -c` reads."""
    lines = [f"{sha256(path)}  {path.relative_to(root).as_posix()}\n" for path in sorted(files)]
    if not lines:
        raise BadInput(f"{out}: nothing to seal")
    write_text(out, "".join(lines))


def check_seal(seal: Path, root: Path) -> list[Path]:
    """The files of a seal, each with the digest that it states; a file that differs is bad input, by name."""
    try:
        lines = seal.read_text().splitlines()
    except OSError as error:
        raise BadInput(f"{seal}: cannot be read ({error.strerror})") from error
    files = []
    for line in lines:
        digest, _, name = line.partition("  ")
        path = root / name
        if sha256(path) != digest:
            raise BadInput(f"{path}: is not what {seal} sealed; a study is void once that happens")
        files.append(path)
    return files
