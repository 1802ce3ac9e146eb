//! The border of what is known: a line, and everything outside of it hatched.

use egui::{Pos2, Rect, Stroke, pos2};

use super::paint::Map;
use crate::theme;

/// Distance of the hatching's lines, points.
const SPACING: f32 = 7.0;
/// Their width: what is left between them shows the field, darker than inside.
const WIDTH: f32 = 3.5;

/// A closed line on the table beyond which nothing was measured. What lies outside is hatched.
#[derive(Clone, Debug, PartialEq)]
pub struct Border {
    /// Its name on the map; empty for none.
    pub name: String,
    /// Corners (x forward, y left) in order, meters. Fewer than three: everything is outside.
    pub corners_m: Vec<[f64; 2]>,
}

impl Border {
    /// Whether a place on the table lies inside.
    pub fn contains(&self, at_m: [f64; 2]) -> bool {
        let corners = &self.corners_m;
        let mut inside = false;
        for (i, a) in corners.iter().enumerate() {
            let b = corners[(i + 1) % corners.len()];
            if (a[1] > at_m[1]) != (b[1] > at_m[1]) {
                let x = a[0] + (b[0] - a[0]) * (at_m[1] - a[1]) / (b[1] - a[1]);
                inside ^= at_m[0] < x;
            }
        }
        inside
    }
}

impl Map {
    /// Hatches what lies outside.
    pub(super) fn hatch(&self, rect: Rect, border: &Border) {
        let corners = self.corners(border);
        let stroke = Stroke::new(WIDTH, self.tokens.backdrop.gamma_multiply(0.8));
        for line in diagonals(rect) {
            for [from, to] in outside(line, &corners) {
                self.painter.line_segment([from, to], stroke);
            }
        }
    }

    /// Draws the line with its name; returns where the name stands.
    pub(super) fn border(&self, border: &Border) -> Option<Rect> {
        let mut points = self.corners(border);
        let first = points.first().copied()?;
        points.push(first);
        // Bright on dark: seen on every color of a field.
        self.painter.line(points.clone(), Stroke::new(4.5, theme::RIM));
        self.painter.line(points.clone(), Stroke::new(2.0, theme::ON_IMAGE.text_strong));
        if border.name.is_empty() {
            return None;
        }
        let lowest = points.into_iter().reduce(|a, b| if b.y > a.y { b } else { a })?;
        let inside = self.painter.clip_rect();
        let width = self.width_of(&border.name);
        let x = (lowest.x - width / 2.0).clamp(inside.left() + 4.0, (inside.right() - width - 4.0).max(4.0));
        Some(self.chip(pos2(x, (lowest.y + 5.0).min(inside.bottom() - 40.0)), &border.name))
    }

    fn corners(&self, border: &Border) -> Vec<Pos2> {
        border.corners_m.iter().map(|corner| self.transform.to_screen(*corner)).collect()
    }
}

/// Lines at 45° across a rectangle.
fn diagonals(rect: Rect) -> impl Iterator<Item = [Pos2; 2]> {
    let count = ((rect.width() + rect.height()) / SPACING).max(0.0) as usize;
    (0..=count).map(move |i| {
        let along = i as f32 * SPACING;
        let from = if along <= rect.height() {
            pos2(rect.left(), rect.top() + along)
        } else {
            pos2(rect.left() + along - rect.height(), rect.bottom())
        };
        let to = if along <= rect.width() {
            pos2(rect.left() + along, rect.top())
        } else {
            pos2(rect.right(), rect.top() + along - rect.width())
        };
        [from, to]
    })
}

/// The parts of a line that lie outside of a closed polygon.
fn outside([from, to]: [Pos2; 2], corners: &[Pos2]) -> Vec<[Pos2; 2]> {
    let along = to - from;
    let mut crossings: Vec<f32> = Vec::new();
    for (i, a) in corners.iter().enumerate() {
        let b = corners[(i + 1) % corners.len()];
        let edge = b - *a;
        let area = along.x * edge.y - along.y * edge.x;
        if area.abs() < 1e-6 {
            continue; // parallel
        }
        let offset = *a - from;
        let on_line = (offset.x * edge.y - offset.y * edge.x) / area;
        let on_edge = (offset.x * along.y - offset.y * along.x) / area;
        // Half open, so that a corner counts once.
        if (0.0..1.0).contains(&on_edge) && (0.0..=1.0).contains(&on_line) {
            crossings.push(on_line);
        }
    }
    crossings.sort_by(f32::total_cmp);
    // The line starts at the edge of the map, which may itself be inside.
    let mut is_outside = !contains(corners, from);
    let mut parts = Vec::new();
    let mut last = 0.0;
    for crossing in crossings.into_iter().chain([1.0]) {
        if is_outside && crossing > last {
            parts.push([from + along * last, from + along * crossing]);
        }
        is_outside = !is_outside;
        last = crossing;
    }
    parts
}

fn contains(corners: &[Pos2], at: Pos2) -> bool {
    let as_table = |p: Pos2| [f64::from(p.x), f64::from(p.y)];
    let corners_m = corners.iter().copied().map(as_table).collect();
    Border { name: String::new(), corners_m }.contains(as_table(at))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> Vec<Pos2> {
        vec![pos2(2.0, 2.0), pos2(6.0, 2.0), pos2(6.0, 6.0), pos2(2.0, 6.0)]
    }

    fn length(parts: &[[Pos2; 2]]) -> f32 {
        parts.iter().map(|[a, b]| a.distance(*b)).sum()
    }

    #[test]
    fn a_line_through_the_border_is_cut_where_it_is_inside() {
        let parts = outside([pos2(0.0, 4.0), pos2(10.0, 4.0)], &square());
        assert_eq!(parts.len(), 2);
        assert!((length(&parts) - 6.0).abs() < 1e-4);
    }

    #[test]
    fn a_line_that_starts_inside_and_one_that_never_meets_it() {
        let parts = outside([pos2(4.0, 4.0), pos2(10.0, 4.0)], &square());
        assert!((length(&parts) - 4.0).abs() < 1e-4, "{parts:?}");
        assert!((length(&outside([pos2(0.0, 8.0), pos2(10.0, 8.0)], &square())) - 10.0).abs() < 1e-4);
    }

    #[test]
    fn a_notch_is_outside() {
        let mut notched = square();
        notched.insert(1, pos2(4.0, 5.0));
        let parts = outside([pos2(0.0, 3.0), pos2(10.0, 3.0)], &notched);
        assert_eq!(parts.len(), 3, "{parts:?}");
    }

    #[test]
    fn without_a_border_everything_is_outside() {
        assert!((length(&outside([pos2(0.0, 0.0), pos2(3.0, 4.0)], &[])) - 5.0).abs() < 1e-5);
        assert!(!Border { name: String::new(), corners_m: vec![] }.contains([0.0, 0.0]));
    }

    #[test]
    fn diagonals_stay_on_the_map_and_cover_it() {
        let rect = Rect::from_min_max(pos2(10.0, 20.0), pos2(110.0, 60.0));
        let lines: Vec<_> = diagonals(rect).collect();
        assert!(lines.iter().flatten().all(|end| rect.expand(0.1).contains(*end)));
        let middle = |lines: &[[Pos2; 2]]| {
            lines.iter().any(|[a, b]| {
                let cross = (b.x - a.x) * (40.0 - a.y) - (b.y - a.y) * (60.0 - a.x);
                a.distance(*b) > 1.0 && cross.abs() / a.distance(*b) < SPACING
            })
        };
        assert!(middle(&lines));
    }
}
