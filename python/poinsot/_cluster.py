"""Campaigns beyond one machine: shards as tasks of Dask, results in object stores of fsspec.

A task gets the files of the plan, runs its shards in a folder of its own, and puts them where the results belong. A
worker that does not see that place returns the bytes, and the driver puts them there.
"""

from __future__ import annotations

import os
import re
import threading
import time
from collections.abc import Callable, Generator, Sequence
from contextlib import contextmanager
from pathlib import Path, PurePosixPath
from secrets import token_hex
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple, Protocol

from . import _core
from ._errors import InputError, PoinsotError, ResourceError, need

# Aim for the time of a task, s: the shortest of the 10 to 120 s that a scheduler handles well loses least in a crash.
_TASK_S = 10.0
# Tasks of each thread, at least, in the shards that are left.
_TASKS_OF_THREAD = 4
# Tasks that the scheduler holds, or one a thread if that is more. Its memory stays constant, and clusters that grow with the queue do so.
_QUEUED = 1000
# Repetitions of a task that fails. A task whose workers die is repeated by Dask's own `allowed-failures`.
_RETRIES = 3
# Time between two checks for an interruption, s; a tenth of the 0.2 s within which Ctrl-C acts.
_POLL_S = 0.02
# File that shows a worker whether it sees the place of the results.
_TOKEN = ".poinsot-driver"

Report = Callable[[str, int, int], Any]
# Names of files with their bytes, or with their size where they are in place.
Found = dict[str, "bytes | int"]


class Store(Protocol):
    """The place of the results."""

    # Folder that the merge reads.
    folder: str

    def put(self, name: str, data: bytes) -> None: ...
    def get(self, name: str) -> bytes | None: ...
    def note(self, name: str, data: bytes | int) -> None: ...


class Folder:
    """A folder of the file system."""

    def __init__(self, folder: str) -> None:
        self.folder = folder

    def put(self, name: str, data: bytes) -> None:
        """Write a file whole or not at all."""
        path = Path(self.folder, name)
        draft = path.with_name(f".{path.name}.{token_hex(8)}")
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            draft.write_bytes(data)
            draft.replace(path)
        except OSError as error:
            draft.unlink(missing_ok=True)
            raise ResourceError(f"E0002 {path}: cannot be written: {error.strerror}; correct the path or the permission") from error

    def get(self, name: str) -> bytes | None:
        """Bytes of a file, None where there is none."""
        try:
            return Path(self.folder, name).read_bytes()
        except OSError:
            return None

    def note(self, name: str, data: bytes | int) -> None:
        """Nothing: the merge reads the folder itself."""


class Bucket:
    """A folder of an object store. The merge reads a mirror: sums whole, for rows a file `.elsewhere` of their size."""

    def __init__(self, url: str, mirror: str | None = None) -> None:
        core = need("fsspec", "fsspec").core
        self.folder = mirror or ""
        # Without the user and the password that a URL may hold.
        self._shown = re.sub("//[^/@]*@", "//", url)
        with self._faults():
            fs, root = core.url_to_fs(url, auto_mkdir=True) if url.startswith("file:") else core.url_to_fs(url)
            self._fs, self._root = fs, root.rstrip("/")

    @contextmanager
    def _faults(self) -> Generator[None]:
        """Errors of any object store, of any type, with a code."""
        try:
            yield
        except FileNotFoundError:
            raise
        except Exception as error:
            what = " ".join(str(error).split()) or type(error).__name__
            raise ResourceError(f"E0002 {self._shown}: {what}; correct the address or the permission") from error

    def put(self, name: str, data: bytes) -> None:
        """Write an object."""
        with self._faults():
            self._fs.pipe_file(f"{self._root}/{name}", data)

    def get(self, name: str) -> bytes | None:
        """Bytes of an object, None where there is none."""
        try:
            with self._faults():
                data: bytes = self._fs.cat_file(f"{self._root}/{name}")
        except FileNotFoundError:
            return None
        return data

    def note(self, name: str, data: bytes | int) -> None:
        """Mirror an object."""
        path = Path(self.folder, name)
        if not name.endswith(".json"):
            path = path.with_suffix(".elsewhere")
        path.parent.mkdir(parents=True, exist_ok=True)
        with path.open("wb") as file:
            if isinstance(data, bytes) and name.endswith(".json"):
                file.write(data)
            else:
                file.truncate(len(data) if isinstance(data, bytes) else data)

    def pull(self) -> None:
        """Mirror the shards of an earlier run."""
        with self._faults():
            # Cached listings are out of date.
            self._fs.invalidate_cache()
            found = self._fs.find(f"{self._root}/shards", detail=True)
        for path, about in found.items():
            name = "shards/" + str(PurePosixPath(path)).rpartition("/shards/")[2]
            data = self.get(name) if name.endswith(".json") else None
            self.note(name, about["size"] if data is None else data)


def _store(out: str, mirror: str | None = None) -> Folder | Bucket:
    return Bucket(out, mirror) if "://" in out else Folder(out)


class Inputs(NamedTuple):
    """A plan with the files that it names, as a worker gets them."""

    digest: str
    trials: int
    # Name of the plan below the common folder, and the other files with it.
    plan: str
    files: dict[str, bytes]

    @classmethod
    def of(cls, plan: _core.Plan) -> Inputs:
        """Collect the files; a plan names them relative to its own folder."""
        base, paths = plan.files()
        text = plan.text()
        base = os.path.abspath(base)
        whole = sorted({os.path.abspath(p) for p in paths})
        root = os.path.commonpath([base, *map(os.path.dirname, whole)])
        name = PurePosixPath(Path(base).relative_to(root).as_posix(), f"{plan.digest}.toml")
        files = {Path(p).relative_to(root).as_posix(): Path(p).read_bytes() for p in whole}
        return cls(plan.digest, plan.trials, str(name), files | {str(name): text.encode()})


# Plans of this process, with the folders of their files.
_plans: dict[tuple[str, int], tuple[TemporaryDirectory[str], _core.Plan]] = {}
_lock = threading.Lock()


def _plan(inputs: Inputs) -> _core.Plan:
    key = (inputs.digest, inputs.trials)
    with _lock:
        if key not in _plans:
            folder = TemporaryDirectory(prefix="poinsot-")
            for name, data in inputs.files.items():
                Folder(folder.name).put(name, data)
            try:
                plan = _core.Plan.read(os.path.join(folder.name, inputs.plan), inputs.trials)
            except PoinsotError as error:
                raise type(error)(f"{error}; this is a worker: files of the plan are sent where it names them relative to itself") from None
            if plan.digest != inputs.digest:
                raise InputError(
                    f"E0602 {inputs.plan}: this worker reads plan {plan.digest[:12]}, the driver {inputs.digest[:12]}; "
                    "install the same version of poinsot on both, and name files of the plan relative to it"
                )
            _plans[key] = (folder, plan)
        return _plans[key][1]


def _shards(plan: _core.Plan, shards: Sequence[int], threads: int | None, progress: Report | None = None) -> dict[str, bytes]:
    """Files of these shards, rows before sums."""
    with TemporaryDirectory(prefix="poinsot-") as folder:
        plan.run(folder, list(shards), threads, progress)
        paths = sorted((p for p in Path(folder).rglob("*") if p.is_file()), key=lambda p: (p.suffix == ".json", p))
        return {p.relative_to(folder).as_posix(): p.read_bytes() for p in paths}


def task(inputs: Inputs, shards: Sequence[int], out: str, token: bytes) -> tuple[float, bool, Found]:
    """Run shards on one thread of a worker: their time, whether they are in place, and their files."""
    plan = _plan(inputs)
    store = _seen(out, token)
    begun = time.perf_counter()
    files = _shards(plan, shards, 1)
    seconds = time.perf_counter() - begun
    if store is None:
        return (seconds, False, dict(files))
    for name, data in files.items():
        store.put(name, data)
    # The driver merges sums alone.
    return (seconds, True, {name: data if name.endswith(".json") else len(data) for name, data in files.items()})


def _seen(out: str, token: bytes) -> Folder | Bucket | None:
    """The place of the results where this worker sees it; it may lack the library, the credentials or the network."""
    try:
        store = _store(out)
        return store if store.get(_TOKEN) == token else None
    except PoinsotError:
        return None


class Engine:
    """Runs shards for a campaign: by the workers of a client, or on the cores of this machine."""

    def __init__(self, plan: _core.Plan, out: str, store: Folder | Bucket, client: Any, progress: Report | None) -> None:
        self._plan, self._out, self._store, self._client = plan, out, store, client
        self._report = progress or (lambda stage, done, total: None)
        self._stopped = threading.Event()
        self._failure: BaseException | None = None
        # Raised by the caller's own `progress`.
        self._refused: BaseException | None = None

    def __call__(self, shards: list[int]) -> None:
        """Called by the campaign beside the calling thread."""
        done, results = 0, self._here(shards) if self._client is None else self._tasks(shards)
        try:
            for count, there, found in results:
                for name, data in found.items():
                    if not there and isinstance(data, bytes):
                        self._store.put(name, data)
                    self._store.note(name, data)
                done += count
                self._show(done, len(shards))
        except BaseException as error:
            self._failure = error
            raise
        finally:
            # Cancels the tasks while the client is there.
            results.close()

    def _show(self, done: int, total: int) -> None:
        try:
            self._report("shards", done, total)
        except BaseException as error:
            self._refused = error
            raise

    def run(self, resume: bool, until: float | None) -> tuple[str, str, int]:
        """The campaign; an interruption cancels the tasks."""
        try:
            return self._plan.campaign(self._store.folder, resume, until, self)
        except PoinsotError as error:
            failure = self._failure
            if self._refused is not None:
                raise self._refused from None
            if isinstance(failure, PoinsotError):
                raise failure from None
            if failure is not None:
                # Of Dask or of an object store, of any type.
                what = " ".join(str(failure).split()) or type(failure).__name__
                raise ResourceError(f"E0002 {self._out}: {what}; finished shards are kept, correct it and give resume=True") from failure
            raise type(error)(str(error).replace(self._store.folder, self._out)) from None
        finally:
            self._stopped.set()

    def _look(self, *_: object) -> None:
        if self._stopped.is_set():
            raise KeyboardInterrupt

    def _here(self, shards: list[int]) -> Generator[tuple[int, bool, Found]]:
        at, size = 0, os.cpu_count() or 1
        while at < len(shards):
            begun = time.perf_counter()
            some = shards[at : at + size]
            yield len(some), False, dict(_shards(self._plan, some, None, self._look))
            at += len(some)
            size = max(1, int(len(some) * _TASK_S / (time.perf_counter() - begun)))

    def _tasks(self, shards: list[int]) -> Generator[tuple[int, bool, Found]]:
        distributed, client = need("distributed", "dask"), self._client
        token = token_hex(16).encode()
        self._store.put(_TOKEN, token)
        # A task, not scattered data: it is computed again where the worker that holds it is lost. Of its own key: a campaign
        # that ends must not cancel another one of the same plan.
        inputs = client.submit(Inputs, *Inputs.of(self._plan), pure=False, retries=_RETRIES)
        waiting: dict[Any, int] = {}
        finished = distributed.as_completed(loop=client.loop)
        threads = max(1, sum(client.nthreads().values()))
        # The first tasks have one shard each, and say how long it takes.
        at, size, room = 0, 1, threads
        try:
            while at < len(shards) or waiting:
                while at < len(shards) and len(waiting) < room:
                    # Smaller towards the end, so that no worker waits long for another (Polychronopoulos and Kuck 1987).
                    some = shards[at : at + min(size, max(1, (len(shards) - at) // (threads * _TASKS_OF_THREAD)))]
                    future = client.submit(task, inputs, some, self._out, token, pure=False, retries=_RETRIES)
                    waiting[future] = len(some)
                    finished.add(future)
                    at += len(some)
                for future in self._next(finished):
                    seconds, there, found = future.result()
                    count = waiting.pop(future)
                    room = max(threads, _QUEUED)
                    # Shards of other cells take other times: at most twice as many as the last task.
                    size = min(max(1, int(_TASK_S * count / seconds)), 2 * count)
                    yield count, there, found
        finally:
            client.cancel([inputs, *waiting])

    def _next(self, finished: Any) -> list[Any]:
        """Tasks that are finished; waits for one."""
        while True:
            self._look()
            if self._client.status in ("closed", "closing"):
                raise ResourceError("E0002 client: the scheduler of Dask has ended; start a cluster and give resume=True")
            if finished.has_ready():
                return list(finished.next_batch(block=False))
            time.sleep(_POLL_S)


def campaign(
    plan: _core.Plan, out: str | None, resume: bool, until: float | None, client: Any, progress: Report | None
) -> tuple[str, str, int]:
    """JSON, text and exit code of a campaign."""
    remote = out is not None and "://" in out
    if client is None and not remote:
        return plan.campaign(out, resume, until, None, progress)
    if client is not None and getattr(client, "asynchronous", False):
        raise InputError("E0001 client: it is asynchronous; give a client of Client(address)")
    # An interrupted task may still write.
    with TemporaryDirectory(prefix="poinsot-", ignore_cleanup_errors=True) as folder:
        place = out or folder
        store = _store(place, folder)
        if isinstance(store, Bucket):
            store.pull()
        printed = Engine(plan, place, store, client, progress).run(resume, until)
        if isinstance(store, Bucket):
            for name in ("campaign.json", "campaign.html"):
                store.put(name, Path(folder, name).read_bytes())
        return printed
