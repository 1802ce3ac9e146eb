//! What of a file's contents can stand in a message.

/// Characters of a file's contents that a message quotes at most.
pub const MOST_SHOWN: usize = 60;

/// Characters of a whole message at most: what a parser says of a file may repeat much of it.
pub const MOST_TOLD: usize = 1200;

/// A message that may quote a file: as it is, but without control characters other than the ends of
/// lines, and shortened to [`MOST_TOLD`] characters.
pub fn told(text: &str) -> String {
    let visible = |c: char| if c.is_control() && c != '\n' { '\u{fffd}' } else { c };
    let length = text.chars().count();
    if length <= MOST_TOLD {
        return text.chars().map(visible).collect();
    }
    // What to do stands at the end.
    let end = MOST_TOLD / 3;
    let start: String = text.chars().take(MOST_TOLD - end).map(visible).collect();
    let rest: String = text.chars().skip(length - end).map(visible).collect();
    format!("{start} … ({} characters left out) … {rest}", length - MOST_TOLD)
}

/// A piece of a file for a message: on one line, without control characters (a terminal would
/// obey them), and shortened to [`MOST_SHOWN`] characters with its length behind.
pub fn shortened(text: &str) -> String {
    let visible = |c: char| if c.is_control() { '\u{fffd}' } else { c };
    let length = text.chars().count();
    if length <= MOST_SHOWN {
        return text.chars().map(visible).collect();
    }
    let start: String = text.chars().take(MOST_SHOWN).map(visible).collect();
    format!("{start}… ({length} characters)")
}
