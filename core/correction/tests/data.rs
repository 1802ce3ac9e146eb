//! Sessions that can and that cannot be learned from.

mod common;

use common::{data, places, rig, row, screen, session, touch_245, touches};
use plumbline_correction::{DataError, TouchData, spread_of_repeats};
use plumbline_model::session::TouchRow;
use plumbline_model::{Pixel, Point, Session};

fn rows(count: usize) -> Vec<TouchRow> {
    places(count, 1).into_iter().map(row).collect()
}

fn read(session: &Session) -> Result<TouchData, DataError> {
    TouchData::of_session(session, &rig().chain("right_index_tip").expect("a tip of the rig"))
}

#[test]
fn a_session_without_encoder_angles_is_fine() {
    let data = read(&session(&rows(10))).expect("touches to learn from");
    assert_eq!(data.len(), 10);
    assert!(data.left_out.is_empty(), "{:?}", data.left_out);
}

#[test]
fn the_point_sent_is_computed_where_it_was_not_logged() {
    let chain = rig().chain("right_index_tip").expect("a tip of the rig");
    let mut rows = rows(10);
    let angles = [0.2, 0.3, 0.4, 1.6, 1.0, 0.7];
    rows[3].target = None;
    rows[3].commanded_rad = angles.map(Some).to_vec();
    rows[4].target = None;
    rows[4].commanded_rad[2] = None;
    let data = read(&session(&rows)).expect("touches to learn from");
    let sent = data.touches[3].sent.coords.coords;
    assert!((sent - chain.robot_from_tip(&angles).translation_m()).norm() < 1e-15);
    assert_eq!(data.len(), 9);
    assert_eq!(data.left_out, ["1 row had neither the point sent nor all commanded angles"]);
}

#[test]
fn what_is_left_out_is_counted_and_named() {
    let mut rows = rows(12);
    rows[1].touch = None;
    rows[2].touch = Some(Pixel::new(1919.5, 10.0));
    rows[3].screen_height_m = Some(0.03);
    rows[4].payload_kg = Some(0.2);
    rows.push(rows[0].clone());
    let data = read(&session(&rows)).expect("touches to learn from");
    assert_eq!(data.len(), 8);
    assert_eq!(data.left_out.len(), 5, "{:?}", data.left_out);
    for part in ["touched nothing", "off the screen", "height", "payload", "exactly"] {
        assert!(data.left_out.iter().any(|sentence| sentence.contains(part)), "{part}: {:?}", data.left_out);
    }
}

#[test]
fn the_commonest_height_is_learned_from_also_when_it_is_not_nominal() {
    let mut rows = rows(12);
    rows.iter_mut().skip(4).for_each(|row| row.screen_height_m = Some(0.03));
    assert_eq!(read(&session(&rows)).expect("touches to learn from").len(), 8);
}

#[test]
fn nothing_to_learn_from_is_said() {
    let mut none = session(&[]);
    assert_eq!(read(&none).expect_err("no rows"), DataError::NoTouches);
    none.touches = None;
    assert_eq!(read(&none).expect_err("no table"), DataError::NoTouches);
    let one = read(&session(&rows(1))).expect_err("one touch");
    assert!(
        one.to_string().contains("1 of the session's touches") && one.to_string().contains("at least 4"),
        "{one}"
    );
    let mut off = rows(5);
    off.iter_mut().for_each(|row| row.touch = Some(Pixel::new(-5.0, 10.0)));
    let off = read(&session(&off)).expect_err("all off");
    assert!(off.to_string().contains("5 rows touched a place off the screen"), "{off}");
}

#[test]
fn touches_on_a_line_are_refused() {
    let line: Vec<TouchRow> =
        (0..20).map(|i| row([200.0 + 70.0 * f64::from(i), 800.0 + f64::from(i % 3) * 6.0])).collect();
    let error = read(&session(&line)).expect_err("a line");
    assert!(matches!(error, DataError::OnALine { found: 20, .. }), "{error}");
    let same = touches(6, 0.0, 1)
        .into_iter()
        .map(|t| plumbline_correction::Touch { pixel: Pixel::new(5.0, 5.0), ..t });
    assert!(matches!(TouchData::new(same.collect(), screen(), vec![]), Err(DataError::OnALine { .. })));
}

#[test]
fn a_screen_without_area_and_numbers_that_are_none_are_refused() {
    let mut flat = session(&rows(10));
    flat.manifest.touchscreen.as_mut().expect("has one").width_px = 0;
    let error = read(&flat).expect_err("no area");
    assert!(error.to_string().contains("0 × 1080 px"), "{error}");
    flat.manifest.touchscreen = Some(plumbline_model::session::Touchscreen { height_m: 0.0, ..screen() });
    assert!(matches!(read(&flat), Err(DataError::ScreenWithoutArea { .. })));
    flat.manifest.touchscreen = None;
    assert_eq!(read(&flat).expect_err("no screen"), DataError::NoScreen);
    let mut wild = touches(6, 0.0, 1);
    wild[2].sent = Point::new(0.3, f64::NAN, 0.0);
    let error = TouchData::new(wild, screen(), vec![]).expect_err("not a number");
    assert_eq!(error, DataError::NotFinite { what: "the point sent", row: 3 });
}

#[test]
fn a_chain_of_another_arm_is_refused_only_where_it_is_needed() {
    let left =
        rig().chain("left_index_tip").or_else(|_| rig().chain("left_palm_center")).expect("a left tip");
    let mut rows = rows(10);
    assert!(TouchData::of_session(&session(&rows), &left).is_ok());
    rows[0].target = None;
    let error = TouchData::of_session(&session(&rows), &left).expect_err("other joints");
    assert!(matches!(error, DataError::OtherChain { .. }), "{error}");
}

#[test]
fn repeats_tell_the_noise_floor() {
    assert_eq!(spread_of_repeats(&data(20, 0.0, 1)), None);
    let mut touches = touches(5, 0.0, 1);
    touches[4].pixel = Pixel::new(300.0, 1000.0);
    for (index, (u, v)) in
        [(500.0, 500.0), (504.0, 500.0), (900.0, 900.0), (900.0, 908.0)].into_iter().enumerate()
    {
        touches[index].pixel = Pixel::new(u, v);
        touches[index].group = Some((index / 2).to_string());
    }
    let repeats =
        spread_of_repeats(&TouchData::new(touches, screen(), vec![]).expect("enough")).expect("groups");
    assert_eq!((repeats.groups, repeats.touches), (2, 4));
    // Per axis one group is off its mean by ±2 px (±4 px), with two degrees of freedom left.
    let pitch_m = [0.475 / 1920.0, 0.267 / 1080.0];
    assert!((repeats.sd_m[0] - 2.0 * pitch_m[0]).abs() < 1e-12);
    assert!((repeats.sd_m[1] - 4.0 * pitch_m[1]).abs() < 1e-12);
    assert!((repeats.rms_2d_m - repeats.sd_m[0].hypot(repeats.sd_m[1])).abs() < 1e-15);
}

#[test]
fn a_measured_line_is_a_line() {
    let Some(data) = touch_245() else { return };
    assert_eq!(data.len(), 245);
    for line in ["line_horizontal_1", "line_vertical_2", "line_diagonal_1"] {
        let touches =
            data.touches.iter().filter(|touch| touch.set.as_deref() == Some(line)).cloned().collect();
        let error = TouchData::new(touches, data.screen.clone(), vec![]).expect_err("a line");
        assert!(matches!(error, DataError::OnALine { .. }), "{line}: {error}");
    }
}

#[test]
fn points_that_the_arm_cannot_be_sent_to_are_left_out_or_refused() {
    let mut all = rows(20);
    let sent = |row: &mut TouchRow, factor: f64| {
        let point = row.target.expect("sent").coords;
        row.target = Some(Point::new(point.x, point.y, point.z * factor));
    };
    // One height that is 57 times too large.
    sent(&mut all[3], 57.0);
    let data = read(&session(&all)).expect("one row only");
    assert_eq!(data.len(), 19);
    assert_eq!(data.left_out, ["1 row was sent to a point that the arm cannot reach"]);
    all.iter_mut().for_each(|row| sent(row, 57.0));
    let said = read(&session(&all)).expect_err("all of them").to_string();
    assert!(said.contains("of the 20 touches lie up to") && said.contains("target_z_m"), "{said}");
}

#[test]
fn pixels_and_points_that_do_not_belong_together_make_no_model() {
    use plumbline_correction::{Method, TrainOptions, train};
    let mut touches = touches(60, 1e-3, 3);
    // A mirror image of the table, sent twice as far.
    touches.iter_mut().for_each(|touch| {
        let sent = touch.sent.coords;
        touch.sent = Point::new(2.5 * sent.x - 0.6, -2.5 * sent.y, sent.z);
    });
    let data = TouchData::new(touches, screen(), vec![]).expect("numbers");
    let error = train(&data, Method::M1, &TrainOptions::default(), &plumbline_model::Unattended, &mut |_| ());
    let said = error.expect_err("nonsense").to_string();
    assert!(
        said.contains("M1 misses the touches that it was trained on by") && said.contains("unit"),
        "{said}"
    );
}
