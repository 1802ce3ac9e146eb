//! What a person at the robot is asked while it grasps, on the screen that lies before the robot: where to
//! lay a thing, and whether it is held.

use egui::{Button, Color32, RichText, TextStyle, Ui, vec2};
use plumbline_engine::View;
use plumbline_engine::view::{Connection, GraspOutcome, GraspPhase, TrialsPhase};
use plumbline_widgets::theme::{ON_IMAGE, space};

use crate::operator::words::trials::ask;
use crate::operator::{Action, GraspAction, TrialsAction};

/// A finger or a fist finds it, points.
const BUTTON: egui::Vec2 = vec2(220.0, 90.0);

/// What is asked.
#[derive(Clone, Debug, PartialEq)]
pub struct Prompt {
    /// A sentence.
    pub asked: String,
    /// What can be answered, and what follows.
    pub answers: Vec<(&'static str, Action)>,
}

/// What a person is asked now; `None`: nothing. The twin needs nobody, and nothing is asked while it moves.
pub fn prompt(view: &View) -> Option<Prompt> {
    let is_robot = matches!(view.robot.connection, Connection::Connected { twin: false, .. });
    if !is_robot || view.grasp.phase != GraspPhase::Idle || view.robot.stopped {
        return None;
    }
    let held = || Prompt {
        asked: "Look at the hand: is it held?".to_owned(),
        answers: vec![
            ("Held", Action::Grasp(GraspAction::Held)),
            ("Not held", Action::Grasp(GraspAction::NotHeld)),
        ],
    };
    match (&view.trials.phase, &view.trials.shown) {
        (TrialsPhase::Asks { at_m, .. }, Some(shown)) => Some(Prompt {
            asked: format!(
                "{} Then an arm moves; the other one goes home first where it is in the way.",
                ask(&shown.experiment.object, *at_m)
            ),
            answers: vec![("Placed", Action::Trials(TrialsAction::Placed))],
        }),
        (TrialsPhase::WaitsForWord { .. }, _) => Some(held()),
        _ => {
            let run = view.grasp.run.as_ref().filter(|run| run.told.is_none() && !run.name.is_empty())?;
            let was_tried = matches!(run.outcome, Some(GraspOutcome::Success | GraspOutcome::Failed { .. }));
            was_tried.then(held)
        }
    }
}

/// Asks, over all of `ui`; what was answered.
pub fn show(ui: &mut Ui, prompt: &Prompt) -> Option<Action> {
    ui.painter().rect_filled(ui.max_rect(), 0.0, Color32::BLACK);
    let mut answered = None;
    ui.vertical_centered(|ui| {
        ui.add_space(0.25 * ui.available_height());
        let asked = RichText::new(&prompt.asked).text_style(TextStyle::Heading).color(ON_IMAGE.text);
        ui.label(asked);
        ui.add_space(space::L);
        let all = BUTTON.x * prompt.answers.len() as f32
            + ui.spacing().item_spacing.x * prompt.answers.len().saturating_sub(1) as f32;
        ui.allocate_ui(vec2(all, BUTTON.y), |ui| {
            ui.horizontal(|ui| {
                for (label, action) in &prompt.answers {
                    let button = Button::new(RichText::new(*label).text_style(TextStyle::Heading));
                    if ui.add(button.min_size(BUTTON)).clicked() {
                        answered = Some(*action);
                    }
                }
            });
        });
    });
    answered
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use plumbline_engine::view::GraspRun;

    use super::*;

    fn view(twin: bool, phase: TrialsPhase, run: Option<GraspRun>) -> View {
        let mut view = View::default();
        let connection = Connection::Connected { to: "it".to_owned(), twin };
        Arc::make_mut(&mut view.robot).connection = connection;
        Arc::make_mut(&mut view.trials).phase = phase;
        Arc::make_mut(&mut view.grasp).run = run.map(Arc::new);
        view
    }

    fn lifted(told: Option<bool>) -> GraspRun {
        let outcome = Some(GraspOutcome::Success);
        GraspRun { name: "one".to_owned(), outcome, told, ..GraspRun::default() }
    }

    #[test]
    fn a_person_at_the_robot_is_asked_once_whether_it_is_held_and_at_the_twin_nobody() {
        let answers = |view: &View| -> Vec<&str> {
            prompt(view)
                .map(|prompt| prompt.answers.iter().map(|(label, _)| *label).collect())
                .unwrap_or_default()
        };
        assert_eq!(answers(&view(false, TrialsPhase::Idle, Some(lifted(None)))), ["Held", "Not held"]);
        assert!(answers(&view(false, TrialsPhase::Idle, Some(lifted(Some(false))))).is_empty());
        assert!(answers(&view(true, TrialsPhase::Idle, Some(lifted(None)))).is_empty());
        let refused = GraspOutcome::Refused { why: "it is too hot".to_owned() };
        let refused = GraspRun { outcome: Some(refused), ..lifted(None) };
        assert!(answers(&view(false, TrialsPhase::Idle, Some(refused))).is_empty());
        let mut moves = view(false, TrialsPhase::Idle, Some(lifted(None)));
        Arc::make_mut(&mut moves.grasp).phase = GraspPhase::Grasping { paused: false, ending: false };
        assert!(answers(&moves).is_empty(), "nothing is asked while it moves");
    }
}
