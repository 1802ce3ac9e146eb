//! Parameters of effects in the words of somebody who stands before the robot.
//!
//! Files and the command line call a parameter by its name with the unit (`rot_x_rad`). What people read is
//! said in one place, for the sentence of a finding, its page and the window alike.

/// A name, what is said before its value ("off by 1.8°"), and what it is called ("zero").
const KNOWN: [(&str, &str, &str); 44] = [
    ("offset_rad", "off by", "zero"),
    ("offset_m", "off by", "zero"),
    ("scale", "too large by", "scale"),
    ("scale_u", "wider by", "width of the image"),
    ("scale_v", "higher by", "height of the image"),
    ("amplitude_rad", "moves by up to", "largest swing"),
    ("phase_rad", "swing shifted by", "start of the swing"),
    ("order", "swings per turn", "swings per turn"),
    ("width_rad", "from side to side", "width of the play"),
    ("width_m", "from side to side", "width of the play"),
    ("step_rad", "jumped by", "jump"),
    ("t_secs", "at", "moment"),
    ("time_constant_s", "two thirds of it within", "pace"),
    ("delay_s", "begins after", "delay"),
    ("late_s", "late by", "lateness"),
    ("ratio", "follows by", "share that it follows"),
    ("from_joint", "pulled by", "joint that pulls"),
    ("which", "namely the", "which of the two"),
    ("fraction", "share of the remaining way", "share of the remaining way"),
    ("early_secs", "too early by", "time that it was too early"),
    ("compliance_rad_per_nm", "gives way by", "how far it gives way"),
    ("compliance_m_per_n", "gives way by", "how far it gives way"),
    ("give_rad_per_nm", "gives way beyond it by", "how far it gives way"),
    ("stiffness_nm_per_rad", "stiffness", "stiffness"),
    ("lean_rad_per_nm", "leans by", "how far it leans"),
    ("torque_nm", "holds up to", "largest torque"),
    ("rot_x_rad", "turned about its x axis by", "turn about its x axis"),
    ("rot_y_rad", "turned about its y axis by", "turn about its y axis"),
    ("rot_z_rad", "turned about its z axis by", "turn about its z axis"),
    ("rot_a_rad", "turned across its axis by", "turn across its axis"),
    ("rot_b_rad", "turned the other way across its axis by", "other turn across its axis"),
    ("yaw_rad", "turned sideways by", "turn sideways"),
    ("roll_rad", "rolled by", "roll"),
    ("pitch_rad", "tilted up by", "tilt"),
    ("length_m", "longer by", "length"),
    ("radius_m", "radius", "radius"),
    ("drag_m", "drags by", "drag"),
    ("mass_kg", "heavier by", "mass"),
    ("latency_s", "late by", "delay"),
    ("bow_u_per_m", "bowed across by", "bow across"),
    ("bow_v_per_m", "bowed from far to near by", "bow from far to near"),
    ("edge_m", "off at the border by", "error at the border"),
    ("k_px", "off at the border by", "error at the border"),
    ("weight", "share of the background", "share of the background"),
];

/// Names of shifts: along which axis, and the unit.
const SHIFTS: [(&str, &str); 8] = [
    ("dx_m", "forward"),
    ("dy_m", "to the robot's left"),
    ("du_px", "to the right in the image"),
    ("dv_px", "down in the image"),
    ("x_m", "along its x axis"),
    ("y_m", "along its y axis"),
    ("z_m", "along its z axis"),
    ("shift_px", "outward"),
];

/// Ends of names that say a unit.
const UNITS: [&str; 11] =
    ["_rad_per_nm", "_nm_per_rad", "_m_per_n", "_per_m", "_rad", "_kg", "_px", "_secs", "_nm", "_m", "_s"];

/// What is said before a value: "off by", "turned about its x axis by". A site before the name, where one
/// effect stands for every joint, is kept: "right elbow y off by".
pub fn said(name: &str) -> String {
    with_site(name, |(_, said, _)| (*said).to_owned(), |along| format!("shifted {along} by"))
}

/// What is said before a size, and the size with its interval (value, low, high) as it is said then: what is longer by
/// less than nothing is shorter.
pub fn directed(name: &str, [value, low, high]: [f64; 3]) -> (String, [f64; 3]) {
    match said_below_zero(name).filter(|_| value < 0.0) {
        Some(said) => (said, [-value, -high, -low]),
        None => (said(name), [value, low, high]),
    }
}

/// What is said before a size below zero without its sign; `None`: the sign stands with the number.
fn said_below_zero(name: &str) -> Option<String> {
    let said = said(name);
    BELOW_ZERO.iter().find_map(|(above, below)| Some(format!("{}{below}", said.strip_suffix(above)?)))
}

/// What is said of a size above zero, and below.
const BELOW_ZERO: [(&str, &str); 6] = [
    ("longer by", "shorter by"),
    ("heavier by", "lighter by"),
    ("wider by", "narrower by"),
    ("higher by", "lower by"),
    ("too large by", "too small by"),
    ("late by", "early by"),
];

/// What a parameter is called inside of a sentence: "zero", "turn about its x axis".
pub fn called(name: &str) -> String {
    with_site(name, |(_, _, called)| (*called).to_owned(), |along| format!("shift {along}"))
}

/// A joint or link that nobody gave a title: "right elbow y" of `r_elbow_y`, "right forearm" of `forearm_r`.
pub fn place(site: &str) -> String {
    let side = |part: &str| match part {
        "r" => Some("right"),
        "l" => Some("left"),
        _ => None,
    };
    let (sides, rest): (Vec<&str>, Vec<&str>) = site.split('_').partition(|part| side(part).is_some());
    let sides = sides.into_iter().filter_map(side);
    sides.chain(rest).collect::<Vec<_>>().join(" ")
}

/// With its article inside of a sentence: "the right elbow", but "every joint" and "both eyes".
pub fn the(whose: &str) -> String {
    let first = whose.split(' ').next().unwrap_or_default().to_lowercase();
    match first.as_str() {
        "every" | "each" | "all" | "both" | "the" => whose.to_owned(),
        _ => format!("the {whose}"),
    }
}

type Known = (&'static str, &'static str, &'static str);

fn with_site(name: &str, known: impl Fn(&Known) -> String, shift: impl Fn(&str) -> String) -> String {
    let of_name = |bare: &str| {
        let listed = KNOWN.iter().find(|(one, ..)| *one == bare).map(&known);
        listed.or_else(|| SHIFTS.iter().find(|(one, _)| *one == bare).map(|(_, along)| shift(along)))
    };
    // The longest end that is known decides; what stands before it is a site.
    let cuts = std::iter::once(0).chain(name.match_indices('_').map(|(at, _)| at + 1));
    for at in cuts {
        if let Some(words) = of_name(&name[at..]) {
            let site = place(name[..at].trim_end_matches('_'));
            return if site.is_empty() { words } else { format!("{site} {words}") };
        }
    }
    let bare = UNITS.iter().find_map(|unit| name.strip_suffix(unit)).unwrap_or(name);
    bare.replace('_', " ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_those_of_a_person_and_hold_no_unit() {
        assert_eq!(said("rot_x_rad"), "turned about its x axis by");
        assert_eq!(called("rot_x_rad"), "turn about its x axis");
        assert_eq!(said("amplitude_rad"), "moves by up to");
        assert_eq!(said("x_m"), "shifted along its x axis by");
        assert_eq!(said("dx_m"), "shifted forward by");
    }

    #[test]
    fn a_site_stays_before_the_words() {
        assert_eq!(said("r_elbow_y_offset_rad"), "right elbow y off by");
        assert_eq!(called("r_wrist_x_rot_z_rad"), "right wrist x turn about its z axis");
        assert_eq!(said("right_forearm_length_m"), "right forearm longer by");
    }

    #[test]
    fn a_place_without_a_title_is_read() {
        let places =
            [("r_elbow_y", "right elbow y"), ("forearm_r", "right forearm"), ("tip", "tip"), ("", "")];
        for (site, words) in places {
            assert_eq!(place(site), words);
        }
    }

    #[test]
    fn what_stands_for_all_has_no_article() {
        assert_eq!(the("right elbow"), "the right elbow");
        for whose in ["every joint", "Every joint", "both eyes", "all fingers"] {
            assert_eq!(the(whose), whose);
        }
        assert_eq!(the("everything else"), "the everything else", "whole words alone");
    }

    #[test]
    fn what_is_not_known_loses_its_unit() {
        assert_eq!(said("step_px"), "step");
        assert_eq!(called("odd_nm_per_rad"), "odd");
    }

    #[test]
    fn every_name_is_there_once() {
        let mut names: Vec<&str> =
            KNOWN.iter().map(|(name, ..)| *name).chain(SHIFTS.iter().map(|(name, _)| *name)).collect();
        let all = names.len();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), all);
    }
}
