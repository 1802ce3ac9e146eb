//! Whether it records, and what is handed to the recorder.

use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use jiff::Timestamp;
use plumbline_hardware::SourceSpec;
use plumbline_model::{Eye, EyesThen, PixelBox, StereoCameras, StereoFrame};
use plumbline_recording::{EyePlaces, JointGoal, JointReading, Level, Note, Outline, Topic};
use serde_json::{Value, json};

use super::command::RecordingCommand;
use super::export::ExportLerobot;
use super::recorder::{Item, Recorder, Written};
use super::view::{Recorded, RecordedSoFar, RecordingState, RecordingView};
use super::work::{Context, RecordingResult, RecordingWork};
use crate::detect::view::{DetectionsView, ObjectView, SeenBox};
use crate::ground::jobs::JobId;
use crate::ground::notice::{Notice, NoticeLevel};
use crate::ground::{Moment, Nothing, Time, Workflow, World};
use crate::robot::view::{JointView, RobotView};

/// So many pairs are remembered for what is found in them later: two seconds of them.
const REMEMBERED: usize = 60;

/// What the workflow can see of the rest.
pub struct RecordingAround {
    /// Whose eyes the source shows.
    pub world: World,
    /// Whether a source delivers, and nothing that was recorded before.
    pub is_live: bool,
    /// Which source, counted.
    pub opened: u64,
    /// What it is; `None`: none is open.
    pub spec: Option<SourceSpec>,
    /// Pairs that its own queue replaced by newer ones, counted since it was opened.
    pub superseded: u64,
    /// Name of the rig.
    pub rig: String,
    /// The calibration of the eyes in use.
    pub cameras: Option<StereoCameras>,
}

/// Recording. There is one at a time, of what is shown.
#[derive(Clone, Debug, Default)]
pub struct RecordingWorkflow {
    data_dir: PathBuf,
    phase: Phase,
    /// When it was begun.
    since: Option<Time>,
    /// Of which source.
    spec: Option<SourceSpec>,
    /// Its number, counted, when it was opened last.
    opened: u64,
    /// The source as it was seen last.
    seen: Seen,
    /// Pairs of all sources that were replaced by a newer one before anybody saw them.
    replaced: u64,
    /// Number of the newest message that is in it.
    noted: u64,
    /// Numbers of the newest pairs that are in it, and at which time each stands.
    times: VecDeque<(u64, Timestamp)>,
    last: Option<Arc<Recorded>>,
    /// One is being written as a data set.
    exporting: Option<JobId>,
}

/// A source as it was seen last.
#[derive(Clone, Copy, Debug, Default)]
struct Seen {
    /// Counted.
    opened: u64,
    /// Whether it delivered.
    is_live: bool,
    /// Pairs that its own queue had replaced.
    superseded: u64,
}

#[derive(Clone, Debug, Default)]
enum Phase {
    #[default]
    Off,
    Begins(JobId),
    On(Recorder),
    Ends(JobId, Recorded),
}

impl RecordingWorkflow {
    fn recorder(&self) -> Option<&Recorder> {
        match &self.phase {
            Phase::On(recorder) => Some(recorder),
            _ => None,
        }
    }

    /// Takes the recorder away: nothing more is recorded.
    pub fn take(&mut self) -> Option<Recorder> {
        match std::mem::take(&mut self.phase) {
            Phase::On(recorder) => Some(recorder),
            _ => None,
        }
    }

    /// Whether something is to be handed over.
    pub fn is_on(&self) -> bool {
        self.recorder().is_some()
    }

    /// A pair has come; how and where the eyes are, as far as that is known.
    pub fn saw(&mut self, frame: &StereoFrame, eyes: EyesThen, places: Option<EyePlaces>, time: Time) {
        let Some(recorder) = self.recorder() else { return };
        let at = time.day_at(frame.stamp.captured_at);
        recorder.put(Item::Pair {
            at,
            number: frame.stamp.seq,
            images: [frame.left.clone(), frame.right.clone()],
            jpegs: frame.beside.jpegs.clone(),
            right_later_s: frame.time_difference_s,
            eyes,
            places: places.map(Box::new),
        });
        self.times.push_back((frame.stamp.seq, at));
        if self.times.len() > REMEMBERED {
            self.times.pop_front();
        }
    }

    /// So many pairs, since the program was started, were replaced by a newer one before they came here.
    pub fn were_replaced(&mut self, replaced: u64) {
        let before = std::mem::replace(&mut self.replaced, replaced);
        if let Some(recorder) = self.recorder() {
            recorder.missed(replaced.saturating_sub(before));
        }
    }

    /// Pairs of another source are not of this recording: it ends with a word. The same one may be opened again,
    /// after a loss or because its thread was started again.
    pub fn follow_source(&mut self, around: &RecordingAround, context: &mut Context<'_>) {
        self.count_superseded(around);
        // A source whose thread ended is none for a moment, under the same number.
        let is_closed = around.spec.is_none() && around.opened != self.opened;
        let is_another = around.spec.is_some() && around.spec != self.spec;
        if self.is_on() && (is_closed || is_another) {
            let text = "Another source was opened, or this one closed: the recording has ended with what came before.";
            context.notices.add(NoticeLevel::Warning, text);
            return self.stop(context);
        }
        if around.spec == self.spec {
            self.opened = around.opened;
        }
    }

    /// Pairs that the source's own queue replaced are missing, too; not those of a source that is held still.
    fn count_superseded(&mut self, around: &RecordingAround) {
        let Seen { opened, is_live, superseded } = self.seen;
        let seen = Seen { opened: around.opened, is_live: around.is_live, superseded: around.superseded };
        self.seen = seen;
        // A source that was opened anew counts anew.
        let is_anew = opened != seen.opened || seen.superseded < superseded;
        let before = if is_anew { 0 } else { superseded };
        if let Some(recorder) = self.recorder().filter(|_| seen.is_live && (is_live || is_anew)) {
            recorder.missed(seen.superseded - before);
        }
    }

    /// Joints were read. What they were told stands beside it, also where that is nothing any more.
    pub fn read(&self, robot: &RobotView, time: Time) {
        let Some(recorder) = self.recorder() else { return };
        let reading = |joint: &JointView| {
            Some(JointReading {
                name: joint.name.clone(),
                angle_rad: joint.angle_rad?,
                speed_rad_s: joint.speed_rad_s,
            })
        };
        let goal =
            |joint: &JointView| Some(JointGoal { name: joint.name.clone(), angle_rad: joint.goal_rad? });
        let readings: Vec<JointReading> = robot.joints.iter().filter_map(reading).collect();
        if !readings.is_empty() {
            let goals = robot.joints.iter().filter_map(goal).collect();
            recorder.put(Item::Joints(time.day, readings, goals));
        }
    }

    /// Something was asked for.
    pub fn asked(&self, command: &impl serde::Serialize, time: Time) {
        let Some(recorder) = self.recorder() else { return };
        if let Ok(value) = serde_json::to_value(command) {
            recorder.put(Item::Told(Topic::Commands, time.day, value));
        }
    }

    /// Things were found in a pair.
    pub fn found(&self, found: &DetectionsView, time: Time) {
        let Some(recorder) = self.recorder() else { return };
        // What is drawn over an image stands at exactly its time.
        let known = self.times.iter().find(|(number, _)| *number == found.stamp.seq);
        let at = known.map_or_else(|| time.day_at(found.stamp.captured_at), |(_, at)| *at);
        recorder.put(Item::Told(Topic::Detections, at, detections(found)));
        recorder.put(Item::Outlines(at, outlines(found)));
    }

    /// Messages that are not in it yet.
    pub fn told(&mut self, notices: &[Notice]) {
        let Some(recorder) = self.recorder() else { return };
        for notice in notices.iter().filter(|notice| notice.number > self.noted) {
            let level = match notice.level {
                NoticeLevel::Info | NoticeLevel::Success => Level::Info,
                NoticeLevel::Warning => Level::Warning,
                NoticeLevel::Error => Level::Error,
            };
            recorder.put(Item::Note(notice.at, Note { level, text: notice.text.clone() }));
        }
        self.noted = notices.last().map_or(self.noted, |newest| newest.number.max(self.noted));
    }

    /// A recorder that broke is ended, which says why.
    pub fn look_after(&mut self, context: &mut Context<'_>) {
        if self.recorder().is_some_and(Recorder::is_broken) {
            self.stop(context);
        }
    }

    fn start(&mut self, around: &RecordingAround, context: &mut Context<'_>) {
        if !matches!(self.phase, Phase::Off) {
            return context.refuse("A recording is under way: stop it first.");
        }
        if !around.is_live {
            return context.refuse("There is nothing live to record: connect the eyes, or the twin's.");
        }
        let work = RecordingWork::Begin {
            sessions: around.world.folder(&self.data_dir).join("sessions"),
            started: context.time.day,
            rig: around.rig.clone(),
            of_twin: around.world == World::Twin,
            cameras: around.cameras.map(Box::new),
        };
        (self.spec, self.opened) = (around.spec.clone(), around.opened);
        self.since = Some(context.time);
        self.phase = Phase::Begins(context.start(work));
    }

    fn export(&mut self, export: ExportLerobot, context: &mut Context<'_>) {
        if self.exporting.is_some() {
            return context.refuse("A recording is being exported: wait until that has ended, or cancel it.");
        }
        let of_now = match &self.phase {
            Phase::On(recorder) => Some(recorder.session()),
            Phase::Ends(_, recorded) => Some(recorded.session.as_path()),
            Phase::Off | Phase::Begins(_) => None,
        };
        if of_now == Some(export.session()) {
            return context.refuse("This recording is still being written: stop it first, then export it.");
        }
        self.exporting = Some(context.start(RecordingWork::Export(export)));
    }

    fn stop(&mut self, context: &mut Context<'_>) {
        let Phase::On(mut recorder) = std::mem::take(&mut self.phase) else {
            return context.refuse("Nothing is being recorded.");
        };
        recorder.close();
        let so_far = self.so_far(&recorder, context.time);
        let recorded = Recorded { session: recorder.session().to_owned(), so_far };
        self.phase = Phase::Ends(context.start(RecordingWork::End(recorder)), recorded);
    }

    fn so_far(&self, recorder: &Recorder, now: Time) -> RecordedSoFar {
        let (pairs, bytes, dropped) = recorder.so_far();
        let since = self.since.map(|since| now.instant.saturating_duration_since(since.instant));
        RecordedSoFar { time: since.unwrap_or_default(), pairs, dropped, bytes }
    }
}

/// Boxes in px, places and deviations in m in the frame of the robot.
fn detections(found: &DetectionsView) -> Value {
    let objects: Vec<Value> = found
        .objects
        .iter()
        .map(|object| {
            let seen = |seen: &Option<SeenBox>| {
                seen.as_ref().map(|seen| {
                    let PixelBox { x0_px, y0_px, x1_px, y1_px } = seen.area;
                    json!({ "box_px": [x0_px, y0_px, x1_px, y1_px], "confidence": seen.confidence })
                })
            };
            let place = object.place.as_ref().ok().map(|place| {
                let point: [f64; 3] = place.point_in_robot.coords.into();
                json!({ "point_m": point, "sigma_m": place.sigma_m })
            });
            json!({ "name": object.name, "left": seen(&object.left), "right": seen(&object.right), "place": place })
        })
        .collect();
    json!({ "pair": found.stamp.seq, "objects": objects })
}

/// Boxes in the left and in the right image, each with what it is and how sure that is.
fn outlines(found: &DetectionsView) -> [Vec<Outline>; 2] {
    Eye::BOTH.map(|eye| {
        let of_object = |object: &ObjectView| {
            let seen = object.seen(eye)?;
            let PixelBox { x0_px, y0_px, x1_px, y1_px } = seen.area;
            let text = format!("{} {:.2}", object.name, seen.confidence);
            Some(Outline { box_px: [x0_px, y0_px, x1_px, y1_px].map(f64::from), text })
        };
        found.objects.iter().filter_map(of_object).collect()
    })
}

impl Workflow for RecordingWorkflow {
    type Command = RecordingCommand;
    type Work = RecordingWork;
    type Control = Nothing;
    type Around = RecordingAround;
    type View = RecordingView;

    fn new(data_dir: &Path) -> Self {
        Self { data_dir: data_dir.to_owned(), ..Self::default() }
    }

    fn view(&mut self, _: &RecordingAround, moment: &Moment) -> Arc<RecordingView> {
        let state = match &self.phase {
            Phase::Off => RecordingState::Off,
            Phase::Begins(_) => RecordingState::Begins,
            Phase::On(recorder) => RecordingState::On {
                session: recorder.session().to_owned(),
                so_far: self.so_far(recorder, Time { instant: moment.now, day: Timestamp::UNIX_EPOCH }),
            },
            Phase::Ends(..) => RecordingState::Ends,
        };
        Arc::new(RecordingView { state, last: self.last.clone(), exporting: self.exporting })
    }

    fn apply(&mut self, command: RecordingCommand, around: &RecordingAround, context: &mut Context<'_>) {
        match command {
            RecordingCommand::Start => self.start(around, context),
            RecordingCommand::Stop => self.stop(context),
            RecordingCommand::ExportLerobot { file, folder, task } => {
                self.export(ExportLerobot { file, folder, task }, context);
            }
        }
    }

    fn work_done(
        &mut self,
        id: JobId,
        result: RecordingResult,
        around: &RecordingAround,
        context: &mut Context<'_>,
    ) {
        self.exporting.take_if(|exporting| *exporting == id);
        match (result, std::mem::take(&mut self.phase)) {
            (RecordingResult::Begun(recorder), Phase::Begins(begun)) if begun == id => {
                self.since = Some(context.time);
                self.phase = Phase::On(recorder);
                self.follow_source(around, context);
            }
            (RecordingResult::Ended(written), Phase::Ends(ended, mut recorded)) if ended == id => {
                let Written { counts, dropped } = written;
                let time = recorded.so_far.time;
                recorded.so_far = RecordedSoFar { time, pairs: counts.pairs, dropped, bytes: counts.bytes };
                self.last = Some(Arc::new(recorded));
            }
            (_, phase) => self.phase = phase,
        }
    }

    fn work_ended(&mut self, id: JobId, _: Option<&str>, _: &RecordingAround, _: &mut Context<'_>) {
        self.exporting.take_if(|exporting| *exporting == id);
        if let Phase::Begins(own) | Phase::Ends(own, _) = self.phase
            && own == id
        {
            self.phase = Phase::Off;
        }
    }
}
