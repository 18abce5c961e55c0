"""The fields of a result. Without NumPy the arrays are lists within lists."""

from __future__ import annotations

from dataclasses import dataclass

from .arrays import Flags, Integers, Reals


@dataclass(frozen=True)
class Mesh:
    """The mesh that was used."""

    points: Reals  #: (n, 2), lengths
    triangles: Integers  #: (m, 3), numbers of points, counterclockwise
    boundary: dict[str, Integers]  #: part → (k, 2), its edges as pairs of numbers of points


@dataclass(frozen=True)
class DisplacementField:
    """u_h, lengths. A value is a number for a membrane, and has the last extent 2 for an elastic body."""

    space: str  #: `P0` or `P1` (linear in each triangle, with jumps between them)
    values: Reals  #: (m,) or (m, 2) for P0; (m, 3) or (m, 3, 2), the corners, for P1
    at_points: Reals  #: (n,) or (n, 2), a continuous reconstruction for pictures


@dataclass(frozen=True)
class StressField:
    """σ_h, force per area."""

    space: str  #: `RT0` or `RT1`
    at_centroids: Reals  #: (m, 2), qx and qy of a membrane; (m, 3), xx, yy and xy of an elastic body


@dataclass(frozen=True)
class LevelFields:
    """What is seen of a level of an adaptive mesh."""

    level: int  #: its number in `Levels.level`
    points: Reals  #: (n, 2), lengths
    triangles: Integers  #: (m, 3), numbers of points
    displacement_at_points: Reals  #: (n,) or (n, 2)
    error_squares: Reals  #: (m,), what each triangle adds to the square of the error bound


@dataclass(frozen=True)
class ContactPart:
    """One part of the contact boundary: a row a contact edge (nonconforming) or a node (conforming)."""

    points: Reals  #: (k, 2), lengths
    clearance: Reals  #: (k,), λ = g − u_n ≥ 0, lengths
    pressure: Reals  #: (k,), −σ_n ≥ 0, force per area
    gap: Reals  #: (k,), g, lengths
    open: Flags  #: (k,), λ > 0


@dataclass(frozen=True)
class History:
    """Columns by iteration; residuals are relative."""

    iteration: Integers  #: from 1
    displacement_change: Reals | None  #: Σ|uᵐ⁺¹ − uᵐ| / Σ|uᵐ⁺¹|, for the paper's iteration only
    clearance_change: Reals  #: the same of the clearance
    equilibrium: Reals  #: ‖div σ + f‖
    penetration: Reals  #: u_n ≤ g
    tension: Reals  #: σ_n ≤ 0
    complementarity: Reals  #: (u_n − g) σ_n = 0
    active: Integers  #: closed contact unknowns
    seconds: Reals  #: since the start
