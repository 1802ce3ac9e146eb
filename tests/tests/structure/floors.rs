//! Who may use whom inside of a package, from the paths that begin with `crate::`.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Modules of a package (its top level) and which others each uses, outside of its tests.
pub fn uses(source: &Path) -> BTreeMap<String, BTreeSet<String>> {
    let mut uses: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for file in rust_files(source) {
        let inside = file.strip_prefix(source).expect("inside");
        let module = inside.iter().next().expect("a name").to_string_lossy();
        let module = module.trim_end_matches(".rs").to_owned();
        if module == "lib" || module == "main" || is_for_tests(inside) {
            continue;
        }
        let text = std::fs::read_to_string(&file).expect("readable");
        let used = uses.entry(module.clone()).or_default();
        used.extend(named(&program(&text)).into_iter().filter(|name| *name != module));
    }
    // Functions and types of the root are no modules.
    let modules: BTreeSet<String> = uses.keys().cloned().collect();
    for used in uses.values_mut() {
        used.retain(|name| modules.contains(name));
    }
    uses
}

fn rust_files(folder: &Path) -> Vec<std::path::PathBuf> {
    let mut files = Vec::new();
    let mut folders = vec![folder.to_path_buf()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).expect("a folder").flatten() {
            let path = entry.path();
            match path.is_dir() {
                true => folders.push(path),
                false if path.extension().is_some_and(|extension| extension == "rs") => files.push(path),
                false => {}
            }
        }
    }
    files
}

fn is_for_tests(file: &Path) -> bool {
    file.iter().any(|part| {
        let part = part.to_string_lossy();
        part.trim_end_matches(".rs").ends_with("tests")
            || ["kept.rs", "testing.rs", "made_up.rs"].contains(&&*part)
    })
}

/// Without comments and without the tests at its end.
fn program(text: &str) -> String {
    let mut program = String::new();
    let mut lines = text.lines().peekable();
    while let Some(line) = lines.next() {
        let begins_tests = line.starts_with("#[cfg(") && line.contains("test");
        if begins_tests && lines.peek().is_some_and(|next| next.starts_with("mod ") && next.ends_with('{')) {
            break;
        }
        program.push_str(line.split("//").next().unwrap_or_default());
        program.push('\n');
    }
    program
}

/// First names after `crate::`, also those in braces.
fn named(program: &str) -> BTreeSet<String> {
    let mut names = BTreeSet::new();
    for (at, start) in program.match_indices("crate::") {
        let rest = &program[at + start.len()..];
        match rest.strip_prefix('{') {
            None => names.insert(first_name(rest)),
            Some(list) => {
                names.extend(top_level(list).into_iter().map(first_name));
                true
            }
        };
    }
    names
}

fn first_name(path: &str) -> String {
    path.trim_start().chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect()
}

/// The parts of a list in braces, whose opening brace is gone.
fn top_level(list: &str) -> Vec<&str> {
    let (mut depth, mut begin, mut parts) = (0, 0, Vec::new());
    for (at, c) in list.char_indices() {
        match c {
            '{' => depth += 1,
            '}' if depth == 0 => {
                parts.push(&list[begin..at]);
                break;
            }
            '}' => depth -= 1,
            ',' if depth == 0 => {
                parts.push(&list[begin..at]);
                begin = at + 1;
            }
            _ => {}
        }
    }
    parts
}

/// A module that is used, in the end, by one that it uses; `None` when there is no circle.
pub fn circle(uses: &BTreeMap<String, BTreeSet<String>>) -> Option<String> {
    let reached = |from: &String| {
        let (mut reached, mut waiting) = (BTreeSet::new(), vec![from.clone()]);
        while let Some(module) = waiting.pop() {
            for used in uses.get(&module).into_iter().flatten() {
                if reached.insert(used.clone()) {
                    waiting.push(used.clone());
                }
            }
        }
        reached
    };
    uses.keys().find(|module| reached(module).contains(*module)).cloned()
}
