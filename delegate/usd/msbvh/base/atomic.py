"""Files that appear under their final name complete or not at all.

A file is written under no name where the file system can do that (O_TMPFILE), else under a temporary one, flushed to
the disk, and renamed. A symbolic link is written through: the file that it points to is replaced, and the link stays.
Other names (hard links) of a replaced file keep what it had.
"""

from __future__ import annotations

import contextlib
import errno
import itertools
import os
import re
import stat
from pathlib import Path

from . import signals

CHUNK = 1 << 22
"""Bytes between two looks for signals."""

MAX_LINKS = 40
"""Linux follows no more."""

_count = itertools.count()


class OutputError(Exception):
    """A file cannot be written; str() is one line that names it and says why."""


class OutputClash(OutputError):
    """An output would overwrite what must stay; exit code 2."""


class Folders:
    """What is known of the folders that files go to: looked up once, however many frames there are."""

    def __init__(self) -> None:
        self._faults: dict[str, str] = {}
        self._real: dict[str, str] = {}
        self._name_limits: dict[str, int] = {}
        self._mounts: set[str] | None = None

    def target(self, path: Path) -> Path:
        """The file that is replaced: behind symbolic links, and with a real path, so that two are one file where
        theirs are equal. Raises OSError for a loop of links, and for /dev/stdout and its like: the file behind it
        may be anybody's log."""
        for _ in range(MAX_LINKS):
            if not path.is_symlink():
                break
            if os.path.realpath(path.parent).startswith("/proc/"):
                raise OSError(errno.EINVAL, "it is an open descriptor, not a regular file")
            path = Path(os.path.join(path.parent, os.readlink(path)))
        else:
            raise OSError(errno.ELOOP, os.strerror(errno.ELOOP))
        folder = str(path.parent)
        if folder not in self._real:
            self._real[folder] = os.path.realpath(folder)
        return Path(self._real[folder], path.name)

    def fault(self, folder: Path) -> str:
        """Why no file can be made in a folder; empty: one can."""
        key = str(folder)
        if key not in self._faults:
            self._faults[key] = _folder_fault(folder)
        return self._faults[key]

    def name_fault(self, path: Path) -> str:
        """Why a folder has no place for a file of this name, in a few words; empty: it has."""
        folder = str(path.parent)
        if folder not in self._name_limits:
            self._name_limits[folder] = os.pathconf(folder, "PC_NAME_MAX") if os.path.isdir(folder) else 0
        length, limit = len(os.fsencode(path.name)), self._name_limits[folder]
        if length <= limit:
            return ""
        if not limit:
            return f"there is no folder '{folder}'"
        return f"the name is {length} bytes long, at most {limit} are possible"

    def is_mount_point(self, path: Path) -> bool:
        """Of a single file, as containers have them."""
        if self._mounts is None:
            self._mounts = _mount_points()
        return str(path) in self._mounts


def check_writable(path: Path, folders: Folders | None = None) -> Path:
    """Raises OutputError where `path` could not be written: said before an hour of rendering, not after it.
    Returns the file that would be replaced."""
    folders = folders or Folders()
    target = path
    try:
        fault = folders.name_fault(path)
        if not fault:
            with contextlib.suppress(FileNotFoundError, NotADirectoryError):
                os.stat(path)  # Follows links as the kernel does, with its limits on loops and on foreign links.
            target = folders.target(path)
            fault = folders.fault(target.parent) or _file_fault(target, folders)
    except OSError as error:
        fault = error.strerror or str(error)
    if fault:
        raise OutputError(f"cannot write '{path}': {fault}")
    return target


def check_folder(path: Path) -> None:
    """Makes a folder for outputs. Raises OutputError where that, or a file in it, is impossible."""
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(f"cannot write '{path}': {error.strerror or error}") from None
    if fault := _folder_fault(path):
        raise OutputError(f"cannot write '{path}': {fault}")


def write_whole(path: Path, content: bytes | memoryview) -> None:
    """Writes a file, complete or not at all. Raises OutputError for what the operating system refuses."""
    try:
        target = Folders().target(path)
        folder = os.open(target.parent, os.O_PATH | os.O_DIRECTORY | os.O_CLOEXEC)
        try:
            _replace(folder, target.name, memoryview(content))
        finally:
            os.close(folder)
        _sync_folder(target.parent)
    except OSError as error:
        raise OutputError(f"cannot write '{path}': {error.strerror or error}") from error


def _replace(folder: int, name: str, content: memoryview) -> None:
    temporary = _temporary_name()

    def remove() -> None:
        with contextlib.suppress(OSError):
            os.unlink(temporary, dir_fd=folder)

    with signals.deferred(undo=remove):
        try:
            if not _write_unnamed(folder, temporary, name, content):
                _write_named(folder, temporary, name, content)
            os.rename(temporary, name, src_dir_fd=folder, dst_dir_fd=folder)
        finally:
            remove()


def _temporary_name() -> str:
    """Shorter than any limit on names, whatever the final one's length."""
    return f".msbvh-{os.getpid()}-{next(_count)}"


def _write_unnamed(folder: int, temporary: str, final: str, content: memoryview) -> bool:
    """Into a file that has no name before it is complete, so that not even SIGKILL leaves a part of it. False
    where the file system has no such files: NFS, FUSE."""
    try:
        file = os.open(".", os.O_WRONLY | os.O_CLOEXEC | os.O_TMPFILE, 0o666, dir_fd=folder)
    except OSError:
        return False
    try:
        _fill(file, folder, final, content)
        try:
            os.link(f"/proc/self/fd/{file}", temporary, dst_dir_fd=folder, follow_symlinks=True)
        except OSError:
            return False
    finally:
        os.close(file)
    return True


def _write_named(folder: int, temporary: str, final: str, content: memoryview) -> None:
    flags = os.O_WRONLY | os.O_CLOEXEC | os.O_CREAT | os.O_EXCL
    file = os.open(temporary, flags, 0o666, dir_fd=folder)
    try:
        _fill(file, folder, final, content)
    except BaseException:
        os.close(file)
        raise
    os.close(file)  # May fail: network file systems send what they hold only now.


def _fill(file: int, folder: int, final: str, content: memoryview) -> None:
    """With the permissions of the file that is replaced."""
    with contextlib.suppress(OSError):
        os.fchmod(file, stat.S_IMODE(os.stat(final, dir_fd=folder).st_mode))
    _write(file, content)


def _write(file: int, content: memoryview) -> None:
    done = 0
    while done < len(content):
        signals.stop_if_received()
        done += os.write(file, content[done : done + CHUNK])
    os.fsync(file)


def _sync_folder(folder: Path) -> None:
    """So that the name outlives a power cut too. Not each file system, nor each folder's permission, allows it."""
    with contextlib.suppress(OSError):
        descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)


def _folder_fault(folder: Path) -> str:
    """Tries it: no flag tells of quotas, read-only disks and network permissions alike."""
    if not os.path.isdir(folder):
        return f"there is no folder '{folder}'"
    try:
        descriptor = os.open(folder, os.O_PATH | os.O_DIRECTORY | os.O_CLOEXEC)
        try:
            _make_and_remove(descriptor)
        finally:
            os.close(descriptor)
    except PermissionError:
        return f"no permission to write in folder '{folder}'"
    except OSError as error:
        return f"no file can be made in folder '{folder}': {error.strerror}"
    return ""


def _make_and_remove(folder: int) -> None:
    name = _temporary_name()
    with signals.deferred():
        os.close(os.open(name, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, 0o600, dir_fd=folder))
        os.unlink(name, dir_fd=folder)


def _file_fault(target: Path, folders: Folders) -> str:
    """Why a file of this name cannot be made or replaced in a folder that can be written to."""
    if fault := folders.name_fault(target):
        return fault
    try:
        found = os.lstat(target)
    except FileNotFoundError:
        return ""
    if not stat.S_ISREG(found.st_mode):
        return "it is not a regular file"
    if not os.access(target, os.W_OK):
        return "it is write-protected"
    folder = os.stat(target.parent)
    if folder.st_mode & stat.S_ISVTX and os.geteuid() not in (0, found.st_uid, folder.st_uid):
        return "it belongs to someone else, in a folder where only owners replace files"
    if folders.is_mount_point(target):
        return "it is a mount point, which no file can replace; mount its folder instead"
    return ""


def _mount_points() -> set[str]:
    try:
        with open("/proc/self/mountinfo", encoding="utf-8", errors="surrogateescape") as lines:
            places = [line.split(" ")[4] for line in lines]
    except (OSError, IndexError):
        return set()
    return {re.sub(r"\\(\d{3})", lambda octal: chr(int(octal[1], 8)), place) for place in places}
