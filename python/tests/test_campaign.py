"""Campaigns beyond one machine: object stores, and the workers of Dask, killed at their work.

The scheduler and two workers are processes that talk over TCP on loopback.
"""

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

import poinsot as pn

fsspec = pytest.importorskip("fsspec", reason="fsspec is missing: pip install 'poinsot[fsspec]'")

# Longest wait for a process to start, a shard to be written, a campaign to end, s.
PATIENCE_S = 120.0
# Time between two checks, s: well below that of a shard.
POLL_S = 0.02
TRIALS, BLOCK, CELLS = 12, 1, 2
PLAN = f"""schema = "poinsot.plan/1"
name = "small"
trials = {TRIALS}
trials_per_shard = {BLOCK}

[[experiment]]
case = "cases/tug_thrusters.toml"
every = 20

[[vary]]
number = "noise"
values = [1.0, 2.0]
"""


@pytest.fixture(scope="module")
def plan(root, tmp_path_factory):
    """A plan of cheap trials in a folder, its case in another."""
    folder = tmp_path_factory.mktemp("plan")
    (folder / "cases").mkdir()
    for name in ("tug_thrusters.toml", "tug_truth.toml"):
        shutil.copy(root / "data/cases" / name, folder / "cases" / name)
    (folder / "plan.toml").write_text(PLAN)
    return folder / "plan.toml"


def untimed(document) -> dict:
    """The result without times, which differ between runs."""
    values = json.loads(json.dumps(dict(document)))
    values.pop("sha256", None)
    for cell in values["cells"]:
        for method in cell["methods"]:
            method["seconds_per_trial"] = None
    return values


@pytest.fixture(scope="module")
def whole(plan):
    return untimed(pn.campaign(plan))


def wait(until, what: str) -> None:
    begun = time.monotonic()
    while not until():
        assert time.monotonic() - begun < PATIENCE_S, f"no {what}"
        time.sleep(POLL_S)


def end(*processes: subprocess.Popen) -> None:
    for process in processes:
        process.kill()
        process.wait()


class Cluster:
    """A scheduler and workers of one thread, each a process; a worker that dies is not started again."""

    def __init__(self, folder: Path, workers: int = 2) -> None:
        folder.mkdir()
        self.file, self.folder = folder / "scheduler.json", folder
        self.scheduler = self._start("scheduler", "--scheduler-file", str(self.file))
        wait(self.file.exists, "scheduler")
        words = ["worker", "--scheduler-file", str(self.file), "--nthreads", "1", "--no-nanny", "--local-directory"]
        self.workers = [self._start(*words, str(folder / f"worker{k}")) for k in range(workers)]

    def _start(self, kind: str, *words: str) -> subprocess.Popen:
        command = [sys.executable, "-m", "distributed.cli.dask_" + kind, "--host", "127.0.0.1", "--no-dashboard", *words]
        command += ["--port", "0"] if kind == "scheduler" else []
        with (self.folder / f"{kind}.log").open("a") as log:
            return subprocess.Popen(command, stdout=log, stderr=log)

    def client(self):
        client = pytest.importorskip("distributed").Client(scheduler_file=str(self.file), timeout="60s")
        client.wait_for_workers(len(self.workers), timeout=PATIENCE_S)
        return client

    def end(self) -> None:
        end(*self.workers, self.scheduler)


@pytest.fixture
def cluster(tmp_path):
    pytest.importorskip("distributed", reason="Dask is missing: pip install 'poinsot[dask]'")
    made = Cluster(tmp_path / "cluster")
    yield made
    made.end()


def shards(out: Path) -> list[Path]:
    return sorted(out.glob("shards/*/*.json"))


@pytest.mark.parametrize("protocol", ["memory", "file"])
def test_exact_object_stores_give_the_bits_of_a_folder(plan, whole, tmp_path, protocol):
    """Run into a store, lose a shard, cut one, and resume: the same bits, with the rows in the store."""
    url = f"{protocol}://{tmp_path}/run"
    store, root = fsspec.core.url_to_fs(url)
    assert untimed(pn.campaign(plan, out=url)) == whole
    assert untimed(json.loads(store.cat_file(f"{root}/campaign.json"))) == whole
    files = sorted(store.find(f"{root}/shards"))
    rows = [f for f in files if f.endswith(".parquet")]
    assert len(rows) == TRIALS // BLOCK * CELLS and all(store.size(f) > 0 for f in rows)
    with pytest.raises(pn.InputError, match="E0602 .*run: .*exist already"):
        pn.campaign(plan, out=url)
    store.rm(rows[1])
    store.pipe_file(files[0], store.cat_file(files[0])[:-40])
    assert untimed(pn.campaign(plan, out=url, resume=True)) == whole
    assert all(store.exists(f) for f in files)


def test_exact_workers_give_the_bits_of_one_machine(plan, whole, cluster, tmp_path):
    """With a shared folder, without a folder, and with a store that the workers do not see; until as the command."""
    told = []
    with cluster.client() as client:
        assert untimed(pn.campaign(plan, out=tmp_path / "out", client=client, progress=lambda *s: told.append(s))) == whole
        assert len(shards(tmp_path / "out")) == TRIALS // BLOCK * CELLS
        assert told[-1] == ("shards", TRIALS // BLOCK * CELLS, TRIALS // BLOCK * CELLS)
        assert untimed(pn.campaign(plan, client=client)) == whole
        url = f"memory://{tmp_path}/unseen"
        assert untimed(pn.campaign(plan, out=url, client=client)) == whole
        assert len(fsspec.filesystem("memory").glob(f"{tmp_path}/unseen/shards/*/*.parquet")) == TRIALS // BLOCK * CELLS
        swept = {"trials": 4, "seed": 3, "client": client}
        case = plan.parent / "cases/tug_thrusters.toml"
        ours = pn.sweep(case, {"noise": [1, 2]}, **swept)
        assert untimed(ours) == untimed(pn.sweep(case, {"noise": [1, 2]}, **(swept | {"client": None})))


def test_exact_an_error_of_the_callers_progress_is_his_own(plan, cluster, tmp_path):
    def refuse(stage: str, done: int, total: int) -> None:
        raise LookupError("mine")

    with cluster.client() as client, pytest.raises(LookupError, match="mine"):
        pn.campaign(plan, out=tmp_path / "out", client=client, progress=refuse)


def test_unit_an_address_without_a_store_is_an_error_of_ours(plan):
    with pytest.raises(pn.ResourceError, match="E0002 nowhere://host/run: "):
        pn.campaign(plan, out="nowhere://user:secret@host/run")


def test_exact_a_killed_worker_loses_nothing(plan, whole, cluster, tmp_path):
    def kill(stage: str, done: int, total: int) -> None:
        if cluster.workers[0].poll() is None and done * 4 >= total:
            cluster.workers[0].kill()

    with cluster.client() as client:
        assert untimed(pn.campaign(plan, out=tmp_path / "out", client=client, progress=kill)) == whole
    assert cluster.workers[0].wait() == -signal.SIGKILL


def test_exact_a_killed_scheduler_is_named_and_resumed(plan, whole, cluster, tmp_path):
    def kill(stage: str, done: int, total: int) -> None:
        cluster.scheduler.kill()

    distributed = pytest.importorskip("distributed")
    client = distributed.Client(scheduler_file=str(cluster.file), timeout="5s")
    client.wait_for_workers(2, timeout=PATIENCE_S)
    with pytest.raises(pn.ResourceError, match="E0002 .*resume=True"):
        pn.campaign(plan, out=tmp_path / "out", client=client, progress=kill)
    client.close(timeout=1)
    begun = len(shards(tmp_path / "out"))
    assert 0 < begun < TRIALS // BLOCK * CELLS
    again = Cluster(tmp_path / "again")
    try:
        with again.client() as client:
            assert untimed(pn.campaign(plan, out=tmp_path / "out", client=client, resume=True)) == whole
    finally:
        again.end()


DRIVER = """
import signal, sys
import poinsot as pn
from distributed import Client
# A shell has its background jobs ignore the signal, and Python then leaves it ignored.
signal.signal(signal.SIGINT, signal.default_int_handler)
plan, out, scheduler = sys.argv[1:]
pn.campaign(plan, out=out, client=Client(scheduler_file=scheduler))
"""


def test_exact_a_killed_driver_and_scheduler_are_resumed(plan, whole, cluster, tmp_path):
    """The driver and the scheduler are killed at once; another cluster runs what is missing."""
    out = tmp_path / "out"
    words = [sys.executable, "-c", DRIVER, str(plan), str(out), str(cluster.file)]
    driver = subprocess.Popen(words, stderr=subprocess.DEVNULL)
    wait(lambda: len(shards(out)) > 2 or driver.poll() is not None, "shard")
    assert driver.poll() is None, "the driver ended before it was killed"
    end(driver, cluster.scheduler)
    again = Cluster(tmp_path / "again")
    try:
        with again.client() as client:
            assert untimed(pn.campaign(plan, out=out, client=client, resume=True)) == whole
    finally:
        again.end()


@pytest.mark.skipif(os.name == "nt", reason="sends SIGINT")
def test_exact_an_interrupted_driver_cancels_its_tasks(plan, whole, cluster, tmp_path):
    out = tmp_path / "out"
    words = [sys.executable, "-c", DRIVER, str(plan), str(out), str(cluster.file)]
    driver = subprocess.Popen(words, stderr=subprocess.PIPE, text=True)
    wait(lambda: len(shards(out)) > 0 or driver.poll() is not None, "shard")
    driver.send_signal(signal.SIGINT)
    said = driver.communicate(timeout=PATIENCE_S)[1]
    assert driver.returncode != 0 and "KeyboardInterrupt" in said
    with cluster.client() as client:
        wait(lambda: client.run_on_scheduler(lambda dask_scheduler: len(dask_scheduler.tasks)) == 0, "end of the tasks")
        assert untimed(pn.campaign(plan, out=out, client=client, resume=True)) == whole
