//! Calibrating how the eyes sit in the head: one button per step of it.

use std::sync::Arc;

use egui_kittest::kittest::{NodeT as _, Queryable as _};
use plumbline::{Screen, ThemeChoice, WindowSettings};
use plumbline_engine::view::{
    AcceptedCalibration, EyesView, MountView, RobotView, SourceStatus, SourceView, StepState, TouchView,
    TwinView,
};
use plumbline_engine::{Command, MountCommand, RobotCommand, TwinCommand, View};
use plumbline_model::StereoCalibration;

use crate::fake::{Fake, click, says, shows};
use crate::made_up::{connected, everything, lying_board, mount, rig, solved_mount, twin};
use crate::made_up_touch::placement;

fn on_mount() -> WindowSettings {
    WindowSettings { screen: Screen::Mount, ..WindowSettings::default() }
}

/// The eyes are calibrated and the board lies on the table.
fn ready(mount: MountView) -> View {
    let twin = TwinView { board: Some(lying_board()), ..twin() };
    let eyes = EyesView { in_use: Some(calibrated()), ..EyesView::default() };
    View { mount: Arc::new(mount), twin: Arc::new(twin), eyes: Arc::new(eyes), ..everything() }
}

fn sent(fake: &Fake) -> Vec<MountCommand> {
    let only = |command| if let Command::Mount(command) = command { Some(command) } else { None };
    fake.take_sent().into_iter().filter_map(only).collect()
}

fn calibrated() -> Arc<AcceptedCalibration> {
    Arc::new(AcceptedCalibration {
        id: "first".to_owned(),
        calibration: Arc::new(StereoCalibration::bare(rig().eyes.cameras)),
        accepted: jiff::Timestamp::now(),
        uncertainty: None,
        stated_at_m: 0.45,
        depth_per_px_m: None,
    })
}

#[test]
fn without_calibrated_eyes_it_leads_to_them() {
    let fake = Fake::over(everything());
    let mut window = fake.window(on_mount());
    assert!(says(&window, "Calibrate the eyes first"));
    click(&mut window, "Calibrate the eyes");
    assert_eq!(sent(&fake), []);
}

#[test]
fn one_button_leads_through_the_work() {
    let planned = MountView { planned: vec![(0.1, -0.5); 14].into(), ..MountView::default() };
    let seen = MountView { proposal: None, ..mount() };
    for (view, button, wanted) in [
        (MountView::default(), "Plan head poses", MountCommand::Plan),
        (planned, "Turn the head to 14 poses", MountCommand::Tour),
        (seen, "Solve 13 views", MountCommand::Solve),
        (mount(), "Accept the mount", MountCommand::Accept),
    ] {
        let fake = Fake::over(ready(view));
        let mut window = fake.window(on_mount());
        let buttons: Vec<_> = window.get_all_by_label(button).collect();
        // The last one is in the bottom line.
        buttons.last().expect("a button").click();
        window.run_steps(3);
        assert_eq!(sent(&fake), [wanted], "{button}");
    }
}

#[test]
fn a_proposal_of_other_views_is_solved_again_and_not_accepted() {
    let why = "The views are others than those that the proposed mount was solved from. Solve it again.";
    let stale = MountView { proposal_stale: Some(why.to_owned()), ..mount() };
    let fake = Fake::over(ready(stale));
    let mut window = fake.window(on_mount());
    assert!(says(&window, why) && !shows(&window, "Accept the mount"));
    click(&mut window, "Solve 13 views again");
    assert_eq!(sent(&fake), [MountCommand::Solve]);
}

#[test]
fn views_of_colder_eyes_go_first() {
    let mut mixed = mount();
    let mut views = mixed.views.to_vec();
    views.iter_mut().take(4).for_each(|view| view.is_colder = true);
    mixed.views = views.into();
    let fake = Fake::over(ready(mixed));
    let mut window = fake.window(on_mount());
    assert!(says(&window, "4 of 13 views were taken while the eyes were colder."));
    assert!(shows(&window, "colder"));
    click(&mut window, "Delete 4 views of colder eyes");
    assert_eq!(sent(&fake), [MountCommand::DeleteColder]);
}

#[test]
fn what_was_accepted_is_behind_and_the_button_leads_to_the_next_step() {
    // Eyes without a mount: on every screen where one looks at them, the mount comes next.
    for screen in [Screen::Live, Screen::Judge, Screen::Accept] {
        let source = SourceView { status: SourceStatus::Running, ..SourceView::default() };
        let fake = Fake::over(View { source: Arc::new(source), ..ready(MountView::default()) });
        let mut window = fake.window(WindowSettings { screen, ..WindowSettings::default() });
        assert!(says(&window, "Next: measure how the eyes sit in the head (step 2)."), "{screen:?}");
        click(&mut window, "Go to Mount");
        assert!(says(&window, "Plan head poses"), "{screen:?}");
    }
    // Its views are still there when it was accepted: they are not solved again, the screen is touched.
    let accepted = MountView {
        proposal: None,
        in_use: Some(solved_mount()),
        is_solved: true,
        step: StepState::Done,
        ..mount()
    };
    let fake = Fake::over(ready(accepted.clone()));
    let mut window = fake.window(on_mount());
    assert!(says(&window, "Next: touch the screen (step 3)."));
    click(&mut window, "Go to Touch");
    assert!(says(&window, "First measure where the screen lies"));
    // With that done, too, it leads further on, and not back to the board.
    let touch = TouchView { placement: Some(Arc::new(placement())), ..TouchView::default() };
    let placed = View { touch: Arc::new(touch), ..ready(accepted.clone()) };
    let window = Fake::over(placed.clone()).window(on_mount());
    assert!(says(&window, "Next: touch targets to learn from (step 3)."));
    let partly = window.get_by_role_and_label(egui::accesskit::Role::Tab, "Touch").accesskit_node().value();
    assert_eq!(partly.as_deref(), Some("partly done"));
    let mut touched = placed;
    Arc::make_mut(&mut touched.touch).step = StepState::Done;
    let window = Fake::over(touched).window(on_mount());
    assert!(says(&window, "Next: learn from the touches"));
    // A view more is one to solve with.
    let more = MountView { is_solved: false, ..accepted };
    let fake = Fake::over(ready(more));
    let window = fake.window(on_mount());
    assert!(says(&window, "Solve 13 views"));
}

#[test]
fn a_mount_of_eyes_that_were_taken_back_is_not_green() {
    let why = "The eyes that the mount was solved with are not in use any more.".to_owned();
    let step = StepState::Stale { why: why.clone() };
    let stale =
        MountView { proposal: None, views: Arc::from([]), in_use: Some(solved_mount()), step, ..mount() };
    let mut view = ready(stale);
    let mut window = Fake::over(view.clone()).window(on_mount());
    assert!(says(&window, &why) && shows(&window, "Plan head poses"));
    view.eyes = Arc::default();
    window = Fake::over(view).window(on_mount());
    assert!(says(&window, &why));
    click(&mut window, "Calibrate the eyes");
    assert!(shows(&window, "No pairs yet"));
}

#[test]
fn a_servo_that_was_let_go_is_taken_hold_of_before_the_work_goes_on() {
    let mut joints = connected().joints.to_vec();
    joints[0].let_go = true;
    joints[0].problem = Some("it did not answer for a while, so nothing is sent to it".to_owned());
    let robot = RobotView { joints: joints.into(), ..connected() };
    let planned = MountView { planned: vec![(0.1, -0.5); 8].into(), ..MountView::default() };
    for screen in [Screen::Mount, Screen::Touch] {
        let view = View { robot: Arc::new(robot.clone()), ..ready(planned.clone()) };
        let fake = Fake::over(view);
        let mut window = fake.window(WindowSettings { screen, ..WindowSettings::default() });
        assert!(says(&window, "it did not answer for a while"), "{screen:?}");
        assert!(!says(&window, "The head turns to 8 poses"), "{screen:?}: it would be refused");
        fake.take_sent();
        click(&mut window, "Hold all joints");
        let sent = fake.take_sent();
        let holds = matches!(sent.as_slice(), [Command::Robot(RobotCommand::Torque { on: true, .. })]);
        assert!(holds, "{screen:?}: {sent:?}");
    }
}

#[test]
fn while_the_head_tours_there_is_nothing_to_press() {
    let touring = MountView {
        step: StepState::Running,
        planned: vec![(0.1, -0.5); 9].into(),
        next: "The head turns and looks: 9 poses left.".to_owned(),
        ..MountView::default()
    };
    let fake = Fake::over(ready(touring));
    let mut window = fake.window(on_mount());
    assert!(says(&window, "9 poses left. Esc or space stops."));
    window.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::Enter);
    window.run_steps(2);
    assert_eq!(sent(&fake), []);
}

#[test]
fn the_tour_says_that_only_the_head_moves() {
    let planned = MountView { planned: vec![(0.1, -0.5); 14].into(), ..MountView::default() };
    let fake = Fake::over(ready(planned));
    let window = fake.window(on_mount());
    assert!(says(&window, "the arms stay"));
}

#[test]
fn the_board_is_laid_first_where_there_is_none() {
    let mut view = ready(MountView::default());
    view.twin = Arc::new(twin());
    let fake = Fake::over(view);
    let mut window = fake.window(on_mount());
    click(&mut window, "Lay the board on the table");
    let laid = fake.take_sent();
    assert!(matches!(laid.as_slice(), [Command::Twin(TwinCommand::LayBoard { .. })]), "{laid:?}");
}

#[test]
fn figures_come_with_their_uncertainty_and_left_out_views_with_the_reason() {
    let fake = Fake::over(ready(mount()));
    let window = fake.window(on_mount());
    for words in ["1.20 ± 0.78", "−1.203 ± 0.067", "the head had not settled", "0.183 px"] {
        assert!(says(&window, words), "{words}");
    }
}

/// Every state drawn into a PNG of `PLUMBLINE_WINDOW_PICTURES=<folder>`, with `--ignored pictures`.
#[test]
#[ignore = "draws pictures for people to look at"]
fn pictures_of_the_mount() {
    let folder = crate::fake::picture_folder();
    let both = MountView { in_use: Some(solved_mount()), ..mount() };
    for theme in [ThemeChoice::Dark, ThemeChoice::Light] {
        for (name, view) in [("empty", MountView::default()), ("solved", both.clone())] {
            let fake = Fake::over(ready(view));
            let mut window = fake.window_with(WindowSettings { theme, ..on_mount() }, [1280.0, 800.0], true);
            window.run_steps(2);
            let image = window.render().expect("the test renderer draws");
            let file = format!("mount {name} {theme:?}.png").to_lowercase().replace(' ', "-");
            image.save(folder.join(file)).expect("the folder can be written");
        }
    }
}
