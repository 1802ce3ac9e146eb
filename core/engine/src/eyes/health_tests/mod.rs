//! Calibrations judged by rendered pairs: what is said, and what is then offered.

use std::sync::{Arc, OnceLock};
use std::time::{Duration, Instant};

use image::{DynamicImage, GrayImage, RgbImage};
use nalgebra::{Isometry3, Vector3};
use plumbline_hardware::SourceSpec;
use plumbline_model::robot::default_rig;
use plumbline_model::{
    CalibrationOptions, Evidence, Stamp, StereoCalibration, StereoCameras, StereoFrame, Unattended,
    default_board,
};
use plumbline_vision::health::turned;
use plumbline_vision::synthetic::{Plane, Scene, granite_texture};
use tempfile::TempDir;

use super::command::EyesCommand;
use super::view::{
    AcceptedCalibration, EyesHealth, EyesView, HealthFigures, HealthState, Origin, Proposal, ProposalHealth,
};
use super::work::{EyesResult, EyesWork, HealthEnded};
use super::{EyesAround, EyesWorkflow};
use crate::ground::jobs::JobId;
use crate::ground::jobs::list::JobList;
use crate::ground::notice::Notices;
use crate::ground::stage::Skipped;
use crate::ground::step::StepState;
use crate::ground::{Asked, Context, LongWork as _, Moment, Nothing, Time, Workflow as _};
use crate::source::view::{ReplayView, SourceStatus, SourceView};

mod by_itself;
mod when;

struct Desk {
    room: EyesWorkflow,
    around: EyesAround,
    notices: Notices,
    jobs: JobList,
    time: Time,
    started: Vec<(JobId, EyesWork)>,
    _folder: TempDir,
}

impl Desk {
    /// Eyes as the rig has them look at a table and a wall; a calibration is in use whose right eye is off by so much.
    fn new(in_use_off_deg: f64) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let source = SourceView {
            spec: Some(SourceSpec::Cameras { left_index: 0, right_index: 2 }),
            status: SourceStatus::Running,
            opened: 1,
            ..SourceView::default()
        };
        let mut room = EyesWorkflow::new(folder.path());
        room.in_use = Some(Arc::new(accepted(in_use_off_deg)));
        let time = Time::now();
        let around = EyesAround {
            newest: Some(frame(seen(), time)),
            source: Arc::new(source),
            twin_on_s: None,
            rig: default_rig(),
            arm_moves: false,
            is_watched: false,
            drifted: None,
            is_corrected: false,
        };
        Self {
            room,
            around,
            notices: Notices::default(),
            jobs: JobList::default(),
            time,
            started: vec![],
            _folder: folder,
        }
    }

    fn propose(&mut self, off_deg: f64) {
        self.room.proposal = Some(Arc::new(Proposal {
            calibration: calibration(off_deg),
            origin: Origin::Imported { file: "another.toml".to_owned() },
            difference: None,
            uncertainty: None,
            stated_at_m: 0.45,
            depth_per_px_m: None,
            doubts: vec![],
            stale: None,
        }));
    }

    /// The calibration in use says that the cameras had been on for so long.
    fn calibrated_after(&mut self, minutes: f64) {
        let in_use = self.room.in_use.as_ref().expect("one is in use");
        let calibration = timed(&in_use.calibration, minutes);
        self.room.in_use =
            Some(Arc::new(AcceptedCalibration { calibration, ..AcceptedCalibration::clone(in_use) }));
    }

    fn with(&mut self, act: impl FnOnce(&mut EyesWorkflow, &EyesAround, &mut super::work::Context<'_>)) {
        let mut asked: Vec<Asked<EyesWork, Nothing>> = vec![];
        let Self { room, around, notices, jobs, time, .. } = self;
        act(room, around, &mut Context::new(notices, jobs, *time, &mut asked));
        for one in asked {
            if let Asked::Start(id, work) = one {
                self.started.push((id, work));
            }
        }
    }

    fn ask(&mut self, command: EyesCommand) {
        self.with(|room, around, context| room.apply(command, around, context));
    }

    /// A second passes, and a pair comes.
    fn see(&mut self, images: [Arc<RgbImage>; 2]) {
        self.time = self.time.after(Duration::from_secs(1));
        let frame = frame(images, self.time);
        self.with(|room, around, context| room.saw(&frame, around, context));
    }

    /// So much time passes without a pair.
    fn wait(&mut self, time: Duration) {
        self.time = self.time.after(time);
        if self.room.is_overdue(self.time.instant) {
            self.with(|room, around, context| room.time_passes(around, context));
        }
    }

    /// What is being judged ends.
    fn end_judging(&mut self) {
        let (id, work) = self.started.pop().expect("it is judged");
        let result = work.run(&Unattended).expect("not cancelled");
        self.with(|room, around, context| room.work_done(id, result, around, context));
    }

    /// Pairs come, one a second, until they are judged.
    fn until_judging(&mut self) {
        self.until_judging_with(&dark());
    }

    fn until_judging_with(&mut self, images: &[Arc<RgbImage>; 2]) {
        for _ in 0..200 {
            if !self.started.is_empty() {
                return;
            }
            self.see(images.clone());
        }
        panic!("it is never judged");
    }

    /// What is being judged ends at once, and the calibration in use looks bad.
    fn looks_bad(&mut self) {
        let (id, _) = self.started.pop().expect("it is judged");
        let in_use = HealthFigures {
            is_good: false,
            off_m: [0.01, 0.02, 0.03],
            sigma_m: [0.001; 3],
            turn_rad: 0.01,
            epipolar_px: 2.0,
        };
        let health = EyesHealth { in_use, proposed: None, pairs: 4, places: 900 };
        let state = HealthState::Judged(Arc::new(health));
        let result = EyesResult::Health(HealthEnded { state, busy: Duration::ZERO });
        self.with(|room, around, context| room.work_done(id, result, around, context));
    }

    /// A minute passes, a pair a second, and what is judged ends; how often that was.
    fn minute(&mut self, images: &[Arc<RgbImage>; 2]) -> usize {
        (0..60).filter(|_| self.second(images)).count()
    }

    /// Sees for a second; whether something was judged.
    fn second(&mut self, images: &[Arc<RgbImage>; 2]) -> bool {
        self.see(images.clone());
        let is_judged = matches!(self.started.last(), Some((_, EyesWork::Health(_))));
        if is_judged {
            self.end_judging();
        }
        is_judged
    }

    /// The source has something new.
    fn source(&mut self, change: impl FnOnce(&mut SourceView)) {
        change(Arc::make_mut(&mut self.around.source));
        self.with(|room, around, context| room.source_changed(around, context));
    }

    /// Asks, sees four pairs, and waits for what comes of them.
    fn judged(&mut self, images: &[Arc<RgbImage>; 2]) -> HealthState {
        self.around.newest = Some(frame(images.clone(), self.time));
        self.ask(EyesCommand::JudgeHealth);
        for pairs in 1..4 {
            assert_eq!(self.view().health.state, HealthState::Gathering { pairs, of: 4 });
            self.see(images.clone());
        }
        assert_eq!(self.view().health.state, HealthState::Judging);
        let (id, work) = self.started.pop().expect("it is judged");
        let result = work.run(&Unattended).expect("not cancelled");
        assert!(matches!(result, EyesResult::Health(_)), "{result:?}");
        self.with(|room, around, context| room.work_done(id, result, around, context));
        self.view().health.state.clone()
    }

    fn health(&mut self) -> EyesHealth {
        match self.judged(&seen()) {
            HealthState::Judged(health) => *health,
            other => panic!("{other:?}"),
        }
    }

    fn view(&mut self) -> Arc<EyesView> {
        let moment = Moment { now: self.time.instant, skipped: Skipped::default() };
        self.room.view(&self.around, &moment)
    }

    fn said(&mut self) -> Vec<String> {
        self.notices.view().iter().map(|notice| notice.text.clone()).collect()
    }

    /// Whether the proposal is put in use when that is asked for.
    fn accepts(&mut self) -> bool {
        self.ask(EyesCommand::Accept);
        matches!(self.started.pop(), Some((_, EyesWork::Accept(_))))
    }
}

fn accepted(off_deg: f64) -> AcceptedCalibration {
    AcceptedCalibration {
        id: "in use".to_owned(),
        calibration: calibration(off_deg),
        accepted: jiff::Timestamp::UNIX_EPOCH,
        uncertainty: None,
        stated_at_m: 0.45,
        depth_per_px_m: None,
    }
}

/// A recording that was paused.
fn held_still() -> ReplayView {
    ReplayView {
        position: Some(3),
        length: 9,
        playing: false,
        looping: true,
        pairs_per_second: None,
        growth: Default::default(),
    }
}

fn turned_by(cameras: &StereoCameras, pan_deg: f64) -> StereoCameras {
    turned(cameras, &Vector3::new(0.0, pan_deg.to_radians(), 0.0))
}

/// Of the rig's eyes, the right one off by so much.
fn calibration(off_deg: f64) -> Arc<StereoCalibration> {
    Arc::new(StereoCalibration::bare(turned_by(&default_rig().eyes.cameras, off_deg)))
}

/// A table and a wall; rendered once.
fn seen() -> [Arc<RgbImage>; 2] {
    static SEEN: OnceLock<[Arc<RgbImage>; 2]> = OnceLock::new();
    SEEN.get_or_init(rendered).clone()
}

fn rendered() -> [Arc<RgbImage>; 2] {
    let table = Isometry3::new(Vector3::new(0.0, 0.25, 0.5), Vector3::new(1.9, 0.0, 0.0));
    let wall = Isometry3::translation(0.0, 0.0, 1.6);
    let planes =
        vec![Plane::new(table, granite_texture(0.012, 7)), Plane::new(wall, granite_texture(0.05, 8))];
    let scene = Scene { planes, balls: vec![], background: 90.0 };
    let (left, right) = scene.render_pair(&default_rig().eyes.cameras, 1.0, 3);
    let rgb = |gray: GrayImage| Arc::new(DynamicImage::ImageLuma8(gray).to_rgb8());
    [rgb(left), rgb(right)]
}

fn dark() -> [Arc<RgbImage>; 2] {
    [0, 1].map(|_| Arc::new(RgbImage::from_pixel(640, 480, image::Rgb([3; 3]))))
}

fn frame([left, right]: [Arc<RgbImage>; 2], time: Time) -> StereoFrame {
    let stamp = Stamp { seq: 1, captured_at: time.instant };
    StereoFrame { stamp, left, right, time_difference_s: None, name: None, beside: Default::default() }
}

/// The same, made when the cameras had been on for so long.
fn timed(calibration: &StereoCalibration, minutes: f64) -> Arc<StereoCalibration> {
    let evidence = Evidence {
        board: default_board(),
        options: CalibrationOptions::default(),
        observations: vec![],
        dropped_pairs: vec![],
        created: jiff::Timestamp::UNIX_EPOCH,
        software: String::new(),
        minutes_since_on: Some(minutes),
        source: String::new(),
    };
    Arc::new(StereoCalibration { evidence: Some(evidence), ..calibration.clone() })
}

#[test]
fn a_calibration_that_holds_passes_and_one_whose_eye_has_turned_does_not() {
    let health = Desk::new(0.0).health();
    assert!(health.in_use.is_good && health.proposed.is_none() && health.pairs == 4, "{health:?}");
    assert!(health.in_use.off_m.iter().all(|off_m| *off_m < 4e-3), "{health:?}");
    let off = Desk::new(0.6).health().in_use;
    assert!(!off.is_good && (off.turn_rad.to_degrees() - 0.6).abs() < 0.05, "{off:?}");
    let [near_m, middle_m, far_m] = off.off_m;
    assert!(near_m < middle_m && middle_m < far_m && far_m > 0.02, "{off:?}");
}

#[test]
fn a_proposal_that_is_worse_or_cannot_be_told_apart_is_not_put_in_use() {
    for (proposed_deg, expected) in [(0.6, ProposalHealth::Worse), (5e-4, ProposalHealth::Undecided)] {
        let mut desk = Desk::new(0.0);
        desk.propose(proposed_deg);
        let health = desk.health();
        let (figures, verdict) = health.proposed.expect("both are judged");
        assert_eq!(verdict, expected, "{health:?}");
        assert!(desk.view().health.is_against_proposal());
        assert!(!desk.accepts(), "{expected:?}");
        assert!(desk.said().iter().any(|text| text.contains("not put in use")), "{:?}", desk.said());
        assert_eq!(figures.is_good, expected == ProposalHealth::Undecided);
        // Another one is not what was judged.
        desk.propose(0.0);
        assert!(!desk.view().health.is_against_proposal() && desk.accepts());
    }
}

#[test]
fn a_proposal_that_is_better_is_put_in_use() {
    let mut desk = Desk::new(0.6);
    desk.propose(0.0);
    let health = desk.health();
    assert_eq!(health.proposed.map(|(_, verdict)| verdict), Some(ProposalHealth::Better), "{health:?}");
    assert!(!desk.view().health.is_against_proposal() && desk.accepts());
}

#[test]
fn in_the_dark_nothing_is_said_of_it_and_without_a_calibration_or_image_nothing_is_looked_at() {
    let mut desk = Desk::new(0.0);
    desk.propose(0.6);
    let state = desk.judged(&dark());
    assert!(matches!(state, HealthState::Failed(_)), "{state:?}");
    assert!(!desk.view().health.is_against_proposal() && desk.accepts(), "nobody knows that it is worse");
    desk.around.newest = None;
    desk.ask(EyesCommand::JudgeHealth);
    assert!(desk.said().iter().any(|text| text.contains("no image")), "{:?}", desk.said());
    desk.room.in_use = None;
    desk.ask(EyesCommand::JudgeHealth);
    assert!(desk.said().iter().any(|text| text.contains("No calibration is in use")), "{:?}", desk.said());
    assert!(desk.started.is_empty());
}

#[test]
fn photographs_are_judged_at_once_and_pairs_of_other_eyes_are_not_mixed() {
    let mut desk = Desk::new(0.0);
    desk.ask(EyesCommand::JudgeHealth);
    Arc::make_mut(&mut desk.around.source).opened = 2;
    desk.see(dark());
    assert!(desk.started.is_empty() && !desk.room.wants_pairs());
    assert!(desk.said().iter().any(|text| text.contains("Other eyes were opened")), "{:?}", desk.said());
    Arc::make_mut(&mut desk.around.source).photographs = true;
    desk.ask(EyesCommand::JudgeHealth);
    assert!(matches!(&desk.started[..], [(_, EyesWork::Health(work))] if work.pairs.len() == 1));
}

#[test]
fn where_no_more_pairs_come_none_are_waited_for_and_it_can_be_asked_again() {
    let stop: [fn(&mut SourceView); 3] = [
        |source| {
            let reason = "unplugged".to_owned();
            source.status = SourceStatus::Lost { reason, since: Instant::now(), attempts: 0 };
        },
        |source| *source = SourceView { opened: source.opened, ..SourceView::default() },
        |source| source.replay = Some(held_still()),
    ];
    for stop in stop {
        let mut desk = Desk::new(0.0);
        desk.ask(EyesCommand::JudgeHealth);
        desk.see(seen());
        let going = desk.around.source.clone();
        desk.source(|_| {});
        assert_eq!(desk.view().health.state, HealthState::Gathering { pairs: 2, of: 4 }, "they still come");
        desk.source(stop);
        assert_eq!(desk.view().health.state, HealthState::NotAsked, "{:?}", desk.around.source);
        assert!(desk.said().iter().any(|text| text.contains("No more pairs come")), "{:?}", desk.said());
        desk.source(|source| *source = SourceView::clone(&going));
        desk.ask(EyesCommand::JudgeHealth);
        desk.see(seen());
        // Asked while pairs are gathered, it begins anew.
        desk.ask(EyesCommand::JudgeHealth);
        assert_eq!(desk.view().health.state, HealthState::Gathering { pairs: 1, of: 4 });
    }
}

#[test]
fn what_was_judged_stands_while_it_is_judged_again_and_when_nothing_comes_of_that() {
    let mut desk = Desk::new(0.0);
    desk.propose(0.6);
    let health = desk.health();
    assert_eq!(health.proposed.map(|(_, verdict)| verdict), Some(ProposalHealth::Worse), "{health:?}");
    let is_refused = |desk: &mut Desk| desk.view().health.is_against_proposal() && !desk.accepts();
    desk.ask(EyesCommand::JudgeHealth);
    assert!(is_refused(&mut desk), "while pairs are gathered");
    (0..3).for_each(|_| desk.see(dark()));
    assert_eq!(desk.view().health.state, HealthState::Judging);
    assert!(desk.view().health.is_against_proposal(), "while it is computed");
    let state = desk.judged(&dark());
    assert!(matches!(state, HealthState::Failed(_)), "{state:?}");
    assert!(is_refused(&mut desk), "in the dark nothing else is known");
    desk.propose(0.0);
    assert!(!desk.view().health.is_against_proposal(), "another one is not what was judged");
}

#[test]
fn whoever_asks_has_an_answer_within_ten_seconds_however_slowly_pairs_come() {
    let mut desk = Desk::new(0.0);
    desk.ask(EyesCommand::JudgeHealth);
    let asked = desk.time.instant;
    desk.wait(Duration::from_millis(2500));
    desk.see(seen());
    desk.wait(Duration::from_secs(1));
    assert_eq!(desk.view().health.state, HealthState::Gathering { pairs: 2, of: 4 });
    // No more come: what is there is judged.
    desk.wait(Duration::from_millis(600));
    assert_eq!(desk.view().health.state, HealthState::Judging);
    let [(_, EyesWork::Health(work))] = &desk.started[..] else { panic!("{:?}", desk.started) };
    assert_eq!(work.pairs.len(), 2);
    assert!(work.until < asked + Duration::from_secs(10), "what is matched until then is judged");
    // The machine is busy with something else.
    desk.wait(Duration::from_millis(4950));
    let state = desk.view().health.state.clone();
    assert!(desk.time.instant <= asked + Duration::from_millis(10_200));
    assert!(
        matches!(&state, HealthState::Failed(why) if why.contains("Not enough was seen") && why.contains("ask again")),
        "{state:?}"
    );
    // What comes of it later is of nobody's question.
    desk.end_judging();
    assert_eq!(desk.view().health.state, state);
    // Where time is over before a place was matched, that is an outcome.
    desk.ask(EyesCommand::JudgeHealth);
    (0..3).for_each(|_| desk.see(seen()));
    let Some((id, EyesWork::Health(mut work))) = desk.started.pop() else { panic!("nothing is judged") };
    work.until = Instant::now();
    let result = EyesWork::Health(work).run(&Unattended).expect("not cancelled");
    desk.with(|room, around, context| room.work_done(id, result, around, context));
    let state = desk.view().health.state.clone();
    assert!(matches!(&state, HealthState::Failed(why) if why.contains("close other programs")), "{state:?}");
}

#[test]
fn a_proposal_is_judged_by_itself_but_not_while_the_arm_moves() {
    let mut desk = Desk::new(0.0);
    desk.see(seen());
    desk.propose(0.6);
    desk.around.arm_moves = true;
    (0..8).for_each(|_| desk.see(seen()));
    assert!(desk.started.is_empty() && !desk.room.wants_pairs());
    desk.around.arm_moves = false;
    (0..4).for_each(|_| desk.see(seen()));
    assert!(desk.room.wants_pairs());
    // It begins to move while pairs are gathered: they are let go.
    desk.around.arm_moves = true;
    desk.see(seen());
    assert!(!desk.room.wants_pairs() && desk.said().is_empty(), "{:?}", desk.said());
    desk.around.arm_moves = false;
    (0..9).for_each(|_| desk.see(seen()));
    desk.end_judging();
    assert!(desk.view().health.is_against_proposal() && !desk.accepts(), "it is worse");
    (0..30).for_each(|_| desk.see(seen()));
    assert!(desk.started.is_empty(), "once is enough");
}

#[test]
fn a_calibration_that_does_not_hold_is_told_once() {
    let mut desk = Desk::new(0.6);
    let seconds_to_next = |desk: &mut Desk| (1..3600).find(|_| desk.second(&seen())).expect("judged");
    seconds_to_next(&mut desk);
    assert_eq!(desk.said(), Vec::<String>::new(), "once may be a hand before an eye");
    let soon_s = seconds_to_next(&mut desk);
    assert!((15..=30).contains(&soon_s), "and is looked at again soon: {soon_s} s");
    let said = desk.said();
    // Its pace is that of this machine: no more than a small share of it.
    assert!(seconds_to_next(&mut desk) >= 120, "from then on it rests for two minutes at least");
    let [words] = &said[..] else { panic!("{said:?}") };
    assert!(words.contains("does not hold any more") && words.contains("mm far"), "{words}");
    assert!(!desk.view().health.judged.as_ref().expect("judged").in_use.is_good);
    assert_eq!(desk.view().step, StepState::Stale { why: words.clone() }, "it stays to be seen");
    // Who asks reads it where he has asked.
    assert!(!desk.health().in_use.is_good);
    assert_eq!(desk.said().len(), 1);
}

#[test]
fn nobody_is_disturbed_by_what_is_looked_at_by_itself() {
    let mut desk = Desk::new(0.0);
    let health = desk.health();
    (0..4).for_each(|_| _ = desk.minute(&dark()));
    assert_eq!(desk.said(), Vec::<String>::new());
    assert_eq!(desk.view().health.state, HealthState::Judged(Arc::new(health)), "at night nothing is news");
    // What watches drift, and what a law of time takes off, is none of it; nor is a recording.
    let quiet: [fn(&mut EyesAround); 3] = [
        |around| around.is_watched = true,
        |around| around.is_corrected = true,
        |around| {
            Arc::make_mut(&mut around.source).replay = Some(ReplayView { playing: true, ..held_still() })
        },
    ];
    for make_quiet in quiet {
        let mut desk = Desk::new(0.6);
        make_quiet(&mut desk.around);
        let judged: usize = (0..5).map(|_| desk.minute(&dark())).sum();
        assert_eq!(judged, 0);
    }
}

#[test]
fn one_that_cannot_be_told_apart_is_offered_where_it_alone_says_how_warm_the_eyes_were() {
    let mut desk = Desk::new(0.0);
    desk.propose(5e-4);
    let proposal = desk.room.proposal.as_ref().expect("proposed");
    let calibration = timed(&proposal.calibration, 20.0);
    desk.room.proposal = Some(Arc::new(Proposal { calibration, ..Proposal::clone(proposal) }));
    let health = desk.health();
    assert_eq!(health.proposed.map(|(_, verdict)| verdict), Some(ProposalHealth::KnowsWhen), "{health:?}");
    assert!(!desk.view().health.is_against_proposal() && desk.accepts());
}
