"""What the body is made of."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, Union

from .values import Field


@dataclass(frozen=True)
class MembraneMaterial:
    """κ in σ = κ ∇u, force per length: a field, or a symmetric 2×2 matrix of fields."""

    stiffness: Field | Sequence[Sequence[Field]]


@dataclass(frozen=True)
class YoungPoisson:
    """An isotropic elastic material."""

    young: Field  #: Young's modulus, force per area
    poisson: Field  #: Poisson's ratio, between −1 and 1/2
    plane: Literal["strain", "stress"] | None = None  #: default `strain`


@dataclass(frozen=True)
class HookeTensor:
    """Any elastic material: the symmetric 3×3 matrix in the order xx, yy, xy with engineering shear strain."""

    tensor: Sequence[Sequence[Field]]  #: force per area


Material = Union[MembraneMaterial, YoungPoisson, HookeTensor]
