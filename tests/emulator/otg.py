"""The USB core of the F405 as a full-speed device, down to its packets. RM0090 34.16 (registers), 34.17 (how to use them).

What the manual leaves open: an OUT endpoint whose NAK is cleared receives, enabled anew or not, as drivers that work
on chips rely on; an IN endpoint that was enabled stays so through a bus reset and through a SETUP packet, with an empty
FIFO once that is flushed, so that it never sends again until it has been disabled.
"""

from peripheral import Peripheral, Unmodelled

INTERRUPT = 67
N_ENDPOINTS = 4
PACKET = 64
FIFO_WORDS = 320

SETUP_RECEIVED, OUT_RECEIVED, OUT_DONE, SETUP_DONE = 6, 2, 3, 4

RX_NOT_EMPTY, EARLY_SUSPEND, SUSPEND, BUS_RESET, ENUMERATED = 1 << 4, 1 << 10, 1 << 11, 1 << 12, 1 << 13
IN_ENDPOINTS, OUT_ENDPOINTS, WAKE_UP = 1 << 18, 1 << 19, 1 << 31

ACTIVE, NAKS, STALL, CLEAR_NAK, SET_NAK, DISABLE, ENABLE = (1 << bit for bit in (15, 17, 21, 26, 27, 30, 31))
NEXT_IS_DATA1, SET_DATA0, SET_DATA1 = 1 << 16, 1 << 28, 1 << 29
# In DOEPTSIZ0: SETUP packets that endpoint 0 can still take.
SETUPS, SETUP_STEP = 3 << 29, 1 << 29
TRANSFER_DONE, DISABLED, SETUP_FLAG, NAK_EFFECTIVE, FIFO_EMPTY = 1 << 0, 1 << 1, 1 << 3, 1 << 6, 1 << 7
CONFIGURATION = 0x003C_87FF

AHB_IDLE, FLUSH_RX, FLUSH_TX, CORE_RESET = 1 << 31, 1 << 4, 1 << 5, 1 << 0
ALL_FIFOS = 16
SOFT_DISCONNECT = 1 << 1
# In DSTS.
FULL_SPEED, LINES_IDLE = 3 << 1, 1 << 0
GLOBAL_INTERRUPT = 1 << 0


class Endpoint:
    """One direction of an endpoint."""

    def __init__(self, number):
        self.number = number
        self.control = self.flags = self.size = 0
        # Data packets alternate between DATA0 and DATA1 (USB 2.0, 8.6); here for all endpoints but 0.
        self.data1 = False
        self.fifo = []

    def write_control(self, value):
        """What is kept, and what only acts."""
        kept = self.control & (ENABLE | NAKS)
        self.control = kept | value & (CONFIGURATION | ACTIVE | STALL)
        if value & SET_NAK:
            self.control |= NAKS
            self.flags |= NAK_EFFECTIVE
        if value & CLEAR_NAK:
            self.control &= ~NAKS
            self.flags &= ~NAK_EFFECTIVE
        if value & (SET_DATA0 | SET_DATA1):
            self.data1 = bool(value & SET_DATA1)
        if value & ENABLE:
            self.control |= ENABLE
        if value & DISABLE and self.control & ENABLE:
            self.control &= ~ENABLE
            self.flags |= DISABLED

    def read_control(self):
        """Endpoint 0 is always active."""
        return self.control | (ACTIVE if self.number == 0 else 0) | (NEXT_IS_DATA1 if self.data1 else 0)

    def is_active(self):
        """May the host use it?"""
        return bool(self.read_control() & ACTIVE)

    def length(self):
        """Bytes of the transfer."""
        return self.size & 0x7FFFF if self.number else self.size & 0x7F


class Otg(Peripheral):
    """At 0x50000000."""

    NAME = "OTG_FS"
    REGISTERS = {
        0x000: "GOTGCTL",
        0x004: "GOTGINT",
        0x008: "GAHBCFG",
        0x00C: "GUSBCFG",
        0x010: "GRSTCTL",
        0x014: "GINTSTS",
        0x018: "GINTMSK",
        0x01C: "GRXSTSR",
        0x020: "GRXSTSP",
        0x024: "GRXFSIZ",
        0x028: "DIEPTXF0",
        0x038: "GCCFG",
        0x03C: "CID",
        0x050: "HWCFG4",
        0x104: "DIEPTXF1",
        0x108: "DIEPTXF2",
        0x10C: "DIEPTXF3",
        0x800: "DCFG",
        0x804: "DCTL",
        0x808: "DSTS",
        0x810: "DIEPMSK",
        0x814: "DOEPMSK",
        0x818: "DAINT",
        0x81C: "DAINTMSK",
        0x834: "DIEPEMPMSK",
        0xE00: "PCGCCTL",
    }
    RESET = {"CID": 0x1200, "DCTL": SOFT_DISCONNECT, "GUSBCFG": 0x1440}

    def __init__(self, chip):
        # The host at the other end of the cable is told what changes; see usb_host.py.
        self.host = None
        super().__init__(chip)

    def reset(self):
        super().reset()
        self.events = 0
        self.inward = [Endpoint(n) for n in range(N_ENDPOINTS)]
        self.outward = [Endpoint(n) for n in range(N_ENDPOINTS)]
        # What waits in the receive FIFO: status, words, and what happens when the status has been taken.
        self.received = []
        self._words = []
        self._interrupt()
        if self.host:
            self.host.on_detached()

    # Registers

    def read(self, offset):
        if offset >= 0x1000:
            return self._words.pop(0) if self._words else 0
        for base, endpoints in ((0x900, self.inward), (0xB00, self.outward)):
            if base <= offset < base + 0x20 * N_ENDPOINTS:
                return self._read_endpoint(endpoints[offset - base >> 5], offset & 0x1F, endpoints is self.inward)
        return super().read(offset)

    def write(self, offset, value, size=4):
        if offset >= 0x1000:
            self._fill(offset // 0x1000 - 1, value)
            return
        for base, endpoints in ((0x900, self.inward), (0xB00, self.outward)):
            if base <= offset < base + 0x20 * N_ENDPOINTS:
                self._write_endpoint(endpoints[offset - base >> 5], offset & 0x1F, value)
                self._interrupt()
                return
        super().write(offset, value, size)
        self._interrupt()

    def _read_endpoint(self, endpoint, place, is_in):
        if place == 0x00:
            return endpoint.read_control()
        if place == 0x08:
            empty = FIFO_EMPTY if is_in and not endpoint.fifo else 0
            return endpoint.flags | empty
        if place == 0x10:
            return endpoint.size
        if place == 0x18 and is_in:
            return self._fifo_words(endpoint.number) - len(endpoint.fifo)
        raise self._unknown("read", 0x900 + place)

    def _write_endpoint(self, endpoint, place, value):
        if place == 0x00:
            endpoint.write_control(value)
            if self.host:
                self.host.on_endpoint_changed()
        elif place == 0x08:
            endpoint.flags &= ~value
        elif place == 0x10:
            endpoint.size = value
        else:
            raise self._unknown("wrote", 0x900 + place)

    def _fifo_words(self, number):
        return (self.values[f"DIEPTXF{number}"] >> 16) or 16

    def _fill(self, number, word):
        endpoint = self.inward[number]
        if len(endpoint.fifo) >= self._fifo_words(number):
            raise Unmodelled(f"the firmware overfilled the FIFO of endpoint {number}")
        endpoint.fifo.append(word)
        if self.host and 4 * len(endpoint.fifo) >= endpoint.length():
            self.host.on_endpoint_changed()

    def read_GRSTCTL(self):
        return AHB_IDLE

    def write_GRSTCTL(self, value):
        if value & FLUSH_TX:
            which = value >> 6 & 31
            for endpoint in self.inward:
                if which in (endpoint.number, ALL_FIFOS):
                    endpoint.fifo.clear()
        if value & FLUSH_RX:
            self.received.clear()
            self._words.clear()
        if value & CORE_RESET:
            self.reset()

    def read_GINTSTS(self):
        inward, outward = self._pending()
        value = self.events | (RX_NOT_EMPTY if self.received else 0)
        return value | (IN_ENDPOINTS if inward else 0) | (OUT_ENDPOINTS if outward else 0)

    def write_GINTSTS(self, value):
        self.events &= ~value

    def read_GRXSTSR(self):
        return self.received[0][0] if self.received else 0

    def read_GRXSTSP(self):
        if not self.received:
            return 0
        status, self._words, after = self.received.pop(0)
        if after:
            after()
        self._interrupt()
        return status

    def read_DSTS(self):
        if not self.host:
            return FULL_SPEED
        return FULL_SPEED | self.host.frame_number() << 8 | (LINES_IDLE if self.host.is_quiet() else 0)

    def read_DAINT(self):
        inward, outward = self._pending(everything=True)
        return outward << 16 | inward

    def write_DCTL(self, value):
        was = self.values["DCTL"]
        self.values["DCTL"] = value
        if self.host and (was ^ value) & SOFT_DISCONNECT:
            if value & SOFT_DISCONNECT:
                self.host.on_detached()
            else:
                self.host.on_attached()

    def _pending(self, everything=False):
        mask = 0xFFFF_FFFF if everything else self.values["DAINTMSK"]
        inward = outward = 0
        for endpoint in self.inward:
            flags = endpoint.flags & self.values["DIEPMSK"]
            if self.values["DIEPEMPMSK"] >> endpoint.number & 1 and not endpoint.fifo:
                flags |= FIFO_EMPTY
            inward |= bool(flags) << endpoint.number
        for endpoint in self.outward:
            outward |= bool(endpoint.flags & self.values["DOEPMSK"]) << endpoint.number
        return inward & mask, outward & mask >> 16

    def _interrupt(self):
        enabled = self.values["GAHBCFG"] & GLOBAL_INTERRUPT
        asserted = bool(enabled and self.read_GINTSTS() & self.values["GINTMSK"])
        self.chip.nvic.set_line(INTERRUPT, asserted)

    # What the host does

    def is_connected(self):
        """Does the pull-up show a device?"""
        return not self.values["DCTL"] & SOFT_DISCONNECT

    def bus_event(self, event):
        """Reset, end of enumeration, suspend, wake-up."""
        if event == BUS_RESET:
            for endpoint in self.inward[1:] + self.outward[1:]:
                endpoint.control &= ~ACTIVE
        self.events |= event
        self._interrupt()

    def address(self):
        """That the device answers to."""
        return self.values["DCFG"] >> 4 & 0x7F

    def setup(self, packet):
        """A SETUP packet; it is always taken."""
        for endpoint in (self.inward[0], self.outward[0]):
            endpoint.control = endpoint.control & ~STALL | NAKS
        if self.outward[0].size & SETUPS:
            self.outward[0].size -= SETUP_STEP
        self._receive(0, SETUP_RECEIVED, packet, None)

        def done():
            self.outward[0].flags |= SETUP_FLAG

        self._receive(0, SETUP_DONE, b"", done)
        self._interrupt()

    def out(self, number, packet, data1=None):
        """An OUT packet: "ack", "nak" or "stall"; None if nobody answers. A packet out of turn is taken for the one
        before, come again, and forgotten."""
        endpoint = self.outward[number]
        if not endpoint.is_active():
            return None
        if endpoint.control & STALL:
            return "stall"
        waiting = sum(len(words) + 1 for _, words, _ in self.received)
        if endpoint.control & NAKS or waiting + PACKET // 4 + 2 > self.values["GRXFSIZ"]:
            return "nak"
        if number and data1 != endpoint.data1:
            return "ack"
        endpoint.data1 = not endpoint.data1
        endpoint.control |= NAKS

        def done():
            endpoint.flags |= TRANSFER_DONE

        self._receive(number, OUT_RECEIVED, packet, None)
        self._receive(number, OUT_DONE, b"", done)
        self._interrupt()
        return "ack"

    def _receive(self, number, status, packet, after):
        words = [int.from_bytes(packet[i : i + 4], "little") for i in range(0, len(packet), 4)]
        self.received.append((number | len(packet) << 4 | status << 17, words, after))

    def take(self, number):
        """What the device sends for an IN token: bytes, "nak" or "stall"; None if nobody answers. `sent_data1`
        says whether they were DATA1."""
        endpoint = self.inward[number]
        if not endpoint.is_active():
            return None
        if endpoint.control & STALL:
            return "stall"
        length = endpoint.length()
        is_ready = endpoint.control & ENABLE and not endpoint.control & NAKS and 4 * len(endpoint.fifo) >= length
        if not is_ready:
            return "nak"
        n_words = -(-length // 4)
        packet = b"".join(word.to_bytes(4, "little") for word in endpoint.fifo[:n_words])[:length]
        del endpoint.fifo[:n_words]
        endpoint.control &= ~ENABLE
        endpoint.size = 0
        endpoint.flags |= TRANSFER_DONE
        self.sent_data1 = endpoint.data1
        endpoint.data1 = not endpoint.data1
        self._interrupt()
        return packet
