//! The words of a formula.

use super::FormulaError;
use std::ops::Range;

/// A word.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Token {
    Number(f64),
    Name(String),
    /// `+ - * / ^ ( )`
    Sign(char),
    End,
}

/// A word and its place, in bytes.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Placed {
    pub(super) token: Token,
    pub(super) bytes: Range<usize>,
}

/// Cuts the part `within` of a text into words; an `End` is the last.
pub(super) fn tokens(text: &str, within: Range<usize>) -> Result<Vec<Placed>, FormulaError> {
    let mut found = Vec::new();
    let mut at = within.start;
    while let Some(first) = text[at..within.end].chars().next() {
        let rest = &text[at..within.end];
        let (length, token) = match first {
            space if space.is_whitespace() => (space.len_utf8(), None),
            digit if digit.is_ascii_digit() || digit == '.' => {
                let (value, length) = number(text, at..within.end)?;
                (length, Some(Token::Number(value)))
            }
            letter if is_in_name(letter) => {
                let name: String = rest.chars().take_while(|c| is_in_name(*c) || c.is_ascii_digit()).collect();
                (name.len(), Some(Token::Name(name)))
            }
            '·' | '×' => (first.len_utf8(), Some(Token::Sign('*'))),
            '−' => (first.len_utf8(), Some(Token::Sign('-'))),
            '+' | '-' | '*' | '/' | '^' | '(' | ')' => (1, Some(Token::Sign(first))),
            other => {
                let bytes = at..at + other.len_utf8();
                return Err(FormulaError::at(text, bytes, format!("'{other}' means nothing in a formula")));
            }
        };
        found.extend(token.map(|token| Placed { token, bytes: at..at + length }));
        at += length;
    }
    found.push(Placed { token: Token::End, bytes: within.end..within.end });
    Ok(found)
}

fn is_in_name(c: char) -> bool {
    c.is_alphabetic() || c == '_'
}

/// The number at the beginning of a part, and its length. Two dots end it: they stand between the ends of a range.
pub(super) fn number(text: &str, within: Range<usize>) -> Result<(f64, usize), FormulaError> {
    let rest = text[within.clone()].as_bytes();
    let mut length = 0;
    while let Some(byte) = rest.get(length) {
        let next = rest.get(length + 1);
        let after_exponent = length > 0 && matches!(rest[length - 1], b'e' | b'E');
        let belongs = match byte {
            b'0'..=b'9' => true,
            b'.' => next != Some(&b'.') && (length == 0 || rest[length - 1] != b'.'),
            b'e' | b'E' => length > 0 && next.is_some_and(|next| matches!(next, b'0'..=b'9' | b'+' | b'-')),
            b'+' | b'-' => after_exponent,
            _ => false,
        };
        if !belongs {
            break;
        }
        length += 1;
    }
    let written = &text[within.start..within.start + length];
    match written.parse::<f64>() {
        Ok(value) if value.is_finite() && (value as f32).is_finite() => Ok((value, length)),
        _ => {
            let bytes = within.start..within.start + length.max(1);
            Err(FormulaError::at(text, bytes, format!("'{written}' is not a number that the rig can hold")))
        }
    }
}
