"""Integrals over triangles and edges of what may jump anywhere: cells are halved where halving changes their share."""
import numpy as np

# Seven points, exact for degree five; barycentric coordinates and weights that sum to one.
_s = np.sqrt(15)
_a, _b = (6 - _s) / 21, (6 + _s) / 21
BARY = np.array([[1 / 3] * 3] + [[1 - 2 * c if i == k else c for i in range(3)] for c in (_a, _b) for k in range(3)])
WEIGHT = np.array([9 / 40] + [(155 - _s) / 1200] * 3 + [(155 + _s) / 1200] * 3)
_x, _w = np.polynomial.legendre.leggauss(5)
GAUSS, GAUSS_WEIGHT = (1 + _x) / 2, _w / 2

QUARTERS = np.array([[[2, 0, 0], [1, 1, 0], [1, 0, 1]], [[1, 1, 0], [0, 2, 0], [0, 1, 1]],
                     [[1, 0, 1], [0, 1, 1], [0, 0, 2]], [[1, 1, 0], [0, 1, 1], [1, 0, 1]]]) / 2
HALVES = np.array([[0, 0.5], [0.5, 1]])


def composite(levels):
    """Points and weights of the rule on a triangle cut into 4^levels."""
    cells = np.eye(3)[None]
    for _ in range(levels):
        cells = np.einsum("qij,cjk->cqik", QUARTERS, cells).reshape(-1, 3, 3)
    return np.einsum("pi,cik->cpk", BARY, cells).reshape(-1, 3), np.tile(WEIGHT / len(cells), len(cells))


def over_triangles(integrand, areas, tolerance, start, most_cells=30000, deepest=14):
    """Σ over triangles of ∫ integrand(triangle numbers, barycentric points (n, p, 3)), and how wrong that may be."""
    cells = np.eye(3)[None]
    for _ in range(start):
        cells = np.einsum("qij,cjk->cqik", QUARTERS, cells).reshape(-1, 3, 3)
    numbers = np.repeat(np.arange(len(areas)), len(cells))
    cells = np.tile(cells, (len(areas), 1, 1))
    cut = lambda cells: np.einsum("qij,cjk->cqik", QUARTERS, cells).reshape(-1, 3, 3)

    def share(numbers, cells):
        # The share of a cell in its triangle's area is |det| of its corners.
        weight = areas[numbers] * np.abs(np.linalg.det(cells))
        shares = np.empty(len(numbers))
        for i in range(0, len(numbers), 50000):
            part = slice(i, i + 50000)
            points = np.einsum("pi,cik->cpk", BARY, cells[part])
            shares[part] = integrand(numbers[part], points) @ WEIGHT
        return weight * shares

    return halve(share, numbers, cells, cut, 4, tolerance, most_cells, deepest)


def over_edges(integrand, lengths, tolerance, start, most_cells=20000, deepest=40):
    """Σ over edges of ∫ integrand(edge numbers, positions (n, p) in (0, 1)), and how wrong that may be."""
    ends = np.linspace(0, 1, 2 ** start + 1)
    cells = np.tile(np.stack([ends[:-1], ends[1:]], 1), (len(lengths), 1))
    numbers = np.repeat(np.arange(len(lengths)), 2 ** start)
    cut = lambda cells: (cells[:, None, :1] + HALVES * (cells[:, 1:] - cells[:, :1])[:, None]).reshape(-1, 2)

    def share(numbers, cells):
        width = cells[:, 1] - cells[:, 0]
        points = cells[:, :1] + width[:, None] * GAUSS
        return lengths[numbers] * width * (integrand(numbers, points) @ GAUSS_WEIGHT)

    return halve(share, numbers, cells, cut, 2, tolerance, most_cells, deepest)


def halve(share, numbers, cells, cut, pieces, tolerance, most_cells, deepest):
    total, square, drift = 0.0, 0.0, 0.0
    now = share(numbers, cells)
    for level in range(deepest):
        numbers, cells = np.repeat(numbers, pieces), cut(cells)
        finer = share(numbers, cells)
        change = finer.reshape(-1, pieces).sum(1) - now
        # Jumps leave changes of either sign: they add up like the steps of a random walk.
        order = np.argsort(np.abs(change))
        settled = np.cumsum(change[order] ** 2) <= (tolerance / 4) ** 2
        open_ = np.ones(len(change), bool)
        open_[order[settled]] = False
        if level == deepest - 1 or pieces * open_.sum() > most_cells:
            open_[:] = False
        total += finer.reshape(-1, pieces)[~open_].sum()
        square += (change[~open_] ** 2).sum()
        drift += change[~open_].sum()
        keep = np.repeat(open_, pieces)
        numbers, cells, now = numbers[keep], cells[keep], finer[keep]
        if not len(now):
            break
    return total, 4 * np.sqrt(square) + abs(drift)
