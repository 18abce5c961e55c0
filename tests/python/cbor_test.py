"""The reader of CBOR against the examples of the RFCs, Debian's cbor2, and what the service writes."""

from __future__ import annotations

import json
import math
import struct
import subprocess
import sys
import unittest
import urllib.request
from typing import Any

import cbor2
import numpy

from daemon import Daemon
from signorini import Client, cbor

#: RFC 8949, appendix A: what JSON can say too, and the forms of unknown length.
EXAMPLES: list[tuple[str, Any]] = [
    ("00", 0), ("17", 23), ("1818", 24), ("1903e8", 1000), ("1a000f4240", 1000000),
    ("1b000000e8d4a51000", 1000000000000), ("1bffffffffffffffff", 18446744073709551615),
    ("3bffffffffffffffff", -18446744073709551616), ("20", -1), ("3863", -100), ("3903e7", -1000),
    ("f90000", 0.0), ("f93c00", 1.0), ("fb3ff199999999999a", 1.1), ("f97bff", 65504.0), ("fa47c35000", 100000.0),
    ("fb7e37e43c8800759c", 1.0e300), ("f90001", 5.960464477539063e-8), ("f97c00", math.inf), ("f4", False),
    ("f5", True), ("f6", None), ("40", b""), ("4401020304", b"\x01\x02\x03\x04"), ("60", ""), ("6161", "a"),
    ("62c3bc", "ü"), ("64f0908591", "𐅑"), ("80", []), ("83010203", [1, 2, 3]),
    ("8301820203820405", [1, [2, 3], [4, 5]]), ("a0", {}), ("a201020304", {1: 2, 3: 4}),
    ("a26161016162820203", {"a": 1, "b": [2, 3]}),
    ("5f42010243030405ff", b"\x01\x02\x03\x04\x05"), ("7f657374726561646d696e67ff", "streaming"), ("9fff", []),
    ("9f018202039f0405ffff", [1, [2, 3], [4, 5]]), ("bf61610161629f0203ffff", {"a": 1, "b": [2, 3]}),
]  # fmt: skip

#: RFC 8949, appendix F, and tags that the service does not write.
NOT_WELL_FORMED = [
    "", "18", "19 00", "1a0000", "61", "4401", "81", "a1", "a100", "9f", "bf00ff", "ff", "81ff", "1c", "fc", "1f", "c0",
    "0000", "c074323031332d30332d32315432303a30343a30305a", "f8ff", "d85647000102030405 06", "d8288201",
    "61ff", "a18000", "5f6161ff", "8100ff", "bf6161ff",
]  # fmt: skip


def lists(value: Any) -> Any:
    """The document with lists for arrays."""
    if isinstance(value, numpy.ndarray):
        return value.tolist()
    if isinstance(value, dict):
        return {key: lists(member) for key, member in value.items()}
    return [lists(element) for element in value] if isinstance(value, list) else value


class Cbor(unittest.TestCase):
    def test_the_examples_of_the_rfc_are_read(self) -> None:
        for text, value in EXAMPLES:
            with self.subTest(text):
                read = cbor.loads(bytes.fromhex(text))
                self.assertEqual(read, value)
                self.assertIs(type(read), type(value))

    def test_what_is_not_well_formed_is_refused(self) -> None:
        for text in NOT_WELL_FORMED:
            with self.subTest(text), self.assertRaises(cbor.CborError):
                cbor.loads(bytes.fromhex(text))

    def test_every_part_of_a_document_is_cut_off(self) -> None:
        whole = cbor2.dumps({"points": cbor2.CBORTag(40, [[1, 2], cbor2.CBORTag(86, bytes(16))]), "n": [1000, 2.5]})
        cbor.loads(whole)
        for end in range(len(whole)):
            with self.assertRaises(cbor.CborError):
                cbor.loads(whole[:end])

    def test_depth_is_bounded(self) -> None:
        for opening in (b"\x81", b"\x9f", b"\xa1\x00", b"\xbf\x00", b"\x5f"):
            with self.subTest(opening), self.assertRaisesRegex(cbor.CborError, "nested too deeply"):
                cbor.loads(opening * 100_000)
        self.assertEqual(cbor.loads(b"\x81" * 40 + b"\x00"), cbor2.loads(b"\x81" * 40 + b"\x00"))

    def test_typed_arrays_are_those_of_numpy(self) -> None:
        doubles = cbor2.CBORTag(86, struct.pack("<6d", *range(6)))
        integers = cbor2.CBORTag(78, struct.pack("<3i", -1, 0, 2**31 - 1))
        found = cbor.loads(cbor2.dumps([cbor2.CBORTag(40, [[3, 2], doubles]), integers, cbor2.CBORTag(86, b"")]))
        self.assertEqual([array.dtype for array in found], ["float64", "int32", "float64"])
        self.assertEqual(lists(found), [[[0, 1], [2, 3], [4, 5]], [-1, 0, 2147483647], []])
        found[0][0, 0] = 7  # it can be written to

    def test_extents_that_do_not_fit_are_refused(self) -> None:
        wrong: list[Any] = [[2, 2], [3], [-1, 2, 9], "x", [-1], [3, -1], [2**63, 0], [6, True], [6.0], [], None, {}]
        for extents in wrong:
            with self.subTest(extents), self.assertRaises(cbor.CborError):
                cbor.loads(cbor2.dumps(cbor2.CBORTag(40, [extents, cbor2.CBORTag(86, bytes(48))])))

    def test_without_numpy_the_arrays_are_lists(self) -> None:
        document = cbor2.dumps(cbor2.CBORTag(40, [[2, 1, 2], cbor2.CBORTag(78, struct.pack("<4i", 1, -2, 3, 4))]))
        program = (
            "import sys; sys.modules['numpy'] = None\n"
            f"from signorini import cbor; print(cbor.loads(bytes.fromhex('{document.hex()}')))\n"
            "try: cbor.loads(bytes.fromhex('d82882820303d8564101'))\n"
            "except cbor.CborError: print('refused')"
        )
        said = subprocess.run([sys.executable, "-c", program], check=True, capture_output=True, text=True).stdout
        self.assertEqual(said.split("\n")[:2], ["[[[1, -2]], [[3, 4]]]", "refused"])

    def test_the_results_of_all_examples_are_those_in_json(self) -> None:
        with Daemon() as daemon:
            client = Client(daemon.url)
            for name in client.examples():
                with self.subTest(name):
                    result = client.solve(client.example(name))
                    address = f"{daemon.url}/v1/solves/{result.id}/result?fields={','.join(list(result.document)[2:])}"
                    with urllib.request.urlopen(address) as reply:
                        self.assertEqual(lists(dict(result.document)), json.load(reply))


if __name__ == "__main__":
    unittest.main()
