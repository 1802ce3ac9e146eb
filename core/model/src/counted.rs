//! Counts and lists in sentences.

/// A count with its noun: `1 pair`, `30 pairs`, `80 touches`, `2 boxes`, `3 copies`.
pub fn counted(n: usize, singular: &str) -> String {
    match n {
        1 => format!("1 {singular}"),
        n => format!("{n} {}", plural(singular)),
    }
}

/// `a`, `a and b`, `a, b and c`; nothing of nothing.
pub fn listed(what: &[&str]) -> String {
    match what {
        [] => String::new(),
        [one] => (*one).to_owned(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

fn plural(singular: &str) -> String {
    let hisses = ["ch", "sh", "s", "x", "z"].iter().any(|ending| singular.ends_with(ending));
    match singular.strip_suffix('y') {
        Some(stem) if !stem.ends_with(['a', 'e', 'i', 'o', 'u']) => format!("{stem}ies"),
        _ if hisses => format!("{singular}es"),
        _ => format!("{singular}s"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_and_several() {
        let said = ["pair", "touch", "box", "class", "copy", "day"].map(|noun| counted(2, noun));
        assert_eq!(said, ["2 pairs", "2 touches", "2 boxes", "2 classes", "2 copies", "2 days"]);
        assert_eq!([counted(0, "pair"), counted(1, "class")], ["0 pairs", "1 class"]);
    }

    #[test]
    fn what_is_listed_reads_as_a_sentence() {
        let of = |what: &[&str]| listed(what);
        assert_eq!([of(&[]), of(&["a"]), of(&["a", "b"])], ["", "a", "a and b"]);
        assert_eq!(of(&["a", "b", "c"]), "a, b and c");
    }
}
