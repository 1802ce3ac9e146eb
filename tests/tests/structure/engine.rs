//! What the engine tells: errors that say which they are, and things that it names itself.

use proc_macro2::{Delimiter, TokenStream, TokenTree};

use crate::files::tracked_text_files;

/// Files of the engine with their code as tokens, those of its tests among them.
fn sources() -> Vec<(String, Vec<TokenTree>)> {
    let of_engine = |name: &str| {
        name.starts_with("core/engine/") && std::path::Path::new(name).extension() == Some("rs".as_ref())
    };
    let files = tracked_text_files().into_iter().filter(|(name, _)| of_engine(name));
    files.map(|(name, text)| (name, tokens(&text))).collect()
}

fn tokens(text: &str) -> Vec<TokenTree> {
    text.parse::<TokenStream>().expect("the file compiles").into_iter().collect()
}

fn is_punct(token: Option<&TokenTree>, mark: char) -> bool {
    matches!(token, Some(TokenTree::Punct(punct)) if punct.as_char() == mark)
}

fn is_word(token: Option<&TokenTree>, word: &str) -> bool {
    matches!(token, Some(TokenTree::Ident(ident)) if ident == word)
}

/// Every `Result` whose error is a mere text, by what it holds.
fn errors_as_text(tokens: &[TokenTree]) -> Vec<String> {
    let mut found = Vec::new();
    for (place, token) in tokens.iter().enumerate() {
        if let TokenTree::Group(group) = token {
            found.extend(errors_as_text(&group.stream().into_iter().collect::<Vec<_>>()));
        }
        let is_result = is_word(Some(token), "Result") && is_punct(tokens.get(place + 1), '<');
        if is_result {
            let arguments = arguments(&tokens[place + 2..]);
            found.extend(arguments.last().filter(|error| is_text(error)).map(|_| arguments.concat()));
        }
    }
    found
}

/// The arguments of a type up to the bracket that ends them, without spaces.
fn arguments(tokens: &[TokenTree]) -> Vec<String> {
    let (mut depth, mut before) = (0, ' ');
    let mut arguments = vec![String::new()];
    for token in tokens {
        let mark = match token {
            TokenTree::Punct(punct) => punct.as_char(),
            _ => ' ',
        };
        match mark {
            '<' => depth += 1,
            // The one of an arrow ends nothing.
            '>' if before == '-' => {}
            '>' if depth == 0 => break,
            '>' => depth -= 1,
            _ => {}
        }
        before = mark;
        match (mark, arguments.last_mut()) {
            (',', _) if depth == 0 => arguments.push(String::new()),
            (_, Some(last)) => last.push_str(&token.to_string()),
            (_, None) => {}
        }
    }
    arguments.into_iter().filter(|argument| !argument.is_empty()).collect()
}

fn is_text(error: &str) -> bool {
    error == "String" || error.ends_with("::String") || (error.starts_with('&') && error.ends_with("str"))
}

/// What `pub use` hands on of another package as a whole.
fn packages_handed_on(tokens: &[TokenTree]) -> Vec<String> {
    let mut found = Vec::new();
    for (place, token) in tokens.iter().enumerate() {
        if let TokenTree::Group(group) = token {
            found.extend(packages_handed_on(&group.stream().into_iter().collect::<Vec<_>>()));
        }
        if !is_word(Some(token), "pub") {
            continue;
        }
        match tokens.get(place + 1) {
            next if is_word(next, "use") => {}
            next if is_word(next, "extern") => found.push("extern crate".to_owned()),
            _ => continue,
        }
        let path: Vec<TokenTree> =
            tokens[place + 2..].iter().take_while(|token| !is_punct(Some(token), ';')).cloned().collect();
        found.extend(leaves(&path).into_iter().filter(|leaf| is_whole(leaf)));
    }
    found
}

/// The paths that a `use` names one by one.
fn leaves(path: &[TokenTree]) -> Vec<String> {
    let Some((TokenTree::Group(group), start)) = path.split_last() else {
        return vec![path.iter().map(ToString::to_string).collect::<Vec<_>>().join(" ")];
    };
    assert_eq!(group.delimiter(), Delimiter::Brace, "a list of names");
    let inner: Vec<TokenTree> = group.stream().into_iter().collect();
    let parts = inner.split(|token| is_punct(Some(token), ',')).filter(|part| !part.is_empty());
    parts.flat_map(|part| leaves(&[start, part].concat())).collect()
}

/// `plumbline_x`, `plumbline_x as y`, `plumbline_x::*`, `plumbline_x::{self}`.
fn is_whole(leaf: &str) -> bool {
    let named = leaf.split(" as ").next().unwrap_or_default();
    let parts: Vec<&str> = named.split(':').map(str::trim).filter(|part| !part.is_empty()).collect();
    match parts.as_slice() {
        [package] | [package, "*" | "self"] => package.starts_with("plumbline_"),
        _ => false,
    }
}

#[test]
fn no_error_of_the_engine_is_a_mere_text() {
    for text in [
        "fn f() -> Result<(), String> {}",
        "struct S { a: Option<Result<Arc<Vec<u8>>, String>> }",
        "type T = Result<Box<dyn Fn(u8) -> Vec<u8>>, std::string::String>;",
        "fn f() -> Result<u8, &'static str> {}",
    ] {
        assert_eq!(errors_as_text(&tokens(text)).len(), 1, "this test must be able to see {text}");
    }
    for text in ["fn f() -> Result<String, Why> {}", "type T = Result<Vec<String>, Told<String>>;"] {
        assert!(errors_as_text(&tokens(text)).is_empty(), "{text}");
    }
    let sources = sources();
    assert!(sources.len() > 100, "this test must be able to see the engine");
    let mut found = Vec::new();
    for (name, tokens) in &sources {
        found.extend(errors_as_text(tokens).into_iter().map(|of| format!("{name}: Result<{of}>")));
    }
    assert!(
        found.is_empty(),
        "errors that are mere texts; make each an enum that says what to do: {found:?}"
    );
}

#[test]
fn the_engine_hands_on_no_package_as_a_whole() {
    for text in [
        "pub use plumbline_gap;",
        "pub use plumbline_gap as gap;",
        "mod m { pub use plumbline_gap::*; }",
        "pub use {crate::a, plumbline_gap::{self, Finding}};",
        "pub extern crate plumbline_gap;",
    ] {
        assert_eq!(packages_handed_on(&tokens(text)).len(), 1, "this test must be able to see {text}");
    }
    for text in ["use plumbline_gap as gap;", "pub use plumbline_gap::{Finding, finding::Unit as U};"] {
        assert!(packages_handed_on(&tokens(text)).is_empty(), "{text}");
    }
    let mut found = Vec::new();
    for (name, tokens) in sources() {
        found.extend(packages_handed_on(&tokens).into_iter().map(|what| format!("{name}: {what}")));
    }
    assert!(found.is_empty(), "name what the engine offers of these: {found:?}");
}
