//! Experiments that an operator can do with this rig and has not done yet, as rows to come.

use std::collections::BTreeSet;

use nalgebra::Vector3;
use plumbline_effects::measurements::{Apparatus, Measurements, Observation, What};

use super::{poses, words};
use crate::finding::Experiment;
use crate::search::Found;

/// Weight that is tried, kg.
pub(super) const WEIGHT_KG: f64 = 0.25;
/// Heights of the blocks that are tried, m.
pub(super) const BLOCKS_M: [f64; 2] = [0.06, 0.12];
/// Places that an experiment is made at.
const PLACES: usize = 10;
/// Rows whose weight is below this are outliers.
const BELIEVED: f64 = 0.5;
/// How far more places lie from those that were measured, m.
const WIDER_M: f64 = 0.05;
/// Of a card behind what is seen, m.
const CARD_M: f64 = 0.1;
/// Turn of the head, rad.
const TURN_RAD: f64 = 0.21;
/// Cold and warm, s after power-on.
const COLD_SECS: f64 = 60.0;
const WARM_SECS: f64 = 2400.0;

/// Things that are watched at once, and when they are looked at, s after power-on.
const WATCHED_PLACES: usize = 3;
const WATCHED_SECS: [f64; 6] = [60.0, 180.0, 300.0, 480.0, 720.0, 960.0];
const WATCHED_MIN: f64 = 18.0;

/// Time that things take, minutes.
const TOUCH_MIN: f64 = 0.25;
const LOOK_MIN: f64 = 0.2;
const CHANGE_WEIGHT_MIN: f64 = 1.0;
const CHANGE_BLOCK_MIN: f64 = 2.0;
const ARRANGE_MIN: f64 = 2.0;

/// An experiment with its rows to come. Their session is one more than those that were measured,
/// with a frame of its own: whoever measures again may have moved the screen.
#[derive(Clone, Debug)]
pub(super) struct Trial {
    pub kind: Experiment,
    pub what: String,
    pub rows: Vec<Observation>,
    pub minutes: f64,
    /// Session that it is done like.
    pub like: usize,
}

/// All that can be done and was not done yet.
pub(super) fn of(measurements: &Measurements, found: &Found) -> Vec<Trial> {
    let believed: Vec<&Observation> = measurements
        .rows
        .iter()
        .enumerate()
        .filter(|(i, _)| found.weights.get(*i).is_none_or(|weight| *weight >= BELIEVED))
        .map(|(_, row)| row)
        .collect();
    let mut trials = vec![];
    for (whats, is_arm) in [
        (&[What::Touch][..], true),
        (&[What::Pose, What::OrientedPose], true),
        (&[What::Place, What::EyePoints], false),
    ] {
        let rows: Vec<&Observation> =
            believed.iter().copied().filter(|row| whats.contains(&row.what)).collect();
        let Some(last) = rows.last() else { continue };
        let rows: Vec<&Observation> =
            rows.iter().copied().filter(|row| row.session == last.session).collect();
        let apparatus = &measurements.apparatuses[last.session];
        let all: Vec<&Observation> =
            believed.iter().copied().filter(|row| whats.contains(&row.what)).collect();
        let menu = Menu {
            base: spread(&rows, PLACES),
            all,
            apparatus,
            session: measurements.apparatuses.len(),
            like: last.session,
        };
        trials.extend(if is_arm { menu.of_arm() } else { menu.of_eyes() });
    }
    trials
}

/// Rows as far from each other as can be.
fn spread<'a>(rows: &[&'a Observation], most: usize) -> Vec<&'a Observation> {
    let place = |row: &Observation| -> Vec<f64> {
        row.truth_m.map_or_else(|| row.angles_rad().to_vec(), |truth| truth.coords.as_slice().to_vec())
    };
    let places: Vec<Vec<f64>> = rows.iter().map(|row| place(row)).collect();
    let distance = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
    let mut chosen: Vec<usize> = vec![];
    let mut nearest = vec![f64::INFINITY; rows.len()];
    while chosen.len() < most.min(rows.len()) {
        let Some(next) = (0..rows.len()).max_by(|a, b| nearest[*a].total_cmp(&nearest[*b])) else { break };
        // What is left repeats places that were chosen.
        if !chosen.is_empty() && nearest[next] < 1e-8 {
            break;
        }
        for (near, place) in nearest.iter_mut().zip(&places) {
            *near = near.min(distance(place, &places[next]));
        }
        chosen.push(next);
    }
    chosen.into_iter().map(|i| rows[i]).collect()
}

struct Menu<'a> {
    base: Vec<&'a Observation>,
    all: Vec<&'a Observation>,
    apparatus: &'a Apparatus,
    session: usize,
    like: usize,
}

impl Menu<'_> {
    fn of_arm(&self) -> Vec<Trial> {
        let weight = |row: &Observation| {
            Some(vec![
                self.with(row, |row| row.payload_kg = 0.0),
                self.with(row, |row| row.payload_kg = WEIGHT_KG),
            ])
        };
        let slower = |row: &Observation| {
            let secs = row.move_secs?;
            Some(vec![
                self.with(row, |_| ()),
                self.with(row, |row| {
                    row.move_secs = Some(3.0 * secs);
                    row.speed_rad_s.iter_mut().flatten().for_each(|speed| *speed /= 3.0);
                }),
            ])
        };
        let later = |row: &Observation| {
            row.lag_rad()?;
            Some(vec![
                self.with(row, |_| ()),
                self.with(row, |row| {
                    row.commanded_rad.clone_from(&row.encoder_rad);
                    (row.usual_lag_rad, row.given_way_rad) = (None, None);
                }),
            ])
        };
        let repeats = |row: &Observation| Some(vec![self.with(row, |_| ()); 3]);
        let mut trials = vec![];
        let mut add = |kind,
                       done: bool,
                       changes_min: f64,
                       each_min: f64,
                       rows: &dyn Fn(&Observation) -> Option<Vec<Observation>>| {
            if !done {
                trials.extend(self.trial(kind, changes_min, each_min, rows));
            }
        };
        let is_touch = self.base.iter().all(|row| row.what == What::Touch);
        add(Experiment::OtherSide, self.has_both_sides(), 0.0, TOUCH_MIN, &|row| self.both_sides(row));
        add(
            Experiment::Weight,
            self.differ(|row| Some(row.payload_kg), 0.05),
            CHANGE_WEIGHT_MIN,
            TOUCH_MIN,
            &weight,
        );
        let heights = self.differ(|row| Some(row.screen_height_m), 0.02);
        add(Experiment::RaisedScreen, heights || !is_touch, 2.0 * CHANGE_BLOCK_MIN, TOUCH_MIN, &|row| {
            self.raised(row)
        });
        add(Experiment::OtherPosture, self.has_postures(), ARRANGE_MIN, 1.4 * TOUCH_MIN, &|row| {
            self.postures(row)
        });
        let speeds = self.ratio(|row| row.move_secs) > 2.5;
        add(Experiment::Slower, speeds, 0.0, 2.0 * TOUCH_MIN, &slower);
        let warm = self.differ(|row| row.t_secs, WARM_SECS);
        add(Experiment::ColdAndWarm, warm, WARM_SECS / 60.0, TOUCH_MIN, &|row| self.cold_and_warm(row));
        add(Experiment::LogLater, false, ARRANGE_MIN, TOUCH_MIN, &later);
        let repeated = self.all.iter().map(|row| row.cell).collect::<BTreeSet<_>>().len() < self.all.len();
        add(Experiment::Repeats, repeated, 0.0, TOUCH_MIN, &repeats);
        add(Experiment::MorePlaces, false, 0.0, TOUCH_MIN, &|row| self.wider(row));
        trials
    }

    /// One thing was watched: others, or under another angle, over the same time.
    fn of_watched(&self) -> Vec<Trial> {
        let stands = self.all.iter().filter_map(|row| row.stand).max().map_or(0, |last| last + 1);
        let trial = |kind, place: &dyn Fn(&Observation, usize) -> Option<Observation>| {
            let mut rows = vec![];
            for (k, row) in self.base.iter().enumerate() {
                for other in 0..WATCHED_PLACES {
                    let at = place(row, other)?;
                    let stand = Some(stands + WATCHED_PLACES * k + other);
                    rows.extend(WATCHED_SECS.map(|secs| {
                        let timed = Observation { t_secs: Some(secs), stand, ..at.clone() };
                        Observation { session: self.session, ..self.with(&timed, |_| ()) }
                    }));
                }
            }
            rows.iter_mut().enumerate().for_each(|(i, row)| (row.row, row.cell) = (i, i));
            let what = words::watched(kind)?.to_owned();
            Some(Trial { kind, what, rows, minutes: WATCHED_MIN, like: self.like })
        };
        let distances = trial(Experiment::OtherDistance, &|row, other| {
            let (head, truth) = (self.head_m(row)?, row.truth_m?);
            let share = [2.0 / 3.0, 1.0, 1.5][other];
            Some(self.with(row, |row| row.truth_m = Some((head + (truth.coords - head) * share).into())))
        });
        let turned = trial(Experiment::HeadTurned, &|row, other| {
            let turn_rad = [-TURN_RAD, 0.0, TURN_RAD][other];
            (!row.neck_rad.is_empty()).then(|| self.with(row, |row| row.neck_rad[0] += turn_rad))
        });
        distances.into_iter().chain(turned).collect()
    }

    fn of_eyes(&self) -> Vec<Trial> {
        if self.base.iter().any(|row| row.stand.is_some()) {
            return self.of_watched();
        }
        let range_m = |row: &Observation| self.range_m(row);
        let card = |row: &Observation| {
            row.background_m?;
            let behind = self.range_m(row)? + CARD_M;
            Some(vec![self.with(row, |_| ()), self.with(row, |row| row.background_m = Some(behind))])
        };
        let has_card = self.all.iter().any(|row| {
            row.background_m
                .zip(self.range_m(row))
                .is_some_and(|(behind, range)| behind - range < 1.5 * CARD_M)
        });
        let distance = |row: &Observation| {
            let head = self.head_m(row)?;
            let truth = row.truth_m?;
            let at = |share: f64| {
                self.with(row, |row| row.truth_m = Some((head + (truth.coords - head) * share).into()))
            };
            Some(vec![at(1.0), at(2.0 / 3.0), at(1.5)])
        };
        let turned = |row: &Observation| {
            let turn = |by: f64| self.with(row, |row| row.neck_rad[0] += by);
            (!row.neck_rad.is_empty()).then(|| vec![turn(0.0), turn(TURN_RAD), turn(-TURN_RAD)])
        };
        let head_turned = self.differ(|row| row.neck_rad.first().copied(), 0.15);
        let warm = self.differ(|row| row.t_secs, WARM_SECS);
        let distances = self.ratio(range_m) > 1.8;
        let mut trials = vec![];
        let mut add =
            |kind, done: bool, changes_min: f64, rows: &dyn Fn(&Observation) -> Option<Vec<Observation>>| {
                if !done {
                    trials.extend(self.trial(kind, changes_min, LOOK_MIN, rows));
                }
            };
        add(Experiment::CardBehind, has_card, CHANGE_WEIGHT_MIN, &card);
        add(Experiment::OtherDistance, distances, CHANGE_BLOCK_MIN, &distance);
        add(Experiment::HeadTurned, head_turned, 0.0, &turned);
        add(Experiment::ColdAndWarm, warm, WARM_SECS / 60.0, &|row| self.cold_and_warm(row));
        let repeated = self.all.iter().map(|row| row.cell).collect::<BTreeSet<_>>().len() < self.all.len();
        add(Experiment::Repeats, repeated, 0.0, &|row| Some(vec![self.with(row, |_| ()); 3]));
        add(Experiment::MorePlaces, false, 0.0, &|row| self.wider(row));
        trials
    }

    /// An experiment at all places that allow it; `None` when fewer than half do.
    fn trial(
        &self,
        kind: Experiment,
        changes_min: f64,
        each_min: f64,
        rows: &dyn Fn(&Observation) -> Option<Vec<Observation>>,
    ) -> Option<Trial> {
        let made: Vec<Vec<Observation>> = self.base.iter().filter_map(|row| rows(row)).collect();
        let places = made.len();
        if places < 3 || 2 * places < self.base.len() {
            return None;
        }
        let (verb, noun) = match self.base.first()?.what {
            What::Touch => ("touch", "places"),
            What::Pose | What::OrientedPose => ("measure", "poses"),
            What::Place | What::EyePoints => ("look at", "places"),
        };
        let rows: Vec<Observation> = made
            .into_iter()
            .flatten()
            .enumerate()
            .map(|(i, row)| Observation { session: self.session, row: i, cell: i, ..row })
            .collect();
        let minutes = changes_min + each_min * rows.len() as f64;
        let shown = if kind == Experiment::MorePlaces { rows.len() } else { places };
        Some(Trial { kind, what: words::what(kind, shown, verb, noun), rows, minutes, like: self.like })
    }

    fn with(&self, row: &Observation, change: impl FnOnce(&mut Observation)) -> Observation {
        let mut row = row.clone();
        change(&mut row);
        // Torques and temperatures were measured under other conditions.
        row.torque_nm = None;
        row
    }

    /// Whether a value differs between rows by more than this.
    fn differ(&self, value: impl Fn(&Observation) -> Option<f64>, least: f64) -> bool {
        let known = self.all.iter().filter_map(|row| value(row));
        let (low, high) =
            known.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
        high - low >= least
    }

    /// Largest over smallest value.
    fn ratio(&self, value: impl Fn(&Observation) -> Option<f64>) -> f64 {
        let known = self.all.iter().filter_map(|row| value(row)).filter(|v| *v > 0.0);
        let (low, high) = known.fold((f64::INFINITY, 0.0_f64), |(low, high), v| (low.min(v), high.max(v)));
        if high > 0.0 { high / low } else { 1.0 }
    }

    fn has_both_sides(&self) -> bool {
        let sides: BTreeSet<&str> = self
            .all
            .iter()
            .filter_map(|row| row.approach.as_deref())
            .filter(|side| !side.trim().is_empty())
            .collect();
        if sides.len() > 1 {
            return true;
        }
        // Of most joints both directions were seen, each in a tenth of the rows and more.
        let joints = self.all.first().map_or(0, |row| row.direction.len());
        let share = |j: usize, sign: f64| {
            let count =
                self.all.iter().filter(|row| row.direction.get(j).is_some_and(|d| *d == sign)).count();
            count as f64 / self.all.len().max(1) as f64
        };
        let both = (0..joints).filter(|&j| share(j, 1.0) > 0.1 && share(j, -1.0) > 0.1).count();
        joints > 0 && 2 * both > joints
    }

    /// Whether some place was reached with clearly different angles.
    fn has_postures(&self) -> bool {
        let Some(arm) = &self.apparatus.arm else { return true };
        let none = plumbline_effects::arm::Deviation::none(arm.len());
        let every = self.all.len().div_ceil(60).max(1);
        let poses: Vec<(nalgebra::Point3<f64>, &[f64])> = self
            .all
            .iter()
            .step_by(every)
            .map(|row| (arm.tip_m(row.angles_rad(), &none), row.angles_rad()))
            .collect();
        poses.iter().enumerate().any(|(i, (tip, angles))| {
            poses[i + 1..].iter().any(|(other_tip, other)| {
                (tip - other_tip).norm() < 0.02 && angles.iter().zip(*other).any(|(a, b)| (a - b).abs() > 0.3)
            })
        })
    }

    fn both_sides(&self, row: &Observation) -> Option<Vec<Observation>> {
        let arm = self.apparatus.arm.as_ref()?;
        let along = self.apparatus.surface.as_ref().map_or(-Vector3::y(), |surface| surface.axes()[0]);
        let directions = poses::directions(arm, row.angles_rad(), &along)?;
        let side = |sign: f64| {
            let directions = directions.iter().map(|d| sign * d).collect();
            self.with(row, |row| row.direction = directions)
        };
        Some(vec![side(1.0), side(-1.0)])
    }

    fn raised(&self, row: &Observation) -> Option<Vec<Observation>> {
        let normal = *self.apparatus.surface.as_ref()?.normal();
        let mut rows = vec![self.with(row, |_| ())];
        for height_m in BLOCKS_M {
            // A place that the arm does not reach so high is touched at the other heights.
            let Some(mut raised) =
                self.posed(row, |arm, angles| poses::moved(arm, angles, normal * height_m))
            else {
                continue;
            };
            raised.screen_height_m += height_m;
            rows.push(raised);
        }
        (rows.len() > 1).then_some(rows)
    }

    fn postures(&self, row: &Observation) -> Option<Vec<Observation>> {
        let sign = if row.row.is_multiple_of(2) { 1.0 } else { -1.0 };
        let other = self.posed(row, |arm, angles| poses::other_posture(arm, angles, sign))?;
        Some(vec![self.with(row, |_| ()), other])
    }

    /// With other angles; commanded ones and encoders move alike.
    fn posed(
        &self,
        row: &Observation,
        change: impl Fn(&plumbline_effects::arm::Arm, &[f64]) -> Option<Vec<f64>>,
    ) -> Option<Observation> {
        let from = row.angles_rad();
        let to = change(self.apparatus.arm.as_ref()?, from)?;
        let turn: Vec<f64> = to.iter().zip(from).map(|(to, from)| to - from).collect();
        Some(self.with(row, |row| {
            for angles in [&mut row.commanded_rad, &mut row.encoder_rad].into_iter().flatten() {
                angles.iter_mut().zip(&turn).for_each(|(angle, turn)| *angle += turn);
            }
        }))
    }

    fn wider(&self, row: &Observation) -> Option<Vec<Observation>> {
        // Four ways in turn, two for each place.
        let way = |k: usize| match k % 4 {
            0 => Vector3::new(1.0, 0.0, 0.0),
            1 => Vector3::new(0.0, 1.0, 0.0),
            2 => Vector3::new(-1.0, 0.0, 0.0),
            _ => Vector3::new(0.0, -1.0, 0.0),
        };
        let rows: Vec<Observation> = [row.row, row.row + 1]
            .into_iter()
            .filter_map(|k| match row.truth_m {
                Some(truth) => Some(self.with(row, |row| row.truth_m = Some(truth + WIDER_M * way(k)))),
                None => {
                    self.posed(row, |arm, angles| poses::moved(arm, angles, self.level(way(k)) * WIDER_M))
                }
            })
            .collect();
        (!rows.is_empty()).then_some(rows)
    }

    /// The same way along the glass.
    fn level(&self, way: Vector3<f64>) -> Vector3<f64> {
        let Some(surface) = &self.apparatus.surface else { return way };
        way - surface.normal() * surface.normal().dot(&way)
    }

    fn cold_and_warm(&self, row: &Observation) -> Option<Vec<Observation>> {
        row.t_secs?;
        let at = |secs: f64| self.with(row, |row| row.t_secs = Some(secs));
        Some(vec![at(COLD_SECS), at(WARM_SECS)])
    }

    /// Place of the left eye, robot frame.
    fn head_m(&self, row: &Observation) -> Option<Vector3<f64>> {
        let eyes = self.apparatus.eyes.as_ref()?;
        let nominal = plumbline_effects::EyesDeviation::none(eyes.neck.len());
        Some(eyes.robot_from_left(&row.neck_rad, &nominal).translation.vector)
    }

    fn range_m(&self, row: &Observation) -> Option<f64> {
        Some((row.truth_m?.coords - self.head_m(row)?).norm())
    }
}
