"""The errors that a user sees: one line each, naming where, what was found and what was expected."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Fault:
    """One thing that is wrong with an input.

    Attributes
    ----------
    file : str
        Path of the file (or folder) at fault, as the user would type it.
    where : str
        Key (``table.profile[0].rate_deg_s``), line (``line 7``) or byte offset (``byte 64``); empty
        for the file as a whole.
    found, expected : str
        What stands there, and what should.
    """

    file: str
    where: str
    found: str
    expected: str

    def __str__(self) -> str:
        place = f"{self.file}: {self.where}" if self.where else self.file
        text = f"{place}: found {self.found.strip() or 'nothing'}; expected {self.expected}"
        # On one line, and nothing in it that a terminal would obey: names and bytes come from anywhere.
        text = " ".join(text.split())
        return text if text.isprintable() else "".join(map(_shown, text))


def _shown(character: str) -> str:
    return character if character.isprintable() else character.encode("unicode_escape").decode()


class FogreduceError(Exception):
    """Base of all errors raised on purpose. Exit status 1 unless a subclass says otherwise."""

    exit_status = 1


class BadInput(FogreduceError):
    """Input or usage that cannot be used: carries one or more faults. Exit status 2."""

    exit_status = 2

    def __init__(self, *faults: Fault) -> None:
        self.faults = faults
        super().__init__("\n".join(str(fault) for fault in faults))

    def __reduce__(self) -> tuple[type[BadInput], tuple[Fault, ...]]:
        return type(self), self.faults

    @classmethod
    def at(cls, file: object, where: str, *, found: object, expected: object) -> BadInput:
        """One fault, its parts turned into text."""
        return cls(Fault(str(file), where, str(found), str(expected)))
