"""The interrupt controller and the system's exceptions: which one is next. PM0214 4.3 (NVIC), 2.3 (exceptions).

Exceptions have their numbers: 1 to 15 the system's, 16 and above the chip's interrupts. Sets of them are bits of one
number. An interrupt whose line is still asserted when its handler returns comes again.
"""

from peripheral import Peripheral

HARD_FAULT = 3
SYSTICK = 15
FIRST_INTERRUPT = 16

# The chip implements the upper four bits of a priority (PM0214 4.3.7).
PRIORITY_BITS = 0xF0
N_INTERRUPTS = 97
LOWEST = 256
WORDS = range(-(-N_INTERRUPTS // 32))

SYSTEM_EXCEPTIONS = (1 << FIRST_INTERRUPT) - 1


def _registers():
    names = {}
    for word in WORDS:
        for offset, name in ((0x00, "ISER"), (0x80, "ICER"), (0x100, "ISPR"), (0x180, "ICPR"), (0x200, "IABR")):
            names[offset + 4 * word] = f"{name}{word}"
    names.update({0x300 + 4 * i: f"IPR{i}" for i in range(-(-N_INTERRUPTS // 4))})
    return names


class Nvic(Peripheral):
    """At 0xE000E100."""

    NAME = "NVIC"
    REGISTERS = _registers()

    def reset(self):
        super().reset()
        self.enabled = SYSTEM_EXCEPTIONS
        self.pended = 0
        self.priorities = [0] * (FIRST_INTERRUPT + N_INTERRUPTS)
        self.priorities[1:4] = [-3, -2, -1]
        # Exceptions under way, the innermost last, each with its priority.
        self.active = []
        self.lines = 0
        self._look()

    def _look(self):
        """`candidates` is what would be taken but for priorities."""
        self.candidates = (self.pended | self.lines) & self.enabled

    def set_line(self, interrupt, asserted):
        """A peripheral asserts its interrupt or no longer does."""
        bit = 1 << FIRST_INTERRUPT + interrupt
        lines = self.lines | bit if asserted else self.lines & ~bit
        if lines != self.lines:
            self.lines = lines
            self._changed()

    def pend(self, exception):
        """Once, by software or a timer of the processor."""
        self.pended |= 1 << exception
        self._changed()

    def _changed(self):
        self._look()
        if self.candidates and self.chip.core.must_take():
            self.chip.core.stop()

    def next(self):
        """The exception that is to be taken now, if priorities allow one."""
        # The innermost has the highest priority of those under way.
        current = self.active[-1][1] if self.active else LOWEST
        best, rest, number = None, self.candidates, 0
        while rest:
            number = (rest & -rest).bit_length() - 1
            rest &= rest - 1
            if self.priorities[number] < current:
                best, current = number, self.priorities[number]
        return best

    def enter(self, number):
        """Its handler begins."""
        self.pended &= ~(1 << number)
        self.active.append((number, self.priorities[number]))
        self._look()

    def leave(self):
        """The innermost handler has ended; gives its number."""
        return self.active.pop()[0] if self.active else None

    def read(self, offset):
        name = self.REGISTERS.get(offset, "")
        sets = {"ISER": self.enabled, "ICER": self.enabled, "ISPR": self.pended | self.lines}
        sets["ICPR"] = sets["ISPR"]
        sets["IABR"] = sum(1 << number for number, _ in self.active)
        if name[:4] in sets:
            return sets[name[:4]] >> FIRST_INTERRUPT + 32 * int(name[4:]) & 0xFFFF_FFFF
        if name.startswith("IPR"):
            first = FIRST_INTERRUPT + offset - 0x300
            return int.from_bytes(bytes(self.priorities[first : first + 4]), "little")
        return super().read(offset)

    def write(self, offset, value, size=4):
        name = self.REGISTERS.get(offset & ~3, "")
        if name.startswith("IPR"):
            for i, byte in enumerate(value.to_bytes(4, "little")[:size]):
                self.priorities[FIRST_INTERRUPT + offset - 0x300 + i] = byte & PRIORITY_BITS
            return
        if size != 4 or not name or name.startswith("IABR"):
            raise self._unknown("wrote", offset)
        bits = value << FIRST_INTERRUPT + 32 * int(name[4:])
        if name.startswith("ISER"):
            self.enabled |= bits
        elif name.startswith("ICER"):
            self.enabled &= ~bits
        elif name.startswith("ISPR"):
            self.pended |= bits
        else:
            self.pended &= ~bits
        self._changed()
