"""The shape of the body, and the names of the parts of its boundary."""

from __future__ import annotations

import os
import pathlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar, Union

from .values import Indices, Pair, Points


@dataclass(frozen=True)
class Rectangle:
    """A rectangle along the axes, with the parts `left`, `right`, `bottom`, `top`."""

    type: ClassVar[str] = "rectangle"
    origin: Pair | None = None  #: the lower left corner; default (0, 0)
    size: Pair | None = None  #: width and height; default (1, 1)


@dataclass(frozen=True)
class Arc:
    """The arc of a circle from a vertex to the next one."""

    centre: Pair
    long: bool | None = None  #: the longer of the two arcs


@dataclass(frozen=True)
class Vertex:
    """A vertex from which the edge to the next one may be an arc."""

    at: Pair
    arc: Arc | None = None


@dataclass(frozen=True)
class Circle:
    """A circle."""

    centre: Pair
    radius: float


@dataclass(frozen=True)
class CircularHole:
    """A hole that is a circle."""

    circle: Circle


#: The vertices of a closed ring, either way round.
Ring = Sequence[Union[Pair, Vertex]]


@dataclass(frozen=True)
class Polygon:
    """A polygon whose edges may be arcs, with holes; their parts are `hole0`, `hole1`, …"""

    type: ClassVar[str] = "polygon"
    vertices: Ring
    holes: Sequence[Ring | CircularHole] | None = None
    sides: Sequence[str] | None = None  #: the part of each edge; default `side0`, `side1`, …


@dataclass(frozen=True)
class GivenMesh:
    """A mesh of the client's own."""

    type: ClassVar[str] = "mesh"
    points: Points  #: (n, 2), lengths
    triangles: Indices  #: (m, 3), numbers of points from 0, either way round
    boundary: Mapping[str, Indices]  #: part → (k, 2), its edges; every boundary edge in one part


@dataclass(frozen=True)
class Gmsh:
    """A mesh of Gmsh; its physical groups of lines are the parts."""

    type: ClassVar[str] = "gmsh"
    msh: str  #: the text of an ASCII .msh file, version 2.2 or 4.1

    @classmethod
    def from_file(cls, path: str | os.PathLike[str]) -> Gmsh:
        """The mesh of a .msh file. Raises OSError if it cannot be read."""
        return cls(pathlib.Path(path).read_text(encoding="utf-8"))


Domain = Union[Rectangle, Polygon, GivenMesh, Gmsh]
