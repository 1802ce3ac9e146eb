//! What is expected of boxes and objects.

use plumbline_model::{ClassIndex, ClassNames};

/// Settings of [`super::PlaceFinder`].
#[derive(Clone, Debug, PartialEq)]
pub struct PlaceOptions {
    /// Standard deviation of each edge of a box, raw pixels. Larger boxes get more, see
    /// [`PlaceOptions::edge_share`].
    pub edge_sigma_px: f64,
    /// Standard deviation of an edge as a share of the box's size, added (in squares).
    pub edge_share: f64,
    /// Nearest and farthest range of an object, m.
    pub range_m: [f64; 2],
    /// Classes that a detector takes for one another: boxes of such classes may be paired, flagged.
    pub look_alikes: Vec<[ClassIndex; 2]>,
    /// Boxes paired per eye; of more, the most confident.
    pub most_per_eye: usize,
    /// What lies behind an object is worth a warning from this distance, m…
    pub leak_depth_m: f64,
    /// …if it has this share of the box's pixels, 0–1,
    pub leak_share: f64,
    /// or if a place from all pixels of the box would have been wrong by this much, m.
    pub leak_error_m: f64,
}

impl Default for PlaceOptions {
    fn default() -> Self {
        Self {
            edge_sigma_px: 1.0,
            edge_share: 0.02,
            range_m: [0.15, 3.0],
            look_alikes: Vec::new(),
            most_per_eye: 64,
            leak_depth_m: 0.06,
            leak_share: 0.35,
            leak_error_m: 0.02,
        }
    }
}

/// Things of the published data set that look alike at the size at which the eyes see them.
const LOOK_ALIKES: [[&str; 2]; 5] = [
    ["LeftHand", "RightHand"],
    ["Tomato", "Orange"],
    ["Orange", "Onion"],
    ["Tomato", "Onion"],
    ["Mushroom", "Onion"],
];

impl PlaceOptions {
    /// The usual ones, with the look-alikes among these classes.
    pub fn for_classes(names: &ClassNames) -> Self {
        let look_alikes =
            LOOK_ALIKES.iter().filter_map(|[a, b]| Some([names.index_of(a)?, names.index_of(b)?])).collect();
        Self { look_alikes, ..Self::default() }
    }

    /// Whether two classes are taken for one another.
    pub(super) fn look_alike(&self, a: ClassIndex, b: ClassIndex) -> bool {
        self.look_alikes.iter().any(|pair| *pair == [a, b] || *pair == [b, a])
    }
}
