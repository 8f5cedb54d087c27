//! What is checked on the microcontroller itself. The same functions run on the PC, where the results are compared.
#![no_std]
#![forbid(unsafe_code)]

pub mod checks;
pub mod cut_flash;
pub mod noise;
pub mod traces;
