//! Rig files with faults of known lines.

use super::*;

const RIG: &str = include_str!("../../../../../assets/robots/nico/rig.toml");
const URDF: &str = include_str!("../../../../../assets/robots/nico/nico.urdf");

fn check(rig: &str, urdf: &str) -> Vec<Problem> {
    Rig::check_text("rig.toml", rig, |_| Ok(urdf.to_owned()))
}

/// The text with something else in a place of it, and the line of that place.
fn with(text: &str, from: &str, to: &str) -> (String, usize) {
    let at = text.find(from).unwrap_or_else(|| panic!("{from} is there"));
    (text.replacen(from, to, 1), line_of(text, at))
}

fn told(problems: &[Problem], line: usize, what: &str, fix: &str) {
    let here = |problem: &&Problem| problem.line == Some(line) && problem.what.contains(what);
    let found = problems.iter().find(here).unwrap_or_else(|| panic!("{line}: {what} in {problems:#?}"));
    assert!(found.fix.contains(fix), "{found:?}");
}

#[test]
fn the_rig_that_comes_with_the_program_is_sound() {
    assert_eq!(check(RIG, URDF), []);
}

#[test]
fn all_that_is_wrong_with_a_rig_file_is_told_at_once() {
    let faults = [
        ("baud = 1_000_000", "baud = 1_000_000\nbauds = 3", "unknown key bauds in [bus]", "[bus] has baud"),
        ("joint = \"r_arm_x\"", "joint = \"r_arm_w\"", "the joint r_arm_w", "r_arm_x"),
        ("link = \"head\"", "link = \"heat\"", "the link heat", "head"),
        ("warm_c = 55.0", "warm_c = \"55\"", "gate: invalid type: string", "rig.toml"),
        ("left_palm_center", "left_palm_centre", "the link left_palm_centre", "left_palm_center"),
        ("head_z = 0.0", "head_z = 9.0", "pose home puts head_z at 9 rad", "1.5707"),
        ("ratio = 4.0", "ratio = -4.0", "ratio -4 must be positive", "correct"),
    ];
    let (mut rig, mut lines) = (RIG.to_owned(), vec![]);
    for (from, to, ..) in faults {
        let (text, _) = with(&rig, from, to);
        rig = text;
    }
    for (_, to, ..) in faults {
        let at = rig.find(to).expect("it was put there") + to.find('\n').map_or(0, |at| at + 1);
        lines.push(line_of(&rig, at));
    }
    let problems = check(&rig, URDF);
    for ((_, _, what, fix), line) in faults.into_iter().zip(lines) {
        // What is wrong with a section as a whole is told where it begins.
        let line = if what.contains("ratio") { line - 7 } else { line };
        let fix = if fix == "rig.toml" { "rig file" } else { fix };
        told(&problems, line, what, fix);
    }
    assert_eq!(problems.len(), 7, "{problems:#?}");
    assert!(problems.is_sorted_by_key(|problem| problem.line));
}

#[test]
fn ids_that_occur_twice_and_reversed_motors_have_a_line() {
    let (rig, _) = with(RIG, "id = 20\n", "id = 19\n");
    let (rig, _) = with(&rig, "id = 40\n", "id = 41\n");
    let (rig, _) = with(&rig, "motor_lower_rad = -0.523599", "motor_lower_rad = 3.2");
    let problems = check(&rig, URDF);
    let line_of_section = |marker: &str| {
        let at = rig.find(marker).expect("it is there");
        line_of(&rig, rig[..at].rfind("[[").expect("a section"))
    };
    told(
        &problems,
        line_of_section("title = \"Head down–up\""),
        "both have the id 19",
        "answers to on the bus",
    );
    told(&problems, line_of_section("title = \"Left hand board\""), "has the id 41", "id of its own");
    told(&problems, line_of_section("motor_lower_rad = 3.2"), "motor_lower_rad must be below", "correct");
    assert_eq!(problems.len(), 3, "{problems:#?}");
}

#[test]
fn cameras_screen_and_keys_that_are_missing_are_told() {
    let begin = RIG.find("[touchscreen]").expect("a section");
    let end = begin + RIG[begin..].find("\n# ").expect("a comment after it");
    let rig = format!("{}{}", &RIG[..begin], &RIG[end..]);
    let begin = rig.find("[eyes.right]").expect("a section");
    let end = begin + rig[begin..].find("\n# ").expect("a comment after it");
    let rig = format!("{}{}", &rig[..begin], &rig[end..]);
    let (rig, _) = with(&rig, "skew_px = -0.07459\n", "");
    let (rig, _) = with(&rig, "name = \"nico\"\n", "");
    let problems = check(&rig, URDF);
    let missing = |what: &str| {
        let found = problems.iter().find(|problem| problem.what.contains(what));
        found.unwrap_or_else(|| panic!("{what} in {problems:#?}")).clone()
    };
    let screen = missing("no [touchscreen]: the screen that the finger touches");
    assert!(screen.line.is_none() && screen.fix.contains("origin_m, u_axis, v_axis"), "{screen:?}");
    assert_eq!(missing("the file has no name").line, None);
    let lens = rig.find("[eyes.left]").expect("a section");
    told(&problems, line_of(&rig, lens), "has no skew_px", "add skew_px");
    assert!(missing("[eyes] has no [eyes.right]: the lens of the right camera").line.is_some());
    assert_eq!(problems.len(), 4, "{problems:#?}");
}

#[test]
fn all_that_is_wrong_with_a_description_is_told_with_it() {
    let joint = |name: &str| {
        let at = URDF.find(&format!("<joint name=\"{name}\"")).unwrap_or_else(|| panic!("{name}"));
        let end = at + URDF[at..].find("</joint>").expect("it ends");
        URDF[at..end].to_owned()
    };
    let part = |name: &str, tag: &str| {
        let text = joint(name);
        let at = text.find(tag).expect("it has one");
        text[at..=at + text[at..].find('>').expect("a tag")].to_owned()
    };
    let limit = |name: &str| part(name, "<limit");
    let change = |urdf: &str, name: &str, from: &str, to: &str| {
        let old = joint(name);
        assert!(old.contains(from), "{name}: {old}");
        urdf.replacen(&old, &old.replacen(from, to, 1), 1)
    };
    let urdf = change(URDF, "r_elbow_y", &limit("r_elbow_y"), "");
    let urdf = change(
        &urdf,
        "r_arm_x",
        &limit("r_arm_x"),
        "<limit lower=\"1\" upper=\"-1\" effort=\"1\" velocity=\"1\"/>",
    );
    let urdf = change(&urdf, "l_arm_x", &part("l_arm_x", "<axis"), "<axis xyz=\"1 1 0\"/>");
    let urdf = change(&urdf, "l_elbow_y", "type=\"revolute\"", "type=\"prismatic\"");
    let urdf = change(&urdf, "l_wrist_x", "<parent link=\"", "<parent link=\"no_");
    let urdf = urdf.replacen("</robot>", "<link name=\"lost\"/>\n<link name=\"head\"/>\n</robot>", 1);
    let problems = check(RIG, &urdf);
    let line = |marker: &str| line_of(&urdf, urdf.rfind(marker).unwrap_or_else(|| panic!("{marker}")));
    let of_joint = |name: &str| line(&format!("<joint name=\"{name}\""));
    told(&problems, of_joint("r_elbow_y"), "has no limits", "<limit lower");
    told(&problems, line("lower=\"1\" upper=\"-1\""), "reversed, 1 to -1", "lower=\"-1\" upper=\"1\"");
    told(&problems, line("xyz=\"1 1 0\""), "its axis is 1.414214 long, not 1", "0.707106781 0.707106781");
    told(&problems, of_joint("l_elbow_y"), "of the kind prismatic", "fixed");
    told(&problems, line("\"no_"), "which is not there", "left_wrist");
    told(&problems, line("<link name=\"lost\"/>"), "hangs on nothing", "the base is torso");
    told(&problems, line("<link name=\"head\"/>"), "two links called head", "rename one");
    // The rig file is still checked by the names that are there.
    let (rig, at) = with(RIG, "joint = \"r_wrist_z\"", "joint = \"r_wrist_q\"");
    told(&check(&rig, &urdf), at, "the joint r_wrist_q", "there are:");
}

#[test]
fn loops_are_told_with_what_closes_them() {
    let urdf = |joints: &str| {
        let links = ["a", "b", "c"].map(|name| format!("<link name=\"{name}\"/>")).join("\n");
        format!("<robot name=\"r\">\n{links}\n{joints}\n</robot>")
    };
    let joint = |name: &str, parent: &str, child: &str| {
        format!(
            "<joint name=\"{name}\" type=\"fixed\"><parent link=\"{parent}\"/><child link=\"{child}\"/></joint>\n"
        )
    };
    let twice = urdf(&[joint("one", "a", "b"), joint("two", "b", "c"), joint("three", "a", "c")].concat());
    let found = description::check("r.urdf", &twice).problems;
    told(&found, 7, "joint three: it carries c, as two does already: a loop", "take one of the two out");
    let round = urdf(&[joint("one", "b", "c"), joint("two", "c", "b")].concat());
    let found = description::check("r.urdf", &round).problems;
    told(&found, 6, "link b carries itself", "another parent");
    told(&found, 5, "link c carries itself", "another parent");
}

#[test]
fn what_is_no_rig_file_is_told() {
    let not_toml = check("format = 1\nname = \"a\ntitle = 3 =\n", URDF);
    told(&not_toml, 2, "not TOML", "correct the line");
    told(&not_toml, 3, "not TOML", "correct the line");
    let description = check(URDF, URDF);
    assert!(description.len() == 1 && description[0].what.contains("not a rig file"), "{description:#?}");
    let gone = Rig::check_text("rig.toml", RIG, |name| Err(format!("{name} is not there")));
    let (_, line) = with(RIG, "description = \"nico.urdf\"", "");
    told(&gone, line, "nico.urdf is not there", "beside the rig file");
    let broken = check(RIG, "<robot><link></robot>");
    assert!(broken.iter().any(|problem| problem.what.contains("not valid URDF")), "{broken:#?}");
    let (rig, line) = with(RIG, "[bus]\nbaud = 1_000_000", "bus = 7");
    told(&check(&rig, URDF), line, "bus is no section", "[bus]");
    let folder = tempfile::tempdir().expect("a folder");
    let unreadable = Rig::check(&folder.path().join("none.toml")).expect_err("no file").to_string();
    assert!(unreadable.contains("none.toml"), "{unreadable}");
    std::fs::write(folder.path().join("rig.toml"), RIG).expect("written");
    std::fs::write(folder.path().join("nico.urdf"), URDF).expect("written");
    assert_eq!(Rig::check(&folder.path().join("rig.toml")).expect("read"), []);
}
