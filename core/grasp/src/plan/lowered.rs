//! Down again with what is held.

use plumbline_model::Point;
use plumbline_model::robot::Posture;

use super::{GraspPlanner, NoPlan};

/// Headings that are tried beside the one in which the hand is held, rad.
const BESIDE_RAD: [f64; 9] = [0.0, 0.1, -0.1, 0.2, -0.2, 0.35, -0.35, 0.5, -0.5];
/// A way down that begins farther from where the arm stands holds it in another way, rad.
const FARTHEST_RAD: f64 = 0.9;
/// The same back over where a thing was taken.
const FARTHEST_BACK_RAD: f64 = 1.4;
/// An arm whose joints are no farther from home stands at home, from where each way over the table is a long one, rad.
const AT_HOME_RAD: f64 = 0.3;
/// Headings in which it is brought back from there, rad, of a right hand.
const FROM_HOME_RAD: [f64; 7] = [0.0, 0.3, -0.3, 0.6, 1.0, -0.6, 1.5];
/// The palm is at a height to within this, m.
const THERE_M: f64 = 0.004;

/// What was lifted goes back over where it was taken at this height over there, m: clear of the table.
const OVER_M: f64 = 0.04;
/// What is over where it was taken to within this was lifted straight, m.
const STRAIGHT_M: f64 = 0.01;

impl GraspPlanner {
    /// The way back down to where the palm was when the hand closed (robot frame, m), fingers as they are; where it does not
    /// get over there, straight down to that height, as [`Self::lowered`]. `None`: it does not get down.
    ///
    /// # Errors
    /// When the way to where it goes down is not free.
    pub fn put_back(&self, from: &Posture, palm_m: [f64; 3]) -> Result<Option<Vec<Posture>>, NoPlan> {
        let [x_m, y_m, z_m] = palm_m;
        let arm = self.arm();
        let now_m = arm.palm(from).coords;
        let is_over = (now_m.x - x_m).hypot(now_m.y - y_m) < STRAIGHT_M;
        let home = arm.rig().home();
        let is_at_home = arm.joints().iter().all(|joint| (from[*joint] - home[*joint]).abs() < AT_HOME_RAD);
        if !is_at_home && (is_over || now_m.z < z_m + OVER_M) {
            return self.lowered(from, z_m);
        }
        let side = if arm.is_left() { 1.0 } else { -1.0 };
        let headings: Vec<f64> = match is_at_home {
            true => FROM_HOME_RAD.iter().map(|heading_rad| -side * heading_rad).collect(),
            false => BESIDE_RAD.iter().map(|beside_rad| arm.heading_rad(from) + beside_rad).collect(),
        };
        let farthest_rad = if is_at_home { f64::INFINITY } else { FARTHEST_BACK_RAD };
        for heading_rad in headings {
            let over = arm.sent_to(Point::new(x_m, y_m, z_m + OVER_M), heading_rad, from);
            let Some(over) = over.filter(|over| over.distance_rad(from) < farthest_rad) else {
                continue;
            };
            let down = self.vertical(heading_rad, &over, -OVER_M);
            let is_down = down.last().is_some_and(|low| (arm.palm(low).coords.z - z_m).abs() < THERE_M);
            if is_down && self.is_free(from, std::slice::from_ref(&over))?.is_none() {
                return Ok(Some([vec![over], down].concat()));
            }
        }
        // Below where it stands at home there need be no table.
        if is_at_home { Ok(None) } else { self.lowered(from, z_m) }
    }

    /// The way down to where the palm is at a height (robot frame, m), fingers as they are. An arm that went up gets not
    /// always down again the way it would find from above: then it is the way up from there, turned round. `None`: the
    /// arm does not get down there.
    ///
    /// # Errors
    /// When the way to where it goes down is not free.
    pub fn lowered(&self, from: &Posture, height_m: f64) -> Result<Option<Vec<Posture>>, NoPlan> {
        let (palm, held_rad) = (self.arm().palm(from).coords, self.arm().heading_rad(from));
        let down_m = height_m - palm.z;
        let is_at = |posture: &Posture, m: f64| (self.arm().palm(posture).coords.z - m).abs() < THERE_M;
        let straight = self.vertical(held_rad, from, down_m);
        if straight.last().is_some_and(|low| is_at(low, height_m)) {
            return Ok(Some(straight));
        }
        let (mut barred, mut best): (_, Option<(f64, Vec<Posture>)>) = (None, None);
        for beside_rad in BESIDE_RAD {
            let heading_rad = held_rad + beside_rad;
            let below = Point::new(palm.x, palm.y, height_m);
            let Some(low) = self.arm().sent_to(below, heading_rad, from) else { continue };
            let up = self.vertical(heading_rad, &low, -down_m);
            let Some(top) =
                up.last().filter(|top| is_at(top, palm.z) && top.distance_rad(from) < FARTHEST_RAD)
            else {
                continue;
            };
            let turn_rad = top.distance_rad(from) + top.distance_rad(&low);
            let way: Vec<Posture> = up.iter().rev().cloned().chain([low]).collect();
            match self.is_free(from, &way[..1])?.or(self.stops_arm(&way)?) {
                None if best.as_ref().is_none_or(|(least_rad, _)| turn_rad < *least_rad) => {
                    best = Some((turn_rad, way));
                }
                None => {}
                Some(why) => barred = barred.or(Some(why)),
            }
        }
        match (best, barred) {
            (Some((_, way)), _) => Ok(Some(way)),
            (None, Some(why)) => Err(NoPlan::NotFree(why)),
            (None, None) => Ok(None),
        }
    }
}
