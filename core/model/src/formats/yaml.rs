//! YAML in and out: a reader that remembers lines, and a writer of numbers that every YAML
//! parser takes for numbers, digit for digit.

use std::fmt;
use std::path::Path;

use serde::de::{Deserialize, Deserializer, MapAccess, SeqAccess, Visitor};
use serde_saphyr::{NonFiniteFloatPolicy, Spanned};

use super::error::{FormatError, Place};
use super::node::{Node, Value};

/// Parses one YAML document.
pub(crate) fn parse(file: &Path, text: &str) -> Result<Node, FormatError> {
    super::depth::check(super::depth::of_yaml(text)).map_err(|reason| FormatError::Syntax {
        place: Place { file: file.to_path_buf(), line: None, key: String::new() },
        language: "YAML",
        reason,
    })?;
    let options = serde_saphyr::options! {
        // Room for thousands of pairs; the defaults stop at a few hundred.
        budget: serde_saphyr::budget! {
            max_events: 50_000_000,
            max_nodes: 50_000_000,
        },
        strict_booleans: true,
        non_finite_float_policy: NonFiniteFloatPolicy::PassThrough,
        with_snippet: false,
    };
    serde_saphyr::from_str_with_options(text, options).map_err(|error| FormatError::Syntax {
        place: Place {
            file: file.to_path_buf(),
            line: error.location().map(|at| at.line() as usize).filter(|&line| line > 0),
            key: String::new(),
        },
        language: "YAML",
        reason: error.to_string(),
    })
}

impl<'de> Deserialize<'de> for Node {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let spanned = Spanned::<Value>::deserialize(deserializer)?;
        Ok(Self { line: spanned.referenced.line() as usize, value: spanned.value })
    }
}

impl<'de> Deserialize<'de> for Value {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(ValueVisitor)
    }
}

struct ValueVisitor;

impl<'de> Visitor<'de> for ValueVisitor {
    type Value = Value;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a value")
    }
    fn visit_unit<E>(self) -> Result<Value, E> {
        Ok(Value::Null)
    }
    fn visit_none<E>(self) -> Result<Value, E> {
        Ok(Value::Null)
    }
    fn visit_some<D: Deserializer<'de>>(self, deserializer: D) -> Result<Value, D::Error> {
        deserializer.deserialize_any(self)
    }
    fn visit_bool<E>(self, value: bool) -> Result<Value, E> {
        Ok(Value::Flag(value))
    }
    fn visit_i64<E>(self, value: i64) -> Result<Value, E> {
        Ok(Value::Integer(value))
    }
    fn visit_u64<E>(self, value: u64) -> Result<Value, E> {
        Ok(i64::try_from(value).map_or(Value::Number(value as f64), Value::Integer))
    }
    fn visit_f64<E>(self, value: f64) -> Result<Value, E> {
        Ok(Value::Number(value))
    }
    fn visit_str<E>(self, value: &str) -> Result<Value, E> {
        Ok(Value::Text(value.to_owned()))
    }
    fn visit_seq<A: SeqAccess<'de>>(self, mut sequence: A) -> Result<Value, A::Error> {
        let mut items = Vec::new();
        while let Some(item) = sequence.next_element::<Node>()? {
            items.push(item);
        }
        Ok(Value::List(items))
    }
    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Value, A::Error> {
        let mut entries = Vec::new();
        while let Some(entry) = map.next_entry::<String, Node>()? {
            entries.push(entry);
        }
        Ok(Value::Map(entries))
    }
}

/// A number with the fewest digits that give it back bit for bit. Always with a decimal point,
/// and a sign in the exponent: YAML 1.1 parsers, Python's among them, take `1e-7` for a text.
pub(crate) fn number(value: f64) -> String {
    let text = format!("{value:?}");
    match text.split_once('e') {
        None => text,
        Some((mantissa, exponent)) => {
            let point = if mantissa.contains('.') { "" } else { ".0" };
            let sign = if exponent.starts_with('-') { "" } else { "+" };
            format!("{mantissa}{point}e{sign}{exponent}")
        }
    }
}

/// Numbers as a flow list: `[1.0, 2.5]`.
pub(crate) fn numbers<'a>(values: impl IntoIterator<Item = &'a f64>) -> String {
    let all: Vec<String> = values.into_iter().map(|&value| number(value)).collect();
    format!("[{}]", all.join(", "))
}

/// A text in double quotes.
pub(crate) fn quoted(text: &str) -> String {
    let mut out = String::from("\"");
    for character in text.chars() {
        match character {
            '"' => out.push_str("\\\""),
            '\\' => out.push_str("\\\\"),
            '\n' => out.push_str("\\n"),
            '\t' => out.push_str("\\t"),
            '\r' => out.push_str("\\r"),
            // Not allowed, or taken for a line break, inside a YAML string.
            c if c.is_control() || matches!(c, '\u{2028}' | '\u{2029}' | '\u{feff}') => {
                out.push_str(&format!("\\u{:04x}", c as u32));
            }
            c => out.push(c),
        }
    }
    out.push('"');
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::node::Field;

    #[test]
    fn numbers_come_back_bit_for_bit() {
        let values = [
            0.1,
            -0.0,
            1e-7,
            -1.234_567_890_123_456_7e-300,
            1e300,
            f64::MIN_POSITIVE,
            5e-324,
            std::f64::consts::PI,
            1.0 / 3.0,
            123.0,
            1e16,
        ];
        let file = Path::new("numbers.yaml");
        let node = parse(file, &numbers(&values)).expect("valid YAML");
        let back = Field::root(file, &node).numbers().expect("numbers");
        assert_eq!(back.len(), values.len());
        for (a, b) in values.iter().zip(&back) {
            assert_eq!(a.to_bits(), b.to_bits(), "{a} came back as {b}");
        }
    }

    #[test]
    fn exponents_are_numbers_in_every_dialect() {
        assert_eq!(number(1e-7), "1.0e-7");
        assert_eq!(number(1e300), "1.0e+300");
        assert_eq!(number(2.5e-9), "2.5e-9");
        assert_eq!(number(3.0), "3.0");
    }

    #[test]
    fn any_text_comes_back() {
        let file = Path::new("text.yaml");
        for text in [
            "",
            "plain",
            "a: b # c",
            "\"quoted\" \\ back",
            "two\nlines\tand\r\n",
            "Košice ½ 目",
            "~",
            "\u{7}\u{85}\u{2028}",
        ] {
            let node = parse(file, &quoted(text)).expect("valid YAML");
            assert_eq!(Field::root(file, &node).text().expect("a text"), text);
        }
    }

    #[test]
    fn lines_are_those_of_the_file() {
        let file = Path::new("lines.yaml");
        let node = parse(file, "# comment\na: 1\nb:\n  - 2\n  - x\n").expect("valid YAML");
        let root = Field::root(file, &node);
        let error = root.get("b").expect("there").numbers().expect_err("x is no number");
        assert_eq!(
            error.to_string(),
            "lines.yaml, line 5, key \"b[1]\" should be a number, but is the text \"x\": correct it or write the file again"
        );
    }

    #[test]
    fn non_finite_numbers_are_named() {
        let file = Path::new("nan.yaml");
        for bad in [".nan", "nan", "-.inf", "inf", "1e999"] {
            let text = format!("f: {bad}\n");
            let node = parse(file, &text).expect("valid YAML");
            let error = Field::root(file, &node).get("f").expect("there").number().expect_err(bad);
            assert!(matches!(error, FormatError::NotFinite { .. }), "{bad}: {error}");
        }
    }
}
