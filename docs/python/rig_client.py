"""Talks to the rig: python3 rig_client.py /dev/ttyACM0

Prints who answers, then a second of angles. Needs Python 3 only, on Linux or macOS. The messages are explained in
docs/protocol.md.
"""

import os
import select
import struct
import sys
import termios
import time
import tty

HELLO, COMMAND, ANSWER, SAMPLES = 0, 1, 2, 3
START, STOP, GET_SETTINGS = 0, 1, 7
DONE, REFUSED, SETTINGS = 0, 1, 3
PROTOCOL = 1


def crc32c(data):
    """CRC-32/ISCSI, bit by bit."""
    crc = 0xFFFFFFFF
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = crc >> 1 ^ (0x82F63B78 if crc & 1 else 0)
    return crc ^ 0xFFFFFFFF


def stuff(data):
    """Consistent overhead byte stuffing: no zero byte is left."""
    out = bytearray()
    for run in data.split(b"\0"):
        while len(run) >= 254:
            out += b"\xff" + run[:254]
            run = run[254:]
        out += bytes([len(run) + 1]) + run
    return bytes(out)


def unstuff(data):
    out = bytearray()
    while data:
        length = data[0]
        out += data[1:length]
        data = data[length:]
        if data and length < 255:
            out.append(0)
    return bytes(out)


def varint(number):
    out = bytearray()
    while number >= 128:
        out.append(number & 127 | 128)
        number >>= 7
    return bytes(out + bytes([number]))


class Reader:
    """Takes the values of a message one by one."""

    def __init__(self, data):
        self.data, self.at = data, 0

    def take(self, length):
        self.at += length
        return self.data[self.at - length : self.at]

    def varint(self):
        number = shift = 0
        while True:
            byte = self.take(1)[0]
            number |= (byte & 127) << shift
            shift += 7
            if byte < 128:
                return number

    def f32(self):
        return struct.unpack("<f", self.take(4))[0]

    def text(self):
        return self.take(self.varint()).decode()


class Rig:
    def __init__(self, port):
        self.port = os.open(port, os.O_RDWR | os.O_NOCTTY)
        tty.setraw(self.port, termios.TCSANOW)
        attributes = termios.tcgetattr(self.port)
        # For a rig on a UART; USB ignores it, and some systems have no name for it.
        attributes[4] = attributes[5] = getattr(termios, "B921600", attributes[5])
        termios.tcsetattr(self.port, termios.TCSANOW, attributes)
        self.unread, self.number = b"", 0
        os.write(self.port, b"\0")
        hello = bytes([HELLO]) + b"PNDL" + varint(PROTOCOL) + varint(0) + bytes([0, 1, 0]) + varint(6) + b"python"
        for _ in range(8):
            self.send(hello)
            answer = self.wait_for(HELLO, 0.5)
            if answer and answer.take(4) == b"PNDL":
                break
        else:
            raise SystemExit(f"no rig answers on {port}")
        protocol, _, version = answer.varint(), answer.varint(), answer.take(3)
        self.name = f"{answer.text()} {'.'.join(map(str, version))}"
        if protocol != PROTOCOL:
            raise SystemExit(f"{self.name} speaks protocol {protocol}, this program {PROTOCOL}")

    def send(self, message):
        os.write(self.port, stuff(message + struct.pack("<I", crc32c(message))) + b"\0")

    def frame(self, patience_s):
        """The next good frame, or None."""
        end = time.monotonic() + patience_s
        while True:
            while b"\0" in self.unread:
                stuffed, self.unread = self.unread.split(b"\0", 1)
                data = unstuff(stuffed)
                if len(data) > 4 and struct.unpack("<I", data[-4:])[0] == crc32c(data[:-4]):
                    return data[:-4]
            left = end - time.monotonic()
            if left <= 0 or not select.select([self.port], [], [], left)[0]:
                return None
            self.unread += os.read(self.port, 4096)

    def wait_for(self, kind, patience_s):
        end = time.monotonic() + patience_s
        while (left := end - time.monotonic()) > 0:
            frame = self.frame(left)
            if frame and frame[0] == kind:
                return Reader(frame[1:])
        return None

    def ask(self, command, content=b""):
        """Sends a command and gives kind and content of the answer."""
        self.number += 1
        self.send(bytes([COMMAND]) + varint(self.number) + bytes([command]) + content)
        answer = self.wait_for(ANSWER, 2)
        while answer and answer.varint() != self.number:
            answer = self.wait_for(ANSWER, 2)
        if answer is None:
            raise SystemExit("the rig did not answer")
        kind = answer.varint()
        if kind == REFUSED:
            raise SystemExit(f"the rig refused, reason number {answer.varint()}")
        return kind, answer

    def settings(self):
        kind, answer = self.ask(GET_SETTINGS)
        assert kind == SETTINGS
        names = ["rate_hz", "cutoff_hz", "bandwidth_rad_s", "zero_code", "radian_per_code"]
        return {name: answer.f32() for name in names} | {"full_scale": answer.varint()}

    def samples(self):
        """Starts the stream of codes and gives (sample number, code) for ever."""
        self.ask(START, bytes([1]) + varint(0))
        while True:
            frame = self.wait_for(SAMPLES, 2)
            if frame is None:
                raise SystemExit("the stream dried up")
            _sequence, first, _status = frame.varint(), frame.varint(), frame.take(1)
            for offset in range(frame.varint()):
                yield first + offset, frame.varint()


def main():
    rig = Rig(sys.argv[1])
    settings = rig.settings()
    print(f"{rig.name}, {settings['rate_hz']:.0f} samples/s, codes 0 to {settings['full_scale']}")
    first = None
    for number, code in rig.samples():
        first = number if first is None else first
        time_s = (number - first) / settings["rate_hz"]
        if time_s >= 1.0:
            break
        if (number - first) % 100 == 0:
            angle_rad = (code - settings["zero_code"]) * settings["radian_per_code"]
            print(f"{time_s:.3f} s  code {code}  {angle_rad:+.4f} rad")
    rig.ask(STOP)


main()
