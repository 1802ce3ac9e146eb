use rand::rngs::StdRng;
use rand::seq::SliceRandom;
use rand::{Rng, SeedableRng};

use super::*;

fn grid(columns: u32, rows: u32, pitch_px: f64) -> Vec<Pixel<Screen>> {
    let at = |i: u32| Pixel::new(f64::from(i % columns) * pitch_px, f64::from(i / columns) * pitch_px);
    (0..columns * rows).map(at).collect()
}

fn border(pixels: &[Pixel<Screen>]) -> Border {
    Border::around(pixels).expect("the pixels have an area")
}

fn scattered(count: usize, seed: u64) -> Vec<Pixel<Screen>> {
    let mut random = StdRng::seed_from_u64(seed);
    (0..count)
        .map(|_| Pixel::new(random.random_range(0.0..1600.0), random.random_range(0.0..800.0)))
        .collect()
}

#[test]
fn a_grid_is_inside_with_a_margin_of_half_its_pitch() {
    let border = border(&grid(9, 4, 200.0));
    assert!((border.spacing_px() - 200.0).abs() < 1e-9);
    for pixel in grid(17, 7, 100.0) {
        assert!(border.contains(pixel), "{pixel:?} lies in the grid");
    }
    assert!(border.contains(Pixel::new(800.0, -95.0)), "less than half a pitch beyond the edge");
    let outside = Pixel::new(800.0, -300.0);
    assert!(!border.contains(outside));
    assert!((border.distance_outside_px(outside) - 200.0).abs() < 10.0);
    assert_eq!(border.rings().len(), 1);
}

#[test]
fn the_notch_of_an_l_is_outside() {
    let l: Vec<_> = grid(12, 12, 100.0).into_iter().filter(|p| p.u_px < 350.0 || p.v_px > 750.0).collect();
    let border = border(&l);
    let notch = Pixel::new(900.0, 200.0);
    assert!(!border.contains(notch));
    assert!(border.distance_outside_px(notch) > 400.0);
    assert!(l.iter().all(|&pixel| border.contains(pixel)));
    assert_eq!(border.rings().len(), 1);
}

#[test]
fn a_hole_is_outside_and_missing_touches_are_not() {
    let is_hole = |p: &Pixel<Screen>| (350.0..750.0).contains(&p.u_px) && (350.0..750.0).contains(&p.v_px);
    let ring: Vec<_> = grid(12, 12, 100.0).into_iter().filter(|p| !is_hole(p)).collect();
    let with_hole = border(&ring);
    assert!(!with_hole.contains(Pixel::new(550.0, 550.0)));
    assert_eq!(with_hole.rings().len(), 2);
    // The outline is the outer edge.
    assert!(with_hole.outline().iter().all(|p| p.distance_px(&Pixel::new(550.0, 550.0)) > 500.0));
    let one_missing: Vec<_> =
        grid(12, 12, 100.0).into_iter().filter(|p| (p.u_px, p.v_px) != (500.0, 500.0)).collect();
    assert!(border(&one_missing).contains(Pixel::new(500.0, 500.0)));
}

#[test]
fn a_lone_outlier_and_a_lone_pair_are_outside() {
    let clean = border(&grid(9, 4, 200.0));
    let mut touches = grid(9, 4, 200.0);
    let far = [Pixel::new(800.0, 2500.0), Pixel::new(800.0, 2540.0)];
    touches.push(far[0]);
    for outliers in 1..=2 {
        let border = border(&touches);
        assert!(!border.contains(far[0]));
        let gap = border.distance_outside_px(far[0]) - clean.distance_outside_px(far[0]);
        assert!(gap.abs() < 5.0, "{outliers} outliers move the border by {gap} px");
        touches.push(far[1]);
    }
}

#[test]
fn repeats_and_dense_lines_do_not_shrink_the_spacing() {
    let mut random = StdRng::seed_from_u64(1);
    let mut near = |p: &Pixel<Screen>| {
        Pixel::new(p.u_px + random.random_range(-8.0..8.0), p.v_px + random.random_range(-8.0..8.0))
    };
    let repeated: Vec<_> = grid(9, 4, 200.0).iter().flat_map(|p| [*p; 5]).map(|p| near(&p)).collect();
    let repeats = border(&repeated);
    assert!((repeats.spacing_px() - 200.0).abs() < 20.0, "{}", repeats.spacing_px());
    assert!(repeats.contains(Pixel::new(300.0, 300.0)));
    let lines: Vec<_> = grid(80, 4, 20.0).iter().map(|p| Pixel::new(p.u_px, p.v_px * 10.0)).collect();
    let lines = border(&lines);
    assert!(lines.contains(Pixel::new(800.0, 300.0)), "between two lines");
    assert_eq!(lines.rings().len(), 1);
}

#[test]
fn scattered_touches_are_inside_and_most_of_their_area_too() {
    for seed in 0..5 {
        let touches = scattered(245, seed);
        let border = border(&touches);
        let missed = touches.iter().filter(|&&touch| !border.contains(touch)).count();
        assert!(missed == 0, "seed {seed}: {missed} touches are outside of their own border");
        let targets = scattered(2000, seed + 100);
        let share = targets.iter().filter(|&&target| border.contains(target)).count() as f64 / 2000.0;
        assert!(share > 0.93, "seed {seed}: {share} of the area is inside");
    }
}

#[test]
fn order_place_and_scale_change_nothing() {
    let touches = scattered(100, 3);
    let plain = border(&touches);
    let mut shuffled = touches.clone();
    shuffled.shuffle(&mut StdRng::seed_from_u64(4));
    assert_eq!(border(&shuffled), plain);
    let moved = |p: &Pixel<Screen>| Pixel::new(3.0 * p.u_px - 500.0, 3.0 * p.v_px + 70.0);
    let scaled = border(&touches.iter().map(moved).collect::<Vec<_>>());
    for target in scattered(500, 5).iter().map(|p| Pixel::new(1.2 * p.u_px - 100.0, 1.2 * p.v_px - 50.0)) {
        let (here, there) = (plain.distance_outside_px(target), scaled.distance_outside_px(moved(&target)));
        // The tracing lattices differ.
        assert!((3.0 * here - there).abs() < 0.1 * plain.spacing_px(), "{target:?}: {here} and {there}");
    }
}

#[test]
fn the_nearest_pixel_inside_is_on_the_border() {
    let border = border(&grid(5, 5, 100.0));
    let inside = Pixel::new(210.0, 190.0);
    assert_eq!(border.nearest_inside(inside), inside);
    let outside = Pixel::new(700.0, 200.0);
    let nearest = border.nearest_inside(outside);
    assert!((nearest.distance_px(&outside) - border.distance_outside_px(outside)).abs() < 1e-9);
    assert!(border.distance_outside_px(nearest) < 1e-6);
}

#[test]
fn three_touches_have_an_area() {
    let border = border(&[Pixel::new(100.0, 100.0), Pixel::new(500.0, 120.0), Pixel::new(300.0, 500.0)]);
    assert!(border.contains(Pixel::new(300.0, 240.0)));
    assert!(!border.contains(Pixel::new(1500.0, 240.0)));
}

#[test]
fn without_an_area_there_is_no_border() {
    let around = |pixels: &[Pixel<Screen>]| Border::around(pixels).expect_err("these have no area");
    assert_eq!(around(&[]), BorderError::TooFew { found: 0 });
    assert_eq!(around(&[Pixel::new(5.0, 5.0); 9]), BorderError::TooFew { found: 1 });
    let line: Vec<_> = (0..40).map(|i| Pixel::new(40.0 * f64::from(i), 300.0 + f64::from(i % 3))).collect();
    assert_eq!(around(&line), BorderError::OnALine);
    let mut touches = grid(4, 4, 100.0);
    touches[5] = Pixel::new(f64::NAN, 3.0);
    assert_eq!(around(&touches), BorderError::NotFinite { index: 5 });
    assert!(around(&line).to_string().contains("a grid is best"));
}

#[test]
fn a_border_is_the_same_after_it_was_stored() {
    let border = border(&scattered(60, 9));
    let text = serde_json::to_string(&border).expect("numbers can be written");
    let read: Border = serde_json::from_str(&text).expect("what was written can be read");
    assert_eq!(read.rings().len(), border.rings().len());
    for (a, b) in read.rings().iter().flatten().zip(border.rings().iter().flatten()) {
        // The last digit of a number may be lost.
        assert!(a.distance_px(b) < 1e-9);
    }
    let damaged = r#"{"spacing_px": 10.0, "rings_px": [[[0.0, 0.0], [1.0, 0.0]]]}"#;
    let error = serde_json::from_str::<Border>(damaged).expect_err("two corners are no area");
    assert!(error.to_string().contains("train the model again"), "{error}");
}

#[test]
fn two_areas_are_two_parts() {
    let far = |p: &Pixel<Screen>| Pixel::new(p.u_px + 1200.0, p.v_px);
    let left = grid(5, 5, 100.0);
    let both: Vec<_> = left.iter().copied().chain(left.iter().map(far)).collect();
    let border = border(&both);
    assert_eq!(border.rings().len(), 2);
    assert!(both.iter().all(|&pixel| border.contains(pixel)));
    let between = Pixel::new(800.0, 200.0);
    assert!(!border.contains(between));
    assert!((border.distance_outside_px(between) - 350.0).abs() < 10.0);
}
