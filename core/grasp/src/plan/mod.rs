//! From the place of an object to the postures that grasp it: how the hand comes, where it closes,
//! and free ways there and up again.

mod beside;
mod fingers;
mod headed;
mod lifted;
mod lowered;
mod standing;
mod ways;

use std::f64::consts::PI;

use nalgebra::Vector3;
use plumbline_model::robot::Posture;
use plumbline_model::robot::collision::{Allowance, Body, CollisionError, CollisionModel};
use plumbline_model::{Point, Robot};

use crate::arm::PalmArm;
use crate::hands::Hand;

pub use beside::Beside;
pub use headed::Headed;
pub use standing::Standing;

/// The palm waits this high above where it closes, m; lower where the arm does not get so high.
const ABOVE_M: [f64; 3] = [0.09, 0.07, 0.05];
/// It lifts this high, m.
const LIFT_M: f64 = 0.10;
/// Postures on the way down are this far apart, m.
const STEP_M: f64 = 0.01;
/// Headings that are tried, rad apart.
const HEADING_STEP_RAD: f64 = PI / 18.0;
/// Headings of a right hand over a table: from pointing to the right to pointing left and back; those of a
/// left hand are their mirror images.
const HEADINGS_RAD: [f64; 2] = [-0.6 * PI, 0.9 * PI];
/// A palm inclined farther than this (cosine) does not close around things.
const LEAST_LEVEL: f64 = 0.6;
/// More level than this (cosine) makes no difference.
const LEVEL_ENOUGH: f64 = 0.97;
/// How a palm is turned and where it belongs depend on each other: so many times, until it is this near, m.
const TURNS: usize = 6;
const TURNED_M: f64 = 0.0005;
/// A way with less room than this between any two bodies, m, counts as this much more turning, rad.
const ROOM_M: f64 = 0.008;
const CRAMPED_RAD: f64 = 2.0;

/// The table stands where it is described to within so much at the most, to each side and in height, m: a
/// forearm that would pass its edge by less may meet it. The hand itself goes by what the eyes see.
const TABLE_OFF_M: f64 = 0.015;

/// Why a grasp cannot be made. Reads as a sentence.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NoPlan {
    /// The hand does not get there.
    #[error(
        "the hand does not reach x {:.0}, y {:.0} mm with its palm down: put the object nearer to the middle of the table",
        .xy_m[0] * 1e3, .xy_m[1] * 1e3
    )]
    OutOfReach {
        /// Where the object is, m.
        xy_m: [f64; 2],
    },
    /// No way there is free.
    #[error("no way to above the object is free ({0}): move the arm by hand or take away what is in the way")]
    NotFree(String),
    /// A posture is no posture of this robot.
    #[error(transparent)]
    Posture(#[from] CollisionError),
}

/// A grasp that was looked at before anything moves.
#[derive(Clone, Debug, PartialEq)]
pub struct GraspPlan {
    /// With which hand.
    pub hand: Hand,
    /// What is to be grasped.
    pub standing: Standing,
    /// Azimuth of the fingers, rad.
    pub heading_rad: f64,
    /// Cosine of the palm's inclination where it closes.
    pub level: f64,
    /// Where the real palm belongs when the hand closes, robot frame, m.
    pub palm_m: Vector3<f64>,
    /// On the way to above the object, that posture last.
    pub approach: Vec<Posture>,
    /// From above down to where the hand closes, the first a step below `above`.
    pub down: Vec<Posture>,
    /// How far joints turn on the way down and up, rad; a cramped way counts as turning more.
    pub effort_rad: f64,
}

impl GraspPlan {
    /// How level the palm is where it closes, where more makes no difference the least that does not.
    pub fn capped_level(&self) -> f64 {
        self.level.min(LEVEL_ENOUGH)
    }

    /// The posture above the object.
    pub fn above(&self) -> Option<&Posture> {
        self.approach.last()
    }

    /// The posture in which the hand closes.
    pub fn closing(&self) -> Option<&Posture> {
        self.down.last().or(self.above())
    }

    /// The way from above the object down to so high (m) over where the hand closes, and the grasp from
    /// there.
    pub fn from_low(&self, over_m: f64) -> (Vec<Posture>, Self) {
        let rest = ((over_m / STEP_M).round() as usize).min(self.down.len());
        let (way, down) = self.down.split_at(self.down.len() - rest);
        let approach = if way.is_empty() { self.approach.clone() } else { way.to_vec() };
        (way.to_vec(), Self { approach, down: down.to_vec(), ..self.clone() })
    }
}

/// The robot before a table that stands as far off as tables do.
fn at_a_larger_table(arm: &PalmArm) -> (CollisionModel, Allowance) {
    let mut rig = (**arm.rig()).clone();
    let table = &mut rig.table;
    table.height_m += TABLE_OFF_M;
    for range_m in [&mut table.x_range_m, &mut table.y_range_m] {
        *range_m = [range_m[0] - TABLE_OFF_M, range_m[1] + TABLE_OFF_M];
    }
    let bodies = CollisionModel::of_rig(&rig);
    let links = arm.joints().last().map_or_else(Vec::new, |wrist| bodies.links_moved_by(*wrist));
    // All of the hand may go on as at the table that is described.
    let hand = Allowance { links, body: Body::Table, depth_m: f64::INFINITY };
    (bodies, hand)
}

/// Above what stands somewhere, and down.
struct WayDown {
    palm_m: Vector3<f64>,
    above: Posture,
    down: Vec<Posture>,
    level: f64,
}

/// Plans grasps of one hand.
#[derive(Clone, Debug)]
pub struct GraspPlanner {
    arm: PalmArm,
    bodies: CollisionModel,
    /// The same with a table that is larger and higher by [`TABLE_OFF_M`], and what the hand may do there.
    at_a_larger_table: (CollisionModel, Allowance),
    /// What is left as it is.
    others: Vec<Beside>,
}

impl GraspPlanner {
    /// For a hand as a model has it.
    pub fn new(arm: PalmArm) -> Self {
        let bodies = CollisionModel::of_rig(arm.rig());
        let at_a_larger_table = at_a_larger_table(&arm);
        Self { arm, bodies, at_a_larger_table, others: vec![] }
    }

    /// The hand.
    pub fn arm(&self) -> &PalmArm {
        &self.arm
    }

    /// The grasp of what stands somewhere, by an arm that stands at `from`; `sent` shifts every point
    /// to which the palm is sent (m), as a correction of the published kind does. What it leaves as it is
    /// ([`Self::leave`]) it touches only where there is no other way.
    ///
    /// # Errors
    /// Why it cannot be made.
    pub fn plan(
        &self,
        standing: &Standing,
        shift_m: &Vector3<f64>,
        from: &Posture,
    ) -> Result<GraspPlan, NoPlan> {
        let leaves = if self.others.is_empty() { &[false][..] } else { &[true, false] };
        let mut barred = None;
        for leaves in leaves {
            for above_m in ABOVE_M {
                match self.plan_from(above_m, standing, shift_m, from, *leaves) {
                    Ok(plan) => return Ok(plan),
                    Err(why) => barred = barred.or(Some(why)),
                }
            }
        }
        Err(barred.unwrap_or(NoPlan::OutOfReach { xy_m: standing.xy_m }))
    }

    /// The same for a palm that waits so high above where it closes.
    fn plan_from(
        &self,
        above_m: f64,
        standing: &Standing,
        shift_m: &Vector3<f64>,
        from: &Posture,
        leaves: bool,
    ) -> Result<GraspPlan, NoPlan> {
        let open = self.open(from);
        let mut ways: Vec<(f64, f64, WayDown)> = vec![];
        let steps = ((HEADINGS_RAD[1] - HEADINGS_RAD[0]) / HEADING_STEP_RAD).round() as usize;
        for step in 0..=steps {
            let heading_rad = HEADINGS_RAD[0] + step as f64 * HEADING_STEP_RAD;
            let heading_rad = if self.arm.is_left() { -heading_rad } else { heading_rad };
            if let Some(way) = self.way_to(above_m, standing, heading_rad, shift_m, &open) {
                ways.push((way.level, heading_rad, way));
            }
        }
        ways.retain(|(level, ..)| *level >= LEAST_LEVEL);
        // Level counts; of what is level enough that which turns least on its way down and up again: an
        // arm that has to turn much shakes what it holds.
        ways.sort_by(|a, b| b.0.min(LEVEL_ENOUGH).total_cmp(&a.0.min(LEVEL_ENOUGH)));
        let out_of_reach = NoPlan::OutOfReach { xy_m: standing.xy_m };
        let (mut why, mut best): (_, Option<(f64, GraspPlan)>) = (None, None);
        for (level, heading_rad, way) in ways {
            if best.as_ref().is_some_and(|(_, best)| best.level >= LEVEL_ENOUGH && level < LEVEL_ENOUGH) {
                break;
            }
            let WayDown { palm_m, above, down, .. } = way;
            if leaves && self.meets_others(&down) {
                continue;
            }
            let free = self.room(&above, &down).and_then(|room_m| Ok((room_m, self.free_way(from, &above)?)));
            match free {
                Ok((room_m, approach)) => {
                    let cost = turn_rad(&above, &down)
                        + CRAMPED_RAD * f64::from(room_m < ROOM_M)
                        + CRAMPED_RAD * f64::from(self.may_meet_table(&above, &down)?);
                    if best.as_ref().is_none_or(|(least, _)| cost < *least) {
                        let standing = *standing;
                        best = Some((
                            cost,
                            GraspPlan {
                                hand: self.arm.which(),
                                standing,
                                heading_rad,
                                level,
                                palm_m,
                                approach,
                                down,
                                effort_rad: cost,
                            },
                        ));
                    }
                }
                Err(barred) => why = why.or(Some(barred)),
            }
        }
        if let Some((_, plan)) = best {
            return Ok(plan);
        }
        Err(why.unwrap_or(out_of_reach))
    }

    /// The same grasp from above the object with the palm sent elsewhere.
    ///
    /// # Errors
    /// When the hand does not get there.
    pub fn again(&self, plan: &GraspPlan, shift_m: &Vector3<f64>) -> Result<GraspPlan, NoPlan> {
        let out_of_reach = NoPlan::OutOfReach { xy_m: plan.standing.xy_m };
        let start = plan.above().ok_or_else(|| out_of_reach.clone())?;
        let mut why = None;
        for above_m in ABOVE_M {
            let Some(way) = self.way_to(above_m, &plan.standing, plan.heading_rad, shift_m, start) else {
                continue;
            };
            let WayDown { palm_m, above, down, level } = way;
            match self.room(&above, &down) {
                Ok(_) => return Ok(GraspPlan { level, palm_m, approach: vec![above], down, ..plan.clone() }),
                Err(barred) => why = why.or(Some(barred)),
            }
        }
        Err(why.unwrap_or(out_of_reach))
    }

    /// Straight up (down where `by_m` is negative) as far as the arm gets, fingers as they are.
    pub fn vertical(&self, heading_rad: f64, from: &Posture, by_m: f64) -> Vec<Posture> {
        let start = self.arm.palm(from).coords;
        let steps = (by_m.abs() / STEP_M).round().max(1.0) as usize;
        let mut way: Vec<Posture> = vec![];
        for step in 1..=steps {
            let next = Point::from(start + Vector3::z() * (by_m * step as f64 / steps as f64));
            match self.arm.next_to(next, heading_rad, way.last().unwrap_or(from)) {
                Some(next) => way.push(next),
                None => break,
            }
        }
        way
    }

    /// The way down onto what stands somewhere; a palm that cannot be level comes from where it is
    /// turned to.
    fn way_to(
        &self,
        above_m: f64,
        standing: &Standing,
        heading_rad: f64,
        shift_m: &Vector3<f64>,
        open: &Posture,
    ) -> Option<WayDown> {
        let mut palm = standing.palm(heading_rad, self.arm.is_left());
        for _ in 0..TURNS {
            let (above, down) =
                self.way_down(above_m, Point::from(palm.coords + shift_m), heading_rad, open)?;
            let turn = self.arm.robot_from_palm(down.last()?).isometry.rotation;
            let turned = standing.palm_turned(&turn, self.arm.is_left());
            if turned.distance_m(&palm) < TURNED_M {
                let level = self.arm.level(down.last()?);
                return Some(WayDown { palm_m: palm.coords.coords, above, down, level });
            }
            palm = turned;
        }
        None
    }

    fn way_down(
        &self,
        above_m: f64,
        palm: Point<Robot>,
        heading_rad: f64,
        open: &Posture,
    ) -> Option<(Posture, Vec<Posture>)> {
        let at = |height_m: f64| Point::from(palm.coords + Vector3::z() * height_m);
        let above = self.arm.sent_to(at(above_m), heading_rad, open)?;
        let steps = (above_m / STEP_M).round() as usize;
        let mut down: Vec<Posture> = vec![];
        for step in (0..steps).rev() {
            let next = self.arm.next_to(
                at(above_m * step as f64 / steps as f64),
                heading_rad,
                down.last().unwrap_or(&above),
            )?;
            down.push(next);
        }
        Some((above, down))
    }
}

/// The largest turns of a joint on a way, added up, rad.
fn turn_rad(above: &Posture, down: &[Posture]) -> f64 {
    let before = std::iter::once(above).chain(down);
    before.zip(down).map(|(before, next)| before.distance_rad(next)).sum()
}
