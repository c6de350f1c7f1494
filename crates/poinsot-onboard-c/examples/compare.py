"""Compare what the example printed on the desktop and on the target, and print what the run took; the folder is the argument."""

import re
import struct
import sys
from pathlib import Path

FOLDER = Path(sys.argv[1])
NAMES = ("m", "mc_x", "mc_y", "mc_z", "I_xx", "I_xy", "I_yy", "I_xz", "I_yz", "I_zz")
# Relative difference of a number; bytes of stack.
LARGEST_DIFFERENCE, LARGEST_STACK, LARGEST_PROGRAM = 1.0e-9, 64 * 1024, 400_000


def packets(name: str) -> list[tuple[list[str], list[float]]]:
    """Words and numbers of each line of housekeeping."""
    lines = [line.split() for line in (FOLDER / name).read_text().splitlines() if not line.startswith("#")]
    return [(line[:3], [struct.unpack(">d", bytes.fromhex(x))[0] for x in line[3:]]) for line in lines]


def main() -> None:
    desktop, target = packets("desktop.txt"), packets("cortex_m7.txt")
    if [words for words, _ in desktop] != [words for words, _ in target]:
        sys.exit("health, determined numbers or refusals differ")
    worst = max(abs(a - b) / max(abs(a), 1e-300) for (_, x), (_, y) in zip(desktop, target) for a, b in zip(x, y))
    words, numbers = target[-1]
    print(f"{len(target)} lines of 10 values and 10 sigmas; at the end health {int(words[0], 16)} (1: determined), refused {int(words[2], 16)}")
    for k, name in enumerate(NAMES):
        print(f"  {name:5}{numbers[1 + 2 * k]:12.6f} +- {numbers[2 + 2 * k]:.6f}")
    took = dict(re.findall(r"^# (\w+) (\d+)$", (FOLDER / "cortex_m7.txt").read_text(), re.MULTILINE))
    sections = dict(re.findall(r"^(\.\w+) +(\d+)", (FOLDER / "size.txt").read_text(), re.MULTILINE))
    record = (FOLDER / "flight.bin").stat().st_size + (FOLDER / "filter.bin").stat().st_size
    program = int(sections[".text"]) - record
    rows = {
        "largest relative difference from the desktop": f"{worst:.1e}",
        "filter, bytes": took["filter_bytes"],
        "static memory, bytes": int(sections[".data"]) + int(sections[".bss"]),
        "stack, most bytes": took["stack_bytes"],
        "program and constants without the record, bytes": program,
        "instructions of a sample after the window, mean": took["push_mean"],
        "instructions of a sample after the window, most": took["push_most"],
        "instructions of the sample that replays the window": took["push_replay"],
        "instructions of an answer, most": took["read_most"],
    }
    for name, value in rows.items():
        print(f"{name:52}{value:>14}")
    if desktop[-1][0][:2] != ["00000001", "000003ff"]:
        sys.exit("not all ten numbers are determined at the end")
    if worst > LARGEST_DIFFERENCE or int(took["stack_bytes"]) > LARGEST_STACK:
        sys.exit(f"more than {LARGEST_DIFFERENCE} or {LARGEST_STACK} bytes of stack")
    if program > LARGEST_PROGRAM:
        sys.exit(f"more than {LARGEST_PROGRAM} bytes of program: does it hold an idle filter, whose bits are all zero?")


if __name__ == "__main__":
    main()
