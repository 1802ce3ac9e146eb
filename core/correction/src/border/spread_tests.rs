//! Coverage of the stated intervals on synthetic screens whose truth is known.

use nalgebra::{DMatrix, DVector, Vector2};
use plumbline_model::Pixel;
use plumbline_model::session::Screen;
use rand::rngs::StdRng;
use rand::{Rng, SeedableRng};

use super::{Border, Spread, SpreadError};

const TOUCHES: usize = 245;
const TARGETS: usize = 1000;
/// Data of the published touches: the screen's middle.
const DATA_PX: [(f64, f64); 2] = [(120.0, 1761.0), (335.0, 1055.0)];

/// A robot and a screen: which point (m) must be sent for a pixel.
struct Truth {
    name: &'static str,
    /// Smooth part beyond the placement of the screen, m, of the pixel over 1000.
    bend: fn(Vector2<f64>) -> [f64; 3],
    noise_m: f64,
    /// Degree of the polynomial that stands in for a model.
    degree: i32,
}

const TRUTHS: [Truth; 5] = [
    Truth {
        name: "gentle, cubic",
        bend: |p| [0.004 * (2.0 * p.x).sin(), 0.003 * p.x * p.y, 0.002 * (3.0 * p.y).cos()],
        noise_m: 0.001,
        degree: 3,
    },
    Truth {
        name: "gentle, quadratic",
        bend: |p| [0.004 * (2.0 * p.x).sin(), 0.003 * p.x * p.y, 0.002 * (3.0 * p.y).cos()],
        noise_m: 0.002,
        degree: 2,
    },
    Truth {
        name: "wavy, cubic",
        bend: |p| [0.006 * (3.0 * p.x + p.y).sin(), 0.005 * (3.0 * p.y).sin(), 0.004 * (4.0 * p.x).cos()],
        noise_m: 0.0005,
        degree: 3,
    },
    Truth {
        name: "sagging, quadratic",
        bend: |p| [0.004 * p.x.powi(3), 0.01 * (-p.y).exp(), 0.01 / (1.0 + p.y.powi(2))],
        noise_m: 0.001,
        degree: 2,
    },
    Truth {
        name: "sagging, cubic",
        bend: |p| [0.004 * p.x.powi(3), 0.01 * (-p.y).exp(), 0.01 / (1.0 + p.y.powi(2))],
        noise_m: 0.0015,
        degree: 3,
    },
];

impl Truth {
    fn sent(&self, pixel: Pixel<Screen>, random: &mut StdRng) -> [f64; 3] {
        let p = pixel.vector() / 1000.0;
        let bend = (self.bend)(p);
        let flat = [0.545 - 0.247 * p.y, 0.2375 - 0.247 * p.x, 0.056];
        std::array::from_fn(|axis| flat[axis] + bend[axis] + self.noise_m * normal(random))
    }
}

/// Standard normal (Box and Muller).
fn normal(random: &mut StdRng) -> f64 {
    let radius = (-2.0 * (1.0 - random.random::<f64>()).ln()).sqrt();
    radius * (std::f64::consts::TAU * random.random::<f64>()).cos()
}

fn monomials(pixel: Pixel<Screen>, degree: i32) -> Vec<f64> {
    let (x, y) = ((pixel.u_px - 960.0) / 900.0, (pixel.v_px - 700.0) / 400.0);
    (0..=degree).flat_map(|n| (0..=n).map(move |k| x.powi(k) * y.powi(n - k))).collect()
}

/// Coefficients of a polynomial per axis.
fn fitted(pixels: &[Pixel<Screen>], sent: &[[f64; 3]], degree: i32) -> [DVector<f64>; 3] {
    let rows: Vec<Vec<f64>> = pixels.iter().map(|&pixel| monomials(pixel, degree)).collect();
    let matrix = DMatrix::from_fn(rows.len(), rows[0].len(), |i, j| rows[i][j]);
    let svd = plumbline_model::decompose::svd(matrix, true, true).expect("finite");
    std::array::from_fn(|axis| {
        let right = DVector::from_fn(sent.len(), |i, _| sent[i][axis]);
        svd.solve(&right, 1e-12).expect("both factors were computed")
    })
}

fn answered(model: &[DVector<f64>; 3], pixel: Pixel<Screen>, degree: i32) -> [f64; 3] {
    let terms = DVector::from_vec(monomials(pixel, degree));
    std::array::from_fn(|axis| model[axis].dot(&terms))
}

/// Residuals of each block under a model that was fitted without it.
fn cross_validated(
    pixels: &[Pixel<Screen>],
    sent: &[[f64; 3]],
    blocks: &[usize],
    degree: i32,
) -> Vec<[f64; 3]> {
    let mut residuals = vec![[0.0; 3]; pixels.len()];
    let count = blocks.iter().max().expect("there are touches") + 1;
    for block in 0..count {
        let kept: Vec<usize> = (0..pixels.len()).filter(|&i| blocks[i] != block).collect();
        let of = |i: &usize| (pixels[*i], sent[*i]);
        let (kept_pixels, kept_sent): (Vec<_>, Vec<_>) = kept.iter().map(of).unzip();
        let model = fitted(&kept_pixels, &kept_sent, degree);
        for i in (0..pixels.len()).filter(|&i| blocks[i] == block) {
            let answer = answered(&model, pixels[i], degree);
            residuals[i] = std::array::from_fn(|axis| sent[i][axis] - answer[axis]);
        }
    }
    residuals
}

fn anywhere(range: [(f64, f64); 2], random: &mut StdRng) -> Pixel<Screen> {
    let [u, v] = range.map(|(low, high)| random.random_range(low..high));
    Pixel::new(u, v)
}

/// Blocks of an area: columns and rows of rectangles.
fn block(pixel: Pixel<Screen>, columns: f64, rows: f64) -> usize {
    let share = |value: f64, (low, high): (f64, f64)| (value - low) / (high - low);
    let column = (share(pixel.u_px, DATA_PX[0]) * columns).floor().clamp(0.0, columns - 1.0);
    let row = (share(pixel.v_px, DATA_PX[1]) * rows).floor().clamp(0.0, rows - 1.0);
    (row * columns + column) as usize
}

/// Shares of new touches within 1.96 standard deviations: inside and outside of the border.
struct Coverage {
    inside: f64,
    outside: f64,
    /// Mean standard deviation (m) inside and outside.
    sd_m: [f64; 2],
}

fn coverage(truth: &Truth, layout: [f64; 2], with_blocks: bool, seed: u64) -> Coverage {
    let mut random = StdRng::seed_from_u64(seed);
    let pixels: Vec<_> = (0..TOUCHES).map(|_| anywhere(DATA_PX, &mut random)).collect();
    let sent: Vec<_> = pixels.iter().map(|&pixel| truth.sent(pixel, &mut random)).collect();
    let border = Border::around(&pixels).expect("the touches fill an area");
    let blocks: Vec<usize> = if with_blocks {
        pixels.iter().map(|&pixel| block(pixel, layout[0], layout[1])).collect()
    } else {
        (0..TOUCHES).map(|i| i % 10).collect()
    };
    let residuals = cross_validated(&pixels, &sent, &blocks, truth.degree);
    let spread = if with_blocks {
        Spread::fit_blocked(&pixels, &residuals, &blocks, &border)
    } else {
        Spread::fit(&pixels, &residuals, &border)
    }
    .expect("the residuals are numbers");
    let model = fitted(&pixels, &sent, truth.degree);
    let (mut held, mut counted, mut sum) = ([0.0; 2], [0.0; 2], [0.0; 2]);
    while counted[0] < 3.0 * TARGETS as f64 || counted[1] < 3.0 * TARGETS as f64 {
        let target = anywhere([(0.0, 1920.0), (0.0, 1080.0)], &mut random);
        let side = usize::from(!border.contains(target));
        if counted[side] >= 3.0 * TARGETS as f64 {
            continue;
        }
        let (new, answer) = (truth.sent(target, &mut random), answered(&model, target, truth.degree));
        for (axis, sd) in spread.sd_m(target).into_iter().enumerate() {
            held[side] += f64::from((new[axis] - answer[axis]).abs() <= 1.96 * sd);
            counted[side] += 1.0;
            sum[side] += sd;
        }
    }
    Coverage {
        inside: held[0] / counted[0],
        outside: held[1] / counted[1],
        sd_m: [sum[0] / counted[0], sum[1] / counted[1]],
    }
}

/// 1000 targets inside and 1000 outside on the rest of the screen, for every truth and seed.
fn report(what: &str, layout: [f64; 2], with_blocks: bool) -> Vec<Coverage> {
    let mut all = Vec::new();
    for truth in &TRUTHS {
        for seed in 0..4 {
            let found = coverage(truth, layout, with_blocks, seed);
            eprintln!(
                "{what}, {}, seed {seed}: 95 % intervals hold {:.1} % inside (sd {:.2} mm), {:.1} % outside (sd {:.2} mm)",
                truth.name,
                100.0 * found.inside,
                1e3 * found.sd_m[0],
                100.0 * found.outside,
                1e3 * found.sd_m[1],
            );
            all.push(found);
        }
    }
    all
}

fn assert_honest(all: &[Coverage]) {
    for (i, found) in all.iter().enumerate() {
        assert!((0.90..=0.98).contains(&found.inside), "case {i}: {} inside", found.inside);
        assert!(found.outside >= 0.90, "case {i}: {} outside", found.outside);
        assert!(found.sd_m[1] > found.sd_m[0], "case {i}: narrower outside");
    }
}

#[test]
fn intervals_hold_new_touches_when_areas_were_left_out() {
    assert_honest(&report("12 areas", [4.0, 3.0], true));
    assert_honest(&report("5 columns", [5.0, 1.0], true));
}

#[test]
fn intervals_hold_new_touches_when_the_growth_is_the_fallback() {
    assert_honest(&report("scattered folds", [0.0, 0.0], false));
}

#[test]
fn the_interval_grows_outward() {
    let truth = &TRUTHS[0];
    let mut random = StdRng::seed_from_u64(7);
    let pixels: Vec<_> = (0..TOUCHES).map(|_| anywhere(DATA_PX, &mut random)).collect();
    let sent: Vec<_> = pixels.iter().map(|&pixel| truth.sent(pixel, &mut random)).collect();
    let blocks: Vec<usize> = pixels.iter().map(|&pixel| block(pixel, 4.0, 3.0)).collect();
    let border = Border::around(&pixels).expect("the touches fill an area");
    let residuals = cross_validated(&pixels, &sent, &blocks, truth.degree);
    for spread in [
        Spread::fit(&pixels, &residuals, &border),
        Spread::fit_blocked(&pixels, &residuals, &blocks, &border),
    ] {
        let spread = spread.expect("the residuals are numbers");
        for _ in 0..TARGETS {
            let pixel = anywhere([(-500.0, 2500.0), (-500.0, 1500.0)], &mut random);
            let (here, nearest) = (spread.sd_m(pixel), spread.sd_m(border.nearest_inside(pixel)));
            let at_least = if border.contains(pixel) { 1.0 } else { 1.0 - 1e-9 };
            assert!(
                (0..3).all(|axis| here[axis] >= at_least * nearest[axis]),
                "{pixel:?}: {here:?}, {nearest:?}"
            );
        }
        for direction in [Vector2::new(1.0, 0.0), Vector2::new(0.0, -1.0), Vector2::new(-0.6, 0.8)] {
            let mut before = [0.0; 3];
            for step in 0..20 {
                let pixel = Pixel::from(Vector2::new(940.0, 700.0) + 100.0 * f64::from(step) * direction);
                let sd_m = spread.sd_m(pixel);
                if border.distance_outside_px(pixel) > 100.0 {
                    assert!((0..3).all(|axis| sd_m[axis] >= before[axis]), "{pixel:?}: {sd_m:?}, {before:?}");
                    before = sd_m;
                }
            }
        }
        let pixel = Pixel::new(900.0, 700.0);
        let (alone, doubted) = (spread.sd_m(pixel), spread.sd_m_with(pixel, [0.004; 3]));
        assert!((0..3).all(|axis| doubted[axis] > 0.004 && doubted[axis] > alone[axis]));
        assert_eq!(spread.sd_m_with(pixel, [0.0; 3]), alone);
    }
}

/// Where touches scatter more the interval is wider.
#[test]
fn the_interval_follows_local_noise() {
    let mut random = StdRng::seed_from_u64(8);
    let pixels: Vec<_> = (0..400).map(|_| anywhere(DATA_PX, &mut random)).collect();
    let noise_m = |pixel: &Pixel<Screen>| if pixel.u_px < 900.0 { 0.0005 } else { 0.002 };
    let residuals: Vec<[f64; 3]> =
        pixels.iter().map(|pixel| std::array::from_fn(|_| noise_m(pixel) * normal(&mut random))).collect();
    let border = Border::around(&pixels).expect("the touches fill an area");
    let spread = Spread::fit(&pixels, &residuals, &border).expect("the residuals are numbers");
    let (calm, rough) = (spread.sd_m(Pixel::new(400.0, 700.0)), spread.sd_m(Pixel::new(1400.0, 700.0)));
    assert!((0..3).all(|axis| rough[axis] > 1.4 * calm[axis]), "{calm:?}, {rough:?}");
}

#[test]
fn bad_residuals_are_refused() {
    let pixels: Vec<_> =
        (0..16).map(|i| Pixel::new(f64::from(i % 4) * 100.0, f64::from(i / 4) * 100.0)).collect();
    let border = Border::around(&pixels).expect("a grid has an area");
    let mut residuals = vec![[0.001; 3]; 16];
    let fit =
        |pixels: &[_], residuals: &[_]| Spread::fit(pixels, residuals, &border).expect_err("bad residuals");
    assert_eq!(fit(&pixels, &residuals[1..]), SpreadError::Lengths { pixels: 16, residuals: 15, blocks: 16 });
    assert_eq!(fit(&pixels[..2], &residuals[..2]), SpreadError::TooFew { found: 2 });
    residuals[7][1] = f64::NAN;
    assert_eq!(fit(&pixels, &residuals), SpreadError::NotFinite { index: 7 });
    let blocked = Spread::fit_blocked(&pixels, &residuals, &[0; 3], &border);
    assert!(matches!(blocked, Err(SpreadError::Lengths { blocks: 3, .. })));
}

#[test]
fn a_spread_is_the_same_after_it_was_stored() {
    let mut random = StdRng::seed_from_u64(9);
    let pixels: Vec<_> = (0..60).map(|_| anywhere(DATA_PX, &mut random)).collect();
    let residuals: Vec<[f64; 3]> =
        pixels.iter().map(|_| std::array::from_fn(|_| 0.001 * normal(&mut random))).collect();
    let border = Border::around(&pixels).expect("the touches fill an area");
    let spread = Spread::fit(&pixels, &residuals, &border).expect("the residuals are numbers");
    let text = serde_json::to_string(&spread).expect("numbers can be written");
    let read: Spread = serde_json::from_str(&text).expect("what was written can be read");
    for _ in 0..100 {
        let pixel = anywhere([(0.0, 1920.0), (0.0, 1080.0)], &mut random);
        for (a, b) in spread.sd_m(pixel).into_iter().zip(read.sd_m(pixel)) {
            assert!((a - b).abs() < 1e-9);
        }
    }
}
