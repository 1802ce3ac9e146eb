//! Boxes from what the renderer says of every pixel.

use nalgebra::{Isometry3, Point3, Vector3};
use plumbline_model::{Camera, ClassIndex, PixelBox};

use crate::eyes::ObjectImage;
use crate::scene::Shape;
use crate::toys::surface::triangles;

/// Share of its outline that must be seen of something that is labeled.
const LEAST_SEEN: f64 = 0.25;
/// A box is at least this broad and high, px.
const LEAST_SIDE_PX: u32 = 4;
/// What shows this few pixels, and hardly any of itself, is seen by nobody.
const UNSEEN_PX: usize = 5;
const UNSEEN_SHARE: f64 = 0.04;

/// Something that is labeled.
pub(super) struct Thing {
    /// Its number in images of objects.
    pub object: u16,
    /// Its class.
    pub class: ClassIndex,
    /// Its shapes.
    pub robot_from_shapes: Vec<(Isometry3<f64>, Shape)>,
}

/// A box of a class.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Label {
    /// Class in the published order.
    pub class: ClassIndex,
    /// What is seen of it: the edges of its outermost pixels.
    pub area: PixelBox,
}

/// How a thing appears in an image.
pub(super) enum Appears {
    /// Not at all.
    Unseen,
    /// Enough of it is seen.
    As(PixelBox),
    /// So little that some would label it and some would not.
    Barely,
}

/// How a thing appears to an eye.
pub(super) fn appears(
    thing: &Thing,
    image: &ObjectImage,
    camera: &Camera,
    robot_from_eye: &Isometry3<f64>,
) -> Appears {
    let Some((low, high, count)) = extent(image, thing.object) else { return Appears::Unseen };
    let whole = outline_px(thing, camera, robot_from_eye).max(count);
    let share = count as f64 / whole as f64;
    let (width, height) = (high[0] - low[0] + 1, high[1] - low[1] + 1);
    if share >= LEAST_SEEN && width >= LEAST_SIDE_PX && height >= LEAST_SIDE_PX {
        let edge = |px: u32| px as f32;
        return Appears::As(PixelBox::new(edge(low[0]), edge(low[1]), edge(high[0] + 1), edge(high[1] + 1)));
    }
    if count <= UNSEEN_PX && share < UNSEEN_SHARE { Appears::Unseen } else { Appears::Barely }
}

/// First and last column and row of an object's pixels, and how many there are.
pub(super) fn extent(image: &ObjectImage, object: u16) -> Option<([u32; 2], [u32; 2], usize)> {
    let (mut low, mut high, mut count) = ([u32::MAX; 2], [0; 2], 0);
    for (x, y, pixel) in image.enumerate_pixels() {
        if pixel.0[0] == object {
            low = [low[0].min(x), low[1].min(y)];
            high = [high[0].max(x), high[1].max(y)];
            count += 1;
        }
    }
    (count > 0).then_some((low, high, count))
}

/// Pixels that a thing would cover if nothing were in the way, also beyond the image's edge.
fn outline_px(thing: &Thing, camera: &Camera, robot_from_eye: &Isometry3<f64>) -> usize {
    let eye_from_robot = robot_from_eye.inverse();
    let mut flat: Vec<[[f64; 2]; 3]> = vec![];
    for (robot_from_shape, shape) in &thing.robot_from_shapes {
        let eye_from_shape = eye_from_robot * robot_from_shape;
        for triangle in triangles(shape) {
            let seen = triangle.map(|corner| {
                let point: Vector3<f64> = (eye_from_shape * Point3::from(corner)).coords;
                camera.project(&point).ok().map(|pixel| [pixel.u_px, pixel.v_px])
            });
            if let [Some(a), Some(b), Some(c)] = seen {
                flat.push([a, b, c]);
            }
        }
    }
    covered_px(&flat)
}

/// Pixels whose middle lies in one of some triangles.
fn covered_px(flat: &[[[f64; 2]; 3]]) -> usize {
    let all = || flat.iter().flatten();
    let low = [0, 1].map(|i| all().map(|p| p[i]).fold(f64::MAX, f64::min).max(-400.0).ceil());
    let high = [0, 1].map(|i| all().map(|p| p[i]).fold(f64::MIN, f64::max).min(1400.0).floor());
    if flat.is_empty() || low[0] > high[0] || low[1] > high[1] {
        return 0;
    }
    let width = (high[0] - low[0]) as usize + 1;
    let height = (high[1] - low[1]) as usize + 1;
    let mut covered = vec![false; width * height];
    for [a, b, c] in flat {
        let span = |i: usize| {
            let (first, last) =
                (a[i].min(b[i]).min(c[i]).ceil().max(low[i]), a[i].max(b[i]).max(c[i]).floor().min(high[i]));
            ((first - low[i]) as usize, last - low[i])
        };
        let ((x0, x1), (y0, y1)) = (span(0), span(1));
        let side = |p: &[f64; 2], q: &[f64; 2], x: f64, y: f64| {
            (q[0] - p[0]) * (y - p[1]) - (q[1] - p[1]) * (x - p[0])
        };
        for row in y0..height {
            if row as f64 > y1 {
                break;
            }
            for column in x0..width {
                if column as f64 > x1 {
                    break;
                }
                let (x, y) = (column as f64 + low[0], row as f64 + low[1]);
                let sides = [side(a, b, x, y), side(b, c, x, y), side(c, a, x, y)];
                if sides.iter().all(|s| *s >= 0.0) || sides.iter().all(|s| *s <= 0.0) {
                    covered[row * width + column] = true;
                }
            }
        }
    }
    covered.iter().filter(|covered| **covered).count()
}

/// A line of a label file: class, middle and size in shares of the image.
pub(super) fn line(label: &Label, size_px: (u32, u32)) -> String {
    let [x, y, width, height] = label.area.in_shares(size_px);
    format!("{} {x} {y} {width} {height}\n", label.class.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangles_cover_the_pixels_whose_middle_they_hold() {
        let square = [[[0.0, 0.0], [9.0, 0.0], [9.0, 4.0]], [[0.0, 0.0], [9.0, 4.0], [0.0, 4.0]]];
        assert_eq!(covered_px(&square), 50);
        assert_eq!(covered_px(&[[[0.2, 0.2], [0.8, 0.2], [0.5, 0.8]]]), 0);
        assert_eq!(covered_px(&[]), 0);
    }

    #[test]
    fn a_line_gives_the_middle_and_the_size() {
        let label = Label { class: ClassIndex(7), area: PixelBox::new(64.0, 48.0, 128.0, 96.0) };
        assert_eq!(line(&label, (640, 480)), "7 0.15 0.15 0.1 0.1\n");
    }

    #[test]
    fn extents_are_those_of_the_pixels() {
        let mut image = ObjectImage::new(8, 6);
        assert_eq!(extent(&image, 3), None);
        image.put_pixel(2, 1, image::Luma([3]));
        image.put_pixel(5, 4, image::Luma([3]));
        assert_eq!(extent(&image, 3), Some(([2, 1], [5, 4], 2)));
    }
}
