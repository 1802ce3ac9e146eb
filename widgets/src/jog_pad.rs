//! Moving the tip of an arm by hand, for as long as an enable key is held.
//!
//! The pad gives back what is asked for right now, and nothing as soon as anything is released,
//! the window loses the keyboard, or the pad is disabled.

use std::sync::Arc;

use egui::{
    Align2, EventFilter, Id, Key, Pos2, Rect, Response, Sense, Stroke, StrokeKind, TextStyle, Ui, WidgetInfo,
    pos2, vec2,
};
use nalgebra::Vector3;

use crate::buttons::choice;
use crate::format;
use crate::glyph::{self, Glyph};
use crate::theme::{self, space};

const CELL: egui::Vec2 = vec2(64.0, 40.0);
const GAP: f32 = space::XS;
const ENABLE_HEIGHT: f32 = 46.0;
const PAD_WIDTH: f32 = 5.0 * CELL.x + 4.0 * GAP + 2.0 * space::S;
/// Where height and turn stand below the plane there is little height, too.
const NARROW_CELL: egui::Vec2 = vec2(64.0, 34.0);
const NARROW_ENABLE_HEIGHT: f32 = 40.0;
const NARROW_WIDTH: f32 = 3.0 * NARROW_CELL.x + 2.0 * GAP;

/// A motion that is asked for right now, in the robot's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JogIntent {
    /// Of the tip, in m/s: x forward, y left, z up.
    pub velocity_m_s: Vector3<f64>,
    /// About z, in rad/s; positive turns to the left.
    pub yaw_rate_rad_s: f64,
}

/// How fast a jog is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum JogSpeed {
    /// 5 mm/s and 3°/s: the last millimeters before contact.
    #[default]
    Fine,
    /// 20 mm/s and 10°/s.
    Normal,
    /// 60 mm/s and 30°/s, in the open.
    Fast,
}

impl JogSpeed {
    /// Of the tip.
    pub fn linear_m_s(self) -> f64 {
        match self {
            Self::Fine => 0.005,
            Self::Normal => 0.020,
            Self::Fast => 0.060,
        }
    }

    /// Of the turn about z.
    pub fn yaw_rad_s(self) -> f64 {
        match self {
            Self::Fine => 3f64.to_radians(),
            Self::Normal => 10f64.to_radians(),
            Self::Fast => 30f64.to_radians(),
        }
    }
}

/// One button: its words, its axis, its place in the pad and its key.
struct Direction {
    word: &'static str,
    axis: &'static str,
    linear: [f64; 3],
    yaw: f64,
    column: f32,
    row: f32,
    key: Key,
    key_name: &'static str,
}

const fn direction(
    word: &'static str,
    axis: &'static str,
    linear: [f64; 3],
    yaw: f64,
    place: [f32; 2],
    key: (Key, &'static str),
) -> Direction {
    let [column, row] = place;
    Direction { word, axis, linear, yaw, column, row, key: key.0, key_name: key.1 }
}

impl Direction {
    /// Height and turn stand a little apart from the plane: beside it, or below it where that is too wide.
    fn rect(&self, pad: Pos2, wide: bool) -> Rect {
        let size = if wide { CELL } else { NARROW_CELL };
        let cell = |column: f32, row: f32| vec2(column * (size.x + GAP), row * (size.y + GAP));
        let at = match (self.column >= 3.0, wide) {
            (false, _) => cell(self.column, self.row),
            (true, true) => cell(self.column, self.row) + vec2((self.column - 2.0) * space::S, 0.0),
            (true, false) => cell(self.column - 3.0, self.row + 2.5) + vec2(0.0, space::S),
        };
        Rect::from_min_size(pad + at, size)
    }
}

/// As seen from above the robot, looking where it looks; the same as on the table map.
const DIRECTIONS: [Direction; 8] = [
    direction("Forward", "+x", [1.0, 0.0, 0.0], 0.0, [1.0, 0.0], (Key::ArrowUp, "arrow up")),
    direction("Back", "−x", [-1.0, 0.0, 0.0], 0.0, [1.0, 2.0], (Key::ArrowDown, "arrow down")),
    direction("Left", "+y", [0.0, 1.0, 0.0], 0.0, [0.0, 1.0], (Key::ArrowLeft, "arrow left")),
    direction("Right", "−y", [0.0, -1.0, 0.0], 0.0, [2.0, 1.0], (Key::ArrowRight, "arrow right")),
    direction("Up", "+z", [0.0, 0.0, 1.0], 0.0, [3.0, 0.5], (Key::PageUp, "page up")),
    direction("Down", "−z", [0.0, 0.0, -1.0], 0.0, [3.0, 1.5], (Key::PageDown, "page down")),
    direction("Turn left", "+yaw", [0.0; 3], 1.0, [4.0, 0.5], (Key::Q, "Q")),
    direction("Turn right", "−yaw", [0.0; 3], -1.0, [4.0, 1.5], (Key::E, "E")),
];

/// Buttons for the directions, the speed, and the one that must be held.
pub struct JogPad<'a> {
    what: &'a str,
    why_not: Option<&'a str>,
    enabled_elsewhere: bool,
    refused: Option<&'a str>,
}

/// What is asked for right now.
#[derive(Clone, Debug)]
pub struct JogPadResponse {
    /// The pad.
    pub response: Response,
    /// `None` unless an enable key and a direction are held.
    pub intent: Option<JogIntent>,
    /// Whether an enable key is held.
    pub enabled: bool,
}

impl<'a> JogPad<'a> {
    /// A pad that moves `what`: "right hand".
    pub fn new(what: &'a str) -> Self {
        Self { what, why_not: None, enabled_elsewhere: false, refused: None }
    }

    /// Why nothing can be moved now, and what to do; the pad gives nothing then.
    pub fn why_not(mut self, why_not: Option<&'a str>) -> Self {
        self.why_not = why_not;
        self
    }

    /// Whether an enable key that the pad does not see is held: the one of a gamepad.
    pub fn enabled_elsewhere(mut self, held: bool) -> Self {
        self.enabled_elsewhere = held;
        self
    }

    /// What is asked for was refused; in a few words, where it stands why.
    pub fn refused(mut self, where_why: Option<&'a str>) -> Self {
        self.refused = where_why;
        self
    }

    /// Draws it. The directions are found by their words, the enable button as "Hold to move", or as why
    /// nothing can be moved.
    pub fn show(self, ui: &mut Ui, speed: &mut JogSpeed) -> JogPadResponse {
        let start = ui.cursor().min;
        let wide = ui.available_width() >= PAD_WIDTH;
        let speed_mm_s = format::fixed(speed.linear_m_s() * 1e3, 0);
        ui.label(theme::strong(ui, format!("Moves the {}, {speed_mm_s} mm/s", self.what)));
        ui.add_space(space::XS);
        speeds(ui, speed, wide);
        ui.add_space(space::XS);
        let (width, rows, cell, enable_height) = match wide {
            true => (PAD_WIDTH, 3.0, CELL, ENABLE_HEIGHT),
            false => (NARROW_WIDTH, 5.0, NARROW_CELL, NARROW_ENABLE_HEIGHT),
        };
        // A long reason has all of its lines.
        let enable_height = self
            .why_galley(ui, width)
            .map_or(enable_height, |galley| enable_height.max(galley.size().y + 2.0 * space::S));
        let height = rows * cell.y + (rows - 1.0) * GAP + 2.0 * space::S + enable_height;
        let (rect, response) = ui.allocate_exact_size(vec2(width, height), Sense::hover());
        let label = format!("Jog the {}", self.what);
        response.widget_info(|| WidgetInfo::labeled(egui::Role::Group, ui.is_enabled(), &label));
        let whole = Rect::from_min_max(start.min(rect.min), rect.max);

        let base = response.id;
        let usable = self.why_not.is_none() && ui.is_enabled();
        let held = |response: &Response| response.is_pointer_button_down_on();
        let buttons = DIRECTIONS
            .each_ref()
            .map(|direction| interact(ui, direction.rect(rect.min, wide), base, direction, usable));
        let enable_rect = Rect::from_min_max(pos2(rect.left(), rect.bottom() - enable_height), rect.max);
        let enable = ui.interact(enable_rect, base.with("enable"), sense(usable));
        let enable_label = self.why_not.unwrap_or("Hold to move");
        enable.widget_info(|| WidgetInfo::labeled(egui::Role::Button, usable, enable_label));

        let focused = buttons.iter().chain([&enable]).any(Response::has_focus);
        let active = focused || ui.rect_contains_pointer(whole);
        let (shift, window) = ui.input(|input| (input.modifiers.shift, input.focused));
        let by_shift = shift && active && !ui.ctx().text_edit_focused();
        let enabled = usable && window && (held(&enable) || by_shift || self.enabled_elsewhere);
        let keys = active || held(&enable);
        let pressed = DIRECTIONS.each_ref().map(|direction| {
            let by_key = keys && !ui.ctx().text_edit_focused() && ui.input(|i| i.key_down(direction.key));
            usable && by_key
        });
        let mut wanted = [false; DIRECTIONS.len()];
        for (i, want) in wanted.iter_mut().enumerate() {
            let enter = buttons[i].has_focus() && ui.input(|input| input.key_down(Key::Enter));
            *want = pressed[i] || (usable && (held(&buttons[i]) || enter));
        }
        let intent = if enabled { intent(&wanted, *speed) } else { None };
        for ((direction, button), want) in DIRECTIONS.iter().zip(buttons).zip(wanted) {
            keep_arrows(ui, &button);
            paint_direction(ui, direction, &button, want, enabled && want, usable);
            button.on_hover_text(format!("{}: {}, while Shift is held", direction.word, direction.key_name));
        }
        keep_arrows(ui, &enable);
        self.paint_enable(ui, &enable, enabled, wanted.contains(&true), intent.as_ref());
        if enabled || wanted.contains(&true) {
            // What is released must be seen at once, also when nothing else happens.
            ui.ctx().request_repaint();
        }
        // Below: in a small window the pad itself has to be in sight.
        ui.add_space(space::XS);
        ui.label(theme::small(ui, "In the robot's frame: forward is away from the robot, left is its left."));
        JogPadResponse { response, intent, enabled }
    }

    /// Why nothing can be moved, as wide as the pad has room for it.
    fn why_galley(&self, ui: &Ui, width: f32) -> Option<Arc<egui::Galley>> {
        let small = theme::font(ui, &TextStyle::Small);
        let wrap = width - 52.0;
        let lay = |why: &str| ui.painter().layout(why.to_owned(), small, theme::tokens(ui).text, wrap);
        self.why_not.map(lay)
    }

    fn paint_enable(
        &self,
        ui: &Ui,
        response: &Response,
        enabled: bool,
        wants: bool,
        intent: Option<&JogIntent>,
    ) {
        let tokens = theme::tokens(ui);
        let painter = ui.painter();
        let rect = response.rect;
        let (fill, ink) =
            if enabled { (tokens.accent, tokens.on_accent) } else { (tokens.raised, tokens.text) };
        painter.rect_filled(rect, 6.0, fill);
        if response.hovered() || response.has_focus() {
            painter.rect_stroke(rect, 6.0, Stroke::new(1.5, tokens.accent), StrokeKind::Inside);
        }
        let small = theme::font(ui, &TextStyle::Small);
        if let Some(galley) = self.why_galley(ui, rect.width()) {
            glyph::paint(
                painter,
                pos2(rect.left() + 20.0, rect.center().y),
                12.0,
                Glyph::Warning,
                tokens.warning,
            );
            let at = pos2(rect.left() + 36.0, rect.center().y - galley.size().y / 2.0);
            painter.galley(at, galley, tokens.text);
            return;
        }
        let (title, hint) = match (enabled, intent) {
            (true, Some(intent)) => match self.refused {
                Some(where_why) => ("Does not move".to_owned(), where_why.to_owned()),
                None => ("Moving".to_owned(), describe(intent)),
            },
            (true, None) => ("Enabled".to_owned(), "press a direction".to_owned()),
            // Which key is which direction stands at each button, where it is pointed at.
            (false, _) if wants => {
                ("Hold Shift, too".to_owned(), "a direction alone moves nothing".to_owned())
            }
            (false, _) => ("Hold to move".to_owned(), "or hold Shift over this pad".to_owned()),
        };
        let strong = theme::strong_font(ui);
        painter.text(rect.center() - vec2(0.0, 8.0), Align2::CENTER_CENTER, title, strong, ink);
        let hint_ink = if enabled { tokens.on_accent } else { tokens.text_weak };
        painter.text(rect.center() + vec2(0.0, 10.0), Align2::CENTER_CENTER, hint, small, hint_ink);
    }
}

fn speeds(ui: &mut Ui, speed: &mut JogSpeed, wide: bool) {
    let words = match wide {
        true => ["Fine 5 mm/s", "Normal 20 mm/s", "Fast 60 mm/s"],
        // How fast the chosen one is stands above.
        false => ["Fine", "Normal", "Fast"],
    };
    let speeds = [JogSpeed::Fine, JogSpeed::Normal, JogSpeed::Fast];
    let options: Vec<(JogSpeed, &str)> = speeds.into_iter().zip(words).collect();
    choice(ui, "Jog speed", speed, &options);
}

/// A press of what senses clicks alone is over once it is too long for a click, or has moved: these are held.
fn sense(usable: bool) -> Sense {
    if usable { Sense::click_and_drag() } else { Sense::hover() }
}

fn interact(ui: &Ui, rect: Rect, base: Id, direction: &Direction, usable: bool) -> Response {
    let response = ui.interact(rect, base.with(direction.word), sense(usable));
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Button, usable, direction.word));
    response
}

/// Arrow keys jog; they do not wander through the buttons.
fn keep_arrows(ui: &Ui, response: &Response) {
    if response.has_focus() {
        let arrows = EventFilter { horizontal_arrows: true, vertical_arrows: true, ..EventFilter::default() };
        ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, arrows));
    }
}

/// Opposite directions cancel; a diagonal is not faster than a side.
fn intent(wanted: &[bool; DIRECTIONS.len()], speed: JogSpeed) -> Option<JogIntent> {
    let mut linear = Vector3::zeros();
    let mut yaw = 0.0;
    for (direction, _) in DIRECTIONS.iter().zip(wanted).filter(|(_, wanted)| **wanted) {
        linear += Vector3::from(direction.linear);
        yaw += direction.yaw;
    }
    let unit = linear.try_normalize(0.5).unwrap_or_else(Vector3::zeros);
    let intent =
        JogIntent { velocity_m_s: unit * speed.linear_m_s(), yaw_rate_rad_s: yaw * speed.yaw_rad_s() };
    (unit != Vector3::zeros() || yaw != 0.0).then_some(intent)
}

/// "forward, up at 20.0 mm/s".
fn describe(intent: &JogIntent) -> String {
    let along = |direction: &&Direction| {
        let linear = Vector3::from(direction.linear).dot(&intent.velocity_m_s) > 0.0;
        linear || direction.yaw * intent.yaw_rate_rad_s > 0.0
    };
    let words: Vec<String> = DIRECTIONS.iter().filter(along).map(|d| d.word.to_lowercase()).collect();
    let mut speeds = Vec::new();
    if intent.velocity_m_s != Vector3::zeros() {
        speeds.push(format!("{}/s", format::mm(intent.velocity_m_s.norm())));
    }
    if intent.yaw_rate_rad_s != 0.0 {
        speeds.push(format!("{}/s", format::degrees(intent.yaw_rate_rad_s.abs())));
    }
    format!("{} at {}", words.join(", "), speeds.join(", "))
}

fn paint_direction(
    ui: &Ui,
    direction: &Direction,
    response: &Response,
    pressed: bool,
    moving: bool,
    usable: bool,
) {
    let tokens = theme::tokens(ui);
    let painter = ui.painter();
    let rect = response.rect;
    let fill = match (moving, pressed || response.hovered()) {
        (true, _) => tokens.accent,
        (false, true) => tokens.raised_hover,
        (false, false) => tokens.raised,
    };
    painter.rect_filled(rect, 4.0, if usable { fill } else { tokens.raised.gamma_multiply(0.5) });
    if response.has_focus() || (pressed && !moving) {
        painter.rect_stroke(rect, 4.0, Stroke::new(1.5, tokens.accent), StrokeKind::Inside);
    }
    let (word, axis) = match (moving, usable) {
        (true, _) => (tokens.on_accent, tokens.on_accent),
        (false, true) => (tokens.text, tokens.text_weak),
        (false, false) => (tokens.text_weak, tokens.text_weak),
    };
    let body = theme::font(ui, &TextStyle::Body);
    let small = theme::font(ui, &TextStyle::Small);
    painter.text(rect.center() - vec2(0.0, 7.0), Align2::CENTER_CENTER, direction.word, body, word);
    painter.text(rect.center() + vec2(0.0, 9.0), Align2::CENTER_CENTER, direction.axis, small, axis);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with(words: &[&str]) -> Option<JogIntent> {
        intent(&DIRECTIONS.each_ref().map(|direction| words.contains(&direction.word)), JogSpeed::Normal)
    }

    #[test]
    fn words_are_the_robots_axes() {
        let velocity = |word| with(&[word]).expect("a motion").velocity_m_s;
        assert_eq!(velocity("Forward"), Vector3::new(0.02, 0.0, 0.0));
        assert_eq!(velocity("Left"), Vector3::new(0.0, 0.02, 0.0));
        assert_eq!(velocity("Down"), Vector3::new(0.0, 0.0, -0.02));
        assert!(with(&["Turn left"]).expect("a turn").yaw_rate_rad_s > 0.0);
    }

    #[test]
    fn a_diagonal_is_not_faster_and_opposites_cancel() {
        let diagonal = with(&["Forward", "Left", "Up"]).expect("a motion").velocity_m_s;
        assert!((diagonal.norm() - 0.02).abs() < 1e-12);
        assert_eq!(with(&["Forward", "Back"]), None);
        assert_eq!(with(&["Turn left", "Turn right"]), None);
        assert_eq!(with(&[]), None);
        let turn = with(&["Forward", "Back", "Turn right"]).expect("the turn stays");
        assert_eq!(turn.velocity_m_s, Vector3::zeros());
    }

    #[test]
    fn a_motion_is_described_in_words() {
        let text = describe(&with(&["Forward", "Up", "Turn left"]).expect("a motion"));
        assert_eq!(text, "forward, up, turn left at 20.0 mm/s, 10.0°/s");
    }
}
