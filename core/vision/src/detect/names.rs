//! Names of classes: written by Python into the metadata of a file, or as YAML beside it.
//!
//! Exports of ultralytics carry the names as the text of a Python dictionary,
//! `{0: 'Banana', 1: "Farmer's cap"}`. A data set's `data.yaml` has a list or a map under
//! `names`.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use plumbline_model::detection::ClassNames;

use super::NamesFrom;
use crate::yolo_set::YoloSet;

/// Names as Python prints a dictionary of numbers, or a list; `None` if it is neither, or if a
/// number between 0 and the last is missing.
pub(super) fn from_python(text: &str) -> Option<ClassNames> {
    let text = text.trim();
    let (inner, numbered) = match text.strip_prefix('{').and_then(|text| text.strip_suffix('}')) {
        Some(inner) => (inner, true),
        None => {
            let list = text.strip_prefix('[').and_then(|text| text.strip_suffix(']'));
            let tuple = || text.strip_prefix('(').and_then(|text| text.strip_suffix(')'));
            (list.or_else(tuple)?, false)
        }
    };
    let mut names = BTreeMap::new();
    let mut rest = inner.trim_start();
    while !rest.is_empty() {
        let number = if numbered {
            let (number, after) = rest.split_once(':')?;
            rest = after.trim_start();
            number.trim().trim_matches(['\'', '"']).parse().ok()?
        } else {
            names.len()
        };
        let (name, after) = python_string(rest)?;
        names.insert(number, name);
        rest = after.trim_start();
        rest = match rest.strip_prefix(',') {
            Some(next) => next.trim_start(),
            None if rest.is_empty() => rest,
            None => return None,
        };
    }
    in_order(names)
}

/// A string as Python prints it (or a bare word), and what follows.
fn python_string(text: &str) -> Option<(String, &str)> {
    let mut chars = text.char_indices();
    let Some((_, quote @ ('\'' | '"'))) = chars.next() else {
        let end = text.find(',').unwrap_or(text.len());
        let word = text[..end].trim();
        return (!word.is_empty()).then(|| (word.to_owned(), &text[end..]));
    };
    let mut name = String::new();
    while let Some((at, character)) = chars.next() {
        match character {
            '\\' => name.push(escaped(&mut chars)?),
            end if end == quote => return Some((name, &text[at + 1..])),
            plain => name.push(plain),
        }
    }
    None
}

/// What stands after a backslash.
fn escaped(chars: &mut std::str::CharIndices<'_>) -> Option<char> {
    let digits = match chars.next()?.1 {
        'n' => return Some('\n'),
        't' => return Some('\t'),
        'r' => return Some('\r'),
        'x' => 2,
        'u' => 4,
        'U' => 8,
        other => return Some(other),
    };
    let mut code = 0;
    for _ in 0..digits {
        code = code * 16 + chars.next()?.1.to_digit(16)?;
    }
    char::from_u32(code)
}

fn in_order(names: BTreeMap<usize, String>) -> Option<ClassNames> {
    let complete = !names.is_empty() && names.keys().copied().eq(0..names.len());
    complete.then(|| ClassNames::new(names.into_values()))
}

/// The `data.yaml` that belongs to a file: `NAME.yaml` or `data.yaml` beside it.
fn beside(file: &Path) -> Option<PathBuf> {
    [file.with_extension("yaml"), file.with_file_name("data.yaml"), file.with_file_name("data.yml")]
        .into_iter()
        .find(|path| path.is_file())
}

/// Names of a detector, and what must be said about them.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Found {
    pub in_file: Option<ClassNames>,
    pub beside: Option<ClassNames>,
    pub remark: Option<String>,
}

impl Found {
    /// From the metadata text and what lies beside the file.
    pub fn new(metadata: Option<&str>, file: Option<&Path>) -> Self {
        let mut remarks = Vec::new();
        let in_file = metadata.and_then(|text| {
            let names = from_python(text);
            if names.is_none() {
                remarks.push("the names in the file cannot be read".to_owned());
            }
            names
        });
        let beside = file.and_then(beside).and_then(|path| {
            YoloSet::read_names(&path)
                .map_err(|error| remarks.push(format!("what lies beside the file is not used: {error}")))
                .ok()
        });
        if let (Some(in_file), Some(beside)) = (&in_file, &beside) {
            remarks.extend(difference(in_file, beside));
        }
        Self { in_file, beside, remark: (!remarks.is_empty()).then(|| remarks.join("; ")) }
    }

    /// The names that hold for a head of so many classes, and where they come from. Those of
    /// the file win; `Err` holds the names that do not fit.
    pub fn choose(&self, classes: Option<usize>) -> Result<Option<(ClassNames, NamesFrom)>, ClassNames> {
        let fits = |names: &ClassNames| classes.is_none_or(|classes| classes == names.len());
        let given = [(&self.in_file, NamesFrom::File), (&self.beside, NamesFrom::DataYaml)];
        let mut other = None;
        for (names, from) in given {
            match names {
                Some(names) if fits(names) => return Ok(Some((names.clone(), from))),
                Some(names) => other = other.or_else(|| Some(names.clone())),
                None => {}
            }
        }
        other.map_or(Ok(None), Err)
    }
}

/// Numbered names, for a detector that carries none.
pub(super) fn numbered(classes: usize) -> ClassNames {
    ClassNames::new((0..classes).map(|class| format!("class {class}")))
}

/// What differs between the names in a file and those beside it, in words.
fn difference(in_file: &ClassNames, beside: &ClassNames) -> Option<String> {
    if in_file == beside {
        return None;
    }
    let end = "; those of the file are used. If the data.yaml is right, the detector names things wrongly";
    let sorted = |names: &ClassNames| {
        let mut names: Vec<String> = names.iter().map(|(_, name)| name.to_owned()).collect();
        names.sort_unstable();
        names
    };
    let what =
        if sorted(in_file) == sorted(beside) { "the same classes in another order" } else { "other classes" };
    Some(format!(
        "the data.yaml beside the file has {what}: in the file {in_file}; in data.yaml {beside}{end}"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(list: &[&str]) -> Option<ClassNames> {
        Some(ClassNames::new(list.iter().copied()))
    }

    #[test]
    fn what_python_prints_is_read() {
        assert_eq!(from_python("{0: 'Banana', 1: 'Duck'}"), names(&["Banana", "Duck"]));
        assert_eq!(from_python(r#"{0: "it's", 1: 'say "hi"'}"#), names(&["it's", "say \"hi\""]));
        assert_eq!(from_python(r#"{0: 'both \' and \"', 1: 'a\\b'}"#), names(&["both ' and \"", r"a\b"]));
        assert_eq!(from_python(r"{0: 'Z\xfcrich', 1: '\u96f6'}"), names(&["Zürich", "零"]));
        assert_eq!(from_python("{1: 'b', 0: 'a, {c}: d',}"), names(&["a, {c}: d", "b"]));
        assert_eq!(from_python(" ['a', 'b'] "), names(&["a", "b"]));
        assert_eq!(from_python("{'0': 'a', '1': 'b'}"), names(&["a", "b"]));
        assert_eq!(from_python("{0: 0, 1: apple}"), names(&["0", "apple"]));
    }

    #[test]
    fn what_is_no_list_of_names_is_not_guessed() {
        for text in
            ["", "{}", "[]", "person", "{0: 'a', 2: 'c'}", "{0: 'a' 1: 'b'}", "{0: 'a", "{x: 'a'}", "{0}"]
        {
            assert_eq!(from_python(text), None, "{text}");
        }
    }

    #[test]
    fn what_cannot_be_read_beside_the_file_is_said() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("a.onnx");
        std::fs::write(folder.path().join("data.yaml"), "nc: 3\n").expect("writing");
        let found = Found::new(Some("{0: 'Banana'}"), Some(&file));
        assert_eq!((found.in_file, found.beside), (names(&["Banana"]), None));
        assert!(found.remark.expect("a remark").contains("is not used"));
        let unreadable = Found::new(Some("Banana and Duck"), None);
        assert!(unreadable.remark.expect("a remark").contains("cannot be read"));
    }

    #[test]
    fn another_order_is_said_with_both_orders() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("a.onnx");
        std::fs::write(folder.path().join("data.yaml"), "names: [Duck, Banana]\n").expect("writing");
        let found = Found::new(Some("{0: 'Banana', 1: 'Duck'}"), Some(&file));
        let remark = found.remark.clone().expect("a remark");
        assert!(remark.contains("another order"), "{remark}");
        assert!(remark.contains("Banana, Duck") && remark.contains("Duck, Banana"), "{remark}");
        let (used, from) = found.choose(Some(2)).expect("they fit").expect("names");
        assert_eq!((Some(used), from), (names(&["Banana", "Duck"]), NamesFrom::File));
    }

    #[test]
    fn what_lies_beside_is_the_fallback() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("a.onnx");
        std::fs::write(folder.path().join("data.yaml"), "names: [x, y]\n").expect("writing");
        let found = Found::new(None, Some(&file));
        assert_eq!(found.remark, None);
        assert_eq!(found.choose(Some(2)), Ok(names(&["x", "y"]).map(|names| (names, NamesFrom::DataYaml))));
        assert_eq!(found.choose(Some(3)).err(), names(&["x", "y"]), "the count does not fit");
        assert_eq!(Found::new(None, None).choose(Some(3)), Ok(None));
    }
}
