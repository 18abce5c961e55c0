"""The same problem in other units."""
import copy
import re


def scaled(document, length, displacement, stiffness):
    """Lengths, displacements and stiffness times these; the energy is stiffness · displacement² times what it was."""
    out = copy.deepcopy(document)

    def field(value, factor):
        if isinstance(value, list):
            return [field(v, factor) for v in value]
        if not isinstance(value, str):
            return value * factor
        inner = re.sub(r"\b([xy])\b", rf"(\1/{length!r})", value)
        return f"({inner})*{factor!r}" if factor != 1 else inner

    def lengths(value):
        return [lengths(v) for v in value] if isinstance(value, list) else value * length

    domain, mesh = out["domain"], out.get("mesh", {})
    for key in ("origin", "size", "vertices", "holes", "points"):
        if key in domain:
            domain[key] = lengths(domain[key])
    if domain["type"] == "rectangle":
        domain.setdefault("size", [length, length])
    if "size" in mesh:
        mesh["size"] = lengths(mesh["size"])
    for near in mesh.get("sizes", []):
        for key in ("at", "radius", "size"):
            near[key] = lengths(near[key])
    for key, factor in (("stiffness", stiffness), ("young", stiffness), ("tensor", stiffness), ("poisson", 1)):
        if key in out["material"]:
            out["material"][key] = field(out["material"][key], factor)
    if "load" in out:
        out["load"]["body"] = field(out["load"]["body"], stiffness * displacement / length ** 2)
    for condition in out["boundary"].values():
        traction = condition["type"] == "traction"
        for key in ("value", "pressure", "gap"):
            if key in condition:
                condition[key] = field(condition[key], stiffness * displacement / length if traction else displacement)
    return out
