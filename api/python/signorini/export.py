"""Results for other packages: PyVista, meshio and pandas."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from .errors import NotInResult, PackageMissing

if TYPE_CHECKING:
    import meshio
    import pandas
    import pyvista

    from .result import Result

_VTK_TRIANGLE = 5


def package(name: str, purpose: str) -> Any:
    """The package of this name. Raises PackageMissing, which says what it is wanted for."""
    try:
        return importlib.import_module(name)
    except ImportError as error:
        distribution = name.split(".")[0]
        raise PackageMissing(f"{purpose} takes {distribution}, which is not installed") from error


def to_pyvista(result: Result) -> pyvista.UnstructuredGrid:
    """The triangles in the plane z = 0 as `pyvista.UnstructuredGrid`, with the fields that the result has.

    Point data: `displacement`, continuous; (n,) or, with z = 0, (n, 3). Cell data: `stress`, `principal`, `von_mises`.
    Raises PackageMissing, NotInResult without a mesh.
    """
    pyvista = package("pyvista", "to_pyvista()")
    numpy = package("numpy", "to_pyvista()")
    triangles = result.mesh.triangles
    cells = numpy.insert(triangles, 0, 3, axis=1).ravel()
    kinds = numpy.full(len(triangles), _VTK_TRIANGLE, "uint8")
    grid = pyvista.UnstructuredGrid(cells, kinds, _in_space(result.mesh.points))
    for name, values in _point_data(result).items():
        grid.point_data[name] = values
    for name, values in _cell_data(result).items():
        grid.cell_data[name] = values
    return grid


def to_meshio(result: Result) -> meshio.Mesh:
    """The triangles in the plane z = 0 as `meshio.Mesh`, with the same fields as `to_pyvista`.

    Raises PackageMissing, NotInResult without a mesh.
    """
    meshio = package("meshio", "to_meshio()")
    return meshio.Mesh(
        _in_space(result.mesh.points),
        [("triangle", result.mesh.triangles)],
        point_data=_point_data(result),
        cell_data={name: [values] for name, values in _cell_data(result).items()},
    )


def to_pandas(result: Result, table: str) -> pandas.DataFrame:
    """A table as `pandas.DataFrame`.

    `contact` has the columns part, x, y, clearance, pressure, gap, open; `history` a row an iteration; `study` a row a
    mesh and scheme. Raises PackageMissing, NotInResult, and ValueError for another name.
    """
    pandas = package("pandas", "to_pandas()")
    if table == "contact":
        if not result.contact:
            raise NotInResult("this result has no contact: its problem has no such part")
        frames = [_frame_of_part(pandas, name, part) for name, part in result.contact.items()]
        return pandas.concat(frames, ignore_index=True)
    if table == "history":
        return pandas.DataFrame({name: column for name, column in vars(result.history).items() if column is not None})
    if table == "study":
        return pandas.DataFrame(list(result.study.rows))
    raise ValueError(f"there is no table {table!r}; there are contact, history and study")


def _frame_of_part(pandas: Any, name: str, part: Any) -> Any:
    columns = {"part": name, "x": part.points[:, 0], "y": part.points[:, 1]}
    return pandas.DataFrame(columns | {key: getattr(part, key) for key in ("clearance", "pressure", "gap", "open")})


def _in_space(vectors: Any) -> Any:
    return package("numpy", "an export").pad(vectors, ((0, 0), (0, 1)))


def _point_data(result: Result) -> dict[str, Any]:
    try:
        values = result.displacement.at_points
    except NotInResult:
        return {}
    return {"displacement": values if values.ndim == 1 else _in_space(values)}


def _cell_data(result: Result) -> dict[str, Any]:
    found = {}
    for name in ("stress", "principal", "von_mises"):
        try:
            values = getattr(result, name)
        except NotInResult:
            continue
        found[name] = values.at_centroids if name == "stress" else values
    return found
