"""From pydantic's errors to faults: one line each, with the key's dotted path, in plain words."""

from __future__ import annotations

import difflib
import os
import typing
from collections.abc import Sized
from typing import Any

from pydantic import BaseModel, ValidationError
from pydantic_core import PydanticCustomError

from fogreduce.errors import Fault
from fogreduce.metadata.patterns import IN_WORDS
from fogreduce.metadata.words import kind_of


def unexpected(expected: str, *, found: str = "", key: str = "") -> PydanticCustomError:
    """What a validator raises, in plain words.

    Parameters
    ----------
    expected : str
        What should stand there.
    found : str
        What does, where the value itself does not say it.
    key : str
        The key to blame, below the place of the validator, where it looks at several.
    """
    return contradictions([(key, found, expected)])


def contradictions(wrong: list[tuple[str, str, str]]) -> PydanticCustomError:
    """The same for several faults at once, each (key, found, expected)."""
    return PydanticCustomError("unexpected", "several values do not fit together", {"wrong": wrong})


def faults_of(
    error: ValidationError, file: str | os.PathLike[str], model: type[BaseModel] | None = None
) -> list[Fault]:
    """One Fault for each of pydantic's errors, with the key's dotted path, in plain words.

    Parameters
    ----------
    error : ValidationError
        What pydantic raised.
    file : path
        The file at fault.
    model : type, optional
        The model that was validated: lets an unknown key be answered with the known ones.
    """
    faults = []
    for item in error.errors(include_url=False):
        location = tuple(part for part in item["loc"] if part != "[key]")
        if item["type"] == "unexpected":
            for key, found, expected in item["ctx"]["wrong"]:
                where = dotted((*location, key) if key else location)
                faults.append(Fault(os.fspath(file), where, found or kind_of(item["input"]), expected))
            continue
        if item["type"] == "too_short" and len(item["input"]) >= item["ctx"]["min_length"]:
            continue  # pydantic counts only the entries without a fault of their own
        found, expected = _found_and_expected(
            item["type"], item["input"], item.get("ctx", {}), location, model
        )
        if item["loc"][-1:] == ("[key]",):
            found = f"the key {location[-1]}"
        faults.append(Fault(os.fspath(file), dotted(location), found, expected))
    return faults


def dotted(location: tuple[int | str, ...]) -> str:
    """``("table", "profile", 0, "rate_deg_s")`` as ``table.profile[0].rate_deg_s``."""
    text = ""
    for part in location:
        text += f"[{part}]" if isinstance(part, int) else f".{part}" if text else str(part)
    return text


_TYPES = {
    "float_type": "a number",
    "int_type": "a whole number",
    "int_from_float": "a whole number",
    "float_parsing": "a number",
    "int_parsing": "a whole number",
    "bool_type": "true or false",
    "bool_parsing": "true or false",
    "string_type": "text (quote it if it looks like a number)",
    "list_type": "a list",
    "tuple_type": "a list",
    "dict_type": "a mapping",
    "model_type": "a mapping",
    "finite_number": "a finite number",
}
_BOUNDS = {
    "greater_than": ("gt", "more than"),
    "greater_than_equal": ("ge", "at least"),
    "less_than": ("lt", "less than"),
    "less_than_equal": ("le", "at most"),
}


def _found_and_expected(
    kind: str,
    value: object,
    context: dict[str, Any],
    location: tuple[int | str, ...],
    model: type[BaseModel] | None,
) -> tuple[str, str]:
    """A pydantic error in plain words."""
    found = kind_of(value)
    if kind == "missing":
        what = "one entry more" if isinstance(location[-1], int) else "this key (it is required)"
        return "nothing", _described(model, location) or what
    if kind == "extra_forbidden":
        return _unknown_key(model, location)
    if kind in _TYPES:
        return found, _TYPES[kind]
    if kind in _BOUNDS:
        name, words = _BOUNDS[kind]
        return found, f"a number, {words} {context[name]:g}"
    if kind == "literal_error":
        return found, str(context["expected"]).replace("'", "")
    if kind == "string_pattern_mismatch":
        return found, IN_WORDS[context["pattern"]]
    if kind in ("too_short", "too_long"):
        bound = "at least" if kind == "too_short" else "at most"
        length = len(value) if isinstance(value, Sized) else context["actual_length"]
        return f"{length} entries", f"{bound} {context.get('min_length', context.get('max_length'))}"
    if kind == "string_too_long":
        return found, f"text of at most {context['max_length']} characters"
    return found, kind.replace("_", " ")


def _model_at(model: type[BaseModel] | None, location: tuple[int | str, ...]) -> type[BaseModel] | None:
    """The model that validates what lies at `location` below `model`."""
    for part in location:
        if isinstance(part, int) or model is None:
            continue
        fields = {info.alias or name: info for name, info in model.model_fields.items()}
        model = _model_in(fields[part].annotation) if part in fields else None
    return model


def _model_in(annotation: object) -> type[BaseModel] | None:
    """The first model named in a type such as ``tuple[Step, ...] | None``."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    for argument in typing.get_args(annotation):
        if found := _model_in(argument):
            return found
    return None


def _unknown_key(model: type[BaseModel] | None, location: tuple[int | str, ...]) -> tuple[str, str]:
    parent = _model_at(model, location[:-1])
    if parent is None:
        return "an unknown key", "no such key"
    keys = [info.alias or name for name, info in parent.model_fields.items()]
    close = difflib.get_close_matches(str(location[-1]), keys, n=1, cutoff=0.5)
    hint = f" (did you mean {close[0]}?)" if close else ""
    return f"an unknown key{hint}", "one of " + ", ".join(keys)


def _described(model: type[BaseModel] | None, location: tuple[int | str, ...]) -> str:
    parent = _model_at(model, location[:-1])
    for name, info in parent.model_fields.items() if parent else ():
        if (info.alias or name) == location[-1] and info.description:
            return " ".join(info.description.split()).rstrip(".")
    return ""
