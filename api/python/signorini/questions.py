"""Which conversations and requests the calls of a client begin."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, Union
from urllib.parse import urlencode

from .conversation import BatchTicket, Ticket
from .document import encoded
from .exchange import Request
from .problem import Problem
from .progress import ProgressBar

#: A problem of the builder, or its document.
AnyProblem = Union[Problem, Mapping[str, Any]]
#: Whether to show a bar on standard error, or who is told instead: `progress(done, count)`.
Progress = Union[bool, Callable[[int, int], None]]

_FIELDS = ("problem", "mesh", "displacement", "stress", "contact", "history", "sweep", "study", "error_squares")
_ELASTIC_FIELDS = ("principal", "von_mises")


def fields_of(problem: AnyProblem, fields: Sequence[str] | None) -> Sequence[str]:
    """The members of the result that are fetched: those that are named, or all that the problem has."""
    if fields is not None:
        return tuple(fields) or ("summary",)
    model = problem.model if isinstance(problem, Problem) else problem.get("model")
    return _FIELDS + (_ELASTIC_FIELDS if model == "elasticity" else ())


def ticket(problem: AnyProblem, fields: Sequence[str] | None) -> Ticket:
    """What a solve begins with."""
    return Ticket(encoded(problem), fields_of(problem, fields))


def tickets(problems: Iterable[AnyProblem], fields: Sequence[str] | None) -> list[Ticket]:
    """What a map begins with."""
    return [ticket(problem, fields) for problem in problems]


def batch(
    problems: Iterable[AnyProblem], title: str | None, tags: Sequence[str] | None, fields: Sequence[str] | None
) -> BatchTicket:
    """What a batch begins with; of the default fields those of any of its problems."""
    listed = list(problems)
    picked = dict.fromkeys(name for problem in listed for name in fields_of(problem, fields))
    members = {"title": title, "tags": tags, "problems": listed}
    body = encoded({name: member for name, member in members.items() if member is not None})
    return BatchTicket(body, tuple(picked))


def solves(tag: str | None, title: str | None, status: str | None) -> Request:
    """Asks for the first page of the solves that are meant."""
    filters = {"limit": "1000", "tag": tag, "title": title, "status": status}
    return Request("GET", "/v1/solves?" + urlencode({name: text for name, text in filters.items() if text is not None}))


def deletion(tag: str, count: int) -> Request:
    """Cancels and deletes all with the tag, if they are so many."""
    return Request("DELETE", "/v1/solves?" + urlencode({"tag": tag, "confirm": count}))


def teller(progress: Progress, count: int) -> Callable[[int], None]:
    """Who is told how many of `count` are done."""
    tell: Callable[[int, int], None] | None = ProgressBar() if progress is True else progress or None
    return lambda done: tell(done, count) if tell else None


def validation(problem: AnyProblem) -> Request:
    """Asks what a problem would cost."""
    return Request("POST", "/v1/validate", encoded(problem))


def examples() -> Request:
    """Asks for the names of all examples."""
    return Request("GET", "/v1/examples")


def example(name: str) -> Request:
    """Asks for an example."""
    return Request("GET", f"/v1/examples/{name}")


def result(id: str, fields: Sequence[str] | None) -> Request:
    """Asks for the result of a solve that has ended."""
    return Request("GET", f"/v1/solves/{id}/result" + (f"?fields={','.join(fields)}" if fields else ""))
