"""The problems that are measured, as a client would post them; those of freefem/ are the same."""

PAPER_ENERGY = -0.914792950798
"""Of the paper's problem; by an independent program, all digits."""


def paper(n, scheme="nonconforming", method="active_set"):
    return {
        "model": "membrane",
        "domain": {"type": "rectangle", "origin": [0, 0], "size": [1, 1]},
        "mesh": {"divisions": [n, n]},
        "material": {"stiffness": 1},
        "load": {"body": "x < 0.5 ? 10 : -10"},
        "boundary": {side: {"type": "fixed"} for side in ("left", "right")}
        | {side: {"type": "contact"} for side in ("bottom", "top")},
        "scheme": scheme,
        "solver": {"method": method},
    }


def elastic_block(n, method="active_set"):
    """On rollers, pressed on a foundation that falls away."""
    return {
        "model": "elasticity",
        "domain": {"type": "rectangle", "origin": [0, 0], "size": [1, 1]},
        "mesh": {"divisions": [n, n]},
        "material": {"young": 200, "poisson": 0.3},
        "boundary": {
            "left": {"type": "roller"},
            "bottom": {"type": "contact", "gap": "0.01 * x^2"},
            "top": {"type": "traction", "pressure": 1},
        },
        "scheme": "nonconforming",
        "solver": {"method": method},
    }


def gap_sweep(n, count):
    """The block, its left side held, over a foundation that tilts in so many steps."""
    problem = elastic_block(n)
    problem["boundary"]["left"] = {"type": "fixed"}
    gaps = [0.01 * (k + 1) / count for k in range(count)]
    problem["sweep"] = [{"boundary": {"bottom": {"gap": f"{gap} * x"}}} for gap in gaps]
    return problem
