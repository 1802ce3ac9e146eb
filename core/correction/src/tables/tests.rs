use std::f64::consts::{PI, TAU};
use std::path::Path;

use nalgebra::{DMatrix, DVector};
use rand::rngs::StdRng;
use rand::seq::SliceRandom;
use rand::{Rng, SeedableRng};

use super::multiquadric::{Multiquadric, epsilon};
use super::*;

fn heights(rows: &[[f64; 3]], smoothing: f64) -> HeightTable {
    let points = rows.iter().map(|row| HeightPoint::from_numbers(row)).collect();
    HeightTable { smoothing, ..HeightTable::new(points).expect("a good table") }
}

/// Made up.
const HEIGHTS: [[f64; 3]; 7] = [
    [0.20, -0.30, 0.110],
    [0.35, -0.25, 0.120],
    [0.45, -0.05, 0.115],
    [0.30, 0.00, 0.100],
    [0.15, 0.10, 0.070],
    [0.40, 0.20, 0.125],
    [0.25, 0.25, 0.090],
];
const YAWS: [[f64; 4]; 8] = [
    [0.20, -0.30, 0.07, -0.5],
    [0.35, -0.25, 0.07, -0.2],
    [0.45, -0.05, 0.07, 0.1],
    [0.30, 0.00, 0.12, 0.8],
    [0.15, 0.10, 0.12, 1.5],
    [0.40, 0.20, 0.12, 0.6],
    [0.25, 0.25, 0.12, 1.2],
    [0.30, -0.10, 0.17, 0.5],
];

fn yaws(turn_rad: f64) -> YawTable {
    let turned = |row: &[f64; 4]| YawPoint::from_numbers(&[row[0], row[1], row[2], row[3] + turn_rad]);
    YawTable::new(YAWS.iter().map(turned).collect()).expect("a good table")
}

fn assert_near(found: f64, expected: f64, tolerance: f64, what: &str) {
    assert!((found - expected).abs() <= tolerance, "{what}: {found} for {expected}");
}

/// Answers of `scipy.interpolate.Rbf` 1.17.1 for the made-up tables.
#[test]
fn answers_are_those_of_scipy() {
    let at = [(0.3, -0.1), (0.2, 0.0), (0.5, 0.3), (0.35, -0.25)];
    let published = [0.10235495546304106, 0.08379783073179951, 0.15448164353383376, 0.11984570156843533];
    let exact = [0.1027184180060185, 0.08401617284409531, 0.15452837604572284, 0.12];
    for (smoothing, expected) in [(0.01, published), (0.0, exact)] {
        let surface = heights(&HEIGHTS, smoothing).surface().expect("it can be solved");
        for ((x_m, y_m), expected) in at.into_iter().zip(expected) {
            let found = surface.interpolate(x_m, y_m).expect("a finite place");
            assert_near(found.value, expected, 1e-12, "height");
        }
    }
    let at = [(0.3, -0.1, 0.1), (0.2, 0.0, 0.07), (0.5, 0.3, 0.2)];
    let expected = [0.40889989733548915, 0.9879114437910453, 0.560679594705044];
    for ((x_m, y_m, z_m), expected) in at.into_iter().zip(expected) {
        let found = yaws(0.0).interpolate(x_m, y_m, z_m).expect("it can be solved");
        assert_near(found.value, expected, 1e-12, "yaw");
    }
}

#[test]
fn answers_are_those_of_scipy_for_the_published_tables() {
    let folder = match plumbline_model::measured_data::folder("nico-tables") {
        Ok(folder) => folder,
        Err(reason) => return eprintln!("{reason}"),
    };
    let table = HeightTable::read(&folder.join("rh_z.csv")).expect("a good file");
    assert_eq!(table.points.len(), 45);
    let surface = table.surface().expect("it can be solved");
    for (x_m, y_m, expected, inside) in [
        (0.3, 0.0, 0.09943312146480726, true),
        (0.25, -0.2, 0.10236639271530189, true),
        (0.4, 0.1, 0.11412547596354, true),
        (0.15, 0.3, 0.09089080659587273, true),
        (0.5, -0.3, 0.14091161548189038, false),
        (0.1, 0.1, 0.05812612941407069, false),
    ] {
        let found = surface.interpolate(x_m, y_m).expect("a finite place");
        assert_near(found.value, expected, 1e-11, "height");
        assert_eq!(found.inside, inside, "({x_m}, {y_m})");
    }
    let errors_m = table.leave_one_out().expect("it can be solved");
    let rms_m = (errors_m.iter().map(|e| e.powi(2)).sum::<f64>() / errors_m.len() as f64).sqrt();
    eprintln!("published heights: leave-one-out rms {:.2} mm", 1e3 * rms_m);

    let mut points = Vec::new();
    for name in ["rh_yaw_z5.csv", "rh_yaw_z10.csv", "rh_yaw_z15.csv"] {
        points.extend(YawTable::read(&folder.join(name)).expect("a good file").points);
    }
    let table = YawTable::new(points).expect("the layers share no place");
    assert_eq!(table.points.len(), 132);
    let field = table.field().expect("it can be solved");
    for (x_m, y_m, z_m, expected) in [
        (0.3, 0.0, 0.07, 0.9803393321624237),
        (0.25, -0.2, 0.1, 0.3512893144877827),
        (0.4, 0.1, 0.12, 0.8335025254599693),
        (0.15, 0.3, 0.15, 1.4043961009065231),
        (0.5, -0.3, 0.05, -0.5478152405376843),
    ] {
        assert_near(field.interpolate(x_m, y_m, z_m).expect("a finite place").value, expected, 1e-10, "yaw");
    }
}

#[test]
fn without_smoothing_the_points_are_met() {
    let table = heights(&HEIGHTS, 0.0);
    for point in &table.points {
        let found = table.interpolate(point.x_m, point.y_m).expect("it can be solved");
        assert_near(found.value, point.height_m, 1e-12, "height");
        assert!(found.inside);
    }
}

/// The interpolation is linear in the values, and a constant is not among its functions.
#[test]
fn a_constant_adds_the_interpolation_of_ones() {
    let with = |value: &dyn Fn(f64) -> f64| {
        let rows = HEIGHTS.map(|[x, y, height]| [x, y, value(height)]);
        heights(&rows, 0.01).surface().expect("it can be solved")
    };
    let (plain, raised, ones) = (with(&|height| height), with(&|height| height + 0.05), with(&|_| 1.0));
    for (x_m, y_m) in [(0.3, -0.1), (0.2, 0.1), (0.9, 0.9)] {
        let value = |surface: &HeightSurface| surface.interpolate(x_m, y_m).expect("a finite place").value;
        assert_near(value(&raised), value(&plain) + 0.05 * value(&ones), 1e-12, "height");
        let unity = (value(&ones) - 1.0).abs();
        assert_eq!(unity < 0.05, x_m < 0.5, "interpolation of ones is off by {unity} at ({x_m}, {y_m})");
    }
}

#[test]
fn order_changes_nothing() {
    let mut rows = HEIGHTS;
    rows.shuffle(&mut StdRng::seed_from_u64(1));
    let (plain, shuffled) = (heights(&HEIGHTS, 0.01), heights(&rows, 0.01));
    let ask = |table: &HeightTable| table.interpolate(0.31, 0.07).expect("it can be solved");
    assert_near(ask(&plain).value, ask(&shuffled).value, 1e-12, "height");
    assert_eq!(ask(&plain).inside, ask(&shuffled).inside);
}

/// Each point predicted by a system without it, with the ε of the whole table.
fn brute_force(places: &[Vec<f64>], values: &[f64], smoothing: f64) -> Vec<f64> {
    let scale = epsilon(places).expect("the places differ");
    let basis = |a: &[f64], b: &[f64]| {
        let squares: f64 = a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum();
        (squares / scale.powi(2) + 1.0).sqrt()
    };
    let error = |left_out: usize| {
        let kept: Vec<usize> = (0..places.len()).filter(|&i| i != left_out).collect();
        let matrix = DMatrix::from_fn(kept.len(), kept.len(), |i, j| {
            basis(&places[kept[i]], &places[kept[j]]) - if i == j { smoothing } else { 0.0 }
        });
        let right = DVector::from_iterator(kept.len(), kept.iter().map(|&i| values[i]));
        let weights = matrix.lu().solve(&right).expect("it can be solved");
        let predicted: f64 =
            kept.iter().zip(&weights).map(|(&i, w)| w * basis(&places[i], &places[left_out])).sum();
        values[left_out] - predicted
    };
    (0..places.len()).map(error).collect()
}

#[test]
fn leaving_out_in_closed_form_is_leaving_out() {
    let mut random = StdRng::seed_from_u64(2);
    for smoothing in [0.0, 0.01, 0.1] {
        for dimensions in [2, 3] {
            let mut numbers =
                || (0..dimensions).map(|_| random.random_range(-0.4..0.4)).collect::<Vec<f64>>();
            let places: Vec<Vec<f64>> = (0..30).map(|_| numbers()).collect();
            let values: Vec<f64> = places.iter().map(|p| p[0].sin() + p[1].powi(2)).collect();
            let closed = Multiquadric::new(places.clone(), &values, smoothing).expect("it can be solved");
            for (k, brute) in brute_force(&places, &values, smoothing).into_iter().enumerate() {
                assert_near(closed.errors()[k], brute, 1e-9, "error");
            }
        }
    }
    let table = heights(&HEIGHTS, 0.01);
    let places: Vec<_> = HEIGHTS.iter().map(|row| row[..2].to_vec()).collect();
    let brute = brute_force(&places, &HEIGHTS.map(|row| row[2]), 0.01);
    for (found, brute) in table.leave_one_out().expect("it can be solved").into_iter().zip(brute) {
        assert_near(found, brute, 1e-12, "error");
    }
}

#[test]
fn yaw_does_not_jump_at_half_a_turn() {
    let ask = |table: &YawTable| table.interpolate(0.3, -0.05, 0.1).expect("it can be solved").value;
    let plain = ask(&yaws(0.0));
    for turn_rad in [PI - 0.5, PI, -PI + 0.3, 2.5, -2.5] {
        // Some angles written beyond ±π, some brought back: the same directions.
        let table = yaws(turn_rad);
        let mut written = table.clone();
        for (i, point) in written.points.iter_mut().enumerate() {
            point.yaw_rad += TAU * (i % 3) as f64 - TAU;
        }
        assert_near(ask(&written), ask(&table), 1e-9, "the same angles");
        let difference = (ask(&table) - plain - turn_rad + PI).rem_euclid(TAU) - PI;
        // A constant is met nearly, see above.
        assert_near(difference, 0.0, 0.1, "turned yaw");
        for error in table.leave_one_out().expect("it can be solved") {
            assert!(error.abs() < 1.5, "turned by {turn_rad} rad: error of {error} rad");
        }
    }
    let around = (0..12).map(|i| {
        let angle = TAU * f64::from(i) / 12.0;
        YawPoint { x_m: 0.1 * angle.cos(), y_m: 0.1 * angle.sin(), z_m: 0.1, yaw_rad: angle }
    });
    let table = YawTable::new(around.collect()).expect("a table");
    assert!(matches!(table.interpolate(0.0, 0.0, 0.1), Err(TableError::YawAllAround)));
}

#[test]
fn inside_is_among_the_points() {
    let height = |x_m, y_m| heights(&HEIGHTS, 0.01).interpolate(x_m, y_m).expect("it can be solved");
    assert!(height(0.3, -0.1).inside);
    assert!(!height(0.9, 0.0).inside);
    assert_eq!(height(0.3, 0.0).sd, None, "seven points tell no standard deviation");
    let yaw = |z_m| yaws(0.0).interpolate(0.3, 0.0, z_m).expect("it can be solved");
    assert!(yaw(0.10).inside);
    assert!(!yaw(0.25).inside && !yaw(0.0).inside);
    assert!(yaw(0.10).sd.is_some_and(|sd| (0.05..1.0).contains(&sd)), "{:?}", yaw(0.10).sd);
}

#[test]
fn the_standard_deviation_is_that_of_new_points() {
    let mut random = StdRng::seed_from_u64(5);
    let mut point = || {
        let (x_m, y_m) = (random.random_range(0.1..0.5), random.random_range(-0.4..0.4));
        // The sum of twelve uniform numbers is nearly normal.
        let noise: f64 = (0..12).map(|_| random.random_range(-0.5..0.5)).sum();
        HeightPoint { x_m, y_m, height_m: 0.1 + 0.05 * x_m - 0.1 * y_m * y_m + 0.002 * noise }
    };
    let table = HeightTable::new((0..60).map(|_| point()).collect()).expect("a good table");
    let surface = table.surface().expect("it can be solved");
    let (mut held, mut inside) = (0, 0);
    while inside < 1000 {
        let new = point();
        let answer = surface.interpolate(new.x_m, new.y_m).expect("a finite place");
        if answer.inside {
            inside += 1;
            let sd_m = answer.sd.expect("60 points tell it");
            held += i32::from((answer.value - new.height_m).abs() <= 1.96 * sd_m);
        }
    }
    eprintln!("95 % intervals of heights hold {held} of 1000 new points inside");
    assert!((900..=985).contains(&held), "{held} of 1000");
}

#[test]
fn points_are_added_moved_and_removed() {
    let mut table = heights(&HEIGHTS, 0.01);
    let new = HeightPoint { x_m: 0.1, y_m: 0.3, height_m: 0.08 };
    table.add(new).expect("a free place");
    assert!(matches!(table.add(new), Err(TableError::Duplicate { index: 7 })));
    let bad = HeightPoint { height_m: f64::NAN, ..new };
    assert!(matches!(table.add(bad), Err(TableError::NotFinite { column: "height_m" })));
    let moved = HeightPoint { height_m: 0.09, ..new };
    table.move_to(7, moved).expect("its own place is free");
    assert_eq!(table.points[7], moved);
    assert!(matches!(table.move_to(0, moved), Err(TableError::Duplicate { index: 7 })));
    assert!(matches!(table.move_to(8, moved), Err(TableError::NoSuchPoint { index: 8, count: 8 })));
    for _ in 0..4 {
        table.remove(0).expect("more than four are left");
    }
    assert!(matches!(table.remove(0), Err(TableError::TooFew { found: 3 })));
    assert_eq!(table.points.len(), 4);
    assert_eq!(table.points[3], moved);
}

#[test]
fn tables_that_cannot_be_used_say_why() {
    let mut table = heights(&HEIGHTS, -0.1);
    assert!(matches!(table.interpolate(0.3, 0.0), Err(TableError::Smoothing { found }) if found == -0.1));
    table.smoothing = 0.01;
    assert!(matches!(table.interpolate(f64::NAN, 0.0), Err(TableError::NotFinite { column: "x_m" })));
    table.points[3] = table.points[1];
    assert!(matches!(table.leave_one_out(), Err(TableError::Duplicate { index: 1 })));
    table.points.truncate(3);
    assert!(matches!(table.surface(), Err(TableError::TooFew { found: 3 })));
    let line = HEIGHTS.map(|[x, _, height]| [x, 2.0 * x, height]);
    assert!(matches!(heights(&line, 0.01).surface(), Err(TableError::NoArea(_))));
}

fn refused(text: &str) -> String {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("heights.csv");
    std::fs::write(&file, text).expect("a file can be written");
    HeightTable::read(&file).expect_err("the file is bad").to_string()
}

#[test]
fn bad_files_are_refused_with_file_line_and_column() {
    let good = "x_m,y_m,height_m\n0.1,0.1,0.1\n0.2,0.1,0.1\n0.2,0.3,0.1\n0.1,0.3,0.1\n";
    for (text, words) in [
        (
            good.replace("0.2,0.3,0.1", "0.2,high,0.1"),
            "heights.csv, line 4, column y_m: \"high\" is no finite",
        ),
        (good.replace("0.2,0.3,0.1", "0.2,0.3,NaN"), "heights.csv, line 4, column height_m: \"NaN\""),
        (good.replace("0.2,0.3,0.1", "0.2,0.3"), "line 4: 2 cells for 3 columns; complete the line"),
        (good.replace("height_m", "z"), "line 1: the columns are \"x_m,y_m,z\", this table has"),
        (good.replace("0.2,0.1", "0.1,0.1"), "line 3: the same place as line 2; remove one"),
        (
            good.replace("0.1,0.3,0.1\n", ""),
            "a table of 3 points cannot be interpolated: it needs at least 4",
        ),
        (String::new(), "line 1: the columns are \"\""),
        (
            good.replace("0.2,0.3,0.1", "200,0.3,0.1"),
            "heights.csv, line 4, column x_m: 200 m cannot be a coordinate of a point sent to the arm",
        ),
        (
            good.replace("0.2,0.3,0.1", "0.2,0.3,35"),
            "it looks like millimeters or centimeters, where meters belong",
        ),
    ] {
        let message = refused(&text);
        assert!(message.contains(words), "{message}");
    }
    let missing = HeightTable::read(Path::new("/nowhere/heights.csv")).expect_err("there is no such file");
    assert!(missing.to_string().contains("/nowhere/heights.csv cannot be read"), "{missing}");
}

#[test]
fn a_table_is_the_same_after_it_was_stored() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (height, yaw) = (folder.path().join("height.csv"), folder.path().join("yaw.csv"));
    let (heights, yaws) = (heights(&HEIGHTS, 0.01), yaws(0.123_456_789));
    heights.write(&height).expect("it can be written");
    yaws.write(&yaw).expect("it can be written");
    assert_eq!(HeightTable::read(&height).expect("it can be read"), heights);
    assert_eq!(YawTable::read(&yaw).expect("it can be read"), yaws);
    assert!(matches!(HeightTable::read(&yaw), Err(TableError::Header { .. })));
}
