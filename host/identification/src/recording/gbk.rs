//! GBK, in which spreadsheets in China save their tables: the words of a heading that a recording needs, and no others.
//!
//! A table of all its 20,000 signs would be longer than the program; who names a column otherwise tells it with
//! `--columns`.

/// Words and signs in GBK (GB 18030-2022); the longer ones first where one begins like another.
const WORDS: [(&[u8], &str); 18] = [
    (&[0xca, 0xb1, 0xbc, 0xe4], "时间"),
    (&[0xbd, 0xc7, 0xb6, 0xc8], "角度"),
    (&[0xb0, 0xda, 0xbd, 0xc7], "摆角"),
    (&[0xbd, 0xc7, 0xce, 0xbb, 0xd2, 0xc6], "角位移"),
    (&[0xbd, 0xc7, 0xcb, 0xd9, 0xb6, 0xc8], "角速度"),
    (&[0xbb, 0xa1, 0xb6, 0xc8], "弧度"),
    (&[0xba, 0xc1, 0xc3, 0xeb], "毫秒"),
    (&[0xce, 0xa2, 0xc3, 0xeb], "微秒"),
    (&[0xc3, 0xeb], "秒"),
    (&[0xb6, 0xc8], "度"),
    (&[0xa1, 0xe3], "°"),
    (&[0xb0, 0xda, 0xb3, 0xa4], "摆长"),
    (&[0xd6, 0xdc, 0xc6, 0xda], "周期"),
    (&[0xce, 0xbb, 0xd6, 0xc3], "位置"),
    (&[0xa3, 0xa8], "（"),
    (&[0xa3, 0xa9], "）"),
    (&[0xa3, 0xac], "，"),
    (&[0xbc, 0xd3, 0xcb, 0xd9, 0xb6, 0xc8], "加速度"),
];

/// Words of fewer bytes may stand in other alphabets too.
const LEAST_BYTES: usize = 4;

/// Is this a line of GBK? All bytes beyond ASCII stand in twos, and one of the longer words is there.
pub(super) fn has_words(bytes: &[u8]) -> bool {
    let mut rest = bytes;
    let mut is_one = false;
    while let Some(first) = rest.first() {
        let is_pair = rest.get(1).is_some_and(|second| (0x40..=0xfe).contains(second));
        if *first >= 0x81 && !is_pair {
            return false;
        }
        is_one |= word(rest).is_some_and(|(word, _)| word.len() >= LEAST_BYTES);
        rest = &rest[if *first >= 0x81 { 2 } else { 1 }..];
    }
    is_one
}

/// Appends the line with its known words; of the other signs nothing is known but that they are there.
pub(super) fn read_into(bytes: &[u8], line: &mut String) {
    let mut rest = bytes;
    while let Some(first) = rest.first() {
        let n = match word(rest) {
            Some((word, text)) => {
                line.push_str(text);
                word.len()
            }
            None if *first >= 0x81 => {
                line.push('?');
                2
            }
            None => {
                line.push(char::from(*first));
                1
            }
        };
        rest = rest.get(n..).unwrap_or_default();
    }
}

/// The word with which bytes begin.
fn word(bytes: &[u8]) -> Option<(&'static [u8], &'static str)> {
    WORDS.into_iter().find(|(word, _)| bytes.starts_with(word))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_heading_in_gbk_is_told_from_latin_and_cyrillic_words() {
        // 时间(s),摆角(度),备注
        let heading = b"\xca\xb1\xbc\xe4(s),\xb0\xda\xbd\xc7(\xb6\xc8),\xb1\xb8\xd7\xa2";
        assert!(has_words(heading));
        let mut line = String::new();
        read_into(heading, &mut line);
        assert_eq!(line, "时间(s),摆角(度),??");
        // Winkel (°), Время in Windows-1251, and a pair that is cut off.
        for other in [b"t;Winkel (\xb0)".as_slice(), b"\xc2\xf0\xe5\xec\xff", b"\xca\xb1\xbc\xe4,\xb0", b"t,theta"] {
            assert!(!has_words(other), "{other:?}");
        }
    }
}
