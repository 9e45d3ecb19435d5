# SPDX-License-Identifier: GPL-3.0-or-later
"""A folder of sample files that is never half true (docs/architecture.md, decision 7).

    store = CacheStore(folder, plan, resume=True)     # refuses a foreign mesh, a newer schema, an unwritable folder
    for j in store.missing():
        store.write(j, lambda path: ...)              # temporary name, fsync, checksum, rename
    store.finish({"field.usda": lambda path: ...})    # shared files, then manifest.json

While the bake runs the folder holds plan.json, and next to each finished sample its checksum (NAME.sha256, as sha256sum
writes it); finish() moves the checksums into the manifest. Several machines may write disjoint samples of one plan into
one folder, or into folders that are copied together: the last one to finish writes the manifest, and the bytes do not
depend on the split. Faults of the disk become one InputError; the file in work is removed, finished samples stay.
"""

import contextlib
import errno
import hashlib
import os
import socket
import time
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping
from pathlib import Path

from ..model.errors import InputError
from ..work import between
from .layout import MANIFEST, PLAN
from .manifest import SHARED, read_manifest, read_plan
from .plan import NAME, Plan, text

WriteFile = Callable[[Path], object]
WriteInSteps = Callable[[Path], Generator[float]]

TEMPORARY = ".tmp-"
CHECKSUM = ".sha256"
#: Bytes that are hashed at once.
SLICE = 4 << 20
#: Where a file is written and its checksum begins, in the fractions of its steps.
WRITTEN = 0.8
#: A temporary file this old (seconds) has lost its writer.
ABANDONED = 3600.0


class CacheStore:
    """Writer of one cache folder.

    resume: keep the samples already there; they must come from an equal plan. Otherwise samples of an equal plan are
    kept for other writers but count as missing for this one, and those of another plan are deleted.
    replace: a cache of another mesh, or of other settings when resuming, is deleted instead of refused.
    """

    def __init__(self, folder: str | os.PathLike, plan: Plan, *, resume: bool = False, replace: bool = False):
        self.folder = Path(folder)
        self.plan = plan
        self.names = plan.names
        self._resume = resume
        self._written: set[int] = set()
        self._verified: set[str] = set()  # whole when this writer last checked
        found = _existing_plan(self.folder)
        if found is not None and not found.same(plan) and not replace:
            self._check_replaceable(found, resume)
        with _disk_faults(self.folder):
            for folder_name in {name.partition("/")[0] for name in self.names}:
                (self.folder / folder_name).mkdir(parents=True, exist_ok=True)
            if found is not None and not found.same(plan):
                delete_cache(self.folder, keep_folders=True)
            _remove_temporary(self.folder, older_than=ABANDONED)
            if not (self.folder / MANIFEST).exists():
                self._atomic(PLAN, lambda path: _write_text(path, text(plan)))

    def missing(self, among: Iterable[int] | None = None) -> list[int]:
        """Samples (of those `among`) this writer has to write: absent, damaged, or without resume not yet rewritten."""
        candidates = range(len(self.names)) if among is None else sorted(among)
        if not self._resume:
            return [j for j in candidates if j not in self._written]
        sums = self._checksums()
        return [j for j in candidates if not self._intact(self.names[j], sums.get(self.names[j]))]

    def write(self, index: int, write_file: WriteFile) -> None:
        """write_file(path) must leave a complete file at path; it gets its name when it is safely on the disk."""
        with _disk_faults(self.folder):
            self._reopen()
            self._atomic(self.names[index], write_file, checksum=True)
        self._written.add(index)
        self._verified.add(self.names[index])

    def write_in_steps(self, index: int, write_file: WriteInSteps) -> Generator[float]:
        """write() in steps: write_file(path) yields the fraction that is written. Closing the generator removes the
        file in work."""
        name = self.names[index]
        with _disk_faults(self.folder):
            self._reopen()
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
                self._write_checksum(name, digest.hexdigest())
                temporary.replace(self.folder / name)
        self._written.add(index)
        self._verified.add(name)

    def finish(self, shared: Mapping[str, WriteFile]) -> bool:
        """Writes the shared files and the manifest; False (and nothing written) while samples are missing."""
        if self._finished():
            self._clean()
            return True
        with _disk_faults(self.folder):
            self._reopen()
            # Finding the files is cheaper than reading them, and many machines ask before the last one may join.
            if not all((self.folder / name).exists() for name in self.names):
                return False
            files = self._checksums()
            if not all(name in self._verified or self._intact(name, files.get(name)) for name in self.names):
                return self._finished()
            try:
                self._join({name: files[name] for name in self.names}, shared)
            except FileNotFoundError:
                # Two machines may finish in the same moment; the first one takes the other's temporary files away.
                if not self._finished():
                    raise
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
            temporary.replace(self.folder / name)
        return digest

    @contextlib.contextmanager
    def _temporary(self, name: str) -> Iterator[Path]:
        """A path in the folder of that file, removed when the work on it fails or is given up."""
        final = self.folder / name
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

    def _reopen(self) -> None:
        """Turns a finished cache of this plan back into a bake in progress, so that no manifest covers a new sample."""
        if not (self.folder / MANIFEST).exists():
            return
        for name, digest in self._checksums().items():
            if name in self.names:
                self._write_checksum(name, digest)
        self._atomic(PLAN, lambda path: _write_text(path, text(self.plan)))
        (self.folder / MANIFEST).unlink()
        _sync(self.folder)

    def _checksums(self) -> dict[str, str]:
        """The checksum each file should have: from the manifest, or from the file next to the sample."""
        if (self.folder / MANIFEST).exists():
            return dict(read_manifest(self.folder / MANIFEST).files)
        sums = {}
        for name in self.names:
            with contextlib.suppress(OSError, IndexError):
                sums[name] = (self.folder / (name + CHECKSUM)).read_text().split()[0]
        return sums

    def _join(self, files: dict[str, str], shared: Mapping[str, WriteFile]) -> None:
        for name, write_file in shared.items():
            files[name] = self._atomic(name, write_file)
        for parent in {(self.folder / name).parent for name in files}:
            _sync(parent)
        self._atomic(MANIFEST, lambda path: _write_text(path, text(self.plan, files)))
        _sync(self.folder)
        self._clean()

    def _finished(self) -> bool:
        """Whether there is a manifest, and every file it names is whole."""
        if not (self.folder / MANIFEST).exists():
            return False
        files = read_manifest(self.folder / MANIFEST).files
        return all(name in self._verified or self._intact(name, digest) for name, digest in files.items())

    def _intact(self, name: str, digest: str | None) -> bool:
        path = self.folder / name
        if digest is None or not path.is_file() or sha256(path) != digest:
            return False
        self._verified.add(name)
        return True

    def _clean(self) -> None:
        """Removes what only a bake in progress needs."""
        for name in self.names:
            (self.folder / (name + CHECKSUM)).unlink(missing_ok=True)
        (self.folder / PLAN).unlink(missing_ok=True)
        _remove_temporary(self.folder, older_than=0.0)


def delete_cache(folder: str | os.PathLike, *, keep_folders: bool = False) -> None:
    """Deletes the files of a cache and nothing else: names that a bake gives, inside the folder, no links followed.

    The manifest goes first, so that an interrupted deletion leaves no cache that claims to be whole.
    """
    folder = Path(folder)
    with _disk_faults(folder):
        for name in (MANIFEST, *SHARED):
            (folder / name).unlink(missing_ok=True)
        for path in _owned(folder):
            path.unlink(missing_ok=True)
        (folder / PLAN).unlink(missing_ok=True)
        if not keep_folders:
            for path in (folder / "samples", folder / "frames", folder):
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


def _remove_temporary(folder: Path, *, older_than: float) -> None:
    for path in _owned(folder):
        with contextlib.suppress(FileNotFoundError):
            if path.name.startswith(TEMPORARY) and time.time() - path.stat().st_mtime >= older_than:
                path.unlink()


def _existing_plan(folder: Path) -> Plan | None:
    for name, read in ((MANIFEST, lambda path: read_manifest(path).plan), (PLAN, read_plan)):
        if (folder / name).exists():
            return read(folder / name)
    return None


def _write_text(path: Path, content: str) -> None:
    """The same bytes on every system."""
    path.write_text(content, encoding="utf-8", newline="\n")


def sha256(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


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
def _disk_faults(folder: Path) -> Iterator[None]:
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
