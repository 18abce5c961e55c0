"""Conditions on parts of the boundary."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Union

from .values import Field, Pair, VectorField


@dataclass(frozen=True)
class Fixed:
    """u = `value`."""

    type: ClassVar[str] = "fixed"
    value: VectorField | None = None  #: a length; default 0


@dataclass(frozen=True)
class Roller:
    """u·n = 0 and no tangential stress; elasticity only."""

    type: ClassVar[str] = "roller"


@dataclass(frozen=True)
class Traction:
    """σn = `value`, or for an elastic body σn = −`pressure` n; not both."""

    type: ClassVar[str] = "traction"
    value: VectorField | None = None  #: force per area; default 0
    pressure: Field | None = None  #: force per area


@dataclass(frozen=True)
class Contact:
    """Contact without friction: u_n ≤ g, σ_n ≤ 0, (u_n − g) σ_n = 0."""

    type: ClassVar[str] = "contact"
    gap: Field | None = None  #: g, a length; negative is an overlap; default 0
    direction: Pair | None = None  #: along which gap and reaction are measured; elasticity only


Condition = Union[Fixed, Roller, Traction, Contact]
