//! Which eye a file or folder name tells, and what is left of the name without it.

use plumbline_model::Eye;

/// A name with its eye taken out.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct EyeName {
    pub eye: Eye,
    /// The name without the word and one separator beside it: both eyes of a pair share it.
    pub rest: String,
}

/// Finds the word `left` or `right` (any case, also as in `imgLeft01`) in a name without
/// extension; failing that, a lone `l` or `r` in front or at the end (`L_001`, `cam-r`).
/// `None` if the name tells no eye, or both.
pub(crate) fn eye_of_name(stem: &str) -> Option<EyeName> {
    // ASCII lower case keeps every byte in its place, so positions fit the original.
    let lower = stem.to_ascii_lowercase();
    let left = find_word(stem, &lower, "left");
    let right = find_word(stem, &lower, "right");
    match (left, right) {
        (Some(at), None) => Some(EyeName { eye: Eye::Left, rest: without(stem, at, 4) }),
        (None, Some(at)) => Some(EyeName { eye: Eye::Right, rest: without(stem, at, 5) }),
        (Some(_), Some(_)) => None,
        (None, None) => lone_letter(stem, &lower),
    }
}

/// Position of `word` standing by itself: not inside a longer word of the same case.
fn find_word(stem: &str, lower: &str, word: &str) -> Option<usize> {
    let bytes = stem.as_bytes();
    lower.match_indices(word).map(|(at, _)| at).find(|&at| {
        let end = at + word.len();
        let starts = match at.checked_sub(1).map(|before| bytes[before]) {
            Some(before) if before.is_ascii_lowercase() => bytes[at].is_ascii_uppercase(),
            Some(before) => !before.is_ascii_alphabetic(),
            None => true,
        };
        let ends = match bytes.get(end) {
            Some(after) if after.is_ascii_uppercase() => bytes[end - 1].is_ascii_lowercase(),
            Some(after) => !after.is_ascii_alphabetic(),
            None => true,
        };
        starts && ends
    })
}

fn lone_letter(stem: &str, lower: &str) -> Option<EyeName> {
    let bytes = lower.as_bytes();
    let eye_at = |at: usize| match bytes.get(at) {
        Some(b'l') => Some(Eye::Left),
        Some(b'r') => Some(Eye::Right),
        _ => None,
    };
    let last = bytes.len().checked_sub(1)?;
    let first_is_lone = bytes.get(1).is_none_or(|next| next.is_ascii() && !next.is_ascii_alphabetic());
    let last_is_lone =
        last > 0 && bytes[last - 1].is_ascii() && !bytes[last - 1].is_ascii_alphabetic() || last == 0;
    let first = if first_is_lone { eye_at(0).map(|eye| (eye, 0)) } else { None };
    let end = if last_is_lone { eye_at(last).map(|eye| (eye, last)) } else { None };
    let (eye, at) = match (first, end) {
        (Some(found), None) | (None, Some(found)) => found,
        (Some(a), Some(b)) if a == b => a,
        _ => return None,
    };
    Some(EyeName { eye, rest: without(stem, at, 1) })
}

/// `stem` without `length` bytes at `at`, and without one separator beside them.
fn without(stem: &str, at: usize, length: usize) -> String {
    let (before, after) = (&stem[..at], &stem[at + length..]);
    const SEPARATORS: [char; 4] = ['_', '-', '.', ' '];
    if let Some(shorter) = before.strip_suffix(SEPARATORS) {
        return format!("{shorter}{after}");
    }
    format!("{before}{}", after.strip_prefix(SEPARATORS).unwrap_or(after))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_eyes_of_a_pair_share_the_rest() {
        let pairs = [
            ("left01", "right01", "01"),
            ("left_1767628247.14", "right_1767628247.14", "1767628247.14"),
            ("123-Left", "123-Right", "123"),
            ("imgLeft7", "imgRight7", "img7"),
            ("LEFT", "RIGHT", ""),
            ("scan_left_02", "scan_right_02", "scan_02"),
            ("L001", "R001", "001"),
            ("cam_l", "cam_r", "cam"),
            ("l", "r", ""),
            ("ä_left_ö", "ä_right_ö", "ä_ö"),
        ];
        for (left, right, rest) in pairs {
            let expected = |eye| Some(EyeName { eye, rest: rest.to_owned() });
            assert_eq!(eye_of_name(left), expected(Eye::Left), "{left}");
            assert_eq!(eye_of_name(right), expected(Eye::Right), "{right}");
        }
    }

    #[test]
    fn names_that_tell_no_eye_or_both() {
        for name in ["", "frame_01", "leftover", "bright", "lights", "left_right", "l_1_r", "rlr", "é"] {
            assert_eq!(eye_of_name(name), None, "{name}");
        }
    }
}
