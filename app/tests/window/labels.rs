//! Data sets and scores: every state is drawn, every click and key asks for what it says.

use egui::{Key, Modifiers};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use plumbline::{PlumblineWindow, Screen, ThemeChoice, WindowSettings};
use plumbline_engine::view::{LabelsView, ScoresView};
use plumbline_engine::{BoxEdit, Command, ConfusionCell, LabelsCommand, ScoresCommand, View};
use plumbline_model::ClassIndex;

use crate::fake::{Fake, click, says, shows};
use crate::made_up_labels::{
    OWN_LABELS, cell, chosen, evaluating, failed, import, judged, judging, labeling, large, not_opened, open,
    proposed, unreadable, unsaved,
};

fn on(screen: Screen) -> WindowSettings {
    WindowSettings { screen, ..WindowSettings::default() }
}

fn images(labels: LabelsView) -> (Fake, Harness<'static, PlumblineWindow>) {
    let fake = Fake::over(labeling(labels));
    let window = fake.window_of_size(on(Screen::Images), [1440.0, 900.0]);
    (fake, window)
}

fn scores(scores: ScoresView) -> (Fake, Harness<'static, PlumblineWindow>) {
    let fake = Fake::over(judging(scores));
    let window = fake.window_of_size(on(Screen::Scores), [1440.0, 900.0]);
    (fake, window)
}

fn asked(fake: &Fake) -> Vec<LabelsCommand> {
    let only = |command| if let Command::Labels(command) = command { Some(command) } else { None };
    fake.take_sent().into_iter().filter_map(only).collect()
}

fn asked_of_scores(fake: &Fake) -> Vec<ScoresCommand> {
    let only = |command| if let Command::Scores(command) = command { Some(command) } else { None };
    fake.take_sent().into_iter().filter_map(only).collect()
}

fn press(window: &mut Harness<'_, PlumblineWindow>, modifiers: Modifiers, key: Key) {
    window.key_press_modifiers(modifiers, key);
    window.run_steps(2);
}

#[test]
fn the_rail_leads_to_images_and_scores() {
    let fake = Fake::over(View::default());
    let mut window = fake.window(WindowSettings::default());
    click(&mut window, "Detect");
    assert!(shows(&window, "Teach a detector what your eyes see"));
    click(&mut window, "Scores");
    assert!(says(&window, "None yet. Add ONNX files"));
}

#[test]
fn keys_mean_drawing_on_images_and_nothing_of_it_elsewhere() {
    let (fake, mut window) = images(open());
    press(&mut window, Modifiers::NONE, Key::ArrowRight);
    assert_eq!(asked(&fake), [LabelsCommand::Step(1)]);
    press(&mut window, Modifiers::NONE, Key::C);
    assert_eq!(asked(&fake), [LabelsCommand::CopyPrevious]);
    press(&mut window, Modifiers::NONE, Key::P);
    assert_eq!(asked(&fake), [LabelsCommand::Propose]);
    press(&mut window, Modifiers::COMMAND, Key::Z);
    assert_eq!(asked(&fake), [LabelsCommand::Undo]);

    let fake = Fake::over(labeling(open()));
    let mut window = fake.window(on(Screen::Live));
    press(&mut window, Modifiers::NONE, Key::C);
    assert_eq!(asked(&fake), []);
}

#[test]
fn the_chosen_box_gets_the_class_of_a_key_and_is_deleted() {
    let (fake, mut window) = images(open());
    let name = open().shown.expect("shown").name;
    press(&mut window, Modifiers::NONE, Key::Num3);
    assert_eq!(asked(&fake), [], "no box is chosen: only the next one is of that class");
    click(&mut window, "Box 2: Tomato");
    press(&mut window, Modifiers::NONE, Key::Num6);
    let edit = BoxEdit::Class { index: 1, class: ClassIndex(5) };
    assert_eq!(asked(&fake), [LabelsCommand::Edit { image: name.clone(), edit }]);
    press(&mut window, Modifiers::NONE, Key::Delete);
    assert_eq!(asked(&fake), [LabelsCommand::Edit { image: name, edit: BoxEdit::Delete { index: 1 } }]);
}

#[test]
fn proposals_are_accepted_together_or_one_by_one() {
    let (fake, mut window) = images(proposed());
    press(&mut window, Modifiers::NONE, Key::Enter);
    assert_eq!(asked(&fake), [LabelsCommand::AcceptProposals]);
    click(&mut window, "Box 3: Orange 0.83?");
    press(&mut window, Modifiers::NONE, Key::Num1);
    let class = Some(ClassIndex(0));
    assert_eq!(asked(&fake), [LabelsCommand::AcceptProposal { index: 0, class, area: None }]);
    press(&mut window, Modifiers::NONE, Key::Delete);
    assert_eq!(asked(&fake), [LabelsCommand::DiscardProposal { index: 0 }]);
}

#[test]
fn what_is_not_on_disk_is_said_and_can_be_tried_again() {
    let (fake, mut window) = images(unsaved());
    assert!(says(&window, "They are kept here"));
    press(&mut window, Modifiers::COMMAND, Key::Enter);
    assert_eq!(asked(&fake), [LabelsCommand::SaveAgain]);
}

#[test]
fn an_image_that_cannot_be_read_says_so_and_the_others_can_be_chosen() {
    let (fake, mut window) = images(unreadable());
    assert!(shows(&window, "This image cannot be shown"));
    press(&mut window, Modifiers::NONE, Key::ArrowLeft);
    assert_eq!(asked(&fake), [LabelsCommand::Step(-1)]);
    press(&mut window, Modifiers::NONE, Key::B);
    assert_eq!(asked(&fake), [], "nothing is written about an image that nobody can see");
}

#[test]
fn an_import_is_shown_before_it_is_accepted() {
    let (fake, mut window) = images(import());
    click(&mut window, "Checks");
    assert!(says(&window, "Class numbers differ") && says(&window, "240 images with 911 boxes"));
    click(&mut window, "Accept the import");
    assert_eq!(asked(&fake), [LabelsCommand::AcceptImport]);
}

#[test]
fn a_new_data_set_has_the_classes_that_were_typed() {
    let (fake, mut window) = images(LabelsView::default());
    click(&mut window, "New data set…");
    assert!(says(&window, "Classes in order"));
    click(&mut window, "Folder, which must be empty or new");
    window.event(egui::Event::Text("toys".to_owned()));
    window.run_steps(2);
    click(&mut window, "Make the data set");
    let names = plumbline_model::detection::PUBLISHED_CLASSES.map(str::to_owned).to_vec();
    assert_eq!(asked(&fake), [LabelsCommand::Create { folder: "toys".into(), names }]);
}

#[test]
fn detectors_are_judged_by_one_button() {
    let (fake, mut window) = scores(chosen());
    press(&mut window, Modifiers::COMMAND, Key::Enter);
    assert_eq!(asked_of_scores(&fake), [ScoresCommand::Evaluate]);
}

#[test]
fn the_table_says_what_has_to_be_known_and_a_cell_opens_its_images() {
    let (fake, mut window) = scores(judged());
    assert!(says(&window, "yolo12s: its classes have another order; they are matched by name."));
    // A detector that proposed the labels agrees with itself, and that stands beside its figures.
    assert!(says(&window, &format!("yolo12s: {OWN_LABELS}")));
    assert_eq!(window.query_all_by_label("own labels").count(), 4, "its figures, and nobody else's");
    assert!(says(&window, "does not know Onion"));
    assert!(says(&window, "is not a usable ONNX file"));
    click(&mut window, "LeftHand taken for RightHand: 4");
    let cell = ConfusionCell { truth: Some(2), found: Some(6) };
    assert_eq!(asked_of_scores(&fake), [ScoresCommand::OpenCell { model: 0, cell }]);
}

#[test]
fn an_image_of_a_cell_is_shown_large() {
    let (fake, mut window) = scores(cell());
    assert!(says(&window, "LeftHand taken for RightHand: 4 images"));
    click(&mut window, "Image left_1767628247");
    assert_eq!(asked_of_scores(&fake), [ScoresCommand::ShowPicture(Some(0))]);
    fake.show(judging(large()));
    window.run_steps(3);
    assert!(shows(&window, "Large picture of left_1767628247"));
}

fn states() -> Vec<(&'static str, Screen, View, Option<&'static str>)> {
    let of_images = [
        ("images-empty", LabelsView::default(), None),
        ("images-open", open(), None),
        ("images-chosen", open(), Some("Box 2: Tomato")),
        ("images-proposed", proposed(), None),
        ("images-unsaved", unsaved(), None),
        ("images-unreadable", unreadable(), None),
        ("images-import", import(), Some("Checks")),
        ("images-not-opened", not_opened(), None),
    ];
    let of_scores = [
        ("scores-empty", ScoresView::default(), None),
        ("scores-chosen", chosen(), None),
        ("scores-evaluating", evaluating(), None),
        ("scores-failed", failed(), None),
        ("scores-judged", judged(), None),
        ("scores-classes", judged(), Some("Per class")),
        ("scores-cell", cell(), None),
        ("scores-large", large(), None),
    ];
    let images = of_images.map(|(name, labels, then)| (name, Screen::Images, labeling(labels), then));
    let scores = of_scores.map(|(name, scores, then)| (name, Screen::Scores, judging(scores), then));
    images.into_iter().chain(scores).collect()
}

#[test]
fn every_state_is_drawn_at_every_size_in_both_themes() {
    for (_, screen, view, _) in states() {
        for theme in [ThemeChoice::Dark, ThemeChoice::Light] {
            for size in [[960.0, 600.0], [3840.0, 2160.0]] {
                let fake = Fake::over(view.clone());
                let window = fake.window_of_size(WindowSettings { theme, ..on(screen) }, size);
                assert!(shows(&window, "STOP"));
            }
        }
    }
}

/// Every state drawn into a PNG of `PLUMBLINE_WINDOW_PICTURES=<folder>`, with `--ignored pictures`.
#[test]
#[ignore = "draws pictures for people to look at"]
fn pictures_of_the_states() {
    let folder = crate::fake::picture_folder();
    for theme in [ThemeChoice::Dark, ThemeChoice::Light] {
        for (name, screen, view, then) in states() {
            let fake = Fake::over(view);
            let mut window = fake.window_with(WindowSettings { theme, ..on(screen) }, [1440.0, 900.0], true);
            if let Some(then) = then {
                click(&mut window, then);
            }
            window.run_steps(2);
            let image = window.render().expect("the test renderer draws");
            let file = format!("{name} {theme:?}.png").to_lowercase().replace(' ', "-");
            image.save(folder.join(file)).expect("the folder can be written");
        }
    }
}
