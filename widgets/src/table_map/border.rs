//! The border of what is known: a line, and everything outside of it hatched.

use egui::{Pos2, Rect, Stroke, pos2};

use super::paint::{Map, NAMED_FROM};
use crate::theme;

/// Distance of the hatching's lines, points.
const SPACING: f32 = 7.0;
/// Their width: what is left between them shows the field, darker than inside.
const WIDTH: f32 = 3.5;

/// Closed lines on the table beyond which nothing was measured. What lies outside is hatched.
#[derive(Clone, Debug, PartialEq)]
pub struct Border {
    /// Its name on the map; empty for none.
    pub name: String,
    /// Lines around the parts and around the holes in them, each its corners (x forward, y left) in
    /// order, meters. A place inside an odd number of lines is inside; without a line of three
    /// corners everything is outside.
    pub rings_m: Vec<Vec<[f64; 2]>>,
}

impl Border {
    /// Whether a place on the table lies inside.
    pub fn contains(&self, at_m: [f64; 2]) -> bool {
        is_inside(self.rings_m.iter().map(Vec::as_slice), at_m)
    }

    /// Whether there is a line around anything.
    pub fn is_known(&self) -> bool {
        self.rings_m.iter().any(|ring| ring.len() > 2)
    }
}

/// Whether a place lies inside an odd number of closed lines.
fn is_inside<'a>(rings: impl Iterator<Item = &'a [[f64; 2]]>, at: [f64; 2]) -> bool {
    let mut inside = false;
    for ring in rings {
        for (a, b) in edges(ring) {
            if (a[1] > at[1]) != (b[1] > at[1]) {
                inside ^= at[0] < a[0] + (b[0] - a[0]) * (at[1] - a[1]) / (b[1] - a[1]);
            }
        }
    }
    inside
}

/// Corners and those that follow them, the last one joined to the first.
fn edges<P: Copy>(ring: &[P]) -> impl Iterator<Item = (P, P)> {
    ring.iter().copied().zip(ring.iter().copied().cycle().skip(1))
}

impl Map {
    /// Hatches what lies outside.
    pub(super) fn hatch(&self, rect: Rect, border: &Border) {
        let rings = self.rings(border);
        let stroke = Stroke::new(WIDTH, self.tokens.backdrop.gamma_multiply(0.8));
        for line in diagonals(rect) {
            for [from, to] in outside(line, &rings) {
                self.painter.line_segment([from, to], stroke);
            }
        }
    }

    /// Draws the lines with their name at the lowest one; returns where it stands.
    pub(super) fn border(&self, border: &Border) -> Option<Rect> {
        let rings = self.rings(border);
        for ring in &rings {
            let closed: Vec<Pos2> = ring.iter().chain(ring.first()).copied().collect();
            // Bright on dark: seen on every color of a field.
            self.painter.line(closed.clone(), Stroke::new(4.5, theme::RIM));
            self.painter.line(closed, Stroke::new(2.0, theme::ON_IMAGE.text_strong));
        }
        if border.name.is_empty() || self.painter.clip_rect().width() < NAMED_FROM {
            return None;
        }
        let lowest = rings.into_iter().flatten().reduce(|a, b| if b.y > a.y { b } else { a })?;
        let inside = self.painter.clip_rect();
        let width = self.width_of(&border.name);
        let x = (lowest.x - width / 2.0).clamp(inside.left() + 4.0, (inside.right() - width - 4.0).max(4.0));
        Some(self.chip(pos2(x, (lowest.y + 5.0).min(inside.bottom() - 40.0)), &border.name))
    }

    fn rings(&self, border: &Border) -> Vec<Vec<Pos2>> {
        let on_screen = |ring: &Vec<[f64; 2]>| ring.iter().map(|m| self.transform.to_screen(*m)).collect();
        border.rings_m.iter().map(on_screen).collect()
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

/// The parts of a line that lie outside of closed polygons: inside of an even number of them.
fn outside([from, to]: [Pos2; 2], rings: &[Vec<Pos2>]) -> Vec<[Pos2; 2]> {
    let along = to - from;
    let mut crossings: Vec<f32> = Vec::new();
    for (a, b) in rings.iter().flat_map(|ring| edges(ring)) {
        let edge = b - a;
        let area = along.x * edge.y - along.y * edge.x;
        if area.abs() < 1e-6 {
            continue; // parallel
        }
        let offset = a - from;
        let on_line = (offset.x * edge.y - offset.y * edge.x) / area;
        let on_edge = (offset.x * along.y - offset.y * along.x) / area;
        // Half open, so that a corner counts once.
        if (0.0..1.0).contains(&on_edge) && (0.0..=1.0).contains(&on_line) {
            crossings.push(on_line);
        }
    }
    crossings.sort_by(f32::total_cmp);
    // The line starts at the edge of the map, which may itself be inside.
    let mut is_outside = !contains(rings, from);
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

fn contains(rings: &[Vec<Pos2>], at: Pos2) -> bool {
    let numbers = |p: &Pos2| [f64::from(p.x), f64::from(p.y)];
    let rings: Vec<Vec<[f64; 2]>> = rings.iter().map(|ring| ring.iter().map(numbers).collect()).collect();
    is_inside(rings.iter().map(Vec::as_slice), numbers(&at))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> Vec<Vec<Pos2>> {
        vec![ring(2.0, 6.0)]
    }

    fn ring(low: f32, high: f32) -> Vec<Pos2> {
        vec![pos2(low, low), pos2(high, low), pos2(high, high), pos2(low, high)]
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
        notched[0].insert(1, pos2(4.0, 5.0));
        let parts = outside([pos2(0.0, 3.0), pos2(10.0, 3.0)], &notched);
        assert_eq!(parts.len(), 3, "{parts:?}");
    }

    #[test]
    fn a_hole_is_outside_and_a_second_part_inside() {
        // From 1 to 9 with a hole from 3 to 7, and a part of its own from 12 to 14.
        let rings = [ring(1.0, 9.0), ring(3.0, 7.0), ring(12.0, 14.0)];
        let parts = outside([pos2(0.0, 5.0), pos2(20.0, 5.0)], &rings);
        assert_eq!(parts.len(), 3, "{parts:?}");
        assert!((length(&parts) - (1.0 + 4.0 + 11.0)).abs() < 1e-4, "{parts:?}");
        let through_both = outside([pos2(0.0, 0.5), pos2(19.5, 20.0)], &rings);
        let wanted = (1.0 + 3.5 + 3.5 + 6.0) * 2.0_f32.sqrt();
        assert!((length(&through_both) - wanted).abs() < 1e-3, "{through_both:?}");
        // A line that begins in the hole begins outside.
        let from_hole = outside([pos2(5.0, 4.5), pos2(5.0, 20.0)], &rings);
        assert!((length(&from_hole) - (2.5 + 11.0)).abs() < 1e-4, "{from_hole:?}");
        let as_table = |ring: &Vec<Pos2>| ring.iter().map(|p| [f64::from(p.x), f64::from(p.y)]).collect();
        let border = Border { name: String::new(), rings_m: rings.iter().map(as_table).collect() };
        let inside = [[2.0, 2.0], [5.0, 5.0], [8.0, 5.0], [10.5, 10.5], [13.0, 13.0]];
        assert_eq!(inside.map(|at_m| border.contains(at_m)), [true, false, true, false, true]);
    }

    #[test]
    fn without_a_border_everything_is_outside() {
        assert!((length(&outside([pos2(0.0, 0.0), pos2(3.0, 4.0)], &[])) - 5.0).abs() < 1e-5);
        let nothing = |rings_m| Border { name: String::new(), rings_m };
        assert!(!nothing(vec![]).contains([0.0, 0.0]) && !nothing(vec![]).is_known());
        assert!(!nothing(vec![vec![[0.0, 0.0], [1.0, 1.0]]]).is_known());
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
