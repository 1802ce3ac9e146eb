//! Changes of numbers in text.

use super::replaced;
use crate::dice::Dice;

const VALUES: [&str; 44] = [
    "0",
    "-0",
    "-0.0",
    "NaN",
    "nan",
    "inf",
    "-inf",
    "Infinity",
    ".nan",
    ".inf",
    "-.inf",
    "null",
    "1e308",
    "-1e308",
    "1.7976931348623157e308",
    "1e-308",
    "5e-324",
    "1e400",
    "1e-400",
    "1e150",
    "-1e150",
    "1e30",
    "1e-30",
    "1e9",
    "1e19",
    "2147483647",
    "2147483648",
    "-2147483648",
    "4294967295",
    "4294967296",
    "9223372036854775807",
    "9223372036854775808",
    "18446744073709551615",
    "18446744073709551616",
    "-1",
    "1",
    "0.5",
    "65535",
    "65536",
    "0x7f",
    "1_000",
    "1,5",
    "",
    "true",
];
const FACTORS: [f64; 12] = [
    1000.0,
    0.001,
    57.295_779_513_082_32,
    0.017_453_292_519_943_295,
    -1.0,
    10.0,
    0.1,
    2.0,
    25.4,
    1e6,
    1e-6,
    1e12,
];

/// Changes numbers once.
pub fn change(dice: &mut Dice, text: &str) -> (String, Vec<u8>) {
    let spans = spans(text);
    let content = text.as_bytes();
    if spans.is_empty() {
        return ("nothing, there is no number".to_owned(), content.to_vec());
    }
    let &(start, end) = dice.pick(&spans);
    let old = &text[start..end];
    match dice.below(12) {
        0..=4 => {
            let new = *dice.pick(&VALUES);
            (format!("{old} made {new} at byte {start}"), replaced(content, start, end, new.as_bytes()))
        }
        5..=7 => {
            let factor = *dice.pick(&FACTORS);
            (
                format!("{old} times {factor} at byte {start}"),
                replaced(content, start, end, times(old, factor).as_bytes()),
            )
        }
        8 => {
            let count = *dice.pick(&[20, 40, 310, 400, 5000, 400_000]);
            let new = format!("{}{}", dice.pick(&["", "-", "0.", "1e"]), "9".repeat(count));
            (
                format!("{old} made {count} digits at byte {start}"),
                replaced(content, start, end, new.as_bytes()),
            )
        }
        9 => {
            let &(from, to) = dice.pick(&spans);
            let new = text[from..to].to_owned();
            (
                format!("{old} made {new} as elsewhere, at byte {start}"),
                replaced(content, start, end, new.as_bytes()),
            )
        }
        10 => {
            // A wrong unit in a whole line, or in everything.
            let factor = *dice.pick(&FACTORS);
            let line = line_around(text, start);
            let (from, to) = if dice.once_in(3) { (0, text.len()) } else { line };
            (
                format!("all numbers from byte {from} to {to} times {factor}"),
                scaled(text, &spans, (from, to), factor),
            )
        }
        _ => {
            let factor = *dice.pick(&FACTORS);
            let column = column_of(text, start);
            (format!("column {column} times {factor}"), scaled_column(text, &spans, column, factor))
        }
    }
}

/// Where numbers begin and end. Digits within a word are none.
pub fn spans(text: &str) -> Vec<(usize, usize)> {
    let bytes = text.as_bytes();
    let mut found = vec![];
    let mut at = 0;
    while at < bytes.len() {
        let begins = bytes[at].is_ascii_digit()
            && at
                .checked_sub(1)
                .is_none_or(|before| !(bytes[before].is_ascii_alphanumeric() || bytes[before] == b'_'));
        if !begins {
            at += 1;
            continue;
        }
        let start = if at > 0 && bytes[at - 1] == b'-' { at - 1 } else { at };
        let mut end = at;
        while end < bytes.len() {
            let is_sign =
                matches!(bytes[end], b'+' | b'-') && matches!(bytes[end - 1], b'e' | b'E') && end > at;
            if bytes[end].is_ascii_digit() || matches!(bytes[end], b'.' | b'e' | b'E') || is_sign {
                end += 1;
            } else {
                break;
            }
        }
        found.push((start, end));
        at = end;
    }
    found
}

fn times(number: &str, factor: f64) -> String {
    match number.parse::<f64>() {
        Ok(value) if value.fract() == 0.0 && (value * factor).fract() == 0.0 && !number.contains('.') => {
            format!("{}", value * factor)
        }
        Ok(value) => format!("{:?}", value * factor),
        Err(_) => format!("{number}e3"),
    }
}

fn line_around(text: &str, at: usize) -> (usize, usize) {
    let start = text[..at].rfind('\n').map_or(0, |end| end + 1);
    let end = text[at..].find('\n').map_or(text.len(), |length| at + length);
    (start, end)
}

/// The comma-separated column that a byte is in.
fn column_of(text: &str, at: usize) -> usize {
    let (start, _) = line_around(text, at);
    text.as_bytes()[start..at].iter().filter(|byte| **byte == b',').count()
}

fn scaled(text: &str, spans: &[(usize, usize)], (from, to): (usize, usize), factor: f64) -> Vec<u8> {
    let wanted = spans.iter().filter(|(start, _)| (from..to).contains(start));
    with_scaled(text, wanted, factor)
}

fn scaled_column(text: &str, spans: &[(usize, usize)], column: usize, factor: f64) -> Vec<u8> {
    // In one pass: a line may be as long as the file.
    let (mut at, mut here) = (0, 0);
    let wanted = spans.iter().filter(|(start, _)| {
        for byte in &text.as_bytes()[at..*start] {
            match byte {
                b'\n' => here = 0,
                b',' => here += 1,
                _ => {}
            }
        }
        at = *start;
        here == column
    });
    with_scaled(text, wanted, factor)
}

fn with_scaled<'a>(text: &str, wanted: impl Iterator<Item = &'a (usize, usize)>, factor: f64) -> Vec<u8> {
    let mut out = String::with_capacity(text.len() * 2);
    let mut copied = 0;
    for &(start, end) in wanted {
        out.push_str(&text[copied..start]);
        out.push_str(&times(&text[start..end], factor));
        copied = end;
    }
    out.push_str(&text[copied..]);
    out.into_bytes()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_found_and_names_with_digits_are_none() {
        let text = "k1 = -0.5e-3, x_2=7 [1,-2.5E+4] 3d";
        let found: Vec<&str> = spans(text).into_iter().map(|(start, end)| &text[start..end]).collect();
        assert_eq!(found, ["-0.5e-3", "7", "1", "-2.5E+4", "3"]);
    }

    #[test]
    fn a_column_in_another_unit_leaves_the_others() {
        let text = "a,b\n1,2.5\n3,4.5\n";
        assert_eq!(scaled_column(text, &spans(text), 1, 1000.0), b"a,b\n1,2500.0\n3,4500.0\n");
    }
}
