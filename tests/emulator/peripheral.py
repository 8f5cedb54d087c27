"""Registers by name, and the bus that finds them by address.

A register that the firmware touches and no model knows is a failure with its name or address: what is not modelled
has not been tested.
"""


from functools import partial


class Unmodelled(Exception):
    """The firmware did something that the emulator does not know."""


class Peripheral:
    """A block of 32-bit registers.

    `REGISTERS` maps offsets to names, `RESET` names to reset values other than 0. A register with a side effect has a
    method `read_NAME(self)` or `write_NAME(self, value)`; all others keep what is written.
    """

    NAME = ""
    REGISTERS = {}
    RESET = {}

    def __init__(self, chip):
        self.chip = chip
        self.clock = chip.clock
        self.readers = {offset: self._reader(name) for offset, name in self.REGISTERS.items()}
        self.writers = {offset: self._writer(name) for offset, name in self.REGISTERS.items()}
        self.reset()

    def reset(self):
        """As after a system reset."""
        self.values = {name: self.RESET.get(name, 0) for name in self.REGISTERS.values()}

    def _reader(self, name):
        return getattr(self, "read_" + name, None) or (lambda: self.values[name])

    def _writer(self, name):
        return getattr(self, "write_" + name, None) or (lambda value: self.values.__setitem__(name, value))

    def read(self, offset):
        """A whole register."""
        reader = self.readers.get(offset)
        if reader is None:
            raise self._unknown("read", offset)
        return reader() & 0xFFFF_FFFF

    def reader(self, offset):
        """What reads that register, so that it is looked for only once."""
        if type(self).read is Peripheral.read and offset in self.readers:
            return self.readers[offset]
        return partial(self.read, offset)

    def write(self, offset, value, size=4):
        """A register, or some bytes of it."""
        place = offset & ~3
        writer = self.writers.get(place)
        if writer is None:
            raise self._unknown("wrote", offset)
        if size < 4:
            shift = 8 * (offset & 3)
            mask = ((1 << 8 * size) - 1) << shift
            value = self.values[self.REGISTERS[place]] & ~mask | value << shift & mask
        writer(value)

    def _unknown(self, verb, offset):
        return Unmodelled(f"the firmware {verb} the register at {offset:#x} of {self.NAME}, which is not modelled")


class Storage(Peripheral):
    """A block whose registers only keep what is written, such as the pins' configuration."""

    def __init__(self, chip, name, registers, reset=()):
        self.NAME, self.REGISTERS, self.RESET = name, registers, dict(reset)
        super().__init__(chip)


class Bus:
    """Finds the peripheral of an address; each occupies whole blocks of 16 bytes."""

    def __init__(self, chip):
        self.chip = chip
        self.blocks = {}
        # By the addresses that have been read.
        self._readers = {}

    def attach(self, address, peripheral, size=0x400):
        """Puts a peripheral at its address."""
        for block in range(address >> 4, (address + size - 1 >> 4) + 1):
            self.blocks[block] = (address, peripheral)
        return peripheral

    def _find(self, verb, address):
        found = self.blocks.get(address >> 4)
        if found is None:
            raise Unmodelled(f"the firmware {verb} {address:#010x}, where no peripheral is modelled")
        return found

    def read(self, address, size):
        """What the processor reads."""
        if size == 4 and address in self._readers:
            return self._readers[address]() & 0xFFFF_FFFF
        reader = self._readers.get(address & ~3) or self._reader(address & ~3)
        return (reader() & 0xFFFF_FFFF) >> 8 * (address & 3) & (1 << 8 * size) - 1

    def _reader(self, address):
        base, peripheral = self._find("read", address)
        self._readers[address] = peripheral.reader(address - base)
        return self._readers[address]

    def write(self, address, size, value):
        """What the processor writes."""
        base, peripheral = self._find("wrote", address)
        peripheral.write(address - base, value, size)
