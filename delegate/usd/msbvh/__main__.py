"""`python -m msbvh` and the console script."""

from __future__ import annotations

import sys


def main() -> int:
    """Returns the exit code. An interrupt while modules still load ends as quietly as a later one."""
    try:
        from .cli import main as run

        return run(sys.argv[1:])
    except ImportError as error:  # A broken installation, before cli can say so.
        print(f"msbvh: error: the installation is incomplete (make setup mends it): {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("msbvh: error: interrupted", file=sys.stderr)
        return 130


if __name__ == "__main__":
    sys.exit(main())
