//! Robots that nobody has looked at: every error drawn by chance from stated ranges, so that a method can be
//! judged on a robot it was not made for. `drawn-7` and `wide-7` are names of scenarios like any other.
//!
//! A robot that was looked into is one of development from then on; the next judge takes a new number.

use std::fmt::Write;

/// Whose ranges a robot is drawn from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Family {
    /// About as far off as the laboratory's, in one arm.
    Drawn,
    /// Larger errors of more kinds, in both arms, other contacts, other toys.
    Wide,
}

impl Family {
    const ALL: [(&'static str, Self); 2] = [("drawn-", Self::Drawn), ("wide-", Self::Wide)];
}

/// How names of drawn robots read.
pub const NAMES: [&str; 2] = ["drawn-NUMBER", "wide-NUMBER"];

/// The text of the scenario of that name; `None` where it is not that of a drawn robot.
pub fn named(name: &str) -> Option<String> {
    Family::ALL.into_iter().find_map(|(begin, family)| {
        let seed: u64 = name.strip_prefix(begin)?.parse().ok()?;
        Some(match family {
            Family::Drawn => drawn(seed),
            Family::Wide => wide(seed),
        })
    })
}

/// Chance.
struct Dice(u64);

impl Dice {
    /// Evenly in 0 to 1 (Steele, Lea and Flood 2014: SplitMix).
    fn share(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Evenly in ± that.
    fn within(&mut self, most: f64) -> f64 {
        most * (2.0 * self.share() - 1.0)
    }

    fn between(&mut self, least: f64, most: f64) -> f64 {
        least + (most - least) * self.share()
    }

    fn three(&mut self, most: f64) -> String {
        let [x, y, z] = [0; 3].map(|_| self.within(most));
        format!("[{x:.6}, {y:.6}, {z:.6}]")
    }
}

/// How far off the joints of an arm are.
struct Arm {
    joints: [&'static str; 6],
    zero_rad: f64,
    slack_rad: f64,
    give_rad_per_nm: f64,
    tilt_rad: f64,
    shift_m: f64,
}

const RIGHT: [&str; 6] = ["r_shoulder_z", "r_shoulder_y", "r_arm_x", "r_elbow_y", "r_wrist_z", "r_wrist_x"];
const LEFT: [&str; 6] = ["l_shoulder_z", "l_shoulder_y", "l_arm_x", "l_elbow_y", "l_wrist_z", "l_wrist_x"];

/// A scenario file that is being written. Writing into a text cannot fail.
struct File {
    text: String,
    dice: Dice,
}

impl File {
    fn begin(begin: &str, title: &str, about: &str, seed: u64) -> Self {
        let text = format!(
            "format = 1\nname = \"{begin}{seed}\"\ntitle = \"{title} {seed}\"\nabout = \"{about}\"\n"
        );
        Self { text, dice: Dice(seed) }
    }

    fn say(&mut self, lines: std::fmt::Arguments<'_>) {
        let _ = self.text.write_fmt(lines);
    }

    fn arm(&mut self, arm: &Arm) {
        for joint in arm.joints {
            let zero = self.dice.within(arm.zero_rad);
            let (slack, give) = (arm.slack_rad * self.dice.share(), arm.give_rad_per_nm * self.dice.share());
            let (tilt, shift) = (self.dice.three(arm.tilt_rad), self.dice.three(arm.shift_m));
            self.say(format_args!(
                "\n[joint.{joint}]\nencoder_zero_rad = {zero:.6}\nslack_rad = {slack:.6}\n\
                 compliance_rad_per_nm = {give:.6}\naxis_tilt_rad = {tilt}\norigin_shift_m = {shift}\n"
            ));
        }
    }

    fn head(&mut self, zero_rad: f64) {
        for joint in ["head_z", "head_y"] {
            let zero = self.dice.within(zero_rad);
            self.say(format_args!("\n[joint.{joint}]\nencoder_zero_rad = {zero:.6}\n"));
        }
    }

    /// The table, and the screen on it: that may be turned and shifted there, and stand a little higher, not deeper.
    fn table(&mut self, turn_rad: f64, scale: f64) {
        let (turn, shift) = (self.dice.three(0.01), self.dice.three(0.008));
        self.say(format_args!("\n[table]\nrotation_rad = {turn}\ntranslation_m = {shift}\n"));
        let turn = self.dice.within(turn_rad);
        let [x, y] = [0; 2].map(|_| self.dice.within(0.01));
        let z = 0.003 * self.dice.share();
        let [u, v] = [0; 2].map(|_| 1.0 + self.dice.within(scale));
        self.say(format_args!(
            "\n[touchscreen]\nrotation_rad = [0.0, 0.0, {turn:.6}]\ntranslation_m = [{x:.6}, {y:.6}, {z:.6}]\n\
             scale = [{u:.6}, {v:.6}]\n"
        ));
    }

    fn eyes(&mut self, turn_rad: f64, shift_m: f64, heat_rad_per_k: f64) {
        let (turn, shift, right) =
            (self.dice.three(turn_rad), self.dice.three(shift_m), self.dice.three(0.01));
        self.say(format_args!(
            "\n[eyes]\nrotation_rad = {turn}\ntranslation_m = {shift}\nright_rotation_rad = {right}\n"
        ));
        let [left, right] = [0; 2].map(|_| self.dice.three(heat_rad_per_k));
        self.say(format_args!("\n[eyes.heat]\nleft_rad_per_k = {left}\nright_rad_per_k = {right}\n"));
    }

    fn fingertip(&mut self, link: &str, off_m: f64) {
        let off = self.dice.three(off_m);
        self.say(format_args!("\n[fingertip.{link}]\noffset_m = {off}\n"));
    }
}

/// Ranges: encoder zeros ±0.03 rad (head ±0.015), slack to 0.008 rad, give to
/// 0.008 rad/Nm, axes ±0.01 rad, joints ±2 mm, table ±8 mm and ±0.01 rad, screen on it ±10 mm, up to 3 mm higher,
/// ±0.02 rad and ±1 %, eyes ±6 mm and ±0.03 rad, right eye ±0.01 rad, warming up ±0.3 mrad/K, fingertip ±4 mm. The
/// right arm alone.
fn drawn(seed: u64) -> String {
    let mut file = File::begin("drawn-", "Drawn", "Errors drawn by chance.", seed);
    file.arm(&Arm {
        joints: RIGHT,
        zero_rad: 0.03,
        slack_rad: 0.008,
        give_rad_per_nm: 0.008,
        tilt_rad: 0.01,
        shift_m: 0.002,
    });
    file.head(0.015);
    file.table(0.02, 0.01);
    file.eyes(0.03, 0.006, 3e-4);
    file.fingertip("r_indexfinger", 0.004);
    file.text
}

/// Ranges, in both arms: encoder zeros ±0.05 rad (head ±0.025), slack to 0.012 rad, give to 0.02 rad/Nm, axes
/// ±0.02 rad, joints ±3 mm, fingertips ±4 mm; table as usual, screen on it ±0.04 rad and ±1.5 %; eyes ±8 mm and
/// ±0.04 rad, warming up ±0.5 mrad/K; friction of toys 0.7 to 1.2, their mass 0.7 to 1.6 and their size 0.9 to 1.1 times the
/// usual, friction of the glass 0.15 to 0.5, a touch felt from 0.1 to 0.4 N; one robot of four has servos that end
/// exactly where they are sent.
fn wide(seed: u64) -> String {
    let mut file = File::begin("wide-", "Wide", "Larger errors of more kinds, drawn by chance.", seed);
    if file.dice.share() < 0.25 {
        file.say(format_args!("\n[servo]\nholding = \"exact\"\n"));
    }
    for joints in [RIGHT, LEFT] {
        file.arm(&Arm {
            joints,
            zero_rad: 0.05,
            slack_rad: 0.012,
            give_rad_per_nm: 0.02,
            tilt_rad: 0.02,
            shift_m: 0.003,
        });
    }
    file.head(0.025);
    file.table(0.04, 0.015);
    file.eyes(0.04, 0.008, 5e-4);
    for link in ["r_indexfinger", "l_indexfinger"] {
        file.fingertip(link, 0.004);
    }
    let dice = &mut file.dice;
    let contact = [
        ("toy_friction", dice.between(0.7, 1.2)),
        ("toy_mass", dice.between(0.7, 1.6)),
        ("toy_size", dice.between(0.9, 1.1)),
        ("glass_friction", dice.between(0.15, 0.5)),
        ("touch_threshold_n", dice.between(0.1, 0.4)),
    ];
    file.say(format_args!("\n[contact]\n"));
    for (key, value) in contact {
        file.say(format_args!("{key} = {value:.4}\n"));
    }
    file.text
}

#[cfg(test)]
mod tests {
    use super::super::Scenario;
    use super::*;

    #[test]
    fn every_drawn_robot_is_a_valid_scenario_of_its_name_and_no_two_are_alike() {
        for family in ["drawn", "wide"] {
            let robots: Vec<Scenario> = (0..200)
                .map(|seed| {
                    let name = format!("{family}-{seed}");
                    let robot = Scenario::from_toml(&name, &named(&name).expect("drawn")).expect("valid");
                    assert_eq!(robot.name, name);
                    robot
                })
                .collect();
            let zeros = |robot: &Scenario| robot.joint("r_elbow_y").encoder_zero_rad;
            for pair in robots.windows(2) {
                assert!((zeros(&pair[0]) - zeros(&pair[1])).abs() > 1e-7);
            }
        }
    }

    #[test]
    fn the_same_name_is_the_same_robot_and_other_names_are_none() {
        assert_eq!(named("wide-3"), named("wide-3"));
        for name in ["wide-", "drawn--1", "drawn", "wide-x", "lab", ""] {
            assert_eq!(named(name), None, "{name}");
        }
    }
}
