//! What pairs are called.

/// Of each folder only its name: "24 pairs in board" for "24 pairs in /data/eyes/board".
pub fn in_short(source: &str) -> String {
    let Some((count, places)) = source.split_once(" in ") else { return source.to_owned() };
    let places: Vec<&str> = places.split(" and ").map(last).collect();
    format!("{count} in {}", places.join(" and "))
}

fn last(path: &str) -> &str {
    let path = path.trim_end_matches(['/', '\\']);
    path.rsplit(['/', '\\']).next().unwrap_or(path)
}

#[cfg(test)]
mod tests {
    use super::in_short;

    #[test]
    fn pairs_are_called_by_the_names_of_their_folders() {
        for (source, short) in [
            ("24 pairs in /data/a.UD8awsEntH/board", "24 pairs in board"),
            ("1 pair in /data/my eyes/left side/", "1 pair in left side"),
            ("30 pairs in C:\\eyes\\nico-chessboard", "30 pairs in nico-chessboard"),
            ("9 pairs in /a/left and /b/right", "9 pairs in left and right"),
            ("30 pairs in nico-chessboard", "30 pairs in nico-chessboard"),
            ("twin \"lab\"", "twin \"lab\""),
            ("", ""),
        ] {
            assert_eq!(in_short(source), short);
        }
    }
}
