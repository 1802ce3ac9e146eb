//! The touch window alone: what it shows, and what it feels.

use egui::{Event, Modifiers, PointerButton, Pos2, TouchDeviceId, TouchId, pos2, vec2};
use egui_kittest::Harness;
use plumbline::{TouchSurface, touch_surface};
use plumbline_engine::view::TouchView;
use plumbline_engine::{ContactWith, ScreenContact, ScreenWindow, TouchCommand};

use crate::made_up_touch::{idle, running, screen};

#[derive(Default)]
struct Shown {
    surface: TouchSurface,
    felt: Vec<ScreenContact>,
}

/// Full screen on a monitor of half a point per pixel, as on a monitor with scale 2.
fn shown(touch: TouchView, full_screen: bool, picture: bool) -> Harness<'static, Shown> {
    let builder = Harness::builder()
        .with_size(vec2(960.0, 540.0))
        .with_pixels_per_point(2.0)
        .with_step_dt(0.02)
        .with_context_setup(|ctx| plumbline_widgets::theme::apply(ctx, egui::Theme::Dark));
    let builder = if picture { builder.wgpu() } else { builder };
    let mut harness = builder.build_ui_state(
        move |ui, shown: &mut Shown| {
            let window = ScreenWindow { width_px: 1920, height_px: 1080, full_screen };
            let screen = screen();
            egui::CentralPanel::default().frame(egui::Frame::NONE).show(ui, |ui| {
                for command in touch_surface(ui, &touch, Some(&screen), &window, &mut shown.surface) {
                    let TouchCommand::Contact(contact) = command else { panic!("{command:?}") };
                    shown.felt.push(contact);
                }
            });
        },
        Shown::default(),
    );
    harness.run_steps(2);
    harness
}

fn finger(phase: egui::TouchPhase, pos: Pos2) -> Event {
    Event::Touch { device_id: TouchDeviceId(3), id: TouchId(9), phase, pos, force: None }
}

fn press(pos: Pos2, pressed: bool) -> Event {
    Event::PointerButton { pos, button: PointerButton::Primary, pressed, modifiers: Modifiers::NONE }
}

#[test]
fn a_finger_is_felt_once_at_the_pixel_of_the_monitor() {
    let mut harness = shown(running(), true, false);
    let at = pos2(480.25, 270.0);
    for event in [finger(egui::TouchPhase::Start, at), Event::PointerMoved(at), press(at, true)] {
        harness.event(event);
    }
    harness.run_steps(2);
    for event in [finger(egui::TouchPhase::End, at), press(at, false), Event::PointerGone] {
        harness.event(event);
    }
    harness.run_steps(2);
    let felt = &harness.state().felt;
    let [down, up] = felt.as_slice() else { panic!("one contact: {felt:?}") };
    assert!((down.u_px - 960.0).abs() < 1e-3 && (down.v_px - 539.5).abs() < 1e-3, "{down:?}");
    assert!(down.down && !up.down && down.with == ContactWith::Touch);
}

#[test]
fn the_mouse_tries_it_out() {
    let mut harness = shown(running(), false, false);
    for pressed in [true, false] {
        harness.event(Event::PointerMoved(pos2(10.0, 10.0)));
        harness.event(press(pos2(10.0, 10.0), pressed));
        harness.run_steps(2);
    }
    let felt = &harness.state().felt;
    assert_eq!(felt.len(), 2);
    assert_eq!(felt[0].with, ContactWith::Mouse);
}

/// Every state drawn into a PNG of `PLUMBLINE_WINDOW_PICTURES=<folder>`, with `--ignored pictures`.
#[test]
#[ignore = "draws pictures for people to look at"]
fn pictures_of_the_touch_window() {
    let folder = crate::fake::picture_folder();
    for (name, touch, full) in
        [("running", running(), true), ("tried-out", running(), false), ("idle", idle(), true)]
    {
        let mut harness = shown(touch, full, true);
        let image = harness.render().expect("the test renderer draws");
        image.save(folder.join(format!("touch-window-{name}.png"))).expect("the folder can be written");
    }
}
