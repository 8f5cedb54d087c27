//! Long names where space is short: an ellipsis in the middle, because files of one series differ at their ends.

/// The name with at most so many letters, of which one may be the ellipsis.
pub fn shortened(name: &str, most: usize) -> String {
    let letters: Vec<char> = name.chars().collect();
    if letters.len() <= most {
        return name.to_owned();
    }
    let n_kept = most.saturating_sub(1);
    let (n_end, n_begin) = (n_kept.div_ceil(2), n_kept / 2);
    let begin: String = letters[..n_begin].iter().collect();
    let end: String = letters[letters.len() - n_end..].iter().collect();
    format!("{begin}…{end}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_ends_of_a_long_name_stay() {
        let check = |name: &str, most, expected: &str| assert_eq!(shortened(name, most), expected);
        check("swing.csv", 9, "swing.csv");
        check("a very long name of a swing-07.csv", 11, "a ver…7.csv");
        check("schön-ä.csv", 5, "sc…sv");
    }
}
