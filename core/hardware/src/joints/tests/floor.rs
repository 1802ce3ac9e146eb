//! What stops an arm above the floor, and how far what is known of its hand moves that.

use super::*;

/// Postures of the right arm all over its limits.
fn drawn(rig: &Rig) -> Vec<Posture> {
    let home = rig.home();
    let arm = rig.arm("right").expect("it has one");
    let posture = |i: u32| {
        let part = |k: u32| f64::from((i * (2 * k + 3) * 7919 + k * 104_729) % 1000) / 1000.0;
        let angles: Vec<f64> = (0u32..)
            .zip(&arm.joints)
            .map(|(k, j)| rig.limits(*j).lower_rad + part(k) * rig.limits(*j).span_rad())
            .collect();
        home.with(&arm.joints, &angles)
    };
    (0..400).map(posture).collect()
}

fn lowest_m(floor: &FloorGuard, posture: &Posture) -> f64 {
    floor.lowest(posture).expect("it has parts").1
}

/// The lowest points of the arm behind the hand and of the hand, m.
fn arm_and_hand_m(floor: &FloorGuard, posture: &Posture) -> [f64; 2] {
    // A hand a meter higher or lower is never, or always, what lies lowest.
    let with_hand = |down_m: f64| floor.lowest_shifted(posture, down_m).expect("it has parts").1;
    [with_hand(-1.0), with_hand(1.0) + 1.0]
}

fn is_hand(floor: &FloorGuard, posture: &Posture) -> bool {
    let [arm_m, hand_m] = arm_and_hand_m(floor, posture);
    hand_m < arm_m - 0.01
}

#[test]
fn the_floor_refuses_what_goes_below_and_lets_out_who_is_there() {
    let rig = nico();
    let floor = FloorGuard::new(&rig);
    let drawn = drawn(&rig);
    let height_m = |posture: &&Posture| lowest_m(&floor, posture);
    let above = drawn.iter().find(|p| height_m(p) > rig.gate.floor_m + 0.05).expect("one above");
    let deep = drawn.iter().min_by(|a, b| height_m(a).total_cmp(&height_m(b))).expect("some");
    assert!(height_m(&deep) < rig.gate.floor_m - 0.02, "one below");
    let refused = floor.check(above, deep).expect_err("below the floor");
    assert!(refused.to_string().contains("mm below the floor"), "{refused}");
    // From below upward, in small steps, and never further down.
    let up = deep.toward(above, 0.02);
    let (first, second) = if height_m(&&up) > height_m(&deep) { (deep, &up) } else { (&up, deep) };
    assert!(floor.check(first, second).is_ok());
    assert!(height_m(&second) < height_m(&first) + 1e-3 || floor.check(second, first).is_err());
    assert!(floor.check(above, above).is_ok());
}

#[test]
fn a_hand_known_to_stand_higher_goes_lower_and_one_known_to_stand_lower_does_not() {
    let rig = nico();
    let (floor, floor_m) = (FloorGuard::new(&rig), rig.gate.floor_m);
    let drawn = drawn(&rig);
    let height_m = |posture: &&Posture| lowest_m(&floor, posture);
    let above = drawn.iter().find(|p| height_m(p) > floor_m + 0.05).expect("one above");
    let below = drawn.iter().filter(|p| height_m(p) < floor_m - 0.02 && is_hand(&floor, p));
    let little = below.max_by(|a, b| height_m(a).total_cmp(&height_m(b))).expect("a hand below");
    let down_m = floor_m - height_m(&little);
    assert!(down_m < FARTHEST_FLOOR_M - 1e-3, "the least deep one is {down_m} below");

    let shift = FloorShift::default();
    let shifted = FloorGuard::new(&rig).shifted_by(shift.clone());
    for (up_m, passes) in
        [(0.0, false), (-down_m - 1e-3, true), (1e-3 - down_m, false), (-1.0, false), (f64::NAN, false)]
    {
        shift.set_m(up_m);
        assert_eq!(shifted.check(above, little).is_ok(), passes, "{up_m}");
    }
    assert!(floor.check(above, little).is_err(), "another guard is not shifted");

    shift.set_m(down_m);
    let stands_low = |posture: &Posture| (floor_m..floor_m + down_m - 1e-3).contains(&height_m(&posture));
    let just_above = (1..200)
        .map(|i| little.toward(above, f64::from(i) / 200.0))
        .find(|posture| is_hand(&floor, posture) && stands_low(posture))
        .expect("a hand a little above the floor");
    assert!(floor.check(above, &just_above).is_ok() && shifted.check(above, &just_above).is_err());
}

#[test]
fn of_the_arm_behind_the_hand_nobody_knows_how_far_it_is_off() {
    let rig = nico();
    let floor = FloorGuard::new(&rig);
    let drawn = drawn(&rig);
    let hand_above_arm_m = |posture: &&Posture| {
        let [arm_m, hand_m] = arm_and_hand_m(&floor, posture);
        hand_m - arm_m
    };
    let height_m = |posture: &&Posture| lowest_m(&floor, posture);
    let by_height = |a: &&Posture, b: &&Posture| height_m(a).total_cmp(&height_m(b));
    let raised_hands = drawn.iter().filter(|posture| hand_above_arm_m(posture) > FARTHEST_FLOOR_M + 0.01);
    let elbow_down = raised_hands.min_by(by_height).expect("a raised hand");
    let above = drawn.iter().max_by(by_height).expect("some posture");
    // No elbow reaches down to the floor of this robot, so the floor comes up to the elbow.
    let elbow_m = lowest_m(&floor, elbow_down);
    let shift = FloorShift::default();
    for (floor_m, passes) in [(elbow_m + 0.01, false), (elbow_m - 0.01, true)] {
        let mut raised = (*rig).clone();
        raised.gate.floor_m = floor_m;
        assert!(height_m(&above) > floor_m, "an arm that is raised");
        let shifted = FloorGuard::new(&raised).shifted_by(shift.clone());
        for up_m in [0.0, -FARTHEST_FLOOR_M, FARTHEST_FLOOR_M] {
            shift.set_m(up_m);
            assert_eq!(shifted.check(above, elbow_down).is_ok(), passes, "{up_m} over {floor_m}");
        }
    }
}
