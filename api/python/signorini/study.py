"""The problem again on other meshes and by other schemes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from .mesh_request import Adaptive
from .values import Field, VectorField


@dataclass(frozen=True, kw_only=True)
class Exact:
    """What is known of the exact solution."""

    displacement: VectorField | None = None  #: u, a length
    stress: Sequence[Field] | None = None  #: [qx, qy] or [xx, yy, xy], force per area
    energy: float | None = None  #: J(u), force times length per thickness


@dataclass(frozen=True, kw_only=True)
class Study:
    """Exactly one of `divisions`, `sizes`, `refine` and `adaptive` is the list of meshes."""

    schemes: Sequence[Literal["conforming", "nonconforming"]] | None = None  #: default: that of the problem
    divisions: Sequence[int | Sequence[int]] | None = None  #: of a rectangle; n stands for (n, n)
    sizes: Sequence[float] | None = None  #: largest edges, lengths
    refine: Sequence[int] | None = None  #: numbers of refinements
    adaptive: Adaptive | None = None  #: a row a level
    exact: Exact | None = None
    check: Sequence[Literal["inf_sup"]] | None = None  #: what else each row has
