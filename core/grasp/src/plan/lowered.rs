//! Down again with what is held.

use plumbline_model::Point;
use plumbline_model::robot::Posture;

use super::{GraspPlanner, NoPlan};

/// Headings that are tried beside the one in which the hand is held, rad.
const BESIDE_RAD: [f64; 9] = [0.0, 0.1, -0.1, 0.2, -0.2, 0.35, -0.35, 0.5, -0.5];
/// A way down that begins farther from where the arm stands holds it in another way, rad.
const FARTHEST_RAD: f64 = 0.9;
/// The palm is at a height to within this, m.
const THERE_M: f64 = 0.004;

impl GraspPlanner {
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
