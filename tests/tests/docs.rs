//! Documents that are made from the code say what the code says.

use std::path::Path;
use tests::program::host;

#[test]
fn the_page_of_effects_is_up_to_date() {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/effects.md");
    let written = std::fs::read_to_string(page).unwrap();
    let made = host(Path::new("."), "effects --markdown").stdout;
    assert_eq!(written, made, "run: cargo host effects --markdown > docs/effects.md");
}
