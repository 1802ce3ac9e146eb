//! Sheets that ask for what a button alone cannot tell: a typed path, camera numbers, whether
//! to delete everything.

use std::path::PathBuf;

use egui::{Align2, TextEdit, Ui, Vec2};
use plumbline_engine::{
    CameraDevice, CommissionCommand, EyesCommand, LabelsCommand, RobotCommand, SourceCommand, SourceSpec,
    View,
};
use plumbline_widgets::NumberField;
use plumbline_widgets::format;
use plumbline_widgets::theme::{self, space};

use super::about::About;
use super::connect::{self, ConnectChoice};
use super::dialogs::{Answer, Question};
use super::lerobot::LerobotAsk;
use super::sheet::{Asked, buttons, buttons_with_care, sheet, title};
use super::unaccepted::{TWIN_BEGINS_ANEW, is_twin, lost_by_closing, sheet_of_unaccepted};

/// An open sheet.
#[derive(Debug)]
pub enum Ask {
    /// Paths, typed.
    Paths {
        /// What for.
        question: Question,
        /// One text per field.
        typed: Vec<String>,
    },
    /// Numbers of two cameras.
    Cameras {
        /// Left eye.
        left: u32,
        /// Right eye.
        right: u32,
    },
    /// Whether to delete all pairs.
    DeleteAll {
        /// How many there are.
        count: usize,
    },
    /// Which version this is.
    About(About),
    /// What the robot is connected to.
    Connect(ConnectChoice),
    /// Whether the window closes although something moves.
    CloseWhileMoving,
    /// Whether it closes although what was solved was not accepted.
    CloseUnaccepted,
    /// Whether all joints may go limp.
    LetGo,
    /// Whether commissioning is counted from the beginning.
    CommissionAnew,
    /// Whether servos may be told for good to answer sooner.
    ShortenAnswers,
    /// Folder and classes of a new data set.
    NewLabelSet {
        /// As it is being typed.
        folder: String,
        /// Separated by commas, as they are being typed.
        classes: String,
    },
    /// Where a recording is written as a data set, and what was being done in it.
    ExportLerobot(LerobotAsk),
    /// The name of a posture.
    SavePose {
        /// As it is being typed.
        title: String,
    },
}

impl Ask {
    /// Asks for typed paths.
    pub fn paths(question: Question) -> Self {
        let name = question.suggested_name().to_owned();
        let typed = question.fields().iter().map(|_| name.clone()).collect();
        Self::Paths { question, typed }
    }

    /// Asks for a new data set, with the published classes.
    pub fn new_label_set() -> Self {
        let classes = plumbline_model::detection::PUBLISHED_CLASSES.join(", ");
        Self::NewLabelSet { folder: String::new(), classes }
    }

    /// Asks where a recording is written to.
    pub fn export_lerobot(file: PathBuf) -> Self {
        Self::ExportLerobot(LerobotAsk::of(file))
    }

    /// Draws the sheet.
    pub fn show(&mut self, ctx: &egui::Context, view: &View, escape_pressed: bool) -> Asked {
        let middle = (Align2::CENTER_CENTER, Vec2::ZERO);
        let shown = sheet(ctx, "ask", middle, 440.0, escape_pressed, |ui| match self {
            Self::Paths { question, typed } => paths(ui, *question, typed),
            Self::Cameras { left, right } => cameras(ui, view, left, right),
            Self::DeleteAll { count } => delete_all(ui, *count),
            Self::About(about) => about.show(ui),
            Self::Connect(chosen) => connect::show(ui, view, chosen),
            Self::CloseWhileMoving => close_while_moving(ui, view),
            Self::CloseUnaccepted => sheet_of_unaccepted(ui, view),
            Self::LetGo => let_go(ui, view),
            Self::CommissionAnew => commission_anew(ui, view),
            Self::ShortenAnswers => shorten_answers(ui, view),
            Self::NewLabelSet { folder, classes } => new_label_set(ui, folder, classes),
            Self::ExportLerobot(ask) => ask.show(ui),
            Self::SavePose { title } => save_pose(ui, title),
        });
        match shown.inner {
            Asked::Open if shown.close => Asked::Closed,
            asked => asked,
        }
    }
}

fn paths(ui: &mut Ui, question: Question, typed: &mut [String]) -> Asked {
    title(ui, question.title(), "Type or paste the path; or drop the files on the window.");
    let nothing_typed = typed.iter().all(|text| text == question.suggested_name());
    let mut entered = false;
    for (i, (field, text)) in question.fields().iter().zip(typed.iter_mut()).enumerate() {
        let label = ui.label(theme::weak(ui, *field));
        let edit = ui.add(TextEdit::singleline(text).desired_width(f32::INFINITY)).labelled_by(label.id);
        if i == 0 && nothing_typed && ui.memory(|memory| memory.focused().is_none()) {
            edit.request_focus();
        }
        entered |= edit.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter));
    }
    let filled = typed.iter().take(question.required()).all(|text| !text.trim().is_empty());
    let verb = if question.saves() { "Save" } else { "Open" };
    match buttons(ui, verb, filled) {
        Some(false) => Asked::Closed,
        Some(true) => answer(question, typed),
        None if entered && filled => answer(question, typed),
        None => Asked::Open,
    }
}

fn answer(question: Question, typed: &[String]) -> Asked {
    let paths = typed.iter().map(|t| t.trim()).filter(|t| !t.is_empty()).map(expand_home).collect();
    Asked::Answer(Answer::Paths(question, paths))
}

/// `~/pairs` as a shell would read it.
pub(super) fn expand_home(text: &str) -> PathBuf {
    let home = || directories::BaseDirs::new().map(|dirs| dirs.home_dir().to_owned());
    match text.strip_prefix("~/").zip(home()) {
        Some((rest, home)) => home.join(rest),
        None => PathBuf::from(text),
    }
}

fn cameras(ui: &mut Ui, view: &View, left: &mut u32, right: &mut u32) -> Asked {
    title(ui, "Use USB cameras", "Numbers as the system counts them: 0 is the first camera.");
    let devices: Vec<&CameraDevice> = view
        .source
        .cameras
        .iter()
        .flat_map(|all| all.iter())
        .filter(|device| device.delivers_images)
        .collect();
    match (&view.source.cameras, devices.is_empty()) {
        (None, _) => ui.label(theme::weak(ui, "Looking for cameras.")),
        (Some(_), true) => ui.label(theme::weak(ui, "No camera is found: plug both eyes in.")),
        (Some(_), false) => {
            ui.label(theme::weak(ui, format!("Found: {}.", format::count(devices.len(), "camera"))))
        }
    };
    ui.add_space(space::S);
    egui::Grid::new("cameras").num_columns(2).spacing([space::M, space::S]).show(ui, |ui| {
        for (name, number) in [("Left eye", &mut *left), ("Right eye", &mut *right)] {
            let label = ui.label(name);
            if devices.is_empty() {
                NumberField { name, range: 0..=63, suffix: "", speed: 0.25, decimals: 0 }
                    .show(ui, number)
                    .labelled_by(label.id);
            } else {
                let shown = device_text(&devices, *number);
                egui::ComboBox::from_id_salt(name).width(260.0).selected_text(shown).show_ui(ui, |ui| {
                    for device in &devices {
                        ui.selectable_value(number, device.number, device_text(&devices, device.number));
                    }
                });
            }
            ui.end_row();
        }
    });
    if left == right {
        ui.label(theme::weak(ui, "The two eyes need two different cameras."));
    }
    match buttons(ui, "Use these cameras", left != right) {
        Some(true) => Asked::Command(
            SourceCommand::Open(SourceSpec::Cameras { left_index: *left, right_index: *right }).into(),
        ),
        Some(false) => Asked::Closed,
        None => Asked::Open,
    }
}

fn device_text(devices: &[&CameraDevice], number: u32) -> String {
    let device = devices.iter().find(|device| device.number == number);
    device.map_or_else(|| format!("{number}: not found"), |device| format!("{number}: {}", device.name))
}

fn delete_all(ui: &mut Ui, count: usize) -> Asked {
    title(
        ui,
        &format!("Delete {}?", if count == 1 { "the pair".to_owned() } else { format!("all {count} pairs") }),
        "You can take it back with Undo.",
    );
    match buttons_with_care(ui, "Delete all pairs") {
        Some(true) => Asked::Command(EyesCommand::DeleteAll.into()),
        Some(false) => Asked::Closed,
        None => Asked::Open,
    }
}

fn close_while_moving(ui: &mut Ui, view: &View) -> Asked {
    // It may have come to rest since it was asked.
    let (asks, held, closes) = match super::status_line::moves(view) {
        true => (
            "Close while the robot moves?",
            "It is stopped first and holds where it is, with torque.",
            "Stop and close",
        ),
        false => ("Close?", "The robot stands by now. It holds where it is, with torque.", "Close"),
    };
    let held = match is_twin(view) {
        false => held.to_owned(),
        true => {
            let stops = if super::status_line::moves(view) { "It is stopped first." } else { "" };
            // What the hand holds tells the rest.
            let then = if view.grasp.held.is_some() { "" } else { TWIN_BEGINS_ANEW };
            format!("{stops} {then}").trim().to_owned()
        }
    };
    let about = match lost_by_closing(view) {
        Some(lost) => format!("{held} {lost}"),
        None => held,
    };
    title(ui, asks, &about);
    match buttons_with_care(ui, closes) {
        Some(true) => Asked::HoldAndClose,
        Some(false) => Asked::Closed,
        None => Asked::Open,
    }
}

fn commission_anew(ui: &mut Ui, view: &View) -> Asked {
    let spent = &view.commission.spent;
    let about = format!(
        "All eight steps count as not done, and {} min, {} and {} begin at zero. What was accepted stays in use; pairs that are collected stay.",
        spent.time.as_secs() / 60,
        format::count(spent.touches, "touch"),
        format::count(spent.views, "view"),
    );
    title(ui, "Commission once more?", &about);
    match buttons_with_care(ui, "Begin anew") {
        Some(true) => Asked::Command(CommissionCommand::Start { anew: true }.into()),
        Some(false) => Asked::Closed,
        None => Asked::Open,
    }
}

fn let_go(ui: &mut Ui, view: &View) -> Asked {
    let falls = view.grasp.held.as_ref().map_or_else(String::new, |held| {
        format!(" The {} falls out of the {} hand.", held.object.to_lowercase(), held.hand.name())
    });
    let about =
        format!("Both arms sink and the head nods, by their own weight: hold them, and keep clear.{falls}");
    title(ui, "Let all joints go limp?", &about);
    match buttons_with_care(ui, "Let all go limp") {
        Some(true) => Asked::Command(RobotCommand::Torque { joints: Vec::new(), on: false }.into()),
        Some(false) => Asked::Closed,
        None => Asked::Open,
    }
}

fn shorten_answers(ui: &mut Ui, view: &View) -> Asked {
    let slow = view.robot.bus.slow_answers;
    let about = format!(
        "Waiting before each answer: {}. They are told to answer at once, and keep that in their permanent memory (return delay). Nothing moves.",
        format::count(slow, "servo")
    );
    title(ui, "Shorten the answers of servos?", &about);
    match buttons(ui, "Write it to the servos", slow > 0) {
        Some(true) => Asked::Command(RobotCommand::ShortenAnswers.into()),
        Some(false) => Asked::Closed,
        None => Asked::Open,
    }
}

fn save_pose(ui: &mut Ui, name: &mut String) -> Asked {
    title(ui, "Save this posture", "All joints as they are now, under a name.");
    let label = ui.label(theme::weak(ui, "Name"));
    let edit = ui.add(TextEdit::singleline(name).desired_width(f32::INFINITY)).labelled_by(label.id);
    if name.is_empty() && ui.memory(|memory| memory.focused().is_none()) {
        edit.request_focus();
    }
    let entered = edit.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter));
    let filled = !name.trim().is_empty();
    let pressed = buttons(ui, "Save posture", filled);
    match pressed {
        Some(false) => Asked::Closed,
        Some(true) => saved_pose(name),
        None if entered && filled => saved_pose(name),
        None => Asked::Open,
    }
}

fn new_label_set(ui: &mut Ui, folder: &mut String, classes: &mut String) -> Asked {
    title(ui, "New data set", "Images, labels and data.yaml in the YOLO layout, in a folder of its own.");
    let label = ui.label(theme::weak(ui, "Folder, which must be empty or new"));
    ui.add(TextEdit::singleline(folder).desired_width(f32::INFINITY)).labelled_by(label.id);
    let label = ui.label(theme::weak(ui, "Classes in order, separated by commas"));
    ui.add(TextEdit::multiline(classes).desired_rows(2).desired_width(f32::INFINITY)).labelled_by(label.id);
    ui.label(theme::small(ui, "The order gives the class numbers their meaning and is never changed later."));
    let names: Vec<String> = classes
        .split([',', '\n'])
        .map(|name| name.trim().to_owned())
        .filter(|name| !name.is_empty())
        .collect();
    let filled = !folder.trim().is_empty() && !names.is_empty();
    match buttons(ui, "Make the data set", filled) {
        Some(false) => Asked::Closed,
        Some(true) => {
            Asked::Command(LabelsCommand::Create { folder: expand_home(folder.trim()), names }.into())
        }
        None => Asked::Open,
    }
}

fn saved_pose(name: &str) -> Asked {
    let title = name.trim().to_owned();
    Asked::Command(RobotCommand::SavePose { title, joints: Vec::new() }.into())
}
