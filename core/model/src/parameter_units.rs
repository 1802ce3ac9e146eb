//! Units in which people read the parameters of effects: the end of a parameter's name says its SI unit.

/// How a parameter is shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    /// Displayed per SI.
    pub per_si: f64,
    /// As it stands behind the number.
    pub name: &'static str,
}

/// A stiffness from which on nothing gives way that could be measured, N m/rad: the end of an interval whose compliance
/// may be zero.
pub const RIGID_NM_PER_RAD: f64 = 1e6;

const DEGREES: f64 = 180.0 / std::f64::consts::PI;
const PERCENT: Unit = Unit { per_si: 100.0, name: "%" };

/// Ends of names with how they are shown; the longest come first.
const ENDS: [(&str, f64, &str); 11] = [
    ("_rad_per_nm", DEGREES, "°/(N m)"),
    ("_nm_per_rad", 1.0, "N m/rad"),
    ("_m_per_n", 1e3, "mm/N"),
    // How far bowed glass is off at 100 mm from its middle.
    ("_per_m", 10.0, "mm at 100 mm"),
    ("_rad", DEGREES, "°"),
    ("_secs", 1.0, "s"),
    ("_kg", 1e3, "g"),
    ("_nm", 1.0, "N m"),
    ("_px", 1.0, "px"),
    ("_m", 1e3, "mm"),
    ("_s", 1.0, "s"),
];

/// Ends of names of shares and ratios.
const SHARES: [&str; 6] = ["scale", "scale_u", "scale_v", "ratio", "fraction", "weight"];

/// How the parameter of this name is shown; `None`: as a number without a unit.
pub fn of(name: &str) -> Option<Unit> {
    let of_end = ENDS.iter().find(|(end, ..)| name.ends_with(end));
    let of_end = of_end.map(|&(_, per_si, name)| Unit { per_si, name });
    of_end.or_else(|| SHARES.iter().any(|end| name.ends_with(end)).then_some(PERCENT))
}

/// Whether the interval of a parameter has no end there: a stiffness that may be that of something rigid.
pub fn is_endless(name: &str, end: f64) -> bool {
    name.ends_with("_nm_per_rad") && end.abs() >= RIGID_NM_PER_RAD
}

/// A number with its unit behind it: degrees stand at their number, all other units apart from it.
pub fn with_unit(number: &str, unit: Option<Unit>) -> String {
    match unit.map(|unit| unit.name) {
        None => number.to_owned(),
        Some(name) if name.starts_with('°') => format!("{number}{name}"),
        Some(name) => format!("{number} {name}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longest_end_of_the_name_says_the_unit() {
        let units = [
            ("offset_rad", "°"),
            ("r_elbow_y_offset_rad", "°"),
            ("compliance_rad_per_nm", "°/(N m)"),
            ("stiffness_nm_per_rad", "N m/rad"),
            ("compliance_m_per_n", "mm/N"),
            ("bow_u_per_m", "mm at 100 mm"),
            ("torque_nm", "N m"),
            ("length_m", "mm"),
            ("scale", "%"),
            ("r_elbow_y_scale", "%"),
            ("scale_u", "%"),
            ("k_px", "px"),
            ("early_secs", "s"),
        ];
        for (name, unit) in units {
            assert_eq!(of(name).map(|unit| unit.name), Some(unit), "{name}");
        }
        assert_eq!(of("order"), None);
    }

    #[test]
    fn only_a_stiffness_has_no_end() {
        assert!(is_endless("stiffness_nm_per_rad", 1e6) && !is_endless("stiffness_nm_per_rad", 900.0));
        assert!(!is_endless("offset_rad", 1e7));
    }

    #[test]
    fn degrees_stand_at_their_number() {
        assert_eq!(with_unit("1.8", of("offset_rad")), "1.8°");
        assert_eq!(with_unit("−1.5", of("length_m")), "−1.5 mm");
        assert_eq!(with_unit("2", of("order")), "2");
    }
}
