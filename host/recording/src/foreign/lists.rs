//! Lists as programs print or keep them: `t = [0.0, 0.01]` and `theta = [1.2, 1.1]`, `[(0.0, 1.2), (0.01, 1.1)]`,
//! `{'t': [0.0, 0.01], 'theta': [1.2, 1.1]}`. Each becomes JSON, and that a table.

use super::as_text::refused;
use super::json;
use crate::error::Fault;

/// Does a file begin so?
pub(super) fn begins(head: &[u8]) -> bool {
    let text = String::from_utf8_lossy(head);
    let text = text.trim_start_matches('\u{feff}').trim_start();
    let behind = |sign: char| text.strip_prefix(sign).map(str::trim_start);
    behind('{').is_some_and(|rest| rest.starts_with('\''))
        || behind('[').is_some_and(|rest| rest.starts_with('('))
        || text.split_once('=').is_some_and(|(name, list)| is_name(name.trim()) && opens_list(list.trim_start()))
}

fn is_name(text: &str) -> bool {
    text.starts_with(char::is_alphabetic) && text.chars().all(|letter| letter.is_alphanumeric() || letter == '_')
}

fn opens_list(text: &str) -> bool {
    ["[", "(", "np.array(", "numpy.array("].iter().any(|begin| text.starts_with(begin))
}

pub(super) fn table(bytes: &[u8], notes: &mut Vec<String>) -> Result<Vec<u8>, Fault> {
    json::table(as_json(&String::from_utf8_lossy(bytes)).as_bytes(), notes).map_err(|fault| match fault {
        Fault::Foreign { problem, .. } => {
            let problem = problem.split("; ").next().unwrap_or_default();
            let expected = "expected t = [0.0, 0.01, …] and theta = [1.2, 1.1, …], or [(0.0, 1.2), (0.01, 1.1), …]";
            refused("file of lists", &format!("{problem}; {expected}"))
        }
        fault => fault,
    })
}

/// Round brackets become square, quotes double, a comma before the end falls off; lists with names become an object.
fn as_json(text: &str) -> String {
    let (mut json, mut before) = (String::new(), String::new());
    let (mut depth, mut n_named) = (0_usize, 0);
    for letter in text.chars() {
        match letter {
            '[' | '(' | '{' => {
                if let (0, Some((name, _))) = (depth, before.split_once('=')) {
                    let name = name.lines().next_back().unwrap_or_default().trim();
                    json += &format!("{}{}:", if n_named > 0 { "," } else { "" }, serde_json::json!(name));
                    n_named += 1;
                }
                before.clear();
                json.push(if letter == '(' { '[' } else { letter });
                depth += 1;
            }
            ']' | ')' | '}' => {
                json.truncate(json.trim_end().trim_end_matches(',').len());
                json.push(if letter == ')' { ']' } else { letter });
                depth = depth.saturating_sub(1);
            }
            '\'' => json.push('"'),
            _ if depth == 0 => before.push(letter),
            _ => json.push(letter),
        }
    }
    match json.split_once(":[[").filter(|_| n_named == 1) {
        Some((_, rows)) => format!("[[{rows}"),
        None if n_named > 0 => format!("{{{json}}}"),
        None => json,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_of_programs_become_json() {
        for (text, json) in [
            ("t = [0, 1,]\ntheta = [1.5, 1.4]\n", r#"{"t":[0, 1],"theta":[1.5, 1.4]}"#),
            ("[(0, 1.5), (1, 1.4),\n]", "[[0, 1.5], [1, 1.4]]"),
            ("{'t': [0, 1], 'theta': (1.5, 1.4)}", r#"{"t": [0, 1], "theta": [1.5, 1.4]}"#),
            ("swing = [(0, 1.5), (1, 1.4)]", "[[0, 1.5], [1, 1.4]]"),
            ("t = np.array([0, 1]);\ny = np.array([2, 3]);", r#"{"t":[[0, 1]],"y":[[2, 3]]}"#),
        ] {
            assert!(begins(text.as_bytes()), "{text}");
            assert_eq!(as_json(text), json);
        }
        for other in
            ["t=0.1 theta=0.2", "[0.1, 0.2]", "{\"t\": [1]}", "(0.1, 0.2)\n", "# t = [s]\n0,1", "", "a b = [1]"]
        {
            assert!(!begins(other.as_bytes()), "{other}");
        }
        assert!(table(b"t = [0 1 2]", &mut Vec::new()).unwrap_err().to_string().contains("file of lists"));
    }
}
