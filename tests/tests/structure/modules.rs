//! Which module of a package uses which, read from its source.
//!
//! A path that names a thing by way of a re-export leads to the module in which the thing stands.
//! What only tests compile is left out, and that a module hands on what its own children offer is
//! no use of them.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use proc_macro2::{Delimiter, TokenStream, TokenTree};

/// A path of names from the root of a package.
pub type Names = Vec<String>;

/// The modules of a package that stand in files of their own.
pub struct Modules {
    modules: BTreeMap<Names, Module>,
}

#[derive(Default)]
struct Module {
    /// What its text names, and whether it only hands it on.
    named: Vec<(Names, bool)>,
    /// What it offers under names of its own.
    offered: BTreeMap<String, Names>,
    /// Modules all of whose things it offers.
    offered_whole: Vec<Names>,
    for_tests: BTreeSet<String>,
}

impl Modules {
    /// Of the package whose `src` folder this is.
    pub fn read(src: &Path) -> Self {
        let texts = files(src).into_iter().map(|(names, file)| {
            let text = std::fs::read_to_string(&file).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
            (names, text)
        });
        Self::of(texts.collect())
    }

    /// Of these texts.
    pub fn of(texts: BTreeMap<Names, String>) -> Self {
        let known: BTreeSet<Names> = texts.keys().cloned().collect();
        let mut modules = BTreeMap::new();
        for (names, text) in texts {
            let tokens: TokenStream = text.parse().unwrap_or_else(|e| panic!("{}: {e}", names.join("::")));
            let mut module = Module::default();
            Reader { known: &known, module: &mut module }.read(tokens, &names);
            modules.insert(names, module);
        }
        let for_tests: BTreeSet<Names> = modules
            .iter()
            .flat_map(|(names, module)| module.for_tests.iter().map(|child| below(names, child)))
            .collect();
        modules.retain(|names, _| !(1..=names.len()).any(|n| for_tests.contains(&names[..n])));
        Self { modules }
    }

    /// Who uses whom, by the names that `called` gives to modules; what it gives none is left out.
    pub fn uses(&self, called: impl Fn(&Names) -> Option<String>) -> BTreeMap<String, BTreeSet<String>> {
        let mut uses: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
        for (names, module) in &self.modules {
            let Some(user) = called(names) else { continue };
            let used = uses.entry(user.clone()).or_default();
            for (path, hands_on) in &module.named {
                let Some(found) = self.stands_in(path, 0) else { continue };
                if *hands_on && found.starts_with(names) {
                    continue;
                }
                used.extend(called(&found).filter(|name| *name != user));
            }
        }
        uses
    }

    /// The module in which a thing stands.
    fn stands_in(&self, path: &[String], steps: usize) -> Option<Names> {
        let own = (0..=path.len()).rev().find(|n| self.modules.contains_key(&path[..*n]))?;
        let (names, rest) = path.split_at(own);
        let module = &self.modules[names];
        // Longer chains would go in circles.
        if let (Some(first), true) = (rest.first(), steps < 12) {
            if let Some(offered) = module.offered.get(first) {
                let further: Names = offered.iter().chain(&rest[1..]).cloned().collect();
                if further != path {
                    return self.stands_in(&further, steps + 1);
                }
            }
            for whole in &module.offered_whole {
                let further: Names = whole.iter().chain(rest).cloned().collect();
                match self.stands_in(&further, steps + 1) {
                    Some(found) if found.len() > whole.len() || self.offers(&found, rest) => {
                        return Some(found);
                    }
                    _ => {}
                }
            }
        }
        Some(names.to_vec())
    }

    fn offers(&self, module: &Names, rest: &[String]) -> bool {
        rest.first().is_some_and(|first| self.modules[module].offered.contains_key(first))
    }
}

/// Those that use each other in circles, each circle in order.
pub fn circles(uses: &BTreeMap<String, BTreeSet<String>>) -> Vec<Vec<String>> {
    let reached: BTreeMap<&String, BTreeSet<&String>> =
        uses.keys().map(|from| (from, reach(from, uses))).collect();
    let mut found: BTreeSet<Vec<String>> = BTreeSet::new();
    for (from, to) in &reached {
        let circle: Vec<String> = to
            .iter()
            .filter(|to| reached.get(**to).is_some_and(|r| r.contains(*from)))
            .map(|n| (*n).clone())
            .collect();
        if !circle.is_empty() {
            found.insert(circle);
        }
    }
    found.into_iter().collect()
}

fn reach<'a>(from: &String, uses: &'a BTreeMap<String, BTreeSet<String>>) -> BTreeSet<&'a String> {
    let mut reached = BTreeSet::new();
    let mut next: Vec<&String> = uses.get(from).into_iter().flatten().collect();
    while let Some(name) = next.pop() {
        if reached.insert(name) {
            next.extend(uses.get(name).into_iter().flatten());
        }
    }
    reached
}

fn below(names: &[String], child: &str) -> Names {
    names.iter().cloned().chain([child.to_owned()]).collect()
}

fn files(src: &Path) -> Vec<(Names, std::path::PathBuf)> {
    let mut found = Vec::new();
    let mut folders = vec![(Vec::new(), src.to_owned())];
    while let Some((names, folder)) = folders.pop() {
        for entry in std::fs::read_dir(&folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display())) {
            let path = entry.expect("an entry").path();
            let stem = path.file_stem().expect("a name").to_string_lossy().into_owned();
            if path.is_dir() {
                folders.push((below(&names, &stem), path));
            } else if path.extension().is_some_and(|end| end == "rs") {
                match stem.as_str() {
                    "main" => {}
                    "lib" | "mod" => found.push((names.clone(), path)),
                    stem => found.push((below(&names, stem), path)),
                }
            }
        }
    }
    found
}

struct Reader<'a> {
    known: &'a BTreeSet<Names>,
    module: &'a mut Module,
}

impl Reader<'_> {
    fn read(&mut self, tokens: TokenStream, at: &Names) {
        let tokens: Vec<TokenTree> = tokens.into_iter().collect();
        let mut i = 0;
        let mut is_public = false;
        while i < tokens.len() {
            match &tokens[i] {
                TokenTree::Punct(p) if p.as_char() == '#' && is_for_tests(tokens.get(i + 1)) => {
                    let end = end_of_item(&tokens, i + 2);
                    self.note_tests(&tokens[i + 2..end]);
                    i = end;
                    continue;
                }
                TokenTree::Ident(word) if word == "pub" => is_public = true,
                TokenTree::Ident(word) if word == "use" => {
                    let end = (i..tokens.len()).find(|j| is_punct(&tokens[*j], ';')).unwrap_or(tokens.len());
                    self.take_use(&tokens[i + 1..end], &[], at, is_public);
                    i = end;
                    is_public = false;
                }
                TokenTree::Ident(word) if word == "mod" => {
                    if let (Some(TokenTree::Ident(name)), Some(TokenTree::Group(inside))) =
                        (tokens.get(i + 1), tokens.get(i + 2))
                    {
                        self.read(inside.stream(), &below(at, &name.to_string()));
                        i += 2;
                    }
                    is_public = false;
                }
                TokenTree::Ident(word) if ["crate", "self", "super"].iter().any(|root| word == root) => {
                    let (path, after) = path_at(&tokens, i);
                    if path.len() > 1 {
                        self.name(&path, at, false);
                    }
                    i = after;
                    continue;
                }
                TokenTree::Group(group) => {
                    // `pub(crate)` is public for what follows; everything else ends it.
                    is_public &= group.delimiter() == Delimiter::Parenthesis;
                    self.read(group.stream(), at);
                }
                _ => is_public = false,
            }
            i += 1;
        }
    }

    fn note_tests(&mut self, item: &[TokenTree]) {
        let at = item.iter().position(|token| matches!(token, TokenTree::Ident(word) if word == "mod"));
        if let Some(TokenTree::Ident(name)) = at.and_then(|at| item.get(at + 1)) {
            self.module.for_tests.insert(name.to_string());
        }
    }

    fn take_use(&mut self, tree: &[TokenTree], before: &[String], at: &Names, is_public: bool) {
        let mut path = before.to_vec();
        let mut offered_as = None;
        for (i, token) in tree.iter().enumerate() {
            match token {
                TokenTree::Ident(word) if word == "as" => {
                    offered_as = tree.get(i + 1).map(ToString::to_string);
                    break;
                }
                TokenTree::Ident(word) => path.push(word.to_string()),
                TokenTree::Punct(p) if p.as_char() == '*' => path.push("*".to_owned()),
                TokenTree::Group(group) => {
                    let tokens: Vec<TokenTree> = group.stream().into_iter().collect();
                    for branch in tokens.split(|token| is_punct(token, ',')) {
                        self.take_use(branch, &path, at, is_public);
                    }
                    return;
                }
                _ => {}
            }
        }
        if path.len() > before.len() && path.last().is_some_and(|last| last == "self") {
            path.pop();
        }
        if path.is_empty() || path.len() == before.len() && before.is_empty() {
            return;
        }
        let Some(whole) = self.name(&path, at, is_public) else { return };
        if is_public && whole.last().is_some_and(|last| last == "*") {
            self.module.offered_whole.push(whole[..whole.len() - 1].to_vec());
        } else if let (true, Some(name)) = (is_public, offered_as.or_else(|| whole.last().cloned())) {
            self.module.offered.insert(name, whole);
        }
    }

    /// Notes a path that is named, if it leads into the package.
    fn name(&mut self, path: &[String], at: &Names, hands_on: bool) -> Option<Names> {
        let mut from = at.clone();
        let whole = match path[0].as_str() {
            "crate" => path[1..].to_vec(),
            "self" => from.into_iter().chain(path[1..].iter().cloned()).collect(),
            "super" => {
                let up = path.iter().take_while(|name| *name == "super").count();
                from.truncate(from.len().saturating_sub(up));
                from.into_iter().chain(path[up..].iter().cloned()).collect()
            }
            child if self.known.contains(&below(at, child)) => {
                from.into_iter().chain(path.iter().cloned()).collect()
            }
            _ => return None,
        };
        self.module.named.push((whole.clone(), hands_on));
        Some(whole)
    }
}

fn is_punct(token: &TokenTree, wanted: char) -> bool {
    matches!(token, TokenTree::Punct(found) if found.as_char() == wanted)
}

/// Names with `::` between them, and where they end.
fn path_at(tokens: &[TokenTree], start: usize) -> (Names, usize) {
    let (mut path, mut i) = (Vec::new(), start);
    while let Some(TokenTree::Ident(word)) = tokens.get(i) {
        path.push(word.to_string());
        let goes_on = [i + 1, i + 2].iter().all(|j| tokens.get(*j).is_some_and(|token| is_punct(token, ':')));
        i += 1;
        if !goes_on || !matches!(tokens.get(i + 2), Some(TokenTree::Ident(_))) {
            break;
        }
        i += 2;
    }
    (path, i)
}

fn is_for_tests(attribute: Option<&TokenTree>) -> bool {
    let Some(TokenTree::Group(group)) = attribute else { return false };
    let text = group.stream().to_string();
    text.starts_with("cfg")
        && !text.contains("not")
        && text.split(|c: char| !c.is_alphanumeric()).any(|w| w == "test")
}

fn end_of_item(tokens: &[TokenTree], start: usize) -> usize {
    let ends = |token: &TokenTree| {
        is_punct(token, ';') || matches!(token, TokenTree::Group(g) if g.delimiter() == Delimiter::Brace)
    };
    (start..tokens.len()).find(|i| ends(&tokens[*i])).map_or(tokens.len(), |i| i + 1)
}
