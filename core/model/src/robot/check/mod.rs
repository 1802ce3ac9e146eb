//! Is a rig file sound: all that is wrong with it and with the description that it names, each with its
//! line and what to do, in one go. [`Rig::read`] stops at the first.

mod description;
mod keys;
mod names;
mod rig;
#[cfg(test)]
mod tests;
mod urdf_lines;

use std::path::Path;

use serde::Serialize;

use super::error::RigError;
use super::rig::Rig;
use crate::files::{self, Size, told};

/// Something that is wrong.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Problem {
    /// The file that it is in.
    pub file: String,
    /// The line, from 1; `None` for something that is nowhere in the file.
    pub line: Option<usize>,
    /// What is wrong.
    pub what: String,
    /// What to do about it.
    pub fix: String,
}

/// Gathers what is wrong with one file.
struct Problems<'a> {
    file: &'a str,
    text: &'a str,
    found: Vec<Problem>,
}

impl<'a> Problems<'a> {
    fn new(file: &'a str, text: &'a str) -> Self {
        Self { file, text, found: vec![] }
    }

    /// Something at a place of the text, in bytes.
    fn at(&mut self, offset: usize, what: impl AsRef<str>, fix: impl AsRef<str>) {
        let line = line_of(self.text, offset);
        self.add(Some(line), what, fix);
    }

    fn add(&mut self, line: Option<usize>, what: impl AsRef<str>, fix: impl AsRef<str>) {
        let (what, fix) = (told(what.as_ref()), told(fix.as_ref()));
        let problem = Problem { file: self.file.to_owned(), line, what, fix };
        if !self.found.contains(&problem) {
            self.found.push(problem);
        }
    }
}

/// Line of a place in a text, from 1.
fn line_of(text: &str, offset: usize) -> usize {
    1 + text.bytes().take(offset).filter(|byte| *byte == b'\n').count()
}

impl Rig {
    /// Everything that is wrong with a rig file and the description that it names, in the order of their
    /// lines, the rig file first. Nothing: [`Rig::read`] reads it.
    ///
    /// # Errors
    /// When the rig file itself cannot be read.
    pub fn check(file: &Path) -> Result<Vec<Problem>, RigError> {
        let text = files::read_text(file, Size::TEXT)?;
        let shown = file.display().to_string();
        let folder = file.parent().unwrap_or(Path::new(""));
        let mut found = Self::check_text(&shown, &text, |name| {
            files::read_text(&folder.join(name), Size::TEXT).map_err(|error| error.to_string())
        });
        if found.is_empty()
            && let Err(error) = Self::read(file)
        {
            // What only reading finds.
            let (what, fix) = (error.to_string(), "correct it as the sentence says".to_owned());
            found.push(Problem { file: shown, line: None, what, fix });
        }
        Ok(found)
    }

    /// The same of the text of a rig file; `description` gives the text of the description that it
    /// names, or says why it cannot.
    pub fn check_text(
        file: &str,
        text: &str,
        description: impl FnOnce(&str) -> Result<String, String>,
    ) -> Vec<Problem> {
        if text.trim_start().starts_with('<') {
            let mut problems = Problems::new(file, text);
            problems.add(
                Some(1),
                "this is a description of a robot (URDF), not a rig file",
                "check the rig file that names it with description = \"…\"; it says which servos, eyes and \
                 touchscreen belong to it, as rig.toml of the robot that comes with the program does",
            );
            let mut found = problems.found;
            found.extend(description::check(file, text).problems);
            return found;
        }
        rig::check(file, text, description)
    }
}
