//! How high the finger stays above the glass.

use std::sync::Arc;

use plumbline_effects::RobotModel;
use plumbline_effects::rig_model::Conditions;
use plumbline_model::Pixel;
use plumbline_model::robot::Posture;
use plumbline_model::touch_plan::{PlanOptions, Side, TouchArea};
use plumbline_model::{Point, Robot, Unattended};

use super::command::Correction;
use super::plan::{self, Corrector, PlanRequest, TIP};
use super::testing::rig;
use crate::motion::{Planner, ScreenPlace, TouchPath, Wanted};
use crate::rig_models::made_up::model_with;

/// Rounding of inverse kinematics, m.
const ROUNDING_M: f64 = 2e-4;

fn planner(place: ScreenPlace) -> Planner {
    Planner::new(&rig(), TIP, place).expect("it can point at the screen")
}

/// Height of the tip above the glass.
fn height_m(planner: &Planner, posture: &Posture) -> f64 {
    let tip = planner.chain().robot_from_tip_in(posture).translation_m();
    planner.rig().touchscreen.height_above_m(Point::<Robot>::new(tip.x, tip.y, tip.z))
}

fn touches(planner: &Planner) -> Vec<TouchPath> {
    let mut from = planner.ready(&planner.rig().home());
    let places = [
        ([950.0, 550.0], Side::Above),
        ([1250.0, 820.0], Side::Left),
        ([1000.0, 800.0], Side::Right),
        ([1280.0, 520.0], Side::Above),
    ];
    let plan = |([u_px, v_px], side): ([f64; 2], Side)| {
        let target = Pixel::new(u_px, v_px);
        let sent = planner.rig().touchscreen.point_at(target);
        let path = planner.plan(&Wanted::straight(target, sent, side), &from).expect("in reach");
        from = path.above().clone();
        path
    };
    places.into_iter().map(plan).collect()
}

#[test]
fn the_finger_stays_higher_until_the_screen_was_measured_and_touches_alike() {
    let (nominal, measured) = (planner(ScreenPlace::Nominal), planner(ScreenPlace::Measured));
    for (high, low) in touches(&nominal).iter().zip(touches(&measured)) {
        assert!((height_m(&nominal, high.above()) - 0.06).abs() < ROUNDING_M);
        assert!((height_m(&measured, low.above()) - 0.04).abs() < ROUNDING_M);
        // The posture at the contact, how it is come to and what follows depend on the place alone.
        assert_eq!((&high.contact, high.heading_rad), (&low.contact, low.heading_rad));
        assert_eq!((high.upright, &high.direction), (low.upright, &low.direction));
        let last = low.lower.len() - 2;
        assert_eq!(high.lower[high.lower.len() - last..], low.lower[low.lower.len() - last..]);
    }
}

#[test]
fn on_the_way_the_finger_stays_two_centimeters_below_where_it_waits_or_higher() {
    for (place, least_m) in [(ScreenPlace::Nominal, 0.04), (ScreenPlace::Measured, 0.02)] {
        let planner = planner(place);
        let touches = touches(&planner);
        for (before, next) in touches.iter().zip(&touches[1..]) {
            let mut from = before.above();
            for to in &next.approach {
                let heights = (0..=40).map(|i| height_m(&planner, &from.toward(to, f64::from(i) / 40.0)));
                let lowest_m = heights.fold(f64::INFINITY, f64::min);
                assert!(lowest_m > least_m - ROUNDING_M, "{place:?}: {lowest_m}");
                from = to;
            }
        }
    }
}

#[test]
fn staying_higher_costs_no_target_of_the_default_plans() {
    let rig = rig();
    let area = TouchArea::reached_by(&rig, TIP).expect("a tip").expect("it reaches a part");
    let rich = PlanOptions::rich(area);
    for (name, options) in [("first", PlanOptions::first(area)), ("rich", rich)] {
        let of = |place| {
            let request =
                PlanRequest { rig: rig.clone(), place, options: options.clone(), corrector: Corrector::None };
            plan::make(&request, &Unattended).expect("a plan")
        };
        let (high, low) = (of(ScreenPlace::Nominal), of(ScreenPlace::Measured));
        eprintln!(
            "{name}: {} of {} touched from 60 mm in {:.0} s, {} from 40 mm in {:.0} s",
            high.reachable(),
            high.touches.len(),
            high.duration_s,
            low.reachable(),
            low.duration_s
        );
        for (high, low) in high.touches.iter().zip(&low.touches) {
            assert_eq!(high.posture, low.posture, "{:?}", high.touch);
        }
    }
}

#[test]
fn where_the_arm_does_not_get_so_high_it_waits_as_high_as_it_gets() {
    let raised = Arc::new(plan::raised(&rig(), 0.12));
    let planner = |place| Planner::new(&raised, TIP, place).expect("it can point at the screen");
    let (nominal, measured) = (planner(ScreenPlace::Nominal), planner(ScreenPlace::Measured));
    let from = nominal.ready(&raised.home());
    let (mut full, mut less, mut lost) = (0, 0, 0);
    for i in 0..24_u32 {
        for j in 0..14_u32 {
            let target = Pixel::new(40.0 + 80.0 * f64::from(i), 40.0 + 77.0 * f64::from(j));
            let sent = raised.touchscreen.point_at(target);
            let of =
                |planner: &Planner| planner.plan(&Wanted::straight(target, sent, Side::Above), &from).ok();
            match (of(&nominal), of(&measured)) {
                (Some(high), _) => {
                    let height_m = height_m(&nominal, high.above());
                    assert!((0.04 - ROUNDING_M..0.06 + ROUNDING_M).contains(&height_m), "{height_m}");
                    if height_m < 0.06 - ROUNDING_M { less += 1 } else { full += 1 }
                }
                (None, Some(_)) => lost += 1,
                (None, None) => {}
            }
        }
    }
    eprintln!(
        "on a block of 120 mm: {full} from 60 mm, {less} from less, {lost} only from 40 mm without need"
    );
    assert!(full > 20 && less > 0 && lost == 0, "{full} {less} {lost}");
}

/// A model that knows that the arm errs sends the tip beside its place. Nothing is in its way then but what is
/// in the way of the tip at its place.
#[test]
fn what_the_arm_must_not_meet_is_looked_at_where_the_tip_will_be_not_where_it_is_sent() {
    let planner = planner(ScreenPlace::Measured);
    let (screen, from) = (&planner.rig().touchscreen, planner.ready(&planner.rig().home()));
    for (u_px, v_px) in [(950.0, 550.0), (1250.0, 820.0), (1000.0, 800.0)] {
        let target = Pixel::new(u_px, v_px);
        let straight = Wanted::straight(target, screen.point_at(target), Side::Above);
        let place = straight.place.coords;
        for beside_m in [[0.0, 0.0, -0.03], [0.012, -0.01, -0.025], [0.0, 0.0, 0.02]] {
            let sent = Point::new(place.x + beside_m[0], place.y + beside_m[1], place.z + beside_m[2]);
            let wanted = Wanted { sent, ..straight };
            let path = planner.plan(&wanted, &from).expect("the tip ends on the glass");
            let tip_m = |posture: &Posture| planner.chain().robot_from_tip_in(posture).translation_m().z;
            assert!((tip_m(&path.contact) - sent.coords.z).abs() < ROUNDING_M);
            assert!(
                (tip_m(path.above()) - sent.coords.z - 0.04).abs() < ROUNDING_M,
                "as high above as always"
            );
            let lowest_m = tip_m(path.lower.last().expect("a way down"));
            assert!((sent.coords.z - lowest_m - 0.012).abs() < 0.004, "as far down as always: {lowest_m}");
            // The same point, with nothing known of the arm, is inside of what it must not meet.
            let unknown = planner.plan(&Wanted::straight(target, sent, Side::Above), &from);
            if beside_m[2] < 0.0 {
                let why = unknown.expect_err("it is below the glass").to_string();
                assert!(why.contains("meet the touchscreen") || why.contains("low enough"), "{why}");
            }
        }
        let deep = planner.plan(&straight.deeper(0.024), &from).expect("it goes deeper");
        let usual = planner.plan(&straight, &from).expect("in reach");
        assert_eq!((&deep.contact, deep.above()), (&usual.contact, usual.above()), "from as high");
        let lowest_m = |path: &TouchPath| path.lower_tip.last().expect("a way down").coords.z;
        assert!((lowest_m(&usual) - lowest_m(&deep) - 0.024).abs() < 0.0021);
        let far = planner.plan(&straight.deeper(0.05), &from).expect_err("no arm errs so much").to_string();
        assert!(far.contains("50 mm beside"), "{far}");
        let nan = Wanted { place: Point::new(f64::NAN, 0.0, 0.0), ..straight };
        assert!(planner.plan(&nan, &from).is_err());
    }
}

/// Inverse kinematics with the effects of the model in use: the arm that has them ends on the pixels.
#[test]
fn touches_are_sent_where_the_arm_with_its_effects_ends_on_the_pixel() {
    let rig = rig();
    let area = TouchArea { u_px: [900.0, 1300.0], v_px: [500.0, 850.0] };
    let request = |corrector| PlanRequest {
        rig: rig.clone(),
        place: ScreenPlace::Nominal,
        options: PlanOptions::check_reach(area, 8, 1),
        corrector,
    };
    let nominal = Corrector::Effects(Arc::new(RobotModel::nominal(rig.clone())));
    let refused = plan::make(&request(nominal), &Unattended).expect_err("no effects").to_string();
    assert!(refused.contains("No effect is in the model"), "{refused}");
    let model =
        model_with(&rig, &[("joint-zero", "r_elbow_y", &[0.03]), ("joint-sag", "r_shoulder_y", &[0.02])]);
    let known = RobotModel::new(rig.clone(), Arc::new(model.clone())).expect("it fits");
    let effects = Corrector::Effects(Arc::new(known));
    let plan = plan::make(&request(effects), &Unattended).expect("planned");
    assert_eq!(plan.model, "with 2 effects");
    assert_eq!(plan.corrected_with, Some(Correction::Effects));
    let arm = model.arm(&rig, TIP).expect("a tip");
    let chain = rig.chain(TIP).expect("a tip");
    let (screen, mut touched) = (&rig.touchscreen, 0);
    for aim in &plan.touches {
        let Some(posture) = &aim.posture else { continue };
        let conditions = Conditions { payload_kg: aim.touch.payload_kg, ..Conditions::default() };
        let at = arm.touch_m(&posture.of(chain.joints()), aim.touch.screen_height_m, &conditions);
        let ([u_m, v_m], middle) = (screen.pitch_m(), screen.middle());
        let (target_u_m, target_v_m) =
            ((aim.touch.target.u_px - middle.u_px) * u_m, (aim.touch.target.v_px - middle.v_px) * v_m);
        let off_m = (at.x - target_u_m).hypot(at.y - target_v_m).hypot(at.z);
        assert!(off_m < 1e-4, "{:.3} mm", off_m * 1e3);
        assert!(aim.sent().distance_m(&aim.place()) > 2e-3, "it was sent elsewhere");
        touched += 1;
    }
    assert!(touched >= 6, "{touched} of 8");
}

/// What the effects are worth is told by touches of the same places without them.
#[test]
fn places_are_sent_as_the_robot_is_described_beside_what_the_effects_say() {
    let rig = rig();
    let area = TouchArea { u_px: [900.0, 1300.0], v_px: [500.0, 850.0] };
    let model = model_with(&rig, &[("joint-zero", "r_elbow_y", &[0.03])]);
    let known = RobotModel::new(rig.clone(), Arc::new(model)).expect("it fits");
    let request = PlanRequest {
        rig: rig.clone(),
        place: ScreenPlace::Nominal,
        options: PlanOptions::prove(area, 5, 1),
        corrector: Corrector::Effects(Arc::new(known)),
    };
    let plan = plan::make(&request, &Unattended).expect("planned");
    assert_eq!(plan.touches.len(), 10);
    for (number, pair) in plan.touches.chunks(2).enumerate() {
        let [described, corrected] = pair else { panic!("an odd number") };
        assert_eq!(described.touch.number, 2 * number + 1);
        assert_eq!(described.touch.target, corrected.touch.target);
        assert!(described.touch.as_described && !corrected.touch.as_described);
        assert_eq!(described.sent_m, described.place_m, "as described it is sent to the pixel itself");
        assert!(corrected.sent().distance_m(&corrected.place()) > 2e-3, "it was sent elsewhere");
        assert_ne!(described.touch.group, corrected.touch.group, "other commands are no repeats");
    }
    let kept = serde_json::to_string(&plan).expect("a plan is kept");
    assert_eq!(serde_json::from_str::<plan::RunPlan>(&kept).expect("read again").touches, plan.touches);
}

/// An arm that sank onto the table is named with the way out: no smaller area would help.
#[test]
fn what_lies_in_the_way_is_named_with_what_brings_it_away() {
    let planner = planner(ScreenPlace::Nominal);
    let rig = rig();
    let from = planner.ready(&rig.home());
    let target = Pixel::new(1000.0, 700.0);
    let wanted = Wanted::straight(target, planner.rig().touchscreen.point_at(target), Side::Above);
    assert!(planner.plan(&wanted, &from).is_ok(), "from where it waits it can be touched");
    let left = &rig.arm("left").expect("there is one").joints;
    let mut said = vec![];
    for fraction in [0.2, 0.4, 0.6, 0.8, 1.0] {
        // As a limp arm sinks: the joints go from home to zero, where it hangs down.
        let hanging = from.with(left, &vec![0.0; left.len()]);
        if let Err(why) = planner.plan(&wanted, &from.toward(&hanging, fraction)) {
            said.push(why.to_string());
        }
    }
    let named = said.iter().find(|why| why.contains("where it stands"));
    let named = named.unwrap_or_else(|| panic!("{said:#?}"));
    assert!(named.contains("left") && named.contains("Show the way home"), "{named}");
    assert!(said.iter().all(|why| !why.contains("smaller area")), "{said:#?}");
}
