"""A serial port. RM0090 30.6, RM0390 25.6: 8 data bits, with the DMA's streams 5 and 6 of DMA1 (USART2).

The PC is at the other end, with its own clock: a byte takes as long as its sender makes it.
"""

from clock import TICKS_PER_S, cancel
from dma import FROM_MEMORY, TO_MEMORY
from peripheral import Peripheral

INTERRUPT = 38
CHANNEL = 4
BITS = 10
# What the PC's programs choose.
BAUD = 921_600
# A receiver takes what deviates by less (RM0090 30.3.5: 3.3 % for 8 bits and OVER8 = 0).
MOST_DEVIATION = 0.033
# Bytes that leave between two looks at the clock.
AT_ONCE = 16

PARITY_ERROR, FRAMING, NOISE, OVERRUN, IDLE, RECEIVED, SENT, EMPTY = (1 << bit for bit in range(8))
ENABLE, OVERSAMPLING_8 = 1 << 13, 1 << 15
RECEIVER, TRANSMITTER = 1 << 2, 1 << 3
# Errors that a byte may come with. A break is a zero without its stop bit (RM0090 30.3.3); after an overrun the byte
# before is still there.
ERRORS = {"break": FRAMING, "framing": FRAMING, "noise": NOISE, "overrun": OVERRUN}
RECEIVES_BY_DMA, SENDS_BY_DMA, ERROR_INTERRUPT = 1 << 6, 1 << 7, 1 << 0


class Usart(Peripheral):
    """USART2, at 0x40004400."""

    NAME = "USART2"
    REGISTERS = {0x00: "SR", 0x04: "DR", 0x08: "BRR", 0x0C: "CR1", 0x10: "CR2", 0x14: "CR3", 0x18: "GTPR"}
    RESET = {"SR": SENT | EMPTY}
    _idle_event = _sent_event = None

    def __init__(self, chip):
        super().__init__(chip)
        streams = chip.dmas[1].streams
        self.from_pc, self.to_pc = streams[5], streams[6]
        self.to_pc.on_enabled = self._send
        # What has left towards the PC.
        self.output = bytearray()
        self.n_lost = 0

    def reset(self):
        super().reset()
        self._sending = 0
        self._single = bytearray()
        self._line_free_at = 0
        self._idle_event, self._sent_event = cancel(self._idle_event), cancel(self._sent_event)
        self._interrupt()

    def baud(self):
        """As the divider makes it."""
        divider = self.values["BRR"]
        if not divider:
            return 0
        if self.values["CR1"] & OVERSAMPLING_8:
            return self.chip.rcc.pclk1_hz / (8 * (divider >> 4) + (divider & 7))
        return self.chip.rcc.pclk1_hz / divider

    # To the PC

    def _send(self):
        control = self.values["CR1"]
        if self._sending or not control & ENABLE or not control & TRANSMITTER:
            return
        by_dma = self.values["CR3"] & SENDS_BY_DMA and self.to_pc.is_for(FROM_MEMORY, CHANNEL)
        self._sending = min(AT_ONCE, self.to_pc.left) if by_dma else len(self._single)
        if self._sending:
            self.values["SR"] &= ~(SENT | EMPTY)
            byte = round(BITS * TICKS_PER_S / self.baud())
            self._sent_event = self.clock.after(self._sending * byte, self._sent)

    def _sent(self):
        n, self._sending = self._sending, 0
        if self._single:
            self.output += self._single[:n]
            del self._single[:n]
        elif self.to_pc.is_for(FROM_MEMORY, CHANNEL):
            self.output += self.to_pc.take(n)
        self._send()
        if not self._sending:
            self.values["SR"] |= SENT | EMPTY
        self._interrupt()

    # From the PC

    def receive(self, data, baud):
        """The PC sends these bytes now, behind those it is sending."""
        byte = round(BITS * TICKS_PER_S / baud)
        start = max(self.clock.now(), self._line_free_at)
        for i, value in enumerate(data):
            self.clock.at(start + (i + 1) * byte, lambda value=value: self._arrives(value, baud))
        self._line_free_at = start + len(data) * byte

    def _arrives(self, value, baud):
        control = self.values["CR1"]
        if not control & ENABLE or not control & RECEIVER:
            self.n_lost += 1
            return
        if abs(self.baud() / baud - 1) > MOST_DEVIATION:
            # Its bits are sampled at wrong times.
            value ^= 0xA5
            self.values["SR"] |= FRAMING
        if self.values["CR3"] & RECEIVES_BY_DMA and self.from_pc.is_for(TO_MEMORY, CHANNEL):
            self.from_pc.give(bytes([value]))
        elif self.values["SR"] & RECEIVED:
            self.values["SR"] |= OVERRUN
            self.n_lost += 1
        else:
            self.values["DR"] = value
            self.values["SR"] |= RECEIVED
        cancel(self._idle_event)
        self._idle_event = self.clock.after(round(BITS * TICKS_PER_S / baud), self._idles)
        self._interrupt()

    def garble(self, error):
        """A byte comes with an error."""
        self.values["SR"] |= ERRORS[error]
        self._arrives(0 if error == "break" else 0x5A, BAUD)

    def _idles(self):
        self._idle_event = None
        self.values["SR"] |= IDLE
        self._interrupt()

    # Registers

    def _interrupt(self):
        status, control = self.values["SR"], self.values["CR1"]
        asserted = status & control & (IDLE | SENT | EMPTY)
        if control & RECEIVED and status & (RECEIVED | OVERRUN):
            asserted = True
        if self.values["CR3"] & ERROR_INTERRUPT and status & (FRAMING | NOISE | OVERRUN):
            asserted = True
        self.chip.nvic.set_line(INTERRUPT, bool(asserted))

    def write_SR(self, value):
        self.values["SR"] &= value | ~(RECEIVED | SENT)
        self._interrupt()

    def read_DR(self):
        # Reading SR, then this, clears the errors and IDLE (RM0090 30.6.1).
        self.values["SR"] &= ~(PARITY_ERROR | FRAMING | NOISE | OVERRUN | IDLE | RECEIVED)
        self._interrupt()
        return self.values["DR"]

    def write_DR(self, value):
        self._single.append(value & 0xFF)
        self._send()

    def write_CR1(self, value):
        self.values["CR1"] = value
        self._send()
        self._interrupt()

    def write_CR3(self, value):
        self.values["CR3"] = value
        self._send()
        self._interrupt()
