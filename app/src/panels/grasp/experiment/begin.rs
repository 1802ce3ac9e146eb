//! What an experiment compares, before it is begun.

use egui::{Button, Ui};
use plumbline_engine::view::GraspMethod;
use plumbline_engine::{TrialsCommand, View};
use plumbline_widgets::NumberField;
use plumbline_widgets::buttons::choice;
use plumbline_widgets::format;
use plumbline_widgets::theme::{self, space};

use crate::operator::words::grasp::method;
use crate::panels::PanelContext;
use crate::panels::parts::warning;

/// An attempt takes about so long on the twin, s.
const ATTEMPT_S: usize = 50;
/// The same object is laid out the same way with this.
const SEED: u64 = 1;

/// Where things are laid.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Places {
    /// The 22 of the published experiment.
    #[default]
    Published,
    /// Three of them, to try it out.
    Three,
}

impl Places {
    fn positions_m(self) -> Option<Vec<[f64; 2]>> {
        match self {
            Self::Published => None,
            Self::Three => Some(vec![[0.3, -0.2], [0.3, -0.1], [0.4, -0.2]]),
        }
    }

    fn count(self) -> usize {
        self.positions_m().map_or(22, |positions| positions.len())
    }
}

/// What is being put together.
#[derive(Clone, Debug, PartialEq)]
pub struct Drafted {
    /// Methods to compare.
    pub methods: Vec<GraspMethod>,
    /// Attempts per position and method.
    pub attempts: usize,
    /// Where.
    pub places: Places,
    /// Class of the object.
    pub object: String,
}

impl Default for Drafted {
    fn default() -> Self {
        Self {
            methods: vec![GraspMethod::M5],
            attempts: 3,
            places: Places::Published,
            object: "Tomato".to_owned(),
        }
    }
}

pub fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    ui.label(theme::strong(ui, "Positions × attempts × methods"));
    let who = match cx.view.twin.running {
        true => "The twin lays the thing out itself; its scene shows whether it was lifted.",
        false => "You lay the thing where it is asked for, and say whether it was held.",
    };
    ui.label(theme::weak(ui, who));
    ui.add_space(space::S);
    let draft = &mut cx.state.grasp.experiment;
    ui.horizontal_wrapped(|ui| {
        ui.label(theme::small(ui, "Methods"));
        for known in cx.view.grasp.methods.iter() {
            let chosen = draft.methods.contains(&known.method);
            let chip =
                ui.add_enabled(known.lacks.is_none(), Button::selectable(chosen, method(known.method)));
            let chip = chip.on_hover_text(known.about);
            if chip.on_disabled_hover_text(known.lacks.clone().unwrap_or_default()).clicked() {
                match chosen {
                    true => draft.methods.retain(|other| *other != known.method),
                    false => draft.methods.push(known.method),
                }
                draft.methods.sort_unstable_by_key(|method| *method as usize);
            }
        }
    });
    ui.horizontal_wrapped(|ui| {
        let places = [(Places::Published, "22 published places"), (Places::Three, "3 places")];
        choice(ui, "Places", &mut draft.places, &places);
    });
    ui.horizontal(|ui| {
        let label = ui.label("Attempts at each");
        NumberField { name: "Attempts at each", range: 1..=20, suffix: "", speed: 0.25, decimals: 0 }
            .show(ui, &mut draft.attempts)
            .labelled_by(label.id);
    });
    ui.horizontal_wrapped(|ui| {
        ui.label(theme::small(ui, "Object"));
        for class in cx.view.grasp.classes.iter() {
            if ui.selectable_label(draft.object == *class, *class).clicked() {
                (*class).clone_into(&mut draft.object);
            }
        }
    });
    ui.add_space(space::S);
    let draft = draft.clone();
    start(ui, cx, &draft);
    earlier(ui, cx);
}

fn start(ui: &mut Ui, cx: &mut PanelContext<'_>, draft: &Drafted) {
    let count = draft.methods.len() * draft.attempts * draft.places.count();
    let trouble = trouble(cx.view, draft);
    let label = format!("Begin: {}", format::count(count, "attempt"));
    // The bottom line has the one primary button.
    let button = Button::new(label).min_size(egui::vec2(120.0, 32.0));
    let button = ui.add_enabled(trouble.is_none(), button);
    if button.clicked() {
        cx.outbox.send(TrialsCommand::Begin {
            methods: draft.methods.clone(),
            attempts: draft.attempts,
            positions_m: draft.places.positions_m(),
            object: draft.object.clone(),
            seed: SEED,
        });
    }
    match trouble {
        Some(trouble) => warning(ui, &trouble),
        None => {
            let minutes = (count * ATTEMPT_S).div_ceil(60);
            ui.label(theme::small(
                ui,
                format!("About {minutes} min. One arm moves at each attempt (M1 to M4: the right one; M5 with Auto: now this one, now that one); the other one goes home first where it is in the way. The head stays. It can be paused, and goes on after a restart."),
            ));
        }
    }
}

fn trouble(view: &View, draft: &Drafted) -> Option<String> {
    if draft.methods.is_empty() {
        return Some("Choose a method.".to_owned());
    }
    view.grasp.trouble().map(str::to_owned)
}

fn earlier(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    if cx.view.trials.earlier.is_empty() {
        return;
    }
    ui.add_space(space::S);
    ui.label(theme::small(ui, "Earlier ones"));
    for earlier in cx.view.trials.earlier.iter() {
        let text = format!("{}   {} of {}", earlier.name, earlier.made, earlier.all);
        if ui.add(Button::selectable(false, text)).on_hover_text("Open it; nothing moves").clicked() {
            cx.outbox.send(TrialsCommand::Open { folder: earlier.folder.clone() });
        }
    }
}
