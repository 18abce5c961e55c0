"""A client of Signorini, which solves contact problems without friction with a guaranteed error bound.

    from signorini import Client
    client = Client("http://127.0.0.1:8080")
    client.solve(client.example("elastic-block")).plot("von_mises", deformed=5)
"""

from .async_client import AsyncClient
from .boundary import Contact, Fixed, Roller, Traction
from .client import Client
from .domain import Arc, Circle, CircularHole, Gmsh, GivenMesh, Polygon, Rectangle, Vertex
from .errors import (
    BadReply,
    Fault,
    NotInResult,
    PackageMissing,
    Refused,
    ResultsDropped,
    ServiceUnreachable,
    SignoriniError,
    SolveFailed,
)
from .local import Local
from .material import HookeTensor, MembraneMaterial, YoungPoisson
from .mesh_request import Adaptive, LocalSize, MeshRequest
from .problem import Load, Problem, Solver, Variation
from .quantity import Disc, MeanDisplacement, Opening, PressureForce, SupportReaction, Weight
from .result import Result
from .study import Exact, Study
from .summary import EnclosedQuantity, Estimate, Summary

__all__ = [
    "Adaptive",
    "Arc",
    "AsyncClient",
    "BadReply",
    "Circle",
    "CircularHole",
    "Client",
    "Contact",
    "Disc",
    "EnclosedQuantity",
    "Estimate",
    "Exact",
    "Fault",
    "Fixed",
    "GivenMesh",
    "Gmsh",
    "HookeTensor",
    "Load",
    "Local",
    "LocalSize",
    "MeanDisplacement",
    "MembraneMaterial",
    "MeshRequest",
    "NotInResult",
    "PackageMissing",
    "Polygon",
    "Opening",
    "PressureForce",
    "Problem",
    "Rectangle",
    "Refused",
    "Result",
    "ResultsDropped",
    "Roller",
    "ServiceUnreachable",
    "SignoriniError",
    "SolveFailed",
    "Solver",
    "Study",
    "Summary",
    "SupportReaction",
    "Traction",
    "Variation",
    "Vertex",
    "Weight",
    "YoungPoisson",
]
