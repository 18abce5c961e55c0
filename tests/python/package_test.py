"""The package is typed, becomes a wheel, and solves by the standard library alone."""

from __future__ import annotations

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest
import zipfile

from daemon import PROGRAM, Daemon

TREE = pathlib.Path(__file__).parents[2]
SOURCE = TREE / "api/python"


class Package(unittest.TestCase):
    work: tempfile.TemporaryDirectory[str]

    @classmethod
    def setUpClass(cls) -> None:
        cls.work = tempfile.TemporaryDirectory()
        cls.place = pathlib.Path(cls.work.name)
        cls.installed = cls.place / "installed"
        copy = shutil.copytree(SOURCE, cls.place / "source", ignore=shutil.ignore_patterns("__pycache__", "notebooks"))
        pip = [sys.executable, "-m", "pip", "--quiet", "--disable-pip-version-check", "--no-cache-dir", "--no-input"]
        offline = ["--no-deps", "--no-index"]
        to_place = ["--root-user-action=ignore", "--target", str(cls.installed)]
        subprocess.run([*pip, "wheel", *offline, "--no-build-isolation", "-w", cls.place, copy], check=True)
        (cls.wheel,) = cls.place.glob("*.whl")
        subprocess.run([*pip, "install", *offline, *to_place, str(cls.wheel)], check=True)

    @classmethod
    def tearDownClass(cls) -> None:
        cls.work.cleanup()

    place: pathlib.Path
    wheel: pathlib.Path
    installed: pathlib.Path

    def python(self, *arguments: str) -> subprocess.CompletedProcess[str]:
        """Runs Python with the installed package and, but for the standard library, nothing else."""
        environment = os.environ | {"PYTHONPATH": str(self.installed)}
        return subprocess.run(
            [sys.executable, "-S", *arguments], env=environment, cwd=self.place, capture_output=True, text=True
        )

    def test_the_wheel_has_every_module_and_says_that_it_is_typed(self) -> None:
        self.assertEqual(self.wheel.name, "signorini-1.0.0-py3-none-any.whl")
        packed = {name for name in zipfile.ZipFile(self.wheel).namelist() if name.startswith("signorini/")}
        modules = {f"signorini/{path.name}" for path in (SOURCE / "signorini").iterdir() if path.is_file()}
        self.assertEqual(packed, modules)
        self.assertIn("signorini/py.typed", packed)

    def test_it_solves_by_the_standard_library_alone(self) -> None:
        program = (
            "import sys\n"
            "from signorini import Client, Local, PackageMissing\n"
            "client = Client(sys.argv[1])\n"
            "for solve in (client.solve, Local(sys.argv[2]).solve):\n"
            "    result = solve(client.example('elastic-block'))\n"
            "    print(round(result.summary.contact.force, 6), type(result.mesh.points), len(result.von_mises))\n"
            "print(len(client.map([client.example('given-mesh')] * 3)))\n"
            "for call in (result.plot, result.to_pyvista, result.to_meshio):\n"
            "    try: call()\n"
            "    except PackageMissing as missing: print(missing)\n"
            "assert 'numpy' not in sys.modules\n"
        )
        with Daemon() as daemon:
            ended = self.python("-c", program, daemon.url, PROGRAM)
        self.assertEqual(ended.stderr, "")
        self.assertEqual(
            ended.stdout.splitlines(),
            [
                *["2.0 <class 'list'> 2048"] * 2,
                "3",
                "plot() takes matplotlib, which is not installed",
                "to_pyvista() takes pyvista, which is not installed",
                "to_meshio() takes meshio, which is not installed",
            ],
        )

    def test_the_command_names_the_package_that_figures_take(self) -> None:
        ended = self.python("-m", "signorini", "figures", "nowhere")
        self.assertEqual(ended.stderr, "signorini: figures takes matplotlib, which is not installed\n")
        self.assertEqual(ended.returncode, 1)

    def mypy(self, *arguments: str, cwd: pathlib.Path) -> subprocess.CompletedProcess[str]:
        command = [sys.executable, "-m", "mypy", "--config-file", str(SOURCE / "pyproject.toml")]
        environment = os.environ | {"MYPYPATH": f"{self.installed}:{TREE / 'tests/python'}"}
        return subprocess.run(
            [*command, "--cache-dir", str(self.place / "types"), *arguments],
            env=environment, cwd=cwd, capture_output=True, text=True,
        )  # fmt: skip

    def test_its_types_and_those_of_its_tests_are_strict(self) -> None:
        tests = [str(path) for path in pathlib.Path(__file__).parent.glob("*.py")]
        for files, place in ((["signorini"], SOURCE), (tests, self.place)):
            said = self.mypy(*files, cwd=place).stdout
            self.assertTrue(said.startswith("Success"), said)

    def test_who_uses_it_sees_its_types(self) -> None:
        (self.place / "user.py").write_text(
            "from signorini import Client, Contact, YoungPoisson\n"
            "result = Client().solve({})\n"
            "reveal_type(result.summary.contact.force)\n"
            "reveal_type(result.contact['bottom'].pressure)\n"
            "Contact(gap=[1])\n"
            "YoungPoisson(young=1)\n"
            "Client().map(3)\n"
        )
        said = self.mypy("user.py", cwd=self.place).stdout
        for expected in (
            'user.py:3: note: Revealed type is "builtins.float"',
            'user.py:4: note: Revealed type is "numpy.ndarray[Any, numpy.dtype[numpy.floating[numpy._typing._64Bit]]]"',
            'user.py:5: error: Argument "gap" to "Contact"',
            'user.py:6: error: Missing positional argument "poisson"',
            'user.py:7: error: Argument 1 to "map" of "Client"',
        ):
            self.assertIn(expected, said)


if __name__ == "__main__":
    unittest.main()
