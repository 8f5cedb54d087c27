//! Which board this is.

#[cfg(feature = "board-feather-f405")]
macro_rules! name {
    () => {
        "feather-f405"
    };
}
#[cfg(feature = "board-nucleo-f446")]
macro_rules! name {
    () => {
        "nucleo-f446"
    };
}
#[cfg(feature = "board-qemu")]
macro_rules! name {
    () => {
        "qemu"
    };
}

/// In the greeting.
pub const NAME: &str = name!();

/// By which `host update` knows an image.
pub const IDENTITY: &str = concat!("pendulum-rig firmware ", env!("CARGO_PKG_VERSION"), " for ", name!(), ";");
