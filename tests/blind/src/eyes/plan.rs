//! What eyes look at in a session.

use nalgebra::{Point3, Vector3};
use rand::Rng;
use rand::rngs::StdRng;

use super::head::{Head, Look};
use crate::answer::Plan;
use crate::physics::normal;

/// From one look to the next, s.
const PACE_S: f64 = 5.0;
/// A thing that is watched is seen once in so long, s.
const WATCH_S: f64 = 45.0;
/// Looks at what is watched.
const WATCHED: usize = 28;
/// What is seen, and how well it is found, px.
const THINGS: [(&str, f64); 3] = [("board corner", 0.1), ("toy", 0.4), ("fingertip", 0.6)];
/// Known places are off by this share of what the noise does at their distance.
const PLACE_SHARE: f64 = 0.2;
/// Pixels per radian: what a pixel is at a distance.
const PX_PER_RAD: f64 = 150.0;

/// A thing at a place, seen once or several times.
#[derive(Clone, Debug)]
pub struct Row {
    /// Where it is, robot frame, m.
    pub place_m: Point3<f64>,
    /// Where somebody wrote that it is, m.
    pub told_m: Point3<f64>,
    /// How the head stands.
    pub look: Look,
    /// Number of what repeats.
    pub cell: usize,
}

/// A session before anything is seen.
pub struct Session {
    pub rows: Vec<Row>,
    pub sets: Vec<String>,
    pub thing: &'static str,
    pub noise_px: f64,
    pub is_repeated: bool,
    pub cells: usize,
    /// Estimates in the robot's frame are written instead of image points.
    pub is_estimated: bool,
}

impl Session {
    /// Drawn by chance.
    pub fn drawn(head: &Head, plan: Plan, is_repeated: bool, random: &mut StdRng) -> Self {
        let (thing, usual_px) = THINGS[random.random_range(0..THINGS.len())];
        let noise_px = usual_px * random.random_range(0.7..1.4);
        let mut session = Self {
            rows: vec![],
            sets: vec![],
            thing,
            noise_px,
            is_repeated,
            cells: 0,
            is_estimated: random.random_bool(0.35),
        };
        match plan {
            Plan::Plain => session.grid(head, random),
            Plan::Rich => session.turned(head, random),
            Plan::Watched => session.watched(head, random),
        }
        session
    }

    /// Four rows of nine places, measured row by row with a head that stands still.
    fn grid(&mut self, head: &Head, random: &mut StdRng) {
        let mut t_secs = random.random_range(20.0..200.0);
        for row in 0..4 {
            let places: Vec<Point3<f64>> = (0..9)
                .map(|column| {
                    let mut beside = || random.random_range(-0.02..0.02);
                    let (x_m, y_m) = (0.24 + 0.1 * f64::from(row), -0.36 + 0.09 * f64::from(column));
                    Point3::new(x_m + beside(), y_m + beside(), 0.06)
                })
                .collect();
            let rest = head.rest_rad.clone();
            self.set(
                head,
                format!("row {}", row + 1),
                &places,
                &[rest.clone(), rest],
                3,
                &mut t_secs,
                random,
            );
        }
    }

    /// Eight postures of the head, seven things at several heights in each.
    fn turned(&mut self, head: &Head, random: &mut StdRng) {
        let mut t_secs = random.random_range(20.0..200.0);
        let mut from = head.rest_rad.clone();
        for number in 0..8 {
            let to = vec![random.random_range(-0.6..0.6), random.random_range(-0.8..-0.25)];
            let mut places = vec![];
            while places.len() < 7 {
                let mut within = |low: f64, high: f64| random.random_range(low..high);
                let place = Point3::new(within(0.22, 0.6), within(-0.35, 0.35), within(0.05, 0.25));
                let look = Look { neck_rad: to.clone(), from_rad: to.clone(), t_secs, set: 0 };
                if head.sees(&[], &look, &place).is_some() {
                    places.push(place);
                }
            }
            let postures = [std::mem::replace(&mut from, to.clone()), to];
            self.set(head, format!("look {}", number + 1), &places, &postures, 2, &mut t_secs, random);
        }
    }

    /// One thing, now and then two, seen for twenty minutes by a head that stands still.
    fn watched(&mut self, head: &Head, random: &mut StdRng) {
        let things = if random.random_bool(0.75) { 1 } else { 2 };
        let mut t_secs = random.random_range(5.0..60.0);
        self.is_repeated = false;
        let places: Vec<[Point3<f64>; 2]> = (0..things)
            .map(|_| {
                let place =
                    Point3::new(random.random_range(0.3..0.55), random.random_range(-0.25..0.25), 0.06);
                [place, self.told(head, &head.rest_rad, &place, random)]
            })
            .collect();
        let rest = &head.rest_rad;
        for _ in 0..WATCHED {
            for [place_m, told_m] in &places {
                let look = Look { neck_rad: rest.clone(), from_rad: rest.clone(), t_secs, set: 0 };
                self.rows.push(Row { place_m: *place_m, told_m: *told_m, look, cell: self.cells });
                self.cells += 1;
            }
            t_secs += WATCH_S * random.random_range(0.8..1.2);
        }
    }

    /// Things in one posture of the head, all of them several times where repeats tell the noise.
    #[allow(clippy::too_many_arguments)]
    fn set(
        &mut self,
        head: &Head,
        name: String,
        places: &[Point3<f64>],
        [from, to]: &[Vec<f64>; 2],
        repeats: usize,
        t_secs: &mut f64,
        random: &mut StdRng,
    ) {
        let set = self.sets.len();
        self.sets.push(name);
        let told: Vec<Point3<f64>> = places.iter().map(|place| self.told(head, to, place, random)).collect();
        for _ in 0..if self.is_repeated { repeats } else { 1 } {
            for (k, (place_m, told_m)) in places.iter().zip(&told).enumerate() {
                let look = Look { neck_rad: to.clone(), from_rad: from.clone(), t_secs: *t_secs, set };
                self.rows.push(Row { place_m: *place_m, told_m: *told_m, look, cell: self.cells + k });
                *t_secs += PACE_S * random.random_range(0.8..1.2);
            }
        }
        self.cells += places.len();
    }

    /// Where somebody writes that a thing is, which a head in this posture looks at.
    fn told(&self, head: &Head, neck_rad: &[f64], place: &Point3<f64>, random: &mut StdRng) -> Point3<f64> {
        let range_m = (head.robot_from_left(neck_rad).inverse() * place).coords.norm();
        let sd_m = PLACE_SHARE * self.noise_px / PX_PER_RAD * range_m;
        place + Vector3::from_fn(|_, _| sd_m * normal(random))
    }
}
