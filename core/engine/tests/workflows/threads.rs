//! The engine with its threads, on folders of synthetic pairs.

use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use plumbline_engine::view::{JobState, SourceStatus};
use plumbline_engine::{
    Engine, EngineSettings, EyesCommand, LiveCommand, Products, SourceCommand, SourceSpec, View,
};

use crate::common::{board, board_pairs, write_pairs};

const PATIENCE: Duration = Duration::from_secs(60);

struct Bench {
    engine: Engine,
    woken: crossbeam_channel::Receiver<()>,
    folder: tempfile::TempDir,
}

impl Bench {
    fn start() -> Self {
        let folder = tempfile::tempdir().expect("temporary folder");
        write_pairs(&folder.path().join("pairs"), board_pairs());
        let (wake, woken) = crossbeam_channel::bounded(1);
        let settings =
            EngineSettings { data_dir: Some(folder.path().join("data")), source: None, twin: None };
        let engine = Engine::start(
            settings,
            Arc::new(move || {
                let _ = wake.try_send(());
            }),
        );
        Self { engine, woken, folder }
    }

    fn pairs(&self) -> SourceSpec {
        SourceSpec::Folder(self.folder.path().join("pairs"))
    }

    /// Waits for a view that fulfills this.
    fn until(&self, what: &str, fulfilled: impl Fn(&View) -> bool) -> Arc<View> {
        let begun = Instant::now();
        loop {
            let view = self.engine.view();
            if fulfilled(&view) {
                return view;
            }
            assert!(begun.elapsed() < PATIENCE, "never: {what}; notices {:?}", view.notices);
            let _ = self.woken.recv_timeout(Duration::from_millis(100));
        }
    }
}

#[test]
fn a_folder_is_opened_collected_solved_accepted_and_rectified_live() {
    let bench = Bench::start();
    let (columns, rows) = board().squares();
    bench.engine.send(EyesCommand::ChooseBoard { columns, rows, square_m: board().square_m });
    bench.engine.send(SourceCommand::Open(bench.pairs()));
    bench.until("a picture", |view| view.live.raw.is_some());
    bench.engine.send(EyesCommand::CollectRecording);
    bench.until("all pairs", |view| view.eyes.collected.len() == board_pairs().len());
    bench.engine.send(EyesCommand::Solve);
    bench.until("a proposal", |view| view.eyes.proposal.is_some());
    bench.engine.send(EyesCommand::Accept);
    bench.until("a calibration", |view| view.eyes.in_use.is_some());
    bench.engine.send(LiveCommand::Want(Products {
        rectified: true,
        disparity: true,
        corners: true,
        detections: false,
    }));
    let view = bench.until("all products", |view| {
        view.live.rectified.is_some() && view.live.disparity.is_some() && view.live.corners.is_some()
    });
    let (rectified, disparity) =
        (view.live.rectified.as_ref().expect("there"), view.live.disparity.as_ref().expect("there"));
    assert_eq!(rectified.stamp, disparity.stamp);
    // What was accepted is also written on the timeline, meanwhile.
    let is_done = |view: &View| view.jobs.iter().all(|job| matches!(job.state, JobState::Done { .. }));
    bench.until("all work to be done", is_done);

    // A picture that stands still is computed anew when something else is wanted.
    bench.engine.send(SourceCommand::Pause);
    bench.until("paused", |view| view.source.status == SourceStatus::Paused);
    bench.engine.send(LiveCommand::Want(Products::default()));
    bench.until("nothing", |view| view.live.rectified.is_none());
    bench.engine.send(LiveCommand::Want(Products { rectified: true, ..Products::default() }));
    bench.until("the rectified pair again", |view| view.live.rectified.is_some());
}

#[test]
fn stepping_shows_the_pair_asked_for() {
    let bench = Bench::start();
    bench.engine.send(SourceCommand::Open(bench.pairs()));
    bench.until("a picture", |view| view.live.raw.is_some());
    bench.engine.send(SourceCommand::Seek(7));
    bench.engine.send(SourceCommand::Pause);
    let name = |view: &View| view.live.raw.as_ref().and_then(|frame| frame.name.clone());
    bench.until("pair 7", |view| name(view).as_deref() == Some("07.png"));
    bench.engine.send(SourceCommand::Step(-1));
    bench.until("pair 6", |view| name(view).as_deref() == Some("06.png"));
}

#[test]
fn a_lost_folder_is_said_everything_else_goes_on_and_it_comes_back() {
    let bench = Bench::start();
    let (there, away) = (bench.folder.path().join("pairs"), bench.folder.path().join("away"));
    bench.engine.send(SourceCommand::Open(bench.pairs()));
    bench.engine.send(SourceCommand::PairsPerSecond(50.0));
    bench.until("a picture", |view| view.live.raw.is_some());
    std::fs::rename(&there, &away).expect("moved");
    let view = bench.until("lost", |view| matches!(view.source.status, SourceStatus::Lost { .. }));
    let SourceStatus::Lost { reason, .. } = &view.source.status else { panic!("lost") };
    assert!(reason.contains("bring it back"), "{reason}");
    assert!(view.live.raw.is_some(), "the last picture stays");
    bench.engine.send(EyesCommand::RecognizeBoard);
    bench.until("an answer", |view| view.eyes.board_seen.is_some());
    std::fs::rename(&away, &there).expect("moved back");
    bench.engine.send(SourceCommand::Retry);
    bench.until("back", |view| view.source.status == SourceStatus::Running);
}

#[test]
fn bad_sources_are_told_and_change_nothing() {
    let bench = Bench::start();
    bench.engine.send(SourceCommand::Open(bench.pairs()));
    bench.until("a picture", |view| view.live.raw.is_some());
    let empty = bench.folder.path().join("empty");
    std::fs::create_dir(&empty).expect("made");
    let told =
        |text: &'static str| move |view: &View| view.notices.iter().any(|notice| notice.text.contains(text));
    for (path, text) in [(empty.as_path(), "holds no"), (Path::new("/no/such/folder"), "does not exist")] {
        bench.engine.send(SourceCommand::OpenPaths(vec![path.to_path_buf()]));
        bench.until(text, told(text));
    }
    assert_eq!(bench.engine.view().source.spec, Some(bench.pairs()));
}

#[test]
fn an_engine_ends_quickly_even_in_the_middle_of_work() {
    let bench = Bench::start();
    bench.engine.send(SourceCommand::Open(bench.pairs()));
    bench.until("a picture", |view| view.live.raw.is_some());
    // The wrong board: the thorough search takes its time on every image.
    bench.engine.send(EyesCommand::ChooseBoard { columns: 12, rows: 9, square_m: 0.02 });
    bench.engine.send(EyesCommand::CollectRecording);
    bench.until("at work", |view| view.running_job().is_some());
    let begun = Instant::now();
    drop(bench.engine);
    assert!(begun.elapsed() < Duration::from_secs(10), "{:?}", begun.elapsed());
}
