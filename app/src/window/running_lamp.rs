//! What is under way, in the top line on every screen: how far it is, and by a click the way back to it.

use plumbline_engine::view::{
    GraspPhase, GraspRun, GridDoing, JobState, JobView, LampState, PartState, TouchPhase, TrialsPhase,
};
use plumbline_engine::{JobId, View};
use plumbline_widgets::format;
use plumbline_widgets::lamp::Health;

use super::lamps::{Then, TopLamp};
use crate::operator::{Screen, done_of, wanted};

/// What moves comes first; nothing stands here while nothing is under way.
pub(super) fn lamp(view: &View) -> Option<TopLamp> {
    touches(view)
        .or_else(|| experiment(view))
        .or_else(|| grasp(view))
        .or_else(|| hands(view))
        .or_else(|| head(view))
        .or_else(|| board(view))
        .or_else(|| search(view))
        .or_else(|| training(view))
        .or_else(|| places(view))
        .or_else(|| of_job(view, view.scores.evaluating, "Judging", Screen::Scores))
        .or_else(|| of_job(view, view.recording.exporting, "Export", Screen::Live))
}

fn under_way(name: &'static str, value: String, fraction: f64, screen: Screen) -> TopLamp {
    let health = Health::Working(fraction.clamp(0.0, 1.0) as f32);
    TopLamp { name, value, health, reason: None, then: Then::Go(screen) }
}

/// It does not go on before somebody has looked.
fn waits(name: &'static str, value: String, why: &str, screen: Screen) -> TopLamp {
    let reason = Some(why.to_owned());
    TopLamp { name, value, health: Health::Warning, reason, then: Then::Go(screen) }
}

/// The one that is under way, from 1, of so many, in words and as a fraction.
fn number_of(done: usize, of: usize) -> (String, f64) {
    (format!("{} of {of}", (done + 1).min(of)), done as f64 / of.max(1) as f64)
}

fn touches(view: &View) -> Option<TopLamp> {
    let touch = &view.touch;
    let (value, fraction) = number_of(done_of(touch.counts), wanted(touch.counts));
    match &touch.phase {
        TouchPhase::Running { .. } => Some(under_way("Touch", value, fraction, Screen::Touch)),
        TouchPhase::Waiting { what, .. } => Some(waits("Touch", value, what, Screen::Touch)),
        _ => None,
    }
}

fn experiment(view: &View) -> Option<TopLamp> {
    let shown = view.trials.shown.as_ref()?;
    let (value, fraction) = number_of(shown.made, shown.all);
    let name = "Experiment";
    match &view.trials.phase {
        TrialsPhase::Idle | TrialsPhase::Paused { .. } => None,
        TrialsPhase::Running { .. } => Some(arm(view, name, value, fraction)),
        TrialsPhase::Asks { .. } => {
            Some(waits(name, value, "The thing has to be laid down for the next trial.", Screen::Grasp))
        }
        TrialsPhase::WaitsForWord { .. } => {
            Some(waits(name, value, "Somebody has to say whether the thing is held.", Screen::Grasp))
        }
    }
}

/// What grasps; an arm that was made to hold goes on when somebody says so, an experiment's, too.
fn arm(view: &View, name: &'static str, value: String, fraction: f64) -> TopLamp {
    if view.grasp.phase.is_paused() {
        return waits(name, value, "The arm holds until you go on.", Screen::Grasp);
    }
    under_way(name, value, fraction, Screen::Grasp)
}

fn grasp(view: &View) -> Option<TopLamp> {
    let phase = &view.grasp.phase;
    let run = view.grasp.run.as_deref();
    let (value, fraction) = match phase {
        GraspPhase::Idle => return None,
        _ if phase.is_paused() => ("paused".to_owned(), 0.0),
        GraspPhase::Planning => ("looks".to_owned(), 0.0),
        GraspPhase::Grasping { .. } => {
            let object = run.map(|run| run.object.to_lowercase()).filter(|object| !object.is_empty());
            (object.unwrap_or_else(|| "moves".to_owned()), run.map_or(0.0, steps_done))
        }
        // One step of the hand is not counted.
        GraspPhase::Hand { step, .. } => (step.title().to_lowercase(), 0.0),
    };
    Some(arm(view, "Grasp", value, fraction))
}

/// The share of its steps that is done.
fn steps_done(run: &GraspRun) -> f64 {
    let done = run.lamps.iter().filter(|(_, lamp)| *lamp == LampState::Done).count();
    done as f64 / run.lamps.len().max(1) as f64
}

fn hands(view: &View) -> Option<TopLamp> {
    let handeye = view.handeye.is_looking.then_some(&view.handeye)?;
    let done = handeye.parts.iter().filter(|part| matches!(part.state, PartState::Done(_))).count();
    let (value, fraction) = match handeye.parts.len() {
        0 => ("looks".to_owned(), 0.0),
        of => number_of(done, of),
    };
    Some(under_way("Hand-eye", value, fraction, Screen::HandEye))
}

fn head(view: &View) -> Option<TopLamp> {
    let tour = view.mount.tour?;
    let (value, fraction) = number_of(tour.pose.saturating_sub(1), tour.of);
    if tour.waits {
        let why = "The head's joints were not heard: it turns on by itself once they are.";
        return Some(waits("Head", value, why, Screen::Mount));
    }
    Some(under_way("Head", value, fraction, Screen::Mount))
}

/// The twin's board.
fn board(view: &View) -> Option<TopLamp> {
    let tour = view.twin.board_tour?;
    let (value, fraction) = number_of(tour.place.saturating_sub(1), tour.of);
    Some(under_way("Board", value, fraction, Screen::Collect))
}

fn search(view: &View) -> Option<TopLamp> {
    of_job(view, view.gap.searching, "Find", Screen::Gap)
}

fn of_job(view: &View, id: Option<JobId>, name: &'static str, screen: Screen) -> Option<TopLamp> {
    let id = id?;
    let fraction = view.jobs.iter().find(|job| job.id == id).map_or(0.0, fraction);
    Some(under_way(name, format::percent(fraction), fraction, screen))
}

/// The 9 by 4 evaluation.
fn places(view: &View) -> Option<TopLamp> {
    let run = view.drift.grid.under_way()?;
    let (value, fraction) = number_of(run.place.saturating_sub(1), run.of);
    Some(match run.doing {
        GridDoing::Asks => {
            waits("Places", value, "The thing has to be laid at the next place.", Screen::Drift)
        }
        GridDoing::NotSeen => waits(
            "Places",
            value,
            "The thing was not found: lay it again, or leave the place out.",
            Screen::Drift,
        ),
        GridDoing::NoDetector => waits(
            "Places",
            value,
            "Nothing is being detected: choose a detector on the screen Live.",
            Screen::Drift,
        ),
        GridDoing::Lays | GridDoing::Looks { .. } | GridDoing::Ended => {
            under_way("Places", value, fraction, Screen::Drift)
        }
    })
}

fn training(view: &View) -> Option<TopLamp> {
    // Whose job it is, is not said; while models are trained, nothing else long runs as a rule.
    let fraction = view.models.training.then(|| view.running_job().map_or(0.0, fraction))?;
    Some(under_way("Training", format::percent(fraction), fraction, Screen::Models))
}

fn fraction(job: &JobView) -> f64 {
    match job.state {
        JobState::Running { fraction, .. } => fraction,
        _ => 1.0,
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use plumbline_engine::view::{
        DriftView, GraspStep, GraspView, GridRunView, GridView, HandEyeView, ModelsView, MountTour,
        MountView, RecordingView, ScoresView, TouchCounts, TouchView,
    };

    use super::*;

    fn told(view: &View) -> Option<(&'static str, String, Screen)> {
        let lamp = lamp(view)?;
        let Then::Go(screen) = lamp.then else { panic!("a click goes somewhere") };
        Some((lamp.name, lamp.value, screen))
    }

    fn touching(phase: TouchPhase) -> View {
        let counts =
            TouchCounts { planned: 82, unreachable: 2, touched: 10, missed: 1, ..TouchCounts::default() };
        View { touch: Arc::new(TouchView { phase, counts, ..TouchView::default() }), ..View::default() }
    }

    #[test]
    fn what_is_under_way_says_how_far_it_is_and_leads_to_its_screen() {
        assert_eq!(told(&View::default()), None);
        let running = TouchPhase::Running { number: Some(14), doing: "settling".to_owned() };
        let touching = touching(running);
        assert_eq!(told(&touching), Some(("Touch", "12 of 80".to_owned(), Screen::Touch)));
        let tour = Some(MountTour { pose: 3, of: 8, waits: false });
        let mount = Arc::new(MountView { tour, ..MountView::default() });
        let head = View { mount: mount.clone(), ..View::default() };
        assert_eq!(told(&head), Some(("Head", "3 of 8".to_owned(), Screen::Mount)));
        let phase = GraspPhase::Grasping { paused: false, ending: false };
        let grasp = Arc::new(GraspView { phase, ..GraspView::default() });
        let looking = Arc::new(HandEyeView { is_looking: true, ..HandEyeView::default() });
        let training = Arc::new(ModelsView { training: true, ..ModelsView::default() });
        for (view, screen) in [
            (View { grasp, ..View::default() }, Screen::Grasp),
            (View { handeye: looking, ..View::default() }, Screen::HandEye),
            (View { models: training, ..View::default() }, Screen::Models),
            (View { mount, ..touching }, Screen::Touch),
        ] {
            assert_eq!(told(&view).map(|(.., goes)| goes), Some(screen));
        }
    }

    #[test]
    fn what_is_judged_evaluated_or_exported_stands_there_with_a_way_back() {
        let run = |doing| GridRunView {
            object: "tomato",
            place: 5,
            of: 36,
            at_m: [0.3, 0.0],
            places_by_itself: false,
            doing,
            measured: 4,
            session: None,
            unkept: None,
        };
        let places = |doing| {
            let grid = GridView { run: Some(run(doing)), ..GridView::default() };
            View { drift: Arc::new(DriftView { grid, ..DriftView::default() }), ..View::default() }
        };
        let looks = places(GridDoing::Looks { looks: 1, of: 3 });
        assert_eq!(told(&looks), Some(("Places", "5 of 36".to_owned(), Screen::Drift)));
        assert_eq!(lamp(&places(GridDoing::Asks)).expect("it is under way").health, Health::Warning);
        assert!(lamp(&places(GridDoing::Ended)).is_none());
        let id = Some(JobId(7));
        let scores = Arc::new(ScoresView { evaluating: id, ..ScoresView::default() });
        let recording = Arc::new(RecordingView { exporting: id, ..RecordingView::default() });
        let judged = View { scores, ..View::default() };
        assert_eq!(told(&judged), Some(("Judging", format::percent(0.0), Screen::Scores)));
        let exported = View { recording, ..View::default() };
        assert_eq!(told(&exported), Some(("Export", format::percent(0.0), Screen::Live)));
    }

    fn grasping(paused: bool) -> View {
        let steps = [GraspStep::Approach, GraspStep::Lower, GraspStep::Close, GraspStep::Lift];
        let states = [LampState::Done, LampState::Lit, LampState::Dark, LampState::Dark];
        let lamps = steps.into_iter().zip(states).collect();
        let run = GraspRun { object: "Tomato".to_owned(), lamps, ..GraspRun::default() };
        let phase = GraspPhase::Grasping { paused, ending: false };
        let grasp = GraspView { phase, run: Some(Arc::new(run)), ..GraspView::default() };
        View { grasp: Arc::new(grasp), ..View::default() }
    }

    #[test]
    fn a_grasp_is_as_far_as_its_steps_and_paused_it_waits_also_in_an_experiment() {
        let moves = lamp(&grasping(false)).expect("it is under way");
        assert_eq!((moves.value.as_str(), moves.health), ("tomato", Health::Working(0.25)));
        let paused = lamp(&grasping(true)).expect("it is under way");
        assert_eq!((paused.value.as_str(), paused.health), ("paused", Health::Warning));
        let of_experiment = |paused| arm(&grasping(paused), "Experiment", "3 of 22".to_owned(), 0.1);
        assert_eq!(of_experiment(false).health, Health::Working(0.1));
        assert_eq!(of_experiment(true).health, Health::Warning);
        assert_eq!(of_experiment(true).value, "3 of 22", "how far it is stays");
    }

    #[test]
    fn what_waits_for_somebody_is_a_warning_and_what_is_paused_is_none() {
        let what = "Put the screen back.".to_owned();
        let lamp =
            lamp(&touching(TouchPhase::Waiting { what: what.clone(), prepare: None })).expect("it waits");
        assert_eq!((lamp.health, lamp.reason), (Health::Warning, Some(what)));
        assert_eq!(told(&touching(TouchPhase::Paused { why: None })), None);
    }
}
