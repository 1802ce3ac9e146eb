//! Ways to above a target and down that nothing is in.

use nalgebra::Vector3;
use plumbline_model::Pixel;
use plumbline_model::Point;
use plumbline_model::robot::Posture;
use plumbline_model::robot::collision::{Allowance, BesideModel, PathCheck, PostureCheck};
use plumbline_model::robot::ik::{Options, Target};
use plumbline_model::session::Screen;

use super::no_way::{Barred, NoWay};
use super::path::ABOVE_MEASURED_M;
use super::planner::Planner;

/// On the way from target to target the tip comes lower than where it waits by no more than this, m.
const DIP_M: f64 = 0.02;
/// A way that is not free goes over a place this much higher, m.
const RAISE_M: f64 = 0.06;
/// Fingers that are farther from the pointing pose are brought there first, rad.
const POINTING_RAD: f64 = 0.05;
/// Places looked at along a way.
const SAMPLES: usize = 16;

/// What may be met, and where it lies for the arm as it is described.
pub(super) struct Around {
    pub(super) bodies: BesideModel,
    /// What may meet while the finger is lowered.
    pub(super) allowances: Vec<Allowance>,
    /// Higher than where it really lies by so much, m.
    pub(super) up_m: f64,
}

/// A way down.
pub(super) struct Lowering {
    /// From above to the lowest, a few millimeters apart.
    pub(super) postures: Vec<Posture>,
    /// So many of the first ones are higher than the tip has to wait.
    pub(super) dispensable: usize,
}

/// A way to above a target and down that nothing is in.
pub(super) struct FreeWay {
    pub(super) lowering: Vec<Posture>,
    pub(super) approach: Vec<Posture>,
    pub(super) turns_rad: Vec<f64>,
}

impl Planner {
    /// The way down from as high as it is free, and a free way to there.
    pub(super) fn highest_free(
        &self,
        target: Pixel<Screen>,
        from: &Posture,
        down: Lowering,
        around: &Around,
    ) -> Result<FreeWay, NoWay> {
        let Lowering { postures, dispensable } = down;
        let mut refused = Err(NoWay::NotANumber);
        let mut tried = None;
        for skip in [0, dispensable / 2, dispensable] {
            if tried.replace(skip) == Some(skip) {
                continue;
            }
            let lowering = &postures[skip..];
            let free = self
                .check_lowering(target, lowering, around)
                .and_then(|()| self.approach(target, from, &lowering[0], around));
            match free {
                Ok((approach, turns_rad)) => {
                    return Ok(FreeWay { lowering: lowering.to_vec(), approach, turns_rad });
                }
                Err(why) => refused = Err(why),
            }
        }
        // Another target or a smaller area would be refused like this one.
        self.others_stand_free(from, around)?;
        refused
    }

    /// What this arm does not move meets nothing: the arm itself is thought away, at home.
    fn others_stand_free(&self, from: &Posture, around: &Around) -> Result<(), NoWay> {
        let standing = from.with(&self.joints, &self.rig.home().of(&self.joints));
        match around.bodies.check_posture(&standing, &around.allowances)? {
            PostureCheck::Collides { contact, .. } => {
                Err(NoWay::InTheWay { a: contact.a_name, b: contact.b_name })
            }
            _ => Ok(()),
        }
    }

    /// Nothing but the finger touches, and nothing but the screen.
    fn check_lowering(
        &self,
        target: Pixel<Screen>,
        lowering: &[Posture],
        around: &Around,
    ) -> Result<(), NoWay> {
        for posture in lowering.iter().rev().step_by(3).chain([&lowering[0]]) {
            let found = around.bodies.check_posture(posture, &around.allowances)?;
            if let PostureCheck::Collides { contact, .. } = found {
                return Err(NoWay::Meets { target, a: contact.a_name, b: contact.b_name });
            }
        }
        Ok(())
    }

    /// A free way of the arm to its home pose, from wherever it waits above the screen; `beside_m` is what it is
    /// sent beside the place where its hand ends, m.
    ///
    /// # Errors
    /// When something bars every way.
    pub fn away(&self, from: &Posture, beside_m: Vector3<f64>) -> Result<Vec<Posture>, NoWay> {
        if !from.is_finite() {
            return Err(NoWay::NotANumber);
        }
        let around = self.nothing_met(beside_m);
        let home = from.with(&self.joints, &self.rig.home().of(&self.joints));
        let mut barred = None;
        for way in self.ways(from, &home) {
            let starts = std::iter::once(from).chain(&way);
            match starts.zip(&way).try_for_each(|(from, to)| self.leg(from, to, &around)) {
                Ok(()) => return Ok(way),
                Err(reason) => drop(barred.get_or_insert(reason)),
            }
        }
        Err(NoWay::NotAway { leg: barred.unwrap_or(Barred::NoWay) })
    }

    /// A free way to the posture above the target, and the largest turn of each of its legs.
    fn approach(
        &self,
        target: Pixel<Screen>,
        from: &Posture,
        above: &Posture,
        around: &Around,
    ) -> Result<(Vec<Posture>, Vec<f64>), NoWay> {
        let mut barred = None;
        for way in self.ways(from, above) {
            let mut legs = vec![];
            let mut before = from;
            for next in &way {
                legs.push(before.distance_rad(next));
                match self.leg(before, next, around) {
                    Ok(()) => before = next,
                    Err(reason) => {
                        barred.get_or_insert(reason);
                        legs.clear();
                        break;
                    }
                }
            }
            if !legs.is_empty() {
                return Ok((way, legs));
            }
        }
        Err(NoWay::NotFree { target, leg: barred.unwrap_or(Barred::NoWay) })
    }

    /// Ways to try, the shortest first.
    fn ways(&self, from: &Posture, above: &Posture) -> Vec<Vec<Posture>> {
        let ready = self.ready(from);
        let points = self.hand.iter().all(|joint| (from[*joint] - ready[*joint]).abs() < POINTING_RAD);
        let mut ways = vec![];
        if points {
            ways.push(vec![above.clone()]);
            let (start, end) = (self.tip(from).coords, self.tip(above).coords);
            for (fraction, raise_m) in [(0.5, RAISE_M), (0.0, RAISE_M), (1.0, RAISE_M), (0.5, 2.0 * RAISE_M)]
            {
                let mut via = start + (end - start) * fraction;
                via.z = start.z.max(end.z) + raise_m;
                let (near, target) = (from.toward(above, fraction), Target::Position(Point::from(via)));
                let options = Options { other_starts: 0, ..Options::default() };
                if let Ok(answer) = self.solver.solve_from(&target, &near, &options)
                    && answer.is_reached()
                {
                    ways.push(vec![near.with(self.solver.joints(), &answer.best().joints), above.clone()]);
                }
            }
        }
        // The rest of the way the middle of the screen is above everything.
        let middle = above.with(self.solver.joints(), &self.middle.of(self.solver.joints()));
        let high = ready.toward(&middle, 0.5);
        ways.push(vec![ready.clone(), above.clone()]);
        ways.push(vec![ready.clone(), high.clone(), above.clone()]);
        ways.push(vec![ready, high, middle, above.clone()]);
        ways
    }

    fn leg(&self, from: &Posture, to: &Posture, around: &Around) -> Result<(), Barred> {
        let corners = self.rig.touchscreen.corners();
        let glass_m = corners.iter().map(|corner| corner.coords.z + around.up_m).fold(0.0, f64::max);
        let lower_end_m = self.tip(from).coords.z.min(self.tip(to).coords.z);
        // Where the arm does not get as high as it should wait, it keeps what it can.
        let clearance_m = (lower_end_m - glass_m).clamp(ABOVE_MEASURED_M, self.above_m) - DIP_M;
        let least_m = (glass_m + clearance_m).min(lower_end_m - 1e-4);
        for sample in 1..SAMPLES {
            let height_m = self.tip(&from.toward(to, sample as f64 / SAMPLES as f64)).coords.z;
            if height_m < least_m {
                return Err(Barred::NearGlass);
            }
        }
        match around.bodies.check_path(from, to, &[]) {
            Ok(PathCheck::Clear { .. }) => Ok(()),
            Ok(PathCheck::Collides { contact, .. }) => {
                Err(Barred::Meets { a: contact.a_name, b: contact.b_name })
            }
            Ok(PathCheck::BeyondLimit { name, why, .. }) => Err(Barred::TooFar { joint: name, why }),
            Err(error) => Err(error.into()),
        }
    }
}
