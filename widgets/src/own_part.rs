//! The part of a drawing that each of many points has for itself, to be clicked in.

use egui::Pos2;

/// Points nearer than this are at the same place: nobody tells them apart with a pointer.
const SAME_PLACE_PT: f32 = 1.0;

/// Side of the square around each point that is its own, at most `most`: close points leave each other
/// their part.
pub(crate) fn own_sides(at: &[Pos2], most: f32) -> Vec<f32> {
    let mut sides = vec![most; at.len()];
    for (i, a) in at.iter().enumerate() {
        for (j, b) in at.iter().enumerate().skip(i + 1) {
            let apart = (*a - *b).abs().max_elem();
            if apart > SAME_PLACE_PT {
                sides[i] = sides[i].min(apart);
                sides[j] = sides[j].min(apart);
            }
        }
    }
    sides
}

#[cfg(test)]
mod tests {
    use egui::{Rect, Vec2, pos2};

    use super::*;

    #[test]
    fn no_two_squares_lie_on_each_other_and_lonely_points_keep_theirs() {
        let at = [pos2(0.0, 0.0), pos2(5.0, 1.0), pos2(9.0, -3.0), pos2(90.0, 0.0), pos2(90.0, 0.4)];
        let sides = own_sides(&at, 16.0);
        assert_eq!(sides[3..], [16.0, 16.0]);
        let square = |i: usize| Rect::from_center_size(at[i], Vec2::splat(sides[i]));
        for (i, j) in [(0, 1), (0, 2), (1, 2), (2, 3)] {
            let common = square(i).intersect(square(j));
            assert!(common.width() <= 1e-4 || common.height() <= 1e-4, "{i} and {j}: {common}");
        }
    }
}
