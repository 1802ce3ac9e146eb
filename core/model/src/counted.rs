//! Counts in sentences.

/// A count with its noun: `1 pair`, `30 pairs`, `80 touches`, `2 boxes`, `3 copies`.
pub fn counted(n: usize, singular: &str) -> String {
    match n {
        1 => format!("1 {singular}"),
        n => format!("{n} {}", plural(singular)),
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
}
