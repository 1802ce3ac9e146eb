//! What is drawn of a model over the table.

use plumbline_engine::view::{Field, ModelMap};
use plumbline_widgets::axis;
use plumbline_widgets::colormap::{ColorScale, Colormap};
use plumbline_widgets::format::{self, Quantity};
use plumbline_widgets::table_map::{BeforeAfter, Border, Outline, Place, ScalarField, TableScene};

use crate::panels::arrows::{Errors, arrow_scale};

/// Which field is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shown {
    /// Standard deviation of the correction.
    Uncertainty,
    /// Length of the correction.
    Correction,
}

/// What is drawn of a map, made once per map.
#[derive(Debug)]
pub struct Drawn {
    pub(crate) of: std::sync::Arc<ModelMap>,
    pub(crate) sd: Option<(ScalarField, ColorScale)>,
    pub(crate) shift: Option<(ScalarField, ColorScale)>,
    pub(crate) border: Border,
    /// Mean lengths before and after, m.
    pub(crate) means_m: Option<[f64; 2]>,
    pub(crate) headline: String,
}

impl Drawn {
    pub fn of(map: &std::sync::Arc<ModelMap>) -> Self {
        let border = Border { name: "the data end here".to_owned(), rings_m: map.border_m.clone() };
        let sd = scalar("Uncertainty", &map.sd);
        let shift = scalar("Correction", &map.shift);
        // Far outside the deviation grows without end: the colors tell apart what may be trusted.
        let inside = largest_inside(&map.sd, &border);
        let sd_end = inside.map(|m| 3.0 * m).or(sd.as_ref().and_then(|sd| Some(sd.extent()?[1])));
        let shift_end = shift.as_ref().and_then(|shift| Some(shift.extent()?[1]));
        let colors = |field: Option<ScalarField>, end_m: Option<f64>| {
            let end_m = axis::round_up(end_m? * 1e3) * 1e-3;
            Some((field?, ColorScale::new(Colormap::Viridis, [0.0, end_m as f32])))
        };
        Self {
            sd: colors(sd, sd_end),
            shift: colors(shift, shift_end),
            means_m: means_m(map),
            headline: headline(map, &border),
            border,
            of: map.clone(),
        }
    }

    pub fn scene(&self, errors: Errors) -> TableScene {
        let map = &self.of;
        let range = |range: [f64; 2], axis: usize| {
            if range[1] > range[0] { range } else { around(&map.screen_m, axis) }
        };
        let plane = |error: [f64; 3]| [error[0], error[1]];
        TableScene {
            x_m: range(map.sd.x_m, 0),
            y_m: range(map.sd.y_m, 1),
            outlines: vec![Outline {
                place: Place::Touchscreen,
                name: "touchscreen".to_owned(),
                corners_m: map.screen_m.clone(),
            }],
            before_after: map
                .touches
                .iter()
                .map(|touch| BeforeAfter {
                    at_m: touch.at_m,
                    before_m: (errors != Errors::After).then_some(plane(touch.before_m)),
                    after_m: (errors != Errors::Before).then_some(plane(touch.after_m)),
                })
                .collect(),
            vector_scale: self.scale(errors),
            border: Some(self.border.clone()),
            ..TableScene::new()
        }
    }

    /// Magnification of the arrows, by the longer ones of those that are shown.
    pub fn scale(&self, errors: Errors) -> f64 {
        match errors {
            Errors::After => arrow_scale(self.of.touches.iter().map(|touch| length(touch.after_m))),
            Errors::Before | Errors::Both => {
                arrow_scale(self.of.touches.iter().map(|touch| length(touch.before_m)))
            }
        }
    }

    /// "corrected by 21.3 mm ± 1.92 mm, inside the data".
    pub fn words(&self, at_m: [f64; 2]) -> String {
        let of = |field: &Option<(ScalarField, ColorScale)>| field.as_ref().and_then(|(f, _)| f.at(at_m));
        let shift = match of(&self.shift) {
            Some(shift) => format!("corrected by {}", format::mm(shift)),
            None => "correction not known".to_owned(),
        };
        let sd = of(&self.sd).map_or_else(String::new, |sd| format!(", sd {}", format::mm(sd)));
        let inside = if self.border.contains(at_m) { "inside the data" } else { "outside the data" };
        format!("{shift}{sd}, {inside}")
    }
}

pub fn scalar(name: &str, field: &Field) -> Option<ScalarField> {
    let found =
        ScalarField::of_grid(name, Quantity::Length, field.x_m, field.y_m, field.columns, &field.values_m)?;
    found.extent().is_some().then_some(found)
}

pub fn around(corners_m: &[[f64; 2]], axis: usize) -> [f64; 2] {
    let values = corners_m.iter().map(|corner| corner[axis]);
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
    if low < high { [low - 0.08, high + 0.08] } else { [-0.5, 0.7] }
}

pub fn largest_inside(field: &Field, border: &Border) -> Option<f64> {
    let rows = field.values_m.len().checked_div(field.columns)?;
    let at = |range: [f64; 2], i: usize, n: usize| {
        range[0] + (range[1] - range[0]) * i as f64 / (n.max(2) - 1) as f64
    };
    let nodes = field.values_m.iter().enumerate().filter_map(|(i, value)| {
        let place = [at(field.x_m, i / field.columns, rows), at(field.y_m, i % field.columns, field.columns)];
        value.filter(|value| value.is_finite() && border.contains(place))
    });
    nodes.reduce(f64::max)
}

pub fn length(error_m: [f64; 3]) -> f64 {
    error_m[0].hypot(error_m[1])
}

pub fn means_m(map: &ModelMap) -> Option<[f64; 2]> {
    let after_m: f64 = map.touches.iter().map(|touch| length(touch.after_m)).sum();
    let without_m = map.without_m.filter(|_| !map.touches.is_empty())?;
    Some([without_m, after_m / map.touches.len() as f64])
}

/// "Inside the border targets shift 21 mm on average, outside 54 mm: do not trust it there."
pub fn headline(map: &ModelMap, border: &Border) -> String {
    if !border.is_known() {
        return "Nobody knows where its data end, because it came without its touches: trust it nowhere unchecked."
            .to_owned();
    }
    match map.mean_shift_m {
        (Some(inside), Some(outside)) => format!(
            "Inside the border targets shift {} on average, outside {}: do not trust it there.",
            format::mm(inside),
            format::mm(outside)
        ),
        (Some(inside), None) => {
            format!("Inside the border targets shift {} on average.", format::mm(inside))
        }
        _ => "No place of the table lies inside its border: do not trust it.".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use plumbline_engine::view::MapTouch;

    use super::*;
    use crate::operator::snapshot::models::Method;

    fn map() -> ModelMap {
        let touch = |x: f64, before: f64, after: f64| MapTouch {
            at_m: [x, 0.0],
            before_m: [before, 0.0, 0.3],
            after_m: [0.0, after, 0.3],
        };
        let field = Field {
            x_m: [0.2, 0.6],
            y_m: [-0.4, 0.4],
            columns: 3,
            values_m: vec![Some(0.02), Some(0.02), Some(0.02), Some(0.02), Some(0.001), Some(0.02)],
        };
        ModelMap {
            method: Some(Method::M3),
            proposed: true,
            touches: vec![touch(0.3, 0.02, 0.004), touch(0.4, 0.022, 0.002)],
            without_m: Some(0.021),
            border_m: vec![vec![[0.5, -0.1], [0.7, -0.1], [0.7, 0.1], [0.5, 0.1]]],
            screen_m: vec![[0.25, -0.2], [0.45, -0.2], [0.45, 0.2], [0.25, 0.2]],
            sd: field.clone(),
            shift: field,
            mean_shift_m: (Some(0.0214), Some(0.0545)),
        }
    }

    #[test]
    fn the_headline_warns_of_what_lies_outside() {
        assert_eq!(
            Drawn::of(&Arc::new(map())).headline,
            "Inside the border targets shift 21.4 mm on average, outside 54.5 mm: do not trust it there."
        );
        let unknown = ModelMap { border_m: vec![], ..map() };
        assert!(Drawn::of(&Arc::new(unknown)).headline.contains("trust it nowhere"));
    }

    #[test]
    fn colors_tell_apart_what_is_inside() {
        let drawn = Drawn::of(&Arc::new(map()));
        let (_, scale) = drawn.sd.as_ref().expect("a field");
        assert!((scale.range[1] - 0.003).abs() < 1e-6, "{:?}", scale.range);
    }

    #[test]
    fn the_words_say_whether_a_place_is_inside() {
        let drawn = Drawn::of(&Arc::new(map()));
        assert_eq!(drawn.words([0.6, 0.0]), "corrected by 1.00 mm, sd 1.00 mm, inside the data");
        assert!(drawn.words([0.25, 0.0]).ends_with("outside the data"));
        assert!(drawn.words([0.0, 0.0]).starts_with("correction not known"));
    }

    #[test]
    fn a_hole_among_the_data_is_outside_and_all_lines_are_drawn() {
        let mut map = map();
        map.border_m.push(vec![[0.58, -0.02], [0.62, -0.02], [0.62, 0.02], [0.58, 0.02]]);
        let drawn = Drawn::of(&Arc::new(map));
        assert!(drawn.words([0.6, 0.0]).ends_with("outside the data"));
        assert!(drawn.words([0.55, 0.0]).ends_with("inside the data"));
        assert_eq!(drawn.scene(Errors::Both).border.map(|border| border.rings_m.len()), Some(2));
    }

    #[test]
    fn arrows_before_and_after_have_one_round_scale_and_leave_the_height_out() {
        let drawn = Drawn::of(&Arc::new(map()));
        assert_eq!(drawn.scale(Errors::Both), 1.0);
        assert_eq!(drawn.scale(Errors::After), 2.0);
        let [before, after] = drawn.means_m.expect("touches");
        assert!((before - 0.021).abs() < 1e-12 && (after - 0.003).abs() < 1e-12);
        assert_eq!(arrow_scale([0.003, 0.003, 0.5].into_iter()), 5.0);
        assert_eq!(arrow_scale([0.0].into_iter()), 1.0);
        assert_eq!(arrow_scale([].into_iter()), 1.0);
        let before = drawn.scene(Errors::Before).before_after;
        assert!(before.iter().all(|error| error.before_m.is_some() && error.after_m.is_none()));
    }
}
