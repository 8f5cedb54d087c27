#!/usr/bin/env python3
"""Writes one swing in the dress of many programs and countries: the files beside this one, and truth.csv.

The swing is integrated here (a pendulum of omega0^2 = 40 /s^2, let go at 1 rad, dry and viscous friction), so that the
truth does not come from the program that reads the files. Needs Python 3.9 and nothing else.
"""

import datetime
import io
import json
import math
import random
import struct
import zipfile
import zlib
from pathlib import Path

HERE = Path(__file__).parent
RATE = 50
SECONDS = 12


def swing(start=1.0, rate=RATE, seconds=SECONDS):
    """Times in s, angles in rad with 0.1 mrad of noise, angular velocities in rad/s."""
    chance = random.Random(7)
    angle, velocity = start, 0.0
    rows = []
    for k in range(rate * seconds):
        rows.append((k / rate, angle + chance.gauss(0, 1e-4), velocity + chance.gauss(0, 1e-3)))
        steps = 1000 // rate * 4
        dt = 1 / rate / steps
        for _ in range(steps):
            velocity += dt * (-40 * math.sin(angle) - 0.05 * velocity - 0.05 * math.copysign(1, velocity))
            angle += dt * velocity
    return rows


ROWS = swing()


def comma(number):
    return str(number).replace(".", ",")


def save(name, text, encoding="utf-8", newline="\n"):
    (HERE / name).write_bytes(text.replace("\n", newline).encode(encoding))


def table(name, head, row, rows=ROWS, **how):
    save(name, head + "".join(row(*values) + "\n" for values in rows), **how)


def deg(angle, digits=5):
    return f"{math.degrees(angle):.{digits}f}"


def grouped(number, digits, thousands, decimal):
    text = f"{number:,.{digits}f}"
    return text.replace(",", "\0").replace(".", decimal).replace("\0", thousands)


def phyphox():
    head = '"Time (s)","Gyroscope x (rad/s)","Gyroscope y (rad/s)","Gyroscope z (rad/s)","Absolute (rad/s)"\n'
    gyro = lambda t, a, w: f"{t:.9E},{w:.9E},{0.01:.9E},{-0.02:.9E},{abs(w):.9E}"
    table("phyphox_gyroscope.csv", head, gyro)
    archive("phyphox_gyroscope.zip", {
        "Raw Data.csv": (HERE / "phyphox_gyroscope.csv").read_text(),
        "meta/device.csv": '"property","value"\n"deviceModel","phone"\n',
        "meta/time.csv": '"event","experiment time","system time"\n"START",0.0,1772366400.0\n',
    })
    tilt = '"Time (s)","Tilt (deg)"\n'
    table("phyphox_tilt.csv", tilt, lambda t, a, w: f"{t:.9E},{math.degrees(a):.9E}")
    table("phyphox_semicolon.csv", tilt.replace(",", ";"), lambda t, a, w: f"{comma(f'{t:.9E}')};{comma(f'{math.degrees(a):.9E}')}")
    archive("phyphox_tilt.zip", {
        "Raw Data.csv": (HERE / "phyphox_tilt.csv").read_text(),
        "meta/device.csv": '"property","value"\n"deviceModel","phone"\n',
        "meta/time.csv": '"event","experiment time","system time"\n"START",0.0,1772366400.0\n',
    })
    archive("two_tables.zip", {"a.csv": "t,theta\n", "b.csv": "t,theta\n"})
    archive("workbook.xlsx", {"[Content_Types].xml": "<Types/>", "xl/workbook.xml": "<workbook/>"})


def archive(name, files):
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as out:
        for path, text in files.items():
            out.writestr(zipfile.ZipInfo(path, (2026, 3, 1, 12, 0, 0)), text, zipfile.ZIP_DEFLATED)
    (HERE / name).write_bytes(packed.getvalue())


def tracker():
    length = 0.25
    table("tracker_xy.txt", "mass_A\nt\tx\ty\n", lambda t, a, w: f"{t:.9E}\t{length * math.sin(a):.9E}\t{-length * math.cos(a):.9E}")
    table("xy_bare.txt", "", lambda t, a, w: f"{t:.9E}\t{length * math.sin(a):.9E}\t{-length * math.cos(a):.9E}")
    table("tracker_theta.txt", "mass_A\nt\tx\ty\tθ\n", lambda t, a, w: f"{t:.4f}\t{0.25 * math.sin(a):.6f}\t{-0.25 * math.cos(a):.6f}\t{a - math.pi / 2:.6f}")
    table("tracker_multi.txt", "#multi:\n\tmass A\t\t\n t\tθ_{r}\tv\t\n".replace(" t", "t"), lambda t, a, w: f"{t:.4f}\t{a:.6f}\t{'' if t == 0 else abs(w * 0.25):.6}\t")
    pixels = lambda t, a, w: f"{t:.4f},{320 + 180 * math.sin(a):.2f},{60 + 180 * math.cos(a):.2f}"
    table("pixels.csv", "time,x_px,y_px\n", pixels)
    squeezed = lambda t, a, w: f"{t:.4f},{320 + 126 * math.sin(a):.2f},{60 + 180 * math.cos(a):.2f}"
    table("pixels_slanting.csv", "time,x_px,y_px\n", squeezed, swing(1.4))
    short = lambda t, a, w: f"{t:.4f},{320 + 180 * math.sin(a):.0f},{60 + 180 * math.cos(a):.0f}"
    table("pixels_short_arc.csv", "time,x_px,y_px\n", short, swing(0.06))


def labview():
    head = (
        "LabVIEW Measurement\t\nWriter_Version\t2\nReader_Version\t2\nSeparator\tTab\nDecimal_Separator\t{mark}\n"
        "Multi_Headings\tNo\nX_Columns\t{x}\nTime_Pref\tRelative\nOperator\tlab\nDate\t2026/03/01\n"
        "Time\t12:00:00.000\n***End_of_Header***\t\n\t\nChannels\t1\t\nSamples\t600\t\nDate\t2026/03/01\t\n"
        "Time\t12:00:00.000\t\nY_Unit_Label\tdeg\t\nX_Dimension\tTime\t\nX0\t0.0000000000000000E+0\t\n"
        "Delta_X\t{step}\t\n***End_of_Header***\t\t\nX_Value\tAngle (deg)\tComment\n"
    )
    one = head.format(mark=".", x="One", step="0.020000")
    table("labview_one.lvm", one, lambda t, a, w: f"{t:.6f}\t{deg(a, 6)}", newline="\r\n")
    none = head.format(mark=",", x="No", step="0,020000")
    table("labview_no_x.lvm", none, lambda t, a, w: f"\t{comma(deg(a, 6))}", newline="\r\n")


def matlab():
    def element(kind, data):
        return struct.pack("<II", kind, len(data)) + data + b"\0" * (-len(data) % 8)

    def matrix(name, columns):
        rows = len(columns[0])
        numbers = b"".join(struct.pack(f"<{rows}d", *column) for column in columns)
        parts = [
            element(6, struct.pack("<II", 6, 0)),
            element(5, struct.pack("<ii", rows, len(columns))),
            element(1, name.encode()),
            element(9, numbers),
        ]
        return element(14, b"".join(parts))

    head = b"MATLAB 5.0 MAT-file, Platform: GLNXA64, Created on: Sun Mar  1 12:00:00 2026".ljust(124) + struct.pack("<HH", 0x0100, 0x4D49)
    times, angles = [row[0] for row in ROWS], [row[1] for row in ROWS]
    (HERE / "matlab_v6.mat").write_bytes(head + matrix("t", [times]) + matrix("theta", [angles]) + matrix("g", [[9.81]]))
    packed = b""
    for part in [matrix("t", [times]), matrix("theta_deg", [[math.degrees(a) for a in angles]])]:
        data = zlib.compress(part)
        packed += struct.pack("<II", 15, len(data)) + data
    (HERE / "matlab_v7.mat").write_bytes(head + packed)
    (HERE / "simulink.mat").write_bytes(head + simulink(element, matrix, times, angles))
    newer = b"MATLAB 7.3 MAT-file, Platform: GLNXA64, HDF5 schema 1.00 .".ljust(512) + b"\x89HDF\r\n\x1a\n" + bytes(100)
    (HERE / "matlab_v73.mat").write_bytes(newer)
    plain_matrices(head, element, matrix, times, angles)


def cells(element, name, texts):
    """One text a cell."""

    def array(kind, name, size, rest):
        parts = [element(6, struct.pack("<II", kind, 0)), element(5, struct.pack("<ii", *size)), element(1, name.encode())]
        return element(14, b"".join(parts) + rest)

    text = lambda text: array(4, "", (1, len(text)), element(16, text.encode()))
    return array(1, name, (1, len(texts)), b"".join(map(text, texts)))


def plain_matrices(head, element, matrix, times, angles):
    """A quantity a row below the head of Simulink's "To File"; a matrix without names, and one with names in
    cells; names beside others like them; and version 4."""
    to_file = b"MAT-file v.5".ljust(116, b"\0") + b" " * 8 + head[124:]
    (HERE / "matlab_to_file.mat").write_bytes(to_file + matrix("ans", [[t, a] for t, a in zip(times, angles)]))
    rates = [row[2] for row in ROWS]
    gains = matrix("K", [[k] for k in [1.5, 2.5, 3.5, 4.5]])
    (HERE / "matlab_matrix.mat").write_bytes(head + gains + matrix("data", [times, angles, rates]))
    others = matrix("timeTrigger", [[0.0, 1.0] * (len(times) // 2)]) + matrix("baseAngle", [[0.1 * a for a in angles]])
    (HERE / "matlab_names.mat").write_bytes(head + others + matrix("time", [times]) + matrix("angle", [angles]))
    data = matrix("data", [times, [0.1 * a for a in angles], angles])
    (HERE / "matlab_cells.mat").write_bytes(head + cells(element, "columns", ["time", "arm", "angle"]) + data)

    def old(name, columns, what):
        rows = len(columns[0])
        numbers = b"".join(struct.pack(f"{'>' if what >= 1000 else '<'}{rows}d", *column) for column in columns)
        return struct.pack(f"{'>' if what >= 1000 else '<'}5I", what, rows, len(columns), 0, len(name) + 1) + name.encode() + b"\0" + numbers

    (HERE / "matlab_v4.mat").write_bytes(old("t", [times], 0) + old("theta", [angles], 0))
    (HERE / "matlab_v4_big.mat").write_bytes(old("data", [times, angles], 1000))


def simulink(element, matrix, times, angles):
    """What a scope logs as "Structure With Time": time, and for each signal its values and label."""

    def letters(name, text):
        parts = [
            element(6, struct.pack("<II", 4, 0)),
            element(5, struct.pack("<ii", 1, len(text))),
            element(1, name.encode()),
            element(4, text.encode("utf-16-le")),
        ]
        return element(14, b"".join(parts))

    def structure(name, fields, entries):
        longest = 16
        parts = [
            element(6, struct.pack("<II", 2, 0)),
            element(5, struct.pack("<ii", 1, len(entries))),
            element(1, name.encode()),
            struct.pack("<HHi", 5, 4, longest),
            element(1, b"".join(field.encode().ljust(longest, b"\0") for field in fields)),
        ]
        return element(14, b"".join(parts) + b"".join(value for entry in entries for value in entry))

    def signal(values, label):
        return [matrix("", [values]), matrix("", [[1.0]]), letters("", label)]

    signals = structure("", ["values", "dimensions", "label"], [signal(angles, "theta"), signal([0.0] * len(times), "cart")])
    return structure("swing", ["time", "signals", "blockName"], [[matrix("", [times]), signals, letters("", "rig/Scope")]])


def json_files():
    table("lines.jsonl", "", lambda t, a, w: json.dumps({"time_ms": round(1e3 * t, 3), "angle_deg": round(math.degrees(a), 6)}))
    columns = {"device": "encoder", "t": [row[0] for row in ROWS], "theta": [round(row[1], 7) for row in ROWS]}
    save("arrays.json", json.dumps(columns))


def workbooks():
    """A sheet of readings beside one of what the phone is, as apps export them; a column stays empty, a name is shared."""
    cell = lambda place, number: f'<c r="{place}"><v>{number}</v></c>'
    rows = "".join(
        f'<row r="{k + 2}">{cell(f"A{k + 2}", f"{t:.3f}")}{cell(f"C{k + 2}", f"{math.degrees(a):.9E}")}</row>'
        for k, (t, a, w) in enumerate(ROWS)
    )
    names = '<row r="1"><c r="A1" t="s"><v>0</v></c><c r="C1" t="inlineStr"><is><t>Tilt (deg)</t></is></c></row>'
    sheet = lambda rows: f'<?xml version="1.0"?>\n<worksheet><sheetData>{rows}</sheetData></worksheet>'
    about = '<row r="1"><c r="A1" t="str"><v>version</v></c><c r="B1"><v>1.2</v></c></row>'
    files = [("Raw Data", sheet(names + rows)), ("Metadata Device", sheet(about))]
    relation = lambda k: f'<Relationship Id="rId{k}" Target="worksheets/sheet{k}.xml"/>'
    archive("workbook_tilt.xlsx", {
        "[Content_Types].xml": "<Types/>",
        "xl/workbook.xml": "<workbook><sheets>" + "".join(
            f'<sheet name="{name}" sheetId="{k}" r:id="rId{k}"/>' for k, (name, _) in enumerate(files, 1)
        ) + "</sheets></workbook>",
        "xl/_rels/workbook.xml.rels": f"<Relationships>{relation(1)}{relation(2)}</Relationships>",
        "xl/sharedStrings.xml": '<sst count="1"><si><t>Time (s)</t></si></sst>',
        **{f"xl/worksheets/sheet{k}.xml": text for k, (_, text) in enumerate(files, 1)},
    })


def older_workbook():
    """A workbook of Excel 97, as phyphox on Android exports its experiment "Pendulum": what was measured, and two sheets of what was made of it."""
    record = lambda kind, data: struct.pack("<HH", kind, len(data)) + data
    part = lambda what, data: record(0x809, struct.pack("<HH12x", 0x600, what)) + data + record(0x0A, b"")
    text = lambda row, column, idx: record(0xFD, struct.pack("<HHHI", row, column, 0, idx))
    number = lambda row, column, value: record(0x203, struct.pack("<HHHd", row, column, 0, value))

    def sheet(texts, rows):
        heads = b"".join(text(0, column, idx) for column, idx in enumerate(texts))
        return part(0x10, heads + b"".join(number(k, column, value) for k, row in enumerate(rows, 1) for column, value in enumerate(row)))

    others = [(k / 10, math.cos(k)) for k in range(40)]
    tilts = [(t, math.degrees(a)) for t, a, w in ROWS]
    sheets = {"Autocorrelation": sheet([0, 2], others), "Raw Data": sheet([0, 1], tilts), "Resonance": sheet([3, 2], others)}
    texts = ["Time (s)", "Tilt (deg)", "Autocorrelation", "Frequency (Hz)"]
    shared = b"".join(struct.pack("<HB", len(text), 0) + text.encode() for text in texts)
    shared = record(0xFC, struct.pack("<II", 6, len(texts)) + shared)

    def stream(begin):
        listed = b""
        for name, data in sheets.items():
            listed += record(0x85, struct.pack("<IHBB", begin, 0, len(name), 0) + name.encode())
            begin += len(data)
        return part(5, listed + shared) + b"".join(sheets.values())

    of_sheets = sum(len(data) for data in sheets.values())
    (HERE / "workbook_97.xls").write_bytes(compound("Workbook", stream(len(stream(0)) - of_sheets)))


def compound(name, stream):
    """A stream in a file of OLE2: the header, one sector of what follows what, the directory, and the stream."""
    n = -(-len(stream) // 512)
    assert 4096 <= len(stream) and n + 2 <= 128
    end, none = 0xFFFFFFFE, 0xFFFFFFFF
    entry = lambda name, kind, first, size: name.encode("utf-16-le").ljust(64, b"\0") + struct.pack("<HBB3I36xIQ", 2 * len(name) + 2, kind, 1, none, none, 1 if kind == 5 else none, first, size)
    follows = [0xFFFFFFFD, end] + list(range(3, n + 2)) + [end]
    header = b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1" + struct.pack("<16x5H6xIIIIIIIII", 0x3E, 3, 0xFFFE, 9, 6, 0, 1, 1, 0, 4096, end, 0, end, 0)
    directory = entry("Root Entry", 5, end, 0) + entry(name, 2, 2, len(stream))
    words = lambda numbers, count: struct.pack(f"<{count}I", *numbers, *[none] * (count - len(numbers)))
    return header + words([0], 109) + words(follows, 128) + directory.ljust(512, b"\0") + stream.ljust(512 * n, b"\0")


def arrays():
    """As numpy.save and numpy.savez write them."""
    def array(columns, shape):
        head = f"{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}"
        head = head.ljust(118 - 1) + "\n"
        data = b"".join(struct.pack("<d", number) for row in zip(*columns) for number in row)
        return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(head)) + head.encode() + data

    times, angles, n = [t for t, _, _ in ROWS], [a for _, a, _ in ROWS], len(ROWS)
    (HERE / "matrix.npy").write_bytes(array([times, angles], f"({n}, 2)"))
    archive("named.npz", {"t.npy": array([times], f"({n},)"), "theta.npy": array([angles], f"({n},)"), "g.npy": array([[9.81]], "()")})


def clocks():
    begin = datetime.datetime(2026, 3, 1, 12, 0, 0, 250000)
    at = lambda t: begin + datetime.timedelta(seconds=t)
    table("iso.csv", "timestamp,theta\n", lambda t, a, w: f"{at(t).isoformat(timespec='milliseconds')}Z,{a:.7f}")
    table("iso_space.txt", "", lambda t, a, w: f"{at(t).strftime('%Y-%m-%d %H:%M:%S.%f')} {a:.7f}")
    table("german_dates.csv", "Zeitpunkt;Winkel [Grad]\n", lambda t, a, w: f"{at(t).strftime('%d.%m.%Y %H:%M:%S')},{at(t).microsecond // 1000:03d};{comma(deg(a))}")
    late = datetime.datetime(2026, 3, 1, 23, 59, 55)
    table("midnight.csv", "Time,Angle (rad)\n", lambda t, a, w: f"{(late + datetime.timedelta(seconds=t)).strftime('%H:%M:%S.%f')[:-3]},{a:.7f}")
    table("epoch_ms.csv", "timestamp,theta\n", lambda t, a, w: f"{1772366400000 + 1000 * t:.0f},{a:.7f}")
    table("epoch_s.csv", "epoch,theta\n", lambda t, a, w: f"{1772366400 + t:.3f},{a:.7f}")


def numbers():
    table("quoted_commas.csv", '"Zeit (s)","Winkel (rad)"\n', lambda t, a, w: f'"{comma(f"{t:.3f}")}","{comma(f"{a:.7f}")}"')
    table("bare_commas.csv", "Zeit,Winkel\n", lambda t, a, w: f"{t:.3f},{a:.7f}".replace(".", ","))
    table("grad.csv", "Zeit [s];Winkel [Grad]\n", lambda t, a, w: f"{comma(f'{t:.3f}')};{comma(deg(a))}", encoding="latin-1")
    table("french.csv", "Temps (s);Angle (degrés);Vitesse angulaire (°/s)\n", lambda t, a, w: f"{comma(f'{t:.3f}')};{comma(deg(a))};{comma(deg(w))}")
    table("spanish.csv", "Tiempo [ms];Ángulo (°)\n", lambda t, a, w: f"{1000 * t:.0f};{comma(deg(a))}", encoding="utf-16")
    table("italian.csv", "Tempo (s)\tAngolo [gradi]\n", lambda t, a, w: f"{comma(f'{t:.3f}')}\t{comma(deg(a))}")
    table("thousands.csv", '"Time (ms)","Angle (rad)"\n', lambda t, a, w: f'"{grouped(1000 * t, 1, ",", ".")}","{a:.7f}"')
    table("thousands_german.csv", "Zeit (ms);Winkel (rad)\n", lambda t, a, w: f"{grouped(1000 * t, 1, '.', ',')};{comma(f'{a:.7f}')}")
    table("thousands_swiss.csv", "Zeit (ms);Winkel (rad)\n", lambda t, a, w: f"{grouped(1000 * t, 1, chr(39), '.')};{a:.7f}")
    hole = lambda text, t, every: text if round(t * RATE) % 97 != every else ""
    table("empty_cells.csv", "t,theta,remark\n", lambda t, a, w: f"{t:.3f},{hole(f'{a:.7f}', t, 5)},")
    table("nan_cells.csv", "t,theta\n", lambda t, a, w: f"{t:.3f},{hole(f'{a:.7f}', t, 5) or 'NaN'}")
    two = lambda t, a, w: f"{t:.3f},{a:.7f},{t + 0.007:.3f},{w:.5f}"
    table("two_time_bases.csv", "Time A (s),Angle (rad),Time B (s),Velocity (rad/s)\n", two)
    merged = "".join(f"{t:.3f},{a:.7f},\n{t + 0.007:.3f},,{w:.5f}\n" for t, a, w in ROWS)
    save("two_rates_merged.csv", "t,theta,omega\n" + merged)


def angles():
    table("from_horizontal.csv", "t,angle (deg)\n", lambda t, a, w: f"{t:.3f},{deg(a - math.pi / 2)}")
    table("from_upright.csv", "t,angle (rad)\n", lambda t, a, w: f"{t:.3f},{a + math.pi:.7f}")
    around = lambda angle, low: (angle - low) % (2 * math.pi) + low
    table("wrapped_180.csv", "t,angle (deg)\n", lambda t, a, w: f"{t:.3f},{deg(around(a + math.pi, -math.pi))}")
    table("wrapped_360.csv", "t,angle (deg)\n", lambda t, a, w: f"{t:.3f},{deg(around(a, 0))}")
    table("odd_zero.csv", "t,theta\n", lambda t, a, w: f"{t:.3f},{a + 0.7:.7f}")
    small = swing(math.radians(2))
    table("small_degrees.csv", "t,theta\n", lambda t, a, w: f"{t:.3f},{math.degrees(a):.6f}", swing(math.radians(3)))
    table("small_radians.csv", "t,theta\n", lambda t, a, w: f"{t:.3f},{a:.7f}", small)
    table("bare_gyroscope.csv", "", lambda t, a, w: f"{t:.3f},{w:.6f}")
    table("radians_named_degrees.csv", "t,angle (deg)\n", lambda t, a, w: f"{t:.3f},{a:.7f}")
    table("phi_punkt.csv", "t,phi_punkt\n", lambda t, a, w: f"{t:.3f},{w:.6f}")
    table("position_in_metres.csv", "Time (s),Position (m)\n", lambda t, a, w: f"{t:.3f},{0.25 * math.sin(a):.6f}")
    table("minutes_unsaid.csv", "t,theta\n", lambda t, a, w: f"{t / 60:.9f},{a:.7f}")
    table("milliseconds_unsaid.csv", "t,theta\n", lambda t, a, w: f"{1000 * t:.1f},{a:.7f}")


def main():
    table("truth.csv", "t,theta\n", lambda t, a, w: f"{t:.3f},{a:.9f}")
    for make in [phyphox, tracker, labview, matlab, json_files, workbooks, older_workbook, arrays, clocks, numbers, angles]:
        make()


main()
