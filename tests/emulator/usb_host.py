"""The PC at the other end of the USB cable: it enumerates and speaks CDC-ACM, and it can fail in every way.

USB 2.0 chapters 7.1.7 (attach, reset, suspend), 8.5 (transactions), 9.4 (requests); CDC PSTN 6.3. What the PC does is
written as generators that yield how long they wait.
"""

import struct
from collections import deque

import otg as device
from clock import TICKS_PER_S, ticks

DEBOUNCE = ticks(0.1)
RESET_FOR = ticks(0.05)
RECOVERY = ticks(0.01)
FRAME = ticks(1e-3)
SUSPENDS_AFTER = ticks(3e-3)
# A 64-byte packet with its token and handshake on a bus that carries 19 of them in a frame.
TRANSACTION = ticks(1e-3) // 19
# A controller asks again so soon after a NAK.
AGAIN = ticks(50e-6)
CONTROL_LIMIT = ticks(5.0)
ADDRESS = 7

GET_DESCRIPTOR = (0x80, 6)
SET_ADDRESS = (0x00, 5)
SET_CONFIGURATION = (0x00, 9)
SET_INTERFACE = (0x01, 11)
CLEAR_HALT = (0x02, 1)
SET_LINE_CODING = (0x21, 0x20)
SET_LINE_STATE = (0x21, 0x22)
DTR_RTS = 3


class Failed(Exception):
    """A request was not answered as it should be."""


class Host:
    """A PC with this cable."""

    def __init__(self, chip):
        self.chip, self.clock, self.otg = chip, chip.clock, chip.otg
        self.otg.host = self
        self.plugged = True
        # A bus without frames is suspended.
        self.awake = True
        self.configured = False
        # Does a program have the port open?
        self.is_open = True
        self.output = bytearray()
        self._to_device = deque()
        self._task = self._bulk = self._suspend_event = None
        self._bulk_free_at = 0
        self._address = 0
        self.serial = None
        self.endpoints = {}
        # Endpoints whose next packet is DATA1, by their addresses; a packet out of turn was sent before, and is dropped.
        self._data1 = set()
        self.n_repeated = 0

    # The cable

    def on_attached(self):
        """The device shows itself."""
        if self.plugged and self.awake:
            self._run(self._enumerate(DEBOUNCE))

    def on_detached(self):
        """The device is gone."""
        self.configured = False
        self._run(None)

    def unplug(self):
        """Pulls the cable; the board lives on from a battery."""
        self.plugged = False
        self._quiet()

    def plug(self):
        """Puts it back."""
        self.plugged = self.awake = True
        self._stop_suspend()
        if self.otg.is_connected():
            self.on_attached()

    def bus_reset(self):
        """The PC resets the port and enumerates anew, as after an error."""
        self._run(self._enumerate(0))

    def suspend(self):
        """The PC goes to sleep: no frames."""
        self.awake = False
        self._quiet()

    def resume(self):
        """The PC wakes, and finds the device as it left it."""
        self._stop_suspend()
        self.awake = True
        self.otg.bus_event(device.WAKE_UP)
        self.on_endpoint_changed()

    def go_on(self):
        """The bus goes on without a word, as behind a hub that lost its power for a moment."""
        self._stop_suspend()
        self.awake = True
        self.on_endpoint_changed()

    def wake_with_reset(self):
        """The PC wakes and resets the port, as after hibernation."""
        self._stop_suspend()
        self.awake = True
        self._run(self._enumerate(0))

    def die(self):
        """The PC is gone in the middle of whatever it was doing."""
        self.awake = False
        self._quiet()
        self._run(None)

    def _quiet(self):
        self._stop_suspend()
        self._suspend_event = self.clock.after(SUSPENDS_AFTER, lambda: self.otg.bus_event(device.SUSPEND))
        if not self.plugged:
            self.configured = False
            self._run(None)

    def is_quiet(self):
        """Is the bus suspended?"""
        return not (self.plugged and self.awake)

    def _stop_suspend(self):
        if self._suspend_event:
            self._suspend_event.cancel()
            self._suspend_event = None

    def frame_number(self):
        """Of the frame under way."""
        return self.clock.now() // FRAME & 0x7FF

    # Tasks

    def _run(self, task):
        self._current = task
        if self._task:
            self._task.cancel()
            self._task = None
        if task:
            self._step(task)

    def _step(self, task):
        if task is not self._current:
            return
        try:
            wait = next(task)
        except StopIteration:
            return
        except Failed as failure:
            self.chip.tell("usb", failed=str(failure))
            return
        self._task = self.clock.after(max(wait, 1), lambda: self._step(task))

    # Control transfers

    def _data(self, transaction, limit, what):
        """Repeats a transaction until it is not answered by NAK."""
        while True:
            answer = transaction()
            if answer != "nak":
                return answer
            if self.clock.now() > limit:
                raise Failed(f"{what} was answered by NAK for {CONTROL_LIMIT / TICKS_PER_S:.0f} s")
            yield AGAIN

    def _control(self, request, value=0, index=0, length=0, data=b"", gap=TRANSACTION):
        """A control transfer; gives what came, or None if it was refused. `gap` lies between request and data."""
        kind, number = request
        length = len(data) or length
        what = f"request {kind:#04x} {number:#04x}"
        limit = self.clock.now() + CONTROL_LIMIT
        if self.otg.address() != self._address:
            raise Failed(f"nobody answers at address {self._address}")
        self.otg.setup(struct.pack("<BBHHH", kind, number, value, index, length))
        yield gap
        came = b""
        if kind & 0x80 and length:
            while len(came) < length:
                packet = yield from self._data(lambda: self.otg.take(0), limit, what)
                if packet == "stall":
                    return None
                came += packet
                yield TRANSACTION
                if len(packet) < device.PACKET:
                    break
            status = yield from self._data(lambda: self.otg.out(0, b""), limit, what)
        else:
            for at in range(0, len(data), device.PACKET):
                packet = data[at : at + device.PACKET]
                answer = yield from self._data(lambda packet=packet: self.otg.out(0, packet), limit, what)
                if answer == "stall":
                    return None
                yield TRANSACTION
            status = yield from self._data(lambda: self.otg.take(0), limit, what)
        yield TRANSACTION
        if status == "stall":
            return None
        self._begin_with_data0(request, index)
        return came

    def _begin_with_data0(self, request, index):
        """After these requests both sides count from DATA0 on (USB 2.0, 9.1.1.5, 9.4.5)."""
        if request in (SET_CONFIGURATION, SET_INTERFACE):
            self._data1.clear()
        elif request == CLEAR_HALT:
            self._data1.discard(index)

    def _expect(self, *request, **rest):
        came = yield from self._control(*request, **rest)
        if came is None:
            raise Failed(f"request {request} was refused")
        return came

    def _string(self, number):
        if not number:
            return None
        came = yield from self._expect(GET_DESCRIPTOR, 3 << 8 | number, 0x409, 255)
        return came[2:].decode("utf-16-le")

    def _enumerate(self, after):
        self.configured = False
        yield after
        yield from self._reset_bus()
        descriptor = yield from self._expect(GET_DESCRIPTOR, 1 << 8, 0, 64)
        yield from self._reset_bus()
        yield from self._expect(SET_ADDRESS, ADDRESS)
        yield ticks(2e-3)
        self._address = ADDRESS
        descriptor = yield from self._expect(GET_DESCRIPTOR, 1 << 8, 0, 18)
        head = yield from self._expect(GET_DESCRIPTOR, 2 << 8, 0, 9)
        whole = yield from self._expect(GET_DESCRIPTOR, 2 << 8, 0, int.from_bytes(head[2:4], "little"))
        product = yield from self._string(descriptor[15])
        self.serial = yield from self._string(descriptor[16])
        self._find_endpoints(whole)
        yield from self._expect(SET_CONFIGURATION, 1)
        yield from self._expect(SET_LINE_CODING, 0, 0, data=struct.pack("<IBBB", 115_200, 0, 0, 8))
        yield from self._expect(SET_LINE_STATE, DTR_RTS if self.is_open else 0)
        self.configured = True
        vendor, product_id = struct.unpack_from("<HH", descriptor, 8)
        self.chip.tell("usb", vendor=vendor, product_id=product_id, product=product, serial=self.serial)
        self.on_endpoint_changed()

    def _reset_bus(self):
        self._address = 0
        self._stop_suspend()
        self.otg.bus_event(device.BUS_RESET)
        yield RESET_FOR
        self.otg.bus_event(device.ENUMERATED)
        yield RECOVERY

    def _find_endpoints(self, configuration):
        """The bulk endpoints of the data interface."""
        self.endpoints, at = {}, 0
        while at < len(configuration):
            length, kind = configuration[at], configuration[at + 1]
            if kind == 5 and configuration[at + 3] & 3 == 2:
                address = configuration[at + 2]
                self.endpoints["in" if address & 0x80 else "out"] = address & 15
            at += length

    def request(self, setup, data=b"", gap=TRANSACTION):
        """A raw control transfer of a strange program; it may end in anything but silence."""
        done = []
        kind, number, value, index, length = struct.unpack("<BBHHH", setup)

        def transfer():
            data_out = data[:length] if not kind & 0x80 else b""
            try:
                came = yield from self._control((kind, number), value, index, length, data_out, gap)
                done.append("refused" if came is None else came)
            except Failed as failure:
                done.append(failure)
            self.on_endpoint_changed()

        self._run(transfer())
        return done

    def abandon(self, setup, n_steps):
        """Begins a control transfer and gives it up after some steps of it."""
        kind, number, value, index, length = struct.unpack("<BBHHH", setup)
        task = self._control((kind, number), value, index, length, bytes(length) if not kind & 0x80 else b"")
        left = [n_steps]

        def some():
            for wait in task:
                left[0] -= 1
                if left[0] < 0:
                    return
                yield wait

        self._run(some())

    # The serial port

    def open(self):
        """A program opens the port."""
        self.is_open = True
        if self.configured:
            self._run(self._line_state(DTR_RTS))

    def close(self):
        """It closes it, or is killed."""
        self.is_open = False
        if self.configured:
            self._run(self._line_state(0))

    def _line_state(self, state):
        yield from self._expect(SET_LINE_STATE, state)
        self.on_endpoint_changed()

    def send(self, data):
        """A program writes to the port."""
        for at in range(0, len(data), device.PACKET):
            self._to_device.append(bytes(data[at : at + device.PACKET]))
        self.on_endpoint_changed()

    def _came(self, address, packet):
        if self.otg.sent_data1 == (address in self._data1):
            self.output += packet
            self._data1 ^= {address}
        else:
            self.n_repeated += 1

    def on_endpoint_changed(self):
        """Something may be ready to move."""
        if self.configured and self.awake and self.plugged and not self._bulk:
            time = max(self.clock.now() + TRANSACTION // 4, self._bulk_free_at)
            self._bulk = self.clock.at(time, self._move)

    def _move(self):
        self._bulk = None
        if not (self.configured and self.awake and self.plugged):
            return
        moved = False
        if self.is_open:
            packet = self.otg.take(self.endpoints["in"])
            if isinstance(packet, bytes):
                self._came(0x80 | self.endpoints["in"], packet)
                moved = True
        if self._to_device:
            address = self.endpoints["out"]
            answer = self.otg.out(address, self._to_device[0], address in self._data1)
            if answer == "ack":
                self._data1 ^= {address}
                self._to_device.popleft()
                moved = True
        self._bulk_free_at = self.clock.now() + (TRANSACTION if moved else AGAIN)
        if moved or self._to_device:
            self.on_endpoint_changed()
