//! What people read counts right: "1 pair", never "1 pairs". A count stands before its noun through
//! `counted` (or `format::count`), which knows both, so a sentence that writes the plural itself after a number
//! that may be one is found here, whichever screen, message or report it belongs to.

use crate::files::tracked_text_files;

/// Where sentences for the operator are made.
const SPOKEN: [&str; 4] = ["app/src/operator/", "app/src/panels/", "app/src/window/", "core/engine/src/"];

/// What is counted.
const NOUNS: [&str; 25] = [
    "pairs",
    "touches",
    "views",
    "images",
    "boxes",
    "points",
    "places",
    "joints",
    "servos",
    "rows",
    "effects",
    "sessions",
    "corners",
    "looks",
    "poses",
    "models",
    "classes",
    "detectors",
    "attempts",
    "targets",
    "files",
    "lines",
    "toys",
    "folders",
    "cameras",
];

/// Binders of match arms whose other arms say what is said of one.
const SEVERAL: [&str; 3] = ["n =>", "more =>", "several =>"];

/// The plural that a line writes after a number that may be one.
fn fault(line: &str, before: &str) -> Option<&'static str> {
    let is_arm = |line: &str| SEVERAL.iter().any(|binder| line.trim_start().starts_with(binder));
    if is_arm(line) || is_arm(before) || line.contains("== 1 ") || line.trim_start().starts_with("//") {
        return None;
    }
    NOUNS.into_iter().find(|noun| {
        let wanted = format!("}} {noun}");
        line.match_indices(&wanted).any(|(at, _)| {
            let after = &line[at + wanted.len()..];
            let Some(open) = line[..at].rfind('{') else { return false };
            let (head, number) = (&line[..open], &line[open + 1..at]);
            let is_constant = number.starts_with(|c: char| c.is_ascii_uppercase());
            // "3 of 7 places", "all 26 places", "4 pairs per second".
            let is_of_several = head.ends_with("of ") || head.ends_with("all ") || after.starts_with(" per ");
            let is_whole_word = !after.starts_with(|c: char| c.is_alphanumeric());
            is_whole_word && !is_of_several && !is_constant
        })
    })
}

fn is_spoken(name: &str) -> bool {
    let is_test = name.contains("/tests") || name.ends_with("tests.rs");
    name.ends_with(".rs") && !is_test && SPOKEN.iter().any(|folder| name.starts_with(folder))
}

#[test]
fn no_sentence_writes_a_plural_after_a_number_that_may_be_one() {
    let files: Vec<_> = tracked_text_files().into_iter().filter(|(name, _)| is_spoken(name)).collect();
    assert!(files.len() > 200, "this test must be able to see the sentences; it saw {}", files.len());
    let mut faults = Vec::new();
    for (name, text) in &files {
        let mut before = "";
        for (i, line) in text.lines().take_while(|line| !line.starts_with("#[cfg(test)]")).enumerate() {
            if let Some(noun) = fault(line, before) {
                faults.push(format!("{name}:{}: {noun}: {}", i + 1, line.trim()));
            }
            before = line;
        }
    }
    assert!(faults.is_empty(), "use `counted` or `format::count`:\n{}", faults.join("\n"));
}

#[test]
fn a_plural_that_is_written_out_is_seen() {
    for wrong in [
        r#"format!("{count} pairs are collected")"#,
        r#"format!("{} touches agree", touches)"#,
        r#"format!("{} images, {} boxes", a, b)"#,
    ] {
        assert!(fault(wrong, "").is_some(), "{wrong}");
    }
    for right in [
        r#"format!("{done} of {all} touches")"#,
        r#"format!("all {} places", places)"#,
        r#"n => format!("{n} rows lie"),"#,
        r#"format!("{rate} pairs per second")"#,
        r#"format!("more than {MOST} attempts")"#,
        r#"if count == 1 { one } else { format!("{count} boxes are") }"#,
        r#"format!("{} placeshifts", n)"#,
        r"/// `{count} pairs`",
    ] {
        assert_eq!(fault(right, ""), None, "{right}");
    }
    assert_eq!(fault(r#""{} images are there","#, "            more => format!("), None);
}
