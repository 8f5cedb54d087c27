//! SHA-256 of files (FIPS 180-4): what `sha256sum` says, so that anybody can check where a row came from.

use sha2::{Digest, Sha256};
use std::fs::File;
use std::io;
use std::path::Path;

/// Of a file, read piece by piece; hexadecimal.
///
/// # Errors
/// The system refuses.
pub fn of_file(path: &Path) -> io::Result<String> {
    let mut digest = Sha256::new();
    io::copy(&mut File::open(path)?, &mut digest)?;
    Ok(in_hex(&digest.finalize()))
}

/// Of a text; hexadecimal.
pub fn of_text(text: &str) -> String {
    in_hex(&Sha256::digest(text))
}

fn in_hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The first example of FIPS 180-4's test vectors.
    #[test]
    fn the_hash_of_abc_is_the_known_one() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("abc");
        std::fs::write(&path, "abc").unwrap();
        let known = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        assert_eq!(of_file(&path).unwrap(), known);
        assert_eq!(of_text("abc"), known);
    }
}
