"""What is said to a service that is full, lost, restarted or left: conversations with a pretended one."""

from __future__ import annotations

import email.utils
import json
import time
import unittest
import warnings
from collections import Counter
from typing import Any

from pretended_service import PretendedService, drive, reply
from signorini import BadReply, Refused, ResultsDropped, ServiceUnreachable
from signorini.conversation import MOST_LOSSES, Line, Ticket, ask, checked_patience, list_solves, solve, solve_all
from signorini.exchange import Hopeless, Lost, Pause, Request
from signorini.result import Result

PATIENCE = 60.0


def tickets(count: int) -> list[Ticket]:
    return [Ticket(json.dumps({"young": number}).encode(), ["problem"]) for number in range(count)]


def map_by(service: PretendedService, count: int, **options: Any) -> Any:
    told: list[int] = []
    results = drive(solve_all(Line(PATIENCE, service.clock), tickets(count), told.append), service, **options)
    assert told == sorted(told) and told[-1] == count, told
    return results


class Many(unittest.TestCase):
    def expect_all(self, results: list[Result], count: int, service: PretendedService) -> None:
        """Every problem has its result, in order, and was solved once."""
        self.assertEqual([result.problem["young"] for result in results], list(range(count)))
        self.assertEqual(len(service.bodies), count)

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

    def test_what_ends_out_of_turn_is_fetched_before_it_is_dropped(self) -> None:
        service = PretendedService(seconds=0.1, kept=20, workers=2)
        slow = Ticket(b'{"young": 0, "slow": 1}', ["problem"])
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            drive(solve_all(Line(PATIENCE, service.clock), [slow, *tickets(800)], lambda done: None), service)
        self.assertEqual(len(service.bodies), 801)
        # The others, 80 s of work, were done while the slow one ran.
        self.assertLess(service.now, 105)

    def test_a_list_that_may_not_be_read_is_done_without(self) -> None:
        service = PretendedService(seconds=0.1)

        def forbid(step: Request | Pause) -> None:
            if isinstance(step, Request) and step.method == "GET":
                service.prepared = [reply(403, {"title": "No"})]

        self.expect_all(map_by(service, 60, before=forbid), 60, service)

    def test_what_a_service_drops_is_solved_again_and_less_is_given_to_it(self) -> None:
        for kept, workers in ((1, 1), (1, 2), (3, 4), (10, 2)):
            service = PretendedService(seconds=0.001, limit=1000, kept=kept, workers=workers)
            with self.assertWarnsRegex(RuntimeWarning, "dropped a result .* keeps too little .--keep-bytes"):
                results = map_by(service, 500)
            self.assertEqual([result.problem["young"] for result in results], list(range(500)))
            self.assertLess(len(service.bodies), 500 + 200)
            self.assertLessEqual(max(Counter(service.bodies).values()), 1 + MOST_LOSSES)

    def test_a_restart_without_memory_costs_what_was_under_way(self) -> None:
        service = PretendedService(seconds=0.1)
        forgotten: list[int] = []

        def forget(step: Request | Pause) -> None:
            if service.now > 10 and not forgotten:
                forgotten.append(len(service.unfinished()))
                service.jobs = {}
                service.free_at = [service.now]

        with self.assertWarns(RuntimeWarning):
            results = map_by(service, 300, before=forget)
        self.assertEqual([result.problem["young"] for result in results], list(range(300)))
        self.assertLessEqual(len(service.bodies) - 300, forgotten[0] + 5)

    def test_what_is_dropped_again_and_again_is_said(self) -> None:
        service = PretendedService(seconds=100.0)

        def delete(step: Request | Pause) -> None:
            service.jobs = {}

        with self.assertRaisesRegex(ResultsDropped, "found for problem 0 .* 3 times: it keeps too little"):
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                map_by(service, 3, before=delete)
        self.assertLess(len(service.bodies), 10)

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
                service.requests.clear()
                raise KeyboardInterrupt

        with self.assertRaises(KeyboardInterrupt):
            map_by(service, 60, before=interrupt)
        self.assertEqual([request.method for request in service.requests], ["DELETE"])

    def test_an_interruption_of_a_silent_service_is_short(self) -> None:
        service = PretendedService(limit=16, seconds=100.0)
        waits: list[float] = []

        def interrupt(step: Request | Pause) -> None:
            if len(service.jobs) == 10 and service.is_up:
                service.is_up = False
                raise KeyboardInterrupt
            if not service.is_up and isinstance(step, Request):
                waits.append(step.timeout)

        with self.assertRaises(KeyboardInterrupt):
            map_by(service, 60, before=interrupt)
        self.assertEqual(waits, [5.0])

    def test_a_bad_problem_is_named_and_the_others_are_cancelled(self) -> None:
        for place, seconds in ((3, 100.0), (200, 0.01)):
            service = PretendedService(seconds=seconds)
            bad = [*tickets(place), Ticket(b'"bad"', []), *tickets(2)]
            with self.assertRaises(Refused) as caught:
                drive(solve_all(Line(PATIENCE, service.clock), bad, lambda done: None), service)
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

    def test_a_service_that_does_not_wait_is_not_asked_in_haste(self) -> None:
        for count in (1, 40):
            service = PretendedService(seconds=100.0)
            service.waits = False
            map_by(service, count)
            self.assertLess(len(service.requests), 3 * 100 * count)

    def test_a_solve_whose_result_was_dropped_is_solved_again(self) -> None:
        service = PretendedService(seconds=75.0)

        def forget(step: Request | Pause) -> None:
            if len(service.requests) == 1:
                service.jobs = {}

        with self.assertWarns(RuntimeWarning):
            result = drive(solve(Line(PATIENCE, service.clock), tickets(1)[0]), service, forget)
        self.assertEqual((result.status, len(service.bodies)), ("succeeded", 2))

    def test_two_solves_have_two_keys(self) -> None:
        first, second = tickets(2)
        self.assertNotEqual(first.key, second.key)

    def test_a_service_that_never_answered_is_not_waited_for(self) -> None:
        service = PretendedService()
        service.is_up = False
        with self.assertRaisesRegex(ServiceUnreachable, "nobody listens"):
            drive(solve(Line(PATIENCE), tickets(1)[0]), service)
        self.assertLess(service.now, 0.1)

    def test_a_service_whose_first_reply_is_lost_never_answered(self) -> None:
        service = PretendedService()
        talk = ask(Line(PATIENCE), Request("GET", "/"))
        next(talk)
        with self.assertRaisesRegex(ServiceUnreachable, "reset"):
            talk.send(Lost("the line was reset", reached=False))
        self.assertEqual(service.requests, [])

    def test_what_is_hopeless_is_not_repeated(self) -> None:
        talk = ask(Line(PATIENCE), Request("GET", "/"))
        next(talk)
        talk.send(reply(503, {}))
        talk.send(None)
        with self.assertRaisesRegex(ServiceUnreachable, "not trusted"):
            talk.send(Hopeless(ServiceUnreachable("its certificate is not trusted")))

    def test_patience_is_a_number(self) -> None:
        for patience in (-1, float("nan"), "60", None, True):
            with self.assertRaisesRegex(ValueError, "patience is a number of seconds"):
                checked_patience(patience)  # type: ignore[arg-type]
        for seconds in (0, 0.5, float("inf")):
            self.assertEqual(checked_patience(seconds), seconds)

    def test_patience_ends(self) -> None:
        for lost in (PretendedService(lost=1.0, seconds=100.0), PretendedService(seconds=100.0)):

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

    def test_every_time_to_retry_is_bounded(self) -> None:
        date = "Fri, 27 Nov 2026 12:00:00 GMT"
        for said, seconds in (
            ("3", 3), ("1.5", 1.5), ("0", 0.1), ("1000000000", 300), ("9" * 400, 300), ("-1", 5), ("", 5), ("soon", 5),
            ("nan", 5), ("inf", 5), ("²", 5), ("Fri, 27 Nov 2026 12:00:42 GMT", 42), ("Fri, 99 Nov 2026 12:00 GMT", 5),
            ("Fri, 27 Nov 2026 11:00:00 GMT", 0.1), ("Fri, 27 Nov 9999 11:00:00 GMT", 300),
        ):  # fmt: skip
            service = PretendedService()
            service.prepared = [reply(503, {}, {"retry-after": said, "date": date}), reply(200, {})]
            drive(ask(Line(PATIENCE), Request("GET", "/")), service)
            self.assertAlmostEqual(service.now, seconds + 0.002, 9, said)
        service.prepared = [reply(429, {}), reply(200, {})]
        drive(ask(Line(PATIENCE), Request("GET", "/")), service)
        self.assertAlmostEqual(service.now, 300.004 + 5, 9)

    def test_a_date_without_that_of_the_reply_is_by_this_clock(self) -> None:
        in_a_minute = email.utils.formatdate(time.time() + 60, usegmt=True)
        self.assertAlmostEqual(reply(503, {}, {"retry-after": in_a_minute}).retry_after, 60, delta=3)

    def test_pages_that_lead_nowhere_are_no_list(self) -> None:
        first = "/v1/solves?limit=1000"
        for following in (first, "http://elsewhere/", "/v1/solves?after=a\r\nb", 3, "/ö"):
            service = PretendedService()
            service.prepared = [reply(200, {"solves": [], "links": {"next": following}})]
            with self.assertRaisesRegex(BadReply, "it cannot be followed by"):
                drive(list_solves(Line(PATIENCE), Request("GET", first)), service)

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
