"""The flash memory's interface. RM0090 3.9, RM0390 3.8; times: DS8626 table 40 and DS10693 table 46.

An erase or a program stops every fetch of code; the interrupts wait, converter, timers and DMA go on. A program that
runs from RAM or from the instruction cache goes on, too, until it needs the flash: a setting, with which the flash does
not interrupt either.
"""

import random

import memory
import option_bytes
from clock import cancel, ticks
from peripheral import Peripheral, Unmodelled

KEYS = (0x4567_0123, 0xCDEF_89AB)
KB = 1024

# Parallelism by PSIZE, in bits.
WIDTHS = (8, 16, 32, 64)

# Milliseconds to erase a sector of so many KB, typical and worst, by PSIZE (there is no supply for x64).
ERASE_MS = {
    16: ((400, 800), (300, 600), (250, 500)),
    64: ((1200, 2400), (700, 1400), (550, 1100)),
    128: ((2000, 4000), (1300, 2600), (1000, 2000)),
}

# Microseconds to program a byte, half-word or word, typical and worst.
PROGRAM_US = (16, 100)

# Below this supply a word cannot be programmed at once (RM0090 table 9).
WORD_MV = 2700

# A flush of the data cache may take this long after an erase before it counts as forgotten.
FLUSH_WITHIN_S = 1e-3

EOP, OPERR, WRPERR, PGAERR, PGPERR, PGSERR, BUSY = 1 << 0, 1 << 1, 1 << 4, 1 << 5, 1 << 6, 1 << 7, 1 << 16
ERRORS = OPERR | WRPERR | PGAERR | PGPERR | PGSERR
PG, SER, MER, STRT, EOPIE, ERRIE, LOCK = 1 << 0, 1 << 1, 1 << 2, 1 << 16, 1 << 24, 1 << 25, 1 << 31
PREFETCH, INSTRUCTION_CACHE, DATA_CACHE, DATA_RESET = 1 << 8, 1 << 9, 1 << 10, 1 << 12

INTERRUPT = 4


def sectors(flash_kb):
    """First address and size in KB of each sector: four of 16 KB, one of 64 KB, the rest of 128 KB."""
    sizes = [16] * 4 + [64] + [128] * ((flash_kb - 128) // 128)
    starts = [sum(sizes[:i]) for i in range(len(sizes))]
    return [(memory.FLASH + start * KB, size) for start, size in zip(starts, sizes)]


class Flash(Peripheral):
    """At 0x40023C00."""

    NAME = "FLASH"
    REGISTERS = {0x00: "ACR", 0x04: "KEYR", 0x08: "OPTKEYR", 0x0C: "SR", 0x10: "CR", 0x14: "OPTCR"}
    RESET = {"CR": LOCK}
    _end = _busy_with = None

    def __init__(self, chip):
        self.sectors = sectors(chip.model.flash_kb)
        self.n_erases = 0
        super().__init__(chip)

    def reset(self):
        if self._busy_with:
            self._tear()
        super().reset()
        self.values["OPTCR"] = option_bytes.register(self.chip.settings)
        self._key = 0
        self._written = []
        self._busy_with = None
        self._end = cancel(self._end)
        self._stale = False
        if self.chip.nvic:
            self._interrupt()

    # Registers

    def wait_states(self):
        """Of a read."""
        return self.values["ACR"] & 0xF

    def write_ACR(self, value):
        if value & DATA_RESET:
            if value & DATA_CACHE:
                raise Unmodelled("the firmware flushed the data cache of the flash while it was on (RM0090 3.9.2)")
            self._stale = False
        self.values["ACR"] = value
        caches = (value & PREFETCH, value & INSTRUCTION_CACHE, value & DATA_CACHE)
        prefetch, instructions, data = (bool(bit) for bit in caches)
        self.chip.tell("flash", wait_states=value & 15, prefetch=prefetch, instructions=instructions, data=data)

    def read_KEYR(self):
        return 0

    def write_KEYR(self, value):
        if self.values["CR"] & LOCK and value == KEYS[self._key]:
            self._key += 1
            if self._key == len(KEYS):
                self._key = 0
                self.values["CR"] &= ~LOCK
        else:
            raise Unmodelled("a wrong key locks the flash until the next reset (RM0090 3.6.1)")

    def write_OPTKEYR(self, value):
        raise Unmodelled("the firmware unlocks the option bytes")

    def write_OPTCR(self, value):
        raise Unmodelled("the firmware writes option bytes")

    def write_SR(self, value):
        self.values["SR"] &= ~(value & (EOP | ERRORS))
        self._interrupt()

    def read_SR(self):
        return self.values["SR"] | (BUSY if self._busy_with else 0)

    def write_CR(self, value):
        if self.values["CR"] & LOCK:
            raise Unmodelled("the firmware wrote FLASH_CR while it was locked")
        self.values["CR"] = value & ~STRT
        if value & STRT:
            self._erase(value)
        self._interrupt()

    def _interrupt(self):
        status, control = self.values["SR"], self.values["CR"]
        asserted = status & EOP and control & EOPIE or status & OPERR and control & ERRIE
        self.chip.nvic.set_line(INTERRUPT, bool(asserted) and self.chip.settings.flash_stops)

    # Erasing

    def _erase(self, control):
        if control & MER or not control & SER:
            raise Unmodelled("the firmware erased the whole chip")
        number, parallelism = control >> 3 & 0xF, control >> 8 & 3
        start, size_kb = self.sectors[number]
        for first, last in self.chip.code:
            if start <= last and first < start + size_kb * KB:
                raise Unmodelled(f"the firmware erased sector {number}, which holds its own code")
        if self._refuses(start):
            return
        self._check_supply(parallelism)
        took_ms = ERASE_MS[size_kb][parallelism][self.chip.settings.worst_flash]
        self.n_erases += 1
        self.chip.tell("erase", sector=number, parallelism=WIDTHS[parallelism], took_ms=took_ms)
        self._work("erase", number, ticks(took_ms / 1000))

    def erase_for_bootloader(self, parts):
        """The sectors that hold any of these; gives their numbers."""
        touched = []
        for number, (start, size_kb) in enumerate(self.sectors):
            if any(start < address + len(data) and address < start + size_kb * KB for address, data in parts):
                self.chip.flash_memory.put(start, b"\xff" * size_kb * KB)
                touched.append(number)
        return touched

    def _work(self, what, where, n_ticks):
        end = self.clock.now() + n_ticks
        self._busy_with = (what, where)
        self._end = self.clock.at(end, self._finish)
        if self.chip.settings.flash_stops:
            self.chip.core.stall_until(end)

    def _refuses(self, address):
        """Is it in a sector that the option bytes protect against writing (RM0090 3.7.4)?"""
        number = max(number for number, (start, _) in enumerate(self.sectors) if start <= address)
        refuses = number in self.chip.settings.protected
        if refuses:
            self._fails(WRPERR)
        return refuses

    def _fails(self, error):
        """OPERR is set with any other error if it is to interrupt (RM0090 3.9.5)."""
        self.values["SR"] |= error | (OPERR if self.values["CR"] & ERRIE else 0)

    def _finish(self):
        if not self._busy_with:
            return
        what, where = self._busy_with
        self._busy_with = None
        if what == "erase":
            start, size_kb = self.sectors[where]
            self.chip.flash_memory.put(start, b"\xff" * size_kb * KB)
            if self.values["ACR"] & DATA_CACHE or self._stale:
                self._stale = True
                self.clock.after(ticks(FLUSH_WITHIN_S), self._check_flushed)
        if self.values["CR"] & EOPIE:
            self.values["SR"] |= EOP
        self._interrupt()

    def _check_flushed(self):
        if self._stale:
            raise Unmodelled("after an erase the data cache of the flash was not flushed: reads may be old (RM0090 3.5.2)")

    def _check_supply(self, parallelism):
        if WIDTHS[parallelism] == 64 or WIDTHS[parallelism] == 32 and self.chip.supply_mv < WORD_MV:
            width = WIDTHS[parallelism]
            raise Unmodelled(f"{self.chip.supply_mv} mV do not allow to write {width} bits at once (RM0090 table 9)")

    # Programming

    def takes(self, address, size, value):
        """A write of the processor to flash; false if it is none. Call `settle` when the instruction has ended."""
        if not memory.FLASH <= address < memory.FLASH + self.chip.model.flash_kb * KB:
            return False
        control, parallelism = self.values["CR"], self.values["CR"] >> 8 & 3
        old = self.chip.flash_memory.take(address, size)
        new = bytes(a & b for a, b in zip(old, (value & (1 << 8 * size) - 1).to_bytes(size, "little")))
        error = 0
        if control & LOCK or not control & PG:
            error = PGSERR
        elif 8 * size != WIDTHS[parallelism]:
            error = PGPERR
        elif address % size:
            error = PGAERR
        if error:
            self._fails(error)
            new = old
        elif self._refuses(address):
            new = old
        else:
            self._check_supply(parallelism)
            self._work("program", (address, old, new), ticks(PROGRAM_US[self.chip.settings.worst_flash] * 1e-6))
        self._written.append((address, new))
        self._interrupt()
        return True

    def settle(self):
        """Programming clears bits and sets none."""
        for address, data in self._written:
            self.chip.flash_memory.put(address, data)
        self._written.clear()

    # Power lost in the middle

    def _tear(self):
        chance = random.Random(self.clock.now())
        what, where = self._busy_with
        if what == "erase":
            # Cells on their way from 0 to 1, and some whose value nobody knows (RM0090 3.6.3).
            start, size_kb = self.sectors[where]
            old = self.chip.flash_memory.take(start, size_kb * KB)
            noise = chance.randbytes(size_kb * KB)
            self.chip.flash_memory.put(start, bytes(a | b for a, b in zip(old, noise)))
        else:
            address, old, new = where
            noise = chance.randbytes(len(old))
            self.chip.flash_memory.put(address, bytes(b | a & n for a, b, n in zip(old, new, noise)))
        self.chip.tell("torn", work=what)
