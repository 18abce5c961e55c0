"""Documents as JSON and CBOR have them, from and to the dataclasses of this package."""

from __future__ import annotations

import dataclasses
import json
import math
import reprlib
import types
import typing
from collections.abc import Mapping
from typing import Any

from .arrays import array, is_array_kind
from .errors import BadReply


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
        return {_name(name): written(member) for name, member in value.items()}
    if hasattr(value, "tolist"):
        return value.tolist()
    if isinstance(value, (list, tuple)):
        return [written(element) for element in value]
    return value


def _name(name: Any) -> str:
    if not isinstance(name, str):
        raise TypeError(f"the names of members are texts, and {name!r} is none")
    return name


def encoded(value: Any) -> bytes:
    """The value as JSON.

    Raises ValueError for a number that is not finite and a text that is no Unicode, TypeError for what JSON does not
    have; both say where it stands, as a JSON pointer.
    """
    try:
        document = written(value)
    except RecursionError:
        raise ValueError("it is nested too deeply, or contains itself") from None
    try:
        return json.dumps(document, allow_nan=False, ensure_ascii=False).encode()
    except RecursionError:
        raise ValueError("it is nested too deeply") from None
    except (TypeError, ValueError) as error:
        raise _fault(document, "") or error from None


def is_unicode(text: str) -> bool:
    """Whether the text has no half of a character of two (a surrogate)."""
    try:
        text.encode()
    except UnicodeEncodeError:
        return False
    return True


def _fault(value: Any, place: str) -> Exception | None:
    """The first thing in a document that JSON does not have."""
    if isinstance(value, dict):
        return next((fault for name in value if (fault := _fault_of_member(value[name], place, name))), None)
    if isinstance(value, list):
        return next((fault for i, each in enumerate(value) if (fault := _fault(each, f"{place}/{i}"))), None)
    if isinstance(value, str):
        return None if is_unicode(value) else ValueError(f"{place}: {value!r} is no Unicode")
    if isinstance(value, float):
        return None if math.isfinite(value) else ValueError(f"{place}: {value} is no finite number")
    if value is None or isinstance(value, int):
        return None
    return TypeError(f"{place}: JSON has nothing like {type(value).__name__}")


def _fault_of_member(value: Any, place: str, name: str) -> Exception | None:
    if not is_unicode(name):
        return ValueError(f"{place}: {name!r} is no Unicode")
    return _fault(value, f"{place}/{name.replace('~', '~0').replace('/', '~1')}")


def read(kind: Any, value: Any) -> Any:
    """The value of a document as `kind`: a dataclass, an array, or a tuple or dict of them.

    Members that the dataclass does not name are passed over, those that are missing are None. Raises BadReply if the
    document is built otherwise.
    """
    try:
        return _read(kind, value)
    except (TypeError, ValueError, AttributeError, OverflowError) as error:
        name = getattr(kind, "__name__", str(kind))
        raise BadReply(f"this is no {name}: {reprlib.repr(value)}") from error


def _read(kind: Any, value: Any) -> Any:
    if value is None:
        return None
    if is_array_kind(kind):
        return array(kind, value)
    if dataclasses.is_dataclass(kind):
        return _read_members(kind, value)
    origin, arguments = typing.get_origin(kind), typing.get_args(kind)
    if origin is dict:
        return {name: _read(arguments[1], member) for name, member in value.items()}
    if origin is tuple:
        return tuple(_read(arguments[0], element) for element in value)
    if origin in (types.UnionType, typing.Union):
        return _read_either([each for each in arguments if each is not type(None)], value)
    return value


def _read_members(kind: Any, value: Mapping[str, Any]) -> Any:
    kinds = typing.get_type_hints(kind)
    return kind(**{field.name: _read(kinds[field.name], value.get(field.name)) for field in dataclasses.fields(kind)})


def _read_either(kinds: list[Any], value: Any) -> Any:
    if len(kinds) == 1:
        return _read(kinds[0], value)
    if isinstance(value, (int, float, str)):
        return value
    if isinstance(value, Mapping):
        return _read(_only([kind for kind in kinds if dataclasses.is_dataclass(kind)]), value)
    element = _only([typing.get_args(kind)[0] for kind in kinds if typing.get_origin(kind) is tuple])
    return tuple(float(each) if element is float else _read(element, each) for each in value)


def _only(kinds: list[Any]) -> Any:
    if not kinds:
        raise TypeError("it is of none of the kinds")
    return kinds[0]
