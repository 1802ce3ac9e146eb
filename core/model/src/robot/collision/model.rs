//! The bodies of a rig, which of them can meet, and one posture.

use std::sync::Arc;

use super::bodies::{Part, bit, joined, movers, parts, people_name, reach_m, surroundings};
use super::solid::Solid;
use crate::frame::{Point, Robot};
use crate::robot::{CoupledLimit, Description, JointIndex, Limits, LinkIndex, Posture, Rig};

/// Links nearer than this in the home pose count as in contact, m: the shapes are drawn no more
/// exactly.
const CONTACT_M: f64 = 0.003;

/// Something that can be run into.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Body {
    /// A link of the robot.
    Link(LinkIndex),
    /// The table.
    Table,
    /// The touchscreen, at its nominal place.
    Touchscreen,
    /// The height below which the rig allows nothing of an arm.
    Floor,
}

/// Two bodies that meet or nearly do, with names for people.
#[derive(Clone, Debug, PartialEq)]
pub struct Contact {
    /// One.
    pub a: Body,
    /// The other.
    pub b: Body,
    /// Name of one ("right lower arm").
    pub a_name: String,
    /// Name of the other ("table").
    pub b_name: String,
}

/// A contact that is wanted: a fingertip on the screen, a hand around an object on the table.
#[derive(Clone, Debug, PartialEq)]
pub struct Allowance {
    /// Links that may touch.
    pub links: Vec<LinkIndex>,
    /// What they may touch.
    pub body: Body,
    /// How deep the shapes may enter each other, m.
    pub depth_m: f64,
}

/// What a posture runs into.
#[derive(Clone, Debug, PartialEq)]
pub enum PostureCheck {
    /// Nothing.
    Clear {
        /// The smallest distance, m.
        smallest_m: f64,
        /// Between these.
        between: Contact,
    },
    /// Two bodies meet.
    Collides {
        /// The two that are deepest in each other.
        contact: Contact,
        /// How deep, m.
        depth_m: f64,
    },
}

/// Why nothing was checked.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CollisionError {
    /// A posture is not of this robot.
    #[error("the posture has {given} angles, the robot has {joints} joints: give one per joint")]
    Count {
        /// Angles given.
        given: usize,
        /// Joints of the robot.
        joints: usize,
    },
    /// A posture holds NaN.
    #[error("the posture holds a value that is not a number: read the joints again")]
    NotANumber,
}

/// The bodies of a rig. Made once, used for many checks.
#[derive(Clone, Debug)]
pub struct CollisionModel {
    pub(super) description: Arc<Description>,
    pub(super) coupled: Vec<CoupledLimit>,
    /// By movable joint.
    pub(super) limits: Vec<Limits>,
    parts: Vec<Part>,
    surroundings: Vec<(Body, Solid)>,
    pub(super) pairs: Vec<Pair>,
    always: Vec<Contact>,
    /// No point below a joint is farther than this from the joint's origin, m; by movable joint,
    /// joints that follow included.
    pub(super) reach_m: Vec<f64>,
}

/// Two bodies that can meet: a part, and another part or one of the surroundings.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pair {
    a: usize,
    b: Other,
    /// Joints that move one against the other, one bit each.
    pub moved_by: u128,
}

#[derive(Clone, Copy, Debug)]
enum Other {
    Part(usize),
    Surrounding(usize),
}

impl CollisionModel {
    /// The bodies of a rig.
    pub fn of_rig(rig: &Rig) -> Self {
        let description = rig.description.clone();
        let parts = parts(&description);
        let surroundings = surroundings(rig);
        let movers: Vec<u128> =
            (0..description.links().len()).map(|link| movers(&description, LinkIndex(link))).collect();
        let bits = |joints: &[JointIndex]| joints.iter().fold(0, |bits, joint| bits | bit(*joint));
        let hands: Vec<u128> = rig.arms.iter().map(|arm| bits(&arm.hand)).collect();
        let mut pairs = vec![];
        for (a, part) in parts.iter().enumerate() {
            for (b, other) in parts.iter().enumerate().skip(a + 1) {
                let moved_by = movers[part.link.0] ^ movers[other.link.0];
                // Fingers are made to meet each other and the palm.
                let within_hand = hands.iter().any(|hand| moved_by & !hand == 0);
                if moved_by != 0 && !within_hand && !joined(&description, part.link, other.link) {
                    pairs.push(Pair { a, b: Other::Part(b), moved_by });
                }
            }
            if movers[part.link.0] != 0 {
                let moved_by = movers[part.link.0];
                pairs.extend((0..surroundings.len()).map(|b| Pair { a, b: Other::Surrounding(b), moved_by }));
            }
        }
        let reach_m = reach_m(&description);
        let coupled = rig.coupled_limits.clone();
        let limits = (0..description.movable_count()).map(|joint| rig.limits(JointIndex(joint))).collect();
        let mut model =
            Self { description, coupled, limits, parts, surroundings, pairs, always: vec![], reach_m };
        model.leave_out_contacts_of(&rig.home());
        model
    }

    /// The same robot among the surroundings of this rig.
    pub fn among(&self, rig: &Rig) -> Self {
        Self { surroundings: surroundings(rig), ..self.clone() }
    }

    /// Pairs of links that meet in the home pose, or nearly, and are therefore never compared.
    pub fn always_in_contact(&self) -> &[Contact] {
        &self.always
    }

    /// Name of a body for people.
    pub fn name(&self, body: Body) -> String {
        match body {
            Body::Link(link) => people_name(&self.description.links()[link.0].name),
            Body::Table => "table".to_owned(),
            Body::Touchscreen => "touchscreen".to_owned(),
            Body::Floor => "lowest height allowed".to_owned(),
        }
    }

    /// Links that hang below a link, itself included.
    pub fn links_from(&self, link: LinkIndex) -> Vec<LinkIndex> {
        let mut found = vec![link];
        for (i, other) in self.description.links().iter().enumerate() {
            if other.parent.is_some_and(|parent| found.contains(&parent)) {
                found.push(LinkIndex(i));
            }
        }
        found
    }

    /// Links that a joint moves: the hand, for the last joint of an arm.
    pub fn links_moved_by(&self, joint: JointIndex) -> Vec<LinkIndex> {
        self.links_from(self.description.joint(joint).child)
    }

    /// What a posture runs into; contacts inside of the allowances do not count.
    ///
    /// # Errors
    /// When the posture is not of this robot or not a number.
    pub fn check_posture(
        &self,
        posture: &Posture,
        allowances: &[Allowance],
    ) -> Result<PostureCheck, CollisionError> {
        self.accept(posture)?;
        let all: Vec<usize> = (0..self.pairs.len()).collect();
        let worst = self.worst(&self.solids(posture), &all, &self.allowed_m(&all, allowances));
        let Some(worst) = worst else {
            // A robot without shapes meets nothing.
            let body = Body::Floor;
            let between = Contact { a: body, b: body, a_name: self.name(body), b_name: self.name(body) };
            return Ok(PostureCheck::Clear { smallest_m: f64::INFINITY, between });
        };
        let contact = self.contact(worst.pair);
        Ok(if worst.collides {
            PostureCheck::Collides { contact, depth_m: -worst.distance_m }
        } else {
            PostureCheck::Clear { smallest_m: worst.distance_m, between: contact }
        })
    }

    /// Which body contains a point, and how deep (m). Links that the chain moves do not count: they
    /// will be elsewhere when its tip is there.
    pub fn body_around(
        &self,
        point: Point<Robot>,
        posture: &Posture,
        chain: &[JointIndex],
    ) -> Option<(Body, f64)> {
        let moving = chain.iter().fold(0, |bits, joint| bits | bit(*joint));
        let point = Solid::point(point.coords);
        let links = self.parts.iter().zip(self.solids(posture));
        let still = links
            .filter(|(part, _)| movers(&self.description, part.link) & moving == 0)
            .map(|(part, solid)| (Body::Link(part.link), solid));
        still
            .chain(self.surroundings.iter().copied())
            .map(|(body, solid)| (body, -solid.distance_m(&point)))
            .filter(|(_, depth_m)| *depth_m > 1e-9)
            .max_by(|a, b| a.1.total_cmp(&b.1))
    }

    pub(in crate::robot) fn accept(&self, posture: &Posture) -> Result<(), CollisionError> {
        let joints = self.description.movable_count();
        if posture.len() != joints {
            return Err(CollisionError::Count { given: posture.len(), joints });
        }
        if !posture.is_finite() {
            return Err(CollisionError::NotANumber);
        }
        Ok(())
    }

    /// All parts at their places.
    pub(super) fn solids(&self, posture: &Posture) -> Vec<Solid> {
        let links = self.description.forward(posture);
        let solid = |part: &Part| Solid::new(&part.shape, &(links.all()[part.link.0] * part.link_from_shape));
        self.parts.iter().map(solid).collect()
    }

    /// How deep each of some pairs may be in contact, m.
    pub(super) fn allowed_m(&self, pairs: &[usize], allowances: &[Allowance]) -> Vec<f64> {
        let allowed = |k: &usize| {
            let (a, b) = self.bodies(*k);
            let fits = |allowance: &&Allowance| {
                let one = |link: Body, other: Body| {
                    other == allowance.body && matches!(link, Body::Link(l) if allowance.links.contains(&l))
                };
                one(a, b) || one(b, a)
            };
            allowances.iter().filter(fits).map(|allowance| allowance.depth_m).fold(0.0, f64::max)
        };
        pairs.iter().map(allowed).collect()
    }

    /// The pair that collides most, or else the nearest one. Pairs within their allowance count
    /// as neither.
    pub(super) fn worst(&self, solids: &[Solid], pairs: &[usize], allowed_m: &[f64]) -> Option<Worst> {
        let mut worst: Option<Worst> = None;
        for (k, allowed_m) in pairs.iter().zip(allowed_m) {
            let (a, b) = self.pair_solids(*k, solids);
            if worst.is_some_and(|worst| a.least_distance_m(b) > worst.distance_m) {
                continue;
            }
            let distance_m = a.distance_m(b);
            if distance_m <= 0.0 && distance_m >= -allowed_m {
                continue;
            }
            if worst.is_none_or(|worst| distance_m < worst.distance_m) {
                worst = Some(Worst { pair: *k, distance_m, collides: distance_m < 0.0 });
            }
        }
        worst
    }

    /// Distance of one pair, m.
    pub(super) fn distance_m(&self, pair: usize, solids: &[Solid]) -> f64 {
        let (a, b) = self.pair_solids(pair, solids);
        a.distance_m(b)
    }

    pub(super) fn contact(&self, pair: usize) -> Contact {
        let (a, b) = self.bodies(pair);
        Contact { a, b, a_name: self.name(a), b_name: self.name(b) }
    }

    fn pair_solids<'a>(&'a self, pair: usize, solids: &'a [Solid]) -> (&'a Solid, &'a Solid) {
        let pair = &self.pairs[pair];
        let other = match pair.b {
            Other::Part(b) => &solids[b],
            Other::Surrounding(b) => &self.surroundings[b].1,
        };
        (&solids[pair.a], other)
    }

    fn bodies(&self, pair: usize) -> (Body, Body) {
        let pair = &self.pairs[pair];
        let other = match pair.b {
            Other::Part(b) => Body::Link(self.parts[b].link),
            Other::Surrounding(b) => self.surroundings[b].0,
        };
        (Body::Link(self.parts[pair.a].link), other)
    }

    fn leave_out_contacts_of(&mut self, home: &Posture) {
        let solids = self.solids(home);
        let mut always: Vec<Contact> = vec![];
        for k in 0..self.pairs.len() {
            let contact = self.contact(k);
            // The surroundings are never left out: a home pose in the table is a mistake.
            let links = matches!(contact.b, Body::Link(_));
            if links && self.distance_m(k, &solids) < CONTACT_M && !always.contains(&contact) {
                always.push(contact);
            }
        }
        let kept = (0..self.pairs.len()).filter(|k| !always.contains(&self.contact(*k)));
        self.pairs = kept.map(|k| self.pairs[k]).collect();
        self.always = always;
    }
}

/// A pair, its distance, and whether it is deeper than allowed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Worst {
    pub pair: usize,
    pub distance_m: f64,
    pub collides: bool,
}
