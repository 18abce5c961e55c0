"""What a solve found out."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from . import export
from .arrays import Reals
from .document import read
from .errors import NotInResult, SolveFailed
from .fields import ContactPart, DisplacementField, History, LevelFields, Mesh, StressField
from .plot import plot
from .summary import EnclosedQuantity, StudyTable, Summary, SweepEntry

if TYPE_CHECKING:
    import matplotlib.axes
    import meshio
    import pandas
    import pyvista


class Result:
    """What a solve found out; a member that was not asked for, or that there is not, raises NotInResult.

    `document` is the whole document of the service, in which members stand that have no name here.
    """

    def __init__(self, document: Mapping[str, Any]) -> None:
        self.document = document

    def __repr__(self) -> str:
        return f"<Result {self.id or 'of the command line'} {self.status}: {', '.join(self.document)}>"

    @property
    def id(self) -> str:
        """The name of the solve on its service; empty from the command line."""
        return str(self.document.get("id", ""))

    @property
    def status(self) -> str:
        """`succeeded`, `failed` or `cancelled`."""
        return str(self.document.get("status"))

    @property
    def error(self) -> str | None:
        """Why it did not succeed and what to try, or None."""
        if self.status == "succeeded":
            return None
        rows = [*_list(self.document.get("sweep")), *_list(_dict(self.document.get("study")).get("rows"))]
        of_rows = next((row["error"] for row in map(_dict, rows) if "error" in row), None)
        of_all = _dict(self.document.get("error")).get("detail") or _dict(self.document.get("summary")).get("advice")
        return str(of_all or of_rows or self.status)

    def check(self) -> Result:
        """This result. Raises SolveFailed if the solve did not succeed."""
        if self.status != "succeeded":
            raise SolveFailed(self)
        return self

    @property
    def problem(self) -> dict[str, Any]:
        """The problem as it was posted, a document."""
        return dict(_dict(self._member("problem")))

    @property
    def summary(self) -> Summary:
        """The figures of the solve."""
        summary: Summary = read(Summary, self._member("summary"))
        return summary

    @property
    def mesh(self) -> Mesh:
        """The mesh that was used."""
        mesh: Mesh = read(Mesh, self._member("mesh"))
        return mesh

    @property
    def displacement(self) -> DisplacementField:
        """u_h."""
        field: DisplacementField = read(DisplacementField, self._member("displacement"))
        return field

    @property
    def stress(self) -> StressField:
        """σ_h."""
        field: StressField = read(StressField, self._member("stress"))
        return field

    @property
    def principal(self) -> Reals:
        """(m, 2), the principal stresses at the centroids of an elastic body, the larger first; force per area."""
        return self._reals("principal")

    @property
    def von_mises(self) -> Reals:
        """(m,), von Mises' stress at the centroids of an elastic body, force per area."""
        return self._reals("von_mises")

    @property
    def error_squares(self) -> Reals:
        """(m,), what each triangle adds to the square of the error bound, energy per thickness; if there is a bound."""
        return self._reals("error_squares")

    @property
    def levels(self) -> tuple[LevelFields, ...]:
        """The levels of an adaptive mesh, but the one whose fields the others are; if they were asked for."""
        levels: tuple[LevelFields, ...] = read(tuple[LevelFields, ...], self._member("levels"))
        return levels

    @property
    def quantities(self) -> tuple[EnclosedQuantity, ...]:
        """What the problem asks for, in its order."""
        quantities: tuple[EnclosedQuantity, ...] = read(tuple[EnclosedQuantity, ...], self._member("quantities"))
        return quantities

    @property
    def contact(self) -> dict[str, ContactPart]:
        """The contact boundary, by part."""
        parts: dict[str, ContactPart] = read(dict[str, ContactPart], self._member("contact"))
        return parts

    @property
    def history(self) -> History:
        """The residuals of each iteration."""
        history: History = read(History, self._member("history"))
        return history

    @property
    def sweep(self) -> tuple[SweepEntry, ...]:
        """The entries of a sweep."""
        entries: tuple[SweepEntry, ...] = read(tuple[SweepEntry, ...], self._member("sweep"))
        return entries

    @property
    def study(self) -> StudyTable:
        """The table of a study."""
        table: StudyTable = read(StudyTable, self._member("study"))
        return table

    def plot(
        self, field: str = "displacement", *, deformed: float = 0.0, axes: matplotlib.axes.Axes | None = None
    ) -> matplotlib.axes.Axes:
        """Draws a field with matplotlib; see the function `plot.plot`."""
        return plot(self, field, deformed=deformed, axes=axes)

    def to_pyvista(self) -> pyvista.UnstructuredGrid:
        """The mesh with its fields for PyVista; see `export.to_pyvista`."""
        return export.to_pyvista(self)

    def to_meshio(self) -> meshio.Mesh:
        """The mesh with its fields for meshio; see `export.to_meshio`."""
        return export.to_meshio(self)

    def to_pandas(self, table: str) -> pandas.DataFrame:
        """The table `contact`, `history` or `study`; see `export.to_pandas`."""
        return export.to_pandas(self, table)

    def _member(self, name: str) -> Any:
        if self.document.get(name) is None:
            raise NotInResult(f"this result has no {name}; it has {', '.join(self.document)}")
        return self.document[name]

    def _reals(self, name: str) -> Reals:
        numbers: Reals = read(Reals, self._member(name))
        return numbers


def _dict(value: Any) -> Mapping[str, Any]:
    return value if isinstance(value, Mapping) else {}


def _list(value: Any) -> Sequence[Any]:
    return value if isinstance(value, list) else []
