"""Documents as JSON and CBOR have them, from and to the dataclasses of this package."""

from __future__ import annotations

import dataclasses
import json
import types
import typing
from collections.abc import Mapping
from typing import Any

from .arrays import array, is_array_kind


def written(value: Any) -> Any:
    """The value as dicts, lists, strings and numbers.

    Of a dataclass every member becomes one of the same name, and those that are None are left out; `type`, where the
    class has one, comes first. Arrays become lists.
    """
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        members = {field.name: getattr(value, field.name) for field in dataclasses.fields(value)}
        kind = getattr(type(value), "type", None)
        named = {"type": kind} if kind else {}
        return named | {name: written(member) for name, member in members.items() if member is not None}
    if isinstance(value, Mapping):
        return {name: written(member) for name, member in value.items()}
    if hasattr(value, "tolist"):
        return value.tolist()
    if isinstance(value, (list, tuple)):
        return [written(element) for element in value]
    return value


def encoded(value: Any) -> bytes:
    """The value as JSON. Raises ValueError if a number in it is not finite."""
    return json.dumps(written(value), allow_nan=False, ensure_ascii=False).encode()


def read(kind: Any, value: Any) -> Any:
    """The value of a document as `kind`: a dataclass, an array, or a tuple or dict of them.

    Members that the dataclass does not name are passed over, those that are missing are None.
    """
    if value is None:
        return None
    if is_array_kind(kind):
        return array(kind, value)
    if dataclasses.is_dataclass(kind):
        return _read_members(kind, value)
    origin, arguments = typing.get_origin(kind), typing.get_args(kind)
    if origin is dict:
        return {name: read(arguments[1], member) for name, member in value.items()}
    if origin is tuple:
        return tuple(read(arguments[0], element) for element in value)
    if origin in (types.UnionType, typing.Union):
        return _read_either([each for each in arguments if each is not type(None)], value)
    return value


def _read_members(kind: Any, value: Mapping[str, Any]) -> Any:
    kinds = typing.get_type_hints(kind)
    return kind(**{field.name: read(kinds[field.name], value.get(field.name)) for field in dataclasses.fields(kind)})


def _read_either(kinds: list[Any], value: Any) -> Any:
    if len(kinds) == 1:
        return read(kinds[0], value)
    if isinstance(value, (int, float, str)):
        return value
    if isinstance(value, Mapping):
        return read(next(kind for kind in kinds if dataclasses.is_dataclass(kind)), value)
    element = next(typing.get_args(kind)[0] for kind in kinds if typing.get_origin(kind) is tuple)
    return tuple(float(each) if element is float else read(element, each) for each in value)
