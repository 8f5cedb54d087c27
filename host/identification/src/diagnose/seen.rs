//! On which parts of the swings a claimed effect is seen, in words: of a part that does not show it, it matters why.

use super::holds::{Holding, Part};
use crate::compare::pictures::short_name;

impl Holding {
    /// Where it is seen, where that can't be told, and where it is not.
    pub fn seen_on(&self) -> String {
        let named = |is_meant: &dyn Fn(&Part) -> bool| {
            let names: Vec<&str> =
                self.parts.iter().filter(|part| is_meant(part)).map(|part| short_name(&part.name)).collect();
            (!names.is_empty()).then(|| names.join(", "))
        };
        let mut words = match named(&|part| part.seen == Some(true)) {
            Some(parts) => format!("seen {parts}"),
            None => "on no part alone".to_owned(),
        };
        let undecided = |is_measured: bool| move |part: &Part| part.seen.is_none() && part.std.is_some() == is_measured;
        words += &named(&undecided(true)).map_or(String::new(), |parts| format!("; can't be told {parts}"));
        words += &named(&undecided(false)).map_or(String::new(), |parts| format!("; too few windows alone {parts}"));
        words += &named(&|part| part.seen == Some(false)).map_or(String::new(), |parts| format!("; not seen {parts}"));
        words
    }
}

#[cfg(test)]
mod tests {
    use super::super::Standing;
    use super::*;

    #[test]
    fn parts_that_do_not_show_it_are_told_with_the_reason() {
        let part = |name: &str, std, seen| Part { name: name.to_owned(), value: 1.0, std, seen };
        let parts = vec![
            part("left", None, None),
            part("right", Some(0.1), Some(true)),
            part("swings/a.csv", Some(3.0), None),
            part("b.csv", Some(0.1), Some(false)),
        ];
        let claim = |parts| Holding {
            effect: "quadratic-drag",
            standing: Standing::Holds,
            windows: 14,
            rmse: 1e-3,
            beside: Vec::new(),
            p: None,
            p_without_two: None,
            value: None,
            std: None,
            parts,
        };
        let all = "seen right; can't be told a.csv; too few windows alone left; not seen b.csv";
        assert_eq!(claim(parts).seen_on(), all);
        assert_eq!(claim(Vec::new()).seen_on(), "on no part alone");
    }
}
