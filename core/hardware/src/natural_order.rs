//! Order of file names as a person sorts them: `frame_2` before `frame_10`.

use std::cmp::Ordering;

/// Compares names so that runs of digits count as numbers of any length. Names that differ
/// only in leading zeros are ordered by their text, so the order is total.
pub fn natural_order(a: &str, b: &str) -> Ordering {
    let (mut rest_a, mut rest_b) = (a, b);
    while !rest_a.is_empty() && !rest_b.is_empty() {
        let (run_a, after_a) = split_run(rest_a);
        let (run_b, after_b) = split_run(rest_b);
        let order = if starts_with_digit(run_a) && starts_with_digit(run_b) {
            compare_numbers(run_a, run_b)
        } else {
            run_a.cmp(run_b)
        };
        if order != Ordering::Equal {
            return order;
        }
        (rest_a, rest_b) = (after_a, after_b);
    }
    rest_a.len().cmp(&rest_b.len()).then_with(|| a.cmp(b))
}

fn starts_with_digit(text: &str) -> bool {
    text.as_bytes().first().is_some_and(u8::is_ascii_digit)
}

/// Splits off the leading run of digits, or of anything but digits.
fn split_run(text: &str) -> (&str, &str) {
    let digits = starts_with_digit(text);
    let end = text.find(|c: char| c.is_ascii_digit() != digits).unwrap_or(text.len());
    text.split_at(end)
}

/// Without a number type, so that time stamps of any length compare.
fn compare_numbers(a: &str, b: &str) -> Ordering {
    let (a, b) = (a.trim_start_matches('0'), b.trim_start_matches('0'));
    a.len().cmp(&b.len()).then_with(|| a.cmp(b))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sorted(names: &[&'static str]) -> Vec<&'static str> {
        let mut names = names.to_vec();
        names.sort_by(|a, b| natural_order(a, b));
        names
    }

    #[test]
    fn numbers_count_as_numbers() {
        assert_eq!(sorted(&["f10", "f9", "f1", "f100", "f2"]), ["f1", "f2", "f9", "f10", "f100"]);
        assert_eq!(sorted(&["left_2_b", "left_2_a", "left_1_z"]), ["left_1_z", "left_2_a", "left_2_b"]);
    }

    #[test]
    fn numbers_of_any_length_compare() {
        let (small, large) = ("t99999999999999999999999998.5", "t99999999999999999999999999.1");
        assert_eq!(natural_order(small, large), Ordering::Less);
    }

    #[test]
    fn the_order_is_total() {
        let names = ["", "1", "01", "001", "a", "a1", "a01", "a1b", "1a", "ä2", "ä10", "é"];
        for a in names {
            for b in names {
                assert_eq!(natural_order(a, b), natural_order(b, a).reverse(), "{a} {b}");
                assert_eq!(natural_order(a, b) == Ordering::Equal, a == b, "{a} {b}");
                for c in names {
                    if natural_order(a, b).is_lt() && natural_order(b, c).is_lt() {
                        assert!(natural_order(a, c).is_lt(), "{a} < {b} < {c}");
                    }
                }
            }
        }
    }
}
