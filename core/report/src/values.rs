//! Numbers as people read them: millimeters, degrees, grams, with the digits that the interval
//! leaves.

use plumbline_gap::finding::FoundParameter;
use plumbline_gap::{number, parameter_units, parameter_words};

/// A unit that is printed, and how much of it an SI unit is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Printed {
    pub unit: &'static str,
    pub per_si: f64,
}

const DEGREES: f64 = 180.0 / std::f64::consts::PI;

/// A parameter with its interval, `offset 1.78 ± 0.17°`; the name only where there are several.
pub fn with_interval(found: &FoundParameter, named: bool) -> String {
    let unit = parameter_units::of(&found.name);
    let as_it_is = [found.value, found.low, found.high];
    // Without its word a size keeps its sign.
    let (name, sizes) = match named {
        true => parameter_words::directed(&found.name, as_it_is),
        false => (parameter_words::said(&found.name), as_it_is),
    };
    let label = if named { format!("{name} ") } else { String::new() };
    if let Some(text) = &found.text {
        return format!("{name} {}", parameter_words::place(text));
    }
    let per_si = unit.map_or(1.0, |unit| unit.per_si);
    let [value, low, high] = sizes.map(|value| value * per_si);
    let with_unit = |number: String| parameter_units::with_unit(&number, unit);
    if !(low.is_finite() && high.is_finite()) {
        return format!("{label}{} (interval not known)", with_unit(significant(value, 3)));
    }
    if parameter_units::is_endless(&found.name, found.high) {
        return format!("{label}{} ({} or more)", with_unit(significant(value, 3)), significant(low, 2));
    }
    let half = 0.5 * (high - low);
    let digits = number::decimals(half);
    let is_even = (0.5 * (high + low) - value).abs() <= 0.2 * half;
    if is_even {
        return format!(
            "{label}{}",
            with_unit(format!("{} ± {}", fixed(value, digits), fixed(half, digits)))
        );
    }
    format!("{label}{} ({} to {})", with_unit(fixed(value, digits)), fixed(low, digits), fixed(high, digits))
}

/// With so many decimals, and a minus sign as wide as a plus.
pub fn fixed(value: f64, decimals: usize) -> String {
    number::fixed(value, decimals).unwrap_or_else(|| "not known".to_owned())
}

/// With so many significant digits.
pub fn significant(value: f64, digits: i32) -> String {
    if !value.is_finite() {
        return "not known".to_owned();
    }
    if value == 0.0 {
        return "0".to_owned();
    }
    let decimals = (digits - 1 - value.abs().log10().floor() as i32).clamp(0, 6);
    fixed(value, decimals as usize)
}

/// A probability in percent. Never 100 % nor 0 %: no data says so.
pub fn percent(probability: f64) -> String {
    match probability * 100.0 {
        value if !value.is_finite() => "not known".to_owned(),
        value if value > 99.0 => "> 99 %".to_owned(),
        value if value < 1.0 => "< 1 %".to_owned(),
        value => format!("{value:.0} %"),
    }
}

/// Share of something that can be all of it, or more.
pub fn share(share: f64) -> String {
    if share.is_finite() { format!("{} %", fixed(100.0 * share, 0)) } else { "not known".to_owned() }
}

/// A probability of noise alone.
pub fn p_value(p: f64) -> String {
    match p {
        p if !p.is_finite() => "p not known".to_owned(),
        p if p < 0.001 => "p < 0.001".to_owned(),
        p if p < 0.1 => format!("p = {p:.3}"),
        p => format!("p = {p:.2}"),
    }
}

/// A covariate's unit as printed, from its SI unit.
pub fn covariate(unit: &str) -> Printed {
    match unit {
        "rad" => Printed { unit: "°", per_si: DEGREES },
        "m" => Printed { unit: "mm", per_si: 1e3 },
        "kg" => Printed { unit: "g", per_si: 1e3 },
        "s" => Printed { unit: "min", per_si: 1.0 / 60.0 },
        "px" => Printed { unit: "px", per_si: 1.0 },
        "N m" | "Nm" | "nm" => Printed { unit: "N m", per_si: 1.0 },
        "°C" | "c" | "C" => Printed { unit: "°C", per_si: 1.0 },
        "N" => Printed { unit: "N", per_si: 1.0 },
        "rad/s" => Printed { unit: "°/s", per_si: DEGREES },
        "m/s" => Printed { unit: "mm/s", per_si: 1e3 },
        _ => Printed { unit: "", per_si: 1.0 },
    }
}

/// Evenly spaced round numbers inside of a range, `about` of them or up to twice as many.
pub fn ticks(low: f64, high: f64, about: usize) -> Vec<f64> {
    let span = high - low;
    if !(span.is_finite() && span > 0.0) || about == 0 {
        return vec![];
    }
    let step = round_down(span / about as f64);
    let first = (low / step - 1e-9).ceil();
    // At the end of what numbers can be, nothing is larger than the end.
    let ticks = (0..=3 * about).map(|i| (first + i as f64) * step);
    ticks.take_while(|tick| tick.is_finite() && *tick <= high + 1e-9 * span).collect()
}

/// The next of 1, 2, 5, 10, 20, … down.
pub fn round_down(value: f64) -> f64 {
    let power = 10f64.powf(value.log10().floor());
    [5.0, 2.0, 1.0].into_iter().map(|m| m * power).find(|v| *v <= value * (1.0 + 1e-9)).unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(name: &str, value: f64, low: f64, high: f64) -> FoundParameter {
        FoundParameter { name: name.to_owned(), value, low, high, text: None }
    }

    #[test]
    fn parameters_are_printed_with_the_digits_that_their_interval_leaves() {
        let offset = found("offset_rad", 0.031, 0.028, 0.034);
        assert_eq!(with_interval(&offset, false), "1.78 ± 0.17°");
        assert_eq!(
            with_interval(&found("x_m", -0.0042, -0.0047, -0.0037), true),
            "shifted along its x axis by −4.20 ± 0.50 mm"
        );
        assert_eq!(
            with_interval(&found("rot_x_rad", 0.01, 0.0, 0.03), true),
            "turned about its x axis by 0.57° (0.00 to 1.72)"
        );
        let sag = found("compliance_rad_per_nm", 0.02, 0.018, 0.022);
        assert_eq!(with_interval(&sag, false), "1.15 ± 0.11°/(N m)");
        assert_eq!(with_interval(&found("mass_kg", 0.118, 0.106, 0.13), false), "118 ± 12 g");
        assert_eq!(with_interval(&found("scale_u", 0.012, 0.010, 0.014), true), "wider by 1.20 ± 0.20 %");
        let stiff = found("stiffness_nm_per_rad", 12.0, 6.2, 1e6);
        assert_eq!(with_interval(&stiff, false), "12.0 N m/rad (6.2 or more)");
        assert!(with_interval(&found("odd", f64::NAN, f64::NAN, 1.0), false).contains("not known"));
    }

    #[test]
    fn ticks_are_round_and_inside() {
        assert_eq!(ticks(-0.4, 2.1, 4), [0.0, 0.5, 1.0, 1.5, 2.0]);
        assert_eq!(ticks(0.0, 0.0, 5), Vec::<f64>::new());
        assert_eq!(ticks(f64::NAN, 1.0, 5), Vec::<f64>::new());
        for (low, high) in [(0.0, f64::MAX), (f64::MIN / 2.0, f64::MAX / 4.0), (1e300, 1e300 * (1.0 + 1e-15))]
        {
            let found = ticks(low, high, 4);
            assert!(
                found.len() <= 13 && found.iter().all(|tick| tick.is_finite()),
                "{low} {high}: {found:?}"
            );
        }
    }

    #[test]
    fn nothing_is_certain() {
        assert_eq!(percent(1.0), "> 99 %");
        assert_eq!(percent(0.0), "< 1 %");
        assert_eq!(percent(0.873), "87 %");
    }
}
