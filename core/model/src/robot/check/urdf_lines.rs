//! Where in the text of a URDF something stands.

/// The text with its comments blanked, so that nothing is found in them.
pub(super) struct UrdfLines {
    text: String,
}

/// A tag with all that is in it, bytes of the text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Block {
    begin: usize,
    end: usize,
}

impl UrdfLines {
    pub fn new(text: &str) -> Self {
        let mut blanked = String::with_capacity(text.len());
        let mut rest = text;
        while let Some(begin) = rest.find("<!--") {
            let end = rest[begin..].find("-->").map_or(rest.len(), |length| begin + length + "-->".len());
            blanked.push_str(&rest[..begin]);
            // As many bytes, the same lines.
            blanked.extend(rest[begin..end].bytes().map(|byte| if byte == b'\n' { '\n' } else { ' ' }));
            rest = &rest[end..];
        }
        blanked.push_str(rest);
        Self { text: blanked }
    }

    /// Line of a block, from 1.
    pub fn line(&self, block: Block) -> usize {
        super::line_of(&self.text, block.begin)
    }

    /// All links or joints of a name, in order.
    pub fn named(&self, tag: &str, name: &str) -> Vec<Block> {
        let (open, close) = (format!("<{tag}"), format!("</{tag}>"));
        let mut found = vec![];
        let mut from = 0;
        while let Some(begin) = self.text[from..].find(&open).map(|at| from + at) {
            from = begin + open.len();
            let Some(head) = self.text[begin..].find('>').map(|length| begin + length) else { break };
            let empty = self.text[..head].ends_with('/');
            let whole = self.text[head..].find(&close).map(|length| head + length);
            let end = if empty { head } else { whole.unwrap_or(head) };
            let block = Block { begin, end };
            // Transmissions name joints, too, without saying what they connect.
            let is_mention = tag == "joint" && self.part(block, "parent").is_none();
            let is_tag = self.text[from..].starts_with(char::is_whitespace);
            if is_tag && !is_mention && attribute(&self.text[begin..head], "name") == Some(name) {
                found.push(block);
            }
        }
        found
    }

    /// The first tag of a kind inside of a block.
    pub fn part(&self, block: Block, tag: &str) -> Option<Block> {
        let inside = &self.text[block.begin..block.end];
        let open = format!("<{tag}");
        let mut from = 1;
        while let Some(at) = inside.get(from..)?.find(&open).map(|at| from + at) {
            from = at + open.len();
            let ends = inside[from..].starts_with(|next: char| next.is_whitespace() || "/>".contains(next));
            if ends {
                let end = inside[at..].find('>').map_or(inside.len(), |length| at + length);
                return Some(Block { begin: block.begin + at, end: block.begin + end });
            }
        }
        None
    }

    /// Line of a part of a link or joint, of the whole where it has no such part; the `occurrence`th of that
    /// name, from 0.
    pub fn of(&self, tag: &str, name: &str, occurrence: usize, part: Option<&str>) -> Option<usize> {
        let block = *self.named(tag, name).get(occurrence)?;
        let inner = part.and_then(|part| self.part(block, part));
        Some(self.line(inner.unwrap_or(block)))
    }
}

/// Value of an attribute in the head of a tag.
fn attribute<'a>(head: &'a str, key: &str) -> Option<&'a str> {
    let mut rest = head;
    while let Some(at) = rest.find(key) {
        let before = rest[..at].chars().next_back();
        rest = &rest[at + key.len()..];
        let Some(value) = rest.trim_start().strip_prefix('=') else { continue };
        let value = value.trim_start();
        let quote = value.chars().next().filter(|quote| matches!(quote, '"' | '\''))?;
        if before.is_some_and(char::is_whitespace) {
            return value[1..].split(quote).next();
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "<robot name='r'>\n<!-- <joint name=\"a\">\n</joint> -->\n<transmission>\n\
                        <joint name=\"a\"/></transmission>\n<joint type=\"fixed\"\n name='a'>\n\
                        <parent link=\"b\"/>\n<limit lower=\"1\"/></joint>\n<link name=\"a\"/>\n</robot>";

    #[test]
    fn joints_are_found_where_they_connect_something() {
        let lines = UrdfLines::new(TEXT);
        assert_eq!(lines.of("joint", "a", 0, None), Some(6));
        assert_eq!(lines.of("joint", "a", 0, Some("limit")), Some(9));
        assert_eq!(lines.of("joint", "a", 0, Some("axis")), Some(6), "where it would be");
        assert_eq!(lines.of("joint", "a", 1, None), None);
        assert_eq!(lines.of("link", "a", 0, None), Some(10));
        assert_eq!(lines.of("joint", "b", 0, None), None);
    }
}
