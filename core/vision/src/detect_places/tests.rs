//! Rendered worlds with a known truth.

use image::RgbImage;
use plumbline_model::{ClassIndex, Detection, PixelBox, StereoCalibration};

use super::{PlaceOptions, Seen, Unpaired, places};
use crate::synthetic::nico_like_eyes;

pub(super) fn detection(class: usize, area: PixelBox) -> Detection {
    Detection { class: ClassIndex(class), confidence: 0.9, area }
}

#[test]
fn a_box_without_partner_says_why() {
    let calibration = StereoCalibration::bare(nico_like_eyes());
    let image = RgbImage::new(640, 480);
    let left = [detection(1, PixelBox::from_middle(320.0, 300.0, 30.0, 30.0))];
    let right = [detection(1, PixelBox::from_middle(295.0, 340.0, 30.0, 30.0))];
    let found = places(&calibration, (&image, &left), (&image, &right), &PlaceOptions::default());
    assert_eq!(found.len(), 2);
    for place in &found {
        let Seen::One { why: Unpaired::OffEpipolarLine { by_px }, .. } = place.seen else {
            panic!("{:?}", place.seen);
        };
        assert!((35.0..50.0).contains(&by_px), "{by_px}");
    }
}
