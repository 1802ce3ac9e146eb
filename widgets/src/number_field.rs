//! A number that is dragged or typed. What is typed outside of its range, or is no number, is refused in words beside
//! the field and changes nothing: a number that was never typed must not come to stand there.

use std::cell::RefCell;
use std::ops::RangeInclusive;

use egui::emath::Numeric;
use egui::{DragValue, Id, Response, RichText, Tooltip, Ui, WidgetInfo};

use crate::theme::{self, Role};

/// How long a refusal stays in sight, unless the field is taken up again before.
const REFUSAL_STAYS_S: f64 = 8.0;

/// What a field is called, and what it takes.
#[derive(Clone, Debug)]
pub struct NumberField<'a, Num> {
    /// Found by it, and read out.
    pub name: &'a str,
    /// In the unit on the screen, like the number itself.
    pub range: RangeInclusive<Num>,
    /// Behind the number: " mm".
    pub suffix: &'a str,
    /// By how much the number grows with each point that it is dragged.
    pub speed: f64,
    /// More are not shown.
    pub decimals: usize,
}

/// Within so long after a refusal another field that was clicked does not take it away, s.
const REFUSAL_IS_NEW_S: f64 = 0.5;

/// The newest one: of which field, when, and why.
#[derive(Clone)]
struct Refusal {
    of: Id,
    at_s: f64,
    why: String,
}

impl<Num: Numeric> NumberField<'_, Num> {
    /// A typed number is taken when the operator is done with it (Enter, Tab, a click elsewhere).
    pub fn show(self, ui: &mut Ui, value: &mut Num) -> Response {
        let before = *value;
        let (low, high) = (self.range.start().to_f64(), self.range.end().to_f64());
        let why_not: RefCell<Option<String>> = RefCell::new(None);
        let parser = |text: &str| {
            let read = self.read(text);
            *why_not.borrow_mut() = read.clone().err();
            read.ok()
        };
        let drag = DragValue::new(value)
            .range(low..=high)
            .clamp_existing_to_range(false)
            .speed(self.speed)
            .max_decimals(self.decimals)
            .suffix(self.suffix)
            .update_while_editing(false)
            .custom_parser(parser);
        let response = ui.add(drag);
        if *value != before && !(low..=high).contains(&value.to_f64()) {
            // By a key or by a screen reader, which no range holds back.
            *value = before;
        }
        response.widget_info(|| {
            let mut info = WidgetInfo::labeled(egui::Role::SpinButton, ui.is_enabled(), self.name);
            info.value = Some(value.to_f64());
            info
        });
        told(ui, &response, why_not.into_inner());
        response
    }

    /// With a comma too, with the minus sign that the formats write, with or without its unit.
    ///
    /// # Errors
    /// What was typed is no number, or out of the range.
    fn read(&self, typed: &str) -> Result<f64, String> {
        let typed = typed.trim();
        let bare = typed.strip_suffix(self.suffix.trim()).unwrap_or(typed).trim();
        let number: f64 = bare
            .replace('−', "-")
            .replace(',', ".")
            .parse()
            .ok()
            .filter(|number: &f64| number.is_finite())
            .ok_or_else(|| format!("“{typed}” is not a number: nothing was changed."))?;
        let (low, high) = (self.range.start().to_f64(), self.range.end().to_f64());
        if (low..=high).contains(&number) {
            return Ok(number);
        }
        let unit = self.suffix;
        Err(format!("{bare} is not between {low} and {high}{unit}: nothing was changed."))
    }
}

/// Shows why the newest number was not taken, below its field, until a field is taken up again.
fn told(ui: &Ui, response: &Response, why_not: Option<String>) {
    let slot = Id::unique("refused number");
    let now_s = ui.input(|input| input.time);
    if let Some(why) = why_not {
        ui.data_mut(|data| data.insert_temp(slot, Refusal { of: response.id, at_s: now_s, why }));
    }
    let Some(refusal) = ui.data(|data| data.get_temp::<Refusal>(slot)) else { return };
    let age_s = now_s - refusal.at_s;
    let is_taken_up = response.gained_focus() || response.dragged() || response.changed();
    let is_new = age_s < REFUSAL_IS_NEW_S && refusal.of != response.id || age_s == 0.0;
    if age_s > REFUSAL_STAYS_S || is_taken_up && !is_new {
        ui.data_mut(|data| data.remove::<Refusal>(slot));
        return;
    }
    if refusal.of != response.id {
        return;
    }
    ui.ctx().request_repaint_after_secs((REFUSAL_STAYS_S - age_s) as f32 + 0.1);
    Tooltip::for_widget(response).show(|ui| {
        ui.label(RichText::new(&refusal.why).color(Role::Warning.color(theme::tokens(ui))));
    });
}

#[cfg(test)]
mod tests {
    use super::NumberField;

    fn squares() -> NumberField<'static, u32> {
        NumberField { name: "Squares", range: 2..=41, suffix: "", speed: 0.1, decimals: 0 }
    }

    fn side() -> NumberField<'static, f64> {
        NumberField { name: "Side", range: 1.0..=1000.0, suffix: " mm", speed: 0.1, decimals: 3 }
    }

    #[test]
    fn what_people_type_is_read() {
        assert_eq!(squares().read(" 9 "), Ok(9.0));
        for typed in ["25,5", "25.5", "25.5 mm", "25.5mm"] {
            assert_eq!(side().read(typed), Ok(25.5), "{typed}");
        }
    }

    #[test]
    fn what_lies_outside_is_refused_and_never_moved_to_the_end_of_the_range() {
        for typed in ["9999999", "1", "-3", "−99999"] {
            let why = squares().read(typed).expect_err(typed);
            assert!(why.contains("between 2 and 41"), "{why}");
        }
        let why = side().read("−99999 mm").expect_err("a negative side");
        assert_eq!(why, "−99999 is not between 1 and 1000 mm: nothing was changed.");
        for typed in ["", "abc", "1e999", "NaN", "2 5"] {
            let why = side().read(typed).expect_err(typed);
            assert!(why.contains("is not a number"), "{why}");
        }
    }
}
