//! A view with objects that no detector found.

use std::sync::Arc;
use std::time::{Duration, Instant};

use image::{Rgb, RgbImage};
use nalgebra::Matrix3;
use plumbline_engine::View;
use plumbline_engine::view::{
    ClassRates, DetectView, DetectionTiming, DetectionsView, DetectorFacts, DetectorState, LiveView,
    LookedAt, ObjectPlaceView, ObjectView, SeenBox, SourceStatus, SourceView, Unplaced,
};
use plumbline_model::detection::{ClassIndex, ClassNames, PixelBox};
use plumbline_model::{Eye, Pixel, Point, Stamp, StereoFrame};

fn stamp() -> Stamp {
    Stamp { seq: 7, captured_at: Instant::now() }
}

fn picture() -> Arc<RgbImage> {
    Arc::new(RgbImage::from_fn(640, 480, |u, v| {
        let light = 60 + (u / 8 + v / 8) as u8 % 90;
        Rgb([light, light, light / 2 + 40])
    }))
}

fn seen(confidence: f32, x: f32, y: f32, size: f32) -> SeenBox {
    let line = (0..30).map(|i| Pixel::new(60.0 + 18.0 * f64::from(i), f64::from(y) + f64::from(i) * 0.5));
    SeenBox {
        confidence,
        area: PixelBox::from_middle(x, y, size, size),
        rectified: Arc::default(),
        line_in_other: line.collect(),
    }
}

/// An object that both eyes see.
pub fn tomato() -> ObjectView {
    let sigma_m = [0.004, 0.002, 0.003];
    let place = ObjectPlaceView {
        point_in_robot: Point::new(0.331, -0.118, 0.082),
        sigma_m,
        wide_because: None,
        covariance_m2: Matrix3::from_diagonal(&nalgebra::Vector3::from(sigma_m.map(|s: f64| s * s))),
        range_m: 0.452,
        range_sigma_m: 0.0043,
        model: "as described".into(),
    };
    ObjectView {
        class: ClassIndex(7),
        name: "Tomato".to_owned(),
        left: Some(seen(0.91, 300.0, 240.0, 60.0)),
        right: Some(seen(0.88, 262.0, 241.0, 60.0)),
        epipolar_px: Some(0.4),
        alone_because: None,
        place: Ok(place),
        stands: None,
        voted: [PixelBox::new(285.0, 225.0, 315.0, 255.0)].into(),
        leak: None,
        doubts: Vec::new(),
    }
}

/// A hand before a far background.
pub fn hand() -> ObjectView {
    ObjectView {
        class: ClassIndex(6),
        name: "RightHand".to_owned(),
        left: Some(seen(0.64, 420.0, 300.0, 80.0)),
        right: Some(seen(0.57, 380.0, 300.0, 80.0)),
        leak: Some(
            "38 % of its box lies 240 mm behind it and does not count: a place from all of the box would be 71 mm off."
                .to_owned(),
        ),
        ..tomato()
    }
}

/// A box of one eye.
pub fn banana() -> ObjectView {
    ObjectView {
        class: ClassIndex(0),
        name: "Banana".to_owned(),
        left: Some(seen(0.77, 150.0, 130.0, 70.0)),
        right: None,
        epipolar_px: None,
        alone_because: Some("The other eye has found nothing of this kind.".to_owned()),
        place: Err(Unplaced::OneEye(Eye::Left).into()),
        stands: None,
        voted: Arc::default(),
        leak: None,
        doubts: Vec::new(),
    }
}

pub fn facts() -> DetectorFacts {
    DetectorFacts {
        name: "Plumbline's own".to_owned(),
        names: ClassNames::published(),
        names_from: "the file itself".to_owned(),
        rows: vec![("Input".to_owned(), "480x480 px".to_owned())],
        ..DetectorFacts::default()
    }
}

pub fn found(objects: Vec<ObjectView>) -> DetectionsView {
    DetectionsView {
        stamp: stamp(),
        names: ClassNames::published(),
        objects,
        no_places_because: None,
        looked_at: LookedAt::Workspace { share: 0.21, with_beyond: false },
        timing: DetectionTiming {
            before: Duration::from_micros(2100),
            network: Duration::from_micros(38_200),
            after: Duration::from_micros(400),
            places: Duration::from_micros(3100),
        },
        left_out: 0,
    }
}

pub fn detect() -> DetectView {
    let rates = ClassRates {
        name: "Tomato".to_owned(),
        left: 0.98,
        right: 0.94,
        agree: Some(0.93),
        lost: Some(0.02),
    };
    DetectView {
        wanted: true,
        detector: DetectorState::Ready(Arc::new(facts())),
        found: Some(Arc::new(found(vec![tomato(), banana(), hand()]))),
        rates: [rates].into(),
        counted: 120,
        ..DetectView::default()
    }
}

/// The Live screen with pictures and this detection.
pub fn live(detect: DetectView) -> View {
    let picture = picture();
    let raw = StereoFrame {
        stamp: stamp(),
        left: picture.clone(),
        right: picture,
        time_difference_s: None,
        name: None,
        beside: Default::default(),
    };
    View {
        source: Arc::new(SourceView {
            description: "made-up eyes".to_owned(),
            status: SourceStatus::Running,
            ..SourceView::default()
        }),
        live: Arc::new(LiveView { raw: Some(raw), ..LiveView::default() }),
        detect: Arc::new(detect),
        ..crate::made_up::everything()
    }
}
