"""What the benchmarks share: programs, their lines of `name,value,unit`, and ratios of them."""
import json
import os
import pathlib
import shutil
import subprocess

ROOT = pathlib.Path(__file__).resolve().parent.parent
ALONE = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
BUILD = ["cargo", "build", "--quiet", "--locked", "--release", "--workspace"]


def stdout(command, **environment):
    """Standard output of a program that must succeed, in the repository, its linear algebra on one thread."""
    where = {"cwd": ROOT, "env": os.environ | ALONE | environment}
    return subprocess.run([str(c) for c in command], check=True, stdout=subprocess.PIPE, text=True, **where).stdout


def pinned(command):
    """The command on one core, where the system can."""
    core = os.environ.get("POINSOT_BENCH_CORE", "0")
    return ["taskset", "-c", core, *command] if shutil.which("taskset") else command


def example(name, root=ROOT):
    """An example program, built with the features of the tests."""
    subprocess.run([*BUILD, "--example", name], check=True, cwd=root)
    return pathlib.Path(root) / "target/release/examples" / name


def bench(name, root=ROOT):
    """A benchmark program, built with the features of the tests."""
    build = ["cargo", "bench", "--quiet", "--locked", "--workspace", "--bench", name, "--no-run", "--message-format=json"]
    said = subprocess.run(build, check=True, stdout=subprocess.PIPE, text=True, cwd=root).stdout
    built = [json.loads(line).get("executable") for line in said.splitlines() if line.startswith("{")]
    return next(path for path in reversed(built) if path and pathlib.Path(path).name.startswith(name + "-"))


class Figures:
    """Best values by name and unit: of times and counts the least, of speeds the largest."""

    def __init__(self, quiet=False):
        self.best, self.quiet = {}, quiet

    def show(self, lines):
        if not self.quiet:
            print(lines, end="", flush=True)
        for line in lines.splitlines():
            match line.split(","):
                case [name, value, unit]:
                    try:
                        value = float(value)
                    except ValueError:
                        continue
                    better = max if unit.endswith("_per_s") else min
                    self.best[name, unit] = better(value, self.best.get((name, unit), value))

    def ratio(self, ours, peer, unit):
        """How many times as fast as the peer; None where one is missing."""
        a, b = self.best.get((ours, unit)), self.best.get((peer, unit))
        if a is None or b is None:
            return None
        return a / b if unit.endswith("_per_s") else b / a
