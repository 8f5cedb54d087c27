"""What a fit costs here and with SciPy and Numba, on the same recording. Usage: table.py HOST_PROGRAM RIG."""

import json
import resource
import subprocess
import sys
from pathlib import Path

RECORDING = Path(__file__).parent.parent.parent / "host/data/paper/reconstructed_recording_noisy.csv"
# The quickest of so many: others may be at work on the machine.
RUNS = 5


def cpu_seconds():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def ours(host, rig, method):
    best = None
    for _ in range(RUNS):
        before = cpu_seconds()
        command = [host, "fit", "--json", "--method", method, "--rig", rig, str(RECORDING)]
        found = json.loads(subprocess.run(command, capture_output=True, check=True, text=True).stdout)
        row = (found["seconds"], cpu_seconds() - before, found["rmse"])
        best = min(best or row, row)
    return best


def theirs():
    script = Path(__file__).parent / "scipy_numba.py"
    runs = [subprocess.run([sys.executable, script, str(RECORDING)], capture_output=True, check=True, text=True)
            for _ in range(RUNS)]
    return min((json.loads(run.stdout) for run in runs), key=lambda found: found["seconds"])


def main():
    host, rig = sys.argv[1:]
    squares, both, other = ours(host, rig, "least-squares"), ours(host, rig, "both"), theirs()
    print("| fit of the paper's recording | seconds | CPU seconds | error, mrad rms |\n|---|---:|---:|---:|")
    for name, (seconds, used, rmse) in (
        ("least squares", squares),
        ("response surfaces, then least squares", both),
        ("SciPy and Numba: least squares", (other["seconds"], other["cpu_seconds"], other["rmse"])),
    ):
        print(f"| {name} | {seconds:.3f} | {used:.3f} | {1e3 * rmse:.4f} |")
    print(f"\nSciPy and Numba take {other['seconds'] / squares[0]:.1f} times as long as least squares here; one swing "
          f"takes Numba {1e3 * other['swing_seconds']:.2f} ms and solve_ivp {1e3 * other['solve_ivp_swing_seconds']:.0f} ms.")


if __name__ == "__main__":
    main()
