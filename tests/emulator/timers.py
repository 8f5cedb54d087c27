"""The general-purpose timers. RM0090 18.4, RM0390 17.4: up-counting, compare without output, one timer counting
another, TIM4 counting the edges of an encoder, updates of TIM3 asking for the DMA.

TIM2 and TIM5 have 32 bits, TIM3 and TIM4 have 16.
"""

import struct

from clock import NEVER, TICKS_PER_S, cancel
from dma import TO_MEMORY
from peripheral import Peripheral, Unmodelled

INTERRUPTS = {2: 28, 3: 29, 4: 30, 5: 50}
WIDTHS = {2: 32, 3: 16, 4: 16, 5: 32}

# Which timer drives which input of another (RM0090 table 93).
DRIVERS = {(2, 2): 3, (2, 3): 4, (3, 1): 2, (3, 3): 4}

RUNS, NO_UPDATE, ONLY_OVERFLOW, PRELOADED = 1 << 0, 1 << 1, 1 << 2, 1 << 7
UPDATE_TRIGGERS = 2
COUNTS_TRIGGERS = 7
COUNTS_BOTH_EDGES = 3
# The encoder's timer; its pins PB6 and PB7 in their alternate function 2 (DS8626 table 9); where its count is.
ENCODERS = 4
ENCODERS_PINS = ("B", (6, 7), 2)
ENCODERS_COUNT = 0x4000_0824
# Both inputs directly, not inverted, enabled.
INPUTS, DIRECT = 0x0303, 0x0101
# Updates of TIM3 ask stream 2 of DMA1, on its channel 5 (RM0090 table 42).
ASKS_DMA = 1 << 8
ASKED = {3: (1, 2, 5)}
CHANNELS = ((1, "CCR1"), (2, "CCR2"), (3, "CCR3"), (4, "CCR4"))


class Timer(Peripheral):
    """One of them."""

    _event = _driver = None
    # Where the encoder was when the count was `_base`.
    _encoder, _turned = None, 0

    REGISTERS = {
        0x00: "CR1",
        0x04: "CR2",
        0x08: "SMCR",
        0x0C: "DIER",
        0x10: "SR",
        0x14: "EGR",
        0x18: "CCMR1",
        0x1C: "CCMR2",
        0x20: "CCER",
        0x24: "CNT",
        0x28: "PSC",
        0x2C: "ARR",
        0x34: "CCR1",
        0x38: "CCR2",
        0x3C: "CCR3",
        0x40: "CCR4",
        0x50: "OR",
    }

    def __init__(self, chip, number):
        self.NAME, self.number = f"TIM{number}", number
        self.mask = (1 << WIDTHS[number]) - 1
        self.RESET = {"ARR": self.mask}
        # Told of this timer's updates: when the first was, the time between two, how many.
        self.listeners = []
        super().__init__(chip)
        for name in ("CCR1", "CCR2", "CCR3", "CCR4", "DIER"):
            offset = next(offset for offset, known in self.REGISTERS.items() if known == name)
            self.writers[offset] = lambda value, name=name: self._set(name, value)

    def reset(self):
        super().reset()
        self._let_go()
        # The counter had the value `_base` at `_since`; everything up to the count `_seen` has been noticed.
        self._base, self._since, self._seen = 0, self.clock.now(), 0
        # Until this count there is nothing to notice.
        self._next = 0
        self._event = cancel(self._event)
        self._prescaler = 0
        self._interrupt()

    # Counting

    def _tick(self):
        return self.chip.rcc.timers1_ticks * (self._prescaler + 1)

    def _modulus(self):
        return self.values["ARR"] + 1

    def _is_clocked(self):
        return self.values["CR1"] & RUNS and self._driver is None and self._encoder is None

    def count_at(self, time):
        """Of an encoder, at a time that is past."""
        if not self._is_wired():
            return self._base
        return self._base + self._encoder.code(time) - self._turned

    def _count(self):
        """Without the wraps taken out."""
        if self._is_clocked():
            return self._base + (self.clock.now() - self._since) // self._tick()
        if self._encoder and self.values["CR1"] & RUNS:
            return self.count_at(self.clock.now())
        return self._base

    def _time_of(self, count):
        return self._since + (count - self._base) * self._tick()

    def notice(self):
        """Flags and triggers of everything that happened since the last look; gives the count."""
        if self._driver:
            self._driver.notice()
        count = self._count()
        if count > self._seen and not self._encoder:
            seen, self._seen = self._seen, count
            if count >= self._next:
                self._notice_between(seen, count)
        return count

    def _notice_between(self, seen, count):
        modulus = self._modulus()
        n_updates = count // modulus - seen // modulus
        status = self.values["SR"]
        if n_updates:
            status |= 1
        for channel, compare in CHANNELS:
            place = self.values[compare]
            if not status >> channel & 1 and place < modulus and (count - place) // modulus > (seen - place) // modulus:
                status |= 1 << channel
        self.values["SR"] = status
        # Every update counts, and each match until it is flagged.
        self._next = min((count // modulus + 1) * modulus, self._next_of(count, 0x1E))
        if not n_updates or not self._is_clocked():
            return
        first = self._time_of((seen // modulus + 1) * modulus)
        if self._triggers_on_update():
            self._trigger(first, n_updates)
        if self.values["DIER"] & ASKS_DMA:
            self._ask_dma(first, n_updates)

    def _next_of(self, count, wanted):
        """At which count one of these flags comes next, if it is not set yet."""
        wanted, modulus = wanted & ~self.values["SR"], self._modulus()
        nearest = (count // modulus + 1) * modulus if wanted & 1 else NEVER
        for channel, compare in CHANNELS:
            if wanted >> channel & 1:
                place = self.values[compare]
                if place < modulus:
                    nearest = min(nearest, ((count - place) // modulus + 1) * modulus + place)
        return nearest

    def _ask_dma(self, first, n):
        """A count of the encoder's timer for each update."""
        if self.number not in ASKED:
            raise Unmodelled(f"{self.NAME} asks for the DMA")
        controller, number, channel = ASKED[self.number]
        stream = self.chip.dmas[controller].streams[number]
        if not stream.is_for(TO_MEMORY, channel):
            return
        if self.chip.dmas[controller].values[f"S{number}PAR"] != ENCODERS_COUNT:
            raise Unmodelled("the DMA carries something else than the encoder's count")
        counter, period = self.chip.timers[ENCODERS], self._modulus() * self._tick()
        counts = [counter.count_at(first + i * period) & counter.mask for i in range(n)]
        stream.give(struct.pack(f"<{n}H", *counts))

    def _triggers_on_update(self):
        """An update is a trigger whether the counter or software made it (RM0090 18.4.2, MMS)."""
        return self.values["CR2"] >> 4 & 7 == UPDATE_TRIGGERS

    def _trigger(self, first, n):
        for listener in self.listeners:
            listener(first, self._modulus() * self._tick(), n)

    def _restart(self, count=None):
        """From this count on, with the settings as they are now."""
        count = self._count() if count is None else count
        self._since = self.clock.now()
        self._base = self._seen = count % self._modulus()
        self._next = 0
        if self._encoder:
            self._turned = self._encoder.code(self._since)

    def _on_triggers(self, first, period, n):
        if self.values["CR1"] & RUNS:
            self._base += n
            self.notice_driven()

    def notice_driven(self):
        """Counting another timer's triggers sets flags, too."""
        count, modulus = self._base, self._modulus()
        if count >= modulus:
            self.values["SR"] |= 1
        self._base = self._seen = count % modulus

    # Interrupts

    def _interrupt(self):
        self.chip.nvic.set_line(INTERRUPTS[self.number], bool(self.values["SR"] & self.values["DIER"] & 0x1F))

    def _schedule(self):
        wanted = self.values["DIER"] & 0x1F & ~self.values["SR"]
        nearest = self._next_of(self._seen, wanted) if wanted and self._is_clocked() else NEVER
        time = self._time_of(nearest) if nearest < NEVER else None
        if self._event and self._event.time == time:
            return
        self._event = cancel(self._event)
        if time is not None:
            self._event = self.clock.at(time, self._on_event)

    def _on_event(self):
        self._event = None
        self._changed()

    def _changed(self):
        self.notice()
        self._interrupt()
        self._schedule()

    # Registers

    def _set(self, name, value):
        self.notice()
        self.values[name] = value & self.mask
        self._next = 0
        self._changed()

    def write_CR1(self, value):
        if value & ~(RUNS | NO_UPDATE | ONLY_OVERFLOW | PRELOADED):
            raise Unmodelled(f"{self.NAME} counts upwards only here; CR1 = {value:#x}")
        self.notice()
        self._restart()
        self.values["CR1"] = value
        self._since = self.clock.now()
        self._changed()

    def write_CR2(self, value):
        self.notice()
        self.values["CR2"] = value

    def write_SMCR(self, value):
        self.notice()
        self._restart()
        self.values["SMCR"] = value
        self._let_go()
        mode, source = value & 7, value >> 4 & 7
        if mode == 0:
            return
        if mode == COUNTS_BOTH_EDGES and self.number == ENCODERS:
            self._follow()
            return
        number = DRIVERS.get((self.number, source))
        if mode != COUNTS_TRIGGERS or number is None:
            raise Unmodelled(f"{self.NAME}: slave mode {mode} from input {source}")
        self._driver = self.chip.timers[number]
        self._driver.notice()
        self._driver.listeners.append(self._on_triggers)

    def _follow(self):
        """The encoder, from now on."""
        if self.values["CCMR1"] & INPUTS != DIRECT or self.values["CCER"] & 0xFF & ~0x11:
            raise Unmodelled(f"{self.NAME}: inputs of an encoder other than direct and not inverted")
        self._encoder = self.chip.encoder
        self._turned = self._encoder.code(self._since)

    def _is_wired(self):
        """Its pins are its own."""
        letter, pins, function = ENCODERS_PINS
        port = self.chip.ports[letter].values
        return all(
            port["MODER"] >> 2 * pin & 3 == 2 and port["AFRL" if pin < 8 else "AFRH"] >> 4 * (pin % 8) & 15 == function
            for pin in pins
        )

    def _let_go(self):
        """Counts no other timer's triggers any more, and no encoder's edges."""
        self._encoder = None
        if self._driver:
            self._driver.listeners.remove(self._on_triggers)
            self._driver = None

    def read_SR(self):
        self.notice()
        return self.values["SR"]

    def write_SR(self, value):
        self.notice()
        self.values["SR"] &= value
        self._next = 0
        self._changed()

    def write_EGR(self, value):
        if value & ~1:
            raise Unmodelled(f"{self.NAME} made an event by software: EGR = {value:#x}")
        if value & 1:
            self.notice()
            self._prescaler = self.values["PSC"]
            self._restart(0)
            if not self.values["CR1"] & ONLY_OVERFLOW:
                self.values["SR"] |= 1
            if self._triggers_on_update():
                self._trigger(self.clock.now(), 1)
            self._changed()

    def read_CNT(self):
        return self.notice() % self._modulus()

    def write_CNT(self, value):
        self.notice()
        self._restart(value & self.mask)
        self._changed()

    def write_PSC(self, value):
        # It takes effect at the next update; the firmware makes one, or never changes it while counting.
        self.values["PSC"] = value & 0xFFFF
        if not self.values["CR1"] & RUNS and value == 0:
            self._prescaler = 0

    def write_ARR(self, value):
        self.notice()
        count = self._count() % self._modulus()
        self.values["ARR"] = value & self.mask
        self._restart(count)
        self._changed()

    def period_s(self):
        """From one update to the next."""
        return self._modulus() * self._tick() / TICKS_PER_S
