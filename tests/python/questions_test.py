"""Questions that are none are refused before they are asked, in words that name the place."""

from __future__ import annotations

import asyncio
import copy
import json
import math
import pathlib
import pickle
import unittest
from collections.abc import Callable
from typing import Any

import numpy

from signorini import (
    AsyncClient,
    Client,
    Contact,
    Fault,
    Local,
    MeshRequest,
    Problem,
    Rectangle,
    Refused,
    Result,
    ServiceUnreachable,
    SolveFailed,
    YoungPoisson,
)
from signorini.document import encoded
from signorini.questions import ELASTIC_FIELDS, FIELDS

TREE = pathlib.Path(__file__).parents[2]
DOCUMENT: dict[str, Any] = {"model": "membrane"}
NOWHERE = "http://127.0.0.1:1"


def refusals(call: str, *arguments: Any, **options: Any) -> list[str]:
    """What every kind of client that has the call says to it, none of which asks a service."""
    said = []
    for client in (Client(NOWHERE), AsyncClient(NOWHERE), Local("no-such-program")):
        if not hasattr(client, call):
            continue
        try:
            answer = getattr(client, call)(*arguments, **options)
            if asyncio.iscoroutine(answer):
                asyncio.run(answer)
        except (TypeError, ValueError) as error:
            said.append(f"{type(error).__name__}: {error}")
        except ServiceUnreachable as error:
            said.append(f"asked: {error}")
    return said


class Arguments(unittest.TestCase):
    def expect(self, words: str, call: str, *arguments: Any, **options: Any) -> None:
        said = refusals(call, *arguments, **options)
        self.assertGreater(len(said), 1)
        for each in said:
            self.assertRegex(each, f"^(Type|Value)Error: {words}")

    def test_what_is_no_problem(self) -> None:
        for wrong in (None, "text", b"{}", 3, [DOCUMENT], Result({})):
            self.expect("a problem is a Problem or its document, a mapping, and not ", "solve", wrong)
            self.expect("a problem is a Problem or its document", "validate", wrong)
            self.expect("problem 1: a problem is a Problem or its document", "map", [DOCUMENT, wrong])
            self.expect("problem 1 is a Problem or its document", "batch", [DOCUMENT, wrong])

    def test_what_is_not_several_problems(self) -> None:
        for wrong in (DOCUMENT, {}, "text", None, 3, Problem):
            self.expect("map takes several problems, such as a list of them, and not ", "map", wrong)
            self.expect("batch takes several problems, such as a list of them, and not ", "batch", wrong)

    def test_what_are_no_names(self) -> None:
        for wrong in ("summary", b"summary", 3):
            for call in ("solve", "map", "batch"):
                problems = DOCUMENT if call == "solve" else [DOCUMENT]
                self.expect("(problem 0: )?fields are several names", call, problems, fields=wrong)
            self.expect("fields are several names", "result", "ID", fields=wrong)
        self.expect("tags are several names", "batch", [DOCUMENT], tags="seal")
        self.expect("a name of fields is a text, and not int", "solve", DOCUMENT, fields=[1])
        self.expect("a name of fields is no Unicode", "solve", DOCUMENT, fields=["\ud800"])
        self.expect("a name of fields is empty", "solve", DOCUMENT, fields=["mesh", ""])
        for call in ("example", "result"):
            for name in (None, 3, b"x", "\ud800"):
                self.expect("the (name|id) of .* is (a text|no Unicode)", call, name)
        self.expect("tag is a text", "delete_tagged", None, 3)
        self.expect("tag is no Unicode", "solves", tag="\ud800")

    def test_what_json_does_not_have(self) -> None:
        loop: dict[str, Any] = {}
        loop["load"] = loop
        deep: Any = []
        for _ in range(100_000):
            deep = [deep]
        for value, words in (
            (math.nan, "/load/body/1: nan is no finite number"), (-math.inf, "/load/body/1: -inf is no finite"),
            ({1}, "/load/body/1: JSON has nothing like set"), (object(), "/load/body/1: JSON has nothing like object"),
            (b"x", "/load/body/1: JSON has nothing like bytes"), (1j, "/load/body/1: JSON has nothing like complex"),
            ("a\ud800", "/load/body/1: .* is no Unicode"), ({"a/b~": math.nan}, "/load/body/1/a~1b~0: nan"),
            ({3: 4}, "the names of members are texts, and 3 is none"), ({"\udfff": 1}, "/load/body/1: .* no Unicode"),
            (loop, "it is nested too deeply, or contains itself"), (deep, "it is nested too deeply"),
            (numpy.array([1.0, numpy.nan]), "/load/body/1/1: nan"), (numpy.float64("inf"), "/load/body/1: inf"),
        ):  # fmt: skip
            problem = DOCUMENT | {"load": {"body": [0, value]}}
            with self.subTest(words):
                self.expect(words, "solve", problem)
                self.expect(f"problem 2: {words}", "map", [DOCUMENT, DOCUMENT, problem])
        self.expect("/problems/1/load: nan", "batch", [DOCUMENT, DOCUMENT | {"load": math.nan}])
        block = Problem(
            model="elasticity", domain=Rectangle((0, 0), (2, 1)), mesh=MeshRequest(size=math.inf),
            material=YoungPoisson(1, 0.3), boundary={"all": Contact()}, scheme="conforming",
        )  # fmt: skip
        self.expect("/mesh/size: inf is no finite number", "solve", block)

    def test_what_is_right_is_asked(self) -> None:
        clients: list[Client | Local] = [Client(NOWHERE), Local("no-such-program")]
        for client in clients:
            with self.assertRaises(ServiceUnreachable):
                client.solve(DOCUMENT)
            with self.assertRaises(ServiceUnreachable):
                client.map(DOCUMENT for _ in range(2))
        texts = {"a": "ü😀", "b": [None, True, 10**20]}
        self.assertEqual(encoded(texts), '{"a": "ü😀", "b": [null, true, 100000000000000000000]}'.encode())

    def test_how_many_run_is_a_count(self) -> None:
        for workers in (0, -1):
            with self.assertRaisesRegex(ValueError, "workers is how many"):
                Local(workers=workers)


class Fields(unittest.TestCase):
    def test_all_are_fetched_but_those_of_other_levels(self) -> None:
        parameters = json.loads((TREE / "api/openapi/solves_paths.json").read_text())["components"]["parameters"]
        (names,) = (each["schema"]["items"]["enum"] for each in parameters.values() if each["name"] == "fields")
        self.assertEqual({"summary", "levels", *FIELDS, *ELASTIC_FIELDS}, set(names))


class Copies(unittest.TestCase):
    def test_results_and_errors_go_between_processes(self) -> None:
        members = {"mesh": {"points": numpy.eye(2)}, "error": {"detail": "slides"}}
        result = Result({"id": "A", "status": "failed", **members})
        refused = Refused(422, "urn:bad", "Bad", "Two.", (Fault("d", "/p"), Fault("e")), 3)
        ways: list[Callable[[Any], Any]] = [copy.copy, copy.deepcopy, lambda value: pickle.loads(pickle.dumps(value))]
        for way in ways:
            again = way(result)
            self.assertEqual((again.id, again.error), ("A", "slides"))
            numpy.testing.assert_array_equal(again.document["mesh"]["points"], numpy.eye(2))
            self.assertEqual(vars(way(refused)), vars(refused))
            self.assertEqual(str(way(refused)), str(refused))
            failed = way(SolveFailed(result))
            self.assertEqual((failed.result.id, str(failed)), ("A", "the solve failed: slides"))
            self.assertEqual(way(Client(NOWHERE, token="t"))._endpoint.token, "t")


if __name__ == "__main__":
    unittest.main()
