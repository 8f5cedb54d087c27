"""Draws a recording: python3 plot.py swing.csv swing.svg

Needs Python 3 only. With pandas and matplotlib it is one line:
    pandas.read_csv("swing.csv", comment="#").plot(x="t", y="theta")
"""

import csv
import sys

WIDTH, HEIGHT, MARGIN = 900, 300, 40


def read(path):
    """Times in s and angles in rad; lines that begin with # are facts about the recording."""
    with open(path, newline="") as file:
        rows = csv.DictReader(line for line in file if not line.startswith("#"))
        return zip(*[(float(row["t"]), float(row["theta"])) for row in rows])


def svg(times, angles):
    span, peak = times[-1] - times[0], max(abs(angle) for angle in angles)
    x = [MARGIN + (WIDTH - 2 * MARGIN) * (t - times[0]) / span for t in times]
    y = [HEIGHT / 2 - (HEIGHT / 2 - MARGIN) * angle / peak for angle in angles]
    step = max(1, len(x) // 5000)
    points = " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(x[::step], y[::step]))
    return f"""<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH}" height="{HEIGHT}">
<rect width="100%" height="100%" fill="white"/>
<line x1="{MARGIN}" x2="{WIDTH - MARGIN}" y1="{HEIGHT / 2}" y2="{HEIGHT / 2}" stroke="silver"/>
<polyline points="{points}" fill="none" stroke="steelblue"/>
<text x="{MARGIN}" y="{MARGIN - 15}" font-family="sans-serif">{peak:.3f} rad</text>
<text x="{WIDTH - MARGIN}" y="{HEIGHT - 10}" text-anchor="end" font-family="sans-serif">{span:.1f} s</text>
</svg>
"""


def main():
    times, angles = read(sys.argv[1])
    with open(sys.argv[2], "w") as file:
        file.write(svg(times, angles))
    print(f"{len(times)} samples over {times[-1] - times[0]:.1f} s, up to {max(map(abs, angles)):.3f} rad")


main()
