"""Reads the replies of a running service with readers that are not ours: Python's json and gzip, and Debian's
python3-cbor2 and python3-meshio. Run as: formats_test.py PATH_OF_SIGNORINID
"""

import gzip
import json
import math
import os
import struct
import subprocess
import sys
import tempfile
import threading
import unittest
import urllib.request
import xml.etree.ElementTree

import cbor2
import meshio
import numpy

JSON = "application/json"
CBOR = "application/cbor"
SANITIZED = "SANITIZED" in os.environ


def nested(extents, numbers):
    """The numbers in row-major order as lists within lists."""
    if len(extents) == 1:
        return list(numbers)
    step = math.prod(extents[1:])
    return [nested(extents[1:], numbers[i * step:(i + 1) * step]) for i in range(extents[0])]


class CborReader:
    """Decodes the typed arrays of RFC 8746 and remembers which tags it met."""

    def __init__(self):
        self.tags = set()

    def read(self, document):
        return cbor2.loads(document, tag_hook=self.untag)

    def untag(self, _, tag):
        self.tags.add(tag.tag)
        if tag.tag == 86:
            return struct.unpack(f"<{len(tag.value) // 8}d", tag.value)
        if tag.tag == 78:
            return struct.unpack(f"<{len(tag.value) // 4}i", tag.value)
        if tag.tag == 40:
            return nested(*tag.value)
        raise ValueError(f"tag {tag.tag} is not expected")


def as_lists(value):
    """The document with lists where an array of one extent was read as a tuple."""
    if isinstance(value, dict):
        return {key: as_lists(member) for key, member in value.items()}
    if isinstance(value, (list, tuple)):
        return [as_lists(element) for element in value]
    return value


class Formats(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.daemon = subprocess.Popen(
            [SIGNORINID, "--port", "0", "--data-dir", ":memory:"], stderr=subprocess.PIPE, text=True)
        for line in cls.daemon.stderr:
            if "listening on " in line:
                cls.base = line.split("listening on ")[1].split()[0]
                break
        threading.Thread(target=cls.daemon.stderr.read, daemon=True).start()

    @classmethod
    def tearDownClass(cls):
        cls.daemon.terminate()
        cls.daemon.wait(timeout=20)

    def call(self, path, accept=None, body=None, body_type=JSON, **headers):
        request = urllib.request.Request(self.base + path, body, {"Accept": accept or "*/*", **headers})
        if body is not None:
            request.add_header("Content-Type", body_type)
        with urllib.request.urlopen(request, timeout=60) as reply:
            return reply.headers, reply.read()

    def problem(self, name):
        return self.call(f"/v1/examples/{name}")[1]

    def solved(self, name):
        headers, _ = self.call("/v1/solves?wait=60&fields=summary", body=self.problem(name))
        return headers["Location"]

    def expect_same_in_cbor(self, path, body=None):
        """Returns the tags that the CBOR document has."""
        _, plain = self.call(path, JSON, body)
        headers, binary = self.call(path, CBOR, body)
        self.assertEqual(headers["Content-Type"], CBOR)
        reader = CborReader()
        self.assertEqual(as_lists(reader.read(binary)), json.loads(plain), path)
        return reader.tags

    def test_every_example_has_the_same_result_in_cbor(self):
        _, examples = self.call("/v1/examples")
        names = [example["name"] for example in json.loads(examples)["examples"]]
        self.assertGreater(len(names), 5)
        for name in names:
            with self.subTest(name):
                tags = self.expect_same_in_cbor(self.solved(name) + "/result")
                self.assertEqual(tags, {40, 78, 86})

    def test_the_invariants_of_the_stress_are_the_same_in_cbor(self):
        self.expect_same_in_cbor(self.solved("elastic-block") + "/result?fields=principal,von_mises")

    def test_the_other_documents_are_the_same_in_cbor(self):
        path = self.solved("paper-nonconforming")
        for document in [path, path + "/history", "/v1/solves", "/v1/examples", "/v1/examples/plate-with-hole"]:
            self.expect_same_in_cbor(document)
        self.expect_same_in_cbor("/v1/validate", self.problem("paper-conforming"))

    def test_a_waited_reply_comes_in_cbor(self):
        headers, binary = self.call("/v1/solves?wait=60", CBOR, self.problem("elastic-block"))
        result = as_lists(CborReader().read(binary))
        _, plain = self.call(headers["Location"] + "/result")
        self.assertEqual(result, json.loads(plain))

    def test_a_problem_in_cbor_is_the_same_problem(self):
        problem = json.loads(self.problem("given-mesh"))
        points, triangles = problem["domain"]["points"], problem["domain"]["triangles"]
        packed = json.loads(self.problem("given-mesh"))
        doubles, integers = struct.pack(f"<{2 * len(points)}d", *sum(points, [])), \
            struct.pack(f">{3 * len(triangles)}H", *sum(triangles, []))
        packed["domain"]["points"] = cbor2.CBORTag(40, [[len(points), 2], cbor2.CBORTag(86, doubles)])
        packed["domain"]["triangles"] = cbor2.CBORTag(40, [[len(triangles), 3], cbor2.CBORTag(65, integers)])
        for body in [cbor2.dumps(packed), cbor2.dumps(problem)]:
            _, reply = self.call("/v1/solves?wait=60&fields=problem,mesh", body=body, body_type=CBOR)
            result = json.loads(reply)
            self.assertEqual(result["problem"], problem)
            self.assertEqual(result["status"], "succeeded")

    def test_gzip_holds_the_same_bytes(self):
        path = self.solved("paper-conforming")
        for file in ["/result", "/result?fields=summary", "/result.vtu", "/history.csv"]:
            for accept in [JSON, CBOR] if "?" in file or file == "/result" else [None]:
                plain_headers, plain = self.call(path + file, accept)
                headers, packed = self.call(path + file, accept, **{"Accept-Encoding": "gzip"})
                self.assertIsNone(plain_headers["Content-Encoding"])
                self.assertEqual(plain_headers["Vary"], "Accept, Accept-Encoding")
                if len(plain) < 1024:
                    self.assertEqual(packed, plain)
                    continue
                self.assertEqual(headers["Content-Encoding"], "gzip", file)
                self.assertEqual(gzip.decompress(packed), plain, file)
                self.assertLess(len(packed), len(plain), file)

    def test_the_vtu_is_read_by_meshio(self):
        for name in ["paper-nonconforming", "paper-conforming", "elastic-block", "hertz-half-disc", "plate-with-hole"]:
            with self.subTest(name), tempfile.NamedTemporaryFile(suffix=".vtu") as file:
                path = self.solved(name)
                file.write(self.call(path + "/result.vtu")[1])
                file.flush()
                grid = meshio.read(file.name)
                result = json.loads(self.call(path + "/result?fields=summary,mesh")[1])
                triangles, lines = grid.cells_dict["triangle"], grid.cells_dict["line"]
                self.assertEqual(len(triangles), len(result["mesh"]["triangles"]))
                parts = list(result["mesh"]["boundary"].values())
                numbers = grid.cell_data_dict["part"]
                self.assertEqual(numbers["line"].tolist(), [i for i, part in enumerate(parts) for _ in part])
                self.assertEqual(set(numbers["triangle"]), {-1})
                ends = grid.points[lines]
                wanted = {frozenset(map(tuple, (result["mesh"]["points"][i] for i in edge))) for part in parts for edge in part}
                self.assertEqual({frozenset(map(tuple, line[:, :2])) for line in ends}, wanted)
                pressure = grid.point_data["pressure"].ravel()
                self.assertTrue(numpy.isnan(pressure[triangles]).all())
                on_lines = numpy.nan_to_num(pressure[lines].mean(axis=1))
                lengths = numpy.linalg.norm(ends[:, 0] - ends[:, 1], axis=1)
                sums = result["summary"]["contact"]
                self.assertAlmostEqual((on_lines * lengths).sum() / sums["force"], 1, 9)
                self.assertAlmostEqual(numpy.nanmax(pressure) / sums["max_pressure"], 1, 12)
                a, b, c = (grid.points[triangles[:, i], :2] for i in range(3))
                areas = numpy.abs(numpy.cross(b - a, c - a)) / 2
                squares = (grid.cell_data_dict["error_density"]["triangle"].ravel() * areas).sum()
                bound = result["summary"]["error_bound"]["value"]
                self.assertGreater(squares, 0)
                self.assertLessEqual(squares, bound**2 * (1 + 1e-9))

    def series(self, problem):
        """The times of a series and its grids, as the command line writes them."""
        with tempfile.TemporaryDirectory() as directory:
            subprocess.run([SIGNORINID, "solve", "--fields", "summary", "--series", directory + "/new", "-"],
                           input=json.dumps(problem).encode(), stdout=subprocess.DEVNULL, check=True, timeout=120)
            sets = xml.etree.ElementTree.parse(directory + "/new/series.pvd").getroot().findall("Collection/DataSet")
            self.assertEqual(len(os.listdir(directory + "/new")), len(sets) + 1)
            return [float(each.get("timestep")) for each in sets], \
                [meshio.read(f"{directory}/new/{each.get('file')}") for each in sets]

    def test_a_series_has_a_file_a_level_or_an_entry(self):
        times, grids = self.series(json.loads(self.problem("adaptive-mesh")))
        self.assertEqual(times, list(range(1, len(times) + 1)))
        triangles = [len(grid.cells_dict["triangle"]) for grid in grids]
        self.assertGreater(len(triangles), 2)
        self.assertEqual(triangles, sorted(triangles))
        problem = json.loads(self.problem("elastic-block"))
        problem["sweep"] = [{"material": {"young": 400}}, {"boundary": {"bottom": {"gap": "0.02 * x^2"}}}]
        times, grids = self.series(problem)
        self.assertEqual(times, [0, 1, 2])
        for grid, change in zip(grids, [{}, *problem["sweep"]]):
            alone = {**problem, "material": {**problem["material"], **change.get("material", {})}}
            alone["boundary"] = {**alone["boundary"], "bottom": {**alone["boundary"]["bottom"],
                                                                 **change.get("boundary", {}).get("bottom", {})}}
            del alone["sweep"]
            reply = self.call("/v1/solves?wait=60&fields=displacement", body=json.dumps(alone).encode())[1]
            wanted = numpy.abs(json.loads(reply)["displacement"]["at_points"]).max()
            self.assertAlmostEqual(numpy.abs(grid.point_data["displacement_continuous"]).max() / wanted, 1, 9)

    def kilobytes(self, quantity):
        with open(f"/proc/{self.daemon.pid}/status") as status:
            return next(int(line.split()[1]) for line in status if line.startswith(quantity))

    @unittest.skipIf(SANITIZED, "a sanitizer keeps freed memory")
    def test_a_reply_takes_little_memory_beside_its_solution(self):
        problem = json.loads(self.problem("paper-nonconforming"))
        problem["mesh"]["divisions"] = [300, 300]
        problem["solver"] = {"method": "active_set"}
        body = json.dumps(problem).encode()
        path = self.call("/v1/solves?wait=60&fields=summary", body=body)[0]["Location"]
        for accept, coding in [(JSON, "identity"), (CBOR, "identity"), (CBOR, "gzip")]:
            with open(f"/proc/{self.daemon.pid}/clear_refs", "w") as peak:
                peak.write("5")
            before = self.kilobytes("VmRSS")
            _, result = self.call(path + "/result", accept, **{"Accept-Encoding": coding})
            self.assertGreater(len(result), 4e6)
            self.assertLess(self.kilobytes("VmHWM") - before, 3000, (accept, coding))

    def test_brotli_is_never_chosen(self):
        path = self.solved("paper-conforming")
        for codings, expected in [("br", None), ("br, gzip;q=0.1", "gzip"), ("gzip;q=0, br", None), ("*", "gzip")]:
            headers, _ = self.call(path + "/result", **{"Accept-Encoding": codings})
            self.assertEqual(headers["Content-Encoding"], expected, codings)


if __name__ == "__main__":
    SIGNORINID = sys.argv.pop(1)
    unittest.main()
