"""`python -m msbvh` and the console script: what has to be in place before modules are loaded."""

from __future__ import annotations

import os
import sys

try:
    from .base import signals, streams
    from .base.exit_codes import DONE, WRONG
except KeyboardInterrupt:  # Some milliseconds in which nobody listens yet. Before them Python itself starts.
    os.write(2, b"msbvh: error: interrupted\n")
    os._exit(130)


def main() -> int:
    """Returns the exit code. Whatever a run leaves behind is in order by then."""
    signals.listen()
    streams.guard()
    _use_utf8()
    code = _run()
    failure = streams.settle()
    if failure and code == DONE:
        print(f"msbvh: error: {failure}", file=sys.stderr)
        return WRONG
    return code


def _run() -> int:
    try:
        from .cli.main import load
        from .cli.main import main as run

        load(sys.argv[1:])
    except (ImportError, OSError, MemoryError) as error:  # Before cli can say so.
        why = f"{type(error).__name__}: {error}" if str(error) else type(error).__name__
        print(f"msbvh: error: the installation cannot be loaded (make setup mends it): {why}", file=sys.stderr)
        return WRONG
    try:
        signals.loaded()
        return signals.finish(run(sys.argv[1:]))
    except KeyboardInterrupt:  # Between the command's end and finish().
        return signals.finish(DONE)


def _use_utf8() -> None:
    """Starts anew in Python's UTF-8 mode where the locale has another encoding: USD and OpenImageIO take names as
    UTF-8 in any locale."""
    if sys.getfilesystemencoding() != "utf-8" and not sys.flags.utf8_mode and sys.executable:
        os.environ["PYTHONUTF8"] = "1"  # For the processes of `conform` as well.
        os.execv(sys.executable, [sys.executable, "-X", "utf8", *sys.orig_argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
