//! NICO's own numbers against the published check values, and broken files.

use nalgebra::{Isometry3, Vector3};

use super::*;
use crate::measured_data;
use crate::session::Session;

fn nico() -> Rig {
    Rig::built_in("nico").expect("the rig that comes with the program is valid")
}

/// Angles in the robot maker's "nicodegrees": degrees of the motor, wrists geared 2 and 4.
fn from_motor_degrees(degrees: [f64; 6]) -> [f64; 6] {
    let ratios = [1.0, 1.0, 1.0, 1.0, 2.0, 4.0];
    std::array::from_fn(|i| degrees[i].to_radians() / ratios[i])
}

fn assert_near(actual: Vector3<f64>, expected: [f64; 3]) {
    let error_m = (actual - Vector3::from(expected)).norm();
    assert!(error_m < 1e-4, "{actual:?} is {error_m} m from {expected:?}");
}

#[test]
fn the_palm_and_the_fingertip_are_where_the_published_software_has_them() {
    let rig = nico();
    let palm = rig.chain("right_palm_center").expect("a tip of the rig");
    let place = palm.robot_from_tip(&from_motor_degrees([-10.0, 87.0, 88.0, 87.0, 2.0, -29.0]));
    assert_near(place.translation_m(), [0.0, -0.2954, 0.5180]);
    let finger = rig.chain("right_index_tip").expect("a tip of the rig");
    let place = finger.robot_from_tip(&from_motor_degrees([-25.0, 84.0, 47.0, 94.0, -59.0, 114.0]));
    assert_near(place.translation_m(), [0.0819, -0.2465, 0.5099]);
}

#[test]
fn logged_commands_reach_their_logged_targets() {
    let folder = match measured_data::folder("nico-touch/touch-245") {
        Ok(folder) => folder,
        Err(reason) => return eprintln!("{reason}"),
    };
    let session = Session::read(&folder).expect("a valid session");
    let table = session.touches.expect("touches");
    let rig = nico();
    let chain = rig.chain("right_index_tip").expect("a tip of the rig");
    let (mut squares, mut elsewhere) = (vec![], vec![]);
    for row in table.rows() {
        let target = row.target.expect("every row has its target").coords.coords;
        let commanded: Option<Vec<f64>> = row.commanded_rad.iter().copied().collect();
        let reached = chain.robot_from_tip(&commanded.expect("every command is logged")).translation_m();
        squares.push((reached - target).norm_squared());
        // In the far left corner, at the end of the arm's reach, the published solver stopped up to
        // 3.5 mm short, always toward the shoulder.
        if !(target.x > 0.4 && target.y > 0.1) {
            elsewhere.push((reached - target).norm_squared());
        }
    }
    let rms_m = |squares: &[f64]| (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
    let (rms_m, elsewhere_m) = (rms_m(&squares), rms_m(&elsewhere));
    eprintln!("{} commands, rms distance to their targets {:.3} mm", squares.len(), rms_m * 1e3);
    assert_eq!(squares.len(), 245);
    // Targets are logged in whole millimeters, which alone may leave 0.5 mm.
    assert!(elsewhere.len() == 226 && elsewhere_m < 0.00042, "{elsewhere_m}");
    assert!(rms_m < 0.00065, "{rms_m}");
}

#[test]
fn the_chain_and_the_tree_agree() {
    let rig = nico();
    let posture = rig.home();
    let links = rig.description.forward(&posture);
    for tip in ["right_palm_center", "left_palm_center", "right_index_tip", "left_index_tip", "mid_eyes"] {
        let link = rig.description.find_link(tip).expect("a link");
        let chain = rig.chain(tip).expect("a tip");
        let difference = links.of(link).isometry.inverse() * chain.robot_from_tip_in(&posture).isometry;
        assert!(
            (difference.to_homogeneous() - Isometry3::identity().to_homogeneous()).norm() < 1e-12,
            "{tip}"
        );
    }
}

#[test]
fn the_jacobian_is_the_derivative_of_the_place() {
    let rig = nico();
    let chain = rig.chain("right_palm_center").expect("a tip");
    let angles: Vec<f64> = chain
        .limits()
        .iter()
        .enumerate()
        .map(|(i, l)| l.lower_rad + l.span_rad() * (0.2 + 0.1 * i as f64))
        .collect();
    let (place, jacobian) = chain.jacobian(&angles);
    let step = 1e-6;
    for i in 0..chain.len() {
        let mut moved = angles.clone();
        moved[i] += step;
        let there = chain.robot_from_tip(&moved);
        let velocity = (there.translation_m() - place.translation_m()) / step;
        let turn = (there.isometry.rotation * place.isometry.rotation.inverse()).scaled_axis() / step;
        for row in 0..3 {
            assert!((velocity[row] - jacobian[(row, i)]).abs() < 1e-5);
            assert!((turn[row] - jacobian[(row + 3, i)]).abs() < 1e-5);
        }
    }
}

#[test]
fn looking_at_a_point_puts_it_on_the_optical_axis() {
    let rig = nico();
    let point = crate::Point::new(0.4, -0.15, 0.06);
    let (pan_rad, tilt_rad) = rig.look_at(point, &rig.home());
    let posture = rig.home().with(&[rig.eyes.pan, rig.eyes.tilt], &[pan_rad, tilt_rad]);
    let in_left = rig.robot_from_left(&posture).isometry.inverse() * point.coords;
    assert!(in_left.x.hypot(in_left.y) / in_left.z < 1e-6, "{in_left:?}");
}

#[test]
fn motor_and_joint_angles_invert_each_other_and_the_wrists_are_geared() {
    let rig = nico();
    for servo in &rig.servos {
        for motor_rad in [-1.0, 0.0, 0.7] {
            assert!((servo.motor_rad(servo.joint_rad(motor_rad)) - motor_rad).abs() < 1e-12);
        }
    }
    let servo = |id| rig.servos.iter().find(|servo| servo.id == id).expect("a servo of NICO");
    // Published: the elbow's user range of 50 to 181 degrees is −86 to 45 degrees of its motor.
    assert!((servo(5).joint_rad((-86f64).to_radians()) - 50f64.to_radians()).abs() < 1e-5);
    assert!((servo(6).joint_rad((-45f64).to_radians()) - 181f64.to_radians()).abs() < 1e-5);
    assert!((servo(31).joint_rad(1.0) + 0.5).abs() < 1e-12);
    assert!((servo(33).joint_rad(1.0) - 0.25).abs() < 1e-12);
}

#[test]
fn a_lowered_head_turns_less() {
    let rig = nico();
    let (pan, tilt) = (rig.eyes.pan, rig.eyes.tilt);
    let largest = |tilt_deg: f64| {
        let posture = rig.description.rest().with(&[tilt], &[tilt_deg.to_radians()]);
        rig.limits_in(pan, &posture).upper_rad.to_degrees()
    };
    assert!((largest(-30.0) - 33.0).abs() < 0.01);
    assert!((largest(-48.0) - 7.5).abs() < 0.01);
    assert!((largest(0.0) - 90.0).abs() < 0.02);
}

fn urdf() -> &'static str {
    include_str!("../../../../assets/robots/nico/nico.urdf")
}

fn rig_with(from: &str, to: &str) -> String {
    let text = include_str!("../../../../assets/robots/nico/rig.toml");
    assert!(text.contains(from), "{from}");
    let changed = text.replacen(from, to, 1);
    Rig::parse("rig.toml", &changed, |_| Ok(urdf().to_owned())).expect_err("must be refused").to_string()
}

#[test]
fn a_broken_rig_is_refused_with_a_sentence() {
    for (from, to, words) in [
        ("joint = \"head_z\"", "joint = \"neck_z\"", "no joint called neck_z"),
        ("id = 20", "id = 19", "two servos have the id 19"),
        ("id = 30", "id = 19", "the id 19 of another part"),
        ("height_m = 0.054", "height_m = nan", "not a number"),
        ("ratio = 2.0", "ratio = -2.0", "must be positive"),
        ("format = 1", "format = 2", "reads 1"),
        ("baud =", "bauds =", "bauds"),
        ("link = \"right_index_tip\"", "link = \"right_toe\"", "no link called right_toe"),
        ("r_arm_x = ", "r_arm_x = 9.0 # ", "outside of its limits"),
        ("height_m = 0.267", "height_m = 5.0", "touchscreen: 5 m cannot be a side of the visible area"),
        ("width_m = 0.475", "width_m = 475.0", "it looks like millimeters, where meters belong"),
        ("u_axis = [0.0, -1.0, 0.0]", "u_axis = [0.0, -1e308, 0.0]", "cannot be a component of a direction"),
        ("m = [-0.0699274", "m = [-69.9274", "eyes: 69.9274 m cannot be a distance between the eyes"),
        ("fx_px = 150.68417", "fx_px = 150684.17", "eyes.left: 150684.17 px cannot be a focal length"),
        ("side_m = 0.018", "side_m = -0.018", "a width is not negative"),
        (
            "turn_sd_rad = 0.003",
            "turn_sd_rad = 0.0",
            "outlines.body: shift_sd_m and turn_sd_rad say how well",
        ),
        ("[[0.055, 0.072, 0.235], [", "[[0.055, -0.072, 0.235], [", "each is at least 0.02 m long"),
        ("hot_c = 70.0", "hot_c = 70000.0", "gate: 70000 °C cannot be a temperature"),
        ("motor_upper_rad = 1.570796", "motor_upper_rad = 1e308", "cannot be a limit of a joint"),
    ] {
        let message = rig_with(from, to);
        assert!(message.contains(words), "{message}");
    }
}

#[test]
fn a_rig_file_without_outlines_is_read_and_nothing_is_measured_by() {
    let text = include_str!("../../../../assets/robots/nico/rig.toml");
    let (before, rest) = text.split_once("[outlines.screen_frame]").expect("there");
    let (_, after) = rest.split_once("# The left eye looks along").expect("there");
    let rig = Rig::parse("rig.toml", &format!("{before}# The left eye looks along{after}"), |_| {
        Ok(urdf().to_owned())
    })
    .expect("valid");
    assert_eq!(rig.outlines, Outlines::default());
    assert_eq!(nico().outlines.body.expect("described").edges_m.len(), 5);
}

#[test]
fn a_broken_description_is_refused_with_a_sentence() {
    let refused = |text: &str| Description::from_urdf(text).expect_err("must be refused").to_string();
    let change = |from: &str, to: &str| {
        assert!(urdf().contains(from), "{from}");
        refused(&urdf().replacen(from, to, 1))
    };
    let extra = |xml: &str| refused(&urdf().replace("</robot>", &format!("{xml}</robot>")));
    let second_parent = r#"<joint name="loop" type="fixed"><parent link="head"/><child link="right_palm"/><origin xyz="0 0 0" rpy="0 0 0"/></joint>"#;
    assert!(extra(second_parent).contains("hangs on both"));
    let around = r#"<link name="a"/><link name="b"/>
        <joint name="ab" type="fixed"><parent link="a"/><child link="b"/></joint>
        <joint name="ba" type="fixed"><parent link="b"/><child link="a"/></joint>"#;
    assert!(extra(around).contains("tree"));
    assert!(extra(r#"<link name="alone"/>"#).contains("alone"));
    assert!(extra(r#"<link name="head"/>"#).contains("two links called head"));
    assert!(
        change(r#"<limit lower="-1.5707" upper="1.5707" effort="30" velocity="1"/>"#, "")
            .contains("no usable limits")
    );
    assert!(change(r#"lower="-1.5707""#, r#"lower="NaN""#).contains("no usable limits"));
    assert!(change(r#"<parent link="torso"/>"#, r#"<parent link="pelvis"/>"#).contains("pelvis"));
    assert!(change(r#"<axis xyz="0 0 1"/>"#, r#"<axis xyz="0 0 0"/>"#).contains("no direction"));
    for (from, to, words) in [
        ("<axis xyz=\"0 0 1\"/>", "<axis xyz=\"0 0 1e308\"/>", "cannot be a length of a vector"),
        ("<axis xyz=\"0.8944271909999159 0.4472135954999579 0\"/>", "<axis xyz=\"2e308 1 0\"/>", "r_thumb_x"),
        ("<mass value=\"0.090439\"/>", "<mass value=\"-5\"/>", "-5 kg cannot be a mass of a link"),
        ("xyz=\"0 0 -0.105\"", "xyz=\"0 0 -105\"", "-105 m cannot be a length of a link"),
        ("rpy=\"0 3.14 0\"", "rpy=\"0 180 0\"", "it looks like degrees, where radians belong"),
        ("upper=\"1.5707\"", "upper=\"1e308\"", "1.000e308 rad cannot be a limit of a joint"),
        ("ixx=\"6e-05\"", "ixx=\"1e300\"", "cannot be a moment of inertia"),
    ] {
        let message = change(from, to);
        assert!(message.contains(words), "{message}");
    }
    let deep = format!(
        "<robot name=\"r\">{}{}</robot>",
        "<link name=\"a\">".repeat(20_000),
        "</link>".repeat(20_000)
    );
    assert!(refused(&deep).contains("it nests 20001 levels deep"), "{}", refused(&deep));
    assert!(refused(&"<a>".repeat(20_000)).contains("levels deep"));
    assert!(refused("not xml").contains("not valid URDF"));
    assert!(refused("").contains("not valid URDF"));
}
