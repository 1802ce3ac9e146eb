//! What ARCHITECTURE.md says about the workspace is true.

mod engine;
mod files;
mod markdown;
mod modules;
mod rooms;
mod shared;
mod words;
mod workspace;

use std::collections::BTreeSet;

use files::{read, repository, tracked_text_files};
use markdown::Table;
use workspace::{Lock, Package, packages};

pub(crate) fn architecture() -> String {
    read(&repository().join("ARCHITECTURE.md"))
}

/// The name that the tables use: without `plumbline-`, and `app` for the program itself.
fn short(package: &str) -> &str {
    match package {
        "plumbline" => "app",
        other => other.strip_prefix("plumbline-").unwrap_or(other),
    }
}

#[test]
fn the_table_of_packages_is_the_workspace() {
    let text = architecture();
    let table = Table::with_header(&text, &["package", "folder", "what it is"]);
    let told: BTreeSet<[String; 3]> =
        table.rows.iter().map(|row| [0, 1, 2].map(|column| row[column].replace('`', ""))).collect();
    let found: BTreeSet<[String; 3]> =
        packages().into_iter().map(|package| [package.name, package.folder, package.description]).collect();
    assert_eq!(told, found, "left: ARCHITECTURE.md, right: the manifests");
}

#[test]
fn packages_use_only_what_the_table_allows_and_the_table_allows_only_what_is_used() {
    let text = architecture();
    let table = Table::starting_with(&text, "may use →");
    let packages = packages();
    assert_eq!(
        table.rows.iter().map(|row| row[0].as_str()).collect::<BTreeSet<_>>(),
        packages.iter().map(|package| short(&package.name)).collect::<BTreeSet<_>>(),
        "every package has its row"
    );
    for package in &packages {
        let name = short(&package.name);
        let used: BTreeSet<&str> = package.workspace_dependencies.iter().map(|used| short(used)).collect();
        let allowed = table.ticked(name);
        let forbidden: Vec<_> = used.difference(&allowed).collect();
        assert!(forbidden.is_empty(), "{name} uses {forbidden:?}, which ARCHITECTURE.md does not allow");
        // The tests may look at everything, whether or not they do at the moment.
        if name != "tests" {
            let unused: Vec<_> = allowed.difference(&used).collect();
            assert!(unused.is_empty(), "ARCHITECTURE.md allows {name} to use {unused:?}, which it does not");
        }
    }
}

#[test]
fn the_computation_reaches_no_window() {
    let text = architecture();
    let table = Table::with_header(&text, &["package", "never reaches"]);
    let packages = packages();
    let lock = Lock::read();
    for below in ["model", "vision", "hardware", "twin", "engine"] {
        let row = table.row(below);
        // The twin draws what its eyes see, without a window.
        let drawing = ["wgpu"].into_iter().filter(|_| !["twin", "engine"].contains(&below));
        for library in ["egui", "eframe", "winit"].into_iter().chain(drawing) {
            assert!(
                row[1].split(", ").any(|told| told == library),
                "{below} must be told to avoid {library}"
            );
        }
    }
    for row in &table.rows {
        let package = packages.iter().find(|package| short(&package.name) == row[0]).expect(&row[0]);
        // What a program loads, not what its tests use.
        let reached = lock.reached_by(package, &packages);
        for library in row[1].split(", ") {
            assert!(
                !reached.contains(library),
                "{} reaches {library}, which ARCHITECTURE.md rules out; cargo tree -p {} -i {library} says how",
                row[0],
                package.name
            );
        }
    }
    let app = packages.iter().find(|package| package.name == "plumbline").expect("the program");
    assert!(lock.reached_by(app, &packages).contains("egui"), "this test must be able to see a window");
}

#[test]
fn nobody_but_judges_reads_what_the_twin_hides() {
    // Put together here, so that this file does not contain them itself.
    let hidden = [
        "truth_for".to_owned() + "_judging",
        "plumbline_twin::".to_owned() + "truth",
        "plumbline_twin::".to_owned() + "judging",
    ];
    let mut readers = Vec::new();
    let mut in_twin = 0;
    for (name, text) in tracked_text_files().into_iter().filter(|(name, _)| name.ends_with(".rs")) {
        let reads = hidden.iter().any(|hidden| text.contains(hidden.as_str()));
        // The twin itself offers it; tests and judges may ask.
        let judges = name.starts_with("tests/") || name.contains("/tests/") || name.ends_with("/judge.rs");
        if name.starts_with("core/twin/") {
            in_twin += usize::from(reads);
        } else if reads && !judges {
            readers.push(name);
        }
    }
    assert!(in_twin > 0, "this test must be able to see the truth");
    assert!(readers.is_empty(), "these read what the twin hides: {readers:?}");
}

#[test]
fn one_place_writes_files() {
    // Each with a reason of its own: the writer itself; lines that are added to a file as things
    // happen; a probe of whether a folder can be written to, with nothing in it; what tests count.
    let writers = [
        "core/model/src/files/",
        "core/engine/src/engine/journal.rs",
        "core/recording/src/writer.rs",
        "core/offline/src/doctor/",
        "core/model/src/measured_data.rs",
    ];
    // Put together here, so that this file does not contain them itself.
    let ways = ["fs::wr", "File::cr", "File::op", "OpenO"]
        .iter()
        .zip(["ite(", "eate", "tions()", "ptions"])
        .map(|(start, end)| (*start).to_owned() + end);
    let ways: Vec<String> = ways.collect();
    let (mut others, mut seen) = (Vec::new(), 0);
    for (name, text) in tracked_text_files() {
        let in_program =
            ["core/", "app/", "widgets/"].iter().any(|part| name.starts_with(part)) && name.contains("/src/");
        let is_test = name
            .split_once("/src/")
            .is_some_and(|(_, below)| ["tests", "laws"].iter().any(|t| below.contains(t)));
        if !in_program || !name.ends_with(".rs") || is_test {
            continue;
        }
        let program = text.split("#[cfg(test)]").next().unwrap_or_default();
        if !ways.iter().any(|way| program.contains(way.as_str())) {
            continue;
        }
        match writers.iter().any(|writer| name.starts_with(writer)) {
            true => seen += 1,
            false => others.push(name),
        }
    }
    assert!(seen >= writers.len(), "this test must be able to see those that write");
    assert!(
        others.is_empty(),
        "these write files themselves; plumbline_model::files does it so that a full disk and a kill \
         leave the old file: {others:?}"
    );
}

#[test]
fn every_package_follows_the_workspace() {
    for package in packages() {
        let Package { name, manifest, .. } = &package;
        let inherits = |table: &toml::Table, key: &str| {
            table.get(key).and_then(|value| value.get("workspace")).and_then(toml::Value::as_bool)
                == Some(true)
        };
        let head = manifest["package"].as_table().expect("a table");
        for key in ["version", "edition", "rust-version", "license", "publish"] {
            assert!(inherits(head, key), "{name}: {key} must come from the workspace");
        }
        let lints = manifest.get("lints").and_then(toml::Value::as_table).expect("lints");
        assert_eq!(lints.get("workspace"), Some(&toml::Value::Boolean(true)), "{name}: lints");
        for (dependency, value) in package.all_dependencies() {
            assert!(
                value.as_table().is_some_and(|table| table.contains_key("workspace")),
                "{name}: the version of {dependency} belongs in the workspace's manifest"
            );
        }
    }
}

#[test]
fn no_file_names_a_place_of_one_machine() {
    // Put together here, so that this file does not contain them itself.
    let places: Vec<String> =
        ["home", "root", "work", "Users", "tmp"].iter().map(|p| format!("/{p}/")).collect();
    let mut found = Vec::new();
    for (name, text) in tracked_text_files() {
        for (number, line) in text.lines().enumerate() {
            // A path of this kind starts a word; inside one it is part of a relative path.
            let starts_word = |at: usize| {
                at == 0 || !line[..at].ends_with(|c: char| c.is_alphanumeric() || "._-~*}<".contains(c))
            };
            for place in &places {
                if line.match_indices(place.as_str()).any(|(at, _)| starts_word(at)) {
                    found.push(format!("{name}:{}: {}", number + 1, line.trim()));
                }
            }
        }
    }
    assert!(found.is_empty(), "paths of one machine:\n{}", found.join("\n"));
}

#[test]
fn the_scripts_can_be_run() {
    use std::os::unix::fs::PermissionsExt;
    for script in ["plumbline", ".ci/run", "packaging/package.sh", "packaging/test.sh", "packaging/AppRun"] {
        let path = repository().join(script);
        let mode = std::fs::metadata(&path).expect(script).permissions().mode();
        assert_eq!(mode & 0o111, 0o111, "{script} is not executable");
        let checked = std::process::Command::new("bash").arg("-n").arg(&path).status().expect("bash");
        assert!(checked.success(), "{script} has a syntax error");
    }
}
