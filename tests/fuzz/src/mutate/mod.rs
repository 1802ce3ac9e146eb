//! Changes to files: what happens to them on disks, in editors, in spreadsheets and in other programs,
//! and what nobody would do on purpose.

mod bytes;
mod fields;
mod numbers;
mod png;
mod special;
mod text;

use crate::dice::Dice;

pub use special::Special;

/// No changed file is larger than this, bytes.
pub const LARGEST: usize = 24_000_000;

/// What stands in place of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Changed {
    /// Other content.
    Bytes(Vec<u8>),
    /// No file any more.
    Special(Special),
}

/// Changes a file once, twice or three times. `others` are files that tokens and pieces are taken from.
/// Returns what was done, in words.
pub fn change(dice: &mut Dice, original: &[u8], others: &[&[u8]]) -> (String, Changed) {
    if dice.once_in(120) {
        let special = Special::any(dice);
        return (format!("{special:?}"), Changed::Special(special));
    }
    let times = match dice.below(10) {
        0..=6 => 1,
        7..=8 => 2,
        _ => 3,
    };
    let mut content = original.to_vec();
    let mut told = vec![];
    for _ in 0..times {
        let (what, changed) = once(dice, &content, others);
        told.push(what);
        content = changed;
        content.truncate(LARGEST);
    }
    (told.join(", then "), Changed::Bytes(content))
}

fn once(dice: &mut Dice, content: &[u8], others: &[&[u8]]) -> (String, Vec<u8>) {
    if png::is_png(content) && dice.below(3) > 0 {
        return png::change(dice, content);
    }
    match std::str::from_utf8(content) {
        Ok(text) if !text.is_empty() => match dice.below(20) {
            0..=7 => numbers::change(dice, text),
            8..=12 => fields::change(dice, text, others),
            13..=16 => text::change(dice, text, others),
            _ => bytes::change(dice, content, others),
        },
        _ => bytes::change(dice, content, others),
    }
}

/// `content` with `new` in place of the bytes from `start` to `end`.
fn replaced(content: &[u8], start: usize, end: usize, new: &[u8]) -> Vec<u8> {
    let mut out = Vec::with_capacity(content.len() + new.len());
    out.extend_from_slice(&content[..start]);
    out.extend_from_slice(new);
    out.extend_from_slice(&content[end..]);
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_dice_change_the_same_and_most_changes_change_something() {
        let text = b"format = 1\nname = \"a b\"\n[part]\nnumbers = [0.5, -1.5e-3, 7]\n".as_slice();
        let mut same = 0;
        for index in 0..500 {
            let change = || change(&mut Dice::new(9, "t", index), text, &[b"other,1\n2,3\n"]);
            assert_eq!(change(), change());
            let (what, changed) = change();
            assert!(!what.is_empty());
            match changed {
                Changed::Bytes(bytes) => {
                    assert!(bytes.len() <= LARGEST);
                    same += usize::from(bytes == text);
                }
                Changed::Special(_) => {}
            }
        }
        assert!(same < 50, "{same} of 500 changes changed nothing");
    }

    #[test]
    fn what_is_empty_or_binary_is_changed_too() {
        for index in 0..300 {
            let _ = change(&mut Dice::new(1, "e", index), b"", &[]);
            let _ = change(&mut Dice::new(1, "b", index), &[0xff, 0x00, 0xfe], &[b""]);
            let _ = change(&mut Dice::new(1, "x", index), "ä".as_bytes(), &["\u{feff}".as_bytes()]);
        }
    }
}
