"""Instructions of steps and fits, counted by callgrind, against those that are kept in instructions.txt.

A clock tells of the neighbours, a count does not: with one thread the same program executes the same instructions.
Usage: counted.py STEPS_PROGRAM HOST_PROGRAM RIG; KEEP=1 writes the counts down instead of judging them. HOST_PROGRAM
may be - to count steps alone.
"""

import os
import re
import subprocess
import sys
from pathlib import Path

FOLDER = Path(__file__).parent
KEPT = FOLDER / "instructions.txt"
DATA = FOLDER.parent.parent / "host/data"
# Other versions of libraries cost some instructions; a change of the physics or of a fit's way costs more.
ALLOWED = 1.03
STEPS = (1000, 3000)
EFFECTS = ("base", "quadratic-drag", "stribeck", "power-law-drag", "detent", "presliding", "drifting-friction")


def instructions(command):
    valgrind = ["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null"]
    environment = {**os.environ, "RAYON_NUM_THREADS": "1"}
    run = subprocess.run(valgrind + command, capture_output=True, text=True, env=environment)
    found = re.search(r"Collected : (\d+)", run.stderr)
    if run.returncode != 0 or not found:
        sys.exit(f"{' '.join(command)} failed under valgrind:\n{run.stderr[-2000:]}")
    return int(found[1])


def counts(steps, host, rig):
    few, many = STEPS
    for effect in EFFECTS:
        cost = [instructions([steps, effect, str(n)]) for n in STEPS]
        yield f"step {effect}", round((cost[1] - cost[0]) / (many - few))
    if host == "-":
        return
    paper = str(DATA / "paper/reconstructed_recording_noisy.csv")
    for method in ("least-squares", "both"):
        yield f"fit {method}", instructions([host, "fit", "--json", "--method", method, "--rig", rig, paper])


def main():
    steps, host, rig = sys.argv[1:]
    lines = KEPT.read_text().splitlines() if KEPT.exists() else []
    kept = {name: int(count) for name, count in (line.rsplit(" ", 1) for line in lines)}
    failed = False
    for name, count in counts(steps, host, rig):
        before = kept.get(name)
        change = f"{100 * (count / before - 1):+.1f} %" if before else "new"
        print(f"{name:28} {count:>14,} {change}", flush=True)
        failed |= before is None or count > ALLOWED * before
        kept[name] = count
    if os.environ.get("KEEP"):
        KEPT.write_text("".join(f"{name} {count}\n" for name, count in kept.items()))
    elif failed:
        sys.exit(f"more instructions than in {KEPT.name}: find out why; KEEP=1 tests/more speed keeps new counts")


if __name__ == "__main__":
    main()
