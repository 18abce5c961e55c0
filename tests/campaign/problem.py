"""What a problem document says, as fields."""
import numpy as np

from expression import Field


class Problem:
    def __init__(self, document):
        self.document = document
        self.components = 1 if document["model"] == "membrane" else 2
        d = self.components
        body = document.get("load", {}).get("body", 0 if d == 1 else [0, 0])
        self.body = fields(body, d)
        self.material = self.read_material(document["material"])

    def condition(self, part):
        boundary = self.document.get("boundary", {})
        return boundary.get(part, boundary.get("all", {"type": "traction"}))

    def read_material(self, material):
        matrix = lambda m: [[Field(v) for v in row] for row in m]
        if "tensor" in material:
            return matrix(material["tensor"])
        if self.components == 1:
            kappa = material["stiffness"]
            return matrix(kappa if isinstance(kappa, list) else [[kappa, 0], [0, kappa]])
        self.plane = material.get("plane", "strain")
        return Field(material["young"]), Field(material["poisson"])

    def hooke(self, x):
        """The stiffness (…, m, m) over (u_x, u_y) or over the engineering strains xx, yy, xy."""
        if isinstance(self.material, list):
            return np.stack([np.stack([f(x) for f in row], -1) for row in self.material], -2)
        e, nu = (f(x) for f in self.material)
        mu = e / (2 * (1 + nu))
        lame = e * nu / ((1 - nu ** 2) if self.plane == "stress" else ((1 + nu) * (1 - 2 * nu)))
        zero = 0 * e
        rows = [[lame + 2 * mu, lame, zero], [lame, lame + 2 * mu, zero], [zero, zero, mu]]
        return np.stack([np.stack(row, -1) for row in rows], -2)

    def loads(self, x):
        return np.stack([f(x) for f in self.body], -1)

    def values(self, condition, key):
        return fields(condition.get(key, 0 if self.components == 1 else [0, 0]), self.components)

    def traction(self, condition):
        """t as a function of points and normals, or nothing where there is none."""
        if "pressure" in condition:
            pressure = Field(condition["pressure"])
            return lambda x, n: -pressure(x, n)[..., None] * n
        if "value" in condition:
            value = self.values(condition, "value")
            return lambda x, n: np.stack([f(x, n) for f in value], -1)
        return None

    def fixed(self, condition):
        value = self.values(condition, "value")
        return lambda x, n: np.stack([f(x, n) for f in value], -1)

    def contact_directions(self, condition, normals):
        """The direction of u_n on each edge; for a membrane u_n = −u."""
        if self.components == 1:
            return -np.ones((len(normals), 1))
        if "direction" in condition:
            along = np.array(condition["direction"], float)
            return np.tile(along / np.hypot(*along), (len(normals), 1))
        return normals


def fields(value, components):
    return [Field(v) for v in (value if components == 2 else [value])]
