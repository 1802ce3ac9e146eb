//! Quantities as text. The same quantity is written by the same function everywhere: SI goes
//! in, millimeters, degrees, pixels, milliseconds and °C come out, with three significant
//! digits, or with as many as the uncertainty supports where one is given.

use std::time::Duration;

use plumbline_model::number;
pub use plumbline_model::spread::NORMAL_95;

/// Stands where there is no number.
pub const NONE: &str = "—";

/// Smallest value that is still written out, in displayed units.
const MOST_DECIMALS: i32 = 4;

/// A physical quantity with its unit on screen. Values go in as SI.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Quantity {
    /// Meters in, mm on screen: lengths, errors, positions.
    Length,
    /// Meters in, whole mm on screen: distances from the eyes, scales of depth maps.
    Depth,
    /// Radians in, degrees on screen.
    Angle,
    /// Pixels.
    Pixels,
    /// Seconds in, ms on screen.
    Time,
    /// °C.
    Temperature,
    /// Hertz.
    Rate,
    /// 0..=1 in, percent on screen.
    Ratio,
    /// Meters per pixel in, mm per px on screen.
    LengthPerPixel,
    /// A number without a unit.
    Number,
}

impl Quantity {
    /// The unit as it stands on screen; empty for plain numbers.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Length | Self::Depth => "mm",
            Self::Angle => "°",
            Self::Pixels => "px",
            Self::Time => "ms",
            Self::Temperature => "°C",
            Self::Rate => "Hz",
            Self::Ratio => "%",
            Self::LengthPerPixel => "mm/px",
            Self::Number => "",
        }
    }

    /// The SI value in the unit on screen.
    pub fn on_screen(self, si: f64) -> f64 {
        match self {
            Self::Length | Self::Depth | Self::Time | Self::LengthPerPixel => si * 1e3,
            Self::Angle => si.to_degrees(),
            Self::Ratio => si * 1e2,
            Self::Pixels | Self::Temperature | Self::Rate | Self::Number => si,
        }
    }

    /// The number alone, three significant digits: `12.3`. Of a length below a millimeter two: `0.73`; nothing here
    /// is measured finer.
    pub fn number(self, si: f64) -> String {
        let value = self.on_screen(si);
        if self == Self::Depth {
            return fixed(value, 0);
        }
        let is_small = matches!(self, Self::Length) && value.abs() < 1.0;
        significant(value, if is_small { 2 } else { 3 })
    }

    /// Number and unit: `12.3 mm`.
    pub fn text(self, si: f64) -> String {
        self.with_unit(self.number(si))
    }

    /// Number of a known standard deviation, ± what holds 95 % ([`NORMAL_95`]), and unit: `120.05 ± 0.12 mm`.
    ///
    /// An uncertainty of zero, or one that is not finite, is left out.
    pub fn text_with(self, si: f64, sigma_si: f64) -> String {
        self.with_unit(self.number_with(si, sigma_si))
    }

    /// As [`Self::text_with`], without the unit.
    pub fn number_with(self, si: f64, sigma_si: f64) -> String {
        self.number_within(si, NORMAL_95 * sigma_si)
    }

    /// Number ± half of an interval that holds 95 %, and unit.
    pub fn text_within(self, si: f64, half_si: f64) -> String {
        self.with_unit(self.number_within(si, half_si))
    }

    fn number_within(self, si: f64, half_si: f64) -> String {
        let (value, half) = (self.on_screen(si), self.on_screen(half_si).abs());
        if !(half.is_finite() && half > 0.0 && value.is_finite()) {
            return self.number(si);
        }
        let decimals = decimals_for(half, 2);
        format!("{} ± {half:.decimals$}", fixed(value, decimals))
    }

    /// `—` where there is no value.
    pub fn text_or_none(self, si: Option<f64>) -> String {
        si.map_or_else(|| NONE.to_owned(), |si| self.text(si))
    }

    fn with_unit(self, number: String) -> String {
        match self {
            _ if number == NONE => number,
            Self::Number => number,
            // Degrees stand at their number, all other units apart from it.
            Self::Angle => format!("{number}°"),
            _ => format!("{number} {}", self.unit()),
        }
    }
}

/// Meters as millimeters with half of an interval that holds 95 %: `120.05 ± 0.12 mm`.
pub fn mm_within(length_m: f64, half_m: f64) -> String {
    Quantity::Length.text_within(length_m, half_m)
}

/// How near something is known to be to where it is said to be, 95 %, of one standard deviation: `0.24 mm`.
pub fn mm_known_to(sigma_m: f64) -> String {
    mm(NORMAL_95 * sigma_m)
}

/// Meters as millimeters: `12.3 mm`.
pub fn mm(length_m: f64) -> String {
    Quantity::Length.text(length_m)
}

/// Meters as millimeters with what holds 95 %, of one standard deviation: `120.05 ± 0.12 mm`.
pub fn mm_with(length_m: f64, sigma_m: f64) -> String {
    Quantity::Length.text_with(length_m, sigma_m)
}

/// Meters as whole millimeters: `14 mm`. For what a calibration costs on the table.
pub fn whole_mm(length_m: f64) -> String {
    let number = fixed(1e3 * length_m, 0);
    if length_m.is_finite() { format!("{number} mm") } else { number }
}

/// Meters as whole millimeters with what holds 95 %, of one standard deviation: `14 ± 2 mm`.
pub fn whole_mm_with(length_m: f64, sigma_m: f64) -> String {
    if !(length_m.is_finite() && sigma_m.is_finite() && sigma_m != 0.0) {
        return whole_mm(length_m);
    }
    // What is known is never known without error: it is not rounded to nothing.
    format!("{} ± {}", fixed(1e3 * length_m, 0), whole_mm((NORMAL_95 * sigma_m).abs().max(1e-3)))
}

/// A distance from the eyes as whole millimeters: `450 mm`; errors and positions are in [`mm`].
pub fn depth(depth_m: f64) -> String {
    Quantity::Depth.text(depth_m)
}

/// Radians as degrees: `12.3°`.
pub fn degrees(angle_rad: f64) -> String {
    Quantity::Angle.text(angle_rad)
}

/// Radians as degrees of a joint, one decimal: `34.2°`, `0.3°`. An encoder tells steps of 0.09°.
pub fn joint_degrees(angle_rad: f64) -> String {
    Quantity::Angle.with_unit(fixed(angle_rad.to_degrees(), 1))
}

/// Pixels: `0.0961 px`.
pub fn px(pixels: f64) -> String {
    Quantity::Pixels.text(pixels)
}

/// Seconds as milliseconds: `33.3 ms`.
pub fn ms(seconds: f64) -> String {
    Quantity::Time.text(seconds)
}

/// Hertz: `29.9 Hz`.
pub fn hertz(rate_hz: f64) -> String {
    Quantity::Rate.text(rate_hz)
}

/// A fraction as percent, whole numbers: `78 %`. One decimal would promise more than a
/// coverage or a progress knows.
pub fn percent(fraction: f64) -> String {
    if fraction.is_finite() { format!("{:.0} %", 100.0 * fraction) } else { NONE.to_owned() }
}

/// A count with its noun: `1 pair`, `30 pairs`, `80 touches`.
pub fn count(n: usize, singular: &str) -> String {
    plumbline_model::counted(n, singular)
}

/// A pixel position: `(312.4, 87.0)`; one decimal is what a pointer can tell.
pub fn pixel_position(at_px: [f64; 2]) -> String {
    format!("({}, {})", fixed(at_px[0], 1), fixed(at_px[1], 1))
}

/// A position in meters as millimeters: `x 412 mm, y −35.2 mm, z 8.10 mm`.
pub fn position_mm(position_m: [f64; 3]) -> String {
    let [x, y, z] = position_m.map(mm);
    format!("x {x}, y {y}, z {z}")
}

/// Minutes and seconds: `4:10`, `1:02:10`.
pub fn clock(duration: Duration) -> String {
    let seconds = duration.as_secs();
    let (h, m, s) = (seconds / 3600, seconds / 60 % 60, seconds % 60);
    if h > 0 { format!("{h}:{m:02}:{s:02}") } else { format!("{m}:{s:02}") }
}

/// `2:10 left`. Rounded up, so that it does not say 0:00 while work goes on.
pub fn time_left(duration: Duration) -> String {
    let seconds = duration.as_secs() + u64::from(duration.subsec_nanos() > 0);
    format!("{} left", clock(Duration::from_secs(seconds)))
}

/// `2 h ago`.
pub fn age(duration: Duration) -> String {
    let seconds = duration.as_secs();
    match seconds {
        0..=1 => "just now".to_owned(),
        2..=59 => format!("{seconds} s ago"),
        60..=3599 => format!("{} min ago", seconds / 60),
        3600..=86_399 => format!("{} h ago", seconds / 3600),
        _ => format!("{} ago", count((seconds / 86_400) as usize, "day")),
    }
}

/// A number with so many significant digits. Digits before the decimal point are never
/// replaced by zeros (1234 stays 1234), nothing is written finer than 0.0001, and zero has no digits.
pub fn significant(value: f64, digits: i32) -> String {
    if !value.is_finite() {
        return NONE.to_owned();
    }
    if value == 0.0 {
        return "0".to_owned();
    }
    fixed(value, decimals_for(value, digits))
}

/// A number with so many decimals, with a real minus sign and without negative zero.
pub fn fixed(value: f64, decimals: usize) -> String {
    number::fixed(value, decimals).unwrap_or_else(|| NONE.to_owned())
}

/// Decimals that show so many significant digits of a value.
fn decimals_for(value: f64, digits: i32) -> usize {
    if value == 0.0 {
        return 0;
    }
    // Rounding can carry into one more digit (9.996 is 10.0): look at the rounded number.
    let unit = 10f64.powi(value.abs().log10().floor() as i32 - (digits - 1));
    let rounded = (value / unit).round() * unit;
    let exponent = (rounded.abs() * (1.0 + 1e-12)).log10().floor() as i32;
    (digits - 1 - exponent).clamp(0, MOST_DECIMALS) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_significant_digits() {
        for (value, text) in [
            (0.0, "0"),
            (1.0, "1.00"),
            (9.994, "9.99"),
            (9.996, "10.0"),
            (99.96, "100"),
            (0.09614, "0.0961"),
            (0.00012, "0.0001"),
            (0.9999, "1.00"),
            (1234.4, "1234"),
            (-35.17, "−35.2"),
            (-0.00001, "0.0000"),
            (f64::NAN, "—"),
            (f64::INFINITY, "—"),
        ] {
            assert_eq!(significant(value, 3), text, "{value}");
        }
    }

    #[test]
    fn units_are_those_of_the_screen() {
        assert_eq!(mm(0.012_34), "12.3 mm");
        assert_eq!(mm(0.000_734), "0.73 mm");
        assert_eq!(mm(-0.000_043), "−0.043 mm");
        assert_eq!(mm(0.000_999), "1.0 mm");
        assert_eq!(degrees(std::f64::consts::FRAC_PI_6), "30.0°");
        assert_eq!(joint_degrees(0.005), "0.3°");
        assert_eq!(joint_degrees(-2.0), "−114.6°");
        assert_eq!(joint_degrees(f64::NAN), "—");
        assert_eq!(ms(1.0 / 30.0), "33.3 ms");
        assert_eq!(px(0.0961), "0.0961 px");
        assert_eq!(depth(0.45), "450 mm");
        assert_eq!(depth(1.2346), "1235 mm");
        assert_eq!(hertz(29.97), "30.0 Hz");
        assert_eq!(Quantity::LengthPerPixel.text(0.0021), "2.10 mm/px");
        assert_eq!(Quantity::Ratio.text(0.785), "78.5 %");
        assert_eq!(mm(f64::NAN), "—");
    }

    #[test]
    fn uncertainty_decides_the_digits() {
        assert_eq!(mm_with(0.120_053, 0.000_12), "120.05 ± 0.24 mm");
        assert_eq!(mm_with(0.120_053, 0.012), "120 ± 24 mm");
        assert_eq!(mm_with(0.120_053, 0.000_51), "120.1 ± 1.0 mm");
        assert_eq!(mm_with(0.120_053, 0.0), "120 mm");
        assert_eq!(mm_with(0.120_053, f64::NAN), "120 mm");
        assert_eq!(Quantity::Angle.text_with(0.1, 0.001), "5.73 ± 0.11°");
        assert_eq!(mm_with(f64::NAN, 0.1), "—");
    }

    #[test]
    fn missing_numbers_are_a_dash() {
        assert_eq!(Quantity::Pixels.text_or_none(None), "—");
        assert_eq!(Quantity::Pixels.text_or_none(Some(1.5)), "1.50 px");
        assert_eq!(percent(f64::NAN), "—");
    }

    #[test]
    fn durations() {
        let s = Duration::from_secs;
        assert_eq!(clock(s(250)), "4:10");
        assert_eq!(clock(s(3730)), "1:02:10");
        assert_eq!(time_left(Duration::from_millis(129_200)), "2:10 left");
        assert_eq!(time_left(Duration::from_millis(200)), "0:01 left");
        assert_eq!(age(s(1)), "just now");
        assert_eq!(age(s(7300)), "2 h ago");
        assert_eq!(age(s(86_400)), "1 day ago");
        assert_eq!(age(s(200_000)), "2 days ago");
    }

    #[test]
    fn counts_and_positions() {
        assert_eq!(count(1, "pair"), "1 pair");
        assert_eq!(count(30, "pair"), "30 pairs");
        assert_eq!(count(2, "touch"), "2 touches");
        assert_eq!(pixel_position([312.44, -0.01]), "(312.4, 0.0)");
        assert_eq!(position_mm([0.412, -0.035_2, 0.0]), "x 412 mm, y −35.2 mm, z 0 mm");
    }

    #[test]
    fn what_a_calibration_costs_is_in_whole_millimeters() {
        assert_eq!(whole_mm(0.0137), "14 mm");
        assert_eq!(whole_mm_with(0.0137, 0.002), "14 ± 4 mm");
        assert_eq!(whole_mm_with(0.0137, f64::NAN), "14 mm");
        assert_eq!(whole_mm_with(0.0137, 0.0), "14 mm");
        assert_eq!(whole_mm_with(0.0137, 2e-4), "14 ± 1 mm");
        assert_eq!((whole_mm(f64::NAN), whole_mm_with(f64::NAN, 0.1)), (NONE.to_owned(), NONE.to_owned()));
    }
}
