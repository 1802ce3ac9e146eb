//! Effects at their sites.

use nalgebra::Vector3;
use plumbline_model::robot::CalibratedAt;

use super::entry::{EyeSite, Is, Shape, Site};
use super::{Kind, Parameter};
use crate::arm::Arm;
use crate::eyes::Eyes;

/// Links shorter than this have no length that could be wrong, m.
const SHORTEST_LINK_M: f64 = 0.02;

/// An effect at its site.
#[derive(Clone, Debug, PartialEq)]
pub struct Effect {
    /// What kind.
    pub kind: Kind,
    /// A joint, a link, `tip`, `base`, `screen`, `eyes`, `right`, a set of rows; empty: all joints alike.
    pub site: String,
    /// What it is and where, for people.
    pub title: String,
    /// What does not enter the prediction linearly, by kind: periods per turn (`None`: one), a
    /// time constant (s), a moment (s), a torque (N m), which of some things (`None`: the first, 1: the second). An
    /// eye that turns is constant without it and grows with it: see [`Self::growth`]. `None`
    /// where there is no such thing.
    pub shape: Option<f64>,
    /// Between which shapes the true one lies, as far as the grid of candidates tells.
    pub shape_range: Option<[f64; 2]>,
    /// Of an effect of the eyes that grows: time since they were switched on at which the calibration that it corrects
    /// holds, s. What has grown until then is in the calibration; see [`Self::part`].
    pub reference_s: f64,
    /// Place of the joint in the arm (or neck), for effects of one joint or link.
    pub(super) joint: Option<usize>,
    /// Two directions across the axis of its joint, own frame.
    pub(crate) across: Option<[Vector3<f64>; 2]>,
    /// Its joint slides: what is an angle elsewhere is a length.
    pub(super) slides: bool,
    /// Joints that may pull its own along, the most probable one first; see [`Self::puller`].
    pub(super) pullers: Vec<Puller>,
    /// Not one effect but one of this kind at every site, each with its own values: a robot that
    /// was put together by hand has every zero off. Parameters are theirs in turn.
    pub(super) members: Vec<Effect>,
}

/// A joint that pulls another one along.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Puller {
    /// Its place in the arm.
    pub place: usize,
    /// Its name.
    pub joint: String,
    /// Its name for people.
    title: String,
}

/// Sites of what is off about one eye.
pub(super) const LEFT: &str = "left";
pub(super) const RIGHT: &str = "right";

/// At most so many joints have their effects in one.
const MOST_MEMBERS: usize = 12;

/// Said of what comes as the eyes warm up.
const GROWS: &str = ", more so as the cameras warm up";

impl Effect {
    /// Every effect that a plan of touches is scored by, at every site of an arm.
    pub fn all(arm: &Arm) -> Vec<Self> {
        Kind::ALL
            .iter()
            .filter(|kind| kind.is_planned())
            .flat_map(|kind| Self::sites(*kind, Some(arm), None))
            .filter(|effect| !effect.site.is_empty())
            .collect()
    }

    /// A kind of effect at every site that an arm or eyes offer, in its first shape.
    pub fn sites(kind: Kind, arm: Option<&Arm>, eyes: Option<&Eyes>) -> Vec<Self> {
        let of_arm = arm.map_or(vec![], |arm| of_arm(kind, arm));
        let of_eyes = eyes.map_or(vec![], |eyes| of_eyes(kind, eyes));
        of_arm.into_iter().chain(of_eyes).collect()
    }

    /// What was so only while one set of rows was measured; `None` for what does not depend on sets.
    pub(crate) fn in_set(kind: Kind, set: &str) -> Option<Self> {
        let is_of_sets = matches!(kind.entry().site, Site::OfEyes(EyeSite::Set));
        is_of_sets.then(|| Self::new(kind, set, &format!("set {set}"), None))
    }

    /// Whether it was so only while one set of rows was measured, and says nothing of any other time.
    pub fn is_of_a_set(&self) -> bool {
        matches!(self.kind.entry().site, Site::OfEyes(EyeSite::Set))
    }

    /// The effect of this name at this site, as a file or the command line gives it; `None` when
    /// the arm or the eyes have no such site. `shape` as in [`Self::shape`].
    pub fn find(
        id: &str,
        site: &str,
        shape: Option<f64>,
        arm: Option<&Arm>,
        eyes: Option<&Eyes>,
    ) -> Option<Self> {
        let kind = Kind::of_id(id)?;
        let in_set = eyes.filter(|_| !site.is_empty()).and_then(|_| Self::in_set(kind, site));
        let at_site = || Self::sites(kind, arm, eyes).into_iter().find(|effect| effect.site == site);
        let found = in_set.or_else(at_site)?.with_shape(shape);
        // Nobody pulls it whom this arm does not have.
        (found.pullers.is_empty() || found.puller().is_some()).then_some(found)
    }

    /// The same in another shape.
    pub fn with_shape(mut self, shape: Option<f64>) -> Self {
        self.shape = shape;
        self.shape_range = None;
        // What is off about eyes all the while, and what comes as they warm up, want another remedy.
        let constant = self.title.trim_end_matches(GROWS);
        self.title = match self.kind.is_growth_of_eyes(shape) {
            true => format!("{constant}{GROWS}"),
            false => constant.to_owned(),
        };
        if let (Some(puller), Some((whose, _))) = (self.puller(), self.title.split_once(": ")) {
            self.title = format!("{whose}: pulled along by {}", puller.title);
        }
        self
    }

    /// The same beside a calibration that holds at this time since the eyes were switched on, s.
    pub fn with_reference(mut self, reference_s: f64) -> Self {
        self.reference_s = reference_s;
        self
    }

    /// The same beside the calibration of these eyes. Where it is not known how warm they were, they count as cold.
    pub(crate) fn beside(self, calibrated_at: &CalibratedAt) -> Self {
        if !self.kind.is_growth_of_eyes(self.shape) {
            return self;
        }
        let reference_s = self.kind.held_at_s(calibrated_at).unwrap_or(0.0);
        self.with_reference(reference_s)
    }

    pub(super) fn new(kind: Kind, site: &str, whose: &str, joint: Option<usize>) -> Self {
        let title =
            if whose.is_empty() { kind.about().to_owned() } else { format!("{whose}: {}", kind.about()) };
        Self {
            kind,
            site: site.to_owned(),
            title,
            shape: None,
            shape_range: None,
            reference_s: 0.0,
            joint,
            across: None,
            slides: false,
            pullers: vec![],
            members: vec![],
        }
    }

    /// Its kind's name on the command line and in files.
    pub fn id(&self) -> &'static str {
        self.kind.id()
    }

    /// Kind and site: `id@site`, or the id alone where the site is empty. Shapes of one effect
    /// have one name.
    pub fn name(&self) -> String {
        if self.site.is_empty() { self.id().to_owned() } else { format!("{}@{}", self.id(), self.site) }
    }

    /// Its parameters.
    pub fn parameters(&self) -> &'static [Parameter] {
        if !self.members.is_empty() {
            let count: usize = self.members.iter().map(|member| member.parameters().len()).sum();
            return &self.kind.entry().site.parameters_of_every()[..count];
        }
        if self.slides && !self.kind.entry().sliding.is_empty() {
            return self.kind.entry().sliding;
        }
        match (self.kind.entry().shape, self.shape) {
            (Shape::Growth(parameters), Some(_)) => parameters,
            _ => self.kind.parameters(),
        }
    }

    /// Whether it stands for one of its kind at every site, each with its own values.
    pub fn is_of_every_site(&self) -> bool {
        !self.members.is_empty()
    }

    /// Whether no robot has more of it than is plausible, so that a larger one is something else that it follows: parts that
    /// are made like others are not wrong at every site as one is by mistake. (Zeros may be off by a whole tooth, and at every joint.)
    pub fn is_bounded(&self) -> bool {
        self.is_of_every_site() && self.kind != Kind::JointZero
    }

    /// Which of the things that its kind may be, from 0 on.
    pub(super) fn choice(&self) -> usize {
        self.shape.map_or(0, |shape| shape as usize)
    }

    /// The joint that pulls its own along, where one does.
    pub(super) fn puller(&self) -> Option<&Puller> {
        self.pullers.get(self.choice())
    }

    /// Whether the joint before its own pulls that along: a cable or a gear of it runs through this one.
    pub fn is_pulled_by_the_one_before(&self) -> bool {
        self.puller().zip(self.joint).is_some_and(|(puller, joint)| puller.place + 1 == joint)
    }

    /// How many joints may pull its own along.
    pub(crate) fn puller_count(&self) -> usize {
        self.pullers.len()
    }

    /// The law of what grows. The shape holds it: whole seconds of the time constant, and its second number in
    /// thousandths of its seconds after the point (240.06: 240 s, 60 s); negative where that number is a second
    /// time constant and no delay.
    pub fn growth(&self) -> Option<Growth> {
        let shape = self.shape?;
        match self.kind.entry().shape {
            Shape::Growth(_) => {
                let time_constant_s = shape.abs().trunc();
                let second_s = (shape.abs().fract() * 1e6).round() / 1e3;
                let (delay_s, late_s) = if shape < 0.0 { (0.0, second_s) } else { (second_s, 0.0) };
                Some(Growth { time_constant_s, delay_s, late_s })
            }
            Shape::TimeConstant(_) => Some(Growth { time_constant_s: shape, delay_s: 0.0, late_s: 0.0 }),
            Shape::None
            | Shape::OnceOrTwice
            | Shape::Teeth
            | Shape::Limit
            | Shape::Moment
            | Shape::OneOf(_)
            | Shape::AnotherJoint => None,
        }
    }

    /// The shape of an eye that turns with this time constant and delay, s.
    pub fn yaw_growth(time_constant_s: f64, delay_s: f64) -> f64 {
        time_constant_s.round() + delay_s * 1e-3
    }

    /// The shape of an eye that turns with its housing, which has this time constant, and is heated by what has
    /// the second one, s.
    pub fn late_growth(time_constant_s: f64, late_s: f64) -> f64 {
        -Self::yaw_growth(time_constant_s, late_s)
    }
}

/// How something approaches its end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Growth {
    /// Time constant, s.
    pub time_constant_s: f64,
    /// Nothing happens before, s.
    pub delay_s: f64,
    /// Time constant of what heats it, and is heated itself, s; 0: it is heated at once.
    pub late_s: f64,
}

impl Growth {
    /// Part of the way after this time, s.
    pub fn share(&self, t_secs: f64) -> f64 {
        let t_secs = (t_secs - self.delay_s).max(0.0);
        let gone = |constant_s: f64| if constant_s > 0.0 { -(-t_secs / constant_s).exp_m1() } else { 1.0 };
        if self.late_s <= 0.0 {
            return gone(self.time_constant_s);
        }
        // Two that are alike are as good as two that hardly differ.
        let alike = (self.time_constant_s - self.late_s).abs() < 1e-3 * self.late_s;
        let late_s = if alike { 0.998 * self.late_s } else { self.late_s };
        // Two bodies in a row, each warmed by the one before.
        let weighted = self.time_constant_s * gone(self.time_constant_s) - late_s * gone(late_s);
        weighted / (self.time_constant_s - late_s)
    }
}

fn of_arm(kind: Kind, arm: &Arm) -> Vec<Effect> {
    let one = |site: &str| vec![Effect::new(kind, site, "", None)];
    match kind.entry().site {
        Site::Joint => joints(kind, arm),
        Site::JointBesideAnother => {
            let all = joints(kind, arm).into_iter().map(|effect| with_pullers(effect, arm));
            all.filter(|effect| !effect.pullers.is_empty()).collect()
        }
        Site::JointOrAllAlike => {
            let mut all = joints(kind, arm);
            all.push(Effect::new(kind, "", "all joints alike", None));
            all
        }
        Site::JointOrEvery(_) => {
            let (slides, turns): (Vec<_>, Vec<_>) =
                joints(kind, arm).into_iter().partition(|effect| effect.slides);
            [and_every(kind, "every joint", turns), slides].concat()
        }
        Site::Link => links(kind, arm),
        Site::LinkOrEvery(_) => and_every(kind, "every link", links(kind, arm)),
        Site::Tip | Site::Contact | Site::WholeArm => one("tip"),
        Site::Palm => one(arm.parts.last().map_or("tip", |part| part.link.as_str())),
        Site::Base => one("base"),
        Site::Screen => one("screen"),
        Site::OfEyes(_) => vec![],
    }
}

fn one_eye(kind: Kind) -> Vec<Effect> {
    vec![Effect::new(kind, RIGHT, "right eye", None), Effect::new(kind, LEFT, "left eye", None)]
}

fn of_eyes(kind: Kind, eyes: &Eyes) -> Vec<Effect> {
    let Site::OfEyes(site) = kind.entry().site else { return vec![] };
    match site {
        EyeSite::Neck => {
            let joints = eyes.neck.parts.iter().enumerate();
            joints.map(|(j, part)| Effect::new(kind, &part.joint, &part.title, Some(j))).collect()
        }
        EyeSite::Right => vec![Effect::new(kind, RIGHT, "", None)],
        EyeSite::Both => vec![Effect::new(kind, "eyes", "", None)],
        EyeSite::One => one_eye(kind),
        EyeSite::BothOrOne => [vec![Effect::new(kind, "eyes", "both eyes", None)], one_eye(kind)].concat(),
        // Which sets there are, only rows say.
        EyeSite::Set => vec![],
    }
}

/// These, and one effect for all of them.
fn and_every(kind: Kind, whose: &str, mut single: Vec<Effect>) -> Vec<Effect> {
    if (2..=MOST_MEMBERS).contains(&single.len()) {
        single.push(Effect { members: single.clone(), ..Effect::new(kind, "", whose, None) });
    }
    single
}

/// Joints of an arm.
fn joints(kind: Kind, arm: &Arm) -> Vec<Effect> {
    (0..arm.len())
        .filter(|&j| !arm.parts[j].slides || kind.entry().is(Is::OfSlides))
        .map(|j| {
            let part = &arm.parts[j];
            let across = Some(across(&part.axis));
            let slides = part.slides;
            Effect { across, slides, ..Effect::new(kind, &part.joint, &part.title, Some(j)) }
        })
        .collect()
}

/// With the joints that may pull its own along: the one before it first, of the first joint the one behind it. What
/// slides pulls no angle.
fn with_pullers(effect: Effect, arm: &Arm) -> Effect {
    let Some(j) = effect.joint else { return effect };
    let nearest = j.checked_sub(1).unwrap_or(j + 1);
    let others = (0..arm.len()).filter(|other| *other != j && *other != nearest);
    let pullers = std::iter::once(nearest)
        .chain(others)
        .filter_map(|place| Some((place, arm.parts.get(place).filter(|part| !part.slides)?)))
        .map(|(place, part)| Puller { place, joint: part.joint.clone(), title: part.title.clone() })
        .collect();
    Effect { pullers, ..effect }.with_shape(None)
}

/// Links between the joints of an arm; the way to the tip belongs to the tip's offset.
fn links(kind: Kind, arm: &Arm) -> Vec<Effect> {
    (1..arm.len())
        .filter(|&j| arm.parts[j].before.translation.vector.norm() > SHORTEST_LINK_M)
        .map(|j| {
            let link = &arm.parts[j - 1].link;
            Effect::new(kind, link, &link.replace('_', " "), Some(j))
        })
        .collect()
}

/// Two directions at right angles to an axis and to each other: those along which the values of an axis that
/// is not square are told, in the frame of its joint.
#[must_use]
pub fn across(axis: &Vector3<f64>) -> [Vector3<f64>; 2] {
    let start = Vector3::ith(axis.iamin(), 1.0);
    let a = axis.cross(&start).normalize();
    [a, axis.cross(&a)]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two bodies in a row: the step response of x'' with both time constants, against small steps.
    #[test]
    fn what_is_warmed_late_follows_two_bodies_in_a_row() {
        for (time_constant_s, late_s) in [(400.0, 60.0), (120.0, 120.0), (300.0, 0.0)] {
            let law = Growth { time_constant_s, delay_s: 0.0, late_s };
            let (mut inner, mut outer) = (if late_s > 0.0 { 0.0 } else { 1.0 }, 0.0);
            for step in 0..20_000 {
                let share = law.share(0.1 * f64::from(step));
                assert!((share - outer).abs() < 2e-3, "{law:?} after {step}: {share} {outer}");
                outer += 0.1 * (inner - outer) / time_constant_s;
                inner += if late_s > 0.0 { 0.1 * (1.0 - inner) / late_s } else { 0.0 };
            }
        }
        assert_eq!(Growth { time_constant_s: 0.0, delay_s: 0.0, late_s: 0.0 }.share(0.0), 1.0);
    }
}
