//! The 9 by 4 evaluation under way: a thing is laid at one place after the other and looked at.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use jiff::Timestamp;
use plumbline_drift::evaluation_places_m;
use plumbline_effects::SeenUnder;
use plumbline_grasp::things::Thing;
use plumbline_model::session::LocalizationRow;
use plumbline_model::{Point, Robot};

use super::DriftAround;
use super::view::{GridDoing, GridRunView};
use super::work::{Context, DriftWork};
use crate::ground::World;
use crate::ground::jobs::JobId;
use crate::twin::command::TwinCommand;

/// A thing that was laid down comes to rest within this.
const SETTLES: Duration = Duration::from_millis(1500);
/// So many looks make a place.
pub(super) const LOOKS: usize = 5;
/// The eyes have found it within this, of time in which they look, or it is not seen.
const SEEN_WITHIN: Duration = Duration::from_secs(8);
/// Pairs that can be looked at come more often than this, or the eyes were away, or had to wait, in between.
const AWAY: Duration = Duration::from_secs(1);
/// What could not be written is tried again after this, or with the next place.
const TRIED_AGAIN: Duration = Duration::from_secs(15);
/// A thing that comes out farther from its target than this is another one, m.
const FARTHEST_M: f64 = 0.2;

/// Where it is.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Stage {
    /// A person lays the thing down.
    Asks,
    /// It was laid down, and comes to rest until then.
    Lies(Instant),
    /// It is looked at since then.
    Looks(Instant),
    /// It was not found there; a person is asked.
    NotSeen,
    /// All places are done, or somebody has ended it.
    Ended,
}

/// An evaluation.
#[derive(Clone, Debug)]
pub(super) struct GridRun {
    thing: Thing,
    began: Timestamp,
    /// Whose eyes look.
    pub world: Option<World>,
    /// Toys of the twin that stood on the table before, and where (x, y), m.
    stood: Vec<(String, [f64; 2])>,
    at: usize,
    stage: Stage,
    rows: Vec<LocalizationRow>,
    /// Of the place where it is.
    looks: Vec<LocalizationRow>,
    /// Until then it was looked at.
    seen_until: Instant,
    /// The newest pair that counted.
    looked_at: Option<Instant>,
    /// The session, once it is on disk.
    pub folder: Option<PathBuf>,
    keeping: Option<JobId>,
    /// When what could not be written is tried again (`None`: at once), and why it could not.
    unkept: Option<(Option<Instant>, String)>,
    /// No detector has looked for as long as one is waited for.
    is_blind: bool,
    /// Rows that the session on disk does not hold yet.
    is_newer: bool,
}

impl GridRun {
    /// At the first place.
    pub fn begin(thing: Thing, around: &DriftAround, context: &mut Context<'_>) -> Self {
        let mut run = Self {
            thing,
            began: context.time.day,
            world: around.world,
            stood: Vec::new(),
            at: 0,
            stage: Stage::Asks,
            rows: Vec::new(),
            looks: Vec::new(),
            seen_until: context.time.instant,
            looked_at: None,
            folder: None,
            keeping: None,
            unkept: None,
            is_blind: false,
            is_newer: false,
        };
        if let Some(twin) = &around.twin {
            context.control(TwinCommand::HideBoard.into());
            let stood = twin.toys.iter().filter_map(|toy| {
                let at_m = toy.place?.coords;
                Some((toy.name.clone(), [at_m.x, at_m.y]))
            });
            run.stood = stood.collect();
            for (toy, _) in run.stood.iter().filter(|(toy, _)| !toy.eq_ignore_ascii_case(thing.class)) {
                context.control(TwinCommand::RemoveToy { toy: toy.clone() }.into());
            }
        }
        run.go_to(0, around, context);
        run
    }

    /// Whether places are still to come.
    pub fn is_under_way(&self) -> bool {
        self.stage != Stage::Ended
    }

    /// Whether it has ended, and all of it is on disk.
    pub fn is_on_disk(&self) -> bool {
        let waits = self.is_newer || self.keeping.is_some() || self.unkept.is_some();
        !self.is_under_way() && !waits
    }

    /// Class of the thing.
    pub fn object(&self) -> &'static str {
        self.thing.class
    }

    /// Places at which it was seen, of how many.
    pub fn seen(&self) -> [usize; 2] {
        let measured = self.rows.iter().filter(|row| row.valid).map(|row| row.truth);
        let mut measured: Vec<_> = measured.flatten().map(|at| at.coords.coords.map(f64::to_bits)).collect();
        measured.dedup();
        [measured.len(), evaluation_places_m().len()]
    }

    /// The thing lies where it was asked for; `false`: nobody asked.
    pub fn placed(&mut self, now: Instant) -> bool {
        let asked = matches!(self.stage, Stage::Asks | Stage::NotSeen);
        if asked {
            self.looks.clear();
            self.stage = Stage::Lies(now + SETTLES);
        }
        asked
    }

    /// The place is left out.
    pub fn leave_out(&mut self, around: &DriftAround, context: &mut Context<'_>) {
        if self.is_under_way() {
            self.miss(around, context);
        }
    }

    /// No more places; what was measured stays, and the toys of the twin stand where they stood before.
    pub fn end(&mut self, around: &DriftAround, context: &mut Context<'_>) {
        self.stage = Stage::Ended;
        self.looks.clear();
        let stood = std::mem::take(&mut self.stood);
        if around.twin.is_none() {
            return;
        }
        let thing = self.thing.class.to_lowercase();
        context.control(TwinCommand::RemoveToy { toy: thing }.into());
        for (toy, [x_m, y_m]) in stood {
            context.control(TwinCommand::PlaceToy { toy: toy.to_lowercase(), x_m, y_m }.into());
        }
    }

    /// A pair has come: what was found in the pairs before is looked at.
    pub fn saw(&mut self, around: &DriftAround, context: &mut Context<'_>) {
        let now = context.time.instant;
        if let Stage::Lies(until) = self.stage
            && now >= until
        {
            self.stage = Stage::Looks(until);
            self.seen_until = until;
        }
        let Stage::Looks(mut since) = self.stage else { return };
        if around.waits_because().is_some() {
            return;
        }
        // Eyes that were lost on the way, or had to wait, have not missed it meanwhile.
        let away = now.saturating_duration_since(self.seen_until);
        if away > AWAY {
            since += away;
            self.stage = Stage::Looks(since);
        }
        self.seen_until = now;
        if let Some((captured, row)) = self.look(around, since) {
            self.looked_at = Some(captured);
            self.looks.push(row);
        }
        let is_over = now.saturating_duration_since(since) > SEEN_WITHIN;
        // Where nobody looks nothing is missing.
        self.is_blind = is_over && around.found.as_ref().is_none_or(|found| found.stamp.captured_at <= since);
        if self.is_blind {
            return;
        }
        if self.looks.len() >= LOOKS || is_over && !self.looks.is_empty() {
            let looks = std::mem::take(&mut self.looks);
            self.add_rows(looks);
            self.go_to(self.at + 1, around, context);
        } else if is_over && around.twin.is_some() {
            self.miss(around, context);
        } else if is_over {
            self.stage = Stage::NotSeen;
        }
    }

    /// One look at the thing in pairs from `since` on, each pair once.
    fn look(&self, around: &DriftAround, since: Instant) -> Option<(Instant, LocalizationRow)> {
        let found = around.found.as_ref()?;
        let captured = found.stamp.captured_at;
        if captured <= since || self.looked_at.is_some_and(|last| captured <= last) {
            return None;
        }
        let target = self.target(around);
        let off_m = |at: &Point<Robot>| (at.coords.coords - target.coords.coords).xy().norm();
        let places = found.objects.iter().filter(|object| object.name.eq_ignore_ascii_case(self.thing.class));
        let places = places.filter_map(|object| Some(object.place.as_ref().ok()?.point_in_robot));
        let nearest = places.min_by(|a, b| off_m(a).total_cmp(&off_m(b)))?;
        if off_m(&nearest) > FARTHEST_M {
            return None;
        }
        let row = self.row(around, Some(nearest))?;
        Some((captured, row))
    }

    /// A row of the session; places come out as the description has them, whatever model is in use: so that
    /// any correction can be judged by it later. `None`: the eyes cannot see such a place.
    fn row(&self, around: &DriftAround, place: Option<Point<Robot>>) -> Option<LocalizationRow> {
        let (model, posture) = (&around.model, around.posture());
        let rig = model.rig();
        let seen = SeenUnder { t_secs: around.eyes_on_s, ..SeenUnder::default() };
        let mut row = LocalizationRow {
            truth: Some(self.target(around)),
            head_rad: [rig.eyes.pan, rig.eyes.tilt].map(|joint| Some(posture[joint])).to_vec(),
            t_secs: around.eyes_on_s,
            object: Some(self.thing.class.to_lowercase()),
            group: Some(format!("{}", self.at + 1)),
            valid: place.is_some(),
            ..LocalizationRow::default()
        };
        if let Some(place) = place {
            let (left, right) = model.project(&place, &posture, &seen)?;
            let in_left = rig.eyes.cameras.triangulate(left, right)?;
            row.estimate = Some(rig.robot_from_left(&posture) * in_left);
            (row.left, row.right) = (Some(left), Some(right));
        }
        Some(row)
    }

    /// Where the middle of the thing is to be, robot frame.
    fn target(&self, around: &DriftAround) -> Point<Robot> {
        let [x_m, y_m] = evaluation_places_m()[self.at];
        Point::new(x_m, y_m, around.model.rig().table.height_m + 0.5 * self.thing.height_m)
    }

    /// Nothing is seen at this place: that is written down, too.
    fn miss(&mut self, around: &DriftAround, context: &mut Context<'_>) {
        self.looks.clear();
        self.add_rows(self.row(around, None));
        self.go_to(self.at + 1, around, context);
    }

    /// They are to be kept at once, whatever was before.
    fn add_rows(&mut self, rows: impl IntoIterator<Item = LocalizationRow>) {
        self.rows.extend(rows);
        self.is_newer = true;
        if let Some((again, _)) = &mut self.unkept {
            *again = None;
        }
    }

    fn go_to(&mut self, at: usize, around: &DriftAround, context: &mut Context<'_>) {
        let Some([x_m, y_m]) = evaluation_places_m().get(at).copied() else {
            return self.end(around, context);
        };
        self.at = at;
        self.stage = if around.twin.is_some() {
            let toy = self.thing.class.to_lowercase();
            context.control(TwinCommand::PlaceToy { toy, x_m, y_m }.into());
            Stage::Lies(context.time.instant + SETTLES)
        } else {
            Stage::Asks
        };
    }

    /// Writes what was measured, unless that is being done.
    pub fn keep(&mut self, sessions: PathBuf, around: &DriftAround, context: &mut Context<'_>) {
        let waits =
            self.unkept.as_ref().is_some_and(|(again, _)| again.is_some_and(|at| context.time.instant < at));
        if !self.is_newer || self.keeping.is_some() || waits {
            return;
        }
        self.is_newer = false;
        self.keeping = Some(context.start(DriftWork::KeepGrid {
            sessions,
            folder: self.folder.clone(),
            rows: self.rows.as_slice().into(),
            rig: around.model.rig().clone(),
            began: self.began,
        }));
    }

    /// It is on disk; `false`: that was of another one.
    pub fn kept(&mut self, id: JobId, folder: PathBuf) -> bool {
        let mine = self.keeping.take_if(|keeping| *keeping == id).is_some();
        if mine {
            self.folder = Some(folder);
            self.unkept = None;
        }
        mine
    }

    /// It could not be written; it is tried again a while later, or with the next place.
    pub fn not_kept(&mut self, id: JobId, why: Option<&str>, now: Instant) {
        if self.keeping.take_if(|keeping| *keeping == id).is_some() {
            self.is_newer = true;
            self.unkept = Some((Some(now + TRIED_AGAIN), why.unwrap_or("it was cancelled").to_owned()));
        }
    }

    /// Whether something was measured that is not on disk, and could not be written.
    pub fn is_unkept(&self) -> bool {
        self.unkept.is_some()
    }

    pub fn view(&self, around: &DriftAround) -> GridRunView {
        let doing = match self.stage {
            Stage::Asks => GridDoing::Asks,
            Stage::Lies(_) => GridDoing::Lays,
            Stage::Looks(_) if self.is_blind => GridDoing::NoDetector,
            Stage::Looks(_) => GridDoing::Looks { looks: self.looks.len(), of: LOOKS },
            Stage::NotSeen => GridDoing::NotSeen,
            Stage::Ended => GridDoing::Ended,
        };
        let [measured, of] = self.seen();
        GridRunView {
            object: self.thing.class,
            place: self.at + 1,
            of,
            at_m: evaluation_places_m()[self.at],
            places_by_itself: around.twin.is_some(),
            doing,
            measured,
            session: self.folder.clone(),
            unkept: self.unkept.as_ref().map(|(_, why)| why.clone()),
        }
    }
}
