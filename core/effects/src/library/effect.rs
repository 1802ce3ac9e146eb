//! Effects at their sites.

use nalgebra::Vector3;

use super::kind::YAW_WARM_UP;
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
    /// A joint, a link, `tip`, `base`, `screen`, `eyes`, `right`; empty: all joints alike.
    pub site: String,
    /// What it is and where, for people.
    pub title: String,
    /// What does not enter the prediction linearly, by kind; `None` where there is no such thing:
    ///
    /// - joint-eccentricity, tooth-ripple: periods per turn (`None`: one);
    /// - servo-warm-up, creep: time constant, s;
    /// - slipped-horn, screen-bumped: moment, s;
    /// - torque-limit: largest torque that is held, N m;
    /// - eye-yaw: `None` is constant, else it grows with time: see [`Self::growth_s`];
    /// - focal-or-baseline: `None` is the focal length, 1 the baseline.
    pub shape: Option<f64>,
    /// Between which shapes the true one lies, as far as the grid of candidates tells.
    pub shape_range: Option<[f64; 2]>,
    /// Place of the joint in the arm (or neck), for effects of one joint or link.
    pub(super) joint: Option<usize>,
    /// Two directions across the axis, own frame, for a skewed axis.
    pub(crate) across: Option<[Vector3<f64>; 2]>,
    /// The joint that pulls this one along.
    pub(super) partner: Option<String>,
    /// Not one effect but one of this kind at every site, each with its own values: a robot that
    /// was put together by hand has every zero off. Parameters are theirs in turn.
    pub(super) members: Vec<Effect>,
}

/// At most so many joints have their effects in one.
const MOST_MEMBERS: usize = 12;

impl Effect {
    /// Every effect that a plan of touches is scored by, at every site of an arm.
    pub fn all(arm: &Arm) -> Vec<Self> {
        Kind::OF_PLANS
            .into_iter()
            .flat_map(|kind| Self::sites(kind, Some(arm), None))
            .filter(|effect| !effect.site.is_empty())
            .collect()
    }

    /// A kind of effect at every site that an arm or eyes offer, in its first shape.
    pub fn sites(kind: Kind, arm: Option<&Arm>, eyes: Option<&Eyes>) -> Vec<Self> {
        if kind.is_of_eyes() {
            eyes.map_or(vec![], |eyes| of_eyes(kind, eyes))
        } else {
            arm.map_or(vec![], |arm| of_arm(kind, arm))
        }
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
        let found =
            Self::sites(Kind::of_id(id)?, arm, eyes).into_iter().find(|effect| effect.site == site)?;
        Some(found.with_shape(shape))
    }

    /// The same in another shape.
    pub fn with_shape(mut self, shape: Option<f64>) -> Self {
        self.shape = shape;
        self.shape_range = None;
        self
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
            joint,
            across: None,
            partner: None,
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
            return &self.kind.parameters_of_many()[..count];
        }
        match (self.kind, self.shape) {
            (Kind::EyeYaw, Some(_)) => YAW_WARM_UP,
            _ => self.kind.parameters(),
        }
    }

    /// Whether it stands for one of its kind at every site, each with its own values.
    pub fn is_of_every_site(&self) -> bool {
        !self.members.is_empty()
    }

    /// Time constant and delay (s) of what grows as 1 − exp(−(t − delay)/time constant). The shape
    /// of a growing [`Kind::EyeYaw`] holds both: whole seconds of the time constant, and the delay
    /// in thousandths of its seconds after the point (240.06: 240 s, after 60 s).
    pub fn growth_s(&self) -> Option<(f64, f64)> {
        let shape = self.shape?;
        match self.kind {
            Kind::EyeYaw => Some((shape.trunc(), (shape.fract() * 1e6).round() / 1e3)),
            Kind::ServoWarmUp | Kind::Creep => Some((shape, 0.0)),
            _ => None,
        }
    }

    /// The shape of an eye that turns with this time constant and delay, s.
    pub fn yaw_growth(time_constant_s: f64, delay_s: f64) -> f64 {
        time_constant_s.round() + delay_s * 1e-3
    }
}

fn of_arm(kind: Kind, arm: &Arm) -> Vec<Effect> {
    if kind.is_of_joint() {
        // The first joint has none before it.
        let first = usize::from(kind == Kind::JointCoupling);
        let single = (first..arm.len()).map(|joint| {
            let part = &arm.parts[joint];
            let mut effect = Effect::new(kind, &part.joint, &part.title, Some(joint));
            match kind {
                Kind::AxisSkew => effect.across = Some(across(&part.axis)),
                Kind::JointCoupling => effect.partner = Some(arm.parts[joint - 1].joint.clone()),
                _ => {}
            }
            effect
        });
        let shared = kind.is_shared().then(|| Effect::new(kind, "", "all joints alike", None));
        let single: Vec<Effect> = single.collect();
        let every = every(kind, "every joint", &single);
        return single.into_iter().chain(shared).chain(every).collect();
    }
    match kind {
        Kind::LinkLength => {
            let single: Vec<Effect> = links(kind, arm).collect();
            let every = every(kind, "every link", &single);
            single.into_iter().chain(every).collect()
        }
        Kind::LinkBending => links(kind, arm).collect(),
        Kind::TipOffset | Kind::FingerRoll | Kind::TouchDrag | Kind::FingerBend | Kind::SpeedOvershoot => {
            vec![Effect::new(kind, "tip", "", None)]
        }
        Kind::PayloadMass => {
            let palm = arm.parts.last().map_or("tip", |part| part.link.as_str());
            vec![Effect::new(kind, palm, "", None)]
        }
        Kind::BaseTilt | Kind::TorsoLean => vec![Effect::new(kind, "base", "", None)],
        _ => vec![Effect::new(kind, "screen", "", None)],
    }
}

fn of_eyes(kind: Kind, eyes: &Eyes) -> Vec<Effect> {
    match kind {
        Kind::HeadJoint => {
            let joints = eyes.neck.parts.iter().enumerate();
            joints.map(|(j, part)| Effect::new(kind, &part.joint, &part.title, Some(j))).collect()
        }
        Kind::EyeYaw | Kind::ImageShift | Kind::EyeRoll => vec![Effect::new(kind, "right", "", None)],
        _ => vec![Effect::new(kind, "eyes", "", None)],
    }
}

/// One effect for all of these, for kinds that come at every site at once when an arm is put
/// together.
fn every(kind: Kind, whose: &str, single: &[Effect]) -> Option<Effect> {
    let at_once = matches!(kind, Kind::JointZero | Kind::AxisSkew | Kind::LinkLength);
    (at_once && (2..=MOST_MEMBERS).contains(&single.len()))
        .then(|| Effect { members: single.to_vec(), ..Effect::new(kind, "", whose, None) })
}

/// Links between the joints of an arm; the way to the tip belongs to the tip's offset.
fn links(kind: Kind, arm: &Arm) -> impl Iterator<Item = Effect> {
    (1..arm.len()).filter(|&j| arm.parts[j].before.translation.vector.norm() > SHORTEST_LINK_M).map(
        move |j| {
            let link = &arm.parts[j - 1].link;
            Effect::new(kind, link, &link.replace('_', " "), Some(j))
        },
    )
}

/// Two directions at right angles to an axis and to each other.
fn across(axis: &Vector3<f64>) -> [Vector3<f64>; 2] {
    let start = Vector3::ith(axis.iamin(), 1.0);
    let a = axis.cross(&start).normalize();
    [a, axis.cross(&a)]
}
