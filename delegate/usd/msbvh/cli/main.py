"""The command line. usdrecord's names and rules where it has them; exit codes in main()."""

from __future__ import annotations

import os
import sys
import traceback
from collections.abc import Sequence

import click

from .. import _core
from ..base import signals
from ..base.atomic import OutputClash, OutputError
from ..base.errors import SceneError
from ..base.exit_codes import DEFECT, DONE, USAGE, WRONG, table_text
from ..base.reporter import Reporter
from ..base.software import software

COMMANDS = ("accuracy", "bench", "conform", "hydra-info", "motion", "plan", "record", "reshutter", "verify")


def load(arguments: Sequence[str]) -> None:
    """Imports what the named command needs, and no other's."""
    if arguments:
        _command(arguments[0])


def _command(name: str) -> click.Command | None:
    """Imported where it is asked for: what another command needs would double the time to start."""
    match name:
        case "accuracy":
            from .accuracy_command import accuracy_command

            return accuracy_command
        case "bench":
            from .bench_command import bench_command

            return bench_command
        case "conform":
            from .conform_command import conform_command

            return conform_command
        case "hydra-info":
            from .hydra_info_command import hydra_info_command

            return hydra_info_command
        case "motion":
            from .motion_command import motion_command

            return motion_command
        case "plan":
            from .plan_command import plan_command

            return plan_command
        case "record":
            from .record_command import record_command

            return record_command
        case "reshutter":
            from .reshutter_command import reshutter_command

            return reshutter_command
        case "verify":
            from .verify_command import verify_command

            return verify_command
        case _:
            return None


class Commands(click.Group):
    """Each is a module of its own."""

    def list_commands(self, _ctx: click.Context) -> list[str]:
        return list(COMMANDS)

    def get_command(self, _ctx: click.Context, name: str) -> click.Command | None:
        return _command(name)


def main(arguments: Sequence[str]) -> int:
    """Runs a command; returns the exit code (exit_codes.py). Whatever goes wrong is one line on stderr, never a
    traceback."""
    try:
        return commands.main(list(arguments), "msbvh", standalone_mode=False, obj=tuple(arguments)) or DONE
    except click.exceptions.NoArgsIsHelpError as error:
        print(error.format_message(), file=sys.stderr)
        return USAGE
    except click.ClickException as error:
        Reporter.error(error.format_message())
        return error.exit_code
    except OutputClash as error:
        Reporter.error(str(error))
        return USAGE
    except (SceneError, OutputError, _core.Error) as error:
        Reporter.error(str(error))
        return WRONG
    except (KeyboardInterrupt, click.Abort):
        signals.announce()
        return signals.exit_code()
    except MemoryError:
        Reporter.error("out of memory")
        return WRONG
    except OSError as error:  # The machine's fault: no descriptors left, a file that cannot be read.
        Reporter.error(f"{error.filename}: {error.strerror}" if error.filename else str(error))
        return WRONG
    except Exception as error:
        return _defect(error)


def _defect(error: Exception) -> int:
    """Of ours, or of a library."""
    if os.environ.get("MSBVH_TRACEBACK"):
        traceback.print_exception(error)
    Reporter.error(
        f"internal error: {type(error).__name__}: {error}. This is a defect of {software()}: please report it to the"
        " issue tracker of the hdMsbvh repository, with this command, its scene, and what it prints with"
        " MSBVH_TRACEBACK=1 in the environment"
    )
    return DEFECT


@click.group(cls=Commands, context_settings={"help_option_names": ["-h", "--help"]}, epilog=table_text())
@click.version_option(software(), message="%(version)s")
def commands() -> None:
    """Motion-blurred frames from USD on the CPU."""
