//! Numbers as people read them, the same in sentences, in the window and on pages.

/// A number with so many decimals, with a real minus sign (−1.5, never -1.5) and without a sign where it rounds to
/// zero; `None` where it is no number.
pub fn fixed(value: f64, decimals: usize) -> Option<String> {
    if !value.is_finite() {
        return None;
    }
    let text = format!("{value:.decimals$}");
    Some(match text.strip_prefix('-') {
        Some(rest) if rest.chars().all(|c| matches!(c, '0' | '.')) => rest.to_owned(),
        Some(rest) => format!("−{rest}"),
        None => text,
    })
}

/// Decimals that show two digits of an uncertainty or of the width of an interval.
pub fn decimals(width: f64) -> usize {
    if !(width > 0.0 && width.is_finite()) {
        return 2;
    }
    (1.0 - width.log10().floor()).clamp(0.0, 4.0) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn minus_is_a_minus_sign_and_zero_has_none() {
        let said = [(-1.5, 1, "−1.5"), (1.5, 1, "1.5"), (-0.04, 1, "0.0"), (-0.4, 0, "0"), (-7.0, 0, "−7")];
        for (value, decimals, text) in said {
            assert_eq!(fixed(value, decimals).as_deref(), Some(text));
        }
    }

    #[test]
    fn what_is_no_number_is_none() {
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert_eq!(fixed(value, 1), None);
        }
    }

    #[test]
    fn an_uncertainty_is_shown_with_two_digits() {
        let shown = [(23.0, 0), (2.3, 1), (0.23, 2), (1e-9, 4), (0.0, 2), (f64::NAN, 2), (f64::INFINITY, 2)];
        for (width, count) in shown {
            assert_eq!(decimals(width), count, "{width}");
        }
    }
}
