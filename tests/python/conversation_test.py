"""What is said to a service that is full, lost, restarted or left: conversations with a pretended one."""

from __future__ import annotations

import json
import unittest
from typing import Any

from pretended_service import PretendedService, drive, reply
from signorini import Refused, ServiceUnreachable
from signorini.conversation import Line, Ticket, ask, solve, solve_all
from signorini.exchange import Pause, Request
from signorini.result import Result

PATIENCE = 60.0


def tickets(count: int) -> list[Ticket]:
    return [Ticket(json.dumps({"young": number}).encode(), ["problem"]) for number in range(count)]


def map_by(service: PretendedService, count: int, **options: Any) -> Any:
    told: list[int] = []
    results = drive(solve_all(Line(PATIENCE), tickets(count), told.append, service.clock), service, **options)
    assert told == sorted(told) and told[-1] == count, told
    return results


class Many(unittest.TestCase):
    def expect_all(self, results: list[Result], count: int, service: PretendedService) -> None:
        """Every problem has its result, in order, and was solved once."""
        self.assertEqual([result.problem["young"] for result in results], list(range(count)))
        self.assertEqual(len(service.jobs), count)

    def test_all_are_solved_in_order(self) -> None:
        for count in (1, 2, 500):
            service = PretendedService(limit=1000)
            self.expect_all(map_by(service, count), count, service)
        self.assertEqual(drive(solve_all(Line(PATIENCE), [], lambda done: None), service), [])

    def test_a_full_queue_is_left_alone_as_long_as_it_says(self) -> None:
        service = PretendedService()
        self.expect_all(map_by(service, 500), 500, service)
        self.assertTrue(service.refused_at)
        for refused in service.refused_at:
            early = [accepted for accepted in service.accepted_at if refused < accepted < refused + service.retry_after]
            self.assertEqual(early, [])

    def test_a_queue_that_was_full_once_is_kept_filled_and_not_full(self) -> None:
        service = PretendedService(seconds=0.1)
        unfinished: list[int] = []
        self.expect_all(
            map_by(service, 500, before=lambda step: unfinished.append(len(service.unfinished()))), 500, service
        )
        self.assertEqual(len(service.refused_at), 1)
        self.assertGreater(max(unfinished), 60)
        # From the end of the first pause on the worker always has something to do.
        self.assertLess(service.now, 500 * 0.1 + 1)

    def test_lost_requests_and_replies_lose_no_problem_and_solve_none_twice(self) -> None:
        for seed in range(20):
            service = PretendedService(limit=16, lost=0.3, seed=seed)
            self.expect_all(map_by(service, 60), 60, service)

    def test_a_restart_is_waited_for(self) -> None:
        service = PretendedService(limit=16, seconds=0.1)

        def restart(step: Request | Pause) -> None:
            service.is_up = not 2.0 < service.now < 22.0

        self.expect_all(map_by(service, 60, before=restart), 60, service)
        self.assertGreater(service.now, 22.0)

    def test_an_interruption_at_any_time_cancels_what_has_not_ended(self) -> None:
        class Interrupted(BaseException):
            pass

        for moment in range(90):
            service = PretendedService(limit=16, seconds=100.0)
            steps = 0

            def interrupt(step: Request | Pause) -> None:
                nonlocal steps
                steps += 1
                if steps == moment + 1:
                    service.do(step)  # it arrives, and nobody reads the reply
                    raise Interrupted

            with self.assertRaises(Interrupted):
                map_by(service, 60, before=interrupt)
            self.assertEqual(service.unfinished(), [], moment)

    def test_an_interruption_while_the_service_is_away_is_short(self) -> None:
        service = PretendedService(limit=16, seconds=100.0)

        def interrupt(step: Request | Pause) -> None:
            if len(service.jobs) == 10 and service.is_up:
                service.is_up = False
                raise KeyboardInterrupt

        with self.assertRaises(KeyboardInterrupt):
            map_by(service, 60, before=interrupt)
        self.assertEqual([request.method for request in service.requests[10:]], ["DELETE"])

    def test_a_bad_problem_is_named_and_the_others_are_cancelled(self) -> None:
        for place, seconds in ((3, 100.0), (200, 0.01)):
            service = PretendedService(seconds=seconds)
            bad = [*tickets(place), Ticket(b'"bad"', []), *tickets(2)]
            with self.assertRaises(Refused) as caught:
                drive(solve_all(Line(PATIENCE), bad, lambda done: None, service.clock), service)
            self.assertEqual(caught.exception.index, place)
            self.assertIn(f"problem {place}: A bad problem: It is bad.", str(caught.exception))
            self.assertEqual((len(service.jobs), service.unfinished()), (place, []))


class One(unittest.TestCase):
    def test_a_long_solve_is_asked_for_again_under_the_same_key(self) -> None:
        service = PretendedService(seconds=1000.0)
        result = drive(solve(Line(PATIENCE), tickets(1)[0]), service)
        self.assertEqual((result.status, len(service.jobs)), ("succeeded", 1))
        self.assertLess(len(service.requests), 25)
        self.assertEqual(len({request.headers["Idempotency-Key"] for request in service.requests}), 1)

    def test_two_solves_have_two_keys(self) -> None:
        first, second = tickets(2)
        self.assertNotEqual(first.key, second.key)

    def test_a_service_that_never_answered_is_not_waited_for(self) -> None:
        service = PretendedService()
        service.is_up = False
        with self.assertRaisesRegex(ServiceUnreachable, "nobody listens"):
            drive(solve(Line(PATIENCE), tickets(1)[0]), service)
        self.assertLess(service.now, 0.1)

    def test_patience_ends(self) -> None:
        for lost in (PretendedService(lost=1.0), PretendedService(seconds=100.0)):

            def leave(step: Request | Pause, lost: PretendedService = lost) -> None:
                lost.is_up = not lost.jobs

            with self.assertRaises(ServiceUnreachable):
                drive(solve(Line(PATIENCE), tickets(1)[0]), lost, leave)
            self.assertGreater(lost.now, PATIENCE)
            self.assertLess(lost.now, PATIENCE + 60)

    def test_an_interruption_cancels_it(self) -> None:
        service = PretendedService(seconds=1000.0)
        interruptions = iter([KeyboardInterrupt()])

        def interrupt(step: Request | Pause) -> None:
            if len(service.requests) == 1:
                for interruption in interruptions:
                    raise interruption

        with self.assertRaises(KeyboardInterrupt):
            drive(solve(Line(PATIENCE), tickets(1)[0]), service, interrupt)
        self.assertEqual((len(service.jobs), service.unfinished()), (1, []))

    def test_refusals_for_now_and_gateways_are_waited_for(self) -> None:
        service = PretendedService()
        service.prepared = [
            reply(429, {}, {"retry-after": "3"}), reply(503, {}, {"retry-after": "7"}), reply(502, {}), reply(503, {}),
            reply(200, {"examples": []}),
        ]  # fmt: skip
        self.assertEqual(drive(ask(Line(PATIENCE), Request("GET", "/v1/examples")), service), {"examples": []})
        self.assertAlmostEqual(service.now, 3 + 7 + 0.1 + 0.2, delta=0.1)

    def test_other_refusals_are_errors(self) -> None:
        service = PretendedService()
        errors = [{"pointer": "/scheme", "detail": "must be one of conforming, nonconforming"}]
        details = {"type": "urn:bad", "title": "Bad", "detail": "One fault.", "errors": errors}
        for status in (400, 401, 404, 409, 422, 500):
            service.prepared = [reply(status, details)]
            with self.assertRaises(Refused) as caught:
                drive(ask(Line(PATIENCE), Request("GET", "/")), service)
            self.assertEqual((caught.exception.status, caught.exception.faults[0].pointer), (status, "/scheme"))
            self.assertIn("/scheme must be one of conforming", str(caught.exception))


if __name__ == "__main__":
    unittest.main()
