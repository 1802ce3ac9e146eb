//! Modules of a package use each other in one direction.

use std::collections::{BTreeMap, BTreeSet};

use crate::architecture;
use crate::files::{repository, tracked_text_files};
use crate::markdown::Table;
use crate::modules::{Modules, Names, circles};
use crate::workspace::packages;

/// The folder or file right below `src` that a module belongs to.
fn room(names: &Names) -> Option<String> {
    names.first().cloned()
}

fn file(names: &Names) -> Option<String> {
    Some(names.join("::")).filter(|name| !name.is_empty())
}

fn told(circles: &[Vec<String>]) -> String {
    circles.iter().map(|circle| format!("{}: {}\n", circle.len(), circle.join(", "))).collect()
}

#[test]
fn no_rooms_of_a_package_use_each_other_in_a_circle() {
    let mut found = String::new();
    let mut seen = 0;
    for package in packages() {
        let modules = Modules::read(&repository().join(&package.folder).join("src"));
        let uses = modules.uses(room);
        seen += uses.values().map(BTreeSet::len).sum::<usize>();
        let circles = circles(&uses);
        if !circles.is_empty() {
            found += &format!("{}\n{}", package.name, told(&circles));
        }
    }
    assert!(seen > 100, "this test must be able to see who uses whom; it saw {seen} arrows");
    assert!(found.is_empty(), "circles:\n{found}");
}

/// Who uses whom among the modules right below `src`, as found there.
fn rooms_of(package: &str) -> BTreeMap<String, BTreeSet<String>> {
    Modules::read(&repository().join(package).join("src")).uses(room)
}

#[test]
fn modules_of_the_engine_use_only_what_the_table_allows() {
    let text = architecture();
    let table = Table::with_header(&text, &["module of the engine", "what it is", "may use"]);
    let uses = rooms_of("core/engine");
    let told: BTreeSet<&str> = table.rows.iter().map(|row| row[0].as_str()).collect();
    let found: BTreeSet<&str> = uses.keys().map(String::as_str).collect();
    assert_eq!(told, found, "left: ARCHITECTURE.md, right: core/engine/src");
    let sums = ["command", "view", "work", "state", "engine"];
    for (module, used) in &uses {
        let may = &table.row(module)[2];
        let names: BTreeSet<&str> = may.split(", ").filter(|name| *name != "–").collect();
        let is_sum = sums.contains(&module.as_str());
        for used in used {
            // Sums know all rooms, and the sums that are named.
            let allowed = names.contains(used.as_str())
                || (is_sum && (may == "everything" || !sums.contains(&used.as_str())));
            assert!(allowed, "{module} uses {used}, which ARCHITECTURE.md does not allow");
        }
        let unused = names.iter().find(|may| !is_sum && !used.contains(**may));
        assert_eq!(unused, None, "ARCHITECTURE.md allows {module} to use it, but it does not");
    }
    assert!(uses["touch"].contains("robot"), "this test must be able to see who uses whom");
}

#[test]
fn what_the_truth_shows_is_seen_by_nobody_who_calibrates_searches_touches_or_grasps() {
    let uses = rooms_of("core/engine");
    // The twin's room hands itself in; the sums put it into the view and take its switch.
    let may = ["truth", "twin", "command", "view", "work", "state", "engine"];
    let using: BTreeSet<&str> =
        uses.iter().filter(|(_, used)| used.contains("truth")).map(|(module, _)| module.as_str()).collect();
    assert!(
        using.contains("twin") && using.contains("state"),
        "this test must be able to see who uses it: {using:?}"
    );
    let others: Vec<&&str> = using.iter().filter(|module| !may.contains(module)).collect();
    assert!(others.is_empty(), "these can see the truth: {others:?}");
    // Past the view nothing of it goes: within the sums only these name it, and no other package but the
    // window's does.
    let room = ["plumbline_engine::", "crate::"].map(|from| from.to_owned() + "truth");
    let shown = ["Truth".to_owned() + "View", "Truth".to_owned() + "Row"];
    let (mut seen, mut past) = (0, Vec::new());
    for (name, text) in tracked_text_files().into_iter().filter(|(name, _)| name.ends_with(".rs")) {
        // The twin's own room of that name is what judges alone may read, which another test holds.
        let is_of_twin = name.starts_with("core/twin/");
        if is_of_twin || !room.iter().chain(&shown).any(|word| text.contains(word.as_str())) {
            continue;
        }
        seen += 1;
        let of_sums = [
            "command.rs",
            "view.rs",
            "state/mod.rs",
            "state/rooms.rs",
            "state/dispatch.rs",
            "state/neighbors.rs",
            "lib.rs",
        ];
        let of_engine = ["truth/", "twin/desk/mod.rs", "engine/pipeline.rs", "engine/hub.rs"];
        let inside =
            |part: &&str| name.strip_prefix("core/engine/src/").is_some_and(|rest| rest.starts_with(part));
        let allowed = name.starts_with("app/") || of_sums.iter().chain(&of_engine).any(inside);
        if !allowed {
            past.push(name);
        }
    }
    assert!(seen > 5, "this test must be able to see who names it");
    assert!(past.is_empty(), "these name what only the window may show: {past:?}");
}

#[test]
fn floors_of_the_window_know_only_those_below() {
    let text = architecture();
    let table = Table::with_header(&text, &["floor of `app/src`", "what stands there", "knows"]);
    let uses = rooms_of("app");
    let told: BTreeSet<String> = table.rows.iter().map(|row| row[0].replace('`', "")).collect();
    assert_eq!(told, uses.keys().cloned().collect(), "left: ARCHITECTURE.md, right: app/src");
    for row in &table.rows {
        let (floor, may) = (row[0].replace('`', ""), row[2].replace('`', ""));
        let may: BTreeSet<&str> = may.split(", ").collect();
        let past = uses[&floor].iter().find(|used| !may.contains(used.as_str()));
        assert_eq!(past, None, "{floor} knows a floor that ARCHITECTURE.md does not allow");
    }
    assert!(uses["window"].contains("panels"), "this test must be able to see who uses whom");
}

#[test]
fn what_other_packages_define_comes_through_one_door() {
    // Put together here, so that this file does not contain them itself.
    let others = ["gap", "models", "touch"].map(|package| format!("plumbline_engine::{package}::"));
    let (mut door, mut past) = (0, Vec::new());
    for (name, text) in tracked_text_files().into_iter().filter(|(name, _)| name.starts_with("app/src/")) {
        if !others.iter().any(|other| text.contains(other.as_str())) {
            continue;
        }
        match name.ends_with("operator/snapshot.rs") {
            true => door += 1,
            false => past.push(name),
        }
    }
    assert_eq!(door, 1, "this test must be able to see the door");
    assert!(past.is_empty(), "these go past operator/snapshot.rs: {past:?}");
}

fn package(files: &[(&str, &str)]) -> Modules {
    let names =
        |path: &str| -> Names { path.split("::").filter(|n| !n.is_empty()).map(str::to_owned).collect() };
    Modules::of(files.iter().map(|(path, text)| (names(path), (*text).to_owned())).collect())
}

fn arrows(modules: &Modules) -> BTreeMap<String, BTreeSet<String>> {
    modules.uses(file)
}

#[test]
fn a_thing_is_looked_for_where_it_stands() {
    let modules = package(&[
        ("", "mod a; mod b; pub use a::Thing; pub use b::deep::*;"),
        ("a", "pub struct Thing; fn f() -> crate::b::Other { todo() }"),
        ("b", "pub mod deep; pub use deep::{Other, inner::{self, More as Most}};"),
        (
            "b::deep",
            "pub struct Other; // crate::a::Thing is only spoken of\n const S: &str = \"crate::a::Thing\";",
        ),
        ("b::deep::inner", "use super::super::super::Thing;"),
        ("c", "use crate::{Thing, b::Most}; mod tests_of_c { use super::super::a; }"),
    ]);
    let arrows = arrows(&modules);
    let of = |name: &str| arrows[name].iter().map(String::as_str).collect::<Vec<_>>();
    assert_eq!(of("a"), ["b::deep"]);
    assert_eq!(of("b::deep"), [""; 0], "comments and texts use nothing");
    assert_eq!(of("b::deep::inner"), ["a"]);
    assert_eq!(of("b"), [""; 0], "what it hands on of its own children is no use");
    assert_eq!(of("c"), ["a", "b::deep::inner"]);
    assert_eq!(circles(&arrows), [[""; 0]; 0]);
}

#[test]
fn a_circle_is_seen_and_what_only_tests_compile_is_not() {
    let modules = package(&[
        ("", "mod a; mod b; mod c; #[cfg(test)] mod trial;"),
        ("a", "use crate::b::B; pub struct A;"),
        ("b", "pub struct B; fn f() { crate::c::call() }"),
        ("c", "pub fn call() { let _ = super::a::A; }"),
        ("d", "use crate::a::A; #[cfg(test)] mod tests { use crate::e::E; }"),
        ("e", "#[cfg(all(test, unix))] use crate::d::D; pub struct E;"),
        ("trial", "use crate::d::D;"),
    ]);
    let arrows = arrows(&modules);
    assert_eq!(circles(&arrows), [["a", "b", "c"]]);
    assert_eq!(arrows["d"].len(), 1);
    assert!(arrows["e"].is_empty() && !arrows.contains_key("trial"));
}
