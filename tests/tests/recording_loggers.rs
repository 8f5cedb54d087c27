//! One swing as microcontrollers, monitors, spreadsheets and plotting programs write it down: read rightly, or refused.

#[path = "recording_loggers/clocks.rs"]
mod clocks;
#[path = "recording_loggers/columns.rs"]
mod columns;
#[path = "recording_loggers/drives.rs"]
mod drives;
#[path = "recording_loggers/frames.rs"]
mod frames;
#[path = "recording_loggers/refusals.rs"]
mod refusals;
#[path = "recording_loggers/rows.rs"]
mod rows;
#[path = "recording_loggers/segments.rs"]
mod segments;
#[path = "recording_loggers/swing.rs"]
mod swing;
