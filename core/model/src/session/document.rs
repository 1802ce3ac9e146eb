//! TOML whose values remember their line.

use std::path::Path;

use toml::de::{DeTable, DeValue};

use crate::formats::node::{Node, Value};
use crate::formats::{FormatError, Place, depth};

/// The error for text that is no TOML.
pub(super) fn syntax(file: &Path, text: &str, error: &toml::de::Error) -> FormatError {
    let line = error.span().map(|span| line_of(text, span.start));
    FormatError::Syntax {
        place: Place { file: file.to_path_buf(), line, key: String::new() },
        language: "TOML",
        reason: error.message().to_owned(),
    }
}

fn line_of(text: &str, offset: usize) -> usize {
    1 + text.bytes().take(offset).filter(|&byte| byte == b'\n').count()
}

/// Parses the document.
pub(super) fn parse(file: &Path, text: &str) -> Result<Node, FormatError> {
    fn table(text: &str, entries: &DeTable<'_>) -> Value {
        Value::Map(
            entries
                .iter()
                .map(|(key, value)| {
                    let line = line_of(text, key.span().start);
                    (key.get_ref().to_string(), node(text, line, value.get_ref()))
                })
                .collect(),
        )
    }
    fn node(text: &str, line: usize, value: &DeValue<'_>) -> Node {
        let value = match value {
            DeValue::String(content) => Value::Text(content.to_string()),
            DeValue::Integer(integer) => i64::from_str_radix(integer.as_str(), integer.radix())
                .map_or_else(|_| Value::Text(integer.to_string()), Value::Integer),
            DeValue::Float(float) => {
                float.as_str().parse().map_or_else(|_| Value::Text(float.to_string()), Value::Number)
            }
            DeValue::Boolean(flag) => Value::Flag(*flag),
            DeValue::Datetime(datetime) => Value::Text(datetime.to_string()),
            DeValue::Array(items) => Value::List(
                items
                    .iter()
                    .map(|item| node(text, line_of(text, item.span().start), item.get_ref()))
                    .collect(),
            ),
            DeValue::Table(entries) => table(text, entries),
        };
        Node { line, value }
    }
    depth::check(depth::of_toml(text)).map_err(|reason| FormatError::Syntax {
        place: Place { file: file.to_path_buf(), line: None, key: String::new() },
        language: "TOML",
        reason,
    })?;
    let document = DeTable::parse(text).map_err(|error| syntax(file, text, &error))?;
    Ok(Node { line: 1, value: table(text, document.get_ref()) })
}
