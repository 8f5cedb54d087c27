//! Time that nobody else wants: releases are kept, and looked at when nothing else is to be done.

use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use firmware::spare::Spare;
use shared::bank::tape::Tape;

static TAPE: Tape = Tape::new();

/// What `main` does when nothing else is to be done.
pub static SPARE: Spare<CriticalSectionRawMutex> = Spare::new(&TAPE);
