//! What is typed: arguments and scripts.

use std::path::Path;

use super::{Reader, one};
use crate::check::Heard;

pub fn readers() -> Vec<Reader> {
    vec![
        one("script", &["words/script.txt"], 30, |folder| {
            understood(&folder.join("words/script.txt"), &["--do"], ';')
        }),
        one("arguments", &["words/arguments.txt"], 20, |folder| {
            understood(&folder.join("words/arguments.txt"), &[], '\n')
        }),
    ]
}

fn understood(file: &Path, before: &[&str], between: char) -> Heard {
    let text = match std::fs::metadata(file) {
        Ok(data) if data.is_file() => {
            String::from_utf8_lossy(&std::fs::read(file).unwrap_or_default()).into_owned()
        }
        _ => return Heard::refused("no file"),
    };
    let given: Vec<String> = match before {
        [] => text.split(between).map(str::to_owned).collect(),
        _ => vec![text],
    };
    // A word on the command line has at most 128 KB; looking for what is meant by one takes its square.
    let given = given.into_iter().map(|word| word.chars().take(4000).collect());
    let words = ["plumbline"].iter().chain(before).map(ToString::to_string).chain(given);
    plumbline::understands(words.take(2000)).into()
}
