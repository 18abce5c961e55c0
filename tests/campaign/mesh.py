"""Triangles with named boundary parts, made here for rectangles; other domains bring their own or the service's."""
import json
import subprocess

import numpy as np


class Mesh:
    def __init__(self, points, triangles, boundary):
        self.points = np.asarray(points, float)
        triangles = np.asarray(triangles, int)
        a, b, c = (self.points[triangles[:, k]] for k in range(3))
        clockwise = cross(b - a, c - a) < 0
        triangles[clockwise] = triangles[clockwise][:, ::-1]
        self.triangles = triangles
        self.boundary = {part: np.asarray(edges, int).reshape(-1, 2) for part, edges in boundary.items()}
        ends = np.sort(np.stack([triangles[:, [1, 2]], triangles[:, [2, 0]], triangles[:, [0, 1]]], 1), 2)
        self.edges, numbers = np.unique(ends.reshape(-1, 2), axis=0, return_inverse=True)
        self.triangle_edges = numbers.reshape(-1, 3)
        self.number = {(a, b): i for i, (a, b) in enumerate(self.edges.tolist())}
        self.owner = {}
        for t, edges in enumerate(self.triangle_edges.tolist()):
            for k, edge in enumerate(edges):
                self.owner[edge] = (t, k)

    def edge_number(self, a, b):
        return self.number[(min(a, b), max(a, b))]

    def refined(self):
        """Each triangle cut into four by the midpoints of its edges."""
        middle = len(self.points) + self.triangle_edges
        t = self.triangles
        four = [[t[:, 0], middle[:, 2], middle[:, 1]], [middle[:, 2], t[:, 1], middle[:, 0]],
                [middle[:, 1], middle[:, 0], t[:, 2]], [middle[:, 0], middle[:, 1], middle[:, 2]]]
        points = np.vstack([self.points, self.points[self.edges].mean(1)])
        halves = {}
        for part, edges in self.boundary.items():
            m = np.array([len(self.points) + self.edge_number(a, b) for a, b in edges.tolist()], int)
            halves[part] = np.concatenate([np.stack([edges[:, 0], m], 1), np.stack([m, edges[:, 1]], 1)])
        return Mesh(points, np.concatenate([np.stack(f, 1) for f in four]), halves)

    def outward_normals(self, part):
        """A unit normal an edge, out of the triangle that it bounds."""
        normals = []
        for a, b in self.boundary[part].tolist():
            t, k = self.owner[self.edge_number(a, b)]
            along = self.points[b] - self.points[a]
            normal = np.array([along[1], -along[0]]) / np.hypot(*along)
            inward = self.points[self.triangles[t, k]] - self.points[a]
            normals.append(-normal if normal @ inward > 0 else normal)
        return np.array(normals)


def cross(a, b):
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def crossed_squares(origin, size, nx, ny):
    """A rectangle of squares, each cut by both diagonals."""
    x = origin[0] + size[0] * np.arange(nx + 1) / nx
    y = origin[1] + size[1] * np.arange(ny + 1) / ny
    corner = lambda i, j: j * (nx + 1) + i
    points = [(a, b) for b in y for a in x]
    triangles = []
    for j in range(ny):
        for i in range(nx):
            ring = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)]
            points.append(((x[i] + x[i + 1]) / 2, (y[j] + y[j + 1]) / 2))
            triangles += [(ring[k], ring[(k + 1) % 4], len(points) - 1) for k in range(4)]
    return Mesh(points, triangles,
                {"bottom": [(corner(i, 0), corner(i + 1, 0)) for i in range(nx)],
                 "top": [(corner(i, ny), corner(i + 1, ny)) for i in range(nx)],
                 "left": [(corner(0, j), corner(0, j + 1)) for j in range(ny)],
                 "right": [(corner(nx, j), corner(nx, j + 1)) for j in range(ny)]})


def mesh_for(document, daemon, triangles):
    """A mesh of the document's domain of about so many triangles: a rectangle's does not fit the service's."""
    domain = document["domain"]
    if domain["type"] == "rectangle":
        origin, size = domain.get("origin", [0, 0]), domain.get("size", [1, 1])
        across = np.sqrt(triangles / 4 * size[0] / size[1])
        nx = max(3, round(across)) | 1
        return crossed_squares(origin, size, nx, max(3, round(nx * size[1] / size[0])) | 1)
    mesh = Mesh(**domain_mesh(document, daemon))
    while len(mesh.triangles) < triangles / 2:
        mesh = mesh.refined()
    return mesh


def domain_mesh(document, daemon):
    domain = document["domain"]
    if domain["type"] == "mesh":
        return {k: domain[k] for k in ("points", "triangles", "boundary")}
    # Of the service only the points and triangles of its mesh are taken.
    membrane = {"model": "membrane", "domain": domain, "material": {"stiffness": 1},
                "mesh": {k: v for k, v in document.get("mesh", {}).items() if k in ("size", "sizes")},
                "boundary": {"all": {"type": "fixed"}}, "scheme": "nonconforming", "solver": {"method": "active_set"}}
    done = subprocess.run([daemon, "solve", "--fields", "mesh", "-"], input=json.dumps(membrane), text=True,
                          capture_output=True, timeout=900)
    return json.loads(done.stdout)["mesh"]
