//! What is under way, in the top line on every screen: how far it is, and by a click the way back to it.

use plumbline_engine::View;
use plumbline_engine::view::{
    GraspPhase, GraspRun, JobState, JobView, LampState, PartState, TouchPhase, TrialsPhase,
};
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
    let id = view.gap.searching?;
    let fraction = view.jobs.iter().find(|job| job.id == id).map_or(0.0, fraction);
    Some(under_way("Find", format::percent(fraction), fraction, Screen::Gap))
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
        GraspStep, GraspView, HandEyeView, ModelsView, MountTour, MountView, TouchCounts, TouchView,
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
        let running = TouchPhase::Running { number: 14, doing: "settling".to_owned() };
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
