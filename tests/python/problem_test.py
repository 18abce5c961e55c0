"""The dataclasses have the names of the schema that the service publishes, and the documents that it takes."""

from __future__ import annotations

import dataclasses
import json
import pathlib
import tempfile
import unittest
from typing import Any

import numpy

import signorini
from signorini import boundary, domain, fields, material, mesh_request, problem, quantity, study, summary
from signorini.document import encoded, read, written
from signorini.figures import CONFORMING

TREE = pathlib.Path(__file__).parents[2]
SCHEMAS: dict[str, Any] = {
    name: schema
    for file in ("problem", "domain", "study", "result", "solve")
    for name, schema in json.loads((TREE / f"api/openapi/{file}.json").read_text())["components"]["schemas"].items()
}
#: Schemas that are written out within another one.
SCHEMAS["Circle"] = SCHEMAS["CircularHole"]["properties"]["circle"]
SCHEMAS["BoundParts"] = SCHEMAS["ErrorBound"]["properties"]["parts"]
SCHEMAS["SweepSummary"] = SCHEMAS["SweepEntry"]["properties"]["summary"]
SCHEMAS["Cost"] = SCHEMAS["Estimate"]["properties"]["estimated"]
SCHEMAS["Reaction"] = SCHEMAS["Reactions"]["additionalProperties"]
SCHEMAS["ContactPart"] = SCHEMAS["ContactParts"]["additionalProperties"]

#: What a problem is made of, and what a result.
OF_PROBLEMS = [boundary, domain, material, mesh_request, problem, quantity, study]
OF_RESULTS = [fields, summary]


def dataclasses_of(modules: list[Any]) -> dict[str, Any]:
    return {
        name: kind
        for module in modules
        for name, kind in vars(module).items()
        if dataclasses.is_dataclass(kind) and kind.__module__ == module.__name__
    }


class Names(unittest.TestCase):
    def test_every_dataclass_has_the_members_of_its_schema(self) -> None:
        for name, kind in dataclasses_of(OF_PROBLEMS + OF_RESULTS).items():
            members = [field.name for field in dataclasses.fields(kind)]
            named = [member for member in SCHEMAS[name]["properties"] if member != "type"]
            self.assertEqual(sorted(members), sorted(named), f"{kind.__module__}.{name} beside api/openapi")

    def test_what_the_schema_requires_has_no_default(self) -> None:
        for name, kind in dataclasses_of(OF_PROBLEMS).items():
            required = {field.name for field in dataclasses.fields(kind) if field.default is dataclasses.MISSING}
            self.assertEqual(required, set(SCHEMAS[name].get("required", [])) - {"type"}, name)

    def test_every_type_is_that_of_the_schema(self) -> None:
        for name, kind in dataclasses_of(OF_PROBLEMS).items():
            const = SCHEMAS[name]["properties"].get("type", {}).get("const")
            self.assertEqual(getattr(kind, "type", None), const, name)

    def test_every_object_of_a_problem_has_a_dataclass(self) -> None:
        known = dataclasses_of(OF_PROBLEMS)
        for name, schema in SCHEMAS.items():
            if schema.get("additionalProperties") is False:
                self.assertIn(name, known)

    def test_a_result_has_a_property_for_every_member(self) -> None:
        for member in SCHEMAS["Result"]["properties"]:
            self.assertIsInstance(vars(signorini.Result).get(member), property, member)


class Documents(unittest.TestCase):
    def test_the_builder_writes_the_example_of_the_paper(self) -> None:
        with open(TREE / "api/examples/paper-conforming.json", encoding="utf-8") as file:
            example = json.load(file)
        built = dataclasses.replace(CONFORMING, divisions=12, max_iterations=1000).problem().document()
        self.assertEqual(built, example)

    def test_what_is_none_is_left_out_but_in_patches(self) -> None:
        entry = signorini.Variation(boundary={"bottom": {"gap": None}})
        self.assertEqual(written(entry), {"boundary": {"bottom": {"gap": None}}})

    def test_arrays_become_lists(self) -> None:
        mesh = signorini.GivenMesh(numpy.eye(3, 2), numpy.array([[0, 1, 2]]), {"all": [[0, 1], [1, 2], [2, 0]]})
        document = json.loads(encoded(mesh))
        self.assertEqual(document["points"], [[1, 0], [0, 1], [0, 0]])
        self.assertEqual((document["type"], document["triangles"]), ("mesh", [[0, 1, 2]]))
        self.assertEqual(json.loads(encoded({"a": numpy.float32(0.5), "b": numpy.int64(3)})), {"a": 0.5, "b": 3})

    def test_a_number_that_is_not_finite_is_refused(self) -> None:
        with self.assertRaises(ValueError):
            encoded(signorini.Contact(float("nan")))

    def test_arcs_and_holes_have_their_form(self) -> None:
        circle = signorini.Arc((0, 1), long=True)
        shape = signorini.Polygon(
            [signorini.Vertex((-1, 1), circle), (1, 1)], [signorini.CircularHole(signorini.Circle((0, 1), 0.1))]
        )
        self.assertEqual(
            written(shape),
            {
                "type": "polygon",
                "vertices": [{"at": [-1, 1], "arc": {"centre": [0, 1], "long": True}}, [1, 1]],
                "holes": [{"circle": {"centre": [0, 1], "radius": 0.1}}],
            },
        )

    def test_a_gmsh_file_is_read_as_it_is(self) -> None:
        with tempfile.NamedTemporaryFile("w", suffix=".msh") as file:
            file.write("$MeshFormat\n2.2 0 8\n")
            file.flush()
            self.assertEqual(signorini.Gmsh.from_file(file.name).msh, "$MeshFormat\n2.2 0 8\n")

    def test_unknown_members_of_a_result_do_no_harm(self) -> None:
        document = {"force": 1.0, "max_pressure": 2.0, "length": 3.0, "centre": [0, 0]}
        self.assertEqual(read(summary.ContactSums, document), summary.ContactSums(1.0, 2.0, 3.0))


if __name__ == "__main__":
    unittest.main()
