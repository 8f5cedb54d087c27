"""What a test can do to a board, by name. Commands and replies are lines of JSON; docs/board-emulator.md says what for."""

from clock import TICKS_PER_S, seconds, ticks
from usart import BAUD


class Control:
    """The board in a test's hands. Each public method is a command."""

    def __init__(self, chip):
        self._chip = chip

    def obey(self, command):
        """`{"do": name, …arguments}`; gives what the reply says."""
        arguments = dict(command)
        name = arguments.pop("do")
        if name.startswith("_") or name == "obey":
            raise ValueError(f"no command {name}")
        return getattr(self, name)(**arguments) or {}

    # Time and link

    def now_s(self):
        """Virtual time."""
        return seconds(self._chip.clock.now())

    def run(self, s, send="", baud=BAUD):
        """The PC sends these bytes (hexadecimal), time passes; gives what the PC got."""
        chip = self._chip
        if send:
            chip.send(bytes.fromhex(send), baud)
        chip.run(ticks(s))
        return {"received": chip.received().hex()}

    def look(self):
        """Counters of the board."""
        chip, now = self._chip, self._chip.clock.now()
        watchdog = chip.watchdog
        unfed = 0 if watchdog.fed_at is None else max(watchdog.longest_unfed, now - watchdog.fed_at)
        return {
            "instructions": chip.core.n_instructions,
            "asleep_s": seconds(chip.core.ticks_asleep),
            "erases": chip.flash.n_erases,
            "resets": chip.n_resets,
            "longest_unfed_s": seconds(unfed),
            "sampling_s": chip.timers[3].period_s(),
            "conversions": chip.adc.n_conversions,
            "converter_starts": chip.adc.n_starts,
            "stopped": chip.has_stopped,
            "usb_configured": bool(chip.host and chip.host.configured),
            "serial": chip.host.serial if chip.host else None,
            "usb_repeated": chip.host.n_repeated if chip.host else 0,
        }

    def garble(self, error):
        """A byte reaches the serial port with an error: "break", "framing", "noise" or "overrun"."""
        self._chip.usart.garble(error)

    # Power, image, processor

    def power(self, on=True, keeps_memory=False):
        """Power goes and comes back; memory holds noise, or what it held if that was short; flash, what was torn."""
        if on:
            self._chip.power_on(keeps_memory)

    def supply(self, mv):
        """The supply's voltage."""
        self._chip.supply_mv = mv

    def reset(self):
        """The reset pin."""
        self._chip.request_reset("pin")

    def probe(self, image):
        """A debug probe writes another image; the processor stands still until a reset."""
        self._chip.probe(image)

    def leave(self):
        """The bootloader starts the program."""
        self._chip.start_from_bootloader()

    def download(self, image):
        """The bootloader writes a DfuSe file and starts what it wrote, as dfu-util tells it to."""
        self._chip.download(image)

    def jump(self, address):
        """The processor goes on elsewhere, as through a wild pointer."""
        self._chip.core.jump_to(address)

    def stall(self, s):
        """The processor stands still from here on, as where it needs the flash while that erases; all else goes on."""
        self._chip.core.stall_until(self._chip.clock.now() + ticks(s))

    def halt(self, s):
        """A debugger halts the processor and lets it go on; what it has not been told to stop goes on meanwhile."""
        self.stall(s)
        if self._chip.debug.stops_watchdog():
            self._chip.watchdog.wait(ticks(s))

    def stack_above_guard(self, bytes):
        """The stack has grown until so many bytes above what the memory protection closes."""
        ((_, last),) = self._chip.mpu.guarded
        self._chip.core.move_stack_to(last + 1 + bytes)

    def poke(self, address, data):
        """Other bytes in memory."""
        self._region(address).put(address, bytes.fromhex(data))

    def peek(self, address, length):
        """Bytes of the memory."""
        return {"data": self._region(address).take(address, length).hex()}

    def _region(self, address):
        return next(region for region in self._chip.memories if region.address <= address < region.address + region.size)

    # The USB cable

    def usb(self, what):
        """unplug, plug, bus_reset, suspend, resume, go_on, wake_with_reset, die, open or close."""
        allowed = ("unplug", "plug", "bus_reset", "suspend", "resume", "go_on", "wake_with_reset", "die", "open", "close")
        if what not in allowed:
            raise ValueError(f"USB knows no {what}")
        getattr(self._chip.host, what)()

    def request(self, setup, data="", within=1.0, gap_s=50e-6):
        """A control transfer as a strange program makes it: what came, "refused" or a failure."""
        done = self._chip.host.request(bytes.fromhex(setup), bytes.fromhex(data), ticks(gap_s))
        end = self._chip.clock.now() + ticks(within)
        while not done and self._chip.clock.now() < end:
            self._chip.run(TICKS_PER_S // 2000)
        if not done:
            return {"answer": "none"}
        return {"answer": done[0].hex() if isinstance(done[0], bytes) else str(done[0])}

    def abandon(self, setup, steps):
        """A control transfer that the PC gives up after some steps."""
        self._chip.host.abandon(bytes.fromhex(setup), steps)

    def bus(self, reads=(), writes=()):
        """Registers, as a debug probe sees them."""
        for address, value in writes:
            self._chip.bus.write(address, 4, value)
        return {"values": [self._chip.bus.read(address, 4) for address in reads]}
