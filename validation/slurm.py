#!/usr/bin/env python3
"""Run the scripts of `poinsot campaign --emit slurm` by a real Slurm of one node, and compare with an undisturbed run.

usage: scripts/slurm [--poinsot target/release/poinsot]

Needs munged, slurmctld and slurmd (Debian: munge, slurmctld, slurmd, slurm-client) and the right to start them: root.
They run without systemd, in a folder of their own, on loopback, and end with this script. Where a program is missing, the
script says so and ends with exit code 0. One task is requeued at its work, one is killed, and the array is submitted again.
"""

import argparse
import json
import os
import re
import secrets
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
NEEDED = ("munged", "slurmctld", "slurmd", "sbatch", "squeue", "scontrol", "sinfo")
# Longest wait for a daemon to start, and for the campaign to end, s.
PATIENCE_S = 300
# A task lasts some seconds, so that a requeue and a kill meet it at work.
PLAN = """schema = "poinsot.plan/1"
name = "slurm"
trials = 60
trials_per_shard = 10

[[experiment]]
case = "tug_thrusters.toml"
"""
CONF = """ClusterName=poinsot
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={controller}
SlurmdPort={daemon}
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
CommunicationParameters=NoInAddrAny,NoCtldInAddrAny
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
MpiDefault=none
AccountingStorageType=accounting_storage/none
JobAcctGatherType=jobacct_gather/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
ReturnToService=2
KillWait=1
SchedulerParameters=bf_interval=1,sched_interval=1
NodeName={host} NodeAddr=127.0.0.1 CPUs={cores} State=UNKNOWN
PartitionName=all Nodes={host} Default=YES MaxTime=INFINITE State=UP
"""


def free_port() -> int:
    with socket.socket() as server:
        server.bind(("127.0.0.1", 0))
        return server.getsockname()[1]


def wait(until, what: str) -> None:
    begun = time.monotonic()
    while not until():
        if time.monotonic() - begun > PATIENCE_S:
            sys.exit(f"{what} did not happen within {PATIENCE_S} s")
        time.sleep(0.2)


def result(out: Path) -> dict:
    """The result without times, which differ between runs."""
    values = json.loads((out / "campaign.json").read_text())
    for cell in values["cells"]:
        for method in cell["methods"]:
            method["seconds_per_trial"] = None
    return values


class Slurm:
    """Munge, controller and daemon in a folder, in the foreground."""

    def __init__(self, folder: Path) -> None:
        self.folder, self.running = folder, []
        for name in ("state", "spool"):
            (folder / name).mkdir()
        key = folder / "munge.key"
        key.write_bytes(secrets.token_bytes(128))
        key.chmod(0o600)
        host = socket.gethostname().split(".")[0]
        ports = {"controller": free_port(), "daemon": free_port()}
        conf = folder / "slurm.conf"
        conf.write_text(CONF.format(host=host, folder=folder, cores=os.cpu_count(), **ports))
        (folder / "cgroup.conf").write_text("")
        self.environment = dict(os.environ, SLURM_CONF=str(conf))
        of = {"key-file": key, "socket": "munge.socket", "pid-file": "munge.pid", "seed-file": "munge.seed"}
        words = [f"--{name}={folder / value}" for name, value in of.items()]
        self.start("munged", "--foreground", "--force", f"--log-file={folder}/munge.log", *words)
        wait((folder / "munge.socket").exists, "the start of munged")
        self.start("slurmctld", "-D", "-c")
        self.start("slurmd", "-D")
        wait(lambda: self.ask("sinfo", "-h", "-o", "%t") == "idle", "an idle node")

    def start(self, *words: str) -> None:
        with (self.folder / f"{words[0]}.out").open("w") as log:
            self.running.append(subprocess.Popen(words, env=self.environment, stdout=log, stderr=log))

    def ask(self, *words: str) -> str:
        return subprocess.run(words, env=self.environment, capture_output=True, text=True).stdout.strip()

    def end(self) -> None:
        for process in reversed(self.running):
            process.send_signal(signal.SIGTERM)
            process.wait(timeout=PATIENCE_S)


def run(program: str, folder: Path, slurm: Slurm) -> None:
    for name in ("tug_thrusters.toml", "tug_truth.toml"):
        shutil.copy(ROOT / "data/cases" / name, folder / name)
    (folder / "plan.toml").write_text(PLAN)
    words = [program, "campaign", "plan.toml", "--quiet", "--out"]
    subprocess.run([*words, "whole"], cwd=folder, check=True)
    subprocess.run([*words, "out", "--emit", "slurm"], cwd=folder, check=True)
    (folder / "bin").mkdir()
    (folder / "bin/poinsot").symlink_to(program)
    environment = dict(slurm.environment, PATH=f"{folder / 'bin'}:{os.environ['PATH']}")
    begun = time.monotonic()
    logs = f"--output={folder}/job%A_%a.log"

    def submit() -> tuple[str, str]:
        """The jobs: array and merge."""
        words = ["sh", "out/slurm/submit.sh", "--time=10", logs]
        said = subprocess.run(words, cwd=folder, env=environment, capture_output=True, text=True)
        if said.returncode != 0:
            sys.exit(f"sbatch refused: {said.stderr.strip()}")
        merge = int(re.findall(r"\d+", said.stdout)[-1])
        return str(merge - 1), str(merge)

    def state(job: str) -> str:
        return slurm.ask("squeue", "-h", "-j", job, "-o", "%T %r")

    array, merge = submit()
    wait(lambda: state(f"{array}_1").startswith("RUNNING"), "the start of the first task")
    slurm.ask("scontrol", "requeue", f"{array}_1")
    wait(lambda: state(f"{array}_2").startswith("RUNNING"), "the start of the second task")
    slurm.ask("scancel", "--signal=KILL", "--full", f"{array}_2")
    # The merge waits for success of every task, and the second one failed: the scripts are submitted again.
    wait(lambda: not state(array) and "NeverSatisfied" in state(merge), "the end of the array")
    again = re.search(r"Restarts=(\d+)", slurm.ask("scontrol", "-o", "show", "job", f"{array}_1"))
    slurm.ask("scancel", merge)
    array, merge = submit()
    wait(lambda: not state(merge), "the end of the merge")
    if result(folder / "out") != result(folder / "whole"):
        sys.exit("the result of Slurm is not that of an undisturbed run")
    if again is None or again[1] == "0":
        sys.exit("no task was requeued")
    print(
        f"{slurm.ask('sinfo', '--version')}: six tasks and a merge, one task requeued, one killed and submitted again, "
        f"equal to an undisturbed run; {time.monotonic() - begun:.0f} s"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--poinsot", default="target/release/poinsot")
    program = str(Path(parser.parse_args().poinsot).resolve())
    missing = [name for name in NEEDED if shutil.which(name) is None]
    if missing or os.geteuid() != 0:
        print(f"skipped: {', '.join(missing) or 'not root'}")
        return
    with tempfile.TemporaryDirectory(prefix="poinsot-slurm-") as name:
        folder = Path(name)
        slurm = None
        try:
            (folder / "slurm").mkdir()
            slurm = Slurm(folder / "slurm")
            run(program, folder, slurm)
        finally:
            if slurm is not None:
                slurm.end()


if __name__ == "__main__":
    main()
