//! Plans that are good to start with.

use super::{Finger, Pattern, PlanOptions, Purpose, Sides, TouchArea};

impl PlanOptions {
    /// A first calibration: about 80 touches. A grid for the shape of the error over the area,
    /// lines for what is bent in between, five places again and again for the noise floor.
    pub fn first(area: TouchArea) -> Self {
        let patterns = vec![
            Pattern::Grid { columns: 7, rows: 4 },
            Pattern::Lines { horizontal: 2, vertical: 1, diagonal: 2, points: 7 },
            Pattern::Again { targets: 5, times: 4 },
        ];
        Self { patterns, ..Self::plain(area, Purpose::Train) }
    }

    /// The least that a model can be trained on: about 24 touches.
    pub fn quick(area: TouchArea) -> Self {
        let patterns = vec![Pattern::Grid { columns: 5, rows: 4 }, Pattern::Again { targets: 2, times: 2 }];
        Self { patterns, ..Self::plain(area, Purpose::Train) }
    }

    /// The richest experiment: two sides, three heights, with and without a weight, so that
    /// causes of the error can be told apart.
    pub fn rich(area: TouchArea) -> Self {
        let patterns = vec![Pattern::Grid { columns: 5, rows: 3 }, Pattern::Again { targets: 2, times: 1 }];
        Self {
            patterns,
            sides: Sides::LeftAndRight,
            screen_heights_m: vec![0.0, 0.06, 0.12],
            payloads_kg: vec![0.0, 0.25],
            ..Self::plain(area, Purpose::Train)
        }
    }

    /// New random targets to see how well a model reaches.
    pub fn check_reach(area: TouchArea, count: usize, seed: u64) -> Self {
        let patterns = vec![Pattern::Random { count }];
        Self { patterns, seed, ..Self::plain(area, Purpose::Check) }
    }

    /// The same, each once by the robot as it is described and once corrected: what a correction is worth.
    pub fn prove(area: TouchArea, count: usize, seed: u64) -> Self {
        Self { beside_described: true, ..Self::check_reach(area, count, seed) }
    }

    /// Where the screen lies: the corners of the area, each twice.
    pub fn place_screen(area: TouchArea) -> Self {
        Self { patterns: vec![Pattern::Corners], repeats: 2, ..Self::plain(area, Purpose::PlaceScreen) }
    }

    /// What commissioning touches for a purpose: 4 corners and the middle, for of four alone nobody can say how good they
    /// are, 15 to learn from where they tell most, 5 anywhere to check, 25 in all. What so few leave open of the arm, its hands held over the table tell the eyes.
    pub fn few(area: TouchArea, purpose: Purpose, seed: u64) -> Self {
        let patterns = match purpose {
            Purpose::PlaceScreen => vec![Pattern::Corners, Pattern::Grid { columns: 1, rows: 1 }],
            Purpose::Train => vec![Pattern::Telling { places: 12, again: 3 }],
            Purpose::Check => vec![Pattern::Random { count: 5 }],
        };
        Self { patterns, seed, ..Self::plain(area, purpose) }
    }

    fn plain(area: TouchArea, purpose: Purpose) -> Self {
        Self {
            area,
            patterns: vec![],
            repeats: 1,
            sides: Sides::Above,
            screen_heights_m: vec![0.0],
            payloads_kg: vec![0.0],
            seed: 1,
            purpose,
            finger: Finger::default(),
            beside_described: false,
        }
    }
}
