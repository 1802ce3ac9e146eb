//! Changes of bytes, whatever they mean.

use super::replaced;
use crate::dice::Dice;

/// Numbers that counts and lengths are compared with, little and big end first.
const WORDS: [u32; 8] = [0, 1, 0x7f, 0xff, 0xffff, 0x7fff_ffff, 0x8000_0000, 0xffff_ffff];

/// Changes bytes once.
pub fn change(dice: &mut Dice, content: &[u8], others: &[&[u8]]) -> (String, Vec<u8>) {
    let mut out = content.to_vec();
    let what = match dice.below(10) {
        0 | 1 => {
            let count = 1 + dice.below(8);
            for _ in 0..count {
                let at = dice.below(out.len());
                let bit = dice.below(8);
                if let Some(byte) = out.get_mut(at) {
                    *byte ^= 1 << bit;
                }
            }
            format!("{count} bits flipped")
        }
        2 => {
            out.truncate(dice.below(content.len()));
            format!("cut off after {} bytes", out.len())
        }
        3 => {
            let (start, end) = span(dice, content.len());
            out = replaced(content, start, end, &[]);
            format!("bytes {start} to {end} taken out")
        }
        4 => {
            let (start, end) = span(dice, content.len());
            let times = 1 + dice.below(40);
            let piece = content[start..end].repeat(times);
            out = replaced(content, end, end, &piece);
            format!("bytes {start} to {end} repeated {times} times")
        }
        5 => {
            let (start, end) = span(dice, content.len());
            let (other, stop) = span(dice, content.len());
            let piece = content[other..stop].to_vec();
            out = replaced(content, start, end, &piece);
            format!("bytes {start} to {end} replaced by {other} to {stop}")
        }
        6 => {
            let word = *dice.pick(&WORDS);
            let bytes = if dice.once_in(2) { word.to_le_bytes() } else { word.to_be_bytes() };
            let width = *dice.pick(&[1, 2, 4]);
            let start = dice.below(content.len());
            let end = (start + width).min(content.len());
            let piece = if word < 0x100 && bytes[0] == 0 { &bytes[4 - width..] } else { &bytes[..width] };
            out = replaced(content, start, end, piece);
            format!("the number {word:#x} at byte {start}")
        }
        7 => {
            let (start, end) = span(dice, content.len());
            out[start..end].iter_mut().for_each(|byte| *byte = dice.bits() as u8);
            format!("bytes {start} to {end} made up")
        }
        8 => {
            let other = others.get(dice.below(others.len())).copied().unwrap_or_default();
            let (from, to) = span(dice, other.len());
            let (start, end) = span(dice, content.len());
            out = replaced(content, start, end, &other[from..to]);
            format!("bytes {start} to {end} replaced by a piece of another file")
        }
        _ => {
            let fill = *dice.pick(&[0x00, 0xff, b' ', b'\n', 0x80]);
            let (start, end) = span(dice, content.len());
            out[start..end].fill(fill);
            format!("bytes {start} to {end} made {fill:#x}, as a disk leaves them")
        }
    };
    (what, out)
}

/// Where a piece begins and ends; most are short.
fn span(dice: &mut Dice, length: usize) -> (usize, usize) {
    let start = dice.below(length);
    let most = if dice.once_in(4) { length } else { 32 };
    (start, (start + 1 + dice.below(most)).min(length))
}
