//! A parsed text file whose values remember their line, so that every error can name it.

use std::path::Path;

use super::error::{FormatError, Place};
use crate::plausible::Quantity;

/// One value of a document.
#[derive(Clone, Debug)]
pub(crate) struct Node {
    /// Line in the file, counted from 1.
    pub line: usize,
    /// The value itself.
    pub value: Value,
}

/// What a value can be.
#[derive(Clone, Debug)]
pub(crate) enum Value {
    Null,
    Flag(bool),
    Integer(i64),
    Number(f64),
    Text(String),
    List(Vec<Node>),
    Map(Vec<(String, Node)>),
}

impl Value {
    fn describe(&self) -> String {
        match self {
            Self::Null => "empty".to_owned(),
            Self::Flag(value) => value.to_string(),
            Self::Integer(value) => value.to_string(),
            // The usual form of 1e308 has 309 digits.
            Self::Number(value) => format!("{value:?}"),
            Self::Text(text) => format!("the text \"{}\"", crate::files::shortened(text)),
            Self::List(items) => format!("a list of {}", items.len()),
            Self::Map(_) => "a group of keys".to_owned(),
        }
    }
}

/// A value together with its file and the path of keys that leads to it.
#[derive(Clone, Debug)]
pub(crate) struct Field<'a> {
    file: &'a Path,
    key: String,
    node: &'a Node,
}

impl<'a> Field<'a> {
    /// The whole document.
    pub fn root(file: &'a Path, node: &'a Node) -> Self {
        Self { file, key: String::new(), node }
    }

    /// Where this is.
    pub fn place(&self) -> Place {
        Place { file: self.file.to_path_buf(), line: Some(self.node.line), key: self.key.clone() }
    }

    fn path_of(&self, key: &str) -> String {
        if self.key.is_empty() { key.to_owned() } else { format!("{}.{key}", self.key) }
    }

    /// An error at this place: another type than `expected`.
    pub fn wrong_type(&self, expected: &str) -> FormatError {
        FormatError::WrongType {
            place: self.place(),
            expected: expected.to_owned(),
            found: self.node.value.describe(),
        }
    }

    /// An error at this place: a value that cannot be.
    pub fn out_of_range(&self, expected: impl Into<String>) -> FormatError {
        FormatError::OutOfRange {
            place: self.place(),
            expected: expected.into(),
            found: self.node.value.describe(),
        }
    }

    /// An error at this place: another number of elements.
    pub fn wrong_size(&self, expected: impl Into<String>, found: impl Into<String>) -> FormatError {
        FormatError::WrongSize { place: self.place(), expected: expected.into(), found: found.into() }
    }

    /// Refuses a number that cannot be what it is said to be. What is no number is left to others.
    pub fn of(self, quantity: Quantity) -> Result<Self, FormatError> {
        self.numbers_are(quantity, std::slice::from_ref(self.node))?;
        Ok(self)
    }

    /// The same for each number of a list.
    pub fn each_of(self, quantity: Quantity) -> Result<Self, FormatError> {
        if let Value::List(nodes) = &self.node.value {
            self.numbers_are(quantity, nodes)?;
        }
        Ok(self)
    }

    fn numbers_are(&self, quantity: Quantity, nodes: &[Node]) -> Result<(), FormatError> {
        for node in nodes {
            let value = match node.value {
                Value::Integer(value) => value as f64,
                // What is not finite has words of its own.
                Value::Number(value) if value.is_finite() => value,
                _ => continue,
            };
            quantity.check(value).map_err(|what| FormatError::Implausible {
                place: Place { line: Some(node.line), ..self.place() },
                what: Box::new(what),
            })?;
        }
        Ok(())
    }

    /// The keys of a group.
    pub fn entries(&self) -> Result<&'a [(String, Node)], FormatError> {
        match &self.node.value {
            Value::Map(entries) => Ok(entries),
            _ => Err(self.wrong_type("a group of keys")),
        }
    }

    /// The value of `key`; `None` when it is absent or empty.
    pub fn find(&self, key: &str) -> Result<Option<Field<'a>>, FormatError> {
        let entry = self.entries()?.iter().find(|(name, _)| name == key);
        Ok(entry.filter(|(_, node)| !matches!(node.value, Value::Null)).map(|(_, node)| Field {
            file: self.file,
            key: self.path_of(key),
            node,
        }))
    }

    /// The value of `key`, which must be there.
    pub fn get(&self, key: &str) -> Result<Field<'a>, FormatError> {
        self.find(key)?.ok_or_else(|| FormatError::Missing {
            place: Place { file: self.file.to_path_buf(), line: None, key: self.path_of(key) },
            or: Vec::new(),
        })
    }

    /// Whether the value is explicitly empty.
    pub fn is_null(&self) -> bool {
        matches!(self.node.value, Value::Null)
    }

    /// The elements of a list.
    pub fn items(&self) -> Result<impl ExactSizeIterator<Item = Field<'a>>, FormatError> {
        let Value::List(nodes) = &self.node.value else {
            return Err(self.wrong_type("a list"));
        };
        let (file, key) = (self.file, self.key.clone());
        Ok(nodes.iter().enumerate().map(move |(i, node)| Field { file, key: format!("{key}[{i}]"), node }))
    }

    /// A finite number; whole numbers count.
    pub fn number(&self) -> Result<f64, FormatError> {
        number_of(self.node).map_err(|problem| match problem {
            NumberProblem::NotANumber => self.wrong_type("a number"),
            NumberProblem::NotFinite => FormatError::NotFinite {
                place: self.place(),
                found: match &self.node.value {
                    Value::Text(text) => text.clone(),
                    other => other.describe(),
                },
            },
        })
    }

    /// A finite number greater than zero.
    pub fn positive(&self) -> Result<f64, FormatError> {
        let number = self.number()?;
        if number > 0.0 { Ok(number) } else { Err(self.out_of_range("greater than zero")) }
    }

    /// A whole number that is not negative.
    pub fn count(&self) -> Result<usize, FormatError> {
        match self.node.value {
            Value::Integer(value) => {
                usize::try_from(value).map_err(|_| self.out_of_range("a whole number, not negative"))
            }
            _ => Err(self.wrong_type("a whole number")),
        }
    }

    /// A number of pixels: whole, at least 1.
    pub fn pixels(&self) -> Result<u32, FormatError> {
        let count = self.count()?;
        u32::try_from(count)
            .ok()
            .filter(|&n| (1..=1_000_000).contains(&n))
            .ok_or_else(|| self.out_of_range("between 1 and a million pixels"))
    }

    /// A list of finite numbers.
    pub fn numbers(&self) -> Result<Vec<f64>, FormatError> {
        let Value::List(nodes) = &self.node.value else {
            return Err(self.wrong_type("a list of numbers"));
        };
        let all: Result<Vec<f64>, NumberProblem> = nodes.iter().map(number_of).collect();
        match all {
            Ok(numbers) => Ok(numbers),
            // The slow way, only to name the element.
            Err(_) => self.items()?.map(|item| item.number()).collect(),
        }
    }

    /// Exactly `N` finite numbers.
    pub fn exactly<const N: usize>(&self) -> Result<[f64; N], FormatError> {
        let numbers = self.numbers()?;
        let found = numbers.len();
        numbers.try_into().map_err(|_| self.wrong_size(format!("{N} numbers"), found.to_string()))
    }

    /// A text. A bare number is one too: names of cameras and files may be made of digits.
    pub fn text(&self) -> Result<String, FormatError> {
        match &self.node.value {
            Value::Text(text) => Ok(text.clone()),
            Value::Integer(value) => Ok(value.to_string()),
            _ => Err(self.wrong_type("a text")),
        }
    }

    /// True or false.
    pub fn flag(&self) -> Result<bool, FormatError> {
        match self.node.value {
            Value::Flag(value) => Ok(value),
            _ => Err(self.wrong_type("true or false")),
        }
    }

    /// A moment in UTC or with an offset.
    pub fn timestamp(&self) -> Result<jiff::Timestamp, FormatError> {
        self.text()?
            .parse()
            .map_err(|_| self.wrong_type("a date and time with its offset, for example 2026-11-21T10:04:00Z"))
    }
}

enum NumberProblem {
    NotANumber,
    NotFinite,
}

fn number_of(node: &Node) -> Result<f64, NumberProblem> {
    match &node.value {
        Value::Number(value) if value.is_finite() => Ok(*value),
        Value::Number(_) => Err(NumberProblem::NotFinite),
        Value::Integer(value) => Ok(*value as f64),
        // Python prints a bare nan or inf, which YAML takes for a text.
        Value::Text(text) if text.parse::<f64>().is_ok_and(|value| !value.is_finite()) => {
            Err(NumberProblem::NotFinite)
        }
        _ => Err(NumberProblem::NotANumber),
    }
}
