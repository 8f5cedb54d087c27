"""The converter with its trigger, its requests to the DMA, and its overrun. RM0090 13.13, RM0390 13.13.

Conversions are not events: whoever looks at their results makes them happen up to now.
"""

import struct

from clock import TICKS_PER_S
from dma import TO_MEMORY
from peripheral import Peripheral, Unmodelled

SAMPLE_CYCLES = (3, 15, 28, 56, 84, 112, 144, 480)
CONVERSION_CYCLES = 12
PRESCALERS = (2, 4, 6, 8)
# DS8626 and DS10693, 12-bit converter: at most 36 MHz at 2.4 to 3.6 V.
MOST_HZ = 36e6

EOC, START_FLAG, OVERRUN = 1 << 1, 1 << 4, 1 << 5
POWER, DMA, DMA_GOES_ON, SOFTWARE_START = 1 << 0, 1 << 8, 1 << 9, 1 << 30
TRIGGERED_BY_TIM3 = 8
DMA_CHANNEL = 0


class Adc(Peripheral):
    """ADC1 at 0x40012000, with the registers common to all converters."""

    NAME = "ADC1"
    REGISTERS = {
        0x00: "SR",
        0x04: "CR1",
        0x08: "CR2",
        0x0C: "SMPR1",
        0x10: "SMPR2",
        0x2C: "SQR1",
        0x30: "SQR2",
        0x34: "SQR3",
        0x4C: "DR",
        0x300: "CSR",
        0x304: "CCR",
    }

    def __init__(self, chip):
        super().__init__(chip)
        self.stream = chip.dmas[2].streams[0]
        self.stream.before_look = self.catch_up
        chip.timers[3].listeners.append(self._on_triggers)

    def reset(self):
        super().reset()
        # Conversions under way: when the first ends, the time between two, how many.
        self._under_way = []
        self._busy_until = 0
        # How often its results began to go to the DMA.
        self.n_conversions = self.n_lost = self.n_starts = 0

    def _channel(self):
        if self.values["SQR1"] >> 20 & 15:
            raise Unmodelled("a sequence of several conversions")
        return self.values["SQR3"] & 31

    def _length(self):
        """Of a conversion, in ticks."""
        hz = self.chip.rcc.pclk2_hz / PRESCALERS[self.values["CCR"] >> 16 & 3]
        if hz > MOST_HZ:
            raise Unmodelled(f"the converter would run at {hz / 1e6} MHz")
        channel = self._channel()
        register, place = ("SMPR2", channel) if channel < 10 else ("SMPR1", channel - 10)
        cycles = SAMPLE_CYCLES[self.values[register] >> 3 * place & 7] + CONVERSION_CYCLES
        return round(cycles * TICKS_PER_S / hz)

    # Conversions

    def _on_triggers(self, first, period, n):
        control = self.values["CR2"]
        if not control & POWER or control >> 28 & 3 == 0 or control >> 24 & 15 != TRIGGERED_BY_TIM3:
            return
        length = self._length()
        # A trigger during a conversion is ignored.
        while n and first < self._busy_until:
            first, n = first + period, n - 1
        stride = -(-length // period)
        n = -(-n // stride)
        if n:
            self._under_way.append((first + length, stride * period, n))
            self._busy_until = first + (n - 1) * stride * period + length

    def catch_up(self):
        """Everything that has ended by now reaches the memory."""
        self.chip.timers[3].notice()
        now, waiting = self.clock.now(), []
        for end, period, n in self._under_way:
            n_done = min(n, (now - end) // period + 1) if end <= now else 0
            if n_done:
                self._deliver(end, period, n_done)
            if n_done < n:
                waiting.append((end + n_done * period, period, n - n_done))
        self._under_way = waiting

    def _deliver(self, first, period, n):
        codes = self.chip.wiper.conversions(self._channel(), first, period, n)
        self.n_conversions += n
        self.values["DR"] = codes[-1]
        self.values["SR"] |= EOC | START_FLAG
        if not self.values["CR2"] & DMA:
            return
        if self.values["SR"] & OVERRUN or not self.stream.is_for(TO_MEMORY, DMA_CHANNEL):
            # One result waits for the DMA; the next one overruns it, and the requests end (RM0090 13.8.2).
            self.n_lost += n
            if n > 1 or self._waits:
                self.values["SR"] |= OVERRUN
            self._waits = True
            return
        self._waits = False
        self.stream.give(struct.pack(f"<{n}H", *codes))

    _waits = False

    # Registers

    def read_SR(self):
        self.catch_up()
        return self.values["SR"]

    def write_SR(self, value):
        self.catch_up()
        self.values["SR"] &= value

    def read_DR(self):
        self.catch_up()
        self.values["SR"] &= ~EOC
        self._waits = False
        return self.values["DR"]

    def write_CR2(self, value):
        self.catch_up()
        if value & (POWER | DMA) and not value & DMA:
            self._waits = False
        self.n_starts += bool(value & ~self.values["CR2"] & DMA)
        self.values["CR2"] = value & ~SOFTWARE_START
        if value & SOFTWARE_START and value & POWER:
            self._under_way.append((self.clock.now() + self._length(), 1, 1))

    def read_CSR(self):
        return self.read_SR()

    def write_SMPR2(self, value):
        self.catch_up()
        self.values["SMPR2"] = value

    def write_SQR3(self, value):
        self.catch_up()
        self.values["SQR3"] = value
