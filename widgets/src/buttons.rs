//! The buttons that matter: the one primary button of a step, and STOP.

use egui::{
    Align2, Button, FontId, Key, Modifiers, Response, RichText, Sense, Stroke, StrokeKind, TextStyle, Ui,
    Vec2, WidgetInfo, vec2,
};

use crate::theme::{self, size, space};

/// The primary button of a step, named by what it does: "Solve 30 pairs". One per screen.
/// Where it cannot be pressed now, `why_not` says why and is shown below it.
pub fn primary_button(ui: &mut Ui, text: &str, why_not: Option<&str>) -> Response {
    let tokens = theme::tokens(ui);
    let enabled = why_not.is_none() && ui.is_enabled();
    let (fill, ink) =
        if enabled { (tokens.accent, tokens.on_accent) } else { (tokens.raised, tokens.text_weak) };
    let label = RichText::new(text).text_style(theme::strong_style(ui)).color(ink);
    ui.vertical(|ui| {
        ui.spacing_mut().item_spacing.y = space::XS;
        ui.spacing_mut().button_padding = vec2(space::M, space::S);
        // Not faded while disabled: it must stay readable, because it says what comes next.
        ui.visuals_mut().disabled_alpha = 1.0;
        let (size, is_one_line) = primary_size(ui, text);
        let mut button = Button::new(label).fill(fill);
        if !is_one_line {
            button = button.wrap();
        }
        let response = ui.add_enabled_ui(enabled, |ui| ui.add_sized(size, button)).inner;
        if let Some(why_not) = why_not {
            ui.label(theme::small(ui, why_not));
        }
        if enabled && (response.hovered() || response.has_focus()) {
            let ring = Stroke::new(2.0, tokens.accent);
            ui.painter().rect_stroke(response.rect.expand(3.0), 6.0, ring, StrokeKind::Inside);
        }
        response
    })
    .inner
}

/// How large it is, and whether its words stand in one line; where the room is too narrow for that, they stand in as many
/// as they need.
fn primary_size(ui: &Ui, text: &str) -> (Vec2, bool) {
    let layout = |wrap_width: f32| {
        let font = theme::strong_font(ui);
        ui.painter().layout(text.to_owned(), font, ui.visuals().text_color(), wrap_width).size()
    };
    let margin = vec2(2.0 * space::M, 2.0 * space::S);
    let in_one_line = layout(f32::INFINITY) + margin;
    let room = ui.available_width();
    if in_one_line.x <= room {
        return (vec2(in_one_line.x.max(120.0), 36.0), true);
    }
    // A little less than there is: rounding must not need one line more than there is room for.
    let height = (layout((room - margin.x - 2.0).max(1.0)) + margin).y.max(36.0);
    (vec2(room, height), false)
}

/// A button that stands out among others, to be added where it is wanted.
pub fn accent_button<'a>(ui: &Ui, text: impl Into<String>) -> Button<'a> {
    let tokens = theme::tokens(ui);
    let text = RichText::new(text).text_style(theme::strong_style(ui)).color(tokens.on_accent);
    Button::new(text).fill(tokens.accent)
}

/// What the arm does right now.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ArmState {
    /// Torque on, standing.
    Held,
    /// In motion.
    Moving,
    /// The head turns; the arm is held.
    HeadMoving,
    /// Torque off: can be moved by hand, and falls.
    Free,
    /// Some joints have no torque, and give way; the others are held.
    PartlyFree,
    /// Stopped and held; nothing moves before the stop is released.
    Stopped,
    /// Connected, and no servo answers: whether it holds is not known.
    Unknown,
    /// Some servos do not answer: where their joints are, and whether they hold, is not known.
    PartlyKnown,
    /// No arm is connected.
    NotConnected,
}

impl ArmState {
    /// The state in words.
    pub fn text(self) -> &'static str {
        match self {
            Self::Held => "arm held",
            Self::Moving => "arm moving",
            Self::HeadMoving => "head moving",
            Self::Free => "arm free",
            Self::PartlyFree => "arm partly limp",
            Self::Stopped => "stopped",
            Self::Unknown => "arm not known",
            Self::PartlyKnown => "arm partly known",
            Self::NotConnected => "no arm connected",
        }
    }
}

/// Size of the stop button in points.
pub const STOP_SIZE: Vec2 = vec2(132.0, 44.0);

/// The stop button. Always enabled, even where its surroundings are disabled, and always the
/// same size; it says what the arm does. Pressed down is enough: it does not wait for the
/// release (see [`stop_pressed`]). Label for tests: `STOP`.
pub fn stop_button(ui: &mut Ui, arm: ArmState) -> Response {
    let (rect, _) = ui.allocate_exact_size(STOP_SIZE, Sense::hover());
    // A `Ui` of its own: one that was disabled cannot be enabled again, and this button has to
    // work and look the same whatever the rest of the window does.
    let id = ui.unique_id().with("stop");
    let builder = egui::UiBuilder::new()
        .layer_id(ui.layer_id())
        .max_rect(rect)
        .style(ui.style().clone())
        .accessibility_parent(ui.unique_id());
    let own = Ui::new(ui.ctx().clone(), id, builder);
    let mut response = own.interact(rect, id.with("button"), Sense::click());
    response.widget_info(|| {
        let mut info = WidgetInfo::labeled(egui::Role::Button, true, "STOP");
        info.current_text_value = Some(arm.text().to_owned());
        info
    });
    if response.is_pointer_button_down_on() && own.input(|input| input.pointer.primary_pressed()) {
        response.mark_changed();
    }
    paint_stop(&own, rect, &response, arm);
    response.on_hover_text("Stops the arm and holds it. Esc, space and B or Start of a gamepad do the same.")
}

fn paint_stop(ui: &Ui, rect: egui::Rect, response: &Response, arm: ArmState) {
    let tokens = theme::tokens(ui);
    let painter = ui.painter();
    let hot = response.hovered() || response.has_focus();
    painter.rect_filled(rect, 6.0, if hot { tokens.stop_hover } else { tokens.stop });
    if response.has_focus() {
        painter.rect_stroke(rect, 6.0, Stroke::new(2.0, tokens.on_stop), StrokeKind::Inside);
    }
    let heading = FontId::new(size::HEADING, theme::strong_font(ui).family);
    let small = theme::font(ui, &TextStyle::Small);
    let center = rect.center();
    painter.text(center - vec2(0.0, 7.0), Align2::CENTER_CENTER, "STOP", heading, tokens.on_stop);
    painter.text(center + vec2(0.0, 11.0), Align2::CENTER_CENTER, arm.text(), small, tokens.on_stop);
}

/// Whether the stop button was pressed: by pointer (on the way down), by keyboard or by a screen
/// reader.
pub fn stop_pressed(response: &Response) -> bool {
    response.clicked() || response.changed()
}

/// Whether Esc or space was pressed anywhere this frame. Space is left alone while a text is
/// being edited. The keys are taken away, so that space does not press a focused button too:
/// call this before anything else is drawn.
pub fn stop_keys(ctx: &egui::Context) -> bool {
    let typing = ctx.text_edit_focused();
    ctx.input_mut(|input| {
        let escape = input.count_and_consume_key(Modifiers::NONE, Key::Escape) > 0;
        let space = !typing && input.count_and_consume_key(Modifiers::NONE, Key::Space) > 0;
        if space {
            input.events.retain(|event| !matches!(event, egui::Event::Text(text) if text == " "));
        }
        escape || space
    })
}

/// A choice of a few, side by side, in more lines where one is too narrow. Returns whether it changed.
pub fn choice<T: PartialEq + Copy>(ui: &mut Ui, label: &str, chosen: &mut T, options: &[(T, &str)]) -> bool {
    let before = *chosen;
    let inner = ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = egui::vec2(2.0, 2.0);
        for (value, text) in options {
            ui.selectable_value(chosen, *value, *text);
        }
    });
    inner.response.widget_info(|| WidgetInfo::labeled(egui::Role::RadioGroup, true, label));
    *chosen != before
}
