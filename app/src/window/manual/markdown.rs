//! As much of Markdown as the manual uses: headings, paragraphs, lists, tables, code, and bold, italic and
//! code within a line. Pictures are left out: the window itself is there to be looked at.

/// A piece of a page.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Block {
    /// Its level, from 1.
    Heading(usize, Vec<Span>),
    Paragraph(Vec<Span>),
    /// How deep it is, its mark ("•", "2."), its text.
    Item(usize, String, Vec<Span>),
    /// The first row is the heading.
    Table(Vec<Vec<Vec<Span>>>),
    Code(String),
}

/// A part of a line in one look.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Span {
    pub text: String,
    pub look: Look,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Look {
    Plain,
    Strong,
    Italic,
    Code,
}

pub fn blocks(text: &str) -> Vec<Block> {
    let mut blocks: Vec<Block> = vec![];
    // Lines of the paragraph or item under way, which end at an empty line or at the next beginning.
    let mut open: Option<(Option<(usize, String)>, String)> = None;
    let mut lines = text.lines().peekable();
    while let Some(line) = lines.next() {
        let trimmed = line.trim();
        if trimmed.starts_with("```") {
            close(&mut open, &mut blocks);
            let code: Vec<&str> = lines.by_ref().take_while(|line| line.trim() != "```").collect();
            blocks.push(Block::Code(code.join("\n")));
        } else if trimmed.is_empty() || trimmed.starts_with("![") {
            close(&mut open, &mut blocks);
        } else if trimmed.starts_with('#') {
            close(&mut open, &mut blocks);
            let level = trimmed.chars().take_while(|c| *c == '#').count();
            blocks.push(Block::Heading(level, spans(trimmed[level..].trim())));
        } else if trimmed.starts_with('|') {
            close(&mut open, &mut blocks);
            table_row(trimmed, &mut blocks);
        } else if let Some((mark, rest)) = item(trimmed) {
            close(&mut open, &mut blocks);
            let depth = (line.len() - line.trim_start().len()) / 2;
            open = Some((Some((depth, mark)), rest.to_owned()));
        } else {
            let (_, text) = open.get_or_insert((None, String::new()));
            if !text.is_empty() {
                text.push(' ');
            }
            text.push_str(trimmed);
        }
    }
    close(&mut open, &mut blocks);
    blocks
}

fn close(open: &mut Option<(Option<(usize, String)>, String)>, blocks: &mut Vec<Block>) {
    match open.take() {
        Some((Some((depth, mark)), text)) => blocks.push(Block::Item(depth, mark, spans(&text))),
        Some((None, text)) => blocks.push(Block::Paragraph(spans(&text))),
        None => {}
    }
}

/// The mark of a list's item and what follows it.
fn item(line: &str) -> Option<(String, &str)> {
    if let Some(rest) = line.strip_prefix("- ").or_else(|| line.strip_prefix("* ")) {
        return Some(("•".to_owned(), rest));
    }
    let (number, rest) = line.split_once(". ")?;
    let is_number = !number.is_empty() && number.len() < 3 && number.chars().all(|c| c.is_ascii_digit());
    is_number.then(|| (format!("{number}."), rest))
}

fn table_row(line: &str, blocks: &mut Vec<Block>) {
    let inside = line.trim_matches('|');
    if inside.chars().all(|c| matches!(c, '-' | ':' | '|' | ' ')) {
        return;
    }
    let row = inside.split('|').map(|cell| spans(cell.trim())).collect();
    match blocks.last_mut() {
        Some(Block::Table(rows)) => rows.push(row),
        _ => blocks.push(Block::Table(vec![row])),
    }
}

/// Bold, italic, code and links, whose targets are left out.
pub fn spans(text: &str) -> Vec<Span> {
    let mut spans: Vec<Span> = vec![];
    let mut rest = text;
    let mut plain = String::new();
    while let Some(c) = rest.chars().next() {
        let marked = [("**", Look::Strong), ("`", Look::Code), ("*", Look::Italic)];
        let found = marked.into_iter().find_map(|(mark, look)| {
            let (inside, after) = rest.strip_prefix(mark)?.split_once(mark)?;
            (!inside.is_empty()).then_some((inside, after, look))
        });
        if let Some((inside, after, look)) = found {
            if !plain.is_empty() {
                spans.push(Span { text: std::mem::take(&mut plain), look: Look::Plain });
            }
            let text = if look == Look::Code { inside.to_owned() } else { without_links(inside) };
            spans.push(Span { text, look });
            rest = after;
        } else if let Some((name, after)) = link(rest) {
            plain.push_str(name);
            rest = after;
        } else {
            plain.push(c);
            rest = &rest[c.len_utf8()..];
        }
    }
    if !plain.is_empty() {
        spans.push(Span { text: plain, look: Look::Plain });
    }
    spans
}

fn without_links(text: &str) -> String {
    let (mut plain, mut rest) = (String::new(), text);
    while let Some(c) = rest.chars().next() {
        match link(rest) {
            Some((name, after)) => {
                plain.push_str(name);
                rest = after;
            }
            None => {
                plain.push(c);
                rest = &rest[c.len_utf8()..];
            }
        }
    }
    plain
}

/// The name of a link that begins here, and what follows it.
fn link(text: &str) -> Option<(&str, &str)> {
    let (name, rest) = text.strip_prefix('[')?.split_once("](")?;
    let (_target, after) = rest.split_once(')')?;
    (!name.contains('[')).then_some((name, after))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plain(text: &str) -> Span {
        Span { text: text.to_owned(), look: Look::Plain }
    }

    #[test]
    fn what_the_manual_uses_is_read() {
        let text = "# Title\n\n![a picture](x.png)\n\nTwo lines\nof **one** `text`, [see](there.md).\n\n1. first\n   goes on\n- other\n\n\
            | a | b |\n|---|---|\n| 1 | *2* |\n\n```\nplumbline run\n```\n";
        let found = blocks(text);
        assert_eq!(found[0], Block::Heading(1, vec![plain("Title")]));
        let strong = Span { text: "one".to_owned(), look: Look::Strong };
        let code = Span { text: "text".to_owned(), look: Look::Code };
        let first = vec![plain("Two lines of "), strong, plain(" "), code, plain(", see.")];
        assert_eq!(found[1], Block::Paragraph(first));
        assert_eq!(found[2], Block::Item(0, "1.".to_owned(), vec![plain("first goes on")]));
        assert_eq!(found[3], Block::Item(0, "•".to_owned(), vec![plain("other")]));
        let Block::Table(rows) = &found[4] else { panic!("{found:?}") };
        assert_eq!((rows.len(), rows[1][1][0].look), (2, Look::Italic));
        assert_eq!(found[5], Block::Code("plumbline run".to_owned()));
        assert_eq!(found.len(), 6);
    }

    #[test]
    fn no_mark_is_left_in_any_page() {
        for (name, text) in super::super::pages::ALL {
            let found = blocks(text);
            assert!(found.len() > 1 && matches!(found[0], Block::Heading(1, _)), "{name}");
            for block in found {
                let spans: Vec<Span> = match block {
                    Block::Heading(_, spans) | Block::Paragraph(spans) | Block::Item(_, _, spans) => spans,
                    Block::Table(rows) => rows.into_iter().flatten().flatten().collect(),
                    Block::Code(_) => vec![],
                };
                for span in spans.iter().filter(|span| span.look != Look::Code) {
                    let left =
                        span.text.contains("**") || span.text.contains("](") || span.text.contains('`');
                    assert!(!left, "{name}: {:?}", span.text);
                }
            }
        }
    }
}
