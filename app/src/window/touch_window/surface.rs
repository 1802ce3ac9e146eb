//! What the touch window shows and feels.

use egui::{Align2, Color32, FontId, Pos2, Rect, Sense, TextStyle, Ui, pos2, vec2};
use plumbline_engine::view::{TouchOutcome, TouchPhase, TouchView};
use plumbline_engine::{ScreenContact, ScreenWindow, TouchCommand};
use plumbline_model::session::Touchscreen;
use plumbline_widgets::theme::{ON_IMAGE, size, space};
use plumbline_widgets::touch_pattern::{TargetLook, paint_felt, paint_target};

use super::contacts::{Contact, ContactFilter};
use crate::operator::words::capitalized;
use crate::operator::{done_of, wanted, window_problem};
use crate::panels::next_touch;

/// Radius of the ring of a target: about a fingertip wide on the glass, m.
const RING_M: f64 = 0.006;
/// A ring stays where the glass was felt for so long, s.
const SHOWN_S: f64 = 2.0;

/// What the surface remembers from frame to frame.
#[derive(Clone, Debug, Default)]
pub struct TouchSurface {
    filter: ContactFilter,
    felt: Option<Felt>,
    /// Number of the newest contact that the engine showed, and since when.
    shown: Option<(u64, f64)>,
}

#[derive(Clone, Copy, Debug)]
struct Felt {
    at_px: [f64; 2],
    is_down: bool,
    at_s: f64,
}

/// Maps pixels of the touchscreen to points of the window.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Glass {
    rect: Rect,
    /// Points per pixel of the screen, across and down.
    points_per_px: [f64; 2],
}

impl Glass {
    /// In full screen a pixel is a pixel of the monitor. A window that is only tried out shows
    /// the whole screen, smaller.
    fn new(rect: Rect, pixels_per_point: f32, screen: &Touchscreen, window: &ScreenWindow) -> Self {
        let points_per_px = if window.full_screen {
            [1.0 / f64::from(pixels_per_point); 2]
        } else {
            [
                f64::from(rect.width()) / f64::from(screen.width_px.max(1)),
                f64::from(rect.height()) / f64::from(screen.height_px.max(1)),
            ]
        };
        Self { rect, points_per_px }
    }

    /// (0, 0) is the center of the first pixel.
    fn to_points(self, at_px: [f64; 2]) -> Pos2 {
        let [u, v] = self.points_per_px;
        self.rect.min + vec2(((at_px[0] + 0.5) * u) as f32, ((at_px[1] + 0.5) * v) as f32)
    }

    fn to_px(self, at: Pos2) -> [f64; 2] {
        let [u, v] = self.points_per_px;
        let by = at - self.rect.min;
        [f64::from(by.x) / u - 0.5, f64::from(by.y) / v - 0.5]
    }
}

/// Draws the touch window over all of `ui`, and returns what was felt.
pub fn touch_surface(
    ui: &mut Ui,
    touch: &TouchView,
    screen: Option<&Touchscreen>,
    window: &ScreenWindow,
    surface: &mut TouchSurface,
) -> Vec<TouchCommand> {
    let (rect, response) = ui.allocate_exact_size(ui.available_size(), Sense::hover());
    // Pixels of the monitor count from its corner, whatever stands around `ui`.
    let rect = if window.full_screen { ui.ctx().viewport_rect() } else { rect };
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, "Touch window"));
    ui.painter().rect_filled(rect, 0.0, Color32::BLACK);
    let Some(screen) = screen else {
        words(ui, rect, Align2::LEFT_TOP, "No touchscreen is known", "Connect the twin or a robot.");
        return Vec::new();
    };
    let glass = Glass::new(rect, ui.ctx().pixels_per_point(), screen, window);
    let now_s = ui.input(|input| input.time);
    let commands = feel(ui, glass, now_s, surface);
    let unit = (RING_M / screen.pitch_m()[0] * glass.points_per_px[0]) as f32;
    let at = pattern(ui, touch, glass, unit.max(6.0));
    felt(ui, touch, glass, unit.max(6.0), now_s, surface);
    let (head, below) = sentence(touch);
    // The words keep out of the way of the target.
    let top = Rect::from_min_size(rect.min, vec2(rect.width() * 0.7, 110.0));
    let anchor = if at.is_some_and(|at| top.contains(at)) { Align2::LEFT_BOTTOM } else { Align2::LEFT_TOP };
    words(ui, rect, anchor, &head, &below);
    if let Some(problem) = window_problem(window, screen) {
        let at = rect.right_bottom() - vec2(space::L, space::L);
        let problem = capitalized(&problem);
        text(ui, at, Align2::RIGHT_BOTTOM, &problem, font(ui, TextStyle::Body), ON_IMAGE.warning);
    }
    commands
}

fn feel(ui: &Ui, glass: Glass, now_s: f64, surface: &mut TouchSurface) -> Vec<TouchCommand> {
    let contacts: Vec<Contact> = ui.input(|input| {
        input.events.iter().filter_map(|event| surface.filter.contact(event, now_s)).collect()
    });
    // What begins beside the glass (in what stands around a window that is tried out) is none.
    let beside = |contact: &Contact| contact.down && !glass.rect.contains(contact.at);
    if contacts.iter().any(beside) {
        surface.filter.forget();
        return Vec::new();
    }
    contacts
        .into_iter()
        .map(|contact| {
            let at_px = glass.to_px(contact.at);
            surface.felt = Some(Felt { at_px, is_down: contact.down, at_s: now_s });
            // The window system says no times; a frame is drawn as soon as something comes.
            TouchCommand::Contact(ScreenContact {
                u_px: at_px[0],
                v_px: at_px[1],
                age_s: 0.0,
                with: contact.with,
                down: contact.down,
            })
        })
        .collect()
}

/// Area, what was done, and the target; returns where the target is.
fn pattern(ui: &Ui, touch: &TouchView, glass: Glass, unit: f32) -> Option<Pos2> {
    let painter = ui.painter();
    if let Some(plan) = &touch.plan {
        let corners = plan.options.area.corners().map(|pixel| glass.to_points([pixel.u_px, pixel.v_px]));
        let stroke = egui::Stroke::new(1.0, ON_IMAGE.text_weak.gamma_multiply(0.35));
        painter.rect_stroke(
            Rect::from_two_pos(corners[0], corners[2]),
            0.0,
            stroke,
            egui::StrokeKind::Middle,
        );
    }
    let at =
        |px: plumbline_model::Pixel<plumbline_model::session::Screen>| glass.to_points([px.u_px, px.v_px]);
    for one in touch.touches.iter().filter(|one| one.outcome == TouchOutcome::Touched) {
        paint_target(painter, at(one.target), unit, TargetLook::Done);
    }
    let running = matches!(touch.phase, TouchPhase::Running { .. });
    let number = next_touch(touch).filter(|_| touch.phase != TouchPhase::Finished)?;
    let one = touch.touches.iter().find(|one| one.number == number)?;
    let look = if running { TargetLook::Now } else { TargetLook::Waits };
    paint_target(painter, at(one.target), unit, look);
    Some(at(one.target))
}

/// Rings where the glass was felt: by this window, and by whoever else feels.
fn felt(ui: &Ui, touch: &TouchView, glass: Glass, unit: f32, now_s: f64, surface: &mut TouchSurface) {
    let mut rings = Vec::new();
    if let Some(felt) = surface.felt.filter(|felt| felt.is_down || now_s - felt.at_s < SHOWN_S) {
        rings.push((felt.at_px, felt.is_down));
    }
    if let Some(contact) = touch.last_contact {
        let since_s = match surface.shown {
            Some((number, since_s)) if number == contact.number => since_s,
            _ => now_s,
        };
        surface.shown = Some((contact.number, since_s));
        if contact.is_down || now_s - since_s < SHOWN_S {
            rings.push(([contact.pixel.u_px, contact.pixel.v_px], contact.is_down));
        }
    }
    for &(at_px, is_down) in &rings {
        paint_felt(ui.painter(), glass.to_points(at_px), unit, is_down);
    }
    if !rings.is_empty() {
        ui.ctx().request_repaint_after(std::time::Duration::from_millis(200));
    }
}

/// How far it is, and what the arm does.
fn sentence(touch: &TouchView) -> (String, String) {
    let (done, wanted) = (done_of(touch.counts), wanted(touch.counts));
    let progress = format!("{done} of {wanted}");
    match &touch.phase {
        TouchPhase::Idle => ("Nothing is planned".to_owned(), "Plan touches in the main window.".to_owned()),
        TouchPhase::Planning => ("Planning".to_owned(), String::new()),
        TouchPhase::Planned => (progress, "The arm stands. It begins from the main window.".to_owned()),
        TouchPhase::Waiting { what, .. } => (progress, what.clone()),
        TouchPhase::Running { doing, .. } => (progress, format!("The arm is {doing}")),
        TouchPhase::Paused { why } => {
            let why = why.as_ref().map_or_else(String::new, |why| format!(": {why}"));
            (progress, format!("Paused{why}"))
        }
        TouchPhase::Finished => (progress, "Finished".to_owned()),
    }
}

fn words(ui: &Ui, rect: Rect, anchor: Align2, head: &str, below: &str) {
    let heading = font(ui, TextStyle::Heading);
    let body = font(ui, TextStyle::Body);
    let x = rect.left() + space::L;
    let line = size::HEADING + space::S;
    let top = if anchor == Align2::LEFT_TOP {
        rect.top() + space::L
    } else {
        rect.bottom() - space::L - line - size::BODY
    };
    text(ui, pos2(x, top), Align2::LEFT_TOP, head, heading, ON_IMAGE.text);
    text(ui, pos2(x, top + line), Align2::LEFT_TOP, below, body, ON_IMAGE.text_weak);
}

/// Words on black, whatever lies below.
fn text(ui: &Ui, at: Pos2, anchor: Align2, text: &str, font: FontId, color: Color32) {
    let galley = ui.painter().layout_no_wrap(text.to_owned(), font, color);
    let rect = anchor.anchor_size(at, galley.size());
    ui.painter().rect_filled(rect.expand2(vec2(space::S, 2.0)), 0.0, Color32::BLACK);
    ui.painter().galley(rect.min, galley, color);
}

fn font(ui: &Ui, style: TextStyle) -> FontId {
    style.resolve(ui.style())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_of_the_monitor_and_points_are_inverse_at_any_scale() {
        let screen =
            plumbline_model::robot::Rig::built_in("nico").expect("comes with the program").touchscreen;
        let window = |full_screen| ScreenWindow { width_px: 1920, height_px: 1080, full_screen };
        for (scale, full_screen) in [(1.0, true), (1.5, true), (2.0, false)] {
            let rect = Rect::from_min_size(pos2(0.0, 0.0), vec2(1920.0, 1080.0) / scale);
            let glass = Glass::new(rect, scale, &screen, &window(full_screen));
            let back = glass.to_px(glass.to_points([1500.0, 33.0]));
            assert!((back[0] - 1500.0).abs() < 1e-3 && (back[1] - 33.0).abs() < 1e-3, "{scale}: {back:?}");
            let corner = glass.to_px(rect.max);
            assert!((corner[0] - 1919.5).abs() < 1e-3 && (corner[1] - 1079.5).abs() < 1e-3, "{corner:?}");
        }
    }
}
