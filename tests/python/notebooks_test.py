"""The notebooks run from beginning to end, beside a service; what they claim they assert themselves."""

from __future__ import annotations

import base64
import os
import pathlib
import struct
import unittest
from datetime import datetime
from typing import Any
from unittest import mock

import nbformat
from nbclient.client import NotebookClient

from daemon import Daemon

NOTEBOOKS = pathlib.Path(__file__).parents[2] / "api/python/notebooks"


def kept(name: str) -> Any:
    """The notebook as it is in the tree."""
    text = (NOTEBOOKS / f"{name}.ipynb").read_text(encoding="utf-8")
    return nbformat.reads(text, as_version=4)  # type: ignore[no-untyped-call]


def run(name: str) -> Any:
    """The notebook with its outputs."""
    where = {"metadata": {"path": str(NOTEBOOKS)}}
    # The kernel draws into the notebook, and its debugger is silent.
    environment = {name: value for name, value in os.environ.items() if name != "MPLBACKEND"}
    environment["PYDEVD_DISABLE_FILE_VALIDATION"] = "1"
    with Daemon() as daemon, mock.patch.dict(os.environ, environment | {"SIGNORINI_URL": daemon.url}, clear=True):
        return NotebookClient(kept(name), timeout=60, kernel_name="python3", resources=where).execute()


def pictures(cell: Any) -> list[bytes]:
    data = [output.get("data", {}) for output in cell.get("outputs", [])]
    return [base64.b64decode(each["image/png"]) for each in data if "image/png" in each]


def text(cell: Any) -> str:
    outputs = cell.get("outputs", [])
    return "".join(output.get("text", "") + output.get("data", {}).get("text/plain", "") for output in outputs)


class Notebooks(unittest.TestCase):
    def expect_pictures(self, notebook: Any, count: int) -> None:
        """So many pictures, none of which is empty."""
        found = [picture for cell in notebook.cells for picture in pictures(cell)]
        self.assertEqual(len(found), count)
        for picture in found:
            width, height = struct.unpack(">II", picture[16:24])
            self.assertGreater(min(width, height), 150)
            self.assertGreater(len(picture), 5000)

    def test_they_are_kept_without_outputs(self) -> None:
        names = sorted(path.stem for path in NOTEBOOKS.glob("*.ipynb"))
        self.assertEqual(names, ["hertz", "paper", "seal"])
        for name in names:
            notebook = kept(name)
            nbformat.validate(notebook)
            for cell in notebook.cells:
                self.assertFalse(cell.get("outputs") or cell.get("execution_count"), name)

    def test_the_paper_has_its_figures_and_its_table(self) -> None:
        notebook = run("paper")
        self.expect_pictures(notebook, 4)
        self.assertIn("all fourteen within 7.2%", "".join(map(text, notebook.cells)))

    def test_hertz_has_his_pressure_and_a_bound(self) -> None:
        notebook = run("hertz")
        self.expect_pictures(notebook, 2)
        self.assertIn("peak pressure 8.6", "".join(map(text, notebook.cells)))

    def test_three_lines_lead_from_a_file_to_a_picture(self) -> None:
        notebook = run("seal")
        self.expect_pictures(notebook, 2)
        (cell,) = (cell for cell in notebook.cells if "from_file" in cell.source and cell.cell_type == "code")
        lines = [line for line in cell.source.splitlines() if not line.startswith("%")]
        self.assertEqual((len(lines), len(pictures(cell))), (3, 1))
        self.assertNotIn("<Axes", text(cell))
        times = cell.metadata["execution"]
        began, ended = times["iopub.status.busy"], times["iopub.status.idle"]
        seconds = (datetime.fromisoformat(ended) - datetime.fromisoformat(began)).total_seconds()
        wall_time = text(cell).split("\n")[1]
        print(f"\n{seconds:.2f} s from seal.msh to its picture in the notebook; it shows {wall_time}")
        self.assertLess(seconds, 10)


if __name__ == "__main__":
    unittest.main()
