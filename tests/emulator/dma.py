"""Direct memory access. RM0090 10.5, RM0390 9.5. A peripheral offers or asks for bytes; a stream moves them."""

from peripheral import Peripheral, Unmodelled

N_STREAMS = 8
# Interrupts of the streams (RM0090 table 62).
INTERRUPTS = {1: (11, 12, 13, 14, 15, 16, 17, 47), 2: (56, 57, 58, 59, 60, 68, 69, 70)}

# Where a stream's five flags are in its register, and which they are.
SHIFTS = (0, 6, 16, 22)
DIRECT_ERROR, ERROR, HALF, COMPLETE = 1 << 2, 1 << 3, 1 << 4, 1 << 5

ENABLE, DIRECTION, CIRCULAR, INCREMENT = 1 << 0, 3 << 6, 1 << 8, 1 << 10
TO_MEMORY, FROM_MEMORY = 0, 1


def _registers():
    names = {0x0: "LISR", 0x4: "HISR", 0x8: "LIFCR", 0xC: "HIFCR"}
    for number in range(N_STREAMS):
        for i, name in enumerate(("CR", "NDTR", "PAR", "M0AR", "M1AR", "FCR")):
            names[0x10 + 0x18 * number + 4 * i] = f"S{number}{name}"
    return names


class Stream:
    """One of the eight."""

    def __init__(self, dma, number):
        self.dma, self.number = dma, number
        self.control = self.length = self.left = self.flags = 0
        # Where in memory the next item goes, counted from the address that software gave.
        self.at = 0
        # Called when the stream is enabled, and before its position is looked at.
        self.on_enabled = self.before_look = lambda: None

    def is_for(self, direction, channel):
        """Is it enabled, with this direction and channel?"""
        control = self.control
        return control & ENABLE and (control & DIRECTION) >> 6 == direction and control >> 25 & 7 == channel

    def _size(self):
        size = 1 << (self.control >> 11 & 3)
        if 1 << (self.control >> 13 & 3) != size or not self.control & INCREMENT:
            raise Unmodelled(f"{self.dma.NAME} stream {self.number}: unequal sizes or a fixed memory address")
        return size

    def _place(self):
        address = self.dma.values[f"S{self.number}M0AR"]
        ram = self.dma.chip.ram
        if not ram.address <= address < ram.address + ram.size:
            raise Unmodelled(f"{self.dma.NAME} cannot reach memory at {address:#010x} (RM0090 2.1)")
        return address + self.at * self._size()

    def give(self, data):
        """Bytes from the peripheral to memory; those that find no room are lost."""
        size = self._size()
        while data and self.control & ENABLE:
            n = min(len(data), self.left * size)
            self.dma.chip.ram.put(self._place(), data[:n])
            data = data[n:]
            self._moved(n // size)

    def take(self, most):
        """Up to so many bytes from memory for the peripheral."""
        n = min(most, self.left)
        data = self.dma.chip.ram.take(self._place(), n * self._size())
        self._moved(n)
        return data

    def _moved(self, n):
        before, self.left, self.at = self.left, self.left - n, self.at + n
        half = self.length // 2
        if before > half >= self.left:
            self.flags |= HALF
        if self.left == 0:
            self.flags |= COMPLETE
            if self.control & CIRCULAR:
                self.left, self.at = self.length, 0
            else:
                self.control &= ~ENABLE
        self.dma.interrupt(self)

    def write_control(self, value):
        """Enabled anew, it begins with the first address again, and goes on counting from where it was (RM0090 10.3.14,
        10.3.17)."""
        was = self.control
        self.control = value
        if value & ENABLE and not was & ENABLE:
            self.at = 0
            self.on_enabled()
        elif was & ENABLE and not value & ENABLE:
            self.flags |= COMPLETE
        self.dma.interrupt(self)


class Dma(Peripheral):
    """DMA1 at 0x40026000 and DMA2 at 0x40026400."""

    REGISTERS = _registers()

    def __init__(self, chip, number):
        self.NAME, self.number = f"DMA{number}", number
        self.streams = [Stream(self, n) for n in range(N_STREAMS)]
        super().__init__(chip)
        for n in range(N_STREAMS):
            at, stream = 0x10 + 0x18 * n, self.streams[n]
            self.readers[at] = lambda stream=stream: stream.control
            self.writers[at] = stream.write_control
            self.readers[at + 4] = lambda stream=stream: (stream.before_look(), stream.left)[1]
            self.writers[at + 4] = lambda value, stream=stream: self._set_length(stream, value)

    def reset(self):
        super().reset()
        for stream in self.streams:
            stream.control = stream.length = stream.left = stream.at = stream.flags = 0
            self.interrupt(stream)

    @staticmethod
    def _set_length(stream, value):
        if not stream.control & ENABLE:
            stream.length = stream.left = value & 0xFFFF

    def interrupt(self, stream):
        """Asserts the stream's interrupt or not."""
        control, flags = stream.control, stream.flags
        wanted = (HALF if control & 1 << 3 else 0) | (COMPLETE if control & 1 << 4 else 0)
        self.chip.nvic.set_line(INTERRUPTS[self.number][stream.number], bool(flags & wanted))

    def _flags(self, first):
        for stream in self.streams[first : first + 4]:
            stream.before_look()
        return sum(stream.flags << SHIFTS[i] for i, stream in enumerate(self.streams[first : first + 4]))

    def read_LISR(self):
        return self._flags(0)

    def read_HISR(self):
        return self._flags(4)

    def _clear(self, first, value):
        for i, stream in enumerate(self.streams[first : first + 4]):
            stream.flags &= ~(value >> SHIFTS[i] & 0x3D)
            self.interrupt(stream)

    def write_LIFCR(self, value):
        self._clear(0, value)

    def write_HIFCR(self, value):
        self._clear(4, value)
