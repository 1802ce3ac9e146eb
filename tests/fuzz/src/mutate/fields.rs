//! Changes of lines, cells and keys of text.

use super::replaced;
use crate::dice::Dice;

/// Changes fields once.
pub fn change(dice: &mut Dice, text: &str, others: &[&[u8]]) -> (String, Vec<u8>) {
    match dice.below(4) {
        0 | 1 => lines(dice, text),
        2 => cells(dice, text),
        _ => words(dice, text, others),
    }
}

fn lines(dice: &mut Dice, text: &str) -> (String, Vec<u8>) {
    let mut lines: Vec<&str> = text.split_inclusive('\n').collect();
    let at = dice.below(lines.len());
    let what = match dice.below(7) {
        0 | 1 => {
            lines.remove(at);
            format!("line {} taken out", at + 1)
        }
        2 => {
            lines.insert(at, lines[at]);
            format!("line {} doubled", at + 1)
        }
        3 => {
            let other = dice.below(lines.len());
            lines.swap(at, other);
            format!("lines {} and {} exchanged", at + 1, other + 1)
        }
        4 => {
            let end = (at + 1 + dice.below(lines.len())).min(lines.len());
            lines.drain(at..end);
            format!("lines {} to {end} taken out", at + 1)
        }
        5 => {
            lines.truncate(at);
            format!("ends before line {}", at + 1)
        }
        _ => {
            let line = lines[at];
            // Rarely so many that a reader which keeps them all is told by its memory.
            let times = if dice.once_in(12) { 8_000_000 / line.len().max(1) } else { 1 + dice.below(200) };
            lines.splice(at..at, std::iter::repeat_n(line, times));
            format!("line {} {times} times", at + 1)
        }
    };
    (what, lines.concat().into_bytes())
}

/// Pieces between commas, colons, equals signs, brackets and spaces.
fn cells(dice: &mut Dice, text: &str) -> (String, Vec<u8>) {
    let is_edge = |byte: u8| b",;:=[]{}()<> \t\n\"'".contains(&byte);
    let content = text.as_bytes();
    let mut spans = vec![];
    let mut start = 0;
    for at in 0..=content.len() {
        if at == content.len() || is_edge(content[at]) {
            if at > start {
                spans.push((start, at));
            }
            start = at + 1;
        }
    }
    if spans.is_empty() {
        return ("nothing, there is no cell".to_owned(), content.to_vec());
    }
    let &(start, end) = dice.pick(&spans);
    let cell = &content[start..end];
    match dice.below(6) {
        0 => (format!("the cell at byte {start} taken out"), replaced(content, start, end, &[])),
        1 => {
            // With the separator after it.
            let end = (end + 1).min(content.len());
            (
                format!("the cell at byte {start} and what ends it taken out"),
                replaced(content, start, end, &[]),
            )
        }
        2 => {
            let end = (end + 1).min(content.len());
            let twice = content[start..end].repeat(2);
            (format!("the cell at byte {start} doubled"), replaced(content, start, end, &twice))
        }
        3 => {
            let &(from, to) = dice.pick(&spans);
            let other = content[from..to].to_vec();
            (
                format!("the cell at byte {start} made like that at {from}"),
                replaced(content, start, end, &other),
            )
        }
        4 => {
            let length = *dice.pick(&[300, 5000, 70_000, 2_000_000]);
            let fill: Vec<u8> = cell.iter().copied().cycle().take(length).collect();
            (
                format!("the cell at byte {start} made {length} bytes long"),
                replaced(content, start, end, &fill),
            )
        }
        _ => {
            let wild = *dice.pick(&[
                "",
                " ",
                "../../../../etc/passwd",
                "/dev/zero",
                "~",
                "%s%n",
                "\u{202e}",
                "é",
                "💥",
                "\\",
                "'",
                "\"",
                "#",
                "null",
                "true",
                "[]",
                "{}",
                "-",
                "a=b",
                "<a>",
                "&x;",
                "*x",
                "!!binary x",
                "!!python/object x",
            ]);
            (
                format!("the cell at byte {start} made {wild:?}"),
                replaced(content, start, end, wild.as_bytes()),
            )
        }
    }
}

/// Names: of keys, columns, joints.
fn words(dice: &mut Dice, text: &str, others: &[&[u8]]) -> (String, Vec<u8>) {
    let content = text.as_bytes();
    let found = spans_of_words(content);
    if found.is_empty() {
        return ("nothing, there is no word".to_owned(), content.to_vec());
    }
    let &(start, end) = dice.pick(&found);
    let word = &text[start..end];
    let new = match dice.below(5) {
        0 => format!("{word}x"),
        1 => word.to_uppercase(),
        2 => word[1..].to_owned(),
        3 => {
            let &(from, to) = dice.pick(&found);
            text[from..to].to_owned()
        }
        _ => {
            let other = others.get(dice.below(others.len())).copied().unwrap_or_default();
            let theirs = spans_of_words(other);
            match theirs.get(dice.below(theirs.len())) {
                Some(&(from, to)) => String::from_utf8_lossy(&other[from..to]).into_owned(),
                None => String::new(),
            }
        }
    };
    if dice.once_in(4) {
        return (format!("every {word} made {new}"), text.replace(word, &new).into_bytes());
    }
    (format!("{word} made {new} at byte {start}"), replaced(content, start, end, new.as_bytes()))
}

fn spans_of_words(content: &[u8]) -> Vec<(usize, usize)> {
    let mut found = vec![];
    let mut start = None;
    for at in 0..=content.len() {
        let inside = content.get(at).is_some_and(|byte| byte.is_ascii_alphanumeric() || *byte == b'_');
        match (inside, start) {
            (true, None) if content[at].is_ascii_alphabetic() => start = Some(at),
            (false, Some(from)) => {
                found.push((from, at));
                start = None;
            }
            _ => {}
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_names_and_not_numbers() {
        let text = b"cmd_r_x_rad = 1.5e3\n";
        let found: Vec<&[u8]> = spans_of_words(text).into_iter().map(|(from, to)| &text[from..to]).collect();
        assert_eq!(found, [b"cmd_r_x_rad".as_slice(), b"e3"]);
    }
}
