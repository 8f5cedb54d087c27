"""Virtual time: a counter that only the emulator moves, and what is to happen when.

The tick divides a cycle of every clock the boards use (8, 12, 16, 48, 168 and 180 MHz), so that none is rounded.
"""

import ctypes
import heapq
import itertools

TICKS_PER_S = 5_040_000_000

NEVER = float("inf")


def ticks(seconds):
    """A time in ticks."""
    return round(seconds * TICKS_PER_S)


def seconds(n_ticks):
    """Ticks as a time."""
    return n_ticks / TICKS_PER_S


class Event:
    """Something that will happen, unless it is cancelled."""

    __slots__ = ("time", "action")

    def __init__(self, time, action):
        self.time, self.action = time, action

    def cancel(self):
        """It will not happen."""
        self.action = None


def cancel(event):
    """Nothing instead of an event that may be there."""
    if event:
        event.cancel()


class Clock:
    """The time now, and what comes next."""

    def __init__(self):
        self._settled = 0
        self._queue = []
        self._order = itertools.count()
        # While the processor runs, the instructions it has done are part of the time: see Core.
        self.instructions, self.ticks_per_instruction = ctypes.c_uint64(), 0

    def now(self):
        """Ticks since power came on for the first time."""
        return self._settled + self.instructions.value * self.ticks_per_instruction

    def move_to(self, time):
        """Lets the time pass, without what was to happen meanwhile."""
        self._settled = max(self._settled, time)

    def at(self, time, action):
        """Calls `action` at that time; gives the event, to be cancelled."""
        event = Event(time, action)
        heapq.heappush(self._queue, (time, next(self._order), event))
        return event

    def after(self, n_ticks, action):
        """Calls `action` so many ticks from now."""
        return self.at(self.now() + n_ticks, action)

    def next(self):
        """When the next thing happens."""
        queue = self._queue
        while queue and queue[0][2].action is None:
            heapq.heappop(queue)
        return queue[0][0] if queue else NEVER

    def happen(self):
        """Lets everything happen that is due."""
        while self.next() <= self._settled:
            event = heapq.heappop(self._queue)[2]
            action, event.action = event.action, None
            action()
