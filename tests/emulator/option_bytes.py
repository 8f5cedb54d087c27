"""The option bytes: what protects the flash, and how the chip starts. RM0090 3.7 (tables 14 and 15), RM0390 3.6.

A program that runs from flash reads and writes it as ever, whatever the protection against reading says; who is shut out
are debug probes and the bootloader (RM0090 3.7.3).
"""

# By the level of protection against reading: none; against probes and the bootloader; the same, for ever.
READ_PROTECTION = (0xAA, 0x55, 0xCC)

# Software watchdog, no reset on entering Stop or Standby, no brown-out reset above the power-on reset.
USER = 0xEC

LOCKED = 1 << 0


def _bits(settings):
    """Protection against reading, and of each sector, where a zero protects against writing."""
    return READ_PROTECTION[settings.read_protection], 0xFFF & ~sum(1 << number for number in settings.protected)


def register(settings):
    """OPTCR after a reset (RM0090 3.9.10)."""
    protection, sectors = _bits(settings)
    return sectors << 16 | protection << 8 | USER | LOCKED


def in_memory(settings):
    """The same at 0x1FFFC000 and 0x1FFFC008."""
    protection, sectors = _bits(settings)
    rest = b"\xff" * 6
    return bytes([USER, protection]) + rest + sectors.to_bytes(2, "little") + rest
