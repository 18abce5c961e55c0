"""Numbers that a result encloses in guaranteed intervals."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, Union

from .values import Pair


@dataclass(frozen=True, kw_only=True)
class Weight:
    """A function along a part, by points on it; exactly one of its members."""

    linear: Sequence[Sequence[float]] | None = None  #: two points with the weights there, (x, y, w)
    hat: Sequence[Pair] | None = None  #: three points: 0, 1 and 0 there, 0 beyond
    trapezoid: Sequence[Pair] | None = None  #: four points: 0, 1, 1 and 0 there, 0 beyond


@dataclass(frozen=True)
class Disc:
    """A disc in the body."""

    centre: Pair
    radius: float  #: a length


@dataclass(frozen=True)
class PressureForce:
    """∫ w p over a contact part."""

    type: ClassVar[str] = "pressure_force"
    name: str  #: by which it is found in the result
    part: str  #: one with a contact
    weight: Weight | None = None  #: w; 1 on the whole part if it is left out


@dataclass(frozen=True)
class Opening:
    """∫ w λ over a contact part, λ the clearance."""

    type: ClassVar[str] = "opening"
    name: str  #: by which it is found in the result
    part: str  #: one with a contact
    weight: Weight | None = None  #: w; 1 on the whole part if it is left out


@dataclass(frozen=True)
class SupportReaction:
    """What a support exerts on the body: of an elastic body along `direction` or `about` a point."""

    type: ClassVar[str] = "reaction"
    name: str  #: by which it is found in the result
    part: str  #: one that is fixed or on rollers
    direction: Pair | None = None  #: elasticity only; of any length
    about: Pair | None = None  #: the point of the moment; elasticity only


@dataclass(frozen=True)
class MeanDisplacement:
    """The mean of u along `direction` over a part of the boundary, a disc or a polygon, exactly one of them."""

    type: ClassVar[str] = "mean_displacement"
    name: str  #: by which it is found in the result
    part: str | None = None  #: one that is free or has a traction
    disc: Disc | None = None
    polygon: Sequence[Pair] | None = None  #: the corners of one in the body
    direction: Pair | None = None  #: for an elastic body, which needs one; of any length


Quantity = Union[PressureForce, Opening, SupportReaction, MeanDisplacement]
