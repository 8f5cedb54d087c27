//! What a fit is doing.

/// What happens, for a progress display.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Progress {
    /// Designs of a window, in seconds (rounded); 0 for the whole.
    Surfaces(u32),
    /// Growing windows.
    Descent,
    /// Ms and DV.
    Stiction,
    /// Uncertainties and checks.
    Uncertainty,
}

impl std::fmt::Display for Progress {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Surfaces(0) => write!(out, "response surfaces over the whole swing"),
            Self::Surfaces(seconds) => write!(out, "response surfaces over the first {seconds} s"),
            Self::Descent => write!(out, "least squares"),
            Self::Stiction => write!(out, "stiction"),
            Self::Uncertainty => write!(out, "uncertainties"),
        }
    }
}
