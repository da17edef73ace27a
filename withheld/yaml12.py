"""YAML whose numbers mean the same to YAML 1.1 and 1.2 readers.

PyYAML follows 1.1, in which `1e-07` is a string.  What is written here always carries a point in the
mantissa and a signed exponent (`1.0e-07`); what is read accepts both forms, and leaves time stamps as text.
"""

import re
from pathlib import Path
from typing import Any

import yaml

from withheld.errors import BadInput

_NUMBER = re.compile(r"^[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?$")


class _Loader(yaml.SafeLoader):
    """Numbers as YAML 1.2 has them; time stamps stay text."""


def _resolvers_without(*tags: str) -> dict[str, list[tuple[str, Any]]]:
    """PyYAML's patterns for plain scalars, by first letter, less those of some tags."""
    return {
        first: [(tag, pattern) for tag, pattern in pairs if not tag.endswith(tags)]
        for first, pairs in yaml.SafeLoader.yaml_implicit_resolvers.items()
    }


_Loader.yaml_implicit_resolvers = _resolvers_without(":timestamp", ":float")
# After the resolver of integers, which is asked first.
_Loader.add_implicit_resolver("tag:yaml.org,2002:float", _NUMBER, list("-+0123456789."))


class _Dumper(yaml.SafeDumper):
    def ignore_aliases(self, data: Any) -> bool:
        return True


# Time stamps are then written plain, as the contract shows them.
_Dumper.yaml_implicit_resolvers = _resolvers_without(":timestamp")


def _represent_float(dumper: yaml.SafeDumper, value: float) -> yaml.Node:
    text = repr(float(value))
    if "e" in text and "." not in text:
        text = text.replace("e", ".0e")
    return dumper.represent_scalar("tag:yaml.org,2002:float", text)


_Dumper.add_representer(float, _represent_float)


def dump(value: Any) -> str:
    """A document of dicts, lists, strings, numbers and booleans as YAML; keys keep their order."""
    return yaml.dump(value, Dumper=_Dumper, sort_keys=False, default_flow_style=None, width=100000)


def load(path: Path) -> Any:
    """The document in `path`."""
    try:
        return yaml.load(path.read_text(), Loader=_Loader)
    except OSError as error:
        raise BadInput(f"{path}: cannot be read ({error.strerror})") from error
    except yaml.YAMLError as error:
        raise BadInput(f"{path}: not YAML ({' '.join(str(error).split())})") from error
