"""An emulated board that runs an unmodified image.

python tests/emulator BOARD IMAGE [options]. Lines of JSON come on standard output: events as they happen, and a reply
to each command that comes on standard input. With --terminal the board's link is a pseudo terminal and time runs on by
itself; without it time passes only by the command `run`. It ends with its standard input.
"""

import argparse
import json
import os
import select
import sys

try:
    import elftools  # noqa: F401
    import unicorn  # noqa: F401
except ImportError as error:
    sys.exit(f"{error}: install tests/emulator/requirements.txt, or run: $(tests/python $(cat tests/emulator/requirements.txt)) tests/emulator …")

import wiper
from chip import MODELS, Chip, Settings
from clock import ticks
from control import Control
from peripheral import Unmodelled
from plant import Plant
from terminal import Terminal

# Between two looks at the terminal and at the commands.
SLICE_S = 2e-3
SLICE = ticks(SLICE_S)

# After so many slices without a byte either way nobody waits for the board, and it runs no faster than a clock: the
# program that has the port is at work itself.
QUIET = 50


def say(line):
    """A line for the test."""
    print(json.dumps(line), flush=True)


def arguments():
    """From the command line."""
    parser = argparse.ArgumentParser(prog="tests/emulator", description=__doc__.splitlines()[0])
    parser.add_argument("board", choices=sorted(MODELS))
    parser.add_argument("image", help="an .elf of that board")
    parser.add_argument("--cpi", type=float, default=2, help="cycles an instruction takes")
    parser.add_argument("--worst-flash", action="store_true", help="the longest erase and program times")
    parser.add_argument("--flash-beside", action="store_true", help="the flash stops nothing and interrupts nobody")
    parser.add_argument("--protect", type=int, nargs="*", default=[], help="sectors that must not be written to")
    parser.add_argument("--read-protection", type=int, default=0, choices=(0, 1, 2), help="its level, in the option bytes")
    parser.add_argument("--lsi-hz", type=int, default=32_000, help="the watchdog's oscillator, 17 to 47 kHz")
    parser.add_argument("--no-crystal", action="store_true", help="the crystal or the clock from outside is missing")
    parser.add_argument("--unique-id", type=bytes.fromhex, default=Settings.unique_id, help="96 bits, hexadecimal")
    parser.add_argument("--device-id", type=int, default=0, help="of another revision of the chip")
    parser.add_argument("--seed", type=int, default=1, help="of what memory holds at power-up")
    parser.add_argument("--leave", action="store_true", help="started by the bootloader instead of by power")
    parser.add_argument("--flash", help="what flash holds before the image, from its first byte on")
    parser.add_argument("--wiper", default="ramp", help="ramp, still, swing, or the path of a pendulum's socket")
    parser.add_argument("--encoder", default="still", help="still, ramp, or the path of a pendulum's socket")
    parser.add_argument("--terminal", action="store_true", help="the link is a pseudo terminal")
    return parser.parse_args()


def build(options):
    """The board, powered."""
    settings = Settings(
        cpi=options.cpi,
        worst_flash=options.worst_flash,
        flash_stops=not options.flash_beside,
        protected=tuple(options.protect),
        read_protection=options.read_protection,
        lsi_hz=options.lsi_hz,
        crystal=not options.no_crystal,
        seed=options.seed,
        unique_id=options.unique_id,
        device_id=options.device_id,
    )
    sources = {"ramp": wiper.ramp, "still": wiper.still, "swing": wiper.swing}
    wiper_shows, encoder_shows = (sources.get(name) or Plant(name) for name in (options.wiper, options.encoder))
    chip = Chip(options.board, settings, wiper_shows, encoder_shows, say)
    if options.flash:
        with open(options.flash, "rb") as file:
            data = file.read()
            chip.flash_memory.put(chip.flash_memory.address, data[: chip.flash_memory.size])
    chip.load(options.image)
    chip.power_on()
    if options.leave:
        chip.start_from_bootloader()
    return chip


class Commands:
    """Lines from standard input, whole ones only."""

    def __init__(self, control):
        self._control, self._bytes, self.ended = control, b"", False

    def take(self, wait_s):
        """Obeys what came; waits for it that long (None: until it comes)."""
        if b"\n" not in self._bytes and select.select([0], [], [], wait_s)[0]:
            piece = os.read(0, 65536)
            self.ended = not piece
            self._bytes += piece
        while b"\n" in self._bytes:
            line, self._bytes = self._bytes.split(b"\n", 1)
            say({"reply": self._control.obey(json.loads(line)), "now_s": self._control.now_s()})


def run_by_itself(chip, commands):
    """With the terminal as link."""
    terminal = Terminal()
    say({"terminal": terminal.name})
    n_quiet = 0
    while not commands.ended:
        commands.take(SLICE_S if n_quiet > QUIET else 0)
        if chip.host and chip.host.is_open != terminal.is_open():
            chip.host.open() if terminal.is_open() else chip.host.close()
        sent = terminal.read()
        if sent:
            chip.send(sent)
        received = chip.received()
        n_quiet = 0 if sent or received else n_quiet + 1
        if terminal.write(received):
            chip.run(SLICE)


def main():
    """Runs until the input ends, or until the firmware does what no model knows."""
    chip = build(arguments())
    commands = Commands(Control(chip))
    try:
        if "--terminal" in sys.argv:
            run_by_itself(chip, commands)
        while not commands.ended:
            commands.take(None)
    except Unmodelled as failure:
        chip.tell("failure", reason=str(failure))
        sys.exit(3)


main()
