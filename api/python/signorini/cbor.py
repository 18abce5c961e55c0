"""Reads CBOR (RFC 8949) with the typed arrays (RFC 8746) that the service writes."""

from __future__ import annotations

import struct
from typing import Any

from .arrays import from_bytes

ROW_MAJOR, INT32, FLOAT64 = 40, 78, 86
_CODES = {INT32: "i4", FLOAT64: "f8"}
_BREAK = object()
_DEEPEST = 64  # values within each other; results have eight


class CborError(ValueError):
    """What was read is no CBOR, or has something in it that the service does not write."""


def loads(document: bytes) -> Any:
    """The value of one CBOR document: dict, list, str, bytes, int, float, bool, None, and arrays.

    Raises CborError if the document is cut off, goes on after its end, or is none.
    """
    reader = _Reader(document)
    value = reader.element()
    if reader.place != len(document):
        raise CborError(f"the document should end at byte {reader.place}")
    return value


def loads_all(sequence: bytes) -> list[Any]:
    """The values of a CBOR sequence (RFC 8742): documents one after the other. Raises CborError."""
    reader = _Reader(sequence)
    values = []
    while reader.place < len(sequence):
        values.append(reader.element())
    return values


class _Reader:
    def __init__(self, document: bytes) -> None:
        self.document = document
        self.place = 0
        self.depth = 0

    def element(self) -> Any:
        """A value that is there, and no end of others."""
        value = self.value()
        if value is _BREAK:
            raise CborError(f"nothing ends at byte {self.place - 1}")
        return value

    def value(self) -> Any:
        if self.depth == _DEEPEST:
            raise CborError(f"at byte {self.place} values are nested too deeply")
        self.depth += 1
        value = self._value()
        self.depth -= 1
        return value

    def _value(self) -> Any:
        initial = self.take(1)[0]
        major, low = initial >> 5, initial & 31
        if major == 7:
            return self.simple(low)
        if low == 31:
            return self.indefinite(major)
        count = self.argument(low)
        if major == 0:
            return count
        if major == 1:
            return -1 - count
        if major == 2:
            return self.take(count)
        if major == 3:
            return self.text(count)
        if major == 4:
            return [self.element() for _ in range(count)]
        if major == 5:
            return _members([self.element() for _ in range(2 * count)])
        return self.tagged(count)

    def take(self, count: int) -> bytes:
        end = self.place + count
        if end > len(self.document):
            raise CborError(f"the document is cut off at byte {len(self.document)}")
        found = self.document[self.place : end]
        self.place = end
        return found

    def text(self, count: int) -> str:
        try:
            return str(self.take(count), "utf-8")
        except UnicodeDecodeError as error:
            raise CborError(f"the text before byte {self.place} is no UTF-8") from error

    def argument(self, low: int) -> int:
        if low < 24:
            return low
        if low > 27:
            raise CborError(f"byte {self.place - 1} begins nothing")
        return int.from_bytes(self.take(1 << (low - 24)), "big")

    def simple(self, low: int) -> Any:
        if low == 31:
            return _BREAK
        if low in (25, 26, 27):
            return struct.unpack({25: ">e", 26: ">f", 27: ">d"}[low], self.take(1 << (low - 24)))[0]
        try:
            return {20: False, 21: True, 22: None, 23: None}[self.argument(low)]
        except KeyError as unknown:
            raise CborError(f"the simple value {unknown} is not known") from None

    def indefinite(self, major: int) -> Any:
        if major not in (2, 3, 4, 5):
            raise CborError(f"byte {self.place - 1} begins nothing")
        pieces: list[Any] = []
        while (piece := self.value()) is not _BREAK:
            pieces.append(piece)
        if major == 5:
            return _members(pieces)
        if major == 4:
            return pieces
        if any(not isinstance(piece, bytes if major == 2 else str) for piece in pieces):
            raise CborError(f"the string before byte {self.place} has pieces that are none")
        return b"".join(pieces) if major == 2 else "".join(pieces)

    def tagged(self, tag: int) -> Any:
        if tag == ROW_MAJOR:
            return self.several_extents()
        if tag in _CODES:
            data = self.data()
            return self.array(tag, data, [len(data) // int(_CODES[tag][1])])
        raise CborError(f"the tag {tag} is not known")

    def several_extents(self) -> Any:
        if self.take(1) != b"\x82":
            raise CborError("an array of several extents is a pair")
        extents = self.value()
        head = self.take(1)[0]
        tag = self.argument(head & 31)
        if head >> 5 != 6 or tag not in _CODES:
            raise CborError("an array of several extents holds a typed array")
        return self.array(tag, self.data(), extents)

    def array(self, tag: int, data: bytes, extents: Any) -> Any:
        try:
            return from_bytes(data, _CODES[tag], _sizes(extents))
        except ValueError as error:
            raise CborError(f"{len(data)} bytes are no array of the extents {extents}") from error

    def data(self) -> bytes:
        data = self.value()
        if not isinstance(data, bytes):
            raise CborError("a typed array is made of bytes")
        return data


def _sizes(extents: Any) -> list[int]:
    if not isinstance(extents, list) or not extents:
        raise ValueError("there are no extents")
    if any(type(size) is not int or not 0 <= size < 1 << 31 for size in extents):
        raise ValueError("an extent is no count")
    return extents


def _members(pieces: list[Any]) -> dict[Any, Any]:
    if len(pieces) % 2 or any(not isinstance(name, (str, int)) for name in pieces[::2]):
        raise CborError("the members of an object have names and values")
    return dict(zip(pieces[::2], pieces[1::2]))
