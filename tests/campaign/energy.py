#!/usr/bin/python3
"""Energy and contact force of a problem document by the campaign's own method. The values of
tests/api/example_values_test.cpp come from here.

    tests/campaign/energy.py build/release/server/signorinid api/examples/elastic-block.json [TRIANGLES] [LEVELS]

A line a mesh, the first of about TRIANGLES triangles (400), each next one the refinement of the one before. The energy
is an upper bound of the least, but for the error of its integrals. A support's reaction in a corner of the contact is
none of the force.
"""
import json
import sys

import primal


def main():
    daemon, path, *numbers = sys.argv[1:]
    triangles, levels = (list(map(int, numbers)) + [400, 3][len(numbers):])[:2]
    with open(path, encoding="utf-8") as file:
        ladder = primal.Ladder(json.load(file), daemon, triangles)
    for level in range(levels):
        energy, error = ladder.level(level)
        print(f"triangles {len(ladder.meshes[level].triangles):6d} energy {energy:.10g} ± {error:.1e} "
              f"force {ladder.found.force:.9g}", flush=True)


if __name__ == "__main__":
    main()
