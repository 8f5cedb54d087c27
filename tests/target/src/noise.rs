//! Repeatable noise, the same on board and PC.

/// Xorshift (Marsaglia 2003); never zero.
#[derive(Clone, Debug)]
pub struct Noise(u32);

impl Noise {
    /// From any seed.
    pub const fn new(seed: u32) -> Self {
        Self(seed | 1)
    }

    /// The next 32 bits.
    pub fn bits(&mut self) -> u32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 17;
        self.0 ^= self.0 << 5;
        self.0
    }

    /// A whole number below `end`.
    pub fn below(&mut self, end: u32) -> u32 {
        (self.bits() >> 8) % end
    }

    /// Between −1 and 1, in steps that `f32` holds exactly.
    pub fn symmetric(&mut self) -> f32 {
        (self.bits() >> 8) as f32 / 8_388_608.0 - 1.0
    }
}
