//! How cases are told apart in files and tables.

use serde::Serialize;

use crate::mix::SIZES;

/// The word of a family or a plan, as in files.
pub fn word(value: impl Serialize) -> String {
    serde_json::to_value(value).ok().and_then(|value| value.as_str().map(str::to_owned)).unwrap_or_default()
}

/// The wanted size that a measured one stands for.
pub fn nearest_size(sigmas: f64) -> String {
    let off = |size: &f64| (size / sigmas.max(1e-9)).ln().abs();
    SIZES
        .iter()
        .min_by(|a, b| off(a).total_cmp(&off(b)))
        .map_or_else(String::new, |size| format!("{size:4.1}"))
}
