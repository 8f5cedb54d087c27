"""What a bootloader may leave running when it jumps to the program: the clock for its USB, interrupts on their way, a
DMA that writes on. AN2606 lists what ST's own one uses; others use other things.
"""

MHZ = 1_000_000
HSI_ON, HSE_ON, PLL_ON = 1 << 0, 1 << 16, 1 << 24
HSE_BIT, PLL_BIT = 16, 24
FROM_HSE, BY_4, BY_5 = 1 << 22, 1 << 16, 5 << 24
RUN_ON_PLL = 2
VCO_MHZ = 240
ONE_WAIT_STATE = 1

# Addresses, and what is written there, in this order.
LEFT = (
    # Clocks of DMA2 and of TIM5; a stream that would write what is converted over the program's memory, for ever.
    (0x4002_3830, 1 << 22),
    (0x4002_3840, 1 << 3),
    (0x4002_6418, 0x4001_204C),
    (0x4002_641C, 0x2000_0400),
    (0x4002_6414, 0xFFFF),
    (0x4002_6410, 1 << 13 | 1 << 11 | 1 << 10 | 1 << 8 | 1),
    # TIM5 counts to 1000 and interrupts.
    (0x4000_0C2C, 1000),
    (0x4000_0C0C, 1),
    (0x4000_0C00, 1),
    (0xE000_E104, 1 << 50 - 32),
    # The system timer interrupts a thousand times a second.
    (0xE000_E014, 60_000),
    (0xE000_E010, 7),
)


def leave_behind(chip):
    """Everything above, on 60 MHz from the PLL if there is a clock from outside."""
    if chip.settings.crystal:
        _speed_up(chip)
    for address, value in LEFT:
        chip.bus.write(address, 4, value)


def _speed_up(chip):
    chip.flash.write_ACR(ONE_WAIT_STATE)
    rcc = chip.rcc
    crystal_mhz = chip.model.crystal_hz // MHZ
    rcc.write_PLLCFGR(FROM_HSE | BY_5 | BY_4 | VCO_MHZ << 6 | crystal_mhz)
    rcc.write_CR(rcc.values["CR"] | HSI_ON | HSE_ON | PLL_ON)
    # Long ago.
    rcc.found_ready(HSE_BIT, PLL_BIT)
    rcc.write_CFGR(RUN_ON_PLL)
