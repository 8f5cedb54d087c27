"""Flash, RAM and the ROM with the bootloader, as plain bytes that the processor and the DMA share.

RM0090 2.3, RM0390 2.2: memory map; boot configuration in 2.4 and 2.3.
"""

import ctypes
import random

FLASH = 0x0800_0000
RAM = 0x2000_0000
RAM_SIZE = 128 * 1024
CCM = 0x1000_0000
CCM_SIZE = 64 * 1024
# System memory, one-time-programmable bytes, unique id, flash size, option bytes.
ROM = 0x1FFF_0000
ROM_SIZE = 0x1_0000

# Where the bootloader's vectors lead; see Core: arriving there means that the bootloader runs.
BOOTLOADER_ENTRY = ROM + 0x400
BOOTLOADER_STACK = RAM + 0x2000


class Region:
    """Bytes at an address."""

    def __init__(self, address, size, fill=0):
        self.address, self.size = address, size
        self.buffer = (ctypes.c_ubyte * size)()
        self.bytes = memoryview(self.buffer).cast("B")
        self.fill(fill)

    def fill(self, byte):
        """The same byte everywhere."""
        ctypes.memset(self.buffer, byte, self.size)

    def noise(self, seed):
        """What memory holds after power came on."""
        self.bytes[:] = random.Random(seed).randbytes(self.size)

    def pointer(self):
        """For the emulator's memory map."""
        return ctypes.addressof(self.buffer)

    def word(self, address):
        """The 32-bit number at an address."""
        at = address - self.address
        return int.from_bytes(self.bytes[at : at + 4], "little")

    def put(self, address, data):
        """Bytes at an address."""
        at = address - self.address
        self.bytes[at : at + len(data)] = data

    def take(self, address, length):
        """Bytes from an address on."""
        at = address - self.address
        return bytes(self.bytes[at : at + length])


def rom(flash_kb, unique_id, option_bytes):
    """The system memory: a bootloader of which only the entry exists, and the chip's signature.

    RM0090 39 (RM0390 34): unique id at 0x1FFF7A10, flash size at 0x1FFF7A22; option bytes at 0x1FFFC000 (3.6).
    """
    region = Region(ROM, ROM_SIZE, 0xFF)
    vectors = [BOOTLOADER_STACK] + [BOOTLOADER_ENTRY | 1] * 111
    region.put(ROM, b"".join(vector.to_bytes(4, "little") for vector in vectors))
    # An endless loop, for the moment until the emulator notices.
    region.put(BOOTLOADER_ENTRY, b"\xfe\xe7" * 2)
    region.put(0x1FFF_7A10, unique_id)
    region.put(0x1FFF_7A22, flash_kb.to_bytes(2, "little"))
    region.put(0x1FFF_C000, option_bytes)
    return region
