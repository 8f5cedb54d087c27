"""A chip on its board: memories, peripherals, power, and how it starts."""

from dataclasses import dataclass

from elftools.elf.elffile import ELFFile

import bootloader
import dfuse
import memory
import option_bytes
import system
from adc import Adc
from clock import Clock, seconds
from core import Core
from dma import Dma
from encoder import Encoder
from flash import Flash
from iwdg import Watchdog
from nvic import Nvic
from otg import Otg
from peripheral import Bus, Unmodelled
from pins import ExternalInterrupts, Gpio, SystemConfiguration
from rcc import Power, Rcc
from timers import Timer
from usart import BAUD, Usart
from usb_host import Host
from wiper import Wiper


@dataclass(frozen=True)
class Model:
    """What differs between the boards."""

    name: str
    flash_kb: int
    has_ccm: bool
    has_overdrive: bool
    crystal_hz: int
    # A clock from outside bypasses the oscillator.
    clock_is_external: bool
    wiper_channel: int
    device_id: int
    link: str


# DS8626 and Adafruit's schematic; DS10693 and UM1724.
MODELS = {
    "feather-f405": Model("feather-f405", 1024, True, False, 12_000_000, False, 4, 0x1007_6413, "usb"),
    "nucleo-f446": Model("nucleo-f446", 512, False, True, 8_000_000, True, 0, 0x1000_6421, "uart"),
}

SUPPLY_MV = 3300
UNIQUE_ID = bytes.fromhex("2b00350013513038353635 32".replace(" ", ""))

AHB1, AHB2, APB1, APB2 = "AHB1", "AHB2", "APB1", "APB2"


@dataclass
class Settings:
    """What may be different from chip to chip and from test to test."""

    cpi: float = 2
    worst_flash: bool = False
    lsi_hz: int = 32_000
    crystal: bool = True
    seed: int = 1
    # The processor stands still while the flash works, which interrupts when it has done.
    flash_stops: bool = True
    # Sectors that the option bytes protect against writing.
    protected: tuple = ()
    # Level of their protection against reading.
    read_protection: int = 0
    unique_id: bytes = UNIQUE_ID
    # Of a revision that is not the model's.
    device_id: int = 0


class Chip:
    """Powered, running `image`."""

    def __init__(self, model, settings, source, turns, on_event=lambda event: None):
        self.model, self.settings, self.on_event = MODELS[model], settings, on_event
        self.clock = Clock()
        self.core = self.nvic = None
        self.supply_mv = SUPPLY_MV
        self.wants_reset = self.has_stopped = None
        self.n_resets = 0
        self.code = []
        self._make_memories()
        self.wiper = Wiper(self.model.wiper_channel, source)
        self.encoder = Encoder(turns)
        self.bus = Bus(self)
        self._make_peripherals()
        self.core = Core(self, settings.cpi)
        self.syscfg.reset()

    def _make_memories(self):
        self.flash_memory = memory.Region(memory.FLASH, self.model.flash_kb * 1024, 0xFF)
        self.ram = memory.Region(memory.RAM, memory.RAM_SIZE)
        self.rom = memory.rom(self.model.flash_kb, self.settings.unique_id, option_bytes.in_memory(self.settings))
        self.rams = [self.ram]
        if self.model.has_ccm:
            self.rams.append(memory.Region(memory.CCM, memory.CCM_SIZE))
        self.memories = [self.flash_memory, self.rom, *self.rams]

    def _make_peripherals(self):
        self.flash = None
        self.nvic = self.bus.attach(0xE000_E100, Nvic(self), 0x400)
        system.attach(self)
        self.rcc = self.bus.attach(0x4002_3800, Rcc(self))
        self.flash = self.bus.attach(0x4002_3C00, Flash(self))
        self.power = self._attach(0x4000_7000, Power(self), APB1, 28)
        self.ports = {letter: Gpio(self, letter) for letter in "ABCDEFGHI"}
        for i, port in enumerate(self.ports.values()):
            self._attach(0x4002_0000 + 0x400 * i, port, AHB1, i)
        self.syscfg = self._attach(0x4001_3800, SystemConfiguration(self), APB2, 14)
        self.bus.attach(0x4001_3C00, ExternalInterrupts(self))
        self.dmas = {1: Dma(self, 1), 2: Dma(self, 2)}
        self._attach(0x4002_6000, self.dmas[1], AHB1, 21)
        self._attach(0x4002_6400, self.dmas[2], AHB1, 22)
        self.timers = {number: Timer(self, number) for number in (2, 3, 4, 5)}
        for number, timer in self.timers.items():
            self._attach(0x4000_0000 + 0x400 * (number - 2), timer, APB1, number - 2)
        self.dmas[1].streams[2].before_look = self.timers[3].notice
        self.adc = self._attach(0x4001_2000, Adc(self), APB2, 8)
        self.usart = self._attach(0x4000_4400, Usart(self), APB1, 17)
        self.watchdog = self.bus.attach(0x4000_3000, Watchdog(self))
        self.otg = self.host = None
        if self.model.link == "usb":
            self.otg = self._attach(0x5000_0000, Otg(self), AHB2, 7, 0x2_0000)
            self.host = Host(self)
        self.peripherals = list(dict.fromkeys(peripheral for _, peripheral in self.bus.blocks.values()))

    def _attach(self, address, peripheral, bus, bit, size=0x400):
        """With the bits of RCC that clock and reset it."""
        self.rcc.resettable[bus + "RSTR", bit] = peripheral
        peripheral.clocked_by = (bus + "ENR", bit)
        return self.bus.attach(address, peripheral, size)

    # Image and start

    def load(self, path):
        """Writes an image into flash; the rest of the flash stays as it was."""
        with open(path, "rb") as file:
            for segment in ELFFile(file).iter_segments():
                data, address = segment.data(), segment["p_paddr"]
                if segment["p_type"] == "PT_LOAD" and data and address >= memory.FLASH:
                    self.flash_memory.put(address, data)
                    self.code.append((address, address + len(data) - 1))
                    if segment["p_flags"] & 1:
                        self.core.watch(data, address)

    def probe(self, path):
        """What a debug probe does, if the flash is not protected against it: it resets the chip, halts the processor before
        its first instruction, writes an image, and leaves it at that.
        """
        if self.settings.read_protection:
            self.tell("refused", whom="probe")
            return
        self._reset("software")
        self.has_stopped = "probe"
        self.code = []
        self.load(path)
        self.core.forget_code()
        self.tell("probe")

    def download(self, path):
        """What the bootloader does with a DfuSe file: it erases the sectors that the file touches, writes, and leaves."""
        if self.has_stopped != "bootloader":
            raise Unmodelled("a download without the bootloader running")
        if self.settings.read_protection:
            self.tell("refused", whom="bootloader")
            return
        with open(path, "rb") as file:
            parts = dfuse.elements(file.read())
        erased = self.flash.erase_for_bootloader(parts)
        self.code = [(address, address + len(data) - 1) for address, data in parts]
        for address, data in parts:
            self.flash_memory.put(address, data)
            self.core.watch(data, address)
        self.core.forget_code()
        self.tell("download", erased=erased, bytes=[len(data) for _, data in parts])
        self.start_from_bootloader()

    def power_on(self, keeps_memory=False):
        """RAM holds noise, or still what it held."""
        for i, ram in enumerate(() if keeps_memory else self.rams):
            ram.noise(self.settings.seed + i)
        self.supply_mv = SUPPLY_MV
        self._reset("power")

    def start_from_bootloader(self):
        """As its `leave` does: it jumps to the program without a reset, its own memory still at address 0."""
        self._reset("software")
        self.syscfg.write_MEMRMP(1)
        bootloader.leave_behind(self)
        stack, entry = (self.flash_memory.word(memory.FLASH + offset) for offset in (0, 4))
        self.core.reset(stack, entry, masked=True)

    def request_reset(self, cause):
        """At the end of this instruction."""
        self.wants_reset = cause
        self.core.stop()

    def restart(self):
        """As asked for."""
        cause, self.wants_reset = self.wants_reset, None
        self.n_resets += 1
        self._reset(cause)

    def _reset(self, cause):
        self.tell("reset", cause=cause)
        if cause == "power":
            self.rcc.values["CSR"] = 0
        for peripheral in self.peripherals:
            peripheral.reset()
        self.rcc.why(cause)
        self.has_stopped = None
        self.core.reset(self.vector_word(0), self.vector_word(4))

    def vector_word(self, offset):
        """Of the vector table in use."""
        address = self.scb.values["VTOR"] + offset
        if address < memory.FLASH:
            region = self.core._at_zero
            return region.word(region.address + address)
        region = next(region for region in self.memories if region.address <= address < region.address + region.size)
        return region.word(address)

    def vector(self, number):
        """Where the handler of an exception begins."""
        return self.vector_word(4 * number)

    def bootloader_runs(self):
        """The program jumped into the ROM, or an interrupt did."""
        if self.settings.read_protection > 1:
            raise Unmodelled("no manual says what a bootloader does that is entered at level 2 of read protection")
        self.has_stopped = "bootloader"
        # Its interrupts are looked up where the processor looks.
        self.tell("bootloader", vectors=self.scb.values["VTOR"])

    # Time and news

    def run(self, n_ticks):
        """Lets virtual time pass."""
        self.core.run(self.clock.now() + n_ticks)

    def tell(self, what, **facts):
        """Something worth knowing has happened."""
        self.on_event({"at_s": round(seconds(self.clock.now()), 6), "event": what, **facts})

    def send(self, data, baud=BAUD):
        """The PC sends bytes over the board's link."""
        if self.host:
            self.host.send(data)
        else:
            self.usart.receive(data, baud)

    def received(self):
        """What the PC got since it was asked last."""
        output = self.host.output if self.host else self.usart.output
        data = bytes(output)
        output.clear()
        return data
