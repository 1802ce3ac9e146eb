//! What is built to run the program is built for the tests already, and the other way around.

use std::collections::{BTreeMap, BTreeSet};
use std::process::Command;

use crate::files::repository;

/// Libraries outside of the workspace with their features, as far as cargo would build them for this.
fn built_for(words: &[&str]) -> BTreeMap<String, BTreeSet<String>> {
    let cargo = std::env::var_os("CARGO").expect("tests are run by cargo");
    let output = Command::new(cargo)
        .current_dir(repository())
        .args(["tree", "--locked", "--offline", "--prefix", "none", "--format", "{p}|{f}"])
        .args(words)
        .output()
        .expect("cargo can be run");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let mut built: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for line in String::from_utf8_lossy(&output.stdout).lines() {
        let Some((package, features)) = line.trim_end_matches(" (*)").split_once('|') else { continue };
        // Packages of the workspace name their folder.
        if package.contains("(/") {
            continue;
        }
        let features = features.split(',').filter(|feature| !feature.is_empty()).map(str::to_owned);
        built.entry(package.trim_end_matches(" (proc-macro)").to_owned()).or_default().extend(features);
    }
    built
}

#[test]
fn the_program_and_its_tests_share_what_they_compile() {
    let program = built_for(&["--package", "plumbline", "--edges", "normal,build"]);
    let tests = built_for(&["--workspace", "--edges", "normal,build,dev"]);
    assert!(program.len() > 100 && tests.len() > program.len(), "{} and {}", program.len(), tests.len());
    let mut twice = Vec::new();
    for (library, features) in &program {
        let for_tests = tests.get(library);
        if for_tests != Some(features) {
            let more: Vec<_> = for_tests.into_iter().flatten().filter(|f| !features.contains(*f)).collect();
            twice.push(format!("{library}: the tests also ask for {more:?}"));
        }
    }
    assert!(
        twice.is_empty(),
        "these, and all that uses them, would be compiled twice; ask for the same features in the program:\n{}",
        twice.join("\n")
    );
}
