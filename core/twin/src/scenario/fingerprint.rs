//! What tells scenarios apart, however their files are written. It tells nothing of what they hide.

use std::collections::BTreeSet;

use toml::{Table, Value};

use super::{
    ContactReality, Displacement, EyesReality, FingertipReality, JointReality, Scenario, ScreenReality,
    ServoReality,
};

impl Scenario {
    /// 16 hexadecimal digits: the same for scenarios of one name and one reality, others for others. The same on
    /// every machine and in every version of the program that knows the keys that are used.
    pub fn fingerprint(&self) -> String {
        format!("{:016x}", hash(&self.canonical()))
    }

    /// Every value that is not as described, a line each, in the order of their keys: a key that is left out and one
    /// that is written out as described say the same, and a key that is new one day changes nothing where it is not
    /// used. Title and sentence are for people: a twin stays the same when they are improved.
    fn canonical(&self) -> String {
        let described = Self {
            format: self.format,
            name: String::new(),
            title: self.title.clone(),
            about: self.about.clone(),
            servo: ServoReality::default(),
            joint: self.joint.keys().map(|name| (name.clone(), JointReality::default())).collect(),
            table: Displacement::default(),
            touchscreen: ScreenReality::default(),
            eyes: EyesReality::default(),
            fingertip: self
                .fingertip
                .keys()
                .map(|name| (name.clone(), FingertipReality::default()))
                .collect(),
            contact: ContactReality::default(),
        };
        let other: Vec<String> = lines(self).difference(&lines(&described)).cloned().collect();
        other.join("\n")
    }
}

/// Each value with its key.
fn lines(scenario: &Scenario) -> BTreeSet<String> {
    let table = Table::try_from(scenario).expect("numbers, texts and maps of them are TOML");
    let mut lines = BTreeSet::new();
    flatten("", &table, &mut lines);
    lines
}

fn flatten(above: &str, table: &Table, lines: &mut BTreeSet<String>) {
    for (key, value) in table {
        let place = format!("{above}/{key}");
        match value {
            Value::Table(inner) => flatten(&place, inner, lines),
            value => {
                lines.insert(format!("{place} = {value}"));
            }
        }
    }
}

/// FNV-1a, 64 bits: the same on every machine and in every version.
fn hash(text: &str) -> u64 {
    let fold = |hash: u64, byte: u8| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
    text.bytes().fold(0xcbf2_9ce4_8422_2325, fold)
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEAD: &str = "format = 1\nname = \"x\"\ntitle = \"X\"\nabout = \"x\"\n";
    const BODY: &str = "[joint.r_arm_x]\nslack_rad = 0.01\norigin_shift_m = [0.001, 0.0, -0.002]\n[contact]\ntoy_mass = 2.0\n";

    fn of(text: &str) -> String {
        Scenario::from_toml("x.toml", text).expect("valid").fingerprint()
    }

    #[test]
    fn a_file_that_is_written_otherwise_is_the_same_twin() {
        let first = of(&format!("{HEAD}{BODY}"));
        for (what, text) in [
            (
                "spaces, comments and other numerals",
                "# Mine.\nname='x'\nformat   = 1\nabout = \"x\"\ntitle = \"X\"\n\n[contact]\ntoy_mass = 2e0 # heavy\n\n[joint.\"r_arm_x\"]\norigin_shift_m = [ 1e-3, 0.0,\n -0.0020 ]\nslack_rad = 0.010\n",
            ),
            (
                "in one line each",
                "format = 1\nname = \"x\"\ntitle = \"X\"\nabout = \"x\"\njoint = { r_arm_x = { slack_rad = 0.01, origin_shift_m = [0.001, 0.0, -0.002] } }\ncontact.toy_mass = 2.0\n",
            ),
        ] {
            assert_eq!(of(text), first, "{what}");
        }
        let written_out = format!(
            "{HEAD}{BODY}toy_friction = 1.0\n[servo]\nholding = \"proportional\"\n[joint.r_elbow_y]\nslack_rad = 0.0\n[touchscreen]\nscale = [1.0, 1.0]\n[eyes.heat]\nhousing_j_per_k = 30.0\n"
        );
        assert_eq!(of(&written_out), first, "what is as described may be written out");
        let said_better =
            format!("{HEAD}{BODY}").replace("\"X\"", "\"Mine\"").replace("\"x\"\n[", "\"Better.\"\n[");
        assert_ne!(said_better, format!("{HEAD}{BODY}"));
        assert_eq!(of(&said_better), first, "words for people");
    }

    #[test]
    fn each_value_that_is_changed_is_another_twin() {
        let all = format!(
            "{HEAD}[servo]\nholding = \"exact\"\n{BODY}[table]\nrotation_rad = [0.01, 0.0, 0.0]\n[touchscreen]\ntranslation_m = [0.003, 0.0, 0.0]\n[eyes]\nright_rotation_rad = [0.0, 0.004, 0.0]\n[eyes.heat]\npower_w = 1.5\n[fingertip.x]\noffset_m = [0.0, 0.0, 0.005]\n"
        );
        let first = of(&all);
        let mut seen = BTreeSet::from([first.clone()]);
        for (from, to) in [
            ("name = \"x\"", "name = \"y\""),
            ("\"exact\"", "\"proportional\""),
            ("slack_rad = 0.01", "slack_rad = 0.010000000000000002"),
            ("[0.001, 0.0, -0.002]", "[0.001, -0.002, 0.0]"),
            ("joint.r_arm_x", "joint.r_arm_y"),
            ("toy_mass = 2.0", "toy_friction = 2.0"),
            ("rotation_rad = [0.01, 0.0", "rotation_rad = [0.0, 0.01"),
            ("translation_m = [0.003", "translation_m = [0.004"),
            ("0.004, 0.0]\n[eyes.heat]", "0.005, 0.0]\n[eyes.heat]"),
            ("power_w = 1.5", "power_w = 1.6"),
            ("fingertip.x", "fingertip.y"),
        ] {
            let changed = all.replacen(from, to, 1);
            assert_ne!(changed, all, "{from}");
            assert!(seen.insert(of(&changed)), "{from} → {to}");
        }
        assert_eq!(of(&all), first, "and the same one is the same again");
    }

    #[test]
    fn it_is_the_same_in_every_version() {
        // Whoever changes this number lets nobody go on with a lab of before.
        assert_eq!(hash("/contact/toy_mass = 2.0\n/name = \"x\""), hash(&canonical_of_one()));
        assert_eq!(hash(""), 0xcbf2_9ce4_8422_2325);
        assert_eq!(hash("a"), 0xaf63_dc4c_8601_ec8c);
    }

    fn canonical_of_one() -> String {
        let text = format!("{HEAD}[contact]\ntoy_mass = 2.0\n");
        Scenario::from_toml("x.toml", &text).expect("valid").canonical()
    }
}
