//! All that is wrong with a description (URDF).

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::Vector3;
use urdf_rs::JointType;

use super::urdf_lines::UrdfLines;
use super::{Problem, Problems};
use crate::robot::description::Description;
use crate::robot::error::DescriptionError;
use crate::robot::urdf;

/// An axis may be so much longer or shorter than 1: numbers are written with few digits.
const LENGTH_OFF: f64 = 1e-3;

/// What was found of a description.
pub(super) struct Checked {
    pub problems: Vec<Problem>,
    /// What it says, where it is XML of a robot; joints and links can be looked up in it even if more is
    /// wrong.
    pub robot: Option<urdf_rs::Robot>,
    /// The same checked, where nothing is wrong that matters for reading it.
    pub description: Option<Description>,
}

/// Checks the text of a description.
pub(super) fn check(file: &str, text: &str) -> Checked {
    let mut problems = Problems::new(file, text);
    let robot = match urdf::parse(text) {
        Ok(robot) => robot,
        Err(error) => {
            problems.add(
                None,
                error.to_string(),
                "correct the XML: every tag is closed, every link and joint has a name, every joint a type, \
                 a <parent link> and a <child link>",
            );
            return Checked { problems: problems.found, robot: None, description: None };
        }
    };
    let mut checker = Checker { robot: &robot, lines: UrdfLines::new(text), problems };
    checker.names();
    robot.joints.iter().for_each(|joint| checker.joint(joint));
    robot.links.iter().for_each(|link| checker.link(link));
    checker.tree();
    let mut problems = checker.problems;
    let description = Description::from_urdf(text);
    if let (Err(error), true) = (&description, problems.found.is_empty()) {
        problems.add(None, error.to_string(), "correct it as the sentence says");
    }
    problems.found.sort_by_key(|problem| problem.line.unwrap_or(0));
    Checked { problems: problems.found, description: description.ok(), robot: Some(robot) }
}

struct Checker<'a> {
    robot: &'a urdf_rs::Robot,
    lines: UrdfLines,
    problems: Problems<'a>,
}

impl Checker<'_> {
    /// Something at a joint, or at a part of it.
    fn at_joint(&mut self, joint: &urdf_rs::Joint, part: &str, what: String, fix: String) {
        let line = self.lines.of("joint", &joint.name, 0, Some(part));
        self.problems.add(line, format!("joint {}: {what}", joint.name), fix);
    }

    fn names(&mut self) {
        let links = self.robot.links.iter().map(|link| ("link", &link.name));
        let joints = self.robot.joints.iter().map(|joint| ("joint", &joint.name));
        let mut seen: BTreeMap<(&str, &String), usize> = BTreeMap::new();
        for named in links.chain(joints) {
            let count = seen.entry(named).or_default();
            if *count > 0 {
                let (what, name) = named;
                let line = self.lines.of(what, name, *count, None);
                self.problems.add(line, format!("there are two {what}s called {name}"), "rename one");
            }
            *count += 1;
        }
    }

    fn joint(&mut self, joint: &urdf_rs::Joint) {
        if matches!(joint.joint_type, JointType::Fixed) {
            if let Err(error) = urdf::check_joint(joint) {
                self.implausible("joint", &joint.name, &error);
            }
            return;
        }
        if !matches!(joint.joint_type, JointType::Revolute) {
            let kind = format!("{:?}", joint.joint_type).to_lowercase();
            let fix = if kind == "continuous" {
                "write type=\"revolute\" and give it a <limit> that its cables allow"
            } else {
                "write type=\"fixed\" if it never moves; this program moves revolute joints only"
            };
            self.at_joint(joint, "", format!("is of the kind {kind}, which is not moved"), fix.to_owned());
            return;
        }
        self.limits(joint);
        self.axis(joint);
        self.mimic(joint);
        if let Err(error) = urdf::check_joint(joint) {
            self.implausible("joint", &joint.name, &error);
        }
    }

    fn limits(&mut self, joint: &urdf_rs::Joint) {
        let (lower, upper) = (joint.limit.lower, joint.limit.upper);
        let block = self.lines.named("joint", &joint.name);
        let given = block.first().is_some_and(|block| self.lines.part(*block, "limit").is_some());
        let form = "<limit lower=\"…\" upper=\"…\" effort=\"…\" velocity=\"…\"/>";
        if !given {
            let fix = format!("add {form} inside of the joint, lower and upper in radians");
            self.at_joint(joint, "limit", "has no limits".to_owned(), fix);
        } else if !(lower.is_finite() && upper.is_finite()) {
            let fix = format!("write two finite numbers in radians: {form}");
            self.at_joint(joint, "limit", format!("its limits {lower} to {upper} are not finite"), fix);
        } else if lower > upper {
            let fix = format!("exchange them: lower=\"{upper}\" upper=\"{lower}\"");
            self.at_joint(joint, "limit", format!("its limits are reversed, {lower} to {upper}"), fix);
        } else if lower >= upper {
            let fix =
                "give a lower limit below the upper one, in radians, or write type=\"fixed\"".to_owned();
            self.at_joint(joint, "limit", format!("its limits {lower} to {upper} leave it no way"), fix);
        }
    }

    fn axis(&mut self, joint: &urdf_rs::Joint) {
        let axis = Vector3::from(joint.axis.xyz.0);
        let length = axis.norm();
        if !(length.is_finite() && length > 1e-9) {
            let fix = "write the direction of the axis in the joint's frame, of length 1, for example <axis \
                       xyz=\"0 0 1\"/>";
            self.at_joint(joint, "axis", "its axis has no direction".to_owned(), fix.to_owned());
        } else if (length - 1.0).abs() > LENGTH_OFF {
            let [x, y, z]: [f64; 3] = (axis / length).into();
            let fix = format!("write <axis xyz=\"{x:.9} {y:.9} {z:.9}\"/>");
            self.at_joint(joint, "axis", format!("its axis is {length:.6} long, not 1"), fix);
        }
    }

    fn mimic(&mut self, joint: &urdf_rs::Joint) {
        let Some(mimic) = &joint.mimic else { return };
        let moves_itself = |other: &&urdf_rs::Joint| {
            other.name == mimic.joint
                && !matches!(other.joint_type, JointType::Fixed)
                && other.mimic.is_none()
        };
        if !self.robot.joints.iter().any(|other| moves_itself(&other)) {
            let what = format!("it copies {}, which is no joint that moves by itself", mimic.joint);
            let fix = "name a revolute joint that copies no other one in <mimic joint=\"…\"/>";
            self.at_joint(joint, "mimic", what, fix.to_owned());
        }
    }

    fn link(&mut self, link: &urdf_rs::Link) {
        let read = urdf::check_link(link).and_then(|()| urdf::read_link(link, &BTreeMap::new()).map(|_| ()));
        if let Err(error) = read {
            self.implausible("link", &link.name, &error);
        }
    }

    /// A number that cannot be.
    fn implausible(&mut self, tag: &str, name: &str, error: &DescriptionError) {
        let line = self.lines.of(tag, name, 0, None);
        let what = match error {
            DescriptionError::Implausible { place, what } => format!("{place}: {what}"),
            other => other.to_string(),
        };
        self.problems.add(line, what, "correct the number; URDF is in meters, radians, kilograms");
    }

    /// Whether the links hang together from one base.
    fn tree(&mut self) {
        let robot = self.robot;
        let links: BTreeSet<&str> = robot.links.iter().map(|link| link.name.as_str()).collect();
        let known = links.iter().copied().collect::<Vec<_>>().join(", ");
        let mut above: BTreeMap<&str, &urdf_rs::Joint> = BTreeMap::new();
        for joint in &robot.joints {
            for (end, link) in [("parent", &joint.parent.link), ("child", &joint.child.link)] {
                if !links.contains(link.as_str()) {
                    let what = format!("its {end} is the link {link}, which is not there");
                    self.at_joint(joint, end, what, format!("add the link, or name one of: {known}"));
                }
            }
            match above.get(joint.child.link.as_str()) {
                None => {
                    above.insert(&joint.child.link, joint);
                }
                Some(first) if first.name != joint.name => {
                    let what =
                        format!("it carries {}, as {} does already: a loop", joint.child.link, first.name);
                    let fix =
                        "a link hangs on one joint: take one of the two out; this program moves trees only";
                    self.at_joint(joint, "child", what, fix.to_owned());
                }
                Some(_) => {}
            }
        }
        let roots: Vec<&str> = links.iter().copied().filter(|link| !above.contains_key(link)).collect();
        let base = most_carrying(&roots, &above);
        for root in roots.iter().filter(|root| Some(**root) != base) {
            let line = self.lines.of("link", root, 0, None);
            let to = base.unwrap_or_default();
            let fix = format!("add a joint that has it as <child>, or take it out; the base is {to}");
            self.problems.add(line, format!("link {root} hangs on nothing"), fix);
        }
        for link in links.iter().filter(|link| base_of(link, &above).is_none()) {
            let line =
                above.get(link).and_then(|joint| self.lines.of("joint", &joint.name, 0, Some("parent")));
            let fix = "let one of the joints of the loop have another parent, one that leads to the base";
            self.problems.add(line, format!("link {link} carries itself: its parents form a loop"), fix);
        }
    }
}

/// The root that a link hangs on; `None` for one in a loop.
fn base_of<'a>(link: &'a str, above: &BTreeMap<&'a str, &'a urdf_rs::Joint>) -> Option<&'a str> {
    let mut at = link;
    for _ in 0..=above.len() {
        match above.get(at) {
            None => return Some(at),
            Some(joint) => at = &joint.parent.link,
        }
    }
    None
}

/// The root that most links hang on: the base that is meant.
fn most_carrying<'a>(roots: &[&'a str], above: &BTreeMap<&'a str, &'a urdf_rs::Joint>) -> Option<&'a str> {
    let carried = |root: &str| above.keys().filter(|link| base_of(link, above) == Some(root)).count();
    roots.iter().copied().max_by_key(|root| carried(root))
}
