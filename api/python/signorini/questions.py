"""Which conversations and requests the calls of a client begin."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, Union
from urllib.parse import quote, urlencode

from .conversation import BatchTicket, Ticket
from .document import encoded, is_unicode
from .exchange import Request
from .problem import Problem
from .progress import ProgressBar

#: A problem of the builder, or its document.
AnyProblem = Union[Problem, Mapping[str, Any]]
#: Whether to show a bar on standard error, or who is told instead: `progress(done, count)`.
Progress = Union[bool, Callable[[int, int], None]]

#: Members of a result beside its summary that are fetched by default, and those of an elastic body alone.
FIELDS = ("problem", "mesh", "displacement", "stress", "contact", "history", "sweep", "study", "quantities",
          "error_squares")  # fmt: skip
ELASTIC_FIELDS = ("principal", "von_mises")


def fields_of(problem: AnyProblem, fields: Sequence[str] | None) -> Sequence[str]:
    """The members of the result that are fetched: those that are named, or all that the problem has."""
    if fields is not None:
        return _names(fields, "fields") or ("summary",)
    model = problem.model if isinstance(problem, Problem) else problem.get("model")
    return FIELDS + (ELASTIC_FIELDS if model == "elasticity" else ())


def posed(problem: AnyProblem, fields: Sequence[str] | None) -> tuple[bytes, Sequence[str]]:
    """A problem as JSON, and the members that are fetched. Raises TypeError, ValueError."""
    if not isinstance(problem, (Problem, Mapping)):
        raise TypeError(f"a problem is a Problem or its document, a mapping, and not {_kind(problem)}")
    return encoded(problem), fields_of(problem, fields)


def all_posed(problems: Iterable[AnyProblem], fields: Sequence[str] | None) -> list[tuple[bytes, Sequence[str]]]:
    """Several problems as `posed` has them; what it raises says which."""
    found = []
    for index, problem in enumerate(_several(problems, "map")):
        try:
            found.append(posed(problem, fields))
        except (TypeError, ValueError) as error:
            raise type(error)(f"problem {index}: {error}") from error
    return found


def ticket(problem: AnyProblem, fields: Sequence[str] | None) -> Ticket:
    """What a solve begins with."""
    return Ticket(*posed(problem, fields))


def tickets(problems: Iterable[AnyProblem], fields: Sequence[str] | None) -> list[Ticket]:
    """What a map begins with."""
    return [Ticket(*each) for each in all_posed(problems, fields)]


def batch(
    problems: Iterable[AnyProblem], title: str | None, tags: Sequence[str] | None, fields: Sequence[str] | None
) -> BatchTicket:
    """What a batch begins with; of the default fields those of any of its problems."""
    listed = list(_several(problems, "batch"))
    for index, problem in enumerate(listed):
        if not isinstance(problem, (Problem, Mapping)):
            raise TypeError(f"problem {index} is a Problem or its document, a mapping, and not {_kind(problem)}")
    picked = dict.fromkeys(name for problem in listed for name in fields_of(problem, fields))
    members = {"title": title, "tags": tags if tags is None else _names(tags, "tags"), "problems": listed}
    body = encoded({name: member for name, member in members.items() if member is not None})
    return BatchTicket(body, tuple(picked))


def _several(problems: Iterable[AnyProblem], call: str) -> Iterable[AnyProblem]:
    if isinstance(problems, (Problem, Mapping, str, bytes)) or not isinstance(problems, Iterable):
        raise TypeError(f"{call} takes several problems, such as a list of them, and not {_kind(problems)}")
    return problems


def _names(names: Sequence[str], what: str) -> tuple[str, ...]:
    """The names. Raises TypeError for one text, which would be many of a letter."""
    if isinstance(names, (str, bytes)) or not isinstance(names, Iterable):
        raise TypeError(f"{what} are several names, such as a list of them, and not {_kind(names)}")
    listed = tuple(_text(name, f"a name of {what}") for name in names)
    if "" in listed:
        raise ValueError(f"a name of {what} is empty")
    return listed


def _text(text: str, what: str) -> str:
    """The text. Raises TypeError, ValueError for half a character of two (a surrogate)."""
    if not isinstance(text, str):
        raise TypeError(f"{what} is a text, and not {_kind(text)}")
    if not is_unicode(text):
        raise ValueError(f"{what} is no Unicode: {text!r}")
    return text


def _kind(value: object) -> str:
    return type(value).__name__


def solves(tag: str | None, title: str | None, status: str | None) -> Request:
    """Asks for the first page of the solves that are meant."""
    filters = {"limit": "1000", "tag": tag, "title": title, "status": status}
    given = {name: _text(text, name) for name, text in filters.items() if text is not None}
    return Request("GET", "/v1/solves?" + urlencode(given))


def deletion(tag: str, count: int) -> Request:
    """Cancels and deletes all with the tag, if they are so many."""
    return Request("DELETE", "/v1/solves?" + urlencode({"tag": _text(tag, "tag"), "confirm": count}))


def teller(progress: Progress, count: int) -> Callable[[int], None]:
    """Who is told how many of `count` are done."""
    tell: Callable[[int, int], None] | None = ProgressBar() if progress is True else progress or None
    return lambda done: tell(done, count) if tell else None


def validation(problem: AnyProblem) -> Request:
    """Asks what a problem would cost."""
    return Request("POST", "/v1/validate", posed(problem, None)[0])


def examples() -> Request:
    """Asks for the names of all examples."""
    return Request("GET", "/v1/examples")


def example(name: str) -> Request:
    """Asks for an example."""
    return Request("GET", "/v1/examples/" + quote(_text(name, "the name of an example"), safe=""))


def result(id: str, fields: Sequence[str] | None) -> Request:
    """Asks for the result of a solve that has ended."""
    path = f"/v1/solves/{quote(_text(id, 'the id of a solve'), safe='')}/result"
    if fields is None:
        return Request("GET", path)
    names = _names(fields, "fields") or ("summary",)
    return Request("GET", f"{path}?" + urlencode({"fields": ",".join(names)}, safe=","))
