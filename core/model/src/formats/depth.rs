//! How deep a text nests, told before a parser sees it that works its way down by calling itself and
//! would run out of stack.

/// Files of this program and of robots nest less than a dozen deep.
const DEEPEST: usize = 64;

/// Refuses what nests deeper than any file here.
///
/// # Errors
/// With what is wrong, for people.
pub fn check(depth: usize) -> Result<(), String> {
    if depth <= DEEPEST {
        return Ok(());
    }
    Err(format!(
        "it nests {depth} levels deep, where {DEEPEST} are plenty: it was not written by a program for robots"
    ))
}

/// Elements of XML inside each other.
pub fn of_xml(text: &str) -> usize {
    let (mut depth, mut deepest) = (0usize, 0);
    let mut rest = text;
    while let Some(at) = rest.find('<') {
        rest = &rest[at..];
        let past = |end: &str| rest.find(end).map_or("", |found| &rest[found + end.len()..]);
        rest = if rest.starts_with("<!--") {
            past("-->")
        } else if rest.starts_with("<![CDATA[") {
            past("]]>")
        } else if rest.starts_with("<?") || rest.starts_with("<!") {
            past(">")
        } else {
            let end = end_of_tag(rest);
            let tag = &rest[..end];
            if tag.starts_with("</") {
                depth = depth.saturating_sub(1);
            } else if !tag.ends_with("/>") {
                depth += 1;
                deepest = deepest.max(depth);
            }
            &rest[end..]
        };
    }
    deepest
}

/// Where the tag that a text begins with ends; `>` may stand in the quotes of an attribute.
fn end_of_tag(text: &str) -> usize {
    let mut quote = None;
    for (at, byte) in text.bytes().enumerate() {
        match (quote, byte) {
            (None, b'"' | b'\'') => quote = Some(byte),
            (None, b'>') => return at + 1,
            (Some(open), _) if open == byte => quote = None,
            _ => {}
        }
    }
    text.len()
}

/// Groups of YAML or JSON inside each other: brackets, dashes before an item, indentation.
pub fn of_yaml(text: &str) -> usize {
    let (mut brackets, mut deepest) = (0usize, 0);
    for line in text.lines() {
        let mut levels = 0usize;
        let (mut quoted, mut escaped) = (false, false);
        for (at, byte) in line.bytes().enumerate() {
            match byte {
                _ if escaped => escaped = false,
                b'\\' if quoted => escaped = true,
                b'"' => quoted = !quoted,
                _ if quoted => {}
                b'[' | b'{' => brackets += 1,
                b']' | b'}' => brackets = brackets.saturating_sub(1),
                b'#' if at == 0 || line.as_bytes()[at - 1] == b' ' => break,
                _ => {}
            }
            deepest = deepest.max(brackets);
            // Each dash with a space opens a list, a question mark a group; some parsers take them
            // behind a key, too.
            levels = match byte {
                b'-' | b'?' => levels + 1,
                b' ' => levels,
                _ => 0,
            };
            deepest = deepest.max(levels);
        }
    }
    let indented = text.lines().map(|line| line.len() - line.trim_start_matches(' ').len()).max();
    // A level is at least one space; long lines that go on are indented more, but not so far.
    deepest.max(indented.unwrap_or(0) / 4)
}

/// Groups of TOML inside each other: brackets, and the dots of keys.
pub fn of_toml(text: &str) -> usize {
    let dots = |line: &str| {
        let key = line.split('=').next().unwrap_or_default();
        key.bytes().filter(|byte| *byte == b'.').count()
    };
    let is_key = |line: &&str| line.contains('=') || line.trim_start().starts_with('[');
    let dotted =
        text.lines().filter(is_key).filter(|line| !line.trim_start().starts_with(['"', '#'])).map(dots);
    of_yaml(text).max(dotted.max().unwrap_or(0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elements_are_counted_and_what_is_none_is_not() {
        let text =
            "<?xml version=\"1.0\"?><!-- <a><b> --><r a=\"1>2\"><b/><c><d x='<'/></c><![CDATA[<e><f>]]></r>";
        assert_eq!(of_xml(text), 2);
        assert_eq!(of_xml(&"<a>".repeat(20_000)), 20_000);
        assert_eq!(of_xml("no tag < at all"), 1);
    }

    #[test]
    fn groups_are_counted_by_brackets_dashes_and_indentation() {
        assert_eq!(of_yaml("a: [1, [2, 3]]\nb: \"[[[\"\n"), 2);
        assert_eq!(of_yaml("# [[[[\n- - - 1\n"), 3);
        assert_eq!(of_yaml("rows: - - - - 1\n"), 4);
        assert_eq!(of_yaml("at: 2026-01-02 - x\n"), 1);
        assert_eq!(of_yaml(&"[".repeat(20_000)), 20_000);
        assert_eq!(of_yaml(&"- ".repeat(500)), 500);
        assert!(of_yaml(&(0..400).map(|i| " ".repeat(i) + "a:\n").collect::<String>()) > DEEPEST);
        assert_eq!(of_toml("a.b.c = \"x.y.z.w\"\nt = [0.1, 0.2]\n"), 2);
        assert!(of_toml(&format!("{}a = 1\n", "a.".repeat(300))) > DEEPEST);
    }

    #[test]
    fn too_deep_is_said_in_words() {
        assert_eq!(check(12), Ok(()));
        assert!(check(20_000).expect_err("too deep").starts_with("it nests 20000 levels deep"));
    }
}
