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
    pieces(name).into_iter().map(|piece| piece.word)
}

/// A lower-case word with the digits at its end, and the signs between it and the word before.
pub(super) struct Piece {
    pub(super) gap: String,
    pub(super) word: String,
}

/// A name in all its words and signs, but for the signs at its end.
pub(super) fn pieces(name: &str) -> Vec<Piece> {
    let mut pieces = Vec::new();
    let mut rest = name;
    while let Some(begin) = rest.find(is_of_word) {
        let end = rest[begin..].find(|letter| !is_of_word(letter)).map_or(rest.len(), |length| begin + length);
        let part = &rest[begin..end];
        let humps = if is_unit_with_prefix(part) { vec![part.to_owned()] } else { humps(part) };
        let mut gap = &rest[..begin];
        for hump in humps.into_iter().filter(|hump| !hump.is_empty()) {
            pieces.push(Piece { gap: std::mem::take(&mut gap).to_owned(), word: hump.to_lowercase() });
        }
        rest = &rest[end..];
    }
    pieces
}

fn is_of_word(letter: char) -> bool {
    letter.is_alphanumeric() || letter == '°'
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
