"""Values that members of a problem can take."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Union

from .arrays import Integers, Reals

#: Two numbers, x and y.
Pair = Sequence[float]
#: A number, or an expression of x and y, on a boundary also of the outward normal nx, ny: "x < 0.5 ? 10 : -10".
Field = Union[float, str]
#: A field for a membrane, a pair of fields for an elastic body.
VectorField = Union[Field, Sequence[Field]]
#: Rows of numbers.
Points = Union[Sequence[Pair], Reals]
#: Rows of numbers of points.
Indices = Union[Sequence[Sequence[int]], Integers]
