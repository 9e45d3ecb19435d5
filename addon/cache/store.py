# SPDX-License-Identifier: GPL-3.0-or-later
"""A folder of sample files that is never half true (docs/architecture.md, decision 7).

    store = CacheStore(folder, plan, resume=True)     # refuses a foreign mesh, a newer schema, an unwritable folder
    for j in store.missing():
        store.write(j, lambda path: ...)              # temporary name, fsync, checksum, rename
    run(store.finish())                               # the joint, where there is one, then manifest.json

While the bake runs the folder holds plan.json, and next to each finished sample its checksum (NAME.sha256, as sha256sum
writes it); finish() moves the checksums into the manifest. Where samples are joined into one file, their own files are
then removed; from it they can be made again. Several machines may write disjoint samples of one plan into
one folder, or into folders that are copied together: the last one to finish writes the manifest, and the bytes do not
depend on the split. Faults of the disk become one InputError; the file in work is removed, finished samples stay.

On folders of a network, names that other machines wrote may appear late, clocks differ, and a virus scanner may refuse
a rename for a moment: names are taken from listings, ages are measured by the folder's own clock, refused renames are
tried again. Two machines may write the same sample: both write the same bytes, and the later one changes nothing.
"""

import contextlib
import errno
import hashlib
import itertools
import os
import re
import socket
import time
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TypeVar

from ..model.errors import InputError
from ..work import between
from .checksums import known_sha256, remember, sha256
from .layout import MANIFEST, PLAN
from .manifest import SHARED, read_manifest, read_plan
from .plan import NAME, Plan, text

WriteFile = Callable[[Path], object]
WriteInSteps = Callable[[Path], Generator[float]]
Content = TypeVar("Content")

TEMPORARY = ".tmp-"
CHECKSUM = ".sha256"
#: Bytes that are hashed at once.
SLICE = 4 << 20
#: Where a file is written and its checksum begins, in the fractions of its steps.
WRITTEN = 0.8
#: A temporary file that nobody has touched for so long (seconds) has lost its writer.
ABANDONED = 3600.0
#: Seconds between two attempts of a rename that the system refuses, and how many there are.
RETRY_PAUSE, RETRIES = 0.1, 25
#: Refusals that end by themselves, as Windows numbers them: access denied, sharing and lock violations.
PASSING = (5, 32, 33)


@dataclass(frozen=True)
class Joint:
    """The one file that takes in all samples when they are finished, in place of their own files."""

    name: str
    write: WriteInSteps  #: joins the files of all samples
    extract: Callable[[int, Path], object]  #: writes the file of one sample again: the same bytes


class CacheStore:
    """Writer of one cache folder.

    resume: keep the samples already there; they must come from an equal plan. Otherwise samples of an equal plan are
    kept for other writers but count as missing for this one, and those of another plan are deleted.
    replace: a cache of another mesh, or of other settings when resuming, is deleted instead of refused.
    joint: None where the samples keep their own files.
    """

    def __init__(
        self,
        folder: str | os.PathLike,
        plan: Plan,
        *,
        resume: bool = False,
        replace: bool = False,
        joint: Joint | None = None,
    ):
        self.folder = Path(folder)
        self.plan = plan
        self._joint = joint
        self.names = plan.names
        self._resume = resume
        self._written: set[int] = set()
        self._verified: set[str] = set()  # whole when this writer last checked
        found = _existing_plan(self.folder)
        if found is not None and not found.same(plan) and not replace:
            self._check_replaceable(found, resume)
        with disk_faults(self.folder):
            self.folder.mkdir(parents=True, exist_ok=True)
            if found is not None and not found.same(plan):
                delete_cache(self.folder, keep_folders=True)
            _remove_abandoned(self.folder)
            if self._manifest() is None:
                for folder_name in {name.partition("/")[0] for name in self.names}:
                    (self.folder / folder_name).mkdir(exist_ok=True)
                self._atomic(PLAN, lambda path: _write_text(path, text(plan)))

    def missing(self, among: Iterable[int] | None = None) -> list[int]:
        """Samples (of those `among`) this writer has to write: absent, damaged, or without resume not yet rewritten."""
        candidates = range(len(self.names)) if among is None else sorted(among)
        if not self._resume:
            return [j for j in candidates if j not in self._written]
        sums = self._checksums()
        return [j for j in candidates if not self._is_there(self.names[j], sums)]

    def write(self, index: int, write_file: WriteFile) -> None:
        """write_file(path) must leave a complete file at path; it gets its name when it is safely on the disk."""
        name = self.names[index]
        with disk_faults(self.folder):
            if not self._holds_finished(name):
                self._reopen()
                with self._or_written_elsewhere(name):
                    self._atomic(name, write_file, checksum=True)
        self._written.add(index)
        self._verified.add(name)

    def write_in_steps(self, index: int, write_file: WriteInSteps) -> Generator[float]:
        """write() in steps: write_file(path) yields the fraction that is written. Closing the generator removes the
        file in work."""
        name = self.names[index]
        with disk_faults(self.folder):
            if not self._holds_finished(name):
                self._reopen()
                with self._or_written_elsewhere(name):
                    yield from self._atomic_in_steps(name, write_file, checksum=True)
        self._written.add(index)
        self._verified.add(name)

    def absent(self) -> list[str]:
        """Names of the samples that no machine has finished yet, from listings of the folder."""
        parents = {"", *(name.rpartition("/")[0] for name in self.names)}
        present = {name for parent in parents for name in self._listed(parent)}
        found = self._manifest()
        if found is not None:
            return [name for name in self.names if self._holder(name, found) not in present]
        return [name for name in self.names if name not in present or name + CHECKSUM not in present]

    def write_all(self, write_joint: WriteInSteps) -> Generator[float]:
        """Writes all samples at once, straight into the joint, and the manifest; yields the fraction that is done.
        write_joint(path) yields it as well; it leaves the same bytes as a joint of single samples."""
        with disk_faults(self.folder), self._or_finished_elsewhere():
            yield from self._join({}, write_joint)

    def finish(self, *, verify: bool = False) -> Generator[float, None, bool]:
        """Writes the joint and the manifest in steps; yields the fraction that is done. False (and nothing written)
        while samples are missing.

        A sample whose checksum stands next to it is whole: names come last. verify: all are read nevertheless, and one
        that is damaged counts as missing.
        """
        with disk_faults(self.folder):
            found = self._manifest()
            if found is not None and self._is_joined(found) and self._is_whole(found, verify=verify):
                self._clean(found)
                return True
            self._reopen()
            if self.absent():
                return False
            files = self._checksums()
            write_joint = None if self._joint is None else self._joint.write
            if verify and not self._all_intact({name: files[name] for name in self.names}):
                return False
            with self._or_finished_elsewhere():
                yield from self._join({name: files[name] for name in self.names}, write_joint)
        return True

    # Steps ------------------------------------------------------------------------------------------------------------

    def _check_replaceable(self, found: Plan, resume: bool) -> None:
        if found.mesh != self.plan.mesh:
            raise InputError(
                f"{self.folder}: holds the cache of another mesh ({found.mesh.vertices} vertices, {found.mesh.faces} "
                f"faces, not {self.plan.mesh.vertices} and {self.plan.mesh.faces} of the same shape); "
                "choose another folder or delete this one"
            )
        if resume:
            raise InputError(
                f"{self.folder}: was baked with other settings, so it cannot be resumed; bake without resume, "
                "or choose another folder"
            )

    def _atomic(self, name: str, write_file: WriteFile, *, checksum: bool = False, durable: bool = True) -> str:
        """Writes one file under its final name, whole or not at all; returns its SHA-256.

        durable: content survives a power cut where the name does. Names are made to survive by finish(): until then a
        lost one is a missing sample.
        """
        with self._temporary(name) as temporary:
            write_file(temporary)
            digest = sha256(temporary)
            if durable:
                _sync(temporary)
            if checksum:
                self._write_checksum(name, digest)
            rename(temporary, self.folder / name)
        return digest

    def _atomic_in_steps(self, name: str, write_file: WriteInSteps, *, checksum: bool) -> Generator[float, None, str]:
        """_atomic() of a large file: yields the fraction that is written."""
        with self._temporary(name) as temporary:
            with contextlib.closing(write_file(temporary)) as writing:
                for fraction in writing:
                    yield between(0.0, WRITTEN, fraction)
            digest, size = hashlib.sha256(), temporary.stat().st_size
            with temporary.open("rb") as file:
                while data := file.read(SLICE):
                    digest.update(data)
                    yield between(WRITTEN, 1.0, file.tell() / size)
            _sync(temporary)
            if checksum:
                self._write_checksum(name, digest.hexdigest())
            rename(temporary, self.folder / name)
        return digest.hexdigest()

    @contextlib.contextmanager
    def _temporary(self, name: str) -> Iterator[Path]:
        """A path in the folder of that file, removed when the work on it fails or is given up."""
        final = self.folder / name
        final.parent.mkdir(exist_ok=True)
        temporary = final.with_name(f"{TEMPORARY}{socket.gethostname()}-{os.getpid()}-{final.name}")
        try:
            yield temporary
        except BaseException:
            # Libraries that write through a temporary file of their own begin its name with ours.
            for leftover in final.parent.glob(temporary.stem + "*"):
                leftover.unlink(missing_ok=True)
            raise

    def _write_checksum(self, name: str, digest: str) -> None:
        line = f"{digest}  {Path(name).name}\n"
        self._atomic(name + CHECKSUM, lambda path: _write_text(path, line), durable=False)

    def _manifest(self) -> dict[str, str] | None:
        """The checksums of a finished cache; None while there is no manifest."""
        found = _read_if_there(self.folder / MANIFEST, read_manifest)
        return None if found is None else dict(found.files)

    def _holds_finished(self, name: str) -> bool:
        """Whether a finished cache holds this sample, so that a late twin has nothing to write."""
        if not self._resume:
            return False
        found = self._manifest()
        return found is not None and self._is_there(name, found)

    def _is_joined(self, files: Mapping[str, str]) -> bool:
        return self._joint is None or self._joint.name in files

    def _holder(self, name: str, files: Mapping[str, str]) -> str:
        """The file of a finished cache that holds a sample."""
        return self._joint.name if self._joint is not None and name not in files else name

    def _is_there(self, name: str, files: Mapping[str, str]) -> bool:
        """Whether a sample is whole, in a file of its own or in the joint."""
        holder = self._holder(name, files)
        if holder == name or holder not in files:
            return self._intact(name, files.get(name))
        try:
            whole = known_sha256(self.folder / holder) == files[holder]
        except (FileNotFoundError, IsADirectoryError):
            return False
        if whole:
            self._verified.add(holder)
        return whole

    @contextlib.contextmanager
    def _or_written_elsewhere(self, name: str) -> Iterator[None]:
        """Another machine may finish this sample, and with it the cache, while this one writes it."""
        try:
            yield
        except FileNotFoundError:
            if not self._is_there(name, self._checksums()):
                raise

    @contextlib.contextmanager
    def _or_finished_elsewhere(self) -> Iterator[None]:
        """Another machine may join the cache in the same moment."""
        try:
            yield
        except FileNotFoundError:
            if self._manifest() is None:
                raise

    def _listed(self, parent: str) -> list[str]:
        """Names in a folder of the cache, relative to the cache. A listing is fresher than a question for one name."""
        try:
            return [path.relative_to(self.folder).as_posix() for path in (self.folder / parent).iterdir()]
        except FileNotFoundError:
            return []

    def _reopen(self) -> None:
        """Turns a finished cache of this plan back into a bake in progress, so that no manifest covers a new sample."""
        found = self._manifest()
        if found is None:
            return
        for index, name in enumerate(self.names):
            if name in found:
                self._write_checksum(name, found[name])
            elif self._joint is not None and self._is_there(name, found):
                self._atomic(name, partial(self._joint.extract, index), checksum=True)
        self._verified.clear()
        self._atomic(PLAN, lambda path: _write_text(path, text(self.plan)))
        (self.folder / MANIFEST).unlink()
        _sync(self.folder)

    def _checksums(self) -> dict[str, str]:
        """The checksum each file should have: from the manifest, or from the file next to the sample."""
        found = self._manifest()
        if found is not None:
            return found
        sums = {}
        for name in self.names:
            with contextlib.suppress(OSError, IndexError):
                sums[name] = (self.folder / (name + CHECKSUM)).read_text().split()[0]
        return sums

    def _join(self, files: dict[str, str], write_joint: WriteInSteps | None) -> Generator[float]:
        """files: the checksums of the samples, which stay where there is no joint."""
        if self._joint is not None and write_joint is not None:
            name = self._joint.name
            files = {name: (yield from self._atomic_in_steps(name, write_joint, checksum=False))}
            remember(self.folder / name, files[name])
            self._verified.add(name)
        for parent in {(self.folder / name).parent for name in files}:
            _sync(parent)
        self._atomic(MANIFEST, lambda path: _write_text(path, text(self.plan, files)))
        _sync(self.folder)
        self._clean(files)

    def _is_whole(self, files: Mapping[str, str], *, verify: bool) -> bool:
        """Whether a finished cache still has all its files: the joint is read, single samples with verify."""
        read = {name: digest for name, digest in files.items() if verify or name not in self.names}
        return not self.absent() and self._all_intact(read)

    def _all_intact(self, files: Mapping[str, str]) -> bool:
        return all(name in self._verified or self._intact(name, digest) for name, digest in files.items())

    def _intact(self, name: str, digest: str | None) -> bool:
        try:
            if digest is None or sha256(self.folder / name) != digest:
                return False
        except (FileNotFoundError, IsADirectoryError):
            return False
        self._verified.add(name)
        return True

    def _clean(self, files: Mapping[str, str]) -> None:
        """Removes what only a bake in progress needs, from a finished cache of these files."""
        for path in _owned(self.folder):
            if not path.name.startswith(TEMPORARY) and path.relative_to(self.folder).as_posix() not in files:
                path.unlink(missing_ok=True)
        (self.folder / PLAN).unlink(missing_ok=True)
        _remove_abandoned(self.folder)
        _remove_empty(self.folder)


def rename(temporary: Path, final: Path) -> None:
    """Gives a file its name. What a virus scanner or a reader refuses for a moment is tried again for some seconds; a
    name that is there although the server's answer was lost counts as done."""
    identity = temporary.stat().st_ino
    for attempt in itertools.count():
        try:
            temporary.replace(final)
            return
        except FileNotFoundError:
            with contextlib.suppress(FileNotFoundError):
                if attempt and final.stat().st_ino == identity:
                    return
            raise
        except PermissionError as error:
            if getattr(error, "winerror", None) not in PASSING or attempt == RETRIES:
                raise
        time.sleep(RETRY_PAUSE)


def delete_cache(folder: str | os.PathLike, *, keep_folders: bool = False) -> None:
    """Deletes the files of a cache and nothing else: names that a bake gives, inside the folder, no links followed.

    The manifest goes first, so that an interrupted deletion leaves no cache that claims to be whole.
    """
    folder = Path(folder)
    with disk_faults(folder):
        for name in (MANIFEST, *SHARED):
            (folder / name).unlink(missing_ok=True)
        for path in _owned(folder):
            path.unlink(missing_ok=True)
        (folder / PLAN).unlink(missing_ok=True)
        if not keep_folders:
            _remove_empty(folder)
            with contextlib.suppress(OSError):
                folder.rmdir()


def _remove_empty(folder: Path) -> None:
    """Removes the folders of samples that hold nothing."""
    for path in (folder / "samples", folder / "frames"):
        with contextlib.suppress(OSError):
            path.rmdir()


def _owned(folder: Path) -> Iterator[Path]:
    """Samples, their checksums and temporary files."""
    for parent in (folder, folder / "samples", folder / "frames"):
        if (parent.is_symlink() and parent != folder) or not parent.is_dir():
            continue
        for path in sorted(parent.iterdir()):
            name = path.relative_to(folder).as_posix().removesuffix(CHECKSUM)
            if path.name.startswith(TEMPORARY) or NAME.fullmatch(name):
                yield path


def _remove_abandoned(folder: Path) -> None:
    """Removes temporary files whose writer is gone: a process of this machine that has ended, or one of another machine
    that has not touched its file for long."""
    files = [path for path in _owned(folder) if path.name.startswith(TEMPORARY)]
    if not files:
        return
    now = _clock(folder)
    for path in files:
        with contextlib.suppress(FileNotFoundError):
            if _writer_ended(path.name) or now - path.stat().st_mtime >= ABANDONED:
                path.unlink()


def _clock(folder: Path) -> float:
    """The time by which the folder's files are stamped, which a server gives: machines' own clocks may differ."""
    probe = folder / f"{TEMPORARY}{socket.gethostname()}-{os.getpid()}-clock"
    try:
        probe.write_bytes(b"")
        return probe.stat().st_mtime
    finally:
        probe.unlink(missing_ok=True)


def _writer_ended(name: str) -> bool:
    """Whether a temporary file belongs to a process of this machine that runs no longer."""
    match = re.match(rf"{re.escape(TEMPORARY + socket.gethostname())}-(\d+)-", name)
    if match is None or os.name == "nt":
        return False
    try:
        os.kill(int(match[1]), 0)
    except ProcessLookupError:
        return True
    except (PermissionError, OverflowError):
        pass
    return False


def _existing_plan(folder: Path) -> Plan | None:
    found = _read_if_there(folder / MANIFEST, read_manifest)
    return _read_if_there(folder / PLAN, read_plan) if found is None else found.plan


def _read_if_there(path: Path, read: Callable[[Path], Content]) -> Content | None:
    """None for a file that cannot be opened because it is not there: a server answers that freshly."""
    try:
        path.open("rb").close()
    except (FileNotFoundError, NotADirectoryError):
        return None
    return read(path)


def _write_text(path: Path, content: str) -> None:
    """The same bytes on every system."""
    path.write_text(content, encoding="utf-8", newline="\n")


def _sync(path: Path) -> None:
    """Makes a file, or the names in a folder, survive a power cut. Systems that cannot open folders keep names safe."""
    if path.is_dir() and os.name == "nt":
        return
    handle = os.open(path, os.O_RDWR if path.is_file() else os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


@contextlib.contextmanager
def disk_faults(folder: Path) -> Iterator[None]:
    """One clear line for what the disk refuses."""
    try:
        yield
    except OSError as error:
        where = error.filename or folder
        match error.errno:
            case errno.ENOSPC | errno.EDQUOT | errno.EFBIG:
                cure = "free some space, then resume the bake: finished samples are kept"
                raise InputError(f"{folder}: the disk is full; {cure}") from error
            case errno.EACCES | errno.EPERM | errno.EROFS:
                raise InputError(f"{where}: may not be written; choose a folder you can write to") from error
            case errno.ENOTDIR | errno.EEXIST:
                raise InputError(f"{where}: is a file, not a folder; choose another name") from error
        raise InputError(f"{where}: {error.strerror or error}; choose another folder") from error
