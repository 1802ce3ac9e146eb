//! Modules of a package use each other in one direction.

use std::collections::{BTreeMap, BTreeSet};

use crate::files::repository;
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
        if std::env::var_os("PLUMBLINE_SHOW_CIRCLES").is_some() {
            let files = crate::modules::circles(&modules.uses(file));
            println!("{}: files in circles\n{}", package.name, told(&files));
        }
    }
    assert!(seen > 100, "this test must be able to see who uses whom; it saw {seen} arrows");
    assert!(found.is_empty(), "circles:\n{found}");
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
