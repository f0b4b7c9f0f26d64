"""How a benchmark that reads what a user names tells that it cannot."""

from __future__ import annotations

import sys
from collections.abc import Callable

from threedfs.errors import UserError


def run_command(main: Callable[[], None]) -> None:
    """Run a benchmark; what it was given amiss is told in one sentence, and the exit status is 1."""
    try:
        main()
    except UserError as fault:
        sys.exit(f"{sys.argv[0]}: {fault}")
    except FileNotFoundError as fault:
        sys.exit(f"{sys.argv[0]}: expected {fault.filename}, found none; check what you named.")
