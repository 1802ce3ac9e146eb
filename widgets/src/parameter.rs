//! Parameters of effects in units that people use: the end of a parameter's name says its SI unit.

use plumbline_model::parameter_words;

use crate::format::{fixed, significant};

/// How a parameter is shown.
struct Shown {
    /// Displayed per SI.
    factor: f64,
    unit: &'static str,
}

/// The longest end that fits decides.
const ENDS: [(&str, f64, &str); 13] = [
    ("compliance_rad_per_nm", DEGREES, "°/(N m)"),
    ("stiffness_nm_per_rad", 1.0 / DEGREES, "N m/°"),
    ("compliance_m_per_n", 1e3, "mm/N"),
    ("lean_rad_per_nm", DEGREES, "°/(N m)"),
    ("_per_m", 1e-2, "% per cm"),
    ("_rad", DEGREES, "°"),
    ("_nm", 1.0, "N m"),
    ("_kg", 1e3, "g"),
    ("_px", 1.0, "px"),
    ("_m", 1e3, "mm"),
    ("_secs", 1.0, "s"),
    ("_s", 1.0, "s"),
    ("k_px", 1.0, "px"),
];
const DEGREES: f64 = 180.0 / std::f64::consts::PI;

fn shown(name: &str) -> Shown {
    let of_end = ENDS.iter().find(|(end, _, _)| name.ends_with(end));
    match of_end {
        Some(&(_, factor, unit)) => Shown { factor, unit },
        // Shares and ratios.
        None if matches!(name, "order") => Shown { factor: 1.0, unit: "per turn" },
        None => Shown { factor: 1e2, unit: "%" },
    }
}

/// The value with its unit: `1.78°`.
pub fn value(name: &str, si: f64) -> String {
    let Shown { factor, unit } = shown(name);
    with_unit(&significant(si * factor, 3), unit)
}

/// The ends of an interval: `1.60 to 1.95°`, with as many digits as its width supports.
pub fn interval(name: &str, low: f64, high: f64) -> String {
    let Shown { factor, unit } = shown(name);
    let (low, high) = (low * factor, high * factor);
    let width = (high - low).abs();
    let decimals = if width > 0.0 && width.is_finite() {
        (1.0 - width.log10().floor()).clamp(0.0, 4.0) as usize
    } else {
        2
    };
    with_unit(&format!("{} to {}", fixed(low, decimals), fixed(high, decimals)), unit)
}

/// What is said before its value, in words, from its name: "off by", "turned about its x axis by".
pub fn words(name: &str) -> String {
    parameter_words::said(name)
}

fn with_unit(number: &str, unit: &str) -> String {
    if unit.starts_with('°') { format!("{number}{unit}") } else { format!("{number} {unit}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_end_of_the_name_says_the_unit() {
        assert_eq!(value("offset_rad", 0.031), "1.78°");
        assert_eq!(value("length_m", -0.0042), "−4.20 mm");
        assert_eq!(value("compliance_rad_per_nm", 0.0175), "1.00°/(N m)");
        assert_eq!(value("stiffness_nm_per_rad", 57.2958), "1.00 N m/°");
        assert_eq!(value("scale", 0.012), "1.20 %");
        assert_eq!(value("mass_kg", 0.25), "250 g");
        assert_eq!(value("k_px", 1.5), "1.50 px");
        assert_eq!(value("time_constant_s", 600.0), "600 s");
    }

    #[test]
    fn an_interval_has_the_digits_that_its_width_supports() {
        assert_eq!(interval("offset_rad", 0.028, 0.034), "1.60 to 1.95°");
        assert_eq!(interval("length_m", -0.001, 0.012), "−1 to 12 mm");
    }

    #[test]
    fn words_have_no_unit() {
        assert_eq!(words("offset_rad"), "off by");
        assert_eq!(words("rot_x_rad"), "turned about its x axis by");
        assert_eq!(words("scale_u"), "wider by");
    }
}
