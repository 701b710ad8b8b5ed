"""Plain values of anything: what JSON and TOML can hold."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from enum import Enum
from typing import Any

import numpy as np


def without_nan(value: Any) -> Any:
    """``value`` with None in place of NaN, tuples as lists."""
    if isinstance(value, dict):
        return {name: without_nan(part) for name, part in value.items()}
    if isinstance(value, (list, tuple)):
        return [without_nan(part) for part in value]
    return none_for_nan(value)


def none_for_nan(value: Any) -> Any:
    """``value``, but None for NaN, which JSON does not know."""
    return None if isinstance(value, float) and math.isnan(value) else value


def plain(value: Any) -> Any:
    """``value`` of numbers, texts, lists and dictionaries only."""
    if isinstance(value, Enum):
        return value.name.lower().replace("_", "-")
    if isinstance(value, np.generic):
        return value.item()
    if hasattr(value, "_asdict"):
        return plain(value._asdict())
    if isinstance(value, Mapping):
        return {str(key): plain(part) for key, part in value.items()}
    if isinstance(value, (Sequence, np.ndarray)) and not isinstance(value, (str, bytes)):
        return [plain(part) for part in value]
    return value if value is None or isinstance(value, (bool, int, float, str)) else repr(value)


def as_plain(record: Any) -> dict[str, Any]:
    """The dataclass as plain values, NaN as None; estimates by the names of their parts."""
    plain_record: dict[str, Any] = without_nan(asdict(record, dict_factory=_by_name))
    return plain_record


def _by_name(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    return {name: _named(value) for name, value in pairs}


def _named(value: Any) -> Any:
    if hasattr(value, "_asdict"):
        return value._asdict()
    if isinstance(value, dict):
        return {name: _named(part) for name, part in value.items()}
    return [_named(part) for part in value] if isinstance(value, (list, tuple)) else value
