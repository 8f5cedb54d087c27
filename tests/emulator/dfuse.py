"""Files of ST's bootloader: DfuSe, UM0391 chapter 2."""

import struct

from peripheral import Unmodelled

PREFIX = struct.Struct("<5sBIB")
TARGET = struct.Struct("<6sBI255sII")
ELEMENT = struct.Struct("<II")


def elements(file):
    """Address and bytes of each element of the one target."""
    signature, version, _, n_targets = PREFIX.unpack_from(file)
    name, *_, n_elements = TARGET.unpack_from(file, PREFIX.size)
    if (signature, version, n_targets, name) != (b"DfuSe", 1, 1, b"Target"):
        raise Unmodelled("a file that is not DfuSe, or has several targets")
    found, at = [], PREFIX.size + TARGET.size
    for _ in range(n_elements):
        address, length = ELEMENT.unpack_from(file, at)
        at += ELEMENT.size + length
        found.append((address, file[at - length : at]))
    return found
