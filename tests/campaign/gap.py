"""A gap as a piecewise linear function, finely enough cut to tell where a quadratic exceeds it."""
import numpy as np

from expression import Field


class GapSamples:
    def __init__(self, contacts, nodes, start=64):
        self.sources = []  # gap, edges' begins and ends, normals; edges are counted through all parts
        for condition, edges, normals in contacts:
            self.sources.append((Field(condition.get("gap", 0)), nodes[edges[:, 0]], nodes[edges[:, 1]], normals))
        self.count = sum(len(begins) for _, begins, _, _ in self.sources)
        ends = np.linspace(0, 1, start + 1)
        e = np.repeat(np.arange(self.count), start)
        s0, s1 = np.tile(ends[:-1], self.count), np.tile(ends[1:], self.count)
        g0, g1 = self.at(e, s0), self.at(e, s1)
        tolerance = 1e-9 * np.abs(g0).max()
        done = []
        while len(e):
            middle = (s0 + s1) / 2
            gm = self.at(e, middle)
            # Two more places, so that a kink in the middle or a wave does not look straight.
            quarter = self.at(e, s0 + 0.23 * (s1 - s0)) - (0.77 * g0 + 0.23 * g1)
            bent = (np.maximum(np.abs(gm - (g0 + g1) / 2), np.abs(quarter)) > tolerance) & (s1 - s0 > 1e-13)
            done.append(np.stack([e, s0, s1, g0, g1])[:, ~bent])
            e, s0, s1, g0, g1, m, gm = (v[bent] for v in (e, s0, s1, g0, g1, middle, gm))
            e, s0, s1 = np.tile(e, 2), np.concatenate([s0, m]), np.concatenate([m, s1])
            g0, g1 = np.concatenate([g0, gm]), np.concatenate([gm, g1])
        e, self.s0, self.s1, self.g0, self.g1 = np.concatenate(done, 1)
        self.edge = e.astype(int)

    def at(self, edges, s):
        out, first = np.zeros(len(s)), 0
        for gap, begins, ends, normals in self.sources:
            mine = (edges >= first) & (edges < first + len(begins))
            i = edges[mine] - first
            out[mine] = gap(begins[i] + s[mine, None] * (ends[i] - begins[i]), normals[i])
            first += len(begins)
        return out

    def pieces(self, trace):
        """Over each piece, v_n − g as e0 + e1 r + e2 r² with r in (0, 1)."""
        begin, end, middle = trace[self.edge].T
        linear, square = -3 * begin - end + 4 * middle, 2 * begin + 2 * end - 4 * middle
        width = self.s1 - self.s0
        e0 = begin + self.s0 * (linear + self.s0 * square) - self.g0
        e1 = width * (linear + 2 * self.s0 * square) - (self.g1 - self.g0)
        return e0, e1, width ** 2 * square

    def excess(self, trace):
        """The largest v_n − g of each edge, and where it is."""
        e0, e1, e2 = self.pieces(trace)
        with np.errstate(all="ignore"):
            top = np.where(e2 < 0, np.clip(-e1 / (2 * e2), 0, 1), np.where(e1 + e2 > 0, 1, 0))
        value = e0 + top * (e1 + top * e2)
        largest = np.full(self.count, -np.inf)
        np.maximum.at(largest, self.edge, value)
        where = np.zeros(self.count)
        best = value >= largest[self.edge]
        where[self.edge[best]] = (self.s0 + top * (self.s1 - self.s0))[best]
        return largest, where

    def needed(self, trace, movable, rounding):
        """How far the ends of each edge that can move must be lowered, linearly along the edge."""
        e0, e1, e2 = self.pieces(trace)
        top = np.maximum(e0, e0 + e1 + np.maximum(e2, 0) + np.maximum(-e2, 0) / 4)
        out = np.zeros(self.count)
        both = movable.all(1)[self.edge]
        np.maximum.at(out, self.edge[both], top[both])
        for k in range(2):
            mine = (movable[:, k] & ~movable[:, 1 - k])[self.edge]
            # Only end k moves: its hat is s or 1 − s, 0 at the end that is fixed.
            low, high = (self.s0, self.s1) if k == 1 else (1 - self.s1, 1 - self.s0)
            beside = e0 if k == 1 else e0 + e1 + e2
            with np.errstate(all="ignore"):
                ratio = top / low
            first = low < 1e-12
            slope = np.maximum(e1, e1 + e2) if k == 1 else np.maximum(-e1, -e1 - 2 * e2)
            at_end = np.where(beside <= 10 * rounding, np.maximum(slope, 0) / high, np.inf)
            ratio = np.where(top <= 0, 0, np.where(first, at_end, ratio))
            np.maximum.at(out, self.edge[mine], ratio[mine])
        stuck = ~movable.any(1)[self.edge] & (top > 10 * rounding)
        out[self.edge[stuck]] = np.inf
        return np.maximum(out, 0)
