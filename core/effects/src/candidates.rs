//! Which effects rows could show at all, and in which shapes.

use std::collections::BTreeMap;

use crate::library::{
    Effect, Kind, Known, MOST_MOMENTS, Shape, Situation, differ, moments, sorted, thinned, with_shapes,
};
use crate::measurements::Measurements;
use crate::observation::{Observation, What};

/// More sets than these are no stretches of one measurement, and fewer rows do not tell how an eye stood.
const MOST_SETS: usize = 8;
const LEAST_IN_SET: usize = 6;
/// Places that are no farther apart are one, m.
const SAME_PLACE_M: f64 = 0.02;
/// Estimates of fewer places do not tell an eye that rolls from one that turns sideways, nor one that pitches from both that
/// nod: image points do.
const ROLL_SHOWS_AT: usize = 3;
/// A joint of the neck that moved by less shows no zero of its own, rad.
const NECK_MOVED_RAD: f64 = 0.02;

impl Effect {
    /// Every effect, at every site and in every shape of a grid, that these rows could show: by
    /// the columns that are there. Whether they do show it is for the tangents to say.
    pub fn candidates(measurements: &Measurements) -> Vec<Self> {
        let arm = measurements.apparatuses.iter().find_map(|apparatus| apparatus.arm.as_ref());
        let eyes = measurements.apparatuses.iter().find_map(|apparatus| apparatus.eyes.as_ref());
        let known = Known::of(measurements);
        Kind::ALL
            .iter()
            .filter(|kind| (kind.entry().shown)(&known))
            .flat_map(|kind| {
                let in_sets = known.eye_sets.iter().filter_map(|set| Self::in_set(*kind, set)).collect();
                [Self::sites(*kind, arm, eyes), in_sets].concat()
            })
            .filter(|effect| known.has_own_name(effect))
            .flat_map(|effect| known.shapes(effect))
            .map(|effect| match eyes {
                Some(eyes) => effect.beside(&eyes.calibrated_at),
                None => effect,
            })
            .collect()
    }

    /// Shapes around this one, between its neighbors of the grid: to pin it down once it was
    /// found. Itself alone where its shape is not a matter of degree.
    pub fn refined(&self, measurements: &Measurements) -> Vec<Self> {
        let Some([low, high]) = self.shape_range.filter(|[low, high]| low < high) else {
            return vec![self.clone()];
        };
        let shapes: Vec<f64> = match self.kind.entry().shape {
            Shape::Moment => {
                let moments = moments(&Known::of(measurements).arm_secs);
                let inside: Vec<f64> = moments.into_iter().filter(|t| (low..=high).contains(t)).collect();
                thinned(&inside, MOST_MOMENTS)
            }
            Shape::TimeConstant(_) => (0..=6).map(|k| low * (high / low).powf(f64::from(k) / 6.0)).collect(),
            Shape::Limit => (0..=6).map(|k| low + (high - low) * f64::from(k) / 6.0).collect(),
            Shape::Teeth => (low.ceil() as i64..=high.floor() as i64).map(|order| order as f64).collect(),
            Shape::None | Shape::OnceOrTwice | Shape::Growth(_) | Shape::OneOf(_) | Shape::AnotherJoint => {
                vec![]
            }
        };
        if shapes.is_empty() {
            return vec![self.clone()];
        }
        with_shapes(self, &shapes, [low, high])
    }
}

impl Known {
    fn of(measurements: &Measurements) -> Self {
        let rows = &measurements.rows;
        let of_arm: Vec<&Observation> = rows.iter().filter(|row| row.what.is_placed()).collect();
        let of_eyes: Vec<&Observation> = rows.iter().filter(|row| !row.what.is_placed()).collect();
        let secs = |rows: &[&Observation]| sorted(rows.iter().filter_map(|row| row.t_secs));
        let moves = |row: &&&Observation| row.move_secs.is_some();
        let durations = sorted(of_arm.iter().filter(moves).filter_map(|row| row.move_secs));
        let joints = of_arm.iter().map(|row| row.angles_rad().len()).max().unwrap_or(0);
        let situations: Vec<Vec<f64>> = of_arm.iter().filter_map(|row| torques(measurements, row)).collect();
        Self {
            touches: measurements.has(What::Touch),
            arm: !of_arm.is_empty(),
            eyes: !of_eyes.is_empty(),
            watched: of_eyes.iter().any(|row| row.stand.is_some()),
            neck_moved: neck_moved(&of_eyes),
            only_watched: !of_eyes.is_empty() && of_eyes.iter().all(|row| row.stand.is_some()),
            eye_sets: measurements.sets_of_eyes(),
            background: of_eyes.iter().any(|row| row.background_m.is_some()),
            commanded: of_arm
                .iter()
                .any(|row| row.encoder_rad.is_none() || row.encoder_copies.contains(&true)),
            lag: of_arm.iter().filter_map(|row| row.lag_rad()).flatten().any(|lag| lag.abs() > 1e-4),
            directions: differ(of_arm.iter().map(|row| row.direction.first().copied().unwrap_or(0.0))),
            direction: of_arm.iter().any(|row| row.direction.iter().any(|side| *side != 0.0)),
            speeds: differ(durations.iter().copied()),
            longest_hold_s: of_arm.iter().filter_map(|row| row.hold_secs).fold(0.0, f64::max),
            arm_secs: secs(&of_arm),
            eye_secs: secs(&of_eyes),
            torques_nm: (0..joints)
                .map(|j| sorted(situations.iter().filter_map(|nm| nm.get(j)).map(|nm| nm.abs())))
                .collect(),
            angles_rad: (0..joints)
                .map(|j| sorted(of_arm.iter().filter_map(|row| row.angles_rad().get(j).copied())))
                .collect(),
        }
    }
}

impl Measurements {
    /// Whether what was seen tells an eye that rolls and pitches from both that nod.
    pub fn roll_shows(&self) -> bool {
        let of_eyes: Vec<&Observation> = self.rows.iter().filter(|row| !row.what.is_placed()).collect();
        self.has(What::EyePoints) || places(&of_eyes) >= ROLL_SHOWS_AT
    }

    /// Labels of the sets in which the eyes measured, if what is between them could be told: two sets at least,
    /// all rows in one of them, and rows enough in each.
    pub fn sets_of_eyes(&self) -> Vec<String> {
        let mut counts = BTreeMap::<&String, usize>::new();
        for row in self.rows.iter().filter(|row| !row.what.is_placed() && row.stand.is_none()) {
            let Some(set) = &row.set else { return vec![] };
            *counts.entry(set).or_default() += 1;
        }
        let is_told =
            (2..=MOST_SETS).contains(&counts.len()) && counts.values().all(|count| *count >= LEAST_IN_SET);
        if is_told { counts.into_keys().cloned().collect() } else { vec![] }
    }
}

/// At how many places things were seen, as many as it takes.
fn places(rows: &[&Observation]) -> usize {
    let mut known: Vec<nalgebra::Point3<f64>> = vec![];
    for at in rows.iter().filter_map(|row| row.truth_m) {
        if known.len() == ROLL_SHOWS_AT {
            break;
        }
        if known.iter().all(|other| (other - at).norm() > SAME_PLACE_M) {
            known.push(at);
        }
    }
    known.len()
}

/// Which joints of the neck moved from row to row.
fn neck_moved(rows: &[&Observation]) -> Vec<bool> {
    let joints = rows.iter().map(|row| row.neck_rad.len()).max().unwrap_or(0);
    let of = |joint: usize| rows.iter().filter_map(move |row| row.neck_rad.get(joint).copied());
    let reach =
        |joint: usize| of(joint).fold((f64::MAX, f64::MIN), |(low, high), rad| (low.min(rad), high.max(rad)));
    (0..joints).map(reach).map(|(low, high)| high - low > NECK_MOVED_RAD).collect()
}

fn torques(measurements: &Measurements, row: &Observation) -> Option<Vec<f64>> {
    let arm = measurements.apparatus(row).arm.as_ref()?;
    let up = nalgebra::Vector3::z();
    let situation = Situation::new(arm, row.angles_rad(), &row.direction, row.payload_kg, &up).during(row);
    Some(situation.torques_nm().to_vec())
}
