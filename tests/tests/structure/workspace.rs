//! The manifests and the lock file of the workspace.

use std::collections::{BTreeMap, BTreeSet};

use toml::{Table, Value};

use crate::files::{read, repository};

/// A package of the workspace.
pub struct Package {
    pub name: String,
    /// Relative to the repository.
    pub folder: String,
    pub description: String,
    /// Packages of the workspace that it uses, for whatever purpose.
    pub workspace_dependencies: BTreeSet<String>,
    pub manifest: Table,
}

impl Package {
    /// Dependencies of every kind, for tests and build scripts too.
    pub fn all_dependencies(&self) -> Vec<(&str, &Value)> {
        ["dependencies", "dev-dependencies", "build-dependencies"]
            .into_iter()
            .filter_map(|kind| self.manifest.get(kind)?.as_table())
            .flatten()
            .map(|(name, value)| (name.as_str(), value))
            .collect()
    }

    /// Dependencies of the package itself.
    fn own_dependencies(&self) -> impl Iterator<Item = &str> {
        let table = self.manifest.get("dependencies").and_then(Value::as_table);
        table.into_iter().flatten().map(|(name, _)| name.as_str())
    }
}

/// All packages of the workspace.
pub fn packages() -> Vec<Package> {
    let root = parse("Cargo.toml");
    let members = root["workspace"]["members"].as_array().expect("members");
    members
        .iter()
        .map(|member| {
            let folder = member.as_str().expect("a folder").to_owned();
            let manifest = parse(&format!("{folder}/Cargo.toml"));
            let text = |key: &str| manifest["package"][key].as_str().expect(key).to_owned();
            let mut package = Package {
                name: text("name"),
                description: text("description"),
                folder,
                workspace_dependencies: BTreeSet::new(),
                manifest: manifest.clone(),
            };
            package.workspace_dependencies = package
                .all_dependencies()
                .into_iter()
                .map(|(name, _)| name.to_owned())
                .filter(|name| name == "plumbline" || name.starts_with("plumbline-"))
                .collect();
            package
        })
        .collect()
}

fn parse(file: &str) -> Table {
    read(&repository().join(file)).parse().unwrap_or_else(|error| panic!("{file}: {error}"))
}

/// Which library uses which, from the lock file; versions of a library count as one.
pub struct Lock {
    uses: BTreeMap<String, BTreeSet<String>>,
}

impl Lock {
    pub fn read() -> Self {
        let lock = parse("Cargo.lock");
        let mut uses: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
        for package in lock["package"].as_array().expect("packages") {
            let dependencies = package.get("dependencies").and_then(Value::as_array).into_iter().flatten();
            // An entry is `name`, or `name version` where there are several.
            let names = dependencies.filter_map(|entry| entry.as_str()?.split(' ').next()).map(str::to_owned);
            uses.entry(package["name"].as_str().expect("a name").to_owned()).or_default().extend(names);
        }
        Self { uses }
    }

    /// Everything that a package's own dependencies lead to. Packages of the workspace are
    /// followed through their manifests, because the lock file mixes in what their tests use.
    pub fn reached_by(&self, package: &Package, packages: &[Package]) -> BTreeSet<String> {
        let mut reached = BTreeSet::new();
        let mut next: Vec<String> = package.own_dependencies().map(str::to_owned).collect();
        while let Some(name) = next.pop() {
            if !reached.insert(name.clone()) {
                continue;
            }
            match packages.iter().find(|package| package.name == name) {
                Some(package) => next.extend(package.own_dependencies().map(str::to_owned)),
                None => next.extend(self.uses.get(&name).into_iter().flatten().cloned()),
            }
        }
        reached
    }
}
