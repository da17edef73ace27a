"""Which of the package's modules a piece of work uses, and a hash of what they say.

The modules are found from their imports, those inside functions and those named in a string among them;
nobody keeps a list.  Comments, docstrings and blank lines do not count: editing one changes no number.  It is
done with regular expressions, faster than a parser, since every command that writes a manifest does it; a
test holds it against Python's own parser on every module of the package.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from functools import cache
from hashlib import sha256
from pathlib import Path

import fogreduce
from fogreduce.provenance.digest import file_digest

#: What the numbers of a reduction come from: how a manifest is made, and the stages.
REDUCTION = ("fogreduce.provenance.manifest", "fogreduce.stages.run")

_STRING = r'"{3}(?:[^\\"]++|\\.|"(?!""))*"{3}|\'{3}(?:[^\\\']++|\\.|\'(?!\'\'))*\'{3}'
_STRING += r'|"(?:[^"\\\n]++|\\.)*"|\'(?:[^\'\\\n]++|\\.)*\''
_TOKEN = re.compile(_STRING + r"|\#[^\n]*", re.DOTALL)
_OPENS = re.compile(r"\s*(?:class|def|async def|\)).*:$")
_ONLY_A_STRING = re.compile(rf"\s*[rR]?(?:{_STRING})$", re.DOTALL)
_TYPES_ONLY = re.compile(r"^if TYPE_CHECKING:\n(?:[ \t]+.*\n?)+", re.MULTILINE)
_IMPORT = re.compile(
    r"^(?P<indent>[ \t]*)(?:from (?P<module>fogreduce[\w.]*) import (?P<names>\([^)]*\)|.+)"
    r"|import (?P<plain>fogreduce[\w.]*))",
    re.MULTILINE,
)
_NAMED = re.compile(r"""["'](fogreduce(?:\.\w+)+)["']""")
_LINE_END_IN_STRING = "\0"
_LARGEST_SOURCE_BYTES = 1 << 22


def meaning(source: str) -> str:
    """A module's source without comments, docstrings (made empty) and blank lines."""

    def kept(match: re.Match[str]) -> str:
        text = match[0]
        return "" if text.startswith("#") else text.replace("\n", _LINE_END_IN_STRING)

    lines: list[str] = []
    for line in _TOKEN.sub(kept, source).split("\n"):
        text = line.rstrip()
        if not text:
            continue
        if (not lines or _OPENS.match(lines[-1])) and _ONLY_A_STRING.match(text):
            text = text[: len(text) - len(text.lstrip())] + '""'
        lines.append(text)
    return "\n".join(lines).replace(_LINE_END_IN_STRING, "\n") + "\n"


def imports(text: str, *, only_at_top: bool = False) -> set[str]:
    """Dotted names below ``fogreduce`` that a module's `meaning` imports, or names in a string.

    A name that is imported from a module comes as ``module.name``, which need not be a module.
    """
    text = _TYPES_ONLY.sub("", text)
    found: set[str] = set()
    for match in _IMPORT.finditer(text):
        if match["indent"] and only_at_top:
            continue
        if match["plain"]:
            found.add(match["plain"])
            continue
        found.add(match["module"])
        for name in match["names"].strip("()").replace("\n", " ").split(","):
            if name.strip():
                found.add(f"{match['module']}.{name.split()[0]}")
    return found | set(_NAMED.findall(text))


@cache
def _read(path: Path, size: int, time_ns: int) -> tuple[str, frozenset[str]]:
    """Hash of a module's meaning, and what it imports; read again only where the file was written anew."""
    if size > _LARGEST_SOURCE_BYTES:  # no module, but what a stranger put in its place
        return file_digest(path), frozenset()
    text = meaning(path.read_bytes().decode("utf-8", "surrogateescape"))
    # The package itself imports its view of results only for who asks for it by name.
    top = path.parent.name == "fogreduce" and path.name == "__init__.py"
    digest = sha256(text.encode("utf-8", "surrogateescape")).hexdigest()
    return digest, frozenset(imports(text, only_at_top=top))


def _source(path: Path) -> tuple[str, frozenset[str]]:
    found = path.stat()
    return _read(path, found.st_size, found.st_mtime_ns)


def modules_used(*entries: str) -> dict[str, Path]:
    """The modules that some modules use, they themselves and the packages around them among them.

    Parameters
    ----------
    *entries : str
        Dotted names of modules below ``fogreduce``.

    Returns
    -------
    dict
        Path of each source by its name below the folder ``fogreduce`` (``stages/fit.py``), in order.

    Raises
    ------
    ValueError
        No such module.
    """
    root = Path(fogreduce.__file__).parent
    found: dict[str, Path] = {}
    todo = list(entries)
    seen: set[str] = set()
    while todo:
        dotted = todo.pop()
        if dotted in seen:
            continue
        seen.add(dotted)
        path = _path(root, dotted)
        if path is None:
            if dotted in entries:
                raise ValueError(f"{dotted}: found no such module; expected one of fogreduce")
            continue
        found[path.relative_to(root).as_posix()] = path
        todo += _source(path)[1]
        if "." in dotted:
            todo.append(dotted.rpartition(".")[0])
    return dict(sorted(found.items()))


@cache
def _path(root: Path, dotted: str) -> Path | None:
    """The file of a module, None for a name that is none."""
    path = root.joinpath(*dotted.split(".")[1:])
    for file in (path.with_name(path.name + ".py"), path / "__init__.py"):
        if file.is_file():
            return file
    return None


def code_digest(*entries: str) -> str:
    """SHA-256 of what the modules that some modules use say; of a reduction where none is named."""
    sources = modules_used(*(entries or REDUCTION))
    return digest_of(sources, sources)


def digest_of(sources: Mapping[str, Path], parts: Iterable[str]) -> str:
    """SHA-256 of what some sources say.

    Parameters
    ----------
    sources : mapping
        Files by their names below the folder ``fogreduce``.
    parts : iterable of str
        Names of those that count; one that is not there does not.
    """
    digest = sha256()
    for name in sorted(parts):
        if name in sources:
            digest.update(name.encode() + b"\0" + bytes.fromhex(_source(sources[name])[0]))
    return digest.hexdigest()


def reduction_parts() -> list[str]:
    """Names of the sources that a reduction's numbers come from."""
    return list(modules_used(*REDUCTION))
