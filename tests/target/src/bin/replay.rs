//! Plays a recording through the rig: reads `codes.bin` (two bytes a code, low byte first) from the directory that QEMU
//! was started in, and writes every byte that the link would carry to `frames.bin` there.
#![no_std]
#![no_main]

use cortex_m as _;
use cortex_m_rt::entry;
use semihosting::fs::File;
use semihosting::io::{Read, Result, Write};
use semihosting::println;
use shared::rig::Rig;
use shared::units::Code;
use shared::wire::{Command, Frame, MAX_FRAME, StoreState, Stream, encode};

/// Bytes of codes read at once, and of frames written.
const CHUNK: usize = 2048;

#[entry]
fn main() -> ! {
    let n_samples = play().expect("codes.bin can be read and frames.bin written");
    println!("played {n_samples}");
    semihosting::process::exit(0)
}

fn play() -> Result<u32> {
    let mut codes = File::open(c"codes.bin")?;
    let mut frames = Frames { file: File::create(c"frames.bin")?, bytes: [0; CHUNK], n_bytes: 0 };
    let mut rig = Rig::new("replay", firmware::ports::FULL_SCALE, Err(StoreState::Empty));
    rig.on_frame(Frame::Command(1, Command::Start(Stream { raw: true, live_every: 4 })));
    let mut bytes = [0; CHUNK];
    let mut n_samples = 0;
    loop {
        let n_bytes = codes.read(&mut bytes)?;
        if n_bytes == 0 {
            frames.flush()?;
            return Ok(n_samples);
        }
        for code in bytes[..n_bytes].chunks_exact(2) {
            let mut written = Ok(());
            rig.on_sample(Code(u16::from_le_bytes([code[0], code[1]])), |frame| written = frames.add(&frame));
            written?;
            n_samples += 1;
        }
    }
}

/// Frames collected into chunks: each call of the PC costs as much as many samples.
struct Frames {
    file: File,
    bytes: [u8; CHUNK],
    n_bytes: usize,
}

impl Frames {
    fn add(&mut self, frame: &Frame) -> Result<()> {
        let mut buffer = [0; MAX_FRAME];
        let encoded = encode(frame, &mut buffer).expect("every frame fits");
        if self.n_bytes + encoded.len() > CHUNK {
            self.flush()?;
        }
        self.bytes[self.n_bytes..][..encoded.len()].copy_from_slice(encoded);
        self.n_bytes += encoded.len();
        Ok(())
    }

    fn flush(&mut self) -> Result<()> {
        self.file.write_all(&self.bytes[..self.n_bytes])?;
        self.n_bytes = 0;
        Ok(())
    }
}

#[panic_handler]
fn panic(info: &core::panic::PanicInfo) -> ! {
    semihosting::eprintln!("{info}");
    semihosting::process::exit(101)
}
