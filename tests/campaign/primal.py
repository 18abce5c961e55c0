"""An upper bound of the least energy, by another method than the service's.

Quadratic displacements; contact as a quadratic program over the contact's nodes with samples of v_n ≤ g as its
conditions. What comes out is then lowered until v_n ≤ g holds along all of the contact, and takes the fixed values
exactly, so that J(v) = ½ a(v, v) − (f, v) − <t, v> is at least the minimum whatever else is inexact; only the
integrals of J(v) itself are not exact, and say by how much.
"""
import numpy as np
import scipy.linalg
import scipy.sparse as sparse
from scipy.optimize import nnls
from scipy.sparse.linalg import splu

import quadrature
from gap import GapSamples
from mesh import mesh_for
from problem import Problem


class NotAdmissible(Exception):
    """No admissible displacement was found."""


def shapes(l):
    """The six functions at barycentric points (…, 3): three corners, then the middles opposite to them."""
    corners = l * (2 * l - 1)
    middles = 4 * np.roll(l, -1, -1) * np.roll(l, -2, -1)
    return np.concatenate([corners, middles], -1)


def slopes(l):
    """Their derivatives (…, 6, 3) by the barycentric coordinates."""
    out = np.zeros(l.shape[:-1] + (6, 3))
    for k in range(3):
        i, j = (k + 1) % 3, (k + 2) % 3
        out[..., k, k] = 4 * l[..., k] - 1
        out[..., 3 + k, i] = 4 * l[..., j]
        out[..., 3 + k, j] = 4 * l[..., i]
    return out


def edge_shapes(s):
    """Begin, end, middle."""
    return np.stack([(1 - s) * (1 - 2 * s), s * (2 * s - 1), 4 * s * (1 - s)], -1)


class Primal:
    def __init__(self, document, mesh):
        self.problem = Problem(document)
        self.mesh = mesh
        self.d = self.problem.components
        self.force = 0.0  # ∫ p over the contact
        self.nodes = np.vstack([mesh.points, mesh.points[mesh.edges].mean(1)])
        self.elements = np.hstack([mesh.triangles, len(mesh.points) + mesh.triangle_edges])
        corners = mesh.points[mesh.triangles]
        jacobian = np.stack([corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]], 2)
        self.corners, self.areas = corners, np.linalg.det(jacobian) / 2
        self.gradients = np.array([[-1, -1], [1, 0], [0, 1]]) @ np.linalg.inv(jacobian)
        self.conditions = {part: self.problem.condition(part) for part in mesh.boundary}

    def parts(self, kind):
        """The parts with such a condition: condition, edges as begin, end, middle, and their normals."""
        for part, condition in self.conditions.items():
            edges = self.mesh.boundary[part]
            if condition["type"] == kind and len(edges):
                middles = [len(self.mesh.points) + self.mesh.edge_number(a, b) for a, b in edges.tolist()]
                yield condition, np.column_stack([edges, middles]), self.mesh.outward_normals(part)

    def along(self, edges, s):
        a, b = self.nodes[edges[:, 0]], self.nodes[edges[:, 1]]
        return a[:, None] + s[..., None] * (b - a)[:, None]

    # The system.

    def strains(self, t, l):
        """u → (u_x, u_y) or (xx, yy, xy) at points l (n, p, 3) of triangles t: (n, p, m, 6 d)."""
        gradients = np.einsum("npak,nkj->npaj", slopes(l), self.gradients[t])
        if self.d == 1:
            return gradients.swapaxes(-1, -2)
        out = np.zeros(l.shape[:-1] + (3, 12))
        out[..., 0, 0::2] = out[..., 2, 1::2] = gradients[..., 0]
        out[..., 1, 1::2] = out[..., 2, 0::2] = gradients[..., 1]
        return out

    def points(self, t, l):
        return np.einsum("npk,nkj->npj", l, self.corners[t])

    def assemble(self):
        d, count = self.d, len(self.elements)
        matrix, right = np.zeros((count, 6 * d, 6 * d)), np.zeros((count, 6 * d))
        everything = np.arange(count)
        for l, weight in zip(*quadrature.composite(1)):
            l = np.broadcast_to(l, (count, 1, 3))
            x = self.points(everything, l)
            strain = self.strains(everything, l)[:, 0]
            share = (weight * self.areas)[:, None]
            matrix += strain.swapaxes(1, 2) @ ((share[..., None] * self.problem.hooke(x)[:, 0]) @ strain)
            f = self.problem.loads(x)[:, 0]
            for c in range(d):
                right[:, c::d] += share * f[:, c:c + 1] * shapes(l)[:, 0]
        dofs = (self.elements[:, :, None] * d + np.arange(d)).reshape(count, -1)
        rows, columns = np.repeat(dofs, 6 * d, 1), np.tile(dofs, (1, 6 * d))
        size = d * len(self.nodes)
        self.k = sparse.csr_matrix((matrix.ravel(), (rows.ravel(), columns.ravel())), (size, size))
        self.f = np.bincount(dofs.ravel(), right.ravel(), size)
        for condition, edges, normals in self.parts("traction"):
            traction = self.problem.traction(condition)
            if not traction:
                continue
            lengths = np.hypot(*(self.nodes[edges[:, 1]] - self.nodes[edges[:, 0]]).T)
            for s, weight in zip(quadrature.GAUSS, quadrature.GAUSS_WEIGHT):
                t = traction(self.along(edges, np.full((len(edges), 1), s))[:, 0], normals)
                for node, shape in zip(edges.T, edge_shapes(np.array(s))):
                    for c in range(d):
                        np.add.at(self.f, node * d + c, weight * lengths * t[:, c] * shape)

    def constrain(self):
        """u = given + basis z: fixed values and rollers are in it, and no others."""
        d = self.d
        self.given = np.zeros(d * len(self.nodes))
        self.is_fixed = np.zeros(len(self.nodes), bool)
        for condition, edges, normals in self.parts("fixed"):
            value = self.problem.fixed(condition)
            for k in range(3):
                self.given.reshape(-1, d)[edges[:, k]] = value(self.nodes[edges[:, k]], normals)
                self.is_fixed[edges[:, k]] = True
        rolled = {}
        for _, edges, normals in self.parts("roller"):
            for nodes, normal in zip(edges, normals):
                for node in nodes:
                    rolled.setdefault(node, []).append(normal)
        blocks = {}
        for node in range(len(self.nodes)):
            if self.is_fixed[node]:
                blocks[node] = np.zeros((d, 0))
            elif node in rolled:
                n = rolled[node][0]
                turned = any(abs(n[0] * m[1] - n[1] * m[0]) > 1e-9 for m in rolled[node])
                blocks[node] = np.zeros((2, 0)) if turned else np.array([[-n[1]], [n[0]]])
        self.blocks = blocks
        rows, columns, values, self.first, count = [], [], [], np.zeros(len(self.nodes), int), 0
        for node in range(len(self.nodes)):
            block = blocks.get(node)
            self.first[node] = count
            if block is None:
                block = np.eye(d)
            for j in range(block.shape[1]):
                for i in range(d):
                    rows.append(node * d + i)
                    columns.append(count + j)
                    values.append(block[i, j])
            count += block.shape[1]
        self.basis = sparse.csr_matrix((values, (rows, columns)), (d * len(self.nodes), count))

    def normal_rows(self, edge_numbers, s):
        """v ↦ v_n at positions s of contact edges, as rows over all of u."""
        rows, columns, values = [], [], []
        count = len(s)
        for k, shape in enumerate(edge_shapes(s).T):
            for c in range(self.d):
                rows.append(np.arange(count))
                columns.append(self.contact_edges[edge_numbers, k] * self.d + c)
                values.append(shape * self.directions[edge_numbers, c])
        return sparse.csr_matrix((np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))),
                                 (count, self.k.shape[0]))

    # The minimum.

    def minimize(self):
        self.assemble()
        self.constrain()
        contacts = list(self.parts("contact"))
        stiffness = (self.basis.T @ self.k @ self.basis).tocsc()
        force = self.basis.T @ (self.f - self.k @ self.given)
        # A body that only contact holds needs a little hold of its own; any v will do.
        stiffness = stiffness + 1e-11 * sparse.diags(stiffness.diagonal())
        if not contacts:
            self.u = self.given + self.basis @ splu(stiffness.tocsc()).solve(force)
            return self
        self.contact_edges = np.concatenate([edges for _, edges, _ in contacts])
        self.directions = np.concatenate([self.problem.contact_directions(c, n) for c, _, n in contacts])
        self.gap = GapSamples(contacts, self.nodes)
        scale = max(np.abs(self.gap.g0).max(), np.abs(self.given).max())
        touched = np.zeros(len(self.nodes), bool)
        touched[self.contact_edges] = True
        of_contact = np.repeat(touched, self.d)
        is_c = np.asarray(abs(self.basis[of_contact]).sum(0)).ravel() > 0
        c, i = np.flatnonzero(is_c), np.flatnonzero(~is_c)
        inner = splu(stiffness[i][:, i].tocsc())
        coupling = stiffness[i][:, c].tocsc()
        schur = stiffness[c][:, c].toarray() - coupling.T @ inner.solve(coupling.toarray())
        schur = (schur + schur.T) / 2
        schur += 1e-10 * np.trace(schur) / len(c) * np.eye(len(c))
        right = force[c] - coupling.T @ inner.solve(force[i])
        # Beside an end that is fixed the slope counts: a sample very near to it has it.
        places = np.array([0, 1e-4, 0.25, 0.5, 0.75, 1 - 1e-4, 1])
        edges = np.repeat(np.arange(len(self.contact_edges)), len(places))
        s = np.tile(places, len(self.contact_edges))
        for _ in range(5):
            rows = self.normal_rows(edges, s)
            level = self.gap.at(edges, s) - rows @ self.given
            conditions = (rows @ self.basis[:, c]).toarray()
            usable = np.abs(conditions).max(1) > 1e-6
            z, forces = least_distance(schur, right, conditions[usable], level[usable])
            # A test with v_n = 1 at all nodes that can move.
            moves = ~self.is_fixed[self.contact_edges[edges[usable]]]
            self.force = forces @ (edge_shapes(s[usable]) * moves).sum(1)
            whole = np.zeros(len(force))
            whole[c], whole[i] = z, inner.solve(force[i] - coupling @ z)
            self.u = self.given + self.basis @ whole
            excess, where = self.gap.excess(self.trace())
            scale = max(scale, np.abs(self.trace()).max())
            bad = excess > 1e-6 * scale
            if not bad.any():
                break
            edges, s = np.concatenate([edges, np.flatnonzero(bad)]), np.concatenate([s, where[bad]])
        self.lower(max(scale, np.abs(self.u).max()))
        return self

    def trace(self):
        """v_n on each contact edge at begin, end and middle."""
        u = self.u.reshape(-1, self.d)
        return np.einsum("ekc,ec->ek", u[self.contact_edges], self.directions)

    def lower(self, scale):
        """Takes a piecewise linear w off v, so that v_n ≤ g everywhere."""
        rounding = 1e-13 * scale
        needed = {}
        movable = np.zeros((len(self.contact_edges), 2), bool)
        for e, (nodes, direction) in enumerate(zip(self.contact_edges, self.directions)):
            for k in range(2):
                block = self.blocks.get(nodes[k], np.eye(self.d))
                movable[e, k] = block.size and np.abs(direction @ block).max() > 1e-6
        for e, amount in enumerate(self.gap.needed(self.trace(), movable, rounding)):
            if amount <= 0:
                continue
            if not movable[e].any() or not np.isfinite(amount):
                raise NotAdmissible("v_n > g beside a node that is fixed")
            for k in range(2):
                if movable[e, k]:
                    needed.setdefault(self.contact_edges[e, k], []).append((self.directions[e], amount))
        shift = np.zeros((len(self.nodes), self.d))
        for node, conditions in needed.items():
            block = self.blocks.get(node, np.eye(self.d))
            move = np.zeros(self.d)
            for _ in range(200):
                worst = max(conditions, key=lambda c: c[1] - c[0] @ move)
                lack = worst[1] - worst[0] @ move
                if lack <= 0:
                    break
                along = block @ (block.T @ worst[0])
                move += (lack + rounding) * along / (worst[0] @ along)
            else:
                raise NotAdmissible("no one motion frees a corner of the contact")
            shift[node] = move
        corners = len(self.mesh.points)
        shift[corners:] = shift[self.mesh.edges].mean(1)
        # A middle of the boundary may lie where the ends' motion is not allowed: rollers and fixed parts are straight,
        # and their ends move along them.
        self.u -= shift.ravel()
        if self.gap.excess(self.trace())[0].max() > 1e-9 * scale:
            raise NotAdmissible("v_n > g after all")

    # The energy.

    def lifts(self):
        """u_D minus its quadratic interpolation, on the fixed edges where that is not nothing."""
        for condition, edges, normals in self.parts("fixed"):
            lift = Lift(self, self.problem.fixed(condition), edges, normals)
            off = lift.on_edges(np.arange(len(edges)), np.broadcast_to(np.linspace(0, 1, 33), (len(edges), 33)))
            if np.abs(off).max() > 1e-13 * np.abs(self.given).max():
                yield lift

    def slope(self, t, l):
        """∂u_c/∂x_j of the quadratic displacement (n, p, c, j)."""
        u = self.u.reshape(-1, self.d)[self.elements[t]][:, None]
        l = l[..., None]
        out = 0
        for k in range(3):
            i, j = (k + 1) % 3, (k + 2) % 3
            by_lambda = ((4 * l[:, :, k] - 1) * u[:, :, k] + 4 * l[:, :, i] * u[:, :, 3 + j] +
                         4 * l[:, :, j] * u[:, :, 3 + i])
            out = out + by_lambda[..., None] * self.gradients[t][:, None, k, None]
        return out

    def integrand(self):
        lifts = list(self.lifts())

        def energy(t, l):
            x = self.points(t, l)
            values = shapes(l) @ self.u.reshape(-1, self.d)[self.elements[t]]
            slope = self.slope(t, l)
            for lift in lifts:
                lift.add(t, l, values, slope)
            strain = slope[:, :, 0] if self.d == 1 else np.stack(
                [slope[:, :, 0, 0], slope[:, :, 1, 1], slope[:, :, 0, 1] + slope[:, :, 1, 0]], -1)
            stress = (self.problem.hooke(x) @ strain[..., None])[..., 0]
            return (stress * strain).sum(-1) / 2 - (self.problem.loads(x) * values).sum(-1)

        return energy

    def energy(self):
        """J(v) and how wrong its integrals may be."""
        work = abs(self.f @ self.u) + self.u @ (self.k @ self.u)
        tolerance = 3e-7 * max(work, 1e-300)
        start = max(0, int(np.ceil(np.log(4000 / len(self.areas)) / np.log(4))))
        total, error = quadrature.over_triangles(self.integrand(), self.areas, tolerance, start)
        u = self.u.reshape(-1, self.d)
        for condition, edges, normals in self.parts("traction"):
            traction = self.problem.traction(condition)
            if not traction:
                continue
            lengths = np.hypot(*(self.nodes[edges[:, 1]] - self.nodes[edges[:, 0]]).T)

            def power(numbers, s):
                x = self.along(edges[numbers], s)
                t = traction(x, np.broadcast_to(normals[numbers][:, None], x.shape))
                v = np.einsum("npk,nkc->npc", edge_shapes(s), u[edges[numbers]])
                return np.einsum("npc,npc->np", t, v)

            share, wrong = quadrature.over_edges(power, lengths, tolerance, 5)
            total, error = total - share, error + wrong
        return total, error + 1e-12 * work + 1e-10 * self.natural_energy()

    def natural_energy(self):
        """Stiffness · displacement²: next to it, the energy of a body that only moves is rounding."""
        return self.k.diagonal().max() * np.abs(self.u).max() ** 2


class Lift:
    """(λ_a + λ_b) δ(λ_b / (λ_a + λ_b)) in the triangle of each edge ab: δ = u_D − its interpolation on ab, and 0 on
    the two other edges."""

    def __init__(self, primal, value, edges, normals):
        self.primal, self.value, self.edges, self.normals = primal, value, edges, normals
        mesh = primal.mesh
        self.edge_of = np.full((3, len(mesh.triangles)), -1)  # by the corner opposite to it
        for row, edge in enumerate(edges[:, 2] - len(mesh.points)):
            t, k = mesh.owner[edge]
            self.edge_of[k, t] = row

    def on_edges(self, rows, s):
        edges, normals = self.edges[rows], self.normals[rows]
        n = np.broadcast_to(normals[:, None], s.shape + (2,))
        nodes = self.primal.given.reshape(-1, self.primal.d)[edges]
        return self.value(self.primal.along(edges, s), n) - edge_shapes(s) @ nodes

    def add(self, t, l, values, slope):
        for k in range(3):
            cells = np.flatnonzero(self.edge_of[k, t] >= 0)
            if not len(cells):
                continue
            triangles, rows = t[cells], self.edge_of[k, t[cells]]
            begins_first = self.primal.mesh.triangles[triangles, (k + 1) % 3] == self.edges[rows, 0]
            a = np.where(begins_first, (k + 1) % 3, (k + 2) % 3)
            b = np.where(begins_first, (k + 2) % 3, (k + 1) % 3)
            la = np.take_along_axis(l[cells], a[:, None, None], 2)[..., 0]
            lb = np.take_along_axis(l[cells], b[:, None, None], 2)[..., 0]
            ga, gb = self.primal.gradients[triangles, a][:, None], self.primal.gradients[triangles, b][:, None]
            r = la + lb
            s = lb / r
            ahead, behind = np.minimum(s + 1e-5, 1), np.maximum(s - 1e-5, 0)
            change = (self.on_edges(rows, ahead) - self.on_edges(rows, behind)) / (ahead - behind)[..., None]
            delta = self.on_edges(rows, s)
            along = (la[..., None] * gb - lb[..., None] * ga) / r[..., None]  # r ∇s
            values[cells] += r[..., None] * delta
            slope[cells] += delta[..., None] * (ga + gb)[:, :, None] + change[..., None] * along[:, :, None]


def least_distance(matrix, right, conditions, level):
    """min ½ zᵀ S z − bᵀ z over A z ≤ g, as Lawson and Hanson's least distance problem: z and the multipliers."""
    factor = scipy.linalg.cholesky(matrix, lower=True)
    half = scipy.linalg.solve_triangular(factor, right, lower=True)
    a = scipy.linalg.solve_triangular(factor, conditions.T, lower=True)  # A L⁻ᵀ, transposed
    lack = level - a.T @ half  # A L⁻ᵀ y ≤ lack, for y the step from the free minimum
    norms = np.linalg.norm(a, axis=0)
    a, lack = a / norms, lack / norms
    y, forces = np.zeros(len(right)), np.zeros(len(lack))
    if lack.min() < 0:
        size = -lack.min()
        system = np.vstack([-a, -lack / size])
        target = np.zeros(len(system))
        target[-1] = 1
        weights, _ = nnls(system, target, maxiter=200 * system.shape[1])
        residual = system @ weights - target
        y = -size * residual[:-1] / residual[-1]
        forces = -size * weights / residual[-1] / norms
    return scipy.linalg.solve_triangular(factor, half + y, lower=True, trans="T"), forces


class Ladder:
    """J(v) and the error of its integrals on a mesh and its refinements."""

    def __init__(self, document, daemon, triangles=400):
        self.document, self.meshes, self.energies = document, [mesh_for(document, daemon, triangles)], []

    def level(self, k):
        while len(self.energies) <= k:
            if len(self.meshes) == len(self.energies):
                self.meshes.append(self.meshes[-1].refined())
            self.found = Primal(self.document, self.meshes[-1]).minimize()
            self.energies.append(self.found.energy())
        return self.energies[k]

    def likely_least(self, k):
        """Below the minimum, if refining once more takes at least a quarter off the error of the energy."""
        (coarse, off), (fine, wrong) = self.level(k - 1), self.level(k)
        return fine - 3 * max(coarse - fine, 0) - off - wrong
