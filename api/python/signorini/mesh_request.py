"""How fine the mesh is."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from .values import Pair


@dataclass(frozen=True)
class LocalSize:
    """No edge of a triangle that meets the disc is longer than `size`."""

    at: Pair
    radius: float
    size: float


@dataclass(frozen=True)
class Adaptive:
    """An accuracy instead of a mesh."""

    tolerance: float  #: what the relative error bound shall be at most, or the relative width of `quantity`
    max_triangles: int | None = None  #: when to give up; default 100 000
    quantity: str | None = None  #: for which the tolerance is, that of the relative width of its interval


@dataclass(frozen=True, kw_only=True)
class MeshRequest:
    """How fine the mesh is.

    A rectangle needs exactly one of `size` and `divisions`, a polygon `size`, both nothing if the mesh is `adaptive`;
    a domain that brings its mesh needs none of it.
    """

    size: float | None = None  #: the largest edge, a length
    divisions: Sequence[int] | None = None  #: the squares of a rectangle along x and y
    pattern: Literal["right", "left", "alternating", "crossed"] | None = None  #: how squares are cut
    sizes: Sequence[LocalSize] | None = None  #: smaller edges near places of a polygon
    refine: int | None = None  #: uniform refinements, each into four times the triangles
    adaptive: Adaptive | None = None
