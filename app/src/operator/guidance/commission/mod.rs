//! The way from a robot that was just switched on to its first good grasp: always one thing that comes
//! next, in which screen, and what it will move.

mod eyes;
mod grasp;
mod title;
mod touch;

pub use title::{done_in_words, name, spent};

use plumbline_engine::View;
use plumbline_engine::view::{CommissionStep, GraspPhase, JobState, MotionState};
use plumbline_widgets::format;

use super::sentence::Guidance;
use super::{failed_inside, gap, robot};
use crate::operator::snapshot::gap::{Finding, NamedEffect, Verdict};
use crate::operator::{Action, CommissionAction, GapAction, MountAction, Screen};

/// Where commissioning is, and what comes next.
#[derive(Clone, Debug, PartialEq)]
pub struct Course {
    /// "Commissioning, 2 of 8 done: place the screen – 2 of 8 touches".
    pub title: String,
    /// Where it happens.
    pub screen: Screen,
    /// What is happening, or what pressing does and what will move.
    pub sentence: String,
    /// Whether that needs attention.
    pub warning: bool,
    /// The one button.
    pub press: Press,
}

impl Course {
    /// Whether pressing the button moves the robot.
    pub fn begins_to_move(&self) -> bool {
        match &self.press {
            Press::Do { actions, .. } => actions.iter().any(|action| action.begins_to_move()),
            Press::Wait { .. } => false,
        }
    }
}

/// What the one button does.
#[derive(Clone, Debug, PartialEq)]
pub enum Press {
    /// Goes to the screen and does this.
    Do {
        /// Named by what it does: "Show the board at all places".
        label: String,
        /// One after the other.
        actions: Vec<Action>,
    },
    /// Nothing now: something runs, or a person has to do something first.
    Wait {
        /// What is waited for.
        why: String,
        /// How far that is, 0 to 1, where it is known.
        fraction: Option<f64>,
    },
}

/// What a step says: sentence, warning, button.
struct Said {
    sentence: String,
    warning: bool,
    press: Press,
}

impl Said {
    fn press(sentence: impl Into<String>, label: impl Into<String>, actions: Vec<Action>) -> Self {
        let press = Press::Do { label: label.into(), actions };
        Self { sentence: sentence.into(), warning: false, press }
    }

    fn wait(why: impl Into<String>, fraction: Option<f64>) -> Self {
        let why = why.into();
        Self { sentence: why.clone(), warning: false, press: Press::Wait { why, fraction } }
    }

    fn warn(mut self) -> Self {
        self.warning = true;
        self
    }
}

impl From<Guidance> for Said {
    fn from(guidance: Guidance) -> Self {
        let Guidance { sentence, warning, next } = guidance;
        let press = match next {
            Some(next) => Press::Do { label: next.label, actions: vec![next.action] },
            None => Press::Wait { why: sentence.clone(), fraction: None },
        };
        Self { sentence, warning, press }
    }
}

/// Where commissioning is, and what comes next; `None` while nobody is led.
pub fn course(view: &View) -> Option<Course> {
    if !view.commission.is_on {
        return None;
    }
    let step = view.commission.now();
    let screen = step.map_or(Screen::Commission, screen_of_step);
    let Said { sentence, warning, press } = said(view, step, screen);
    Some(Course { title: title::title(view, step), screen, sentence, warning, press })
}

fn screen_of_step(step: CommissionStep) -> Screen {
    match step {
        CommissionStep::Eyes => Screen::Collect,
        CommissionStep::Mount => Screen::Mount,
        CommissionStep::Screen | CommissionStep::Touches | CommissionStep::Check => Screen::Touch,
        CommissionStep::Effects => Screen::Gap,
        CommissionStep::Hands => Screen::HandEye,
        CommissionStep::Grasp => Screen::Grasp,
    }
}

fn said(view: &View, step: Option<CommissionStep>, screen: Screen) -> Said {
    if let Some(failed) = failed_inside(view, screen) {
        return failed.into();
    }
    if view.robot.stopped && view.robot.connection.is_connected() && step.is_some() {
        return Said::wait(super::stopped_words(view), None).warn();
    }
    // Limp joints sink, also after the last step.
    let Some(step) = step else {
        return robot::limp(&view.robot).map_or_else(|| all_done(view), Said::from);
    };
    if let Some(running) = running(view) {
        return running;
    }
    if let Some(troubled) = troubled(view, step) {
        return troubled;
    }
    match step {
        CommissionStep::Eyes => eyes::said(view),
        CommissionStep::Mount => mount(view),
        CommissionStep::Screen => touch::placing(view),
        CommissionStep::Touches => touch::training(view),
        CommissionStep::Effects => effects(view),
        CommissionStep::Hands => super::handeye::handeye(view).into(),
        CommissionStep::Check => touch::checking(view),
        CommissionStep::Grasp => grasp::said(view),
    }
}

/// A joint that did not answer for a while is taken hold of before anything goes on.
fn troubled(view: &View, step: CommissionStep) -> Option<Said> {
    let moves = !matches!(step, CommissionStep::Eyes | CommissionStep::Effects);
    let stands =
        view.robot.connection.is_connected() && !matches!(view.robot.motion, MotionState::Moving { .. });
    let troubled = robot::limp(&view.robot).or_else(|| robot::let_go(&view.robot));
    troubled.filter(|_| moves && stands).map(Said::from)
}

/// Whatever runs is waited for.
fn running(view: &View) -> Option<Said> {
    if view.grasp.phase.is_paused() {
        return None;
    }
    let job = view.running_job()?;
    let JobState::Running { fraction, doing, .. } = &job.state else { return None };
    let said = match view.grasp.phase {
        GraspPhase::Grasping { .. } => super::grasp::under_way(&view.grasp),
        GraspPhase::Hand { .. } => format!("{}: {doing}. The arm moves; Esc or space stops.", job.title),
        _ => format!("{}: {doing}.", job.title),
    };
    let said = Said::wait(said, Some(*fraction));
    Some(said)
}

fn all_done(view: &View) -> Said {
    Said::press(
        format!("The robot is commissioned: {}.", spent(&view.commission.spent)),
        "Finish",
        vec![Action::Commission(CommissionAction::Leave)],
    )
}

fn mount(view: &View) -> Said {
    // Where the board has to lie is known from the moment the head was turned there.
    let accept = Action::Mount(MountAction::Accept);
    let mut said: Said = robot::mount(view).into();
    if let Press::Do { actions, .. } = &said.press
        && *actions == [accept]
    {
        let error = view.mount.proposal.as_ref().map(|proposal| proposal.rms_px);
        let error = error.map_or_else(String::new, format::px);
        said.sentence = format!("Solved: {error} are left over in the images. Accepting puts it in use.");
    }
    said
}

/// What is found is added; the touches of the check tell whether that helped.
/// What was found and what it is good for; all of it stands in the panes of the gap.
fn in_short(finding: &Finding, addable: &[usize]) -> String {
    let named: Vec<&NamedEffect> = addable.iter().filter_map(|index| finding.effects.get(*index)).collect();
    // The names of several stand on their cards.
    let names = match named.as_slice() {
        [one] => one.title.clone(),
        several => format::count(several.len(), "effect"),
    };
    let closed = crate::operator::words::gap::on_held_out(finding, "On touches that were held out");
    let closed = closed.map_or_else(String::new, |closed| format!(" {closed}"));
    // What only closes a part of the gap is no name for it.
    let found = match finding.verdict {
        Verdict::NotInLibrary => "Not named, but closed in part by",
        _ if finding.many.is_some() => "Not sure by name; what corrects it:",
        Verdict::Class => "Found, though other names fit as well:",
        Verdict::NoGap | Verdict::Named => "Found:",
    };
    let it = if named.len() == 1 { "it" } else { "them" };
    format!("{found} {names}.{closed} Adding puts {it} into the model in use; nothing moves.")
}

fn effects(view: &View) -> Said {
    let gap_view = &view.gap;
    let find = Action::Gap(GapAction::Find);
    if gap_view.searching.is_some() || gap_view.chosen.is_empty() || gap_view.failed.is_some() {
        return gap::gap(view).into();
    }
    let (addable, wanted) = (gap_view.addable(), gap_view.wanted());
    if gap::is_of_choice(gap_view) && !addable.is_empty() {
        if wanted.is_empty() {
            let sentence = "All that was found is left out. Tick under Gap what shall be added.";
            return Said::press(sentence, "Go to Gap", vec![Action::Go(Screen::Gap)]);
        }
        let label = crate::operator::words::gap::add_label(view, &wanted);
        let sentence = gap_view.finding().map_or_else(String::new, |finding| in_short(finding, &wanted));
        return Said::press(sentence, label, vec![Action::Gap(GapAction::Add)]);
    }
    if gap::is_of_choice(gap_view) && gap_view.sizes_arm {
        return Said::press(
            "What makes the arm miss has no name that could be added. The arm can still be corrected by small shares of all that usually is wrong with arms; touches held out tell whether that helps. Nothing moves.",
            GapAction::Size.label(),
            vec![Action::Gap(GapAction::Size)],
        );
    }
    Said::press(
        "The touches are held against the robot's model: what makes the arm miss is looked for, by name. Nothing moves.",
        "Find what makes the arm miss",
        vec![find],
    )
}
