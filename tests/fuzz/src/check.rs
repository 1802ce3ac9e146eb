//! What must hold of what a reader answers. Messages are judged as they come to the operator: the command
//! line and the window send all of them through [`told`].

use plumbline_model::files::{MOST_TOLD, told};

/// A message that is longer than what reaches the operator is not read by anybody.
pub const LONGEST_MESSAGE: usize = MOST_TOLD + 100;

/// What a reader said.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Heard {
    /// Whether it took the input.
    pub accepted: bool,
    /// What it made of it, as `Debug` writes it.
    pub value: String,
    /// What it says to the operator.
    pub messages: Vec<String>,
}

impl Heard {
    /// Taken, with this result.
    pub fn accepted(value: impl std::fmt::Debug) -> Self {
        Self { accepted: true, value: format!("{value:?}"), messages: vec![] }
    }

    /// Refused with this message.
    pub fn refused(message: impl std::fmt::Display) -> Self {
        Self { accepted: false, value: String::new(), messages: vec![told(&message.to_string())] }
    }

    /// With more that is said.
    #[must_use]
    pub fn and<M: ToString>(mut self, messages: impl IntoIterator<Item = M>) -> Self {
        self.messages.extend(messages.into_iter().map(|message| told(&message.to_string())));
        self
    }
}

impl<T: std::fmt::Debug, E: std::fmt::Display> From<Result<T, E>> for Heard {
    fn from(result: Result<T, E>) -> Self {
        match result {
            Ok(value) => Self::accepted(value),
            Err(error) => Self::refused(error),
        }
    }
}

/// What is wrong with an answer; `None` when nothing is. `finite` asks for numbers that are.
pub fn fault(heard: &Heard, finite: bool) -> Option<String> {
    heard
        .messages
        .iter()
        .find_map(|message| fault_of_message(message))
        .or_else(|| (finite && heard.accepted).then(|| not_finite(&heard.value)).flatten())
}

fn fault_of_message(message: &str) -> Option<String> {
    let count = message.chars().count();
    if message.trim().is_empty() {
        return Some("a message without words".to_owned());
    }
    if count > LONGEST_MESSAGE {
        let start: String = message.chars().take(300).collect();
        return Some(format!("a message of {count} characters: {start}…"));
    }
    // OpenCV, ONNX Runtime and Rust in their own words.
    let raw =
        ["error: (-", "in function '", "called `Option", "called `Result", "CHECK failed", "onnxruntime::"];
    let raw = raw.into_iter().find(|words| message.contains(words));
    raw.map(|raw| format!("words of a library ({raw}): {message}"))
}

/// The first number in a text of `Debug` that is none, with what stands around it. Texts in quotes do not
/// count.
fn not_finite(debug: &str) -> Option<String> {
    let bytes = debug.as_bytes();
    let mut at = 0;
    while at < bytes.len() {
        match bytes[at] {
            b'"' => {
                at += 1;
                while at < bytes.len() && bytes[at] != b'"' {
                    at += if bytes[at] == b'\\' { 2 } else { 1 };
                }
                at += 1;
            }
            byte if byte.is_ascii_alphanumeric() || byte == b'_' => {
                let start = at;
                while at < bytes.len() && (bytes[at].is_ascii_alphanumeric() || bytes[at] == b'_') {
                    at += 1;
                }
                if matches!(&bytes[start..at], b"NaN" | b"inf") {
                    let from = (0..=start.saturating_sub(160))
                        .rev()
                        .find(|k| debug.is_char_boundary(*k))
                        .unwrap_or(0);
                    return Some(format!("a result that is no number: …{}", &debug[from..at]));
                }
            }
            _ => at += 1,
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_are_short_and_in_our_own_words() {
        assert_eq!(fault_of_message("a.csv, line 3: \"x\" is no number"), None);
        assert!(
            fault_of_message(&"x".repeat(LONGEST_MESSAGE + 1))
                .is_some_and(|told| told.contains("a message of"))
        );
        let opencv = "OpenCV(4.6.0) ./modules/core/src/matrix.cpp:246: error: (-215:Assertion failed) s >= 0";
        assert!(fault_of_message(opencv).is_some());
        assert!(fault_of_message(" ").is_some());
    }

    #[test]
    fn a_number_that_is_none_is_found_outside_of_texts() {
        #[derive(Debug)]
        #[allow(dead_code)]
        struct Result {
            name: String,
            infimum: f64,
            error_m: f64,
        }
        let result = |error_m| Result { name: "NaN \" inf".to_owned(), infimum: 1.0, error_m };
        assert_eq!(fault(&Heard::accepted(result(1.0)), true), None);
        assert!(fault(&Heard::accepted(result(f64::NAN)), true).is_some_and(|told| told.contains("error_m")));
        assert!(fault(&Heard::accepted(result(f64::NEG_INFINITY)), true).is_some());
        assert_eq!(fault(&Heard::accepted(result(f64::NAN)), false), None);
    }
}
