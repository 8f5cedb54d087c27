//! A column name in its words.

/// Lower-case words of a name, split at signs and where a small letter meets a capital; digits at the end fall off.
pub(super) fn words(name: &str) -> Vec<String> {
    let mut words = all_words(name);
    // `Angle in degrees`: between two words it is no inch.
    let n_words = words.len();
    let mut idx = 0;
    words.retain(|word| {
        idx += 1;
        word != "in" || idx == 1 || idx == n_words
    });
    words
}

fn all_words(name: &str) -> Vec<String> {
    let bare = |word: String| word.trim_end_matches(|letter: char| letter.is_ascii_digit()).to_owned();
    words_with_digits(name).map(bare).filter(|word| !word.is_empty()).collect()
}

/// Lower-case words with the digits at their ends.
pub(super) fn words_with_digits(name: &str) -> impl Iterator<Item = String> {
    name.split(|letter: char| !letter.is_alphanumeric() && letter != '°')
        .flat_map(|part| if is_unit_with_prefix(part) { vec![part.to_owned()] } else { humps(part) })
        .map(|word| word.to_lowercase())
        .filter(|word| !word.is_empty())
}

/// `timeMs` in two, and `IMU1Angle`.
fn humps(part: &str) -> Vec<String> {
    let mut humps = vec![String::new()];
    let mut before = ' ';
    let mut letters = part.chars().peekable();
    while let Some(letter) = letters.next() {
        let mut begins_small = || letters.peek().is_some_and(|next| next.is_lowercase());
        let may_end = before.is_lowercase() || (before.is_ascii_digit() && begins_small());
        if may_end && letter.is_uppercase() {
            humps.push(String::new());
        }
        before = letter;
        if let Some(hump) = humps.last_mut() {
            hump.push(letter);
        }
    }
    humps
}

/// `µT`, `mV`, `kHz`: of a unit with a capital its prefix is no word.
fn is_unit_with_prefix(part: &str) -> bool {
    let mut rest = part.chars();
    let is_prefix = rest.next().is_some_and(|letter| matches!(letter, 'n' | 'u' | 'µ' | 'μ' | 'm' | 'c' | 'h' | 'k'));
    is_prefix && matches!(rest.as_str(), "T" | "G" | "V" | "A" | "W" | "N" | "J" | "K" | "Hz" | "Pa")
}
