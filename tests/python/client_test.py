"""The client, its asyncio twin and the command line, with the daemon."""

from __future__ import annotations

import asyncio
import dataclasses
import inspect
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy

from daemon import PROGRAM, STOPPED_EARLY, Daemon, block, free_port
from signorini import (
    AsyncClient,
    Client,
    Local,
    NotInResult,
    PressureForce,
    Problem,
    Refused,
    Result,
    ServiceUnreachable,
    SolveFailed,
    Study,
    Variation,
)
from signorini.exchange import Request
from signorini.questions import AnyProblem


class WithDaemon(unittest.TestCase):
    daemon: Daemon
    client: Client

    @classmethod
    def setUpClass(cls) -> None:
        cls.daemon = Daemon()
        cls.client = Client(cls.daemon.url)

    @classmethod
    def tearDownClass(cls) -> None:
        cls.daemon.end(signal.SIGTERM)

    def solves(self, status: str) -> int:
        """How many solves of the service have this status."""
        return len(self.client._ask(Request("GET", f"/v1/solves?limit=1000&status={status}"))["solves"])


def every_way(case: WithDaemon) -> dict[str, Callable[[AnyProblem], Result]]:
    """By a client, by its twin, and without a service."""
    twin = AsyncClient(case.daemon.url)
    return {
        "Client": case.client.solve,
        "AsyncClient": lambda problem: asyncio.run(twin.solve(problem)),
        "Local": Local(PROGRAM).solve,
    }


class Solves(WithDaemon):
    def test_a_pressed_block_carries_its_load(self) -> None:
        for way, solve in every_way(self).items():
            with self.subTest(way):
                result = solve(block())
                self.assertEqual(result.status, "succeeded")
                self.assertIsNone(result.error)
                self.assertAlmostEqual(result.summary.contact.force, 2.0, 9)
                force = result.summary.parts["top"].force
                assert isinstance(force, tuple)
                self.assertAlmostEqual(force[1], -2.0, 9)
                bound = result.summary.error_bound
                assert bound is not None
                self.assertTrue(bound.guaranteed and bound.energy_lower < bound.energy_upper)

    def test_the_fields_are_arrays_of_their_shapes(self) -> None:
        for way, solve in every_way(self).items():
            with self.subTest(way):
                result = solve(block())
                count = result.summary.triangles
                points = len(result.mesh.points)
                shapes: dict[str, tuple[Any, tuple[int, ...], str]] = {
                    "points": (result.mesh.points, (points, 2), "float64"),
                    "triangles": (result.mesh.triangles, (count, 3), "int32"),
                    "bottom": (result.mesh.boundary["bottom"], (8, 2), "int32"),
                    "values": (result.displacement.values, (count, 3, 2), "float64"),
                    "at_points": (result.displacement.at_points, (points, 2), "float64"),
                    "at_centroids": (result.stress.at_centroids, (count, 3), "float64"),
                    "principal": (result.principal, (count, 2), "float64"),
                    "von_mises": (result.von_mises, (count,), "float64"),
                    "error_squares": (result.error_squares, (count,), "float64"),
                    "pressure": (result.contact["bottom"].pressure, (9,), "float64"),
                    "open": (result.contact["bottom"].open, (9,), "bool"),
                    "iteration": (result.history.iteration, (result.summary.iterations,), "int32"),
                }
                for name, (array, shape, kind) in shapes.items():
                    self.assertIsInstance(array, numpy.ndarray, name)
                    self.assertEqual((array.shape, array.dtype), (shape, numpy.dtype(kind)), name)
                numpy.testing.assert_array_equal(result.contact["bottom"].open, result.contact["bottom"].clearance > 0)
                self.assertIsNone(result.history.displacement_change)

    def test_named_quantities_are_fetched_unasked(self) -> None:
        posed = dataclasses.replace(block(), quantities=[PressureForce("grip", "bottom")])
        for way, solve in every_way(self).items():
            with self.subTest(way):
                (grip,) = solve(posed).quantities
                self.assertEqual(grip.name, "grip")
                self.assertAlmostEqual(grip.value, 2.0, 9)

    def test_only_what_is_named_is_fetched(self) -> None:
        result = self.client.solve(block(), fields=["contact"])
        self.assertEqual(list(result.document), ["id", "status", "summary", "contact"])
        with self.assertRaisesRegex(NotInResult, "no stress; it has id, status, summary, contact"):
            result.stress
        self.assertEqual(list(self.client.solve(block(), fields=[]).document), ["id", "status", "summary"])
        self.assertEqual(list(Local(PROGRAM).solve(block(), fields=[]).document), ["status", "summary"])

    def test_a_batch_is_solved_as_a_whole(self) -> None:
        twin = AsyncClient(self.daemon.url)
        failing = dataclasses.replace(block(), solver=STOPPED_EARLY)
        ways: dict[str, Callable[..., list[Result]]] = {
            "a": self.client.batch,
            "b & c": lambda *problems, **asked: asyncio.run(twin.batch(*problems, **asked)),
        }
        for tag, solve_batch in ways.items():
            problems = [block(100.0), failing, block(300.0)]
            results = solve_batch(problems, title="three", tags=[tag], fields=["contact", "problem"])
            self.assertEqual([result.status for result in results], ["succeeded", "failed", "succeeded"])
            self.assertEqual(results[2].problem["material"]["young"], 300)
            self.assertEqual(results[0].contact["bottom"].pressure.shape, (9,))
            self.assertEqual(len(self.client.solves(tag=tag)), 3)
            self.assertEqual(len(self.client.solves(tag=tag, status="failed")), 1)
            with self.assertRaises(Refused) as caught:
                self.client.delete_tagged(tag, 2)
            self.assertEqual(caught.exception.status, 409)
            self.assertEqual(self.client.delete_tagged(tag, 3), {"cancelled": 0, "deleted": 3})
            self.assertEqual(asyncio.run(twin.solves(tag=tag)), [])
        with self.assertRaises(Refused) as caught:
            self.client.batch([block(), block(-1.0)])
        self.assertEqual([fault.pointer for fault in caught.exception.faults], ["/problems/1/material/young"])
        tagged = dataclasses.replace(block(title="a seal"), tags=["own"])
        self.client.solve(tagged, fields=[])
        self.assertEqual([solve["tags"] for solve in self.client.solves(title="SEAL")], [["own"]])

    def test_a_sweep_may_vary_the_material(self) -> None:
        stiff = Variation(title="stiff", material=dataclasses.replace(block(400.0)).material)
        result = self.client.solve(dataclasses.replace(block(200.0), sweep=[stiff, Variation()]), fields=["sweep"])
        energies = [entry.summary.energy for entry in result.sweep if entry.summary]
        alone = self.client.solve(block(400.0), fields=[]).summary.energy
        self.assertAlmostEqual(energies[0] / alone, 1, 9)
        self.assertAlmostEqual(energies[1] / result.summary.energy, 1, 9)

    def test_a_bad_problem_is_refused_with_all_its_faults(self) -> None:
        bad = block().document() | {"scheme": "conformal", "material": {"young": -1, "poisson": 0.3}}
        for way, solve in every_way(self).items():
            with self.subTest(way), self.assertRaises(Refused) as caught:
                solve(bad)
            self.assertEqual({fault.pointer for fault in caught.exception.faults}, {"/scheme", "/material/young"}, way)
            self.assertEqual(caught.exception.status, 422)

    def test_a_solve_that_fails_still_has_its_last_iterate(self) -> None:
        for way, solve in every_way(self).items():
            with self.subTest(way), self.assertRaisesRegex(SolveFailed, "2 iterations|max_iterations") as caught:
                solve(dataclasses.replace(block(), solver=STOPPED_EARLY))
            result = caught.exception.result
            self.assertEqual((result.status, result.summary.outcome), ("failed", "iteration_limit"), way)
            self.assertEqual(len(result.history.iteration), 2)
            with self.assertRaises(SolveFailed):
                result.check()

    def test_a_solve_without_a_result_says_why(self) -> None:
        sliding = dataclasses.replace(block(), boundary={"bottom": block().boundary["bottom"]})
        for way, solve in every_way(self).items():
            with self.subTest(way), self.assertRaises((SolveFailed, Refused)) as caught:
                solve(sliding)
            self.assertRegex(str(caught.exception), "slide|free|held|move")

    def test_a_sweep_and_a_study_are_read(self) -> None:
        deep = Variation(title="deep", boundary={"bottom": {"gap": 0.02}})
        sweep = [deep, Variation(boundary={"top": {"pressure": 2}})]
        entries = self.client.solve(dataclasses.replace(block(), sweep=sweep)).sweep
        self.assertEqual([entry.title for entry in entries], ["deep", None])
        assert entries[1].summary is not None and entries[1].contact is not None
        self.assertAlmostEqual(entries[1].summary.contact.force, 4.0, 9)
        self.assertEqual(entries[1].contact["bottom"].pressure.shape, (9,))
        table = self.client.solve(dataclasses.replace(block(), study=Study(divisions=[(4, 2), (8, 4)]))).study
        self.assertEqual([row["triangles"] for row in table.rows], [16, 64])
        self.assertEqual(table.rates[0]["scheme"], "conforming")

    def test_a_sweep_of_which_an_entry_fails_says_why(self) -> None:
        lifted = Variation(boundary={"top": {"pressure": -1}})
        for way, solve in every_way(self).items():
            with self.subTest(way), self.assertRaises(SolveFailed) as caught:
                solve(dataclasses.replace(block(), sweep=[Variation(), lifted]))
            self.assertIn("lifts it off", str(caught.exception), way)
            if way == "Local":  # the program says which, too
                self.assertIn("first /sweep/1", str(caught.exception))
            self.assertEqual([entry.status for entry in caught.exception.result.sweep], ["succeeded", "failed"])

    def test_every_example_is_solved(self) -> None:
        for name in self.client.examples():
            self.assertEqual(self.client.solve(self.client.example(name), fields=[]).status, "succeeded", name)

    def test_an_earlier_result_is_found_again(self) -> None:
        solved = self.client.solve(block())
        again = self.client.result(solved.id, fields=["stress"])
        numpy.testing.assert_array_equal(again.stress.at_centroids, solved.stress.at_centroids)
        with self.assertRaises(Refused) as caught:
            self.client.result("01M7Y6YNMGXQMRMBC408KV9MTF")
        self.assertEqual(caught.exception.status, 404)

    def test_a_problem_is_estimated(self) -> None:
        estimate = self.client.validate(block())
        self.assertEqual((estimate.triangles, estimate.unknowns.contact), (64, 9))
        self.assertGreater(estimate.estimated.memory_bytes, 1e5)


class Twins(WithDaemon):
    def test_they_have_the_same_calls(self) -> None:
        def calls(kind: type) -> dict[str, inspect.Signature]:
            return {
                name: inspect.signature(call).replace(return_annotation=None)
                for name, call in vars(kind).items()
                if callable(call) and (name == "__init__" or not name.startswith("_"))
            }

        self.assertEqual(calls(Client), calls(AsyncClient))

    def test_the_twin_answers_the_same(self) -> None:
        async def ask() -> list[Any]:
            twin = AsyncClient(self.daemon.url)
            solved = await twin.solve(block(), fields=["contact"])
            again = await twin.result(solved.id, fields=["contact"])
            return [
                again.contact["bottom"].pressure.tolist(),
                await twin.examples(),
                await twin.example("hertz-half-disc"),
                await twin.validate(block()),
                [result.summary.energy for result in await twin.map([block(100), block(200)])],
            ]

        self.assertEqual(
            asyncio.run(ask()),
            [
                self.client.solve(block()).contact["bottom"].pressure.tolist(),
                self.client.examples(),
                self.client.example("hertz-half-disc"),
                self.client.validate(block()),
                [result.summary.energy for result in self.client.map([block(100), block(200)])],
            ],
        )

    def test_many_solves_of_the_twin_run_beside_each_other(self) -> None:
        async def gather() -> list[Result]:
            twin = AsyncClient(self.daemon.url)
            return await asyncio.gather(*(twin.solve(block(100 + i), fields=["problem"]) for i in range(40)))

        found = [result.problem["material"]["young"] for result in asyncio.run(gather())]
        self.assertEqual(found, [100 + i for i in range(40)])

    def test_a_cancelled_task_cancels_its_solves(self) -> None:
        async def cancel(call: Callable[[AsyncClient], Any]) -> None:
            task = asyncio.ensure_future(call(AsyncClient(self.daemon.url)))
            while not self.solves("running") and not task.done():
                await asyncio.sleep(0.05)
            task.cancel()
            with self.assertRaises(asyncio.CancelledError):
                await task

        long = block(divisions=(300, 150))
        calls: list[Callable[[AsyncClient], Any]] = [
            lambda twin: twin.solve(long),
            lambda twin: twin.map([long] * 10),
        ]
        for call in calls:
            asyncio.run(cancel(call))
            self.expect_rest()

    def expect_rest(self) -> None:
        """Nothing waits, and nothing runs any more."""
        until = time.monotonic() + 5
        while self.solves("queued") + self.solves("running") and time.monotonic() < until:
            time.sleep(0.05)
        self.assertEqual((self.solves("queued"), self.solves("running")), (0, 0))

    def test_a_name_that_is_none_is_refused_in_words(self) -> None:
        for name in ("nö", "stress,nö", "a&b=c"):
            id = self.client.solve(block(), fields=[]).id
            with self.assertRaisesRegex(Refused, "fields"):
                self.client.solve(block(), fields=[name])
            with self.assertRaisesRegex(Refused, "fields"):
                self.client.result(id, fields=[name])
            with self.assertRaisesRegex(Refused, "fields"):
                Local(PROGRAM).solve(block(), fields=[name])

    def test_ctrl_c_cancels_its_solves(self) -> None:
        # Who started the tests in the background may have had SIGINT ignored.
        program = (
            "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)\n"
            "import sys; from daemon import block; from signorini import Client\n"
            "client, long = Client(sys.argv[1]), block(divisions=(300, 150))\n"
            "client.solve(long) if sys.argv[2] == 'solve' else client.map([long] * 10)"
        )
        for call in ("solve", "map"):
            command = [sys.executable, "-c", program, self.daemon.url, call]
            with subprocess.Popen(command, cwd=pathlib.Path(__file__).parent, stderr=subprocess.PIPE, text=True) as child:
                while not self.solves("running") and child.poll() is None:
                    time.sleep(0.05)
                child.send_signal(signal.SIGINT)
                self.assertIn("KeyboardInterrupt", child.communicate()[1])
            self.expect_rest()


class Addresses(unittest.TestCase):
    def test_where_nobody_listens_is_said_at_once(self) -> None:
        url = f"http://127.0.0.1:{free_port()}"
        twin = AsyncClient(url)
        ways: list[Callable[[Problem], Result]] = [Client(url).solve, lambda problem: asyncio.run(twin.solve(problem))]
        for solve in ways:
            began = time.monotonic()
            with self.assertRaisesRegex(ServiceUnreachable, url):
                solve(block())
            self.assertLess(time.monotonic() - began, 2)
        with self.assertRaisesRegex(ServiceUnreachable, "no-such-program"):
            Local("no-such-program").solve(block())

    def test_an_address_that_is_none_is_refused(self) -> None:
        for url in ("127.0.0.1:8080", "ftp://host", "http://"):
            with self.assertRaisesRegex(ValueError, "is no address of a service"):
                Client(url)

    def test_a_token_is_shown(self) -> None:
        with tempfile.NamedTemporaryFile("w") as tokens:
            tokens.write("anne read,solve 0123456789abcdef0123\n")
            tokens.flush()
            with Daemon("--token-file", tokens.name) as daemon:
                with self.assertRaises(Refused) as caught:
                    Client(daemon.url).examples()
                self.assertEqual(caught.exception.status, 401)
                self.assertIn("hertz-half-disc", Client(daemon.url, token="0123456789abcdef0123").examples())
                twin = AsyncClient(daemon.url, token="0123456789abcdef0123")
                self.assertEqual(asyncio.run(twin.solve(block())).status, "succeeded")

    def test_the_environment_may_name_the_service(self) -> None:
        program = "from signorini import Client; print(len(Client().examples()))"
        with Daemon() as daemon:
            environment = os.environ | {"SIGNORINI_URL": daemon.url}
            said = subprocess.run([sys.executable, "-c", program], env=environment, check=True, capture_output=True)
        self.assertGreater(int(said.stdout), 10)

    def test_several_threads_share_a_client(self) -> None:
        with Daemon() as daemon:
            client = Client(daemon.url)
            with ThreadPoolExecutor(8) as threads:
                results = list(threads.map(client.solve, [block(100 + i) for i in range(8)]))
        self.assertEqual([result.problem["material"]["young"] for result in results], [100 + i for i in range(8)])


if __name__ == "__main__":
    unittest.main()
