"""The board's serial port as a pseudo terminal. While a program has it open nothing is lost: time waits for the reader."""

import os
import pty
import select
import tty

CHUNK = 4096
# A reader that takes nothing is looked at this often.
PATIENCE_MS = 20


class Terminal:
    """What the PC's programs open."""

    def __init__(self):
        self._master, slave = pty.openpty()
        self.name = os.ttyname(slave)
        tty.setraw(slave)
        # Only once it has been closed can be seen whether anybody has it open.
        os.close(slave)
        os.set_blocking(self._master, False)
        self._poll = select.poll()
        self._poll.register(self._master, select.POLLIN)
        self._waiting = b""

    def is_open(self):
        """Has a program opened it?"""
        return not any(event & select.POLLHUP for _, event in self._poll.poll(0))

    def read(self):
        """What the program wrote."""
        try:
            return os.read(self._master, CHUNK)
        except (BlockingIOError, OSError):
            return b""

    def write(self, data):
        """For the program; false while it does not take what it was given before."""
        self._waiting += data
        if not self.is_open():
            self._waiting = b""
        if self._waiting:
            try:
                self._waiting = self._waiting[os.write(self._master, self._waiting) :]
            except BlockingIOError:
                select.select([], [self._master], [], PATIENCE_MS / 1000)
        return not self._waiting
