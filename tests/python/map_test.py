"""Five hundred problems in one call, with a full queue and a restart of the service in the middle."""

from __future__ import annotations

import asyncio
import dataclasses
import io
import re
import signal
import tempfile
import threading
import time
import unittest
from collections import Counter
from collections.abc import Callable

from daemon import PROGRAM, STOPPED_EARLY, Daemon, block
from signorini import AsyncClient, Client, Local, Refused, Result
from signorini.exchange import Request
from signorini.progress import ProgressBar


class Many(unittest.TestCase):
    def expect_once(self, daemon: Daemon, count: int) -> None:
        """The service has as many solves as there were problems, each with another title, all succeeded."""
        solves = Client(daemon.url)._ask(Request("GET", "/v1/solves?limit=1000"))["solves"]
        self.assertEqual(Counter(solve["status"] for solve in solves), {"succeeded": count})
        self.assertEqual(len({solve["title"] for solve in solves}), count)

    def test_no_problem_is_lost_or_solved_twice(self) -> None:
        with tempfile.TemporaryDirectory() as directory, Daemon("--queue-limit", "64", data_dir=directory) as daemon:
            screen = io.StringIO()
            bar = ProgressBar(screen)

            def restart() -> None:
                daemon.end(signal.SIGTERM)
                daemon.start()

            restarting = threading.Thread(target=restart)

            def tell(done: int, count: int) -> None:
                bar(done, count)
                if done >= 250 and restarting.ident is None:
                    restarting.start()

            problems = [block(100.0 + i, divisions=(16, 8), title=f"young {100 + i}") for i in range(500)]
            results = Client(daemon.url).map(problems, fields=["problem"], progress=tell)

            restarting.join()
            youngs = [result.problem["material"]["young"] for result in results]
            self.assertEqual(youngs, [100.0 + i for i in range(500)])
            self.assertEqual(len({result.id for result in results}), 500)
            for result in results:
                self.assertAlmostEqual(result.check().summary.contact.force, 2.0, 6)
            self.expect_once(daemon, 500)
            log = "".join(daemon.log)
            self.assertIn("status=503", log)
            self.assertEqual(log.count("listening on "), 2)
            self.assertRegex(screen.getvalue(), re.escape(f"[{'#' * 40}] 500/500, ") + r"[0-9.]+ s\n$")
            print("\n" + screen.getvalue().split("\r")[-1], end="")

    def test_the_twin_goes_on_after_a_crash(self) -> None:
        with tempfile.TemporaryDirectory() as directory, Daemon(data_dir=directory) as daemon:

            async def solve() -> list[float]:
                restarts: list[asyncio.Future[None]] = []

                def restart() -> None:
                    daemon.end(signal.SIGKILL)
                    daemon.start()

                def tell(done: int, count: int) -> None:
                    if done >= 10 and not restarts:
                        restarts.append(asyncio.get_running_loop().run_in_executor(None, restart))

                problems = [block(100.0 + i, divisions=(16, 8), title=f"young {100 + i}") for i in range(60)]
                results = await AsyncClient(daemon.url).map(problems, fields=["problem"], progress=tell)
                await asyncio.gather(*restarts)
                self.assertEqual(len(restarts), 1)
                return [result.problem["material"]["young"] for result in results]

            self.assertEqual(asyncio.run(solve()), [100.0 + i for i in range(60)])
            self.expect_once(daemon, 60)

    def test_a_service_that_keeps_little_loses_nothing(self) -> None:
        problems = [block(100.0 + i, divisions=(16, 8), title=f"young {100 + i}") for i in range(40)]

        def tarry(done: int, count: int) -> None:
            time.sleep(0.03)  # while the workers go on

        ways: list[Callable[[str], list[Result]]] = [
            lambda url: Client(url).map(problems, progress=tarry),
            lambda url: asyncio.run(AsyncClient(url).map(problems, progress=tarry)),
        ]
        for solve_all in ways:
            with Daemon("--keep-bytes", "1") as daemon, self.assertWarnsRegex(RuntimeWarning, "keeps too little"):
                results = solve_all(daemon.url)
            youngs = [result.problem["material"]["young"] for result in results]
            self.assertEqual(youngs, [100.0 + i for i in range(40)])
            again = "".join(daemon.log).count("accepted") - 40
            print(f"\nof 40 problems {again} were solved again by a service that keeps one result")
            self.assertLess(again, 30)

    def test_a_solve_that_fails_is_a_result_among_the_others(self) -> None:
        failing = dataclasses.replace(block(), solver=STOPPED_EARLY)
        with Daemon() as daemon:
            for solve_all in (Client(daemon.url).map, Local(PROGRAM, workers=2).map):
                results = solve_all([block(), failing, block(300)])
                self.assertEqual([result.status for result in results], ["succeeded", "failed", "succeeded"])
                self.assertIn("iterations", results[1].error or "")

    def test_the_command_line_solves_many_in_order(self) -> None:
        told: list[tuple[int, int]] = []
        results = Local(PROGRAM, workers=2).map(
            [block(100.0 + i) for i in range(12)],
            fields=["problem"],
            progress=lambda done, count: told.append((done, count)),
        )
        self.assertEqual([result.problem["material"]["young"] for result in results], [100.0 + i for i in range(12)])
        self.assertEqual(told, [(i, 12) for i in range(1, 13)])
        with self.assertRaises(Refused) as caught:
            Local(PROGRAM).map([block(), block(-1.0)])
        self.assertEqual(caught.exception.index, 1)


if __name__ == "__main__":
    unittest.main()
