"""The Cortex-M4: instructions by Unicorn; time, exceptions and sleep here.

PM0214 2.3.7 (exception entry and return), 2.5 (sleep). Unicorn executes instructions and knows neither interrupts nor
time. It is started for so many instructions as fit until the next thing happens, and stopped at what changes the order
of things: a register that raises an interrupt, an instruction that unmasks interrupts, sleep, an exception's return.
"""

import ctypes
import struct

from unicorn import Uc, UcError
from unicorn import arm_const as arm
from unicorn import unicorn_const as constants
from unicorn.unicorn_py3 import unicorn as binding

import memory
from clock import TICKS_PER_S
from nvic import HARD_FAULT
from peripheral import Unmodelled
from rcc import HSI_HZ

PERIPHERALS = ((0x4000_0000, 0x8_0000), (0x5000_0000, 0x4_0000), (0xE000_0000, 0x10_0000))

# Never reached: emulation ends by count or by request.
NOWHERE = 0xFFFF_FFFE
EXCEPTION_RETURN = 0xFFFF_FFE0
MOST_AT_ONCE = 20_000_000

# Cycles to enter or leave an exception (PM0214 2.3.7).
EXCEPTION_CYCLES = 12

WFI = b"\x30\xbf"
CPSIE_I = b"\x62\xb6"
MSR_PRIMASK = b"\x10\x88"

THUMB = 1 << 24
STACK_WAS_ALIGNED_DOWN = 1 << 9
FP_IN_USE = 1 << 2

# What a register's access calls: engine, offset, size (and value). What was handed over comes last, and is left out here:
# each argument takes time.
ON_READ = ctypes.CFUNCTYPE(ctypes.c_uint64, ctypes.c_void_p, ctypes.c_uint64, ctypes.c_uint)
ON_WRITE = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_uint64, ctypes.c_uint, ctypes.c_uint64)
# What the beginning of a block calls; where it lies is known.
ON_BLOCK = ctypes.CFUNCTYPE(None)

_INTEGER = ["R0", "R1", "R2", "R3", "R12", "LR", "PC", "XPSR", "SP", "CONTROL", "PRIMASK"]
_FLOAT = [f"D{i}" for i in range(8)] + ["FPSCR"]
_REST = ["R4", "R5", "R6", "R7", "R8", "R9", "R10", "R11", "BASEPRI", "FAULTMASK"]


_read_registers, _write_registers = binding.uclib.uc_reg_read_batch, binding.uclib.uc_reg_write_batch


class Registers:
    """Several registers at once: one call instead of one for each."""

    def __init__(self, uc, names):
        self._handle, self._n = uc._uch, len(names)
        self._ids = (ctypes.c_int * self._n)(*(getattr(arm, "UC_ARM_REG_" + name) for name in names))
        self.values = (ctypes.c_uint64 * self._n)()
        base = ctypes.addressof(self.values)
        self._places = (ctypes.c_void_p * self._n)(*(base + 8 * i for i in range(self._n)))

    def read(self):
        """From the processor to `values`."""
        _read_registers(self._handle, self._ids, self._places, self._n)
        return self.values

    def write(self):
        """From `values` to the processor."""
        _write_registers(self._handle, self._ids, self._places, self._n)


def counter_of(uc):
    """Where Unicorn counts the instructions of a run: a number in its engine for which there is no call.

    Its neighbour holds the most that may run; a run of a known length tells them. Gives both.
    """
    spin, n_run = memory.RAM, 0x3A5B
    uc.mem_write(spin, b"\xfe\xe7")
    uc.emu_start(spin | 1, NOWHERE, count=n_run)
    engine = uc._uch.value
    for offset in range(0, 4096, 8):
        if ctypes.c_uint64.from_address(engine + offset).value == n_run + 1:
            if ctypes.c_uint64.from_address(engine + offset + 8).value == n_run:
                return [ctypes.c_uint64.from_address(engine + offset + at) for at in (0, 8)]
    raise RuntimeError("this version of Unicorn counts elsewhere; install the one in tests/emulator/requirements.txt")


class Core:
    """The processor of a chip."""

    def __init__(self, chip, cpi):
        self.chip, self.clock, self.cpi = chip, chip.clock, cpi
        self.nvic = chip.nvic
        self.uc = uc = Uc(constants.UC_ARCH_ARM, constants.UC_MODE_THUMB | constants.UC_MODE_MCLASS)
        uc.ctl_set_cpu_model(arm.UC_CPU_ARM_CORTEX_M4)
        read_only = constants.UC_PROT_READ | constants.UC_PROT_EXEC
        for region in chip.memories:
            rights = constants.UC_PROT_ALL if region in chip.rams else read_only
            uc.mem_map_ptr(region.address, region.size, rights, region.pointer())
        self._at_zero = None
        self._on_block = ON_BLOCK(self._on_unmasked)
        self._callbacks = []
        for base, size in PERIPHERALS:
            self._map_registers(base, size)
        uc.hook_add(constants.UC_HOOK_MEM_READ_PROT, self._on_guarded)
        uc.hook_add(constants.UC_HOOK_MEM_WRITE_PROT, self._on_protected_write)
        self._counter, self._most = counter_of(uc)
        self._counter.value = self._most.value = 0
        # Between two runs the values of `_integer` are the processor's.
        self._integer, self._float, self._rest = Registers(uc, _INTEGER), Registers(uc, _FLOAT), Registers(uc, _REST)
        self._primask, self._pc = Registers(uc, ["PRIMASK"]), Registers(uc, ["PC"])
        self._hooked = set()
        self._closed, self._guards_anew = [], False
        self.ram = chip.ram
        self.n_instructions = 0
        self.ticks_asleep = 0
        self.set_clock(TICKS_PER_S // HSI_HZ)
        self.take_clock()
        self.clock.instructions = self._counter

    def _map_registers(self, base, size):
        """Past Unicorn's own wrapper, which takes longer than most registers."""
        bus = self.chip.bus

        def on_read(_, offset, n_bytes):
            try:
                return bus.read(base + offset, n_bytes)
            except Exception as failure:
                return self._fails(failure)

        def on_write(_, offset, n_bytes, value):
            try:
                bus.write(base + offset, n_bytes, value)
            except Exception as failure:
                self._fails(failure)

        callbacks = ON_READ(on_read), ON_WRITE(on_write)
        # They live as long as the processor.
        self._callbacks.append(callbacks)
        read, write = (ctypes.cast(callback, ctypes.c_void_p) for callback in callbacks)
        error = binding.uclib.uc_mmio_map(self.uc._uch, base, size, read, None, write, None)
        if error != constants.UC_ERR_OK:
            raise UcError(error)

    def _fails(self, failure):
        """The run ends with the first failure."""
        self.uc._hook_exception = self.uc._hook_exception or failure
        self.uc.emu_stop()
        return 0

    # Clock, memory and start

    def set_clock(self, ticks_per_cycle):
        """From the next run on."""
        self._next_cycle = ticks_per_cycle
        self.stop()

    def take_clock(self):
        """Uses the clock that was set; not while running."""
        self.ticks_per_cycle = self._next_cycle
        self.clock.ticks_per_instruction = round(self.cpi * self.ticks_per_cycle)
        if self._guards_anew:
            self._take_guards()

    def map_at_zero(self, region):
        """Which memory is seen at address 0 (SYSCFG_MEMRMP)."""
        if self._at_zero is region:
            return
        if self._at_zero is not None:
            self.uc.mem_unmap(0, self._at_zero.size)
        read_only = constants.UC_PROT_READ | constants.UC_PROT_EXEC
        self.uc.mem_map_ptr(0, region.size, read_only, region.pointer())
        self._at_zero = region

    def watch(self, code, address):
        """Notices unmasking in this code. Bytes that only look like it are never executed as such.

        Unmasking ends a block of translated code, and a hook on where the next one begins costs nothing elsewhere; a hook
        on an instruction is looked for at all of them.
        """
        for at in range(0, len(code) - 3, 2):
            here = code[at : at + 2]
            is_msr = here == MSR_PRIMASK and code[at - 2 : at - 1] < b"\x90" and code[at - 1 : at] == b"\xf3"
            if here == CPSIE_I or is_msr:
                self._hook_block(address + at + 2)

    def guard(self):
        """The MPU closes other ranges, from the next run on."""
        self._guards_anew = True
        self.stop()

    def _take_guards(self):
        """Unicorn closes whole pages; hooks on these addresses would make every access a slow one. The handler of hard
        faults may go everywhere (PM0214 4.2.6).
        """
        self._guards_anew = False
        closing = [] if self._is_faulting() else self.chip.mpu.guarded
        for rights, ranges in ((constants.UC_PROT_ALL, self._closed), (constants.UC_PROT_NONE, closing)):
            for first, last in ranges:
                self.uc.mem_protect(first, last + 1 - first, rights)
        self._closed = closing

    def _on_guarded(self, uc, access, address, *_):
        self.chip.scb.on_forbidden(address)
        self._trapped_at = self._pc.read()[0]
        self.stop()
        return True

    def _is_guarded(self, begin, end):
        """Is any of these addresses forbidden now?"""
        return any(begin <= last and first <= end for first, last in self._closed)

    def _is_faulting(self):
        return any(number == HARD_FAULT for number, _ in self.nvic.active)

    def _hook_block(self, address):
        """Notices where a block of translated code begins; past Unicorn's own wrapper, as for the registers."""
        if address in self._hooked:
            return
        self._hooked.add(address)
        handle, place = ctypes.byref(ctypes.c_size_t()), ctypes.c_uint64(address)
        kind, action = constants.UC_HOOK_BLOCK, ctypes.cast(self._on_block, ctypes.c_void_p)
        error = binding.uclib.uc_hook_add(self.uc._uch, handle, kind, action, None, place, place)
        if error != constants.UC_ERR_OK:
            raise UcError(error)

    def reset(self, stack, entry, masked=False):
        """Starts at `entry`, as after a reset or as a bootloader jumps, which may have masked all interrupts."""
        for registers in (self._integer, self._float, self._rest):
            for i in range(len(registers.values)):
                registers.values[i] = 0
        values = self._integer.values
        values[5], values[6], values[7], values[8] = 0xFFFF_FFFF, entry, THUMB, stack
        values[10] = int(masked)
        for registers in (self._rest, self._float, self._integer):
            registers.write()
        self.pc = entry | 1
        self.asleep = self.locked = False
        self.stalled_until = 0
        self.take_clock()

    def jump_to(self, address):
        """As a wild pointer would."""
        self.asleep = False
        self.pc = address | 1

    def move_stack_to(self, address):
        """As a program does that calls ever deeper."""
        self._integer.values[8] = address
        self._integer.write()

    def forget_code(self):
        """Flash holds other instructions than those that were translated."""
        self.uc.ctl_flush_tb()

    def stop(self):
        """Ends the run that is under way, if there is one, after this instruction.

        Unicorn's own stop, called while a register is accessed, would do the instruction again.
        """
        self._most.value = self._counter.value

    def must_take(self):
        """Is an interrupt to be taken at once? Where all are masked, and where another one is being handled, the run ends
        by itself before the next may be taken.
        """
        return self.nvic.next() is not None and not self._primask.read()[0]

    def stall_until(self, time):
        """The flash is busy: no instruction can be fetched."""
        self.stalled_until = max(self.stalled_until, time)
        self.stop()

    # Running

    def run(self, until):
        """Until this time."""
        clock, nvic, chip = self.clock, self.nvic, self.chip
        while True:
            clock.happen()
            if chip.wants_reset:
                chip.restart()
                continue
            now = clock.now()
            if now >= until:
                return
            limit = min(clock.next(), until)
            if now < self.stalled_until:
                clock.move_to(min(limit, self.stalled_until))
                continue
            is_out = self.locked or chip.has_stopped
            if nvic.candidates and not is_out:
                self._take_interrupt()
            if self.asleep or is_out:
                self.ticks_asleep += limit - now
                clock.move_to(limit)
                continue
            self._execute(limit)

    def _take_interrupt(self):
        number = self.nvic.next()
        if number is None:
            return
        if self.asleep:
            # Even a masked one wakes.
            self.asleep = False
        if not self._integer.values[10]:
            self._enter(number)

    def _execute(self, limit):
        n = -(-(limit - self.clock.now()) // self.clock.ticks_per_instruction)
        n = min(max(n, 2), MOST_AT_ONCE)
        error = binding.uclib.uc_emu_start(self.uc._uch, self.pc, NOWHERE, 0, n)
        # The instruction that found the end of the run was counted, not executed.
        # Sleep, a fault and an exception's return end it without one.
        n_counted = self._counter.value
        ended_early = n_counted <= self._most.value
        n_executed = n_counted if ended_early else self._most.value
        self._counter.value = n_executed
        self.clock.move_to(self.clock.now())
        self.n_instructions += n_executed
        self._counter.value = 0
        self.pc = self._integer.read()[6] | 1
        self.take_clock()
        if self.uc._hook_exception is not None:
            failure, self.uc._hook_exception = self.uc._hook_exception, None
            raise failure
        self.chip.flash.settle()
        if self.pc >= EXCEPTION_RETURN:
            self._leave()
        elif self.pc - 1 == memory.BOOTLOADER_ENTRY:
            self.chip.bootloader_runs()
        elif error != constants.UC_ERR_OK or self._trapped_at is not None:
            self.pc = (self.pc if self._trapped_at is None else self._trapped_at) | 1
            self._fault(error)
        elif ended_early and bytes(self.uc.mem_read(self.pc - 3, 2)) == WFI:
            self.asleep = True
        self._trapped_at = None

    # Where an instruction was stopped by a fault.
    _trapped_at = None

    def _fault(self, error):
        if self._is_faulting():
            # A fault within the handler of faults: only a reset helps (PM0214 2.4.4).
            self.locked = True
            self.chip.tell("lockup", pc=f"{self.pc - 1:#010x}")
            return
        self.chip.tell("fault", pc=f"{self.pc - 1:#010x}", reason=str(UcError(error)))
        self.chip.scb.on_fault()
        self._enter(HARD_FAULT)

    # Exceptions

    def _enter(self, number):
        values = self._integer.values
        stack, control = values[8], values[9]
        extended = control & FP_IN_USE
        frame = stack - (0x68 if extended else 0x20) & ~7
        xpsr = values[7] | (STACK_WAS_ALIGNED_DOWN if stack & 4 else 0)
        in_handler = values[7] & 0x1FF
        stacked = struct.pack("<8I", *values[:6], self.pc & ~1, xpsr)
        if extended:
            floats = self._float.read()
            stacked += struct.pack("<8QII", *floats[:8], floats[8], 0)
        try:
            if self._is_guarded(frame, frame + len(stacked) - 1):
                # Nothing is written, and the fault comes before the exception (ARM DDI 0403, B1.5.8).
                number = HARD_FAULT
                self.chip.scb.on_stacking()
            else:
                self.ram.put(frame, stacked)
        except (ValueError, IndexError):
            self.locked = True
            self.chip.tell("lockup", stack=f"{stack:#010x}")
            return
        values[5] = 0xFFFF_FFE1 | (0 if extended else 0x10) | (0 if in_handler else 8)
        values[7] = THUMB | number
        values[8] = frame
        values[9] = control & ~(FP_IN_USE | 8)
        values[6] = self.pc = self.chip.vector(number) | 1
        self._integer.write()
        self.nvic.enter(number)
        if number == HARD_FAULT:
            self._take_guards()
        self.clock.move_to(self.clock.now() + EXCEPTION_CYCLES * self.ticks_per_cycle)

    def _leave(self):
        values = self._integer.values
        frame, how = values[8], self.pc
        stacked = struct.unpack("<8I", self.ram.take(frame, 0x20))
        values[0:6] = stacked[:6]
        extended = not how & 0x10
        if extended:
            floats = struct.unpack("<8QI", self.ram.take(frame + 0x20, 0x44))
            self._float.values[:] = floats
            self._float.write()
        xpsr = stacked[7]
        values[6] = self.pc = stacked[6] | 1
        values[7] = xpsr & ~STACK_WAS_ALIGNED_DOWN
        values[8] = frame + (0x68 if extended else 0x20) + (4 if xpsr & STACK_WAS_ALIGNED_DOWN else 0)
        values[9] = values[9] & ~(FP_IN_USE | 8) | (FP_IN_USE if extended else 0)
        self._integer.write()
        if self.nvic.leave() == HARD_FAULT:
            self._take_guards()
        self.clock.move_to(self.clock.now() + EXCEPTION_CYCLES * self.ticks_per_cycle)

    # What Unicorn calls

    def _on_unmasked(self):
        if self.nvic.candidates and self.must_take():
            self.stop()

    def _on_protected_write(self, uc, access, address, size, value, _):
        if self._is_guarded(address, address):
            return self._on_guarded(uc, access, address)
        if not self.chip.flash.takes(address, size, value):
            raise Unmodelled(f"the firmware wrote {value:#x} to the read-only memory at {address:#010x}")
        self.stop()
        return True
