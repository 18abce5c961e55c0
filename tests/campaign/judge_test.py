"""The judge is right where the answer is known, and catches what is wrong.

    judge_test.py PATH-TO-SIGNORINID
"""
import copy
import json
import math
import pathlib
import sys
import unittest

import numpy as np

import checks
import generator
import primal
import service
import units
from expression import Field
from gap import GapSamples

HERE = pathlib.Path(__file__).resolve().parent
DAEMON = ""


def energies(document, triangles=400):
    ladder = primal.Ladder(document, DAEMON, triangles)
    return [ladder.level(0), ladder.level(1)], ladder


def known(name):
    return json.loads((HERE / "known" / f"{name}.json").read_text(encoding="utf-8"))


class Expressions(unittest.TestCase):
    def test_operators_bind_as_the_service_has_them(self):
        at = np.array([[2.0, 3.0]])
        for text, value in {"-x^2": -4, "2^3^2": 512, "2^-1": 0.5, "-2*y^2": -18, "1 < 2 == 1": 1, "1 || 0 && 0": 1,
                            "x < 1 ? 2 : y < 4 ? 5 : 6": 5, "max(1, x, -3)": 2, "3-2-1": 0, "1 - -1": 2, "pi": math.pi,
                            "atan2(y, x)": math.atan2(3, 2), "1e-3*x": 2e-3}.items():
            self.assertAlmostEqual(Field(text)(at)[0], value, msg=text)


class Energies(unittest.TestCase):
    """Where the least energy is known: never below it, and near."""

    def expect(self, document, exact, relative):
        levels, ladder = energies(document)
        for energy, error in levels:
            self.assertGreaterEqual(energy + error + 1e-12 * abs(exact), exact)
        self.assertLess(levels[1][0] - exact, relative * abs(exact))
        self.assertLessEqual(ladder.likely_least(1), exact)

    def test_signorini_edge(self):
        u = "(x^2 + y^2)^0.75 * cos(1.5 * atan2(y, x))"
        fixed = {"type": "fixed", "value": u}
        self.expect({"model": "membrane", "domain": {"type": "rectangle", "origin": [-1, 0], "size": [2, 1]},
                     "material": {"stiffness": 1},
                     "boundary": {"bottom": {"type": "contact"}, "left": fixed, "right": fixed, "top": fixed}},
                    1.7216903620444786, 2e-5)

    def test_fixed_values_that_are_no_polynomials(self):
        # u = eˣ cos y is harmonic: ½ ∫ |∇u|² = ½ ∫ e²ˣ.
        self.expect({"model": "membrane", "domain": {"type": "rectangle"}, "material": {"stiffness": 1},
                     "boundary": {"all": {"type": "fixed", "value": "exp(x) * cos(y)"}}}, (math.exp(2) - 1) / 4, 1e-6)

    def test_block_pressed_between_rollers(self):
        # σ_yy = −p over E' = E (1 − ν) / ((1 + ν)(1 − 2 ν)), held below by contact alone.
        young, nu, p = 3.0, 0.3, 0.2
        modulus = young * (1 - nu) / ((1 + nu) * (1 - 2 * nu))
        self.expect({"model": "elasticity", "domain": {"type": "rectangle"},
                     "material": {"young": young, "poisson": nu},
                     "boundary": {"left": {"type": "roller"}, "right": {"type": "roller"},
                                  "bottom": {"type": "contact"}, "top": {"type": "traction", "pressure": p}}},
                    -p * p / (2 * modulus), 1e-6)

    def test_load_that_jumps_within_triangles(self):
        self.expect(known("jump-off-the-lines"), -4.627739, 1e-5)

    def test_other_units(self):
        document = known("elastic-young-circle")
        (energy, error), _ = energies(document)[0]
        (other, _), _ = energies(units.scaled(document, 1e9, 1e-9, 1e3))[0]
        self.assertAlmostEqual(other / 1e-15 / energy, 1, delta=1e-9 + 2 * error / abs(energy))


class Admissibility(unittest.TestCase):
    def test_narrow_ridge_is_seen(self):
        nodes = np.array([[0.0, 0.0], [1.0, 0.0], [0.5, 0.0]])
        contacts = [({"gap": "abs(x - 0.4142) < 0.01 ? 0.02 : 0.3"}, np.array([[0, 1, 2]]), np.array([[0.0, -1.0]]))]
        excess, where = GapSamples(contacts, nodes).excess(np.array([[0.1, 0.1, 0.1]]))
        self.assertAlmostEqual(excess[0], 0.08)
        self.assertAlmostEqual(where[0], 0.4142, delta=0.01)

    def test_displacement_stays_above_the_foundation(self):
        for name in ("gap-notch", "gap-frequency", "gap-kink"):
            document = known(name)
            mesh = primal.mesh_for(document, DAEMON, 400)
            found = primal.Primal(document, mesh).minimize()
            gap = Field(document["boundary"]["bottom"]["gap"])
            s = np.tile(np.random.default_rng(1).random(4000), (len(found.contact_edges), 1))
            x = found.along(found.contact_edges, s)
            v = found.trace() @ primal.edge_shapes(s[0]).T
            self.assertLess((v - gap(x)).max(), 1e-9, name)


class Verdicts(unittest.TestCase):
    def setUp(self):
        self.document = known("stiffness-circle")
        self.run = service.run(DAEMON, "first", self.document)
        self.run.result["summary"]["error_bound"]["guaranteed"] = True
        levels, self.ladder = energies(self.document)
        (self.upper, _), (self.finer, _) = levels

    def claim(self, lower, upper):
        run = copy.deepcopy(self.run)
        run.result["summary"]["error_bound"].update(energy_lower=lower, energy_upper=upper)
        return run

    def contradictions(self, *runs):
        report = checks.Report("claims")
        checks.compare_intervals(runs, 0, report)
        checks.compare_with_primal(runs, self.ladder, report)
        return report.contradictions

    def test_honest_claim_stands(self):
        width = abs(self.finer) * 0.05
        self.assertEqual(self.contradictions(self.claim(self.finer - width, self.finer + width)), [])

    def test_claims_that_are_disjoint(self):
        width = abs(self.finer) * 0.05
        found = self.contradictions(self.claim(self.finer - 2 * width, self.finer - width / 2),
                                    self.claim(self.finer - width / 4, self.finer + width))
        self.assertTrue(any("disjoint" in text for text in found))

    def test_claim_that_is_too_high(self):
        size = abs(self.finer)
        found = self.contradictions(self.claim(self.upper + 0.01 * size, self.upper + 0.1 * size))
        self.assertTrue(any("lies above" in text for text in found))

    def test_claim_that_is_too_low(self):
        size = abs(self.finer)
        found = self.contradictions(self.claim(self.finer - 0.5 * size, self.finer - 0.1 * size))
        self.assertTrue(any("lies below" in text for text in found))

    def test_same_seed_same_problem(self):
        for seed in range(100):
            self.assertEqual(generator.problem(seed), generator.problem(seed))


if __name__ == "__main__":
    DAEMON = sys.argv.pop(1)
    unittest.main()
