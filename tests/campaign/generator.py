"""A problem document from a seed: small, well posed, and as varied as the service allows."""
import random

import units

SCHEMES = ("conforming", "nonconforming")
PATTERNS = ("right", "left", "alternating", "crossed")


def problem(seed):
    return Generator(seed).document()


class Generator:
    def __init__(self, seed):
        self.rng = random.Random(f"signorini campaign {seed}")
        self.seed = seed

    def document(self):
        rng = self.rng
        self.elastic = rng.random() < 0.5
        domain, mesh, roles = self.domain()
        document = {"title": f"campaign {self.seed}", "model": "elasticity" if self.elastic else "membrane",
                    "domain": domain, "mesh": mesh, "material": self.material(), "boundary": self.boundary(roles),
                    "scheme": rng.choice(SCHEMES),
                    "solver": {"method": rng.choice(("active_set", "uzawa"))}}
        load = self.load()
        if load is None and not self.is_driven(document["boundary"]):
            load = [0, -0.05]
        if load is not None:
            document["load"] = {"body": load}
        if rng.random() < 0.2:
            document = units.scaled(document, *(rng.choice((1e-9, 1e-3, 1.0, 1e3, 1e9)) for _ in range(3)))
        return document

    @staticmethod
    def is_driven(boundary):
        return any(key in condition for condition in boundary.values() for key in ("value", "pressure"))

    # Fields. A size is what the values differ by.

    def number(self, low, high):
        return round(self.rng.uniform(low, high), 4)

    def irrational(self, low, high):
        """A place that no mesh of ours has a line at."""
        return self.rng.uniform(low, high)

    def line(self):
        a = self.rng.choice(("x", "y", "x + 0.7*y", "x - 0.3*y"))
        return f"{a} < {self.irrational(0.2, 0.8)!r}"

    def circle(self):
        return (f"(x - {self.number(0.1, 0.9)})^2 + (y - {self.number(0.1, 0.9)})^2 < "
                f"{self.irrational(0.03, 0.2)!r}")

    def wave(self, size):
        a, b, phase = self.number(-9, 9), self.number(-9, 9), self.number(0, 6)
        return f"{size:.5g}*sin({a}*x + {b}*y + {phase})"

    def polynomial(self, size):
        form = self.rng.choice(("x", "y", "(x - 0.5)*y", "(x - 0.5)^2", "x^2 - y^2", "x^3 + x*y"))
        return f"{self.rng.choice((-1, 1)) * size:.5g}*({form})"

    def jump(self, size):
        where = self.line() if self.rng.random() < 0.6 else self.circle()
        return f"({where} ? {size:.5g} : {-size:.5g})"

    def steep(self, size):
        return f"{size:.5g}*tanh({self.rng.choice((20, 60, 200))}*(x - {self.irrational(0.2, 0.8)!r}))"

    def kink(self, size):
        a, c = self.rng.choice("xy"), self.irrational(0.2, 0.8)
        form = self.rng.choice((f"abs({a} - {c!r})", f"min({a}, {c!r})", f"max({a} - {c!r}, 0)"))
        return f"{size:.5g}*{form}"

    def varied(self, mean, size, kinds):
        """mean + something of one of these kinds that is at most about size."""
        kind = self.rng.choice(kinds)
        if kind == "constant":
            return round(mean, 5)
        return f"{mean:.5g} + {getattr(self, kind)(size)}"

    # Where.

    def domain(self):
        """domain, mesh and the roles that parts may play: floor, walls, roof, others."""
        rng = self.rng
        kind = rng.choice(("rectangle",) * 4 + ("convex", "re-entrant", "bent", "hole", "imported", "graded"))
        box = {"floor": ["bottom"], "walls": ["left", "right"], "roof": ["top"], "others": [], "box": True}
        if kind == "rectangle":
            size = [self.number(0.7, 1.6), self.number(0.7, 1.3)] if rng.random() < 0.5 else [1, 1]
            divisions = [rng.randint(3, 9), rng.randint(3, 8)]
            mesh = {"divisions": divisions, "pattern": rng.choice(PATTERNS)}
            return {"type": "rectangle", "size": size}, mesh, box
        if kind == "imported":
            return self.imported(), {}, box | {"box": False}
        jitter = lambda p: [round(c + rng.uniform(-0.05, 0.05), 4) for c in p]
        if kind in ("convex", "graded"):
            vertices = [[0, 0], [1, 0]] + [jitter(p) for p in ([1.2, 0.6], [0.5, 1.1], [-0.1, 0.7])]
            sides = ["bottom", "right", "upper right", "upper left", "left"]
            roles = {"floor": ["bottom"], "walls": ["left", "right"], "roof": ["upper right", "upper left"],
                     "others": []}
        elif kind == "re-entrant":
            inner = jitter([0.7, 0.6])
            vertices = [[0, 0], [1.5, 0], [1.5, inner[1]], inner, [inner[0], 1.2], [0, 1.2]]
            sides = ["bottom", "right", "ledge", "inner", "top", "left"]
            roles = {"floor": ["bottom"], "walls": ["left", "right"], "roof": ["top"], "others": ["ledge", "inner"]}
        elif kind == "bent":
            vertices = [[0, self.number(0.05, 0.2)], [self.number(0.4, 0.6), 0], [1, self.number(0.05, 0.2)],
                        [1, 1], [0, 1]]
            sides = ["bottom", "bottom right", "right", "top", "left"]
            if rng.random() < 0.5:
                sides[1] = "bottom"
            floor = sorted(set(sides[:2]))
            roles = {"floor": floor, "walls": ["left", "right"], "roof": ["top"], "others": []}
        else:
            vertices = [[0, 0], [1.2, 0], [1.2, 1], [0, 1]]
            sides = ["bottom", "right", "top", "left"]
            roles = {"floor": ["bottom"], "walls": ["left", "right"], "roof": ["top"], "others": ["hole0"]}
        domain = {"type": "polygon", "vertices": vertices, "sides": sides}
        if kind == "hole":
            domain["holes"] = [[jitter(p) for p in ([0.4, 0.4], [0.8, 0.4], [0.8, 0.7], [0.45, 0.65])]]
        mesh = {"size": self.number(0.15, 0.3)}
        if kind == "graded":
            mesh["sizes"] = [{"at": [self.number(0.2, 0.8), 0], "radius": self.number(0.1, 0.3), "size": 0.05}]
        return domain, mesh, roles

    def imported(self):
        """Squares that are no squares any more."""
        rng, n, m = self.rng, self.rng.randint(3, 7), self.rng.randint(3, 6)
        sway, lift = self.number(-0.2, 0.2), self.number(0, 0.15)
        shift = lambda i, j, count: rng.uniform(-0.1, 0.1) / count if 0 < i < n and 0 < j < m else 0
        points = [[round(i / n + sway * j / m + shift(i, j, n), 6),
                   round(j / m * (1 + lift * i / n) + shift(i, j, m), 6)]
                  for j in range(m + 1) for i in range(n + 1)]
        at = lambda i, j: j * (n + 1) + i
        triangles = []
        for j in range(m):
            for i in range(n):
                a, b, c, d = at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)
                triangles += [[a, b, c], [a, c, d]] if rng.random() < 0.5 else [[a, b, d], [b, c, d]]
        return {"type": "mesh", "points": points, "triangles": triangles,
                "boundary": {"bottom": [[at(i, 0), at(i + 1, 0)] for i in range(n)],
                             "right": [[at(n, j), at(n, j + 1)] for j in range(m)],
                             "top": [[at(i, m), at(i + 1, m)] for i in range(n)],
                             "left": [[at(0, j), at(0, j + 1)] for j in range(m)]}}

    # What.

    def material(self):
        rng, rough = self.rng, ("constant", "constant", "wave", "jump", "steep")
        if not self.elastic:
            if rng.random() < 0.7:
                return {"stiffness": self.varied(1, 0.6, rough)}
            off = self.number(-0.5, 0.5)
            return {"stiffness": [[self.varied(2, 0.6, rough), off], [off, self.varied(1, 0.4, rough)]]}
        if rng.random() < 0.2:
            factor = rng.choice(("1", "(1 + 0.3*sin(5*x))", f"({self.line()} ? 1 : 3)"))
            rows = [[2, 0.4, 0.1], [0.4, 1, 0], [0.1, 0, 0.5]]
            return {"tensor": rows if factor == "1" else [[f"{v}*{factor}" for v in row] for row in rows]}
        poisson = rng.choice((-0.5, 0, 0.25, 0.3, 0.3, 0.45, 0.499, 0.49999))
        return {"young": self.varied(1, 0.5, rough), "poisson": poisson, "plane": rng.choice(("strain", "stress"))}

    def load(self):
        """Downwards more than upwards."""
        rng = self.rng
        kinds = ("constant", "polynomial", "wave", "jump", "steep")
        if not self.elastic:
            size = rng.uniform(0.5, 4)
            if self.loose:
                return self.varied(-rng.uniform(0.2, 1.5), 0.1, ("wave",))
            return self.varied(-size / 2, size, kinds)
        size = rng.uniform(0.02, 0.15)
        if self.loose:
            return [0, self.varied(-size, size / 2, ("constant", "wave"))]
        if rng.random() < 0.15:
            return None
        return [self.varied(0, size / 2, kinds), self.varied(-size, size, kinds)]

    def gap(self, least):
        size = self.rng.uniform(0.01, 0.08)
        kind = self.rng.choice(("constant", "zero", "polynomial", "kink", "jump", "wave", "steep"))
        if kind == "zero":
            return round(least, 5)
        if kind == "constant":
            return round(least + size, 5)
        # Nowhere below the least, which the fixed values beside it may reach.
        if kind in ("jump", "steep"):
            return f"{least + size:.5g} + {getattr(self, kind)(size * 0.9)}"
        return f"{least:.5g} + max(0, {getattr(self, kind)(size)})"

    def contact(self, least, part):
        condition = {"type": "contact", "gap": self.gap(least)}
        if self.elastic and part.startswith("bottom") and self.rng.random() < 0.3:
            condition["direction"] = [0, -1] if self.rng.random() < 0.7 else [self.number(-0.2, 0.2), -2]
        return condition

    def traction(self):
        kinds = ("constant", "polynomial", "wave", "jump", "steep")
        if not self.elastic:
            return {"type": "traction", "value": self.varied(0, self.rng.uniform(0.1, 1), kinds)}
        size = self.rng.uniform(0.01, 0.1)
        if self.rng.random() < 0.4:
            return {"type": "traction", "pressure": self.varied(size, size / 2, kinds)}
        return {"type": "traction", "value": [self.varied(0, size / 2, kinds), self.varied(-size, size, kinds)]}

    def fixed(self, still):
        if still:
            return {"type": "fixed"}
        # One field for all fixed parts: they meet in corners.
        self.common = getattr(self, "common", None) or [
            self.rng.choice((self.wave, self.polynomial))(0.02) for _ in range(2 if self.elastic else 1)]
        return {"type": "fixed", "value": self.common if self.elastic else self.common[0]}

    def boundary(self, roles):
        rng = self.rng
        self.loose = rng.random() < 0.15
        floor, walls, roof, others = (list(roles[k]) for k in ("floor", "walls", "roof", "others"))
        if self.loose and self.elastic:
            return self.pressed(roles)
        if self.loose:
            return {"all": {"type": "contact", "gap": self.varied(0.05, 0.04, ("constant", "wave", "polynomial"))}}
        still = rng.random() < 0.55
        least = 0.0 if still else 0.06
        boundary = {part: self.contact(least, part) for part in floor}
        if rng.random() < 0.3:
            part = rng.choice(walls + roof + others)
            boundary[part] = self.contact(least, part)
        rest = [p for p in walls + roof + others if p not in boundary]
        rng.shuffle(rest)
        boundary[rest.pop()] = self.fixed(still)
        for part in rest:
            choice = rng.random()
            if choice < 0.25:
                boundary[part] = self.fixed(still)
            elif choice < 0.65:
                boundary[part] = self.traction()
            elif choice < 0.75 and self.elastic and roles.get("box") and still:
                boundary[part] = {"type": "roller"}
        return boundary

    def pressed(self, roles):
        """A body that stands on the floor, between rollers or walls."""
        side = {"type": "roller"} if self.rng.random() < 0.6 and roles.get("box") else {"type": "contact"}
        boundary = {part: dict(side) for part in roles["walls"]}
        if side["type"] == "contact" and self.rng.random() < 0.5:
            for condition in boundary.values():
                condition["gap"] = 0.001
        for part in roles["floor"]:
            # An overlap at the beginning, too: nothing that is fixed contradicts it.
            boundary[part] = {"type": "contact", "gap": self.gap(self.rng.choice((0.0, 0.0, -0.02)))}
        for part in roles["roof"]:
            size = self.rng.uniform(0.02, 0.1)
            boundary[part] = {"type": "traction", "pressure": self.varied(size, size / 2, ("constant", "wave"))}
        return boundary
