#!/usr/bin/env python3
"""Do the tests notice errors? Changes the code in a seeded sample of places, one at a time, and runs the tests that
guard it; tells the share they caught with its 95 % interval, and every change that survived.

In: names of folders of tests/mutants/folders.json, all without one; MUTANTS is the size of a sample (150), SEED chooses
another one (1), MUTANTS_PROFILE another profile of cargo. Fails where fewer than 90 % are caught, or where a survivor
has no line in tests/mutants/survivors.txt that says why it may live.
"""

import json
import math
import os
import random
import subprocess
import sys
from pathlib import Path

TREE = Path(__file__).resolve().parents[2]
BUILT = Path(os.environ.get("CARGO_TARGET_DIR", TREE / "target"))
OUTPUT = BUILT / "mutants"
N_WANTED = int(os.environ.get("MUTANTS", 150))
SEED = int(os.environ.get("SEED", 1))
PROFILE = os.environ.get("MUTANTS_PROFILE", "mutants")
LEAST_CAUGHT = 0.9

# A change may make a loop endless; this long, or ten times as long as all tests take, is endless.
PATIENCE_S = 60

# Deviation of a 95 % interval.
Z = 1.96


def main():
    folders = json.loads((TREE / "tests/mutants/folders.json").read_text())
    chosen = sys.argv[1:] or list(folders)
    reasons = known_survivors()
    results = [judge(name, folders[name], reasons) for name in chosen]
    print()
    for line, _ in results:
        print(line)
    sys.exit(0 if all(good for _, good in results) else 1)


def judge(name, folder, reasons):
    """Runs a folder's sample; gives a line for people and whether it is good enough."""
    mutants = listed(folder)
    sample = random.Random(SEED).sample(mutants, min(N_WANTED, len(mutants)))
    left, n_viable = sample, len(sample)
    for stage, tests in enumerate(folder["tests"]):
        left, unviable = run(f"{name}-{stage}", folder, left, tests)
        n_viable -= len(unviable)
        if not left:
            break
    n_caught = n_viable - len(left)
    low, high = wilson(n_caught, n_viable)
    unexplained = [mutant for mutant in left if nameless(mutant) not in reasons]
    for mutant in left:
        print(f"   survived: {mutant}: {reasons.get(nameless(mutant), 'NO REASON in tests/mutants/survivors.txt')}")
    share = n_caught / max(n_viable, 1)
    line = (
        f"{name}: {n_caught} of {n_viable} caught, {100 * share:.0f} % ({100 * low:.0f}–{100 * high:.0f} %), "
        f"of a sample of {len(sample)} from {len(mutants)}; {len(unexplained)} survivors without a reason"
    )
    return line, share >= LEAST_CAUGHT and not unexplained


def listed(folder):
    files = [part for pattern in folder["files"] for part in ("--file", pattern)]
    command = ["cargo", "mutants", "--list", "--json", "--package", folder["package"], *files]
    found = json.loads(subprocess.run(command, cwd=TREE, check=True, capture_output=True, text=True).stdout)
    return sorted(mutant["name"] for mutant in found)


def run(label, folder, mutants, tests):
    """Runs some tests on some mutants; gives those that no test noticed, and those that do not compile."""
    output = OUTPUT / label
    output.mkdir(parents=True, exist_ok=True)
    chosen = [part for mutant in mutants for part in ("--re", f"^{escaped(mutant)}$")]
    # It also takes fields out of structures, whatever was chosen; less so of fewer files.
    files = [f"--file={file}" for file in sorted({mutant.split(":")[0] for mutant in mutants})]
    # Not by --test-package: what is not changed would be tried with the tests of the changed package alone.
    packages = [f"--cargo-arg=--package={package}" for package in tests["packages"]]
    command = ["cargo", "mutants", "--no-shuffle", "--colors=never", "--profile", PROFILE, "--output", output]
    command += ["--package", folder["package"], *files, *packages, *chosen]
    command += ["--timeout-multiplier=10", f"--minimum-test-timeout={PATIENCE_S}"]
    # What is built as well as what is run; all tests would be built otherwise.
    command += [f"--cargo-arg={part}" for part in tests["arguments"] if part.startswith("--")]
    command += ["--", *(part for part in tests["arguments"] if not part.startswith("--"))]
    code = subprocess.run(command, cwd=TREE, env=environment()).returncode
    # 2: some were missed; 3: some took too long.
    if code not in (0, 2, 3):
        sys.exit(f"cargo mutants ended with {code}; see {output}/mutants.out")
    said = [(output / f"mutants.out/{kind}.txt").read_text().splitlines() for kind in ("missed", "unviable")]
    return [[mutant for mutant in kind if mutant in mutants] for kind in said]


def environment():
    # Built apart, because the profile and the changes would rebuild everything each time.
    return {**os.environ, "CARGO_TARGET_DIR": str(OUTPUT / "target")}


def escaped(text):
    """For Rust's regular expressions, where \\< and \\> mean something."""
    return "".join("\\" + letter if letter in r"\.+*?()|[]{}^$" else letter for letter in text)


def nameless(mutant):
    """Without line and column, which change with every edit."""
    file, _, _, what = mutant.split(":", 3)
    return f"{file}:{what}"


def known_survivors():
    """Lines of survivors.txt: FILE: CHANGE | REASON."""
    lines = (TREE / "tests/mutants/survivors.txt").read_text().splitlines()
    pairs = [line.split(" | ", 1) for line in lines if line and not line.startswith("#")]
    return {mutant: reason for mutant, reason in pairs}


def wilson(n_hits, n_tries):
    """E. B. Wilson, J. Am. Stat. Assoc. 22 (1927) 209."""
    if n_tries == 0:
        return 0.0, 1.0
    share, weight = n_hits / n_tries, Z * Z / n_tries
    middle = (share + weight / 2) / (1 + weight)
    half = Z * math.sqrt(share * (1 - share) / n_tries + weight / (4 * n_tries)) / (1 + weight)
    return middle - half, middle + half


main()
