"""What can go wrong."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .result import Result


class SignoriniError(Exception):
    """The base of all errors of this package."""


class ServiceUnreachable(SignoriniError):
    """Nothing answers at the address, or no longer."""


class BadReply(SignoriniError):
    """What answers is no service of Signorini, or no program of it: what came, and from where."""


@dataclass(frozen=True)
class Fault:
    """One fault of a problem or a query."""

    detail: str  #: what is wrong and what would be right
    pointer: str | None = None  #: the member of the problem, a JSON pointer
    parameter: str | None = None  #: the query parameter


class Refused(SignoriniError):
    """The service does not take a request, and says why (RFC 9457).

    `status` is that of HTTP (None from the command line where it has none), `type` the stable name of the kind,
    `faults` every fault of a bad problem. `index` is the place of the problem among those of a `map`.
    """

    def __init__(
        self,
        status: int | None,
        type: str,
        title: str,
        detail: str,
        faults: tuple[Fault, ...],
        index: int | None = None,
    ) -> None:
        self.status = status
        self.type = type
        self.title = title
        self.detail = detail
        self.faults = faults
        self.index = index
        lines = [f"{title}: {detail}" if index is None else f"problem {index}: {title}: {detail}"]
        lines += [f"  {fault.pointer or fault.parameter or ''} {fault.detail}" for fault in faults]
        super().__init__("\n".join(lines))

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.status, self.type, self.title, self.detail, self.faults, self.index)


class SolveFailed(SignoriniError):
    """A solve ended as `failed` or `cancelled`. `result` has its last iterate, if there was any."""

    def __init__(self, result: Result) -> None:
        self.result = result
        super().__init__(f"the solve {result.status}: {result.error}")

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.result,)


class ResultsDropped(SignoriniError):
    """A service dropped results before they could be fetched."""


class NotInResult(SignoriniError, AttributeError):
    """A member that the result does not have."""


class PackageMissing(SignoriniError, ImportError):
    """What was asked for takes a package that is not installed."""
