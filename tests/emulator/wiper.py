"""What the potentiometer's wiper shows: codes of 14 bits, one a millisecond, from a pendulum or a rule.

The firmware averages conversions of 12 bits to codes of 14. So a code is spread over conversions such that any four of
them in a row have just that mean: what the firmware sends can be compared with what the pendulum did.
"""

import math

from clock import TICKS_PER_S

TICKS_PER_CODE = TICKS_PER_S // 1000
CODES_AT_ONCE = 64
FULL_SCALE = 4 * 4095


def ramp(first, n):
    """A code that counts milliseconds, away from the ends of the range: what comes late or not at all is seen."""
    return [1000 + (first + i) % 14_000 for i in range(n)]


def still(first, n):
    """A pendulum at rest."""
    return [FULL_SCALE // 2] * n


REST_S, LIFT_S, SWING_S = 0.5, 0.5, 11.0
OUTERMOST, PERIOD_S, FADES_S = 2800, 1.0, 2.5


def swing(first, n):
    """Hangs, is lifted by about a radian and let go, over and over: a cosine that fades."""
    return [FULL_SCALE // 2 + round(OUTERMOST * displaced((first + i) / 1000)) for i in range(n)]


def displaced(seconds):
    since_lift = seconds % (REST_S + LIFT_S + SWING_S) - REST_S
    if since_lift < LIFT_S:
        return max(since_lift, 0) / LIFT_S
    since = since_lift - LIFT_S
    return math.exp(-since / FADES_S) * math.cos(2 * math.pi * since / PERIOD_S)


class Codes:
    """`source(first, n)` gives the codes from millisecond `first` on; it is asked in order."""

    def __init__(self, source):
        self.source = source
        self._first, self._codes = 0, []

    def code(self, time):
        """The code at a time."""
        place = time // TICKS_PER_CODE - self._first
        while place >= len(self._codes):
            del self._codes[: max(0, min(place, len(self._codes)) - CODES_AT_ONCE)]
            self._refill()
            place = time // TICKS_PER_CODE - self._first
        return self._codes[place]

    def _refill(self):
        asked = self._next
        self._codes += self.source(asked, CODES_AT_ONCE)
        self._next = asked + CODES_AT_ONCE
        self._first = self._next - len(self._codes)

    _next = 0


class Wiper(Codes):
    """On one of the converter's channels."""

    def __init__(self, channel, source):
        super().__init__(source)
        self.channel = channel

    def conversions(self, channel, first, period, n):
        """Results of 12 bits."""
        if channel != self.channel:
            return [0] * n
        results, at = [], 0
        while at < n:
            time = first + at * period
            whole, rest = divmod(self.code(time), 4)
            end = (time // TICKS_PER_CODE + 1) * TICKS_PER_CODE
            n_same = min(n - at, -(-(end - time) // period))
            phase = self._phase
            four = [whole + ((phase + i & 3) < rest) for i in range(4)]
            results += (four * (n_same // 4 + 1))[:n_same]
            self._phase = phase + n_same & 3
            at += n_same
        return results

    _phase = 0
