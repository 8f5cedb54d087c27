"""The independent watchdog. RM0090 21.4, RM0390 20.4. Its oscillator runs at 17 to 47 kHz (DS8626 table 34)."""

from clock import cancel, seconds, ticks
from peripheral import Peripheral, Unmodelled

START, FEED, ALLOW = 0xCCCC, 0xAAAA, 0x5555


class Watchdog(Peripheral):
    """At 0x40003000. Once started only a reset stops it."""

    NAME = "IWDG"
    REGISTERS = {0x0: "KR", 0x4: "PR", 0x8: "RLR", 0xC: "SR"}
    RESET = {"RLR": 0xFFF}
    _event = None

    def reset(self):
        super().reset()
        self._event = cancel(self._event)
        self.fed_at = None
        self.longest_unfed = 0

    def _period(self):
        divider = 4 << min(self.values["PR"], 6)
        return ticks((self.values["RLR"] + 1) * divider / self.chip.settings.lsi_hz)

    def write_KR(self, value):
        if value == START and self.fed_at is None:
            self.fed_at = self.clock.now()
            self.chip.tell("watchdog", period_s=seconds(self._period()))
        elif value == FEED and self.fed_at is not None:
            self.longest_unfed = max(self.longest_unfed, self.clock.now() - self.fed_at)
            self.fed_at = self.clock.now()
        elif value not in (START, FEED, ALLOW):
            raise Unmodelled(f"IWDG_KR has no key {value:#x}")
        self._look_again()

    def wait(self, n_ticks):
        """A debugger has stopped it for so long (RM0090 21.3.3)."""
        if self.fed_at is not None:
            self.fed_at += n_ticks

    def write_RLR(self, value):
        self.values["RLR"] = value & 0xFFF
        self._look_again()

    def _look_again(self):
        if self.fed_at is not None and self._event is None:
            self._event = self.clock.at(self.fed_at + self._period(), self._bite)

    def _bite(self):
        """The event is late on purpose: each feeding only moves the time at which it looks again."""
        self._event = None
        if self.clock.now() < self.fed_at + self._period():
            self._look_again()
        else:
            self.chip.request_reset("watchdog")
