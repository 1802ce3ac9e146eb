//! Correction models: one button per state of the work, and every button asks for what it says.

use std::sync::Arc;

use egui::{Pos2, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use plumbline::{PlumblineWindow, Screen, ThemeChoice, WindowSettings};
use plumbline_engine::models::{Method, TouchData};
use plumbline_engine::view::{JobState, JobView, ModelError, ModelsView, StepState, TablesView};
use plumbline_engine::{Command, GraspTable, JobId, ModelsCommand, TablesCommand, TouchCommand, View};

use crate::fake::{Fake, click, click_at, says, shows};
use crate::made_up::everything;
use crate::made_up_models::{data, in_use, recorded, screen, sessions, tables, trained, training, with};

fn on_models() -> WindowSettings {
    WindowSettings { screen: Screen::Models, ..WindowSettings::default() }
}

const TALL: [f32; 2] = [1440.0, 1500.0];

fn models(fake: &Fake) -> Vec<ModelsCommand> {
    let only = |command| if let Command::Models(command) = command { Some(command) } else { None };
    fake.take_sent().into_iter().filter_map(only).collect()
}

fn edits(fake: &Fake) -> Vec<TablesCommand> {
    let only = |command| if let ModelsCommand::Tables(command) = command { Some(command) } else { None };
    models(fake).into_iter().filter_map(only).collect()
}

/// Presses the one button of the step, which has this label, from the keyboard.
fn press_next(window: &mut Harness<'_, PlumblineWindow>, label: &str) {
    assert!(shows(window, label), "nothing is called {label:?}");
    window.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::Enter);
    window.run_steps(3);
}

fn on_comparison(fake: &Fake) -> Harness<'static, PlumblineWindow> {
    let mut window = fake.window_of_size(on_models(), TALL);
    click(&mut window, "Models compared");
    window
}

#[test]
fn no_other_button_takes_the_place_of_the_one_that_was_pressed() {
    let fake = Fake::over(with(trained()));
    let mut window = on_comparison(&fake);
    let place = |window: &Harness<'_, PlumblineWindow>| window.get_by_label("Use M3").rect();
    let before = place(&window);
    click_at(&mut window, before.center());
    assert_eq!(models(&fake), [ModelsCommand::Accept(Method::M3)]);
    let others = trained().proposals.into_iter().filter(|model| model.method() != Method::M3).collect();
    let in_use = in_use().in_use;
    fake.show(with(ModelsView { proposals: others, in_use, ..trained() }));
    window.run_steps(3);
    assert_eq!(place(&window), before);
    click_at(&mut window, before.center());
    assert_eq!(models(&fake), [], "it is in use already");
}

#[test]
fn without_touches_it_leads_to_them() {
    let fake = Fake::over(everything());
    let mut window = fake.window(on_models());
    assert!(says(&window, "Touch the screen first (step 3)"));
    press_next(&mut window, "Go to Touch");
    assert!(shows(&window, "Plan"), "the tiles of Touch are open");
}

#[test]
fn what_was_recorded_is_trained_by_one_button() {
    let fake = Fake::over(with(recorded()));
    let mut window = fake.window_of_size(on_models(), TALL);
    assert!(says(&window, "touches to learn from: 80"));
    assert!(says(&window, "noise floor of repeats:"));
    assert!(says(&window, "Left out: 2 rows touched nothing."));
    press_next(&mut window, "Train M1, M2 and M3 on 80 touches");
    let all = ModelsCommand::Train { methods: Method::ALL.to_vec(), seed: 1, published_recipe: false };
    assert_eq!(models(&fake), [all]);
}

/// Fewer touches than the networks need lead back to touching; M1 alone can be trained all the same.
#[test]
fn too_few_touches_for_a_network_are_said_before_anything_is_trained() {
    let some: Vec<_> = data().touches.into_iter().step_by(5).take(15).collect();
    let few = TouchData::new(some, screen(), vec![]).expect("touches");
    let fake = Fake::over(with(ModelsView { data: Some(Ok(Arc::new(few))), ..recorded() }));
    let mut window = fake.window_of_size(on_models(), TALL);
    assert!(says(&window, "15 touches are too few for M2 and M3, which need 20"));
    click(&mut window, "Train M1 on 15 touches");
    let m1 = ModelsCommand::Train { methods: vec![Method::M1], seed: 1, published_recipe: false };
    assert_eq!(models(&fake), [m1]);
    press_next(&mut window, "Go to Touch");
}

#[test]
fn methods_seed_and_recipe_are_chosen() {
    let fake = Fake::over(with(recorded()));
    let mut window = fake.window_of_size(on_models(), TALL);
    click(&mut window, "M1");
    click(&mut window, "More");
    window.run_steps(12);
    click(&mut window, "As published: Adam, 200 epochs");
    click(&mut window, "Train M2 and M3 on 80 touches");
    let wanted =
        ModelsCommand::Train { methods: vec![Method::M2, Method::M3], seed: 1, published_recipe: true };
    assert_eq!(models(&fake), [wanted]);
    click(&mut window, "M2");
    click(&mut window, "M3");
    assert!(says(&window, "Choose at least one model."));
    click(&mut window, "Train models on 80 touches");
    assert_eq!(models(&fake), []);
}

#[test]
fn a_session_is_chosen_and_a_broken_one_says_why_not() {
    let fake = Fake::over(with(recorded()));
    let mut window = fake.window_of_size(on_models(), TALL);
    let row = window.query_all_by_label_contains("· 245 touches").next().expect("a row");
    row.click();
    window.run_steps(3);
    let session = sessions()[1].folder.clone();
    assert_eq!(models(&fake), [ModelsCommand::ChooseSession { session }]);
    let broken = window.query_all_by_label_contains("1 touch is too few").next().expect("a row");
    broken.click();
    window.run_steps(3);
    assert_eq!(models(&fake), []);
    click(&mut window, "Look again");
    assert_eq!(models(&fake), [ModelsCommand::ListSessions]);
}

#[test]
fn a_session_that_cannot_be_used_is_told_in_words() {
    let why = Arc::new(ModelError::NoTip);
    let fake = Fake::over(with(ModelsView { data: Some(Err(why)), ..recorded() }));
    let window = fake.window_of_size(on_models(), TALL);
    assert!(says(&window, "does not say which tip touched"));
    assert!(says(&window, "Choose another session."));
}

#[test]
fn while_training_curves_are_drawn_and_nothing_is_offered() {
    let fake = Fake::over(with(training()));
    let mut window = fake.window_of_size(on_models(), TALL);
    assert!(says(&window, "M3: held out"));
    assert!(says(&window, "Models are being trained."));
    window.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::Enter);
    window.run_steps(2);
    assert_eq!(models(&fake), []);
}

#[test]
fn a_training_that_failed_says_why() {
    let failed = JobView {
        id: JobId(3),
        title: "Train M1, M2 and M3".to_owned(),
        state: JobState::Failed {
            reason: "Training M3 diverged in iteration 4: choose another seed.".to_owned(),
        },
        elapsed: std::time::Duration::from_secs(1),
        by_itself: false,
    };
    let fake = Fake::over(View { jobs: Arc::from([failed]), ..with(recorded()) });
    let window = fake.window_of_size(on_models(), TALL);
    assert!(says(&window, "diverged in iteration 4"));
}

#[test]
fn methods_are_compared_in_figures_and_in_words() {
    let fake = Fake::over(with(trained()));
    let window = on_comparison(&fake);
    let headline = ["M3 is best: ", "M2 is best: ", " is simpler and cannot be told apart from it"];
    assert!(headline.into_iter().any(|words| says(&window, words)), "a headline");
    assert!(says(&window, "95 %"), "whether the others can be told apart");
    for method in Method::ALL {
        let row = format!("{}: ", method.name());
        let rows = window.query_all_by_label_contains(&row);
        let labels: Vec<String> = rows.filter_map(|node| node.accesskit_node().label()).collect();
        assert!(labels.iter().any(|label| label.contains(" mm, ") && label.contains(" to ")), "{labels:?}");
    }
    assert!(says(&window, "No model: "));
    assert!(says(&window, "noise of repeats: how far"), "the dashed line is explained");
}

#[test]
fn every_button_of_the_comparison_asks_for_what_it_says() {
    let fake = Fake::over(with(trained()));
    let mut window = on_comparison(&fake);
    for (button, wanted) in [
        ("Use M1", ModelsCommand::Accept(Method::M1)),
        ("Use M2", ModelsCommand::Accept(Method::M2)),
        ("Discard proposals", ModelsCommand::Discard),
        ("Use none", ModelsCommand::UseNone),
    ] {
        click(&mut window, button);
        assert_eq!(models(&fake), [wanted], "{button}");
    }
    let back = window.query_all_by_label_contains("Undo: ").next().expect("a button");
    back.click();
    window.run_steps(3);
    assert_eq!(models(&fake), [ModelsCommand::Undo]);
    let row = window
        .query_all_by_label_contains("M2: ")
        .find(|node| node.accesskit_node().label().is_some_and(|label| label.contains(" to ")));
    row.expect("a row").click();
    window.run_steps(3);
    assert_eq!(models(&fake), [ModelsCommand::Show(Method::M2)]);
}

#[test]
fn files_are_asked_for_and_then_read_or_written() {
    let fake = Fake::over(with(trained()));
    let mut window = on_comparison(&fake);
    let type_path = |window: &mut Harness<'_, PlumblineWindow>, button: &str| {
        click(window, button);
        window.event(egui::Event::Text("here".to_owned()));
        window.run_steps(2);
        click(window, "Open");
    };
    type_path(&mut window, "Import a model…");
    assert_eq!(models(&fake), [ModelsCommand::Import { file: "here".into() }]);
    click(&mut window, "Training");
    type_path(&mut window, "Open folder…");
    assert_eq!(models(&fake), [ModelsCommand::ChooseSession { session: "here".into() }]);
    click(&mut window, "Models compared");
    click(&mut window, "Export M3 as ONNX…");
    click(&mut window, "Save");
    let wanted = ModelsCommand::Export { method: Method::M3, onnx: true, file: "m3.onnx".into() };
    assert_eq!(models(&fake), [wanted]);
}

#[test]
fn proposals_bring_the_comparison_to_the_front_and_training_its_curves() {
    let fake = Fake::over(with(recorded()));
    let mut window = fake.window(on_models());
    assert!(says(&window, "touches to learn from"));
    click(&mut window, "Models compared");
    fake.show(with(training()));
    window.run_steps(3);
    assert!(says(&window, "touches to learn from"), "its curves");
    fake.show(with(trained()));
    window.run_steps(3);
    assert!(!says(&window, "touches to learn from") && shows(&window, "Discard proposals"));
}

#[test]
fn the_best_proposal_is_used_by_the_button_of_the_step() {
    let view = trained();
    let error = |method| view.comparison.as_ref().and_then(|c| c.of(method)).map(|h| h.errors.mean_2d_m);
    let best = Method::ALL.into_iter().min_by(|a, b| error(*a).partial_cmp(&error(*b)).expect("numbers"));
    let best = best.expect("three");
    let fake = Fake::over(with(view));
    let mut window = fake.window(on_models());
    let label = format!("Use {}", best.name());
    let button =
        window.get_all_by_label(&label).map(|node| node.rect()).max_by(|a, b| a.top().total_cmp(&b.top()));
    let button = button.expect("the button of the step");
    assert!(button.right() < 640.0, "not where touches were collected a moment ago: {button}");
    window.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::Enter);
    window.run_steps(2);
    assert_eq!(models(&fake), [ModelsCommand::Accept(best)]);
}

#[test]
fn a_model_that_may_be_no_better_than_none_is_not_called_best() {
    let view = trained();
    let held_out =
        |method| view.comparison.as_ref().and_then(|compared| compared.of(method)).expect("judged");
    let best = Method::ALL.into_iter().map(held_out);
    let best = best.min_by(|a, b| a.errors.mean_2d_m.total_cmp(&b.errors.mean_2d_m)).expect("three");
    let [low_m, high_m] = best.mean_2d_interval_m;
    for (without_m, words) in
        [(0.5 * low_m, "which is less."), (0.5 * (low_m + high_m), "which cannot be told apart from that.")]
    {
        let mut view = view.clone();
        Arc::make_mut(view.map.as_mut().expect("drawn")).without_m = Some(without_m);
        let fake = Fake::over(with(view));
        let mut window = fake.window(on_models());
        click(&mut window, "Models compared");
        assert!(says(&window, words), "{words}");
    }
}

#[test]
fn the_models_that_were_not_chosen_ask_for_nothing_any_more() {
    let others = trained().proposals.into_iter().filter(|model| model.method() != Method::M3).collect();
    let fake = Fake::over(with(ModelsView { proposals: others, ..in_use() }));
    let mut window = fake.window(on_models());
    assert!(shows(&window, "Check M3 with new touches"));
    click(&mut window, "Models compared");
    assert!(shows(&window, "Use M1"), "but they can still be used");
}

#[test]
fn a_model_in_use_is_checked_with_new_touches() {
    let fake = Fake::over(with(in_use()));
    let mut window = fake.window(on_models());
    press_next(&mut window, "Check M3 with new touches");
    let sent = fake.take_sent();
    assert_eq!(sent[0], Command::from(TouchCommand::CorrectWith(Some(Method::M3.into()))));
    let Some(Command::Touch(TouchCommand::Plan(options))) = sent.get(1) else { panic!("{sent:?}") };
    assert_eq!(options.purpose, plumbline_model::touch_plan::Purpose::Check);
}

#[test]
fn a_stale_model_says_why_and_is_trained_anew() {
    let why = "the screen was moved after these touches".to_owned();
    let fake = Fake::over(with(ModelsView { step: StepState::Stale { why }, ..in_use() }));
    let mut window = fake.window(on_models());
    assert!(says(&window, "screen was moved"));
    press_next(&mut window, "Train M1, M2 and M3 on 80 touches");
    assert!(matches!(models(&fake).as_slice(), [ModelsCommand::Train { .. }]));
}

#[test]
fn the_map_warns_of_what_lies_outside_its_border() {
    let fake = Fake::over(with(trained()));
    let mut window = fake.window(on_models());
    assert!(says(&window, "21.4 mm on average, outside 54.5 mm: do not trust it there"));
    assert!(says(&window, "Before, without a model:"));
    assert!(says(&window, "After, each touch held out:"));
    click(&mut window, "After");
    assert!(!says(&window, "Before, without a model:"));
    let map = window.get_by_label("Map of the model").rect();
    window.hover_at(map.center());
    window.run_steps(3);
    click(&mut window, "Correction");
    assert!(shows(&window, "Map of the model"));
}

// ------------------------------------------------------------------- tables

fn on_tables(fake: &Fake) -> Harness<'static, PlumblineWindow> {
    let mut window = fake.window_of_size(on_models(), TALL);
    click(&mut window, "Grasp height and yaw");
    window
}

fn point(window: &Harness<'_, PlumblineWindow>, number: usize) -> Pos2 {
    let label = format!("Point {number}: ");
    window.query_all_by_label_contains(&label).next().expect("a point").rect().center()
}

fn drag(window: &mut Harness<'_, PlumblineWindow>, from: Pos2, by: egui::Vec2) {
    window.hover_at(from);
    window.run_steps(2);
    window.drag_at(from);
    window.run_steps(2);
    for part in [0.5, 1.0] {
        window.hover_at(from + by * part);
        window.run_steps(2);
    }
    window.drop_at(from + by);
    window.run_steps(3);
}

#[test]
fn a_point_of_the_table_is_dragged() {
    let fake = Fake::over(with(recorded()));
    let mut window = on_tables(&fake);
    let from = point(&window, 8);
    drag(&mut window, from, vec2(-30.0, -40.0));
    let sent = edits(&fake);
    let [TablesCommand::Change { table: GraspTable::Height, point: 7, at_m, value }] = sent.as_slice() else {
        panic!("one change: {sent:?}")
    };
    let before = tables().height.expect("heights").points[7];
    assert!(at_m[0] > before.x_m + 0.005 && at_m[1] > before.y_m + 0.005, "{at_m:?} {before:?}");
    assert_eq!(*value, before.height_m);
    // Until the engine answers it is shown where it was put, and then where it is.
    assert!((point(&window, 8) - from - vec2(-30.0, -40.0)).length() < 2.0);
    assert!(says(&window, "Point 8 of 24"));
}

#[test]
fn points_are_added_removed_and_brought_back() {
    let fake = Fake::over(with(recorded()));
    let mut window = on_tables(&fake);
    click(&mut window, "Add the arm's present pose");
    assert_eq!(edits(&fake), [TablesCommand::AddHere { table: GraspTable::Height }]);
    let at = point(&window, 3);
    click_at(&mut window, at);
    assert_eq!(edits(&fake), [], "a click moves nothing");
    click(&mut window, "Remove the point");
    assert_eq!(edits(&fake), [TablesCommand::Remove { table: GraspTable::Height, point: 2 }]);
    click(&mut window, "Undo");
    assert_eq!(edits(&fake), [TablesCommand::Undo]);
}

#[test]
fn a_click_adds_a_point_when_it_was_asked_for() {
    let fake = Fake::over(with(recorded()));
    let mut window = on_tables(&fake);
    let map = window.get_by_label("Points of the table").rect();
    let at = map.center() + vec2(0.0, -0.36 * map.height());
    click_at(&mut window, at);
    assert_eq!(edits(&fake), [], "not asked for");
    click(&mut window, "Add at a click");
    assert!(says(&window, "Click the map where"));
    click_at(&mut window, at);
    let sent = edits(&fake);
    assert!(matches!(sent.as_slice(), [TablesCommand::Add { table: GraspTable::Height, .. }]), "{sent:?}");
}

#[test]
fn a_point_is_changed_in_numbers() {
    let fake = Fake::over(with(recorded()));
    let mut window = on_tables(&fake);
    let row = window.query_all_by_label_contains("Row of point 5:").next();
    assert!(row.is_some() || says(&window, "Row of point"), "the list names its points");
    let at = point(&window, 5);
    click_at(&mut window, at);
    let field = window.get_by_role_and_label(egui::accesskit::Role::SpinButton, "grasp height");
    field.click();
    window.run_steps(3);
    window.event(egui::Event::Text("51,5".to_owned()));
    window.run_steps(2);
    window.key_press(egui::Key::Enter);
    window.run_steps(3);
    let sent = edits(&fake);
    let [TablesCommand::Change { table: GraspTable::Height, point: 4, at_m, value }] = sent.as_slice() else {
        panic!("one change: {sent:?}")
    };
    let before = tables().height.expect("heights").points[4];
    assert!((value - 0.0515).abs() < 1e-9, "{value}");
    assert_eq!([at_m[0], at_m[1]], [before.x_m, before.y_m]);
}

#[test]
fn the_yaw_table_is_seen_layer_by_layer() {
    let fake = Fake::over(with(recorded()));
    let mut window = on_tables(&fake);
    click(&mut window, "Yaw");
    let count = |window: &Harness<'_, PlumblineWindow>| {
        window
            .query_all_by_label_contains("Point ")
            .filter(|node| node.accesskit_node().label().is_some_and(|label| label.contains('°')))
            .count()
    };
    assert_eq!(count(&window), 32);
    click(&mut window, "80.0 mm");
    assert_eq!(count(&window), 16);
}

#[test]
fn what_an_import_replaces_is_said_at_its_button() {
    let fake = Fake::over(with(recorded()));
    let mut window = on_tables(&fake);
    for (table, said) in [("Height", "Replaces the whole table."), ("Yaw", "import one file per height")] {
        click(&mut window, table);
        window.hover_at(egui::pos2(2.0, 2.0));
        window.run_steps(2);
        let button = window.get_by_label("Import CSV…").rect().center();
        window.hover_at(button);
        window.run_steps(60);
        assert!(says(&window, said), "{table}");
    }
}

#[test]
fn without_tables_and_without_an_arm_the_ways_to_fill_them_are_said() {
    let empty = ModelsView { tables: Arc::new(TablesView::default()), ..recorded() };
    let fake = Fake::over(with(empty));
    let mut window = on_tables(&fake);
    assert!(says(&window, "No table of grasp height yet"));
    assert!(window.get_by_label("Add the arm's present pose").accesskit_node().is_disabled());
    click(&mut window, "Import CSV…");
    window.event(egui::Event::Text("heights.csv".to_owned()));
    window.run_steps(2);
    click(&mut window, "Open");
    let wanted = TablesCommand::Import { table: GraspTable::Height, file: "heights.csv".into() };
    assert_eq!(edits(&fake), [wanted]);
}

/// Every state drawn into a PNG of `PLUMBLINE_WINDOW_PICTURES=<folder>`, with `--ignored pictures`.
#[test]
#[ignore = "draws pictures for people to look at"]
fn pictures_of_the_models() {
    let folder = crate::fake::picture_folder();
    let stale = StepState::Stale { why: "the screen was moved after these touches".to_owned() };
    let states = [
        ("empty", ModelsView::default(), None),
        ("compared", trained(), Some("Models compared")),
        ("recorded", recorded(), None),
        ("training", training(), None),
        ("stale", ModelsView { step: stale, ..in_use() }, None),
        ("height", recorded(), Some("Height")),
        ("yaw", recorded(), Some("Yaw")),
    ];
    for theme in [ThemeChoice::Dark, ThemeChoice::Light] {
        for (name, view, table) in &states {
            let fake = Fake::over(with(view.clone()));
            let mut window = fake.window_with(WindowSettings { theme, ..on_models() }, [1280.0, 800.0], true);
            if let Some("Models compared") = table {
                click(&mut window, "Models compared");
            } else if let Some(table) = table {
                click(&mut window, "Grasp height and yaw");
                click(&mut window, table);
                let at = point(&window, 9);
                click_at(&mut window, at);
            }
            window.run_steps(2);
            let image = window.render().expect("the test renderer draws");
            let file = format!("models {name} {theme:?}.png").to_lowercase().replace(' ', "-");
            image.save(folder.join(file)).expect("the folder can be written");
        }
    }
}
