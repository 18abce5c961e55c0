"""The figures of a solve."""

from __future__ import annotations

from dataclasses import dataclass

from .arrays import Integers, Reals
from .fields import ContactPart


@dataclass(frozen=True)
class Unknowns:
    """Numbers of unknowns of each field."""

    stress: int
    displacement: int
    contact: int
    rotation: int  #: 0 for a membrane


@dataclass(frozen=True)
class Residuals:
    """What is left of each condition; relative. Entries of a sweep have those of the contact."""

    equilibrium: float | None  #: div σ + f = 0 and σn = t
    constitutive: float | None  #: Cσ = ε(u)
    penetration: float  #: u_n ≤ g
    tension: float  #: σ_n ≤ 0
    complementarity: float  #: (u_n − g) σ_n = 0
    symmetry: float | None  #: σ = σᵀ


@dataclass(frozen=True)
class ContactSums:
    """Over all contact parts."""

    force: float  #: ∫ p ds, force per thickness
    max_pressure: float  #: force per area
    length: float  #: of the closed part


@dataclass(frozen=True)
class Reaction:
    """What the surroundings exert on the body through one part, per thickness."""

    force: float | tuple[float, float]  #: ∫ σn ds, a number for a membrane
    moment: float | None  #: about the origin; elasticity only


@dataclass(frozen=True)
class BoundParts:
    """What an error bound is made of, in its unit."""

    constitutive: float
    contact: float
    oscillation: float
    equilibration: float
    asymmetry: float


@dataclass(frozen=True)
class ErrorBound:
    """An upper bound of the error in the energy norm."""

    value: float  #: of stress and displacement together, √energy
    relative: float  #: `value` by the norm of the stress
    guaranteed: bool  #: whether the bound is proved for this problem
    unmet: tuple[str, ...] | None  #: if not, the conditions that are not met
    energy_lower: float  #: at most the energy of the solution
    energy_upper: float  #: at least the energy of the solution
    parts: BoundParts


@dataclass(frozen=True)
class EnclosedQuantity:
    """A quantity of the problem with the interval in which it lies."""

    name: str
    value: float  #: of the discrete solution
    estimate: float  #: `value`, or the middle of the interval if that is outside
    lower: float | None  #: none without a finite interval
    upper: float | None
    guaranteed: bool  #: whether the interval is proved to contain the quantity
    unmet: tuple[str, ...] | None  #: if not, why


@dataclass(frozen=True)
class EnclosedNumber:
    """A number with an interval in which it lies."""

    value: float  #: of the discrete solution
    estimate: float  #: `value`, or the middle of the interval if that is outside
    lower: float | None  #: none if nothing bounds it from below
    upper: float | None  #: none if nothing bounds it from above


@dataclass(frozen=True)
class CertifiedStretch:
    """What is known of a stretch of a contact part."""

    begin: tuple[float, ...]  #: a point
    end: tuple[float, ...]
    touches: bool  #: somewhere within
    carries_at_most: float | None  #: ∫ p ds over it
    opens_at_most: float | None  #: ∫ λ ds over it, λ the clearance


@dataclass(frozen=True)
class CertifiedSupport:
    """What a support takes, as in `Reaction`; several together in `Certified.sums`."""

    force: EnclosedNumber | tuple[EnclosedNumber, EnclosedNumber]  #: of a membrane one
    moment: EnclosedNumber | None  #: about the origin
    pressure_force: EnclosedNumber | None  #: ∫ p ds, of a contact part
    stretches: tuple[CertifiedStretch, ...] | None  #: of a contact part, one after the other
    parts: tuple[str, ...] | None  #: in sums


@dataclass(frozen=True)
class Certified:
    """Numbers of every answer in guaranteed intervals."""

    energy: EnclosedNumber
    work: EnclosedNumber  #: of the loads
    parts: dict[str, CertifiedSupport]  #: of parts that are fixed, on rollers or in contact
    sums: tuple[CertifiedSupport, ...] | None  #: of parts that meet in a point whose force nothing shares out
    unmet: tuple[str, ...] | None  #: why some of it is not bounded


@dataclass(frozen=True)
class Levels:
    """The meshes of an adaptive solve, columns by level."""

    level: Integers  #: from 1
    triangles: Integers
    unknowns: Integers
    bound: Reals  #: `ErrorBound.value`
    relative: Reals  #: `ErrorBound.relative`
    iterations: Integers
    seconds: Reals  #: since the start


@dataclass(frozen=True)
class Timings:
    """Seconds by phase."""

    mesh: float
    assemble: float
    factorize: float
    iterate: float
    certify: float
    total: float


@dataclass(frozen=True)
class Summary:
    """The figures of a solve."""

    outcome: str  #: `converged`, or why not: `iteration_limit`, `time_limit`, `diverged`, …
    advice: str | None  #: if it did not converge, what to try
    notes: tuple[str, ...] | None  #: what was done that the problem did not ask for, and warnings
    method: str  #: `uzawa` or `active_set`
    iterations: int
    triangles: int
    unknowns: Unknowns
    energy: float  #: ½(Cσ,σ) − (f,u) − ⟨t,u⟩, force times length per thickness
    residuals: Residuals
    contact: ContactSums
    parts: dict[str, Reaction]  #: by part of the boundary
    reused: bool  #: whether the factor of an earlier solve was used again
    error_bound: ErrorBound | None
    certified: Certified | None  #: if the bound is guaranteed
    levels: Levels | None  #: of an adaptive mesh
    timings: Timings
    peak_memory_bytes: int


@dataclass(frozen=True)
class SweepSummary:
    """The figures of one entry of a sweep, as in `Summary`."""

    outcome: str
    iterations: int
    energy: float
    residuals: Residuals
    contact: ContactSums
    parts: dict[str, Reaction]
    error_bound: ErrorBound | None  #: none of an entry that has but new gaps
    quantities: tuple[EnclosedQuantity, ...] | None  #: of a problem that asks for some
    seconds: float  #: for this entry


@dataclass(frozen=True)
class SweepEntry:
    """One entry of a sweep."""

    title: str | None
    status: str  #: `succeeded` or `failed`
    error: str | None  #: why it failed
    summary: SweepSummary | None
    contact: dict[str, ContactPart] | None


@dataclass(frozen=True)
class StudyTable:
    """The table of a study; the members of rows and rates are those of the schemas `StudyRow` and `StudyTable`."""

    rows: tuple[dict[str, float | str | bool], ...]  #: a row a mesh and scheme
    rates: tuple[dict[str, float | str], ...]  #: for each scheme the fitted exponents of h


@dataclass(frozen=True)
class Cost:
    """What a solve would take."""

    memory_bytes: float  #: at most
    seconds: float  #: on a machine of our time


@dataclass(frozen=True)
class Estimate:
    """Sizes of a problem and what it would cost."""

    valid: bool
    triangles: int
    unknowns: Unknowns
    system: int  #: order of the matrix that is factored
    estimated: Cost
    study_runs: int | None  #: of a problem with a study
    notes: tuple[str, ...] | None  #: what only the solve will tell
