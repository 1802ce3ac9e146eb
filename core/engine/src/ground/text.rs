//! Sentences for people.

use plumbline_model::files::told;

/// Error texts begin with a small letter so that they can stand inside a sentence. A file name at
/// the beginning stays as it is.
pub fn sentence(text: &str) -> String {
    let text = &told(text);
    let begins_with_a_file =
        text.split_whitespace().next().is_some_and(|word| word.contains(['/', '.', '_']));
    let mut characters = text.chars();
    let first = characters
        .next()
        .map(|first| if begins_with_a_file { first.to_string() } else { first.to_uppercase().collect() })
        .unwrap_or_default();
    let end = if text.ends_with(['.', '!', '?', '…']) { "" } else { "." };
    format!("{first}{}{end}", characters.as_str())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_become_sentences() {
        assert_eq!(sentence("the folder is gone"), "The folder is gone.");
        assert_eq!(sentence("Done."), "Done.");
        assert_eq!(sentence("left/a.png has no partner"), "left/a.png has no partner.");
        assert_eq!(sentence(""), ".");
    }
}
