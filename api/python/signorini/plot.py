"""Pictures of results, by matplotlib."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from .errors import NotInResult
from .export import package

if TYPE_CHECKING:
    import matplotlib.axes

    from .fields import ContactPart, History
    from .result import Result

_LABELS = {"von_mises": "von Mises stress"}
_MOST_SHAPES = 20_000  # of a drawing; what has more triangles is drawn as an image
_COMPONENTS = {2: ("x", "y"), 3: ("xx", "yy", "xy")}


def plot(
    result: Result, field: str = "displacement", *, deformed: float = 0.0, axes: matplotlib.axes.Axes | None = None
) -> matplotlib.axes.Axes:
    """Draws a field on the body, or curves, and returns the axes.

    `field` is `displacement` (of an elastic body its length), `stress` (its norm), a component of it (`stress_x`,
    `stress_y` of a membrane, `stress_xx`, `stress_yy`, `stress_xy` of an elastic body), `von_mises`, or one of the
    curves `contact` (pressure and clearance along each part) and `history` (the residuals). `deformed` times the
    displacement is added to the points of an elastic body. Stresses have one colour in each triangle. Without `axes`
    new ones are made. Raises ValueError for another field, PackageMissing without matplotlib or NumPy, NotInResult.
    """
    pyplot = package("matplotlib.pyplot", "plot()")
    numpy = package("numpy", "plot()")
    # What there is to draw is found before axes are made, so that none are left empty.
    draw = _drawing(numpy, result, field, deformed)
    if axes is None:
        axes = pyplot.subplots()[1]
    draw(axes)
    return axes


def _drawing(numpy: Any, result: Result, field: str, deformed: float) -> Callable[[Any], None]:
    """What draws the field on axes. Raises ValueError, NotInResult."""
    if field == "contact":
        parts = result.contact
        if not parts:
            raise NotInResult("this result has no contact: its problem has no such part")
        return lambda axes: _draw_contact(numpy, parts, axes)
    if field == "history":
        history, curves = result.history, _curves(result.history)
        if not curves:
            raise NotInResult("this result has no history to draw: no iteration left a residual above 0")
        return lambda axes: _draw_history(history, curves, axes)
    values, points, triangles = _values(numpy, result, field), _points(result, deformed), result.mesh.triangles
    return lambda axes: _draw_on_body(field, values, points, triangles, axes)


def _values(numpy: Any, result: Result, field: str) -> Any:
    """A value a point, or one a triangle."""
    if field == "displacement":
        values = result.displacement.at_points
        return values if values.ndim == 1 else numpy.linalg.norm(values, axis=1)
    if field == "von_mises":
        return result.von_mises
    name, _, component = field.partition("_")
    if name == "stress":
        stress = result.stress.at_centroids
        components = _COMPONENTS[stress.shape[1]]
        if not component:
            return numpy.sqrt((stress**2).sum(axis=1) + (stress[:, 2] ** 2 if len(components) == 3 else 0))
        if component in components:
            return stress[:, components.index(component)]
    raise ValueError(
        f"there is no field {field!r}; there are displacement, stress, stress_x, stress_y of a membrane, stress_xx, "
        "stress_yy, stress_xy of an elastic body, von_mises, contact and history"
    )


def _points(result: Result, deformed: float) -> Any:
    """Those of the mesh, moved by so many times the displacement of an elastic body."""
    points = result.mesh.points
    if deformed and result.displacement.at_points.ndim == 2:
        points = points + deformed * result.displacement.at_points
    return points


def _draw_on_body(field: str, values: Any, points: Any, triangles: Any, axes: Any) -> None:
    how = {"shading": "gouraud"} if field == "displacement" else {"shading": "flat", "facecolors": values}
    arguments = [values] if field == "displacement" else []
    drawn = axes.tripcolor(*points.T, triangles, *arguments, rasterized=len(triangles) > _MOST_SHAPES, **how)
    axes.set(aspect="equal", xlabel="x", ylabel="y")
    beside = package("mpl_toolkits.axes_grid1", "plot()").make_axes_locatable(axes).append_axes("right", "4%", pad=0.1)
    axes.figure.colorbar(drawn, cax=beside, label=_LABELS.get(field, field.replace("_", " ")))


def _draw_contact(numpy: Any, parts: Mapping[str, ContactPart], axes: Any) -> None:
    """Pressures to the left, clearances to the right, by the way along each part."""
    right = axes.twinx()
    for name, part in parts.items():
        steps = numpy.linalg.norm(numpy.diff(part.points, axis=0), axis=1)
        way = numpy.concatenate([[0.0], numpy.cumsum(steps)])
        line = axes.plot(way, part.pressure, label=f"{name}: pressure")[0]
        right.plot(way, part.clearance, "--", color=line.get_color(), label=f"{name}: clearance")
    axes.set(xlabel="way along the part", ylabel="pressure")
    right.set_ylabel("clearance")
    drawn, others = axes.get_legend_handles_labels(), right.get_legend_handles_labels()
    axes.legend(drawn[0] + others[0], drawn[1] + others[1], loc="upper right")


def _curves(history: History) -> dict[str, Any]:
    """The columns that a logarithmic axis shows."""
    names = ("displacement_change", "clearance_change", "equilibrium", "penetration", "tension", "complementarity")
    columns = {name: getattr(history, name) for name in names}
    return {name: column for name, column in columns.items() if column is not None and (column > 0).any()}


def _draw_history(history: History, curves: Mapping[str, Any], axes: Any) -> None:
    for name, column in curves.items():
        axes.semilogy(history.iteration, column, label=name.replace("_", " "))
    axes.set(xlabel="iteration", ylabel="relative residual")
    axes.legend()
