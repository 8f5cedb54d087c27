//! Sentences and numbers of the page.

use super::super::Study;
use super::super::rig::RigView;

/// `7.125(9)e-4` is for physicists; `(7.125 ± 0.009)·10⁻⁴` for a wall.
pub(super) fn number(value: f64, std: Option<f64>) -> String {
    let size = value.abs().max(std.unwrap_or(0.0));
    if size == 0.0 || !size.is_finite() {
        return format!("{value}");
    }
    let exponent = size.log10().floor() as i32;
    let power = 10f64.powi(exponent);
    let digits =
        std.filter(|std| *std > 0.0).map_or(3, |std| exponent - std.log10().floor() as i32 + 1).clamp(0, 9) as usize;
    let spread = std.map_or(String::new(), |std| format!(" ± {:.digits$}", std / power));
    match exponent {
        0 => format!("{value:.digits$}{spread}"),
        _ if spread.is_empty() => format!("{:.digits$}·10{}", value / power, raised(exponent)),
        _ => format!("({:.digits$}{spread})·10{}", value / power, raised(exponent)),
    }
}

/// A power of ten as it is written by hand.
pub(super) fn raised(exponent: i32) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let digit = |each: char| each.to_digit(10).map_or('⁻', |digit| DIGITS[digit as usize]);
    exponent.to_string().chars().map(digit).collect()
}

/// A place on the page.
pub(super) fn anchor(rig: &str) -> String {
    let plain = |each: char| if each.is_ascii_alphanumeric() { each } else { '-' };
    format!("rig-{}", rig.chars().map(plain).collect::<String>())
}

/// What the study covers.
pub(super) fn extent(study: &Study) -> String {
    let rows = || study.rigs.iter().flat_map(|rig| &rig.rows);
    let recorded = || rows().filter_map(|row| row.recorded.as_deref());
    let (first, last) = (recorded().min(), recorded().max());
    let dates = match (first, last) {
        (Some(first), Some(last)) => format!(", recorded from {} to {}", day(first), day(last)),
        _ => String::new(),
    };
    let studied = rows()
        .map(|row| row.studied.as_str())
        .max()
        .map_or(String::new(), |last| format!(", studied until {}", day(last)));
    format!("{}, {}{dates}{studied}", counted(study.rigs.len(), "rig"), counted(rows().count(), "recording"))
}

/// One thing, or several of them.
fn counted(n: usize, what: &str) -> String {
    if n == 1 { format!("1 {what}") } else { format!("{n} {what}s") }
}

/// The words as a sentence begins.
pub(super) fn begun(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

/// What stands for a number that imitates missing physics: its ± would be that of a model that is not true.
pub(super) fn imitating(value: f64, unit: &str) -> String {
    format!("about {} {unit}, imitating what is missing", number(value, None))
}

/// The day of a date with a time.
pub(super) fn day(date: &str) -> &str {
    date.split_once('T').map_or(date, |(day, _)| day)
}

/// What is known of a rig.
pub(super) fn of_rig(rig: &RigView) -> String {
    let n = rig.rows.len();
    let failed = n - rig.n_fitted();
    let without = if failed == 0 { String::new() } else { format!(", {failed} of them without a fit") };
    let spread = |symbol: &str| {
        let mean = rig.friction_of(symbol)?.mean;
        let share = 100.0 * mean.spread? / mean.value.abs();
        Some(format!(" {symbol} varies by {share:.2} % from swing to swing."))
    };
    format!(
        "{}{without}.{}{}",
        counted(n, "recording"),
        spread("Mc").unwrap_or_default(),
        spread("Mw").unwrap_or_default()
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::rig::tests::row;

    #[test]
    fn numbers_are_written_as_by_hand() {
        assert_eq!(number(7.1251e-4, Some(9.2e-7)), "(7.1251 ± 0.0092)·10⁻⁴");
        assert_eq!(number(2.5, Some(0.1)), "2.50 ± 0.10");
        assert_eq!(number(-1.5e12, None), "-1.500·10¹²");
        assert_eq!(anchor("lab 1/rig_2"), "rig-lab-1-rig-2");
    }

    #[test]
    fn one_is_one_and_a_sentence_begins_with_a_capital() {
        assert_eq!([counted(1, "rig"), counted(0, "rig"), counted(2, "rig")], ["1 rig", "0 rigs", "2 rigs"]);
        assert_eq!([begun("missing: a"), begun("")], ["Missing: a", ""]);
        assert_eq!(imitating(7.1251e-4, "N·m"), "about 7.125·10⁻⁴ N·m, imitating what is missing");
    }

    #[test]
    fn friction_varies_by_its_spread_from_swing_to_swing() {
        let rows = [("1.csv", 0.9), ("2.csv", 1.0), ("3.csv", 1.1)].map(|(name, value)| row(name, value, 0.5));
        let words = of_rig(&RigView::new("rig", rows.to_vec()));
        assert!(words.starts_with("3 recordings. Mc varies by 10.00 % from swing to swing."), "{words}");
    }
}
