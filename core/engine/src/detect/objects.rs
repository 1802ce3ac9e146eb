//! From boxes in two eyes to objects: what belongs together, and where it is.

use std::panic::AssertUnwindSafe;
use std::sync::Arc;

use plumbline_effects::PlaceInRobot;
use plumbline_grasp::outline::Boxes;
use plumbline_grasp::stands::{self, Stands};
use plumbline_grasp::things::Thing;
use plumbline_model::detection::{ClassIndex, ClassNames, Detection, PixelBox};
use plumbline_model::spread::NORMAL_95;
use plumbline_model::{AimedPair, Eye, Pixel, Raw, Rectified, StereoCalibration, StereoFrame};
use plumbline_vision::detect_places::{
    Estimate, ObjectPlace, Place, PlaceFinder, PlaceOptions, RangeFrom, Seen,
};

use super::view::{NoObjectPlace, ObjectPlaceView, ObjectView, SeenBox};
use crate::ground::jobs::panic_message;
use crate::ground::text::sentence;
use crate::live::{LiveSetup, NoSetup, fitting};

/// Points along each edge of a box that are taken over to the rectified image: straight edges are
/// bent by the lens.
const POINTS_PER_EDGE: usize = 8;

/// Finds objects pair by pair; keeps what it knows of the calibration, and working memory.
#[derive(Default)]
pub struct Objects {
    finder: Option<(Option<Arc<StereoCalibration>>, ClassNames, PlaceFinder)>,
    places: Vec<ObjectPlace>,
    curve: Vec<Pixel<Raw>>,
}

/// What the boxes of a pair are.
#[derive(Clone, Debug)]
pub struct FoundObjects {
    /// For the window, the surest first.
    pub objects: Vec<ObjectView>,
    /// The same as they were found.
    pub places: Vec<ObjectPlace>,
    /// Why none of them has a place, a sentence.
    pub no_places_because: Option<String>,
}

/// A defect of this program, met while objects were placed; the message of its panic.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("Places of objects: this program made a mistake ({0}). Please report it with the journal.")]
pub struct Defect(pub String);

impl Objects {
    /// What the boxes of a pair are. A panic inside is returned as a defect.
    ///
    /// # Errors
    /// What the program said when it met a defect of its own.
    pub fn find(
        &mut self,
        frame: &StereoFrame,
        setup: Result<&Arc<LiveSetup>, &NoSetup>,
        names: &ClassNames,
        boxes: [&[Detection]; 2],
    ) -> Result<FoundObjects, Defect> {
        let setup = usable(frame, setup);
        let work = AssertUnwindSafe(|| self.look(frame, setup.as_ref().copied(), names, boxes));
        let mut objects = std::panic::catch_unwind(work).map_err(|panic| {
            // What it kept may be half changed.
            self.finder = None;
            Defect(panic_message(panic.as_ref()))
        })?;
        let no_places_because = setup.err().map(|why| why.to_string());
        objects.sort_by(|a, b| b.confidence().total_cmp(&a.confidence()));
        Ok(FoundObjects { objects, places: self.places.clone(), no_places_because })
    }

    fn look(
        &mut self,
        frame: &StereoFrame,
        setup: Result<&Arc<LiveSetup>, &NoObjectPlace>,
        names: &ClassNames,
        [left, right]: [&[Detection]; 2],
    ) -> Vec<ObjectView> {
        let calibration = setup.ok().map(|setup| &setup.calibration);
        let known = self.finder.take().filter(|(of, of_names, _)| {
            let same = match (of, calibration) {
                (Some(of), Some(calibration)) => Arc::ptr_eq(of, calibration),
                (None, None) => true,
                _ => false,
            };
            same && of_names == names
        });
        let (.., finder) = self.finder.insert(known.unwrap_or_else(|| {
            let options = PlaceOptions::for_classes(names);
            let finder = PlaceFinder::new(calibration.map(|calibration| &**calibration), options);
            (calibration.cloned(), names.clone(), finder)
        }));
        finder.find((&frame.left, left), (&frame.right, right), &mut self.places);
        let curve = &mut self.curve;
        let mut seen_box = |eye: Eye, found: &Detection| {
            finder.epipolar_curve(eye, found.area.middle(), curve);
            let rectified = setup.ok().map(|setup| rectified_outline(&setup.pair, eye, &found.area));
            SeenBox {
                confidence: found.confidence,
                area: found.area,
                rectified: rectified.unwrap_or_default().into(),
                line_in_other: curve.as_slice().into(),
            }
        };
        let mut view = |object: &ObjectPlace| {
            let mut of = |eye, boxes: &[Detection]| {
                object.seen.index(eye).and_then(|i| boxes.get(i)).map(|found| seen_box(eye, found))
            };
            let (left, right) = (of(Eye::Left, left), of(Eye::Right, right));
            object_view(object, names, left, right, setup)
        };
        self.places.iter().map(&mut view).collect()
    }
}

/// What places rest on, where it is for images of this size.
fn usable<'a>(
    frame: &StereoFrame,
    setup: Result<&'a Arc<LiveSetup>, &NoSetup>,
) -> Result<&'a Arc<LiveSetup>, NoObjectPlace> {
    let setup = setup.map_err(NoSetup::clone)?;
    fitting(frame, &setup.pair.cameras)?;
    Ok(setup)
}

fn object_view(
    object: &ObjectPlace,
    names: &ClassNames,
    left: Option<SeenBox>,
    right: Option<SeenBox>,
    setup: Result<&Arc<LiveSetup>, &NoObjectPlace>,
) -> ObjectView {
    let (epipolar_px, alone_because) = match &object.seen {
        Seen::Both { epipolar_px, .. } => (Some(*epipolar_px), None),
        Seen::One { why, .. } => (None, Some(sentence(&why.to_string()))),
    };
    // Without a setup that is why, whatever the boxes say.
    let alone_because = setup.err().map(ToString::to_string).or(alone_because);
    let place = object.place.as_ref();
    let name = class_name(names, object.class);
    let stands =
        place.ok().zip(setup.ok()).and_then(|(place, setup)| stands(place, setup, &name, [&left, &right]));
    let mut doubts = doubts(object, names);
    doubts.extend(stands.and_then(|stands| other_size(&stands, &name)));
    let stands = stands.zip(setup.ok()).map(|(stands, setup)| place_view(&stands.place, setup));
    let in_robot = match (place, setup) {
        (_, Err(why)) => Err(why.clone()),
        (Err(why), _) => Err((*why).into()),
        (Ok(place), Ok(setup)) => {
            let found = setup.place(&place.middle.point, &place.middle.covariance_m2);
            found.map(|found| place_view(&found, setup)).map_err(NoObjectPlace::from)
        }
    };
    ObjectView {
        class: object.class,
        name,
        left,
        right,
        epipolar_px,
        alone_because,
        place: in_robot,
        stands,
        voted: place.map(|place| place.votes.cells().collect()).unwrap_or_default(),
        leak: place.ok().and_then(leak),
        doubts,
    }
}

/// Where it stands on the table, if its shape is known.
fn stands(place: &Place, setup: &LiveSetup, name: &str, seen: [&Option<SeenBox>; 2]) -> Option<Stands> {
    let boxes_px = seen.map(|seen| {
        let PixelBox { x0_px, y0_px, x1_px, y1_px } = seen.as_ref()?.area;
        Some([x0_px, y0_px, x1_px, y1_px])
    });
    let boxes = Boxes { boxes_px: &boxes_px, posture: &setup.posture, under: setup.seen_under() };
    let Estimate { point, covariance_m2, .. } = &place.middle;
    stands::place(&setup.model, &Thing::of_class(name)?, &boxes, point, covariance_m2)
}

/// That it is no toy as it is known.
fn other_size(stands: &Stands, name: &str) -> Option<String> {
    let by = stands.larger_by()?;
    let (share, size) = (100.0 * by.abs(), if by > 0.0 { "larger" } else { "smaller" });
    let (half, class) = (100.0 * NORMAL_95 * stands.scale_sigma, name.to_lowercase());
    Some(format!(
        "It is {share:.0} ± {half:.0} % {size} than the {class} that is known: another toy, something else that is \
         taken for one, or a part of it is hidden. Its place and its height go by the size that is seen."
    ))
}

/// Where the middle of an object is by the model in use.
fn place_view(found: &PlaceInRobot, setup: &LiveSetup) -> ObjectPlaceView {
    let (range_m, range_sigma_m) = found.range_m(&setup.robot_from_left().translation_m());
    ObjectPlaceView {
        point_in_robot: found.point,
        sigma_m: [0, 1, 2].map(|i| found.covariance_m2[(i, i)].max(0.0).sqrt()),
        wide_because: setup.wide_because(),
        covariance_m2: found.covariance_m2,
        range_m,
        range_sigma_m,
        model: setup.title.clone(),
    }
}

/// What lies behind and was kept out.
fn leak(place: &Place) -> Option<String> {
    let leak = place.leak?;
    let side = if leak.behind_m >= 0.0 { "behind" } else { "in front of" };
    Some(format!(
        "{:.0} % of its box lies {:.0} mm {side} it and does not count: a place from all of the box would be {:.0} mm off.",
        100.0 * leak.share,
        1e3 * leak.behind_m.abs(),
        1e3 * leak.median_off_m.abs(),
    ))
}

fn doubts(object: &ObjectPlace, names: &ClassNames) -> Vec<String> {
    let mut doubts = Vec::new();
    if let Seen::Both { eyes_disagree: Some([left, right]), .. } = object.seen {
        let [left, right] = [left, right].map(|class| class_name(names, class));
        doubts.push(format!("The left eye calls it {left}, the right eye {right}."));
    }
    let Ok(place) = &object.place else { return doubts };
    if let Some(disagreement) = place.disagreement {
        let side = if disagreement.by_m >= 0.0 { "farther" } else { "nearer" };
        doubts.push(format!(
            "Its pixels say {:.0} mm {side} than its boxes do ({:.1} standard deviations): it may be hidden in part from one eye.",
            1e3 * disagreement.by_m.abs(),
            disagreement.sigmas.abs(),
        ));
    }
    if place.from == RangeFrom::BoxesAlone {
        doubts.push("Too few of its pixels could be matched: the place rests on its boxes alone.".to_owned());
    }
    doubts
}

fn class_name(names: &ClassNames, class: ClassIndex) -> String {
    names.get(class).map_or_else(|| format!("class {}", class.0), str::to_owned)
}

/// The outline of a box on the rectified image; empty where any of it cannot be seen there, or
/// nothing of it lies on the image.
fn rectified_outline(pair: &AimedPair, eye: Eye, area: &PixelBox) -> Vec<Pixel<Rectified>> {
    let outline: Result<Vec<_>, _> = outline(area).map(|pixel| pair.rectified_from_raw(eye, pixel)).collect();
    let on_image =
        |outline: &Vec<Pixel<Rectified>>| outline.iter().any(|pixel| pixel.is_inside(pair.size_px()));
    outline.ok().filter(on_image).unwrap_or_default()
}

/// Along the edges, clockwise from the top left.
fn outline(area: &PixelBox) -> impl Iterator<Item = Pixel<Raw>> {
    let edge = |value: f32| f64::from(value) - 0.5;
    let (x0, y0, x1, y1) = (edge(area.x0_px), edge(area.y0_px), edge(area.x1_px), edge(area.y1_px));
    let corners = [[x0, y0], [x1, y0], [x1, y1], [x0, y1]];
    (0..4).flat_map(move |i| {
        let (from, to) = (corners[i], corners[(i + 1) % 4]);
        (0..POINTS_PER_EDGE).map(move |step| {
            let part = step as f64 / POINTS_PER_EDGE as f64;
            Pixel::new(from[0] + part * (to[0] - from[0]), from[1] + part * (to[1] - from[1]))
        })
    })
}
