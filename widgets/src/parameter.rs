//! Parameters of effects in units that people use: the end of a parameter's name says its SI unit.

use plumbline_model::{number, parameter_units, parameter_words};

use crate::format::{fixed, significant};

/// The value with its unit: `1.78°`.
pub fn value(name: &str, si: f64) -> String {
    let unit = parameter_units::of(name);
    parameter_units::with_unit(&significant(si * unit.map_or(1.0, |unit| unit.per_si), 3), unit)
}

/// The ends of an interval: `1.60 to 1.95°`, with as many digits as its width supports.
pub fn interval(name: &str, low: f64, high: f64) -> String {
    let unit = parameter_units::of(name);
    let per_si = unit.map_or(1.0, |unit| unit.per_si);
    if parameter_units::is_endless(name, high) && !parameter_units::is_endless(name, low) {
        let low = low * per_si;
        let number = fixed(low, number::decimals(low.abs()));
        return format!("{} or more", parameter_units::with_unit(&number, unit));
    }
    let (low, high) = (low * per_si, high * per_si);
    let decimals = number::decimals((high - low).abs());
    parameter_units::with_unit(&format!("{} to {}", fixed(low, decimals), fixed(high, decimals)), unit)
}

/// What is said before its value, in words, from its name: "off by", "turned about its x axis by".
pub fn words(name: &str) -> String {
    parameter_words::said(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_interval_of_a_stiffness_that_may_be_rigid_has_one_end() {
        assert_eq!(interval("stiffness_nm_per_rad", 6.2, 1e6), "6.2 N m/rad or more");
        assert_eq!(interval("stiffness_nm_per_rad", 6.2, 61.0), "6 to 61 N m/rad");
    }

    #[test]
    fn the_end_of_the_name_says_the_unit() {
        assert_eq!(value("offset_rad", 0.031), "1.78°");
        assert_eq!(value("length_m", -0.0042), "−4.20 mm");
        assert_eq!(value("compliance_rad_per_nm", 0.0175), "1.00°/(N m)");
        assert_eq!(value("stiffness_nm_per_rad", 57.2958), "57.3 N m/rad");
        assert_eq!(value("scale", 0.012), "1.20 %");
        assert_eq!(value("mass_kg", 0.25), "250 g");
        assert_eq!(value("k_px", 1.5), "1.50 px");
        assert_eq!(value("time_constant_s", 600.0), "600 s");
        assert_eq!(value("order", 2.0), "2.00");
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
