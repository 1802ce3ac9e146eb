//! What training has to satisfy on made-up touches, and M1 on its published numbers.

mod common;

use common::{data, places, screen, smooth, touches};
use plumbline_correction::{
    BlockBy, Blocks, CorrectionModel, HeightGrid, M1, Method, Placement, PlacementFrom, Recipe, TouchData,
    TrainError, TrainOptions, compare, train,
};
use plumbline_model::{Cancelled, JobContext, Pixel, Unattended};

fn trained(data: &TouchData, method: Method) -> CorrectionModel {
    train(data, method, &TrainOptions::default(), &Unattended, &mut |_| ()).expect("it trains")
}

fn mean_error_m(model: &CorrectionModel) -> f64 {
    let error = |place: [f64; 2]| {
        let truth = nalgebra::Point3::from(smooth(place));
        (model.correct(Pixel::new(place[0], place[1])).target.coords - truth).norm()
    };
    places(300, 7).into_iter().map(error).sum::<f64>() / 300.0
}

#[test]
fn a_smooth_map_is_recovered() {
    let data = data(200, 0.0, 1);
    assert!(mean_error_m(&trained(&data, Method::M3)) < 4e-4);
    // M1 has no bend in x and y.
    assert!(mean_error_m(&trained(&data, Method::M1)) > 1e-3);
}

#[test]
fn the_same_seed_gives_the_same_model_on_any_number_of_threads() {
    let data = data(80, 2e-3, 1);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a pool");
    let many = trained(&data, Method::M3);
    let one = pool.install(|| trained(&data, Method::M3));
    let other = TrainOptions { seed: 2, ..TrainOptions::default() };
    let other = train(&data, Method::M3, &other, &Unattended, &mut |_| ()).expect("it trains");
    let pixel = Pixel::new(700.0, 600.0);
    assert_eq!(many.correct(pixel), one.correct(pixel));
    assert_ne!(many.correct(pixel), other.correct(pixel));
}

#[test]
fn loss_points_arrive_with_and_without_held_out_touches() {
    let data = data(80, 2e-3, 1);
    let mut points = vec![];
    train(&data, Method::M3, &TrainOptions::default(), &Unattended, &mut |point| points.push(point))
        .expect("it trains");
    let held_out = points.iter().filter(|point| point.held_out_rms_m.is_some());
    let blocks: std::collections::BTreeSet<usize> = held_out.map(|point| point.member).collect();
    let last = points.iter().filter(|point| point.held_out_rms_m.is_none());
    let members: std::collections::BTreeSet<usize> = last.map(|point| point.member).collect();
    assert_eq!(blocks.len(), 12);
    assert_eq!(members.len(), 3);
    let published = TrainOptions { recipe: Recipe::Published, ..TrainOptions::default() };
    let mut epochs = 0;
    train(&data, Method::M2, &published, &Unattended, &mut |point| epochs = epochs.max(point.iteration))
        .expect("it trains");
    assert_eq!(epochs, 200);
}

#[test]
fn methods_are_compared_on_the_same_touches() {
    let data = data(80, 5e-4, 1);
    let comparison =
        compare(&data, &Method::ALL, &TrainOptions::default(), &Unattended).expect("it compares");
    assert_eq!(comparison.rows.len(), 80);
    for compared in &comparison.methods {
        assert_eq!(compared.held_out.residuals_m.len(), 80);
        assert_eq!(compared.held_out.blocks, comparison.methods[0].held_out.blocks);
        let [low, high] = compared.held_out.mean_2d_interval_m;
        let mean = compared.held_out.errors.mean_2d_m;
        assert!(low < mean && mean < high, "{low} {mean} {high}");
    }
    let (difference, [low, high]) = comparison.difference_m(Method::M1, Method::M3).expect("both");
    assert!(low < difference && difference < high && low > 0.0, "{low} {difference} {high}");
}

#[test]
fn repeats_stay_in_one_block() {
    let mut touches = touches(60, 0.0, 1);
    for (index, touch) in touches.iter_mut().enumerate() {
        touch.group = Some((index % 20).to_string());
        touch.set = Some(format!("set {}", index % 5));
    }
    let data = TouchData::new(touches, screen(), vec![]).expect("enough");
    for (by, most) in [(BlockBy::SetsElseArea, 12), (BlockBy::SetsElseArea, 3), (BlockBy::Area, 8)] {
        let blocks = Blocks::of(&data, by, most);
        assert!(blocks.len() >= 2 && blocks.len() <= most, "{} blocks", blocks.len());
        for (touch, block) in data.touches.iter().zip(&blocks.of_touch) {
            let home = data.touches.iter().position(|other| other.group == touch.group).expect("itself");
            assert_eq!(blocks.of_touch[home], *block);
        }
    }
}

#[test]
fn too_few_touches_for_a_network_are_refused_and_suffice_for_m1() {
    let few = data(10, 0.0, 1);
    let error =
        train(&few, Method::M3, &TrainOptions::default(), &Unattended, &mut |_| ()).expect_err("too few");
    assert!(error.to_string().contains("10 touches") && error.to_string().contains("at least 20"), "{error}");
    assert_eq!(trained(&few, Method::M1).method(), Method::M1);
}

#[test]
fn training_can_be_cancelled() {
    struct Stop;
    impl JobContext for Stop {
        fn checkpoint(&self) -> Result<(), Cancelled> {
            Err(Cancelled)
        }
        fn report(&self, _: f64, _: &str) {}
    }
    for method in Method::ALL {
        let ended = train(&data(60, 0.0, 1), method, &TrainOptions::default(), &Stop, &mut |_| ());
        assert!(matches!(ended, Err(TrainError::Cancelled(Cancelled))), "{}", method.name());
    }
}

#[test]
fn outside_of_the_touches_the_model_says_that_it_knows_less() {
    for method in Method::ALL {
        let model = trained(&data(120, 2e-3, 1), method);
        let (inside, outside) =
            (model.correct(Pixel::new(960.0, 700.0)), model.correct(Pixel::new(960.0, -400.0)));
        assert!(inside.inside && !outside.inside);
        for axis in 0..3 {
            assert!(
                outside.sd_m[axis] > inside.sd_m[axis],
                "{} {axis}: {inside:?} {outside:?}",
                method.name()
            );
        }
    }
}

#[test]
fn a_turned_and_shifted_screen_is_found() {
    let stated = Placement::of_screen(&screen());
    let (sine, cosine) = 0.05_f64.sin_cos();
    let mut touches = touches(30, 0.0, 1);
    for touch in &mut touches {
        let at = stated.xy(touch.pixel);
        let (x, y) = (cosine * at.x - sine * at.y + 0.02, sine * at.x + cosine * at.y - 0.03);
        touch.sent = plumbline_model::Point::new(x, y, 0.06);
    }
    let data = TouchData::new(touches, screen(), vec![]).expect("enough");
    let found = M1::of_touches(&data, PlacementFrom::Touches);
    for touch in &data.touches {
        assert!(found.at(touch.pixel).distance_m(&touch.sent) < 1e-12);
    }
    let as_stated = M1::of_touches(&data, PlacementFrom::Session);
    assert_eq!(as_stated.placement, stated);
    // The center of the first pixel lies half a pixel inside of the corner.
    let first = stated.xy(Pixel::new(-0.5, -0.5));
    assert!((first.x - 0.545).abs() < 1e-15 && (first.y - 0.2375).abs() < 1e-15);
}

#[test]
fn the_published_placement_and_heights_are_reproduced() {
    let m1 = M1::published();
    let corner = m1.placement.xy(Pixel::new(0.0, 0.0));
    assert!((corner.x - 0.55).abs() < 1e-12 && (corner.y - 0.24).abs() < 1e-12);
    let other = m1.placement.xy(Pixel::new(1920.0, 1080.0));
    assert!((other.x - 0.28).abs() < 1e-12 && (other.y + 0.24).abs() < 1e-12);
    let z = HeightGrid::published();
    let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-12, "{a} {b}");
    near(z.at(0.30, -0.20), 0.072);
    near(z.at(0.30, 0.20), 0.071);
    near(z.at(0.35, 0.0), 0.071);
    near(z.at(0.45, 0.15), 0.087);
    // Between nodes: along y, along x, and in the middle of four.
    near(z.at(0.30, -0.175), 0.071);
    near(z.at(0.325, -0.20), 0.0745);
    near(z.at(0.425, 0.175), (0.080 + 0.083 + 0.087 + 0.095) / 4.0);
    // Clamped outside.
    near(z.at(0.1, -0.20), 0.072);
    near(z.at(0.6, 0.5), 0.095);
    near(z.at(0.325, -0.9), 0.0745);
    // The whole way: a pixel whose x and y fall on a node.
    let pixel = Pixel::new(1920.0 * (1.0 - (0.0 + 0.24) / 0.48), 1080.0 * (1.0 - (0.35 - 0.28) / 0.27));
    let sent = m1.at(pixel).coords;
    near(sent.x, 0.35);
    near(sent.y, 0.0);
    near(sent.z, 0.071);
}

#[test]
fn heights_come_from_the_sessions_grid_or_from_planes() {
    let mut grid = vec![];
    for (i, x) in [0.30, 0.35, 0.40].into_iter().enumerate() {
        for (j, y) in [-0.1, 0.0, 0.1].into_iter().enumerate() {
            let mut touch = touches(1, 0.0, (3 * i + j) as u64).remove(0);
            touch.sent = plumbline_model::Point::new(x, y, 0.06 + 0.001 * (3 * i + j) as f64);
            touch.set = Some("grid".to_owned());
            grid.push(touch);
        }
    }
    let data = TouchData::new(grid.clone(), screen(), vec![]).expect("enough");
    let heights = HeightGrid::of_touches(&data);
    assert_eq!((heights.x_m.len(), heights.y_m.len()), (3, 3));
    assert!((heights.at(0.35, 0.1) - 0.065).abs() < 1e-12);
    // Without the corner the lines cross where nobody touched.
    grid.pop();
    let data = TouchData::new(grid, screen(), vec![]).expect("enough");
    assert_eq!(HeightGrid::of_touches(&data).z_m.len(), 4);
    // A plane is a plane at every node.
    let mut touches = touches(100, 0.0, 1);
    for touch in &mut touches {
        touch.sent.coords.z = 0.05 + 0.04 * touch.sent.coords.x - 0.02 * touch.sent.coords.y;
    }
    let heights = HeightGrid::of_touches(&TouchData::new(touches, screen(), vec![]).expect("enough"));
    for (x, y) in [(0.33, -0.1), (0.4, 0.15)] {
        assert!((heights.at(x, y) - (0.05 + 0.04 * x - 0.02 * y)).abs() < 3e-4);
    }
}

#[test]
fn touches_that_all_carry_one_group_are_refused() {
    let mut alike = touches(30, 1e-3, 4);
    alike.iter_mut().for_each(|touch| touch.group = Some("line".to_owned()));
    // Another group of one touch leaves that one to learn from.
    let mut nearly = alike.clone();
    nearly[7].group = Some("other".to_owned());
    for touches in [alike, nearly] {
        let data = TouchData::new(touches, screen(), vec![]).expect("touches");
        for method in [Method::M1, Method::M3] {
            let refused = train(&data, method, &TrainOptions::default(), &Unattended, &mut |_| ());
            assert!(matches!(refused, Err(TrainError::MostlyRepeats { found: 30, .. })), "{}", method.name());
        }
    }
}

#[test]
fn a_set_with_most_of_the_touches_is_not_held_out_whole() {
    let blocks = |of_first: usize| {
        let mut touches = touches(60, 1e-3, 4);
        for (index, touch) in touches.iter_mut().enumerate() {
            let set = if index < of_first { "a" } else { ["b", "c"][index % 2] };
            touch.set = Some(set.to_owned());
        }
        let data = TouchData::new(touches, screen(), vec![]).expect("touches");
        Blocks::of(&data, BlockBy::SetsElseArea, 12)
    };
    assert_eq!((blocks(30).by, blocks(30).len()), (BlockBy::SetsElseArea, 3));
    assert_eq!((blocks(31).by, blocks(31).len()), (BlockBy::Area, 12));
}
