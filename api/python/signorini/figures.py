"""The figures of section 6 of the paper: its meshes, steps and iterations, drawn with matplotlib.

6.1 and 6.3 show the triangulations with the nodes of the two schemes; 6.2 and 6.4 the displacement u_h as a surface and
the clearance λ_h along the contact boundary. There u ≥ 0 and λ = u in the limit, for the gap is 0.
"""

from __future__ import annotations

import pathlib
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal, Protocol

import numpy

from .boundary import Contact, Fixed
from .domain import Rectangle
from .errors import SolveFailed
from .export import package
from .fields import Mesh
from .material import MembraneMaterial
from .mesh_request import MeshRequest
from .problem import Load, Problem, Solver
from .result import Result

_STRESS, _DISPLACEMENT, _CLEARANCE = "#1f6f8b", "#c0392b", "#e08e0b"
_LINES = "#8a8f98"
_SIZES = {"D": 5, "o": 8, "s": 13}  # of markers, points
#: Of an edge, where the two normal components of RT1 are drawn: the points of Gauss.
_GAUSS = (0.5 - 0.5 / 3**0.5, 0.5 + 0.5 / 3**0.5)


class CanSolve(Protocol):
    """A Client or Local."""

    def solve(self, problem: Problem) -> Result: ...


@dataclass(frozen=True)
class Experiment:
    """One of the two computations of section 6.

    The paper has the mesh, the step and the criterion 1e-5. It does not say where the iteration starts: these values
    reproduce its Table 6.1. It stopped the conforming one at iteration 200.
    """

    scheme: Literal["conforming", "nonconforming"]
    divisions: int
    rho: float
    initial_displacement: float
    max_iterations: int

    def problem(self) -> Problem:
        """The membrane of section 6."""
        return Problem(
            title=f"The paper, section 6, {self.scheme}",
            model="membrane",
            domain=Rectangle((0, 0), (1, 1)),
            mesh=MeshRequest(divisions=(self.divisions, self.divisions), pattern="right"),
            material=MembraneMaterial(1),
            load=Load("x < 0.5 ? 10 : -10"),
            boundary={"left": Fixed(), "right": Fixed(), "bottom": Contact(0), "top": Contact(0)},
            scheme=self.scheme,
            solver=Solver(
                method="uzawa",
                rho=self.rho,
                augmentation=1,
                initial_displacement=self.initial_displacement,
                tolerance=1e-5,
                max_iterations=self.max_iterations,
            ),
        )

    def solve(self, service: CanSolve) -> Result:
        """The iterate at which the paper ended, whether or not it meets the criterion."""
        try:
            return service.solve(self.problem())
        except SolveFailed as failed:
            return failed.result


CONFORMING = Experiment("conforming", 8, 0.05, 1.0, 200)
NONCONFORMING = Experiment("nonconforming", 14, 0.05, 0.5, 1000)


def write_figures(service: CanSolve, directory: str | pathlib.Path) -> list[pathlib.Path]:
    """Solves both experiments and writes figure-6.1.svg to figure-6.4.svg into the directory, which is made.

    Returns their paths. The same results make the same bytes. Raises PackageMissing without matplotlib, and what
    `solve` raises but SolveFailed.
    """
    directory = pathlib.Path(directory)
    conforming, nonconforming = CONFORMING.solve(service), NONCONFORMING.solve(service)
    directory.mkdir(parents=True, exist_ok=True)
    drawings: dict[str, Callable[[], Any]] = {
        "6.1": lambda: draw_nodes(conforming, CONFORMING),
        "6.2": lambda: draw_solution(conforming, CONFORMING),
        "6.3": lambda: draw_nodes(nonconforming, NONCONFORMING),
        "6.4": lambda: draw_solution(nonconforming, NONCONFORMING),
    }
    return [_save(draw(), directory / f"figure-{number}.svg") for number, draw in drawings.items()]


def _save(figure: Any, path: pathlib.Path) -> pathlib.Path:
    with package("matplotlib", "figures").rc_context({"svg.hashsalt": path.name}):
        figure.savefig(path, metadata={"Date": None})
    package("matplotlib.pyplot", "figures").close(figure)
    return path


def draw_nodes(result: Result, experiment: Experiment) -> Any:
    """The triangulation with the nodes of the clearance, and all nodes of one of its squares; a matplotlib figure."""
    figure, (whole, square) = package("matplotlib.pyplot", "figures").subplots(1, 2, figsize=(9, 4.6))
    mesh = result.mesh
    whole.triplot(*mesh.points.T, mesh.triangles, color=_LINES, linewidth=0.8)
    for part in result.contact.values():
        whole.plot(*part.points.T, "s", color=_CLEARANCE, markersize=4, clip_on=False)
    whole.set_title(f"{experiment.divisions}×{experiment.divisions}, {len(mesh.triangles)} triangles")

    # The two triangles of the square at the top left, where the contact is above.
    side = 1.0 / experiment.divisions
    corners = mesh.points[mesh.triangles]
    inside = (corners[:, :, 0] < 1.5 * side).all(axis=1) & (corners[:, :, 1] > 1 - 1.5 * side).all(axis=1)
    nodes = _nodes(corners[inside], mesh, result, experiment.scheme)
    for triangle in corners[inside]:
        square.fill(*triangle.T, facecolor="none", edgecolor=_LINES, linewidth=1)
    for label, marker, colour, points in nodes:
        filling = "none" if marker == "s" else colour  # what lies at the same place is seen through it
        square.plot(
            *points.T, marker, color=colour, markerfacecolor=filling, markersize=_SIZES[marker], markeredgewidth=2,
            label=label, linestyle="none", clip_on=False,
        )  # fmt: skip
    square.set_title("the nodes of one square")
    square.legend(loc="upper center", bbox_to_anchor=(0.5, -0.02), ncol=3, frameon=False)
    for axes in (whole, square):
        axes.set_aspect("equal")
        axes.axis("off")
    figure.tight_layout()
    return figure


def _nodes(corners: Any, mesh: Mesh, result: Result, scheme: str) -> list[tuple[str, str, str, Any]]:
    """Label, marker, colour and points (k, 2) of the nodes of stress, displacement and clearance on these triangles."""
    centroids = corners.mean(axis=1)
    ends = corners[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2, 2)
    places = _GAUSS if scheme == "conforming" else (0.5,)
    stress = [(1 - place) * ends[:, 0] + place * ends[:, 1] for place in places]
    displacement = centroids
    if scheme == "conforming":
        stress.append(centroids)
        displacement = (0.78 * corners + 0.22 * centroids[:, None]).reshape(-1, 2)
    top = result.contact["top"].points
    return [
        ("stress", "D", _STRESS, numpy.concatenate(stress)),
        ("displacement", "o", _DISPLACEMENT, displacement),
        ("clearance", "s", _CLEARANCE, top[top[:, 0] <= corners[:, :, 0].max() + 1e-9]),
    ]


def draw_solution(result: Result, experiment: Experiment) -> Any:
    """u_h as a surface with λ_h along the contact boundary, and λ_h on y = 1 beside u_h; a matplotlib figure."""
    figure = package("matplotlib.pyplot", "figures").figure(figsize=(11, 4.8))
    figure.suptitle(
        f"{experiment.scheme}, {experiment.divisions}×{experiment.divisions}, ρ = {experiment.rho:g}, "
        f"{result.summary.iterations} iteration{'' if result.summary.iterations == 1 else 's'}"
    )
    _draw_surface(figure.add_subplot(1, 2, 1, projection="3d"), result)
    _draw_along_contact(figure.add_subplot(1, 2, 2), result)
    figure.tight_layout()
    return figure


def _heights(result: Result) -> Any:
    """(m, 3), u_h in the corners of each triangle."""
    values = result.displacement.values
    return values if values.ndim == 2 else numpy.repeat(values[:, None], 3, axis=1)


def _draw_surface(axes: Any, result: Result) -> None:
    """u_h as it is where it is linear in each triangle, its continuous reconstruction where it is constant."""
    art3d = package("mpl_toolkits.mplot3d.art3d", "figures")
    colours = package("matplotlib.cm", "figures").viridis
    mesh, heights = result.mesh, _heights(result)
    if result.displacement.space == "P0":
        heights = result.displacement.at_points[mesh.triangles]
    patches = numpy.concatenate([mesh.points[mesh.triangles], heights[:, :, None]], axis=2)
    means = heights.mean(axis=1)
    shades = colours((means - means.min()) / (means.max() - means.min()))
    axes.add_collection3d(art3d.Poly3DCollection(patches, facecolors=shades, edgecolors="#00000055", linewidths=0.4))
    for name, part in result.contact.items():
        label = r"$\lambda_h$" if name == "top" else None
        axes.plot(*part.points.T, part.clearance, color=_CLEARANCE, linewidth=2.5, label=label, zorder=10)
    axes.set(xlim=(0, 1), ylim=(0, 1), zlim=(heights.min(), heights.max()), xlabel="x", ylabel="y", zlabel="$u_h$")
    axes.set_box_aspect((1, 1, 0.7), zoom=0.9)
    axes.view_init(elev=28, azim=-62)
    axes.legend(loc="upper right")


def _draw_along_contact(axes: Any, result: Result) -> None:
    top = result.contact["top"]
    ends, heights = _top_edges(result.mesh, _heights(result))
    for i, (x, height) in enumerate(zip(ends, heights)):
        axes.plot(x, height, color=_DISPLACEMENT, linewidth=1.2, label="$u_h$ on y = 1" if i == 0 else None)
    axes.plot(top.points[:, 0], top.clearance, "s-", color=_CLEARANCE, markersize=5, label=r"$\lambda_h$ on y = 1")
    axes.set(xlim=(0, 1), xlabel="x")
    axes.grid(alpha=0.3)
    axes.legend()


def _top_edges(mesh: Mesh, heights: Any) -> tuple[Any, Any]:
    """Of the edges on y = 1, x and u_h at both ends; both (k, 2)."""
    on_top = {tuple(sorted(edge)) for edge in mesh.boundary["top"].tolist()}
    found = []
    for triangle, height in zip(mesh.triangles.tolist(), heights):
        for i, j in ((0, 1), (1, 2), (2, 0)):
            if tuple(sorted((triangle[i], triangle[j]))) in on_top:
                found.append(([mesh.points[triangle[i], 0], mesh.points[triangle[j], 0]], [height[i], height[j]]))
    return numpy.array([x for x, _ in found]), numpy.array([height for _, height in found])
