#!/usr/bin/env python3
"""Energy and contact force of a problem document by another method than the service's.

Quadratic displacements on triangles, the contact condition at the nodes, a primal-dual active set on the
saddle-point system: nothing is shared with the service but the mesh, which it writes. The values of
tests/api/example_values_test.cpp come from here. Needs numpy and scipy.

    tests/problems/primal.py build/release/server/signorinid api/examples/elastic-block.json 2

The number counts uniform refinements on top of the document's own mesh.
"""
import json
import re
import subprocess
import sys

import numpy as np
import scipy.sparse as sparse
from scipy.sparse.linalg import splu


def mesh_of(daemon, document, refine):
    """Points, triangles and the boundary's edges by part, after the service's own meshing."""
    document = json.loads(json.dumps(document))
    document["mesh"]["refine"] = document["mesh"].get("refine", 0) + refine
    document["solver"] = {"method": "active_set"}
    out = subprocess.run([daemon, "solve", "--fields", "mesh", "-"], input=json.dumps(document), text=True,
                         capture_output=True, check=True).stdout
    mesh = json.loads(out)["mesh"]
    return np.array(mesh["points"]), np.array(mesh["triangles"]), mesh["boundary"]


def field(value):
    """A number or an expression as a function of x, y and the normal."""
    text = str(value).replace("^", "**")
    ternary = re.fullmatch(r"(.*)\?(.*):(.*)", text)
    if ternary:
        text = "where({}, {}, {})".format(*ternary.groups())
    code = compile(text, text, "eval")
    names = {name: getattr(np, name) for name in ("where", "sin", "cos", "exp", "sqrt", "pi")}
    names["atan2"] = np.arctan2
    return lambda x, n=(0, 0): eval(code, names, {"x": x[0], "y": x[1], "nx": n[0], "ny": n[1]}) + 0 * x[0]


# Seven points, exact for degree five; barycentric coordinates and weights that sum to one.
_s = np.sqrt(15)
_a, _b = (6 - _s) / 21, (6 + _s) / 21
BARY = np.array([[1 / 3] * 3] + [[1 - 2 * c if i == k else c for i in range(3)] for c in (_a, _b) for k in range(3)])
WEIGHT = np.array([9 / 40] + [(155 - _s) / 1200] * 3 + [(155 + _s) / 1200] * 3)
GAUSS = np.array([0.5 - np.sqrt(0.15), 0.5, 0.5 + np.sqrt(0.15)]), np.array([5, 8, 5]) / 18


class Primal:
    def __init__(self, document, points, triangles, boundary):
        self.document, self.boundary = document, boundary
        self.components = 1 if document["model"] == "membrane" else 2
        number = {}
        midpoint = lambda a, b: number.setdefault((min(a, b), max(a, b)), len(points) + len(number))
        self.triangles = np.array([[a, b, c, midpoint(b, c), midpoint(c, a), midpoint(a, b)]
                                   for a, b, c in triangles.tolist()])
        middles = [(points[a] + points[b]) / 2 for a, b in number]
        self.nodes = np.vstack([points, middles])
        self.midpoint = lambda a, b: number[(min(a, b), max(a, b))]
        self.assemble()

    def hooke(self, x):
        """The stiffness over (u_x, u_y) or over the engineering strains xx, yy, xy."""
        material = self.document["material"]
        rows = lambda m: np.array([[field(v)(x) for v in row] for row in m])
        if "tensor" in material:
            return rows(material["tensor"])
        if self.components == 1:
            kappa = material.get("stiffness", 1)
            return rows(kappa if isinstance(kappa, list) else [[kappa, 0], [0, kappa]])
        e, nu = field(material["young"])(x), field(material["poisson"])(x)
        if material.get("plane", "strain") == "stress":
            lame = e * nu / (1 - nu ** 2)
        else:
            lame = e * nu / ((1 + nu) * (1 - 2 * nu))
        mu, zero = e / (2 * (1 + nu)), 0 * e
        return np.array([[lame + 2 * mu, lame, zero], [lame, lame + 2 * mu, zero], [zero, zero, mu]])

    def assemble(self):
        d, n = self.components, 6 * self.components
        corners = self.nodes[self.triangles[:, :3]]
        jacobian = np.stack([corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]], axis=2)
        area = np.linalg.det(jacobian) / 2
        inverse = np.linalg.inv(jacobian)
        lambda_gradients = np.einsum("ki,tij->tkj", np.array([[-1, -1], [1, 0], [0, 1]]), inverse)
        matrix = np.zeros((len(area), n, n))
        right = np.zeros((len(area), n))
        body = self.document.get("load", {}).get("body", 0 if d == 1 else [0, 0])
        for l, weight in zip(BARY, WEIGHT):
            x = np.einsum("k,tkj->jt", l, corners)
            values = np.array([l[k] * (2 * l[k] - 1) for k in range(3)] +
                              [4 * l[(k + 1) % 3] * l[(k + 2) % 3] for k in range(3)])
            gradients = np.stack([(4 * l[k] - 1) * lambda_gradients[:, k] for k in range(3)] +
                                 [4 * (l[(k + 1) % 3] * lambda_gradients[:, (k + 2) % 3] +
                                       l[(k + 2) % 3] * lambda_gradients[:, (k + 1) % 3]) for k in range(3)], 1)
            if d == 1:
                strain = gradients.transpose(0, 2, 1)
            else:
                strain = np.zeros((len(area), 3, n))
                strain[:, 0, 0::2] = strain[:, 2, 1::2] = gradients[:, :, 0]
                strain[:, 1, 1::2] = strain[:, 2, 0::2] = gradients[:, :, 1]
            matrix += np.einsum("t,tia,ijt,tjb->tab", weight * area, strain, self.hooke(x), strain, optimize=True)
            for c in range(d):
                f = field(body if d == 1 else body[c])(x)
                right[:, c::d] += np.outer(weight * area * f, values)
        self.dofs = (self.triangles[:, :, None] * d + np.arange(d)).reshape(len(area), n)
        size = d * len(self.nodes)
        rows, columns = np.repeat(self.dofs, n, axis=1), np.tile(self.dofs, (1, n))
        self.k = sparse.csr_matrix((matrix.reshape(len(area), -1).ravel(), (rows.ravel(), columns.ravel())), (size, size))
        self.f = np.bincount(self.dofs.ravel(), right.ravel(), size)

    def edges(self, part):
        """The edges of a part, each with its three nodes, its outward normal and its length."""
        inside = {}
        for t in self.triangles:
            for k in range(3):
                inside[frozenset((t[k], t[(k + 1) % 3]))] = t[(k + 2) % 3]
        for a, b in self.boundary[part]:
            tangent = self.nodes[b] - self.nodes[a]
            normal = np.array([tangent[1], -tangent[0]]) / np.hypot(*tangent)
            if normal @ (self.nodes[inside[frozenset((a, b))]] - self.nodes[a]) > 0:
                normal = -normal
            yield (a, b, self.midpoint(a, b)), normal, np.hypot(*tangent)

    def add_traction(self, part, condition):
        d = self.components
        for nodes, normal, length in self.edges(part):
            for s, weight in zip(*GAUSS):
                x = (1 - s) * self.nodes[nodes[0]] + s * self.nodes[nodes[1]]
                if "pressure" in condition:
                    t = -field(condition["pressure"])(x, normal) * normal
                else:
                    value = condition.get("value", [0] * d)
                    t = [field(v)(x, normal) for v in (value if d == 2 else [value])]
                for node, shape in zip(nodes, ((1 - s) * (1 - 2 * s), s * (2 * s - 1), 4 * s * (1 - s))):
                    for c in range(d):
                        self.f[node * d + c] += weight * length * t[c] * shape

    def solve(self):
        d = self.components
        conditions = dict(self.document["boundary"])
        rest = conditions.pop("all", None)
        for part in self.boundary:
            if rest and part not in conditions:
                conditions[part] = rest
        fixed, rollers, contacts = {}, [], {}
        for part, condition in conditions.items():
            if condition["type"] == "traction":
                self.add_traction(part, condition)
            for nodes, normal, _ in self.edges(part):
                for node in nodes:
                    x = self.nodes[node]
                    if condition["type"] == "fixed":
                        value = condition.get("value", 0 if d == 1 else [0, 0])
                        for c in range(d):
                            fixed[node * d + c] = field(value if d == 1 else value[c])(x, normal)
                    if condition["type"] == "roller":
                        rollers.append((node, normal, 0))
                    if condition["type"] == "contact":
                        along = np.array(condition.get("direction", normal if d == 2 else [-1]), float)
                        along /= np.linalg.norm(along)
                        gap = field(condition.get("gap", 0))(x, normal)
                        contacts[(node, tuple(np.round(along, 9)))] = (node, along, gap)
        free = np.setdiff1d(np.arange(self.k.shape[0]), list(fixed))
        held = lambda rows: [r for r in rows if r[0] * d not in fixed]
        return self.active_set(free, fixed, held(rollers), held(contacts.values()))

    def active_set(self, free, fixed, rollers, contacts):
        d = self.components
        u = np.zeros(self.k.shape[0])
        u[list(fixed)] = list(fixed.values())

        def rows(constraints):
            b = sparse.lil_matrix((len(constraints), len(u)))
            for i, (node, along, _) in enumerate(constraints):
                b[i, node * d:node * d + d] = along[:d]
            return b.tocsr(), np.array([g for _, _, g in constraints], float)

        # A roller that two edges share is one condition.
        unique = {(node, tuple(np.round(along, 9))): (node, along, g) for node, along, g in rollers}
        equal, zero = rows(list(unique.values()))
        b, gap = rows(contacts)
        active = np.ones(len(gap), bool)
        for step in range(60):
            all_rows = sparse.vstack([equal, b[active]])
            level = np.concatenate([zero, gap[active]]) - all_rows[:, list(fixed)] @ u[list(fixed)]
            m = all_rows.shape[0]
            kkt = sparse.bmat([[self.k[free][:, free], all_rows[:, free].T], [all_rows[:, free], sparse.csr_matrix((m, m))]])
            known = self.f[free] - self.k[free][:, list(fixed)] @ u[list(fixed)]
            solution = splu(kkt.tocsc()).solve(np.concatenate([known, level]))
            u[free] = solution[:len(free)]
            force = np.zeros(len(gap))
            force[active] = solution[len(free) + len(zero):]
            scale = max(abs(force).max(initial=0), 1e-300)
            next_active = (active & (force >= -1e-11 * scale)) | (~active & (b @ u > gap + 1e-12))
            if (next_active == active).all():
                break
            active = next_active
        energy = u @ (self.k @ u) / 2 - self.f @ u
        return energy, force.sum(), step


def main():
    daemon, path, refine = sys.argv[1], sys.argv[2], int(sys.argv[3])
    with open(path, encoding="utf-8") as file:
        document = json.load(file)
    energy, force, steps = Primal(document, *mesh_of(daemon, document, refine)).solve()
    print(f"{document['title'][:40]:40s} refine {refine} energy {energy:.9g} force {force:.9g} steps {steps}")


if __name__ == "__main__":
    main()
