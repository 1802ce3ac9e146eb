//! What is expected of boxes and objects.

use plumbline_model::{ClassIndex, ClassNames};

/// What is known of the body in a box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    /// From the middle of its matched surface to its own middle, along the ray, as a share of half the
    /// shorter side of its box; and the standard deviation of that.
    pub depth: [f64; 2],
    /// Its middle is in the middle of the box: standard deviation, as a share of the box's side.
    pub middle_sigma: f64,
}

impl Body {
    /// Whatever it is: a hand, a lying banana, an animal is flatter or deeper than wide.
    pub const UNKNOWN: Self = Self { depth: [0.45, 0.3], middle_sigma: 0.04 };
    /// A ball, not quite. Its visible half lies 0.67 radii before its middle on average, its outline 0;
    /// windows that are matched see both (rendered balls come out at 0.5).
    pub const BALL: Self = Self { depth: [0.52, 0.08], middle_sigma: 0.01 };
}

/// Classes of the published data set whose things are balls.
const BALLS: [&str; 2] = ["Tomato", "Orange"];

/// Settings of [`super::PlaceFinder`].
#[derive(Clone, Debug, PartialEq)]
pub struct PlaceOptions {
    /// Standard deviation of each edge of a box, raw pixels, before both eyes' boxes are compared. Larger
    /// boxes get more, see [`PlaceOptions::edge_share`].
    pub edge_sigma_px: f64,
    /// Standard deviation of an edge as a share of the box's size, added (in squares).
    pub edge_share: f64,
    /// Nearest and farthest range of an object, m.
    pub range_m: [f64; 2],
    /// Classes that a detector takes for one another: boxes of such classes may be paired, flagged.
    pub look_alikes: Vec<[ClassIndex; 2]>,
    /// What is known of the bodies of some classes; of the others, [`Body::UNKNOWN`].
    pub bodies: Vec<(ClassIndex, Body)>,
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
            bodies: Vec::new(),
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
        let bodies = BALLS.iter().filter_map(|name| Some((names.index_of(name)?, Body::BALL))).collect();
        Self { look_alikes, bodies, ..Self::default() }
    }

    /// What is known of the body of a class.
    pub fn body(&self, class: ClassIndex) -> Body {
        self.bodies.iter().find(|(of, _)| *of == class).map_or(Body::UNKNOWN, |(_, body)| *body)
    }

    /// Whether two classes are taken for one another.
    pub(super) fn look_alike(&self, a: ClassIndex, b: ClassIndex) -> bool {
        self.look_alikes.iter().any(|pair| *pair == [a, b] || *pair == [b, a])
    }
}
