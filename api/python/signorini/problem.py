"""A contact problem, with the names of its JSON document. What is None is left out, and has the service's default."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from .boundary import Condition
from .document import written
from .domain import Domain
from .material import Material
from .mesh_request import MeshRequest
from .quantity import Quantity
from .study import Study
from .values import VectorField


@dataclass(frozen=True)
class Load:
    """What pulls at the inside of the body."""

    body: VectorField | None = None  #: f, force per volume (for a membrane per area); default 0


@dataclass(frozen=True, kw_only=True)
class Solver:
    """How it is solved."""

    method: Literal["uzawa", "active_set"] | None = None  #: default `uzawa`
    rho: float | Literal["auto"] | None = None  #: the step of the paper's form, length²/modulus
    augmentation: float | Literal["auto"] | None = None  #: the weight of the paper's form, length²/modulus
    initial_displacement: float | None = None  #: where the paper's form starts, a length
    tolerance: float | None = None  #: when `uzawa` stops, relative
    max_iterations: int | None = None
    time_limit: float | None = None  #: seconds of the whole solve


@dataclass(frozen=True, kw_only=True)
class Variation:
    """An entry of a sweep: a merge patch (RFC 7396) of the problem, in whose mappings None takes a member out."""

    title: str | None = None
    load: Load | Mapping[str, Any] | None = None
    material: Material | Mapping[str, Any] | None = None  #: by which the problem is factored anew, on its mesh
    boundary: Mapping[str, Mapping[str, Any]] | None = None  #: part → changes of value, gap or pressure


@dataclass(frozen=True, kw_only=True)
class Problem:
    """A contact problem."""

    title: str | None = None  #: shown in lists
    tags: Sequence[str] | None = None  #: by which solves are found and deleted together
    model: Literal["membrane", "elasticity"]
    domain: Domain
    mesh: MeshRequest | None = None
    material: Material
    load: Load | None = None
    boundary: Mapping[str, Condition]  #: part → condition; `all` names every part that is not named
    scheme: Literal["conforming", "nonconforming"]
    quantities: Sequence[Quantity] | None = None  #: that the result encloses in intervals
    solver: Solver | None = None
    sweep: Sequence[Variation] | None = None  #: other data, solved on the same mesh
    study: Study | None = None

    def document(self) -> dict[str, Any]:
        """The problem as its JSON document."""
        document: dict[str, Any] = written(self)
        return document
