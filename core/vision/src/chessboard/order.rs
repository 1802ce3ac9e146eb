//! Puts corners into the board's order, the same for both eyes and, where the print allows it,
//! the same for all views.

use image::GrayImage;
use nalgebra::Vector2;
use plumbline_model::{Chessboard, Pixel, Raw};

/// Reorders a full grid given row by row with `columns` per row so that it matches `board`:
/// right number of columns, x × y pointing into the image (a board seen from its front), first
/// corner at a dark square where the print tells the two ends apart.
///
/// `None` if the grid has another size than the board.
pub(super) fn to_board_order(
    gray: &GrayImage,
    board: &Chessboard,
    columns: usize,
    rows: usize,
    corners: &[Vector2<f64>],
) -> Option<Vec<Vector2<f64>>> {
    let (want_columns, want_rows) = (board.inner_columns as usize, board.inner_rows as usize);
    let mut grid = if (columns, rows) == (want_columns, want_rows) {
        corners.to_vec()
    } else if (columns, rows) == (want_rows, want_columns) {
        transpose(corners, columns, rows)
    } else {
        return None;
    };
    if signed_area(&grid, want_columns) < 0.0 {
        grid = flip_rows(&grid, want_columns);
    }
    let turned: Vec<_> = grid.iter().rev().copied().collect();
    let upright = if ends_differ(board) {
        first_square_is_dark(gray, &grid, want_columns)
    } else {
        // The print looks the same turned by half: take the reading direction.
        let x_direction = grid[want_columns - 1] - grid[0];
        let y_direction = grid[grid.len() - want_columns] - grid[0];
        if x_direction.x.abs() > y_direction.x.abs() { x_direction.x > 0.0 } else { y_direction.y > 0.0 }
    };
    Some(if upright { grid } else { turned })
}

/// Turns the second eye's corners by half if that makes them point the same way as the first's;
/// only for boards whose two ends look alike.
pub(super) fn align(board: &Chessboard, first: &[Pixel<Raw>], second: Vec<Pixel<Raw>>) -> Vec<Pixel<Raw>> {
    if ends_differ(board) {
        return second;
    }
    let columns = board.inner_columns as usize;
    let axes = |c: &[Pixel<Raw>]| {
        (c[columns - 1].vector() - c[0].vector(), c[c.len() - columns].vector() - c[0].vector())
    };
    let ((ax, ay), (bx, by)) = (axes(first), axes(&second));
    if ax.dot(&bx) + ay.dot(&by) < 0.0 { second.into_iter().rev().collect() } else { second }
}

/// Whether a half turn changes the print: the squares at opposite ends then have different colors.
fn ends_differ(board: &Chessboard) -> bool {
    (board.inner_columns + board.inner_rows) % 2 == 1
}

fn transpose(corners: &[Vector2<f64>], columns: usize, rows: usize) -> Vec<Vector2<f64>> {
    (0..columns).flat_map(|i| (0..rows).map(move |j| corners[j * columns + i])).collect()
}

fn flip_rows(corners: &[Vector2<f64>], columns: usize) -> Vec<Vector2<f64>> {
    corners.chunks(columns).rev().flatten().copied().collect()
}

/// Twice the area of the outline; positive when x → y turns clockwise on screen (y down).
fn signed_area(corners: &[Vector2<f64>], columns: usize) -> f64 {
    let n = corners.len();
    let diagonal = corners[n - 1] - corners[0];
    let other = corners[n - columns] - corners[columns - 1];
    diagonal.x * other.y - diagonal.y * other.x
}

/// Compares the squares of the color of the first inner square with the others.
fn first_square_is_dark(gray: &GrayImage, corners: &[Vector2<f64>], columns: usize) -> bool {
    let rows = corners.len() / columns;
    let (mut same, mut other, mut counts) = (0.0, 0.0, (0, 0));
    for j in 0..rows - 1 {
        for i in 0..columns - 1 {
            let k = j * columns + i;
            let center =
                (corners[k] + corners[k + 1] + corners[k + columns] + corners[k + columns + 1]) * 0.25;
            let Some(value) = sample(gray, center) else { continue };
            if (i + j) % 2 == 0 {
                same += value;
                counts.0 += 1;
            } else {
                other += value;
                counts.1 += 1;
            }
        }
    }
    same / f64::from(counts.0.max(1)) < other / f64::from(counts.1.max(1))
}

fn sample(gray: &GrayImage, at: Vector2<f64>) -> Option<f64> {
    let (x, y) = (at.x.round(), at.y.round());
    let inside = x >= 0.0 && y >= 0.0 && x < f64::from(gray.width()) && y < f64::from(gray.height());
    inside.then(|| f64::from(gray.get_pixel(x as u32, y as u32)[0]))
}
