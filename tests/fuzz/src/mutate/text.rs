//! Changes of text as a whole: nesting, encodings, pieces of other files.

use super::replaced;
use crate::dice::Dice;

/// Openings and what closes them.
const NESTS: [(&str, &str); 9] = [
    ("[", "]"),
    ("{\"a\":", "}"),
    ("{a: ", "}"),
    ("- ", ""),
    ("<link name=\"a\">", "</link>"),
    ("<a>", "</a>"),
    ("a.", "b"),
    ("{a=", "}"),
    ("(", ")"),
];

/// Changes text once.
pub fn change(dice: &mut Dice, text: &str, others: &[&[u8]]) -> (String, Vec<u8>) {
    match dice.below(4) {
        0 => nesting(dice, text),
        1 => encoding(dice, text),
        2 => spliced(dice, text, others),
        _ => odd(dice, text),
    }
}

fn nesting(dice: &mut Dice, text: &str) -> (String, Vec<u8>) {
    let (open, close) = *dice.pick(&NESTS);
    let depth = *dice.pick(&[10, 200, 3000, 20_000, 100_000]);
    let nest = format!(
        "{}1{}",
        open.repeat(depth),
        if dice.once_in(2) { close.repeat(depth) } else { String::new() }
    );
    let spans = super::numbers::spans(text);
    // In place of a value, before everything, or between tags.
    let (start, end) = match dice.below(4) {
        0 | 1 if !spans.is_empty() => *dice.pick(&spans),
        2 => (0, 0),
        _ => {
            let places: Vec<usize> = text
                .char_indices()
                .filter(|(_, c)| matches!(c, '>' | '\n' | ' '))
                .map(|(at, _)| at + 1)
                .collect();
            let at = places.get(dice.below(places.len())).copied().unwrap_or(0);
            (at, at)
        }
    };
    (format!("{open} {depth} deep at byte {start}"), replaced(text.as_bytes(), start, end, nest.as_bytes()))
}

fn encoding(dice: &mut Dice, text: &str) -> (String, Vec<u8>) {
    let as_utf16 = |to: fn(u16) -> [u8; 2]| text.encode_utf16().flat_map(to).collect::<Vec<u8>>();
    let (what, bytes) = match dice.below(9) {
        0 => ("a byte-order mark", [b"\xef\xbb\xbf", text.as_bytes()].concat()),
        1 => ("UTF-16, little end first", [b"\xff\xfe".as_slice(), &as_utf16(u16::to_le_bytes)].concat()),
        2 => ("UTF-16, big end first", [b"\xfe\xff".as_slice(), &as_utf16(u16::to_be_bytes)].concat()),
        3 => ("lines end as on Windows", text.replace('\n', "\r\n").into_bytes()),
        4 => ("lines end as on old Macs", text.replace('\n', "\r").into_bytes()),
        5 => ("no end of the last line", text.trim_end().as_bytes().to_vec()),
        6 => ("tabs for spaces", text.replace(' ', "\t").into_bytes()),
        7 => {
            let at = dice.below(text.len());
            ("a zero byte", replaced(text.as_bytes(), at, at, &[0]))
        }
        _ => {
            let at = dice.below(text.len());
            ("a byte of Latin-1", replaced(text.as_bytes(), at, at, &[0xe4]))
        }
    };
    (what.to_owned(), bytes)
}

fn spliced(dice: &mut Dice, text: &str, others: &[&[u8]]) -> (String, Vec<u8>) {
    let other = others.get(dice.below(others.len())).copied().unwrap_or_default();
    let content = text.as_bytes();
    match dice.below(4) {
        0 => ("another file in its place".to_owned(), other.to_vec()),
        1 => ("another file after it".to_owned(), [content, other].concat()),
        2 => {
            let (a, b) = (dice.below(content.len()), dice.below(other.len()));
            (
                "begins like itself and ends like another file".to_owned(),
                [&content[..a], &other[b..]].concat(),
            )
        }
        _ => {
            let theirs: Vec<&[u8]> = other.split_inclusive(|byte| *byte == b'\n').collect();
            let line = theirs.get(dice.below(theirs.len())).copied().unwrap_or_default();
            let at = content.iter().enumerate().filter(|(_, byte)| **byte == b'\n').map(|(at, _)| at + 1);
            let places: Vec<usize> = std::iter::once(0).chain(at).collect();
            let at = *dice.pick(&places);
            (format!("a line of another file at byte {at}"), replaced(content, at, at, line))
        }
    }
}

fn odd(dice: &mut Dice, text: &str) -> (String, Vec<u8>) {
    match dice.below(5) {
        0 => ("empty".to_owned(), vec![]),
        1 => ("only spaces".to_owned(), b"   \n \n".to_vec()),
        2 => ("everything twice".to_owned(), text.repeat(2).into_bytes()),
        3 => {
            let bracket =
                *dice.pick(&['[', ']', '{', '}', '"', '<', '>', '\'', ':', '=', ',', '#', '&', '*']);
            let places: Vec<(usize, char)> = text.char_indices().collect();
            let &(at, c) = dice.pick(&places);
            let end = if dice.once_in(2) { at } else { at + c.len_utf8() };
            let new = bracket.to_string();
            (format!("{bracket} at byte {at}"), replaced(text.as_bytes(), at, end, new.as_bytes()))
        }
        _ => ("empty lines between".to_owned(), text.replace('\n', "\n\n").into_bytes()),
    }
}
