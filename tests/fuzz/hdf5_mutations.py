"""How a dataset is spoilt through HDF5 itself: variables gone, of another kind or shape, links."""

from __future__ import annotations

import io
from collections.abc import Callable, Sequence

import h5py
import numpy as np
from hypothesis import strategies as st

Change = Callable[[h5py.File, str], None]


def _replace(make: Callable[[h5py.File, str, h5py.Dataset], object]) -> Change:
    def change(file: h5py.File, name: str) -> None:
        old = file[name]
        shape, dtype = old.shape, old.dtype
        file.move(name, "old")
        made = make(file, name, file["old"])
        assert made is not None
        assert (shape, dtype) is not None
        del file["old"]

    return change


def _text(file: h5py.File, name: str, old: h5py.Dataset) -> object:
    return file.create_dataset(name, shape=old.shape, dtype=h5py.string_dtype())


def _records(file: h5py.File, name: str, old: h5py.Dataset) -> object:
    return file.create_dataset(name, shape=old.shape, dtype=np.dtype([("a", "<i4"), ("b", "<f8")]))


def _complex(file: h5py.File, name: str, old: h5py.Dataset) -> object:
    return file.create_dataset(name, shape=old.shape, dtype="<c16")


def _scalar(file: h5py.File, name: str, old: h5py.Dataset) -> object:
    return file.create_dataset(name, data=np.zeros((), old.dtype))


def _shorter(file: h5py.File, name: str, old: h5py.Dataset) -> object:
    return file.create_dataset(name, data=old[..., :-7])


def _longer(file: h5py.File, name: str, old: h5py.Dataset) -> object:
    return file.create_dataset(name, shape=(*old.shape[:-1], old.shape[-1] + 9), dtype=old.dtype)


def _none(file: h5py.File, name: str, old: h5py.Dataset) -> object:
    return file.create_dataset(name, shape=(*old.shape[:-1], 0), dtype=old.dtype)


def _null(file: h5py.File, name: str, old: h5py.Dataset) -> object:
    return file.create_dataset(name, data=h5py.Empty(old.dtype))


def _more_dimensions(file: h5py.File, name: str, old: h5py.Dataset) -> object:
    return file.create_dataset(name, data=np.zeros((*old.shape, 2), old.dtype))


def _turned(file: h5py.File, name: str, old: h5py.Dataset) -> object:
    return file.create_dataset(name, data=np.zeros((*old.shape[::-1], 1)[: max(old.ndim, 2)], old.dtype))


def _immense(file: h5py.File, name: str, old: h5py.Dataset) -> object:
    shape = (*old.shape[:-1], 10**12)
    return file.create_dataset(name, shape=shape, dtype=old.dtype, chunks=(1,) * (old.ndim - 1) + (2**20,))


def _group(file: h5py.File, name: str, old: h5py.Dataset) -> object:
    return file.create_group(name)


def _external_link(file: h5py.File, name: str, old: h5py.Dataset) -> object:
    file[name] = h5py.ExternalLink("/etc/passwd", "/x")
    return name


def _soft_link(file: h5py.File, name: str, old: h5py.Dataset) -> object:
    file[name] = h5py.SoftLink("/nowhere")
    return name


def _loop(file: h5py.File, name: str, old: h5py.Dataset) -> object:
    file[name] = h5py.SoftLink("/" + name)
    return name


def _gone(file: h5py.File, name: str) -> None:
    del file[name]


#: Changes after which a variable is not what its stage writes.
CHANGES: list[Change] = [
    _gone,
    *map(_replace, (_text, _records, _complex, _scalar, _shorter, _longer, _none, _null, _more_dimensions)),
    *map(_replace, (_turned, _immense, _group, _external_link, _soft_link, _loop)),
]
_ATTRIBUTES = [np.nan, -1, 2**40, "text", np.arange(3), h5py.Empty("f4"), b"\xff\xfe", ""]


def spoilt(data: bytes, change: Change, name: str) -> bytes:
    """A file of HDF5 after one change to one variable."""
    held = io.BytesIO(data)
    with h5py.File(held, "r+") as file:
        change(file, name)
    return held.getvalue()


@st.composite
def restructured(draw: st.DrawFn, data: bytes, names: Sequence[str]) -> tuple[bytes, list[str]]:
    """A dataset with one of the variables that are read spoilt, or an attribute; what is forbidden in it."""
    name = draw(st.sampled_from(list(names)))
    if draw(st.integers(0, 3)):
        change = draw(st.sampled_from(CHANGES))
        return spoilt(data, change, name), [f"{name} is not as its stage writes it"]
    value = draw(st.sampled_from(_ATTRIBUTES))
    held = io.BytesIO(data)
    with h5py.File(held, "r+") as file:
        if draw(st.booleans()):
            file.attrs["version_id"] = value
            return_value = ["version_id is another"]
        else:
            attributes = file[name].attrs
            key = draw(st.sampled_from(sorted(attributes)))
            del attributes[key]
            attributes[key] = value
            return_value = []
    return held.getvalue(), return_value
