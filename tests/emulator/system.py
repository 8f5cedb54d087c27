"""What else belongs to the processor: control block, system timer, memory protection, floating point, cycle counter.

PM0214 4.2 (MPU), 4.4 (SCB), 4.5 (SysTick), 4.6 (FPU); the cycle counter is in ARM's DDI 0403, C1.8.
"""

from clock import cancel
from nvic import FIRST_INTERRUPT, PRIORITY_BITS, SYSTICK
from peripheral import Peripheral, Unmodelled

RESET_KEY = 0x05FA

# What memory protection can close here: Unicorn's pages.
PAGE = 1024


class SystemControlBlock(Peripheral):
    """At 0xE000ED00."""

    NAME = "SCB"
    REGISTERS = {
        0x00: "CPUID",
        0x04: "ICSR",
        0x08: "VTOR",
        0x0C: "AIRCR",
        0x10: "SCR",
        0x14: "CCR",
        0x18: "SHPR1",
        0x1C: "SHPR2",
        0x20: "SHPR3",
        0x24: "SHCSR",
        0x28: "CFSR",
        0x2C: "HFSR",
        0x30: "DFSR",
        0x34: "MMFAR",
        0x38: "BFAR",
        0x88: "CPACR",
    }
    RESET = {"CPUID": 0x410F_C241, "CCR": 0x200, "AIRCR": 0xFA05_0000}

    def write_AIRCR(self, value):
        if value >> 16 == RESET_KEY and value & 1 << 2:
            self.chip.request_reset("software")

    def read_ICSR(self):
        active = self.chip.nvic.active
        return active[-1][0] if active else 0

    def write_ICSR(self, value):
        if value & 1 << 28:
            self.chip.nvic.pend(14)
        if value & 1 << 26:
            self.chip.nvic.pend(SYSTICK)

    def _set_priorities(self, first, value):
        for i, byte in enumerate(value.to_bytes(4, "little")):
            if first + i > 3:
                self.chip.nvic.priorities[first + i] = byte & PRIORITY_BITS

    def write_SHPR1(self, value):
        self._set_priorities(4, value)
        self.values["SHPR1"] = value

    def write_SHPR2(self, value):
        self._set_priorities(8, value)
        self.values["SHPR2"] = value

    def write_SHPR3(self, value):
        self._set_priorities(12, value)
        self.values["SHPR3"] = value

    def write_CFSR(self, value):
        self.values["CFSR"] &= ~value

    def write_HFSR(self, value):
        self.values["HFSR"] &= ~value

    def on_fault(self):
        """A fault without a handler of its own has become a hard fault (PM0214 2.4.2)."""
        self.values["HFSR"] |= 1 << 30

    def on_forbidden(self, address):
        """An instruction touched what the MPU closes (PM0214 4.4.10, 4.4.14): the address is kept."""
        self.values["CFSR"] |= 1 << 7 | 1 << 1
        self.values["MMFAR"] = address

    def on_stacking(self):
        """Registers could not be saved on entering an exception, because the MPU closes the stack there."""
        self.values["CFSR"] |= 1 << 4
        self.on_fault()
        self.chip.tell("fault", reason="the stack is closed")


class SoftwareTrigger(Peripheral):
    """STIR, at 0xE000EF00 (PM0214 4.3.8)."""

    NAME = "NVIC"
    REGISTERS = {0x00: "STIR"}

    def write_STIR(self, value):
        self.chip.nvic.pend(FIRST_INTERRUPT + (value & 0x1FF))


class FloatingPoint(Peripheral):
    """At 0xE000EF30: lazy stacking is left as it is after a reset."""

    NAME = "FPU"
    REGISTERS = {0x04: "FPCCR", 0x08: "FPCAR", 0x0C: "FPDSCR"}
    RESET = {"FPCCR": 0xC000_0000}

    def write_FPCCR(self, value):
        if value >> 30 != 3:
            raise Unmodelled("the firmware turned off the stacking of floating point registers")
        self.values["FPCCR"] = value


class SysTick(Peripheral):
    """At 0xE000E010; counts the processor's cycles, or an eighth of them."""

    NAME = "SysTick"
    REGISTERS = {0x0: "CTRL", 0x4: "LOAD", 0x8: "VAL", 0xC: "CALIB"}
    _event = None

    def reset(self):
        super().reset()
        self._began = 0
        self._event = cancel(self._event)

    def _tick(self):
        return self.chip.core.ticks_per_cycle * (1 if self.values["CTRL"] & 4 else 8)

    def _period(self):
        return (self.values["LOAD"] + 1) * self._tick()

    def _start(self):
        self._event = cancel(self._event)
        self._began = self.clock.now()
        if self.values["CTRL"] & 1 and self.values["LOAD"]:
            self._event = self.clock.at(self._began + self._period(), self._wrap)

    def _wrap(self):
        self.values["CTRL"] |= 1 << 16
        self._start()
        if self.values["CTRL"] & 2:
            self.chip.nvic.pend(SYSTICK)

    def read_CTRL(self):
        value = self.values["CTRL"]
        self.values["CTRL"] &= ~(1 << 16)
        return value

    def write_CTRL(self, value):
        was = self.values["CTRL"]
        self.values["CTRL"] = value & 7
        if (was ^ value) & 5:
            self._start()

    def read_VAL(self):
        if not self.values["CTRL"] & 1:
            return 0
        passed = (self.clock.now() - self._began) // self._tick()
        return self.values["LOAD"] - passed % (self.values["LOAD"] + 1)

    def write_VAL(self, value):
        self._start()


class Protection(Peripheral):
    """The MPU, at 0xE000ED90: regions without access; the other attributes change nothing here."""

    NAME = "MPU"
    REGISTERS = {
        0x00: "TYPE",
        0x04: "CTRL",
        0x08: "RNR",
        0x0C: "RBAR",
        0x10: "RASR",
        0x14: "RBAR_A1",
        0x18: "RASR_A1",
        0x1C: "RBAR_A2",
        0x20: "RASR_A2",
        0x24: "RBAR_A3",
        0x28: "RASR_A3",
    }
    RESET = {"TYPE": 0x800}

    def reset(self):
        super().reset()
        self.regions = [(0, 0)] * 8
        self.guarded = []
        if self.chip.core:
            self.chip.core.guard()

    def read_RBAR(self):
        return self.regions[self.values["RNR"]][0]

    def write_RBAR(self, value):
        if value & 1 << 4:
            self.values["RNR"] = value & 7
        number = self.values["RNR"]
        self.regions[number] = (value & ~0x1F, self.regions[number][1])
        self._look()

    def read_RASR(self):
        return self.regions[self.values["RNR"]][1]

    def write_RASR(self, value):
        number = self.values["RNR"]
        self.regions[number] = (self.regions[number][0], value)
        self._look()

    write_RBAR_A1 = write_RBAR_A2 = write_RBAR_A3 = write_RBAR
    write_RASR_A1 = write_RASR_A2 = write_RASR_A3 = write_RASR

    def write_CTRL(self, value):
        self.values["CTRL"] = value
        self._look()

    def _look(self):
        """Ranges that may not be touched, as first and last address."""
        self.guarded = []
        if self.values["CTRL"] & 1:
            for base, attributes in self.regions:
                size = 2 << (attributes >> 1 & 0x1F)
                if attributes & 1 and attributes >> 24 & 7 == 0:
                    self._close(base & ~(size - 1), size)
        self.chip.core.guard()

    def _close(self, first, size):
        ram = self.chip.ram
        if size % PAGE or not ram.address <= first <= ram.address + ram.size - size:
            raise Unmodelled(f"the MPU closes {size} bytes at {first:#010x}; here it closes whole KB of RAM only")
        self.guarded.append((first, first + size - 1))


class DebugControl(Peripheral):
    """At 0xE000EDF0 (DDI 0403, C1.6): TRCENA lets the cycle counter run; no debugger is attached."""

    NAME = "CoreDebug"
    REGISTERS = {0x0: "DHCSR", 0x4: "DCRSR", 0x8: "DCRDR", 0xC: "DEMCR"}


class CycleCounter(Peripheral):
    """DWT, at 0xE0001000. It counts on while the processor sleeps, as STM32F4 chips with a running HCLK do."""

    NAME = "DWT"
    REGISTERS = {0x0: "CTRL", 0x4: "CYCCNT", 0xFB0: "LAR"}
    RESET = {"CTRL": 0x4000_0000}

    def reset(self):
        super().reset()
        self._since, self._count = self.clock.now(), 0

    def read_CYCCNT(self):
        if not self.values["CTRL"] & 1:
            return self._count & 0xFFFF_FFFF
        passed = self.clock.now() - self._since
        return self._count + passed // self.chip.core.ticks_per_cycle & 0xFFFF_FFFF

    def write_CYCCNT(self, value):
        self._since, self._count = self.clock.now(), value

    def write_CTRL(self, value):
        self._count, self._since = self.read_CYCCNT(), self.clock.now()
        self.values["CTRL"] = self.RESET["CTRL"] | value & 0xFFF_FFFF


class DebugUnit(Peripheral):
    """DBGMCU, at 0xE0042000 (RM0090 38.16, RM0390 33.16)."""

    NAME = "DBGMCU"
    REGISTERS = {0x0: "IDCODE", 0x4: "CR", 0x8: "APB1_FZ", 0xC: "APB2_FZ"}

    def read_IDCODE(self):
        return self.chip.settings.device_id or self.chip.model.device_id

    def stops_watchdog(self):
        """Does the independent watchdog wait while a debugger halts the processor (DBG_IWDG_STOP)?"""
        return bool(self.values["APB1_FZ"] & 1 << 12)


def attach(chip):
    """Puts all of these on the chip's bus."""
    chip.scb = chip.bus.attach(0xE000_ED00, SystemControlBlock(chip), 0x90)
    chip.bus.attach(0xE000_EF00, SoftwareTrigger(chip), 0x10)
    chip.bus.attach(0xE000_EF30, FloatingPoint(chip), 0x10)
    chip.systick = chip.bus.attach(0xE000_E010, SysTick(chip), 0x10)
    chip.mpu = chip.bus.attach(0xE000_ED90, Protection(chip), 0x30)
    chip.bus.attach(0xE000_EDF0, DebugControl(chip), 0x10)
    chip.dwt = chip.bus.attach(0xE000_1000, CycleCounter(chip), 0x1000)
    chip.debug = chip.bus.attach(0xE004_2000, DebugUnit(chip), 0x10)
