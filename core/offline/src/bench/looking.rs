//! How long it takes from a pair of images to joint targets: a toy on the twin's table, seen by the
//! detector that comes with the program.

use std::sync::Arc;
use std::time::{Duration, Instant};

use plumbline_effects::RobotModel;
use plumbline_grasp::plan::{GraspPlanner, Standing};
use plumbline_grasp::see::Looker;
use plumbline_grasp::things::Thing;
use plumbline_grasp::{Corrections, Knowledge, PalmArm, Sight};
use plumbline_model::robot::{Posture, Rig};
use plumbline_model::{Eye, StereoCalibration};
use plumbline_twin::eyes::{EyeOptions, EyeRenderer, RenderedPair, Sensor};
use plumbline_twin::{Toy, Twin, TwinCommand};
use plumbline_vision::detect::{
    DetectError, DetectSettings, DetectTiming, DetectorOptions, EyesDetector, Part, ShippedDetector,
    shipped_detector,
};
use plumbline_vision::detect_places::{PlaceFinder, PlaceOptions};

use super::Figure;

/// Pairs that are looked at.
const ROUNDS: usize = 15;
/// Where the toy is put, robot frame, m.
const PLACE_M: [f64; 2] = [0.36, -0.08];
/// Both eyes with places may take so long, ms…
const MOST_BOTH_MS: f64 = 75.0;
/// …and all from the images to joint targets, ms.
const MOST_TO_TARGETS_MS: f64 = 150.0;

/// All of them; what cannot be measured here says why.
pub fn figures(twin: &Twin, rig: &Arc<Rig>) -> Vec<Figure> {
    measured(twin, rig).unwrap_or_else(|why| vec![Figure::missing("from images to joint targets", why)])
}

fn measured(twin: &Twin, rig: &Arc<Rig>) -> Result<Vec<Figure>, String> {
    let pair = pair(twin)?;
    let shipped = shipped_detector().ok_or("no detector comes with this version")?;
    let mut figures = both_eyes(&shipped, rig, &pair)?;
    figures.extend(to_targets(&shipped, rig, &pair)?);
    Ok(figures)
}

/// What the twin sees of a tomato on its table.
fn pair(twin: &Twin) -> Result<RenderedPair, String> {
    let [x_m, y_m] = PLACE_M;
    twin.send(TwinCommand::PlaceObject { toy: Toy::Tomato, x_m, y_m });
    // It falls a little, and comes to rest.
    std::thread::sleep(Duration::from_secs(2));
    let (scenery, snapshot) = twin.scene().newest();
    let mut renderer = EyeRenderer::new(EyeOptions::default()).map_err(|error| error.to_string())?;
    renderer.render(&scenery, &snapshot, &Sensor::default(), 0).map_err(|error| error.to_string())
}

/// A way of looking at both eyes.
struct Way {
    name: &'static str,
    detector: EyesDetector,
    parts: [Part; 2],
    looks: Vec<Look>,
}

/// Where the time of one look went.
#[derive(Clone, Copy)]
struct Look {
    eyes: DetectTiming,
    places: Duration,
}

/// A part of that time.
type PartOfLook = fn(&Look) -> Duration;

impl Look {
    fn total(&self) -> Duration {
        self.eyes.total() + self.places
    }
}

impl Way {
    fn quickest_ms(&self, part: PartOfLook) -> f64 {
        self.looks.iter().map(part).min().map_or(f64::NAN, |time| time.as_secs_f64() * 1e3)
    }

    fn median_ms(&self, part: PartOfLook) -> f64 {
        median_ms(self.looks.iter().map(part).collect())
    }
}

/// Both eyes with pairing and places, in turn, so that another load of the machine counts for all: all of
/// the images, one eye after the other with all cores for each; both eyes at once, each on its own core,
/// on what is lit and on the workspace.
fn both_eyes(shipped: &ShippedDetector, rig: &Rig, pair: &RenderedPair) -> Result<Vec<Figure>, String> {
    let cameras = &rig.eyes.cameras;
    let workspace = rig.workspace(&rig.home());
    let size = pair.left.dimensions();
    let regions = Eye::BOTH.map(|eye| Part::of_workspace(cameras, &workspace, eye, size));
    let options = DetectorOptions::default();
    let one_by_one = || shipped.open(&options).map(EyesDetector::from);
    let at_once = || EyesDetector::open(&shipped.file, &options);
    let way = |name, detector: Result<EyesDetector, DetectError>, parts| {
        let detector = detector.map_err(|error| error.to_string())?;
        Ok::<_, String>(Way { name, detector, parts, looks: vec![] })
    };
    let mut ways = [
        way("all of the images, one eye after the other", one_by_one(), [Part::Whole; 2])?,
        way("what is lit, both eyes at once", at_once(), [Part::Lit; 2])?,
        way("the workspace, both eyes at once", at_once(), regions)?,
    ];
    let places = PlaceOptions::for_classes(&ways[0].detector.info().names);
    let mut finder = PlaceFinder::new(Some(&StereoCalibration::bare(*cameras)), places);
    let (settings, [mut left, mut right], mut found) = (DetectSettings::default(), [vec![], vec![]], vec![]);
    for round in 0..=ROUNDS {
        for Way { detector, parts, looks, .. } in &mut ways {
            let looked =
                detector.detect_in([&pair.left, &pair.right], *parts, &settings, [&mut left, &mut right]);
            let eyes = looked.map_err(|error| error.to_string())?.passed();
            let begun = Instant::now();
            finder.find((&pair.left, &left), (&pair.right, &right), &mut found);
            if round > 0 {
                looks.push(Look { eyes, places: begun.elapsed() });
            }
        }
    }
    let [before, lit, workspace] = &ways;
    let whole_ms = before.quickest_ms(Look::total);
    let mut figures = vec![total(before, whole_ms)];
    figures.extend([lit, workspace].map(|way| total(way, whole_ms).at_most(MOST_BOTH_MS)));
    figures.extend([before, workspace].into_iter().flat_map(stages));
    Ok(figures)
}

/// All of a way's time, beside the time for all of the images.
fn total(way: &Way, whole_ms: f64) -> Figure {
    let quickest_ms = way.quickest_ms(Look::total);
    let ratio = quickest_ms / whole_ms;
    let what =
        format!("both eyes with places: {} (quickest {quickest_ms:.1} ms, ratio {ratio:.2})", way.name);
    Figure::new(what, way.median_ms(Look::total), "ms")
}

fn stages(way: &Way) -> Vec<Figure> {
    let stages: [(&str, PartOfLook); 4] = [
        ("letterbox", |look| look.eyes.before),
        ("network", |look| look.eyes.network),
        ("suppression", |look| look.eyes.after),
        ("pairing and places", |look| look.places),
    ];
    let figure = |(stage, part): (&str, PartOfLook)| {
        Figure::new(format!("  {}: {stage}", way.name), way.median_ms(part), "ms")
    };
    stages.map(figure).into()
}

/// From the images to the posture of the arm in which the palm is where it closes around the toy, and
/// to a grasp whose ways were found free.
fn to_targets(shipped: &ShippedDetector, rig: &Arc<Rig>, pair: &RenderedPair) -> Result<Vec<Figure>, String> {
    let model = RobotModel::nominal(rig.clone());
    let arm = rig.arms.first().ok_or("the rig has no arm")?;
    let palm = PalmArm::new(&model, &arm.name).map_err(|error| error.to_string())?;
    let knowledge = Knowledge {
        model,
        described: rig.clone(),
        calibration: Arc::new(StereoCalibration::bare(rig.eyes.cameras)),
        corrections: Corrections::default(),
    };
    let detector = EyesDetector::open(&shipped.file, &DetectorOptions::default());
    let detector = detector.map_err(|error| error.to_string())?;
    let mut looker = Looker::new(detector, &knowledge, DetectSettings::default());
    let posture = rig.home();
    let (left, right) = (Arc::new(pair.left.clone()), Arc::new(pair.right.clone()));
    let sight = Sight { left, right, posture: posture.clone(), at_s: 0.0, eyes_on_s: None, seq: 0 };
    let planner = GraspPlanner::new(palm.clone());
    let (mut seen, mut to_target, mut planned) = (vec![], vec![], vec![]);
    for round in 0..=ROUNDS {
        let begun = Instant::now();
        let standing = standing(&mut looker, &sight, &knowledge)?;
        let seen_after = begun.elapsed();
        target(&palm, &standing, &posture).ok_or("the hand does not get to the toy")?;
        let target_after = begun.elapsed();
        let plan = planner.plan(&standing, &nalgebra::Vector3::zeros(), &posture);
        let plan_after = begun.elapsed();
        plan.map_err(|why| why.to_string())?;
        if round > 0 {
            seen.push(seen_after);
            to_target.push(target_after);
            planned.push(plan_after);
        }
    }
    let quickest_ms = to_target.iter().min().map_or(f64::NAN, |time| time.as_secs_f64() * 1e3);
    let joints: Vec<Duration> = to_target.iter().zip(&seen).map(|(all, seen)| *all - *seen).collect();
    let what = "from images to joint targets: detection on the workspace, place, posture of the arm";
    let what = format!("{what} (quickest {quickest_ms:.1} ms)");
    Ok(vec![
        Figure::new(what, median_ms(to_target), "ms").at_most(MOST_TO_TARGETS_MS),
        Figure::new("  of that: from the place to the posture of the arm", median_ms(joints), "ms"),
        Figure::new("from images to a grasp whose ways were found free", median_ms(planned), "ms"),
    ])
}

fn standing(looker: &mut Looker, sight: &Sight, knowledge: &Knowledge) -> Result<Standing, String> {
    let thing = Thing::of_class("Tomato").ok_or("nothing is known of tomatoes")?;
    let seen = looker.look_at_table(sight, knowledge).map_err(|error| error.to_string())?;
    let tomato = seen.into_iter().find(|seen| seen.class == thing.class).ok_or("no tomato is seen")?;
    let point_m = tomato.place?.point_m;
    let xy_m = [point_m[0], point_m[1]];
    Ok(Standing {
        xy_m,
        support_m: knowledge.support_m(xy_m[0], xy_m[1]),
        height_m: thing.height_m,
        lower_m: 0.0,
    })
}

/// The posture in which the palm is where it closes, for the first heading with which it gets there.
fn target(palm: &PalmArm, standing: &Standing, from: &Posture) -> Option<Posture> {
    let heading_rad = |step: i32| f64::from(step) * 0.2;
    (0..16)
        .flat_map(|step| [heading_rad(step), heading_rad(-step)])
        .find_map(|heading_rad| palm.sent_to(standing.palm(heading_rad, palm.is_left()), heading_rad, from))
}

fn median_ms(mut times: Vec<Duration>) -> f64 {
    times.sort_unstable();
    times.get(times.len() / 2).map_or(f64::NAN, |time| time.as_secs_f64() * 1e3)
}

#[cfg(test)]
mod tests {
    use plumbline_model::measured_data;
    use plumbline_twin::{Scenario, TwinSettings};

    use super::*;

    #[test]
    fn a_toy_on_the_twins_table_is_a_target_of_the_arm() {
        let rig = Arc::new(Rig::built_in("nico").expect("comes with the program"));
        let scenario = Scenario::built_in("perfect").expect("comes with the program");
        let twin =
            Twin::start(TwinSettings { rig: rig.clone(), scenario, seed: 1, pace: 1.0 }).expect("starts");
        let pair = match pair(&twin) {
            Ok(pair) => pair,
            Err(why) => {
                measured_data::left_out(why);
                return;
            }
        };
        let shipped = shipped_detector().expect("comes with the program");
        let of_eyes = both_eyes(&shipped, &rig, &pair).expect("it looks");
        let ms: Vec<f64> = of_eyes.iter().filter_map(|figure| figure.value).collect();
        assert!(ms.len() == 11 && ms[1] < 0.9 * ms[0] && ms[2] < 0.6 * ms[0], "{of_eyes:?}");
        let to_targets = to_targets(&shipped, &rig, &pair).expect("it is reached");
        assert!(to_targets.iter().all(|figure| figure.value.is_some()), "{to_targets:?}");
        for figure in of_eyes.iter().chain(&to_targets) {
            eprintln!("{}: {:.1} {}", figure.what, figure.value.unwrap_or(f64::NAN), figure.unit);
        }
    }
}
