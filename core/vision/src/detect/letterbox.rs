//! Letterbox: an image scaled into the input of a network, its sides kept in proportion, the
//! rest gray.
//!
//! The numbers are those of the reference (`LetterBox` and `scale_boxes` of ultralytics 8.4), so
//! that a network sees here what it saw in training: the scaled sides and the left and upper
//! padding are rounded half to even, padding splits as ⌊d/2 − 0.1⌉ and ⌊d/2 + 0.1⌉, gray is 114,
//! and pixels are resampled bilinearly as OpenCV's `resize` does. Checked against numbers of the
//! reference in `tests/detect_reference.rs`.

use plumbline_model::detection::PixelBox;

use super::{InputSize, Part, Region};

/// Where an image lies in the input of a network.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Letterbox {
    /// Size (width, height) of the image, px.
    pub image: (u32, u32),
    /// Size (width, height) of the input that holds all of the image, px.
    pub input: (u32, u32),
    /// Size (width, height) of the image in it, px.
    pub scaled: (u32, u32),
    /// Column and row of the image's first pixel in the input.
    pub offset: (u32, u32),
    /// What of this input the network is given, in its pixels.
    pub given: Region,
}

impl Letterbox {
    /// For an image of a size (width, height) and a network; `None` if the image is empty.
    pub fn new(image: (u32, u32), input: InputSize) -> Option<Self> {
        if image.0 == 0 || image.1 == 0 {
            return None;
        }
        let (within, stride) = match input {
            InputSize::Fixed { width_px, height_px } => ((width_px, height_px), None),
            InputSize::Dynamic { width_px, height_px, stride_px } => ((width_px, height_px), Some(stride_px)),
        };
        let ratio = |inner: u32, outer: u32| f64::from(inner) / f64::from(outer);
        let scale = ratio(within.1, image.1).min(ratio(within.0, image.0));
        let side = |length: u32| ((f64::from(length) * scale).round_ties_even() as u32).max(1);
        let scaled = (side(image.0), side(image.1));
        // Both fit but for the rounding of a side that is scaled exactly to the input's.
        let spare = |outer: u32, inner: u32| {
            let spare = outer.saturating_sub(inner);
            stride.map_or(spare, |stride| spare % stride.max(1))
        };
        let spare = (spare(within.0, scaled.0), spare(within.1, scaled.1));
        let input = (scaled.0 + spare.0, scaled.1 + spare.1);
        let offset = (before(spare.0), before(spare.1));
        Some(Self { image, input, scaled, offset, given: Region::whole(input) })
    }

    /// For a part of an image: the input that all of it would have, but only the whole strides of it
    /// in which the part lies. The network then sees the same pixels as in all of the image, in the
    /// same places of its cells. An input of fixed size costs the same whatever it shows: it gets all
    /// of the image, and so does a part that is not on the image.
    ///
    /// `None` if the image is empty.
    pub fn of_region(image: (u32, u32), region: Region, input: InputSize) -> Option<Self> {
        let whole = Self::new(image, input)?;
        let (InputSize::Dynamic { stride_px, .. }, Some(region)) = (input, region.on_image(image)) else {
            return Some(whole);
        };
        let stride = stride_px.max(1);
        let along = |axis: Axis, first: u32, length: u32| {
            let gain = f64::from(axis.scaled) / f64::from(axis.image);
            let at = |px: u32| f64::from(axis.offset) + f64::from(px) * gain;
            let begin = at(first) as u32 / stride * stride;
            let end = (at(first + length).ceil() as u32).next_multiple_of(stride).min(axis.input);
            (begin, end - begin)
        };
        let (x_px, width_px) = along(whole.axis(0), region.x_px, region.width_px);
        let (y_px, height_px) = along(whole.axis(1), region.y_px, region.height_px);
        Some(Self { given: Region { x_px, y_px, width_px, height_px }, ..whole })
    }

    /// For what of an image is looked at. `lit` is what is not black to the edge.
    pub(super) fn of_part(
        image: (u32, u32),
        part: Part,
        lit: impl FnOnce() -> Region,
        input: InputSize,
    ) -> Option<Self> {
        match (part, input) {
            (Part::Whole, _) | (_, InputSize::Fixed { .. }) => Self::new(image, input),
            (Part::Lit, _) => Self::of_region(image, lit(), input),
            (Part::Region(region), _) => Self::of_region(image, region, input),
        }
    }

    /// Along columns (0) or rows (1).
    fn axis(&self, axis: usize) -> Axis {
        let of = |(x, y): (u32, u32)| if axis == 0 { x } else { y };
        Axis {
            image: of(self.image),
            input: of(self.input),
            scaled: of(self.scaled),
            offset: of(self.offset),
            given: of((self.given.x_px, self.given.y_px)),
        }
    }

    /// A box of what the network is given on the image, clipped to it.
    pub fn on_image(&self, [x0, y0, x1, y1]: [f32; 4]) -> PixelBox {
        let along = |at: f32, axis: Axis| {
            let gain = (f64::from(axis.scaled) / f64::from(axis.image)) as f32;
            ((at + axis.given as f32 - axis.offset as f32) / gain).clamp(0.0, axis.image as f32)
        };
        let (x, y) = (self.axis(0), self.axis(1));
        PixelBox::new(along(x0, x), along(y0, y), along(x1, x), along(y1, y))
    }
}

/// A letterbox along columns or rows, px.
#[derive(Clone, Copy)]
struct Axis {
    image: u32,
    input: u32,
    scaled: u32,
    offset: u32,
    /// First of what the network is given.
    given: u32,
}

/// Padding on the left or above, of all padding.
fn before(spare: u32) -> u32 {
    (0.5 * f64::from(spare) - 0.1).round_ties_even() as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARE: InputSize = InputSize::Fixed { width_px: 640, height_px: 640 };

    #[test]
    fn a_camera_image_is_padded_above_and_below() {
        let letterbox = Letterbox::new((640, 480), SQUARE).expect("an image");
        assert_eq!(letterbox.scaled, (640, 480));
        assert_eq!(letterbox.offset, (0, 80));
        assert_eq!(letterbox.input, (640, 640));
    }

    #[test]
    fn a_network_of_any_size_gets_no_more_padding_than_it_needs() {
        let any = InputSize::Dynamic { width_px: 640, height_px: 640, stride_px: 32 };
        let letterbox = Letterbox::new((640, 470), any).expect("an image");
        assert_eq!((letterbox.input, letterbox.offset), ((640, 480), (0, 5)));
    }

    #[test]
    fn boxes_come_back_to_where_they_are_on_the_image() {
        for image in [(640, 480), (1, 1), (333, 517), (1920, 1080), (3000, 1)] {
            let letterbox = Letterbox::new(image, SQUARE).expect("an image");
            let (left, top) = (letterbox.offset.0 as f32, letterbox.offset.1 as f32);
            let whole = [left, top, left + letterbox.scaled.0 as f32, top + letterbox.scaled.1 as f32];
            let back = letterbox.on_image(whole);
            assert!((back.width_px() - image.0 as f32).abs() < 1e-3, "{image:?}: {back:?}");
            assert!((back.height_px() - image.1 as f32).abs() < 1e-3, "{image:?}: {back:?}");
            let everywhere = letterbox.on_image([-1e9, -1e9, 1e9, 1e9]);
            assert_eq!(everywhere, PixelBox::new(0.0, 0.0, image.0 as f32, image.1 as f32));
        }
    }

    const ANY: InputSize = InputSize::Dynamic { width_px: 960, height_px: 704, stride_px: 32 };

    #[test]
    fn a_part_is_seen_at_the_scale_and_in_the_cells_of_the_whole() {
        let whole = Letterbox::new((640, 480), ANY).expect("an image");
        let region = Region { x_px: 120, y_px: 200, width_px: 300, height_px: 150 };
        let part = Letterbox::of_region((640, 480), region, ANY).expect("an image");
        assert_eq!(part.given, Region { x_px: 160, y_px: 288, width_px: 480, height_px: 256 });
        assert_eq!(Letterbox { given: whole.given, ..part }, whole);
        let in_whole = [200.0, 300.0, 260.0, 340.0];
        let in_part = [200.0 - 160.0, 300.0 - 288.0, 260.0 - 160.0, 340.0 - 288.0];
        assert_eq!(part.on_image(in_part), whole.on_image(in_whole));
    }

    #[test]
    fn parts_at_the_edges_and_of_any_size_stay_on_the_image() {
        let image = (640, 480);
        for (x_px, y_px) in [(0, 0), (639, 479), (600, 10), (13, 470)] {
            for (width_px, height_px) in [(1, 1), (640, 480), (33, 400), (500, 21), (u32::MAX, 5)] {
                let region = Region { x_px, y_px, width_px, height_px };
                let letterbox = Letterbox::of_region(image, region, ANY).expect("an image");
                let given = letterbox.given;
                assert_eq!(given.on_image(letterbox.input), Some(given), "{region:?}");
                assert!(given.width_px.is_multiple_of(32) && given.height_px.is_multiple_of(32));
                let shown = letterbox.on_image([0.0, 0.0, given.width_px as f32, given.height_px as f32]);
                let asked = region.on_image(image).expect("it begins on the image");
                let (right, below) = (asked.x_px + asked.width_px, asked.y_px + asked.height_px);
                assert!(shown.x0_px <= asked.x_px as f32 && shown.y0_px <= asked.y_px as f32, "{region:?}");
                assert!(shown.x1_px >= right as f32 && shown.y1_px >= below as f32, "{region:?}");
            }
        }
    }

    #[test]
    fn where_a_part_saves_nothing_all_is_seen() {
        let whole = |input| Letterbox::new((640, 480), input);
        let outside = Region { x_px: 640, y_px: 0, width_px: 10, height_px: 10 };
        assert_eq!(Letterbox::of_region((640, 480), outside, ANY), whole(ANY));
        let inside = Region { x_px: 10, y_px: 0, width_px: 10, height_px: 10 };
        assert_eq!(Letterbox::of_region((640, 480), inside, SQUARE), whole(SQUARE));
        assert_eq!(Letterbox::of_region((640, 480), Region::whole((640, 480)), ANY), whole(ANY));
        assert_eq!(Letterbox::of_region((0, 480), inside, ANY), None);
    }

    #[test]
    fn an_empty_image_has_no_place() {
        assert_eq!(Letterbox::new((0, 480), SQUARE), None);
        assert_eq!(Letterbox::new((640, 0), SQUARE), None);
    }
}
