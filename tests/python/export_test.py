"""Results for PyVista, meshio and pandas."""

from __future__ import annotations

import pathlib
import sys
import tempfile
import types
import unittest
from collections.abc import Callable
from typing import Any
from unittest import mock

import meshio
import numpy
import pandas

from daemon import PROGRAM, block
from signorini import Local, NotInResult, PackageMissing, Result
from signorini.figures import NONCONFORMING

ELASTIC = Local(PROGRAM).solve(block())
MEMBRANE = Local(PROGRAM).solve(NONCONFORMING.problem())


class Grid:
    """In the place of pyvista.UnstructuredGrid, whose constructor takes cells, their types and points."""

    def __init__(self, cells: Any, celltypes: Any, points: Any) -> None:
        self.cells, self.celltypes, self.points = cells, celltypes, points
        self.point_data: dict[str, Any] = {}
        self.cell_data: dict[str, Any] = {}


class Pyvista(unittest.TestCase):
    def grid(self, result: Result) -> Any:
        pretended = types.ModuleType("pyvista")
        pretended.UnstructuredGrid = Grid  # type: ignore[attr-defined]
        with mock.patch.dict(sys.modules, pyvista=pretended):
            return result.to_pyvista()

    def test_the_grid_has_every_triangle(self) -> None:
        grid, mesh = self.grid(ELASTIC), ELASTIC.mesh
        cells = grid.cells.reshape(-1, 4)
        numpy.testing.assert_array_equal(cells[:, 0], 3)
        numpy.testing.assert_array_equal(cells[:, 1:], mesh.triangles)
        numpy.testing.assert_array_equal(grid.celltypes, numpy.full(len(mesh.triangles), 5))
        self.assertEqual(grid.celltypes.dtype, numpy.uint8)
        numpy.testing.assert_array_equal(grid.points[:, :2], mesh.points)
        numpy.testing.assert_array_equal(grid.points[:, 2], 0)

    def test_the_grid_has_the_fields(self) -> None:
        elastic, membrane = self.grid(ELASTIC), self.grid(MEMBRANE)
        numpy.testing.assert_array_equal(elastic.point_data["displacement"][:, :2], ELASTIC.displacement.at_points)
        self.assertEqual(elastic.point_data["displacement"].shape[1], 3)
        numpy.testing.assert_array_equal(membrane.point_data["displacement"], MEMBRANE.displacement.at_points)
        self.assertEqual(list(elastic.cell_data), ["stress", "principal", "von_mises"])
        numpy.testing.assert_array_equal(elastic.cell_data["von_mises"], ELASTIC.von_mises)
        self.assertEqual(list(membrane.cell_data), ["stress"])

    def test_what_a_result_lacks_is_no_table(self) -> None:
        without: list[dict[str, Any]] = [{"contact": None}, {"contact": {}}]
        for each in without:
            with self.assertRaisesRegex(NotInResult, "this result has no contact"):
                Result(dict(ELASTIC.document) | each).to_pandas("contact")

    def test_what_was_not_fetched_is_left_out(self) -> None:
        grid = self.grid(Local(PROGRAM).solve(block(), fields=["mesh"]))
        self.assertEqual((grid.point_data, grid.cell_data), ({}, {}))
        with self.assertRaises(NotInResult):
            self.grid(Local(PROGRAM).solve(block(), fields=["stress"]))

    def test_a_package_that_is_not_there_is_named(self) -> None:
        calls: dict[str, Callable[[], object]] = {
            "pyvista": ELASTIC.to_pyvista,
            "meshio": ELASTIC.to_meshio,
            "pandas": lambda: ELASTIC.to_pandas("contact"),
            "matplotlib": ELASTIC.plot,
        }
        for name, call in calls.items():
            with mock.patch.dict(sys.modules, {name: None, f"{name}.pyplot": None}):
                with self.assertRaisesRegex(PackageMissing, rf"takes {name}, which is not installed"):
                    call()


class Meshio(unittest.TestCase):
    def test_the_mesh_is_the_same_after_it_was_written(self) -> None:
        with tempfile.TemporaryDirectory() as directory:
            path = pathlib.Path(directory) / "block.vtu"
            ELASTIC.to_meshio().write(path)
            read = meshio.read(path)
        numpy.testing.assert_array_equal(read.cells_dict["triangle"], ELASTIC.mesh.triangles)
        numpy.testing.assert_array_equal(read.points[:, :2], ELASTIC.mesh.points)
        numpy.testing.assert_array_equal(read.point_data["displacement"][:, :2], ELASTIC.displacement.at_points)
        numpy.testing.assert_array_equal(read.cell_data["stress"][0], ELASTIC.stress.at_centroids)
        numpy.testing.assert_array_equal(read.cell_data["von_mises"][0], ELASTIC.von_mises)


class Pandas(unittest.TestCase):
    def test_the_contact_boundary_is_a_table(self) -> None:
        table = MEMBRANE.to_pandas("contact")
        self.assertEqual(list(table.columns), ["part", "x", "y", "clearance", "pressure", "gap", "open"])
        self.assertEqual(len(table), 28)
        top = table[table["part"] == "top"]
        numpy.testing.assert_array_equal(top["clearance"], MEMBRANE.contact["top"].clearance)
        numpy.testing.assert_array_equal(top["y"], 1.0)

    def test_the_history_is_a_table(self) -> None:
        table = MEMBRANE.to_pandas("history")
        self.assertEqual(len(table), MEMBRANE.summary.iterations)
        self.assertIn("displacement_change", table.columns)
        self.assertNotIn("displacement_change", ELASTIC.to_pandas("history").columns)

    def test_a_study_is_a_table(self) -> None:
        document = {"status": "succeeded", "study": {"rows": [{"scheme": "conforming", "bound": 0.5}], "rates": []}}
        pandas.testing.assert_frame_equal(
            Result(document).to_pandas("study"), pandas.DataFrame({"scheme": ["conforming"], "bound": [0.5]})
        )

    def test_another_table_is_refused(self) -> None:
        with self.assertRaisesRegex(ValueError, "contact, history and study"):
            ELASTIC.to_pandas("stress")


if __name__ == "__main__":
    unittest.main()
