"""python3 -m signorini figures DIRECTORY: the figures of the paper."""

from __future__ import annotations

import argparse
import sys
from typing import TYPE_CHECKING

from .client import Client
from .errors import SignoriniError
from .export import package
from .local import Local

if TYPE_CHECKING:
    from .figures import CanSolve


def main() -> int:
    """0 when all is done, 1 if something went wrong."""
    parser = argparse.ArgumentParser(prog="python3 -m signorini", description="A client of Signorini.")
    commands = parser.add_subparsers(dest="command", required=True)
    figures = commands.add_parser("figures", help="write Figures 6.1 to 6.4 of the paper as SVG")
    figures.add_argument("directory", help="where they are written")
    where = figures.add_mutually_exclusive_group()
    where.add_argument("--service", help="address of the service; default as that of Client")
    where.add_argument("--program", help="path of signorinid, to solve without a service")
    options = parser.parse_args()
    try:
        if options.program:
            return _write_figures(Local(options.program), options.directory)
        return _write_figures(Client(options.service), options.directory)
    except SignoriniError as error:
        print(f"signorini: {error}", file=sys.stderr)
        return 1


def _write_figures(service: CanSolve, directory: str) -> int:
    package("matplotlib", "figures")
    from .figures import write_figures  # which takes NumPy, as matplotlib does

    for path in write_figures(service, directory):
        print(path)
    return 0


if __name__ == "__main__":
    sys.exit(main())
