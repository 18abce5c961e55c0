"""Pictures show the values of the result, and the figures of the paper what it computed."""

from __future__ import annotations

import dataclasses
import pathlib
import subprocess
import sys
import tempfile
import unittest
import warnings
import xml.etree.ElementTree
from typing import Any

import numpy
from matplotlib import pyplot

from daemon import PROGRAM, STOPPED_EARLY, block
from signorini import Local, NotInResult, Result
from signorini.figures import CONFORMING, NONCONFORMING, draw_nodes, draw_solution, write_figures

ELASTIC = Local(PROGRAM).solve(block())
MEMBRANE = Local(PROGRAM).solve(NONCONFORMING.problem())
CONFORMING_RESULT = CONFORMING.solve(Local(PROGRAM))


def drawn_values(axes: Any) -> Any:
    return axes.collections[0].get_array()


class Plots(unittest.TestCase):
    def tearDown(self) -> None:
        pyplot.close("all")

    def test_a_field_has_its_values(self) -> None:
        stress = ELASTIC.stress.at_centroids
        fields = {
            "displacement": numpy.hypot(*ELASTIC.displacement.at_points.T),
            "von_mises": ELASTIC.von_mises,
            "stress_yy": stress[:, 1],
            "stress": numpy.sqrt(stress[:, 0] ** 2 + stress[:, 1] ** 2 + 2 * stress[:, 2] ** 2),
        }
        for field, values in fields.items():
            numpy.testing.assert_allclose(drawn_values(ELASTIC.plot(field)), values, err_msg=field)
        numpy.testing.assert_allclose(drawn_values(MEMBRANE.plot()), MEMBRANE.displacement.at_points)
        numpy.testing.assert_allclose(drawn_values(MEMBRANE.plot("stress_x")), MEMBRANE.stress.at_centroids[:, 0])

    def test_a_body_is_deformed_as_much_as_is_asked_for(self) -> None:
        triangles = ELASTIC.mesh.triangles
        for scale in (0.0, 3.0):
            paths = ELASTIC.plot("von_mises", deformed=scale).collections[0].get_paths()
            points = ELASTIC.mesh.points + scale * ELASTIC.displacement.at_points
            numpy.testing.assert_allclose(paths[5].vertices[:3], points[triangles[5]])

    def test_curves_have_their_values(self) -> None:
        axes = ELASTIC.plot("contact")
        numpy.testing.assert_allclose(axes.lines[0].get_ydata(), ELASTIC.contact["bottom"].pressure)
        self.assertAlmostEqual(axes.lines[0].get_xdata()[-1], 2.0)
        labels = [line.get_label() for line in MEMBRANE.plot("history").lines]
        self.assertIn("displacement change", labels)
        self.assertNotIn("penetration", [line.get_label() for line in ELASTIC.plot("history").lines])

    def test_axes_can_be_given(self) -> None:
        axes = pyplot.subplots()[1]
        self.assertIs(ELASTIC.plot("stress", axes=axes), axes)

    def test_another_field_is_refused(self) -> None:
        for result, field in ((ELASTIC, "strain"), (ELASTIC, "stress_x"), (MEMBRANE, "stress_yy")):
            with self.assertRaisesRegex(ValueError, "there is no field"):
                result.plot(field)
        with self.assertRaises(NotInResult):
            MEMBRANE.plot("von_mises")

    def test_what_a_result_lacks_is_said(self) -> None:
        document = dict(ELASTIC.document)
        zeros = {name: numpy.zeros_like(column) for name, column in document["history"].items()}
        empty = {name: column[:0] for name, column in document["history"].items()}
        numbers = pyplot.get_fignums()
        lacks: list[tuple[str, dict[str, Any]]] = [
            ("history", {"history": None}), ("history", {"history": empty}), ("history", {"history": zeros}),
            ("contact", {"contact": None}), ("contact", {"contact": {}}), ("stress", {"stress": None}),
            ("stress_xx", {"mesh": None}), ("displacement", {"displacement": None}), ("von_mises", {"von_mises": None}),
            ("displacement", {"mesh": None}),
        ]  # fmt: skip
        for field, without in lacks:
            with self.subTest(field, without=without), warnings.catch_warnings():
                warnings.simplefilter("error")
                with self.assertRaisesRegex(NotInResult, "^this result has no (history|contact|stress|mesh|disp|von)"):
                    Result(document | without).plot(field)
        with self.assertRaisesRegex(NotInResult, "no displacement"):
            Result(document | {"displacement": None}).plot("von_mises", deformed=2)
        self.assertEqual(pyplot.get_fignums(), numbers)  # none is left empty

    def test_every_result_of_a_solve_that_fails_is_drawn_or_lacks_it(self) -> None:
        sliding = dataclasses.replace(block(), boundary={"bottom": block().boundary["bottom"]})
        for problem in (sliding, dataclasses.replace(block(), solver=STOPPED_EARLY)):
            (result,) = Local(PROGRAM).map([problem])
            self.assertEqual(result.status, "failed")
            for field in ("displacement", "stress", "von_mises", "contact", "history"):
                try:
                    result.plot(field)
                except NotInResult as error:
                    self.assertIn("this result has no", str(error))


class Figures(unittest.TestCase):
    def tearDown(self) -> None:
        pyplot.close("all")

    def test_the_computations_are_those_of_the_paper(self) -> None:
        solver = {"method": "uzawa", "rho": 0.05, "augmentation": 1, "tolerance": 1e-5}
        for experiment, divisions in ((CONFORMING, 8), (NONCONFORMING, 14)):
            problem = experiment.problem().document()
            self.assertLessEqual(solver.items(), problem["solver"].items())
            self.assertEqual(problem["mesh"]["divisions"], [divisions, divisions])
        self.assertEqual(CONFORMING_RESULT.summary.iterations, 200)
        self.assertEqual(MEMBRANE.summary.outcome, "converged")

    def test_the_nodes_are_those_of_the_schemes(self) -> None:
        for experiment, result, counts in (
            # On two triangles with five edges: two a side and one inside, three corners each, both ends of the top.
            (CONFORMING, CONFORMING_RESULT, {"stress": 2 * 5 + 2, "displacement": 6, "clearance": 2}),
            (NONCONFORMING, MEMBRANE, {"stress": 5, "displacement": 2, "clearance": 1}),
        ):
            whole, square = draw_nodes(result, experiment).axes
            drawn = {line.get_label(): {tuple(point) for point in line.get_xydata().round(9)} for line in square.lines}
            self.assertEqual({label: len(points) for label, points in drawn.items()}, counts)
            divisions = experiment.divisions
            self.assertEqual(whole.get_title(), f"{divisions}×{divisions}, {2 * divisions**2} triangles")

    def test_the_clearance_is_drawn_beside_the_displacement(self) -> None:
        for experiment, result in ((CONFORMING, CONFORMING_RESULT), (NONCONFORMING, MEMBRANE)):
            surface, curves = draw_solution(result, experiment).axes
            (clearance,) = (line for line in curves.lines if "lambda" in line.get_label())
            numpy.testing.assert_allclose(clearance.get_ydata(), result.contact["top"].clearance)
            edges = [line for line in curves.lines if line is not clearance]
            self.assertEqual(len(edges), experiment.divisions)
            # λ_h is close to u_h along the contact boundary, as the paper says.
            middles = {round(float(line.get_xdata().mean()), 6): float(line.get_ydata().mean()) for line in edges}
            along = numpy.interp(list(middles), *clearance.get_data())
            self.assertLess(abs(along - list(middles.values())).max(), 0.06)
            self.assertEqual(len(surface.collections[0]._vec[0]), 3 * result.summary.triangles)

    def test_one_command_writes_them_the_same_every_time(self) -> None:
        with tempfile.TemporaryDirectory() as directory:
            first, second = pathlib.Path(directory) / "first", pathlib.Path(directory) / "second"
            command = [sys.executable, "-m", "signorini", "figures", str(first), "--program", PROGRAM]
            said = subprocess.run(command, check=True, capture_output=True, text=True).stdout.split()
            names = [f"figure-6.{number}.svg" for number in range(1, 5)]
            self.assertEqual(said, [str(first / name) for name in names])
            self.assertEqual([path.name for path in write_figures(Local(PROGRAM), second)], names)
            for name in names:
                root = xml.etree.ElementTree.parse(first / name).getroot()
                self.assertEqual(root.tag, "{http://www.w3.org/2000/svg}svg")
                self.assertEqual((first / name).read_bytes(), (second / name).read_bytes(), name)

    def test_the_command_says_what_went_wrong(self) -> None:
        command = [sys.executable, "-m", "signorini", "figures", "nowhere", "--program", "no-such-program"]
        ended = subprocess.run(command, capture_output=True, text=True)
        self.assertEqual(ended.returncode, 1)
        self.assertRegex(ended.stderr, "^signorini: no-such-program cannot be run")
        self.assertFalse(pathlib.Path("nowhere").exists())


if __name__ == "__main__":
    unittest.main()
