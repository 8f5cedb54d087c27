"""Pins, their interrupts, and which memory is at address 0.

RM0090 8.4 (GPIO), 9.2 (SYSCFG), 12.3 (EXTI); RM0390 7.4, 8.2, 10.3.
"""

from peripheral import Peripheral, Unmodelled


class Gpio(Peripheral):
    """A port; its pins show what is written to them."""

    NAME = "GPIO"
    REGISTERS = {
        0x00: "MODER",
        0x04: "OTYPER",
        0x08: "OSPEEDR",
        0x0C: "PUPDR",
        0x10: "IDR",
        0x14: "ODR",
        0x18: "BSRR",
        0x1C: "LCKR",
        0x20: "AFRL",
        0x24: "AFRH",
    }

    def __init__(self, chip, letter):
        self.NAME = f"GPIO{letter}"
        # After a reset the debug port owns some pins (RM0090 8.4).
        self.RESET = {"A": {"MODER": 0xA800_0000}, "B": {"MODER": 0x280}}.get(letter, {})
        super().__init__(chip)

    def _show(self, value):
        if value != self.values["ODR"]:
            self.values["ODR"] = value
            self.chip.tell("pins", port=self.NAME, output=f"{value:#06x}")

    def read_IDR(self):
        return self.values["ODR"]

    def write_ODR(self, value):
        self._show(value & 0xFFFF)

    def write_BSRR(self, value):
        self._show(self.values["ODR"] & ~(value >> 16) | value & 0xFFFF)


class SystemConfiguration(Peripheral):
    """SYSCFG, at 0x40013800."""

    NAME = "SYSCFG"
    REGISTERS = {
        0x00: "MEMRMP",
        0x04: "PMC",
        0x08: "EXTICR1",
        0x0C: "EXTICR2",
        0x10: "EXTICR3",
        0x14: "EXTICR4",
        0x20: "CMPCR",
        0x2C: "CFGR",
    }

    def reset(self):
        super().reset()
        if self.chip.core:
            self.write_MEMRMP(0)

    def write_MEMRMP(self, value):
        memories = {0: self.chip.flash_memory, 1: self.chip.rom, 3: self.chip.ram}
        if value & 3 not in memories:
            raise Unmodelled("the firmware put external memory at address 0")
        self.values["MEMRMP"] = value
        self.chip.core.map_at_zero(memories[value & 3])


class ExternalInterrupts(Peripheral):
    """EXTI, at 0x40013C00; only what software sets, because nothing outside moves a pin."""

    NAME = "EXTI"
    REGISTERS = {0x00: "IMR", 0x04: "EMR", 0x08: "RTSR", 0x0C: "FTSR", 0x10: "SWIER", 0x14: "PR"}

    def write_PR(self, value):
        self.values["PR"] &= ~value
