//! What a detector says about an image, as plain data: boxes with class and confidence.

use std::fmt;

use serde::{Deserialize, Serialize};

use crate::pixel::{Pixel, PixelSpace};

/// The classes of the published data set of NICO's objects, in its order.
pub const PUBLISHED_CLASSES: [&str; 8] =
    ["Banana", "Duck", "LeftHand", "Mushroom", "Onion", "Orange", "RightHand", "Tomato"];

/// A rectangle along the axes of an image, by its edges: 0 is the left edge of the first pixel,
/// the width of the image the right edge of the last, as in YOLO and COCO files. (A [`Pixel`]
/// counts from the middle of the first pixel, half a pixel less.)
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PixelBox {
    /// Left edge.
    pub x0_px: f32,
    /// Top edge.
    pub y0_px: f32,
    /// Right edge, not before the left one.
    pub x1_px: f32,
    /// Bottom edge, not above the top one.
    pub y1_px: f32,
}

impl PixelBox {
    /// From edges.
    pub fn new(x0_px: f32, y0_px: f32, x1_px: f32, y1_px: f32) -> Self {
        Self { x0_px, y0_px, x1_px, y1_px }
    }

    /// From its middle and its size.
    pub fn from_middle(x_px: f32, y_px: f32, width_px: f32, height_px: f32) -> Self {
        let (w, h) = (0.5 * width_px, 0.5 * height_px);
        Self::new(x_px - w, y_px - h, x_px + w, y_px + h)
    }

    /// Width, px.
    pub fn width_px(&self) -> f32 {
        self.x1_px - self.x0_px
    }

    /// Height, px.
    pub fn height_px(&self) -> f32 {
        self.y1_px - self.y0_px
    }

    /// Area, px²; 0 for a box without extent.
    pub fn area_px2(&self) -> f32 {
        self.width_px().max(0.0) * self.height_px().max(0.0)
    }

    /// Its middle as a pixel of an image.
    pub fn middle<S: PixelSpace>(&self) -> Pixel<S> {
        let middle = |a: f32, b: f32| 0.5 * (f64::from(a) + f64::from(b)) - 0.5;
        Pixel::new(middle(self.x0_px, self.x1_px), middle(self.y0_px, self.y1_px))
    }

    /// What two boxes have in common; `None` if they do not overlap.
    pub fn intersection(&self, other: &Self) -> Option<Self> {
        let common = Self::new(
            self.x0_px.max(other.x0_px),
            self.y0_px.max(other.y0_px),
            self.x1_px.min(other.x1_px),
            self.y1_px.min(other.y1_px),
        );
        (common.x1_px > common.x0_px && common.y1_px > common.y0_px).then_some(common)
    }

    /// Intersection over union, 0–1; 0 where both are empty.
    pub fn iou(&self, other: &Self) -> f32 {
        let common = self.intersection(other).map_or(0.0, |common| common.area_px2());
        let union = self.area_px2() + other.area_px2() - common;
        if union > 0.0 { common / union } else { 0.0 }
    }

    /// Whether a pixel's middle lies in it.
    pub fn contains<S: PixelSpace>(&self, pixel: &Pixel<S>) -> bool {
        let (x, y) = (pixel.u_px + 0.5, pixel.v_px + 0.5);
        x >= f64::from(self.x0_px)
            && x < f64::from(self.x1_px)
            && y >= f64::from(self.y0_px)
            && y < f64::from(self.y1_px)
    }

    /// Middle and size (x, y, width, height) as shares of an image of this size: what rows of label
    /// files in the YOLO layout say.
    pub fn in_shares(&self, size_px: (u32, u32)) -> [f64; 4] {
        let (w, h) = (f64::from(size_px.0), f64::from(size_px.1));
        let [x0, y0, x1, y1] = [self.x0_px, self.y0_px, self.x1_px, self.y1_px].map(f64::from);
        [0.5 * (x0 + x1) / w, 0.5 * (y0 + y1) / h, (x1 - x0) / w, (y1 - y0) / h]
    }

    /// The part of it on an image of this size; `None` if there is none.
    pub fn on_image(&self, (width_px, height_px): (u32, u32)) -> Option<Self> {
        self.intersection(&Self::new(0.0, 0.0, width_px as f32, height_px as f32))
    }
}

/// Number of a class in the list of a detector or data set.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct ClassIndex(pub usize);

/// Names of classes; their order is the meaning of every class number.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ClassNames(Vec<String>);

impl ClassNames {
    /// From names in order.
    pub fn new(names: impl IntoIterator<Item = impl Into<String>>) -> Self {
        Self(names.into_iter().map(Into::into).collect())
    }

    /// The published eight.
    pub fn published() -> Self {
        Self::new(PUBLISHED_CLASSES)
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Name of a class, if it is in the list.
    pub fn get(&self, class: ClassIndex) -> Option<&str> {
        self.0.get(class.0).map(String::as_str)
    }

    /// The class of a name, exactly as written.
    pub fn index_of(&self, name: &str) -> Option<ClassIndex> {
        self.0.iter().position(|known| known == name).map(ClassIndex)
    }

    /// All, in order.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = (ClassIndex, &str)> {
        self.0.iter().enumerate().map(|(i, name)| (ClassIndex(i), name.as_str()))
    }
}

impl fmt::Display for ClassNames {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0.join(", "))
    }
}

/// One thing found on an image.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Detection {
    /// What it is, in the detector's own list.
    pub class: ClassIndex,
    /// How sure the detector is, 0–1 (not a probability unless the detector is calibrated).
    pub confidence: f32,
    /// Where, on the raw image.
    pub area: PixelBox,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pixel::Raw;

    #[test]
    fn overlap_is_symmetric_and_one_with_itself() {
        let a = PixelBox::new(0.0, 0.0, 10.0, 10.0);
        let b = PixelBox::new(5.0, 5.0, 15.0, 15.0);
        assert!((a.iou(&b) - 25.0 / 175.0).abs() < 1e-6);
        assert_eq!(a.iou(&b), b.iou(&a));
        assert_eq!(a.iou(&a), 1.0);
        assert_eq!(a.iou(&PixelBox::new(10.0, 0.0, 20.0, 10.0)), 0.0);
        assert_eq!(PixelBox::default().iou(&PixelBox::default()), 0.0);
    }

    #[test]
    fn the_middle_of_one_pixel_is_that_pixel() {
        let first = PixelBox::new(0.0, 0.0, 1.0, 1.0);
        assert_eq!(first.middle::<Raw>(), Pixel::new(0.0, 0.0));
        assert!(first.contains(&Pixel::<Raw>::new(0.0, 0.0)));
        assert!(!first.contains(&Pixel::<Raw>::new(1.0, 0.0)));
    }

    #[test]
    fn what_is_off_the_image_is_not_on_it() {
        assert_eq!(PixelBox::new(-9.0, 0.0, -1.0, 5.0).on_image((10, 10)), None);
        let half = PixelBox::new(-5.0, 0.0, 5.0, 5.0).on_image((10, 10));
        assert_eq!(half, Some(PixelBox::new(0.0, 0.0, 5.0, 5.0)));
    }

    #[test]
    fn names_keep_their_order() {
        let names = ClassNames::published();
        assert_eq!(names.index_of("Tomato"), Some(ClassIndex(7)));
        assert_eq!(names.get(ClassIndex(2)), Some("LeftHand"));
        assert_eq!(names.get(ClassIndex(8)), None);
        assert_eq!(names.index_of("tomato"), None);
    }
}
