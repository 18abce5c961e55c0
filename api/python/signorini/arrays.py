"""Arrays of a result: NumPy's where NumPy is there, else lists within lists."""

from __future__ import annotations

import math
import struct
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

try:
    import numpy
except ImportError:
    numpy = None  # type: ignore[assignment]

if TYPE_CHECKING:
    from numpy import bool_, float64, int32
    from numpy.typing import NDArray

    Reals = NDArray[float64]
    Integers = NDArray[int32]
    Flags = NDArray[bool_]
else:

    class Reals:
        """An array of double precision numbers."""

    class Integers:
        """An array of 32-bit integers."""

    class Flags:
        """An array of truth values."""


_CODES = {"f8": "d", "i4": "i"}  # of the module struct
_TYPES = {Reals: "float64", Integers: "int32", Flags: "bool"}


def is_array_kind(kind: object) -> bool:
    """Whether `kind` is `Reals`, `Integers` or `Flags`."""
    return any(kind is known for known in _TYPES)


def array(kind: Any, values: Any) -> Any:
    """The values, lists within lists or an array already, as an array of `Reals`, `Integers` or `Flags`."""
    return values if numpy is None else numpy.asarray(values, _TYPES[kind])


def from_bytes(data: bytes, code: str, extents: Sequence[int]) -> Any:
    """The numbers of a typed array, row by row.

    `code` is `f8` or `i4`, as NumPy has it; the bytes are in little endian order. An array of NumPy can be written to.
    Raises ValueError if the bytes are not as many as the extents say.
    """
    count = math.prod(extents)
    if len(data) != count * int(code[1]):
        raise ValueError(f"{len(data)} bytes are not {count} numbers")
    if numpy is not None:
        return numpy.frombuffer(data, f"<{code}").reshape(extents).copy()
    return _nested(struct.unpack(f"<{count}{_CODES[code]}", data), extents)


def _nested(numbers: Sequence[Any], extents: Sequence[int]) -> list[Any]:
    if len(extents) == 1:
        return list(numbers)
    step = len(numbers) // extents[0] if extents[0] else 0
    return [_nested(numbers[i * step : (i + 1) * step], extents[1:]) for i in range(extents[0])]
