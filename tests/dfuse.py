"""Writes an image as a DfuSe file, which dfu-util and ST's tools bring onto a chip over USB.

python3 tests/dfuse.py IMAGE.elf FILE.dfu. The format is ST's UM0391. The file has an element for what lies before the
parameter store and one for what lies behind it, so that the store's sectors are neither erased nor written.
"""

import struct
import sys
import zlib

# ST's bootloader, as it shows itself on USB, and the format's version.
VENDOR, PRODUCT, DFU_VERSION = 0x0483, 0xDF11, 0x011A

STORE = range(0x0800_4000, 0x0801_0000)
ERASED = b"\xff"


def main():
    image, file = sys.argv[1:]
    with open(image, "rb") as source:
        elements = merged(segments(source.read()))
    with open(file, "wb") as target:
        target.write(dfuse(elements))


def segments(elf):
    """What is to be loaded: address and bytes, in order."""
    first, entry_size, n_entries = (*struct.unpack_from("<I", elf, 28), *struct.unpack_from("<HH", elf, 42))
    entries = (struct.unpack_from("<8I", elf, first + i * entry_size) for i in range(n_entries))
    loaded = ((physical, elf[at : at + size]) for kind, at, _, physical, size, *_ in entries if kind == 1 and size > 0)
    return sorted(loaded)


def merged(parts):
    """One element before the store and one behind it; gaps within them look erased."""
    elements = []
    for address, data in parts:
        if address < STORE.stop and address + len(data) > STORE.start:
            sys.exit(f"{address:#x}: {len(data)} bytes reach into the parameter store")
        if elements and (elements[-1][0] < STORE.start) == (address < STORE.start):
            begin, before = elements[-1]
            elements[-1] = (begin, before + ERASED * (address - begin - len(before)) + data)
        else:
            elements.append((address, data))
    return elements


def dfuse(elements):
    """The file: prefix, one target with its elements, suffix."""
    target = b"".join(struct.pack("<II", address, len(data)) + data for address, data in elements)
    name = b"Internal Flash".ljust(255, b"\0")
    target = b"Target" + struct.pack("<BI", 0, 1) + name + struct.pack("<II", len(target), len(elements)) + target
    body = struct.pack("<5sBIB", b"DfuSe", 1, 11 + len(target), 1) + target
    body += struct.pack("<4H3sB", 0xFFFF, PRODUCT, VENDOR, DFU_VERSION, b"UFD", 16)
    return body + struct.pack("<I", ~zlib.crc32(body) & 0xFFFF_FFFF)


main()
