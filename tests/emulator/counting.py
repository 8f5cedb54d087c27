"""Does Unicorn count instructions where core.py reads them? Fails with what to do if it does not.

core.py reads a private number of Unicorn, because a hook on every instruction would make the emulator twenty times
slower. Here such a hook counts beside it.
"""

import sys

from unicorn import Uc
from unicorn import arm_const as arm
from unicorn import unicorn_const as constants

import core
import memory

ADVICE = """Unicorn counts instructions elsewhere than tests/emulator/core.py reads them. Install the version in
tests/emulator/requirements.txt; or, for a newer one, look in its sources (uc_emu_start, uc_count_cb) for the number
that is compared with `count`, and let `counter_of` find it; then this has to pass again."""

# subs r0, #1; back to it while r0 is not zero; an endless loop.
LOOP = bytes.fromhex("0138fdd1fee7")
# Where nothing has run yet: what was translated before the hook was set would run without it.
AT = memory.RAM + 0x100


def main():
    uc = Uc(constants.UC_ARCH_ARM, constants.UC_MODE_THUMB | constants.UC_MODE_MCLASS)
    uc.ctl_set_cpu_model(arm.UC_CPU_ARM_CORTEX_M4)
    uc.mem_map(memory.RAM, memory.RAM_SIZE)
    try:
        counter, most = core.counter_of(uc)
    except RuntimeError as error:
        sys.exit(f"{error}\n{ADVICE}")
    seen = []
    uc.hook_add(constants.UC_HOOK_CODE, lambda *_: seen.append(1))
    uc.mem_write(AT, LOOP)
    for n in (2, 777, 100_000):
        seen.clear()
        uc.reg_write(arm.UC_ARM_REG_R0, 1 << 30)
        counter.value = 0
        uc.emu_start(AT | 1, core.NOWHERE, count=n)
        print(f"asked for {n}, executed {len(seen)}, counted {counter.value}, at most {most.value}")
        # The instruction at which the run ends is counted and not executed.
        if (len(seen), counter.value, most.value) != (n, n + 1, n):
            sys.exit(ADVICE)


main()
