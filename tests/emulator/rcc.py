"""Reset and clock control, and the power controller that goes with it.

RM0090 7.3 and 5.4, RM0390 6.3 and 5.4. Clocks become ready after the times of the data sheets (DS8626 5.3.8 to 5.3.10,
DS10693 6.3.8 to 6.3.10); a crystal may be missing.
"""

from clock import TICKS_PER_S, ticks
from peripheral import Peripheral, Unmodelled

HSI_HZ = 16_000_000

# Times until a clock is ready: typical, but for the PLL, which may take 300 µs at most.
HSI_READY_S = 2.2e-6
CRYSTAL_READY_S = 2e-3
BYPASS_READY_S = 1e-6
PLL_READY_S = 300e-6
LSI_READY_S = 15e-6
OVERDRIVE_READY_S = 40e-6

# One wait state for each of these at 2.7 to 3.6 V (RM0090 3.5.1, RM0390 3.4.1).
HZ_PER_WAIT_STATE = 30_000_000

# Bits of RCC_CR.
HSE_ON, BYPASSED = 1 << 16, 1 << 18

# Flags of RCC_CSR.
LSI_ON, LSI_READY, REMOVE_FLAGS = 1 << 0, 1 << 1, 1 << 24
BROWN_OUT, PIN, POWER_ON = 1 << 25, 1 << 26, 1 << 27
SOFTWARE, WATCHDOG = 1 << 28, 1 << 29

CAUSES = {
    "power": BROWN_OUT | PIN | POWER_ON,
    "pin": PIN,
    "software": PIN | SOFTWARE,
    "watchdog": PIN | WATCHDOG,
}

AHB_DIVIDERS = (1,) * 8 + (2, 4, 8, 16, 64, 128, 256, 512)
APB_DIVIDERS = (1,) * 4 + (2, 4, 8, 16)


class Rcc(Peripheral):
    """At 0x40023800."""

    NAME = "RCC"
    REGISTERS = {
        0x00: "CR",
        0x04: "PLLCFGR",
        0x08: "CFGR",
        0x0C: "CIR",
        0x10: "AHB1RSTR",
        0x14: "AHB2RSTR",
        0x18: "AHB3RSTR",
        0x20: "APB1RSTR",
        0x24: "APB2RSTR",
        0x30: "AHB1ENR",
        0x34: "AHB2ENR",
        0x38: "AHB3ENR",
        0x40: "APB1ENR",
        0x44: "APB2ENR",
        0x50: "AHB1LPENR",
        0x54: "AHB2LPENR",
        0x58: "AHB3LPENR",
        0x60: "APB1LPENR",
        0x64: "APB2LPENR",
        0x70: "BDCR",
        0x74: "CSR",
        0x80: "SSCGR",
        0x84: "PLLI2SCFGR",
        0x88: "PLLSAICFGR",
        0x8C: "DCKCFGR",
        0x90: "CKGATENR",
        0x94: "DCKCFGR2",
    }
    RESET = {
        "CR": 0x83,
        "PLLCFGR": 0x2400_3010,
        "AHB1ENR": 0x0010_0000,
        "AHB1LPENR": 0x7E67_91FF,
        "AHB2LPENR": 0xF1,
        "AHB3LPENR": 1,
        "APB1LPENR": 0x36FE_C9FF,
        "APB2LPENR": 0x0007_5F33,
        "PLLI2SCFGR": 0x2000_3000,
    }

    def __init__(self, chip):
        # Peripherals by the register and bit that reset them.
        self.resettable = {}
        super().__init__(chip)
        self.why("power")

    def reset(self):
        flags = getattr(self, "values", {}).get("CSR", 0)
        super().reset()
        self.values["CSR"] = flags
        self._ready = {}
        self._update()

    def why(self, cause):
        """Adds what caused the reset to the flags (CSR), which stay until they are removed."""
        self.values["CSR"] |= CAUSES[cause]

    def clock_is_on(self, register, bit):
        """Is a peripheral's clock enabled?"""
        return bool(self.values[register] >> bit & 1)

    # Oscillators

    def read_CR(self):
        value = self.values["CR"]
        now = self.clock.now()
        ready = sum(1 << bit + 1 for bit, time in self._ready.items() if time <= now)
        return value & ~0x2A02_0002 | ready | (value & 1) << 1

    def found_ready(self, *bits):
        """These clocks were switched on a while ago."""
        self._ready.update((bit, self.clock.now()) for bit in bits)

    def write_CR(self, value):
        was = self.values["CR"]
        if was & HSE_ON:
            # How the clock from outside is connected can be said only while that is off (RM0090 7.3.1).
            value = value & ~BYPASSED | was & BYPASSED
        self.values["CR"] = value
        bypassed = bool(value & BYPASSED)
        delays = {16: BYPASS_READY_S if bypassed else CRYSTAL_READY_S, 24: PLL_READY_S, 26: PLL_READY_S, 28: PLL_READY_S}
        for bit, delay_s in delays.items():
            if not value >> bit & 1:
                self._ready.pop(bit, None)
            elif not was >> bit & 1 and (bit != 16 or self._crystal(bypassed)):
                self._ready[bit] = self.clock.now() + ticks(delay_s)
        self._update()

    def _crystal(self, bypassed):
        model = self.chip.model
        return self.chip.settings.crystal and bypassed == model.clock_is_external

    def read_CSR(self):
        value = self.values["CSR"]
        return value & ~LSI_READY | (LSI_READY if value & LSI_ON else 0)

    def write_CSR(self, value):
        flags = 0 if value & REMOVE_FLAGS else self.values["CSR"] & 0xFE00_0000
        self.values["CSR"] = flags | value & LSI_ON

    # The tree

    def read_CFGR(self):
        value = self.values["CFGR"]
        return value & ~0xC | (value & 3) << 2

    def write_CFGR(self, value):
        self.values["CFGR"] = value
        self._update()

    def write_PLLCFGR(self, value):
        if 24 in self._ready:
            raise Unmodelled("the firmware changed the PLL while it was on")
        self.values["PLLCFGR"] = value

    def _vco_hz(self):
        value = self.values["PLLCFGR"]
        source_hz = self.chip.model.crystal_hz if value & 1 << 22 else HSI_HZ
        input_hz = source_hz / (value & 0x3F)
        vco_hz = input_hz * (value >> 6 & 0x1FF)
        if not (0.95e6 <= input_hz <= 2.1e6 and 100e6 <= vco_hz <= 432e6):
            raise Unmodelled(f"the PLL would run at {vco_hz / 1e6} MHz from {input_hz / 1e6} MHz (RM0090 7.3.2)")
        return vco_hz

    def usb_hz(self):
        """The clock of the USB core."""
        return self._vco_hz() / (self.values["PLLCFGR"] >> 24 & 15)

    def _sys_hz(self):
        switch = self.values["CFGR"] & 3
        if switch == 0:
            return HSI_HZ
        needed = {1: 16, 2: 24}.get(switch)
        if needed is None or self._ready.get(needed, self.clock.now() + 1) > self.clock.now():
            raise Unmodelled("the firmware switched to a clock that is not ready")
        if switch == 1:
            return self.chip.model.crystal_hz
        return self._vco_hz() / (2 * (self.values["PLLCFGR"] >> 16 & 3) + 2)

    def _update(self):
        config = self.values["CFGR"]
        self.hclk_hz = self._sys_hz() / AHB_DIVIDERS[config >> 4 & 15]
        first, second = APB_DIVIDERS[config >> 10 & 7], APB_DIVIDERS[config >> 13 & 7]
        self.pclk1_hz, self.pclk2_hz = self.hclk_hz / first, self.hclk_hz / second
        self.timers1_hz = self.hclk_hz if first == 1 else 2 * self.pclk1_hz
        self.timers2_hz = self.hclk_hz if second == 1 else 2 * self.pclk2_hz
        self.timers1_ticks = round(TICKS_PER_S / self.timers1_hz)
        cycle = TICKS_PER_S / self.hclk_hz
        if cycle != int(cycle):
            raise Unmodelled(f"a processor clock of {self.hclk_hz} Hz does not fit the emulator's tick")
        flash, core = getattr(self.chip, "flash", None), getattr(self.chip, "core", None)
        if flash and self.hclk_hz > HZ_PER_WAIT_STATE * (flash.wait_states() + 1):
            raise Unmodelled(f"{flash.wait_states()} wait states of the flash are too few at {self.hclk_hz / 1e6} MHz")
        if core:
            core.set_clock(int(cycle))

    # Resets of single peripherals

    def _reset_bits(self, register, value):
        self.values[register] = value
        for bit in range(32):
            if value >> bit & 1 and (register, bit) in self.resettable:
                self.resettable[register, bit].reset()

    def write_AHB1RSTR(self, value):
        self._reset_bits("AHB1RSTR", value)

    def write_AHB2RSTR(self, value):
        self._reset_bits("AHB2RSTR", value)

    def write_APB1RSTR(self, value):
        self._reset_bits("APB1RSTR", value)

    def write_APB2RSTR(self, value):
        self._reset_bits("APB2RSTR", value)


# Falling thresholds of the voltage detector in mV by PWR_CR's PLS, and what a rise needs more (DS8626 table 19,
# DS10693 table 24, typical).
DETECTOR_MV = (2040, 2190, 2350, 2510, 2660, 2820, 2990, 3090)
HYSTERESIS_MV = 100


class Power(Peripheral):
    """PWR, at 0x40007000 (RM0090 5.4, RM0390 5.4)."""

    NAME = "PWR"
    REGISTERS = {0x0: "CR", 0x4: "CSR"}
    RESET = {"CR": 0xC000}

    def reset(self):
        super().reset()
        self._low = False

    def read_CSR(self):
        control = self.values["CR"]
        value = self.values["CSR"] & 0x300 | 1 << 14
        if self.chip.model.has_overdrive:
            value |= (control >> 16 & 1) << 16 | (control >> 17 & 1) << 17
        if control & 1 << 4:
            falling_mv = DETECTOR_MV[control >> 5 & 7]
            self._low = self.chip.supply_mv < falling_mv + (HYSTERESIS_MV if self._low else 0)
            value |= (1 << 2) if self._low else 0
        return value

    def write_CSR(self, value):
        self.values["CSR"] = value & 0x300
