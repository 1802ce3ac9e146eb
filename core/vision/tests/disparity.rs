//! Disparity on made-up views whose truth is known, and on published ones.

use image::{GrayImage, Luma};
use plumbline_vision::disparity::{
    Block, DisparityError, DisparityMap, Matcher, Origin, Quality, Settings, read_pfm, write_pfm,
};
use plumbline_vision::rectify::Pair;

const WIDTH: u32 = 240;
const HEIGHT: u32 = 130;

/// Brightness of a fixed random texture at any place: smooth noise of two scales.
fn texture(x: f64, y: f64) -> f64 {
    fn lattice(x: i64, y: i64) -> f64 {
        let mut h =
            (x as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ (y as u64).wrapping_mul(0xc2b2_ae3d_27d4_eb4f);
        h = (h ^ (h >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        h = (h ^ (h >> 32)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((h >> 40) & 0xffff) as f64 / 65535.0
    }
    let noise = |x: f64, y: f64| {
        let (fx, fy) = (x - x.floor(), y - y.floor());
        let (sx, sy) = (fx * fx * (3.0 - 2.0 * fx), fy * fy * (3.0 - 2.0 * fy));
        let (ix, iy) = (x.floor() as i64, y.floor() as i64);
        let row = |y| lattice(ix, y) * (1.0 - sx) + lattice(ix + 1, y) * sx;
        row(iy) * (1.0 - sy) + row(iy + 1) * sy
    };
    40.0 + 120.0 * noise(x / 2.3, y / 2.3) + 60.0 * noise(x / 7.1 + 100.0, y / 7.1)
}

/// A left view and the right view of the same textured surface, where a pixel x of the left
/// view has the disparity `a + b x + c y`.
fn slanted(a: f64, b: f64, c: f64) -> (GrayImage, GrayImage) {
    let gray = |value: f64| Luma([value.round().clamp(0.0, 255.0) as u8]);
    let left = GrayImage::from_fn(WIDTH, HEIGHT, |x, y| gray(texture(f64::from(x), f64::from(y))));
    // x_right = x − (a + b x + c y), solved for the left x that a right pixel shows.
    let right = GrayImage::from_fn(WIDTH, HEIGHT, |x, y| {
        let (x, y) = (f64::from(x), f64::from(y));
        gray(texture((x + a + c * y) / (1.0 - b), y))
    });
    (left, right)
}

fn compute(settings: Settings, left: &GrayImage, right: &GrayImage) -> DisparityMap {
    Matcher::new(settings).expect("usable settings").compute(left, right, None).expect("same sizes")
}

fn both(max_disparity_px: u32) -> [Settings; 2] {
    [Settings::live(max_disparity_px), Settings::full(max_disparity_px)]
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    values[values.len() / 2]
}

#[test]
fn slanted_surfaces_are_recovered_to_a_fraction_of_a_pixel() {
    for (a, b, c) in [(12.0, 0.0, 0.0), (12.4, 0.0, 0.0), (10.3, 0.05, 0.04), (28.7, -0.03, 0.06)] {
        let (left, right) = slanted(a, b, c);
        for settings in both(40) {
            let map = compute(settings, &left, &right);
            let mut errors = Vec::new();
            for y in 4..HEIGHT - 4 {
                // What lies further left is outside the right view.
                for x in 44..WIDTH - 4 {
                    if let Some(d) = map.measured(x, y) {
                        errors.push((f64::from(d) - (a + b * f64::from(x) + c * f64::from(y))).abs());
                    }
                }
            }
            let part = errors.len() as f64 / f64::from((HEIGHT - 8) * (WIDTH - 48));
            let typical = median(errors);
            assert!(part > 0.95, "{settings:?} measured only {part} of ({a}, {b}, {c})");
            assert!(typical < 0.05, "{settings:?} is typically {typical} px off on ({a}, {b}, {c})");
        }
    }
}

#[test]
fn the_eyes_may_differ_in_gain_and_offset() {
    let (left, right) = slanted(15.3, 0.0, 0.03);
    let darker = GrayImage::from_fn(WIDTH, HEIGHT, |x, y| {
        Luma([(0.7 * f64::from(right.get_pixel(x, y).0[0]) + 12.0).round() as u8])
    });
    let map = compute(Settings::live(40), &left, &darker);
    let errors = (44..WIDTH - 4)
        .filter_map(|x| map.measured(x, 60).map(|d| (f64::from(d) - 15.3 - 0.03 * 60.0).abs()))
        .collect::<Vec<_>>();
    assert!(errors.len() > 170, "only {} pixels measured", errors.len());
    let typical = median(errors);
    assert!(typical < 0.1, "typically {typical} px off");
}

/// A square at disparity 30 in front of a wall at disparity 10.
fn square() -> (GrayImage, GrayImage) {
    let wall = |x: f64, y: f64| texture(x, y);
    let object = |x: f64, y: f64| texture(x + 5000.0, y + 300.0);
    let gray = |value: f64| Luma([value.round() as u8]);
    let inside = |x: u32, y: u32| (110..170).contains(&x) && (40..90).contains(&y);
    let left = GrayImage::from_fn(WIDTH, HEIGHT, |x, y| {
        gray(if inside(x, y) { object(f64::from(x), f64::from(y)) } else { wall(f64::from(x), f64::from(y)) })
    });
    let right = GrayImage::from_fn(WIDTH, HEIGHT, |x, y| {
        gray(if inside(x + 30, y) {
            object(f64::from(x) + 30.0, f64::from(y))
        } else {
            wall(f64::from(x) + 10.0, f64::from(y))
        })
    });
    (left, right)
}

#[test]
fn what_only_the_left_eye_sees_is_filled_from_behind_not_measured() {
    let (left, right) = square();
    for settings in both(40) {
        let map = compute(settings, &left, &right);
        // 20 px of wall to the left of the square are hidden from the right eye.
        let hidden = (94..106).flat_map(|x| (50..80).map(move |y| (x, y)));
        let (mut filled, mut all) = (0, 0);
        for (x, y) in hidden {
            all += 1;
            assert!(
                map.measured(x, y).is_none_or(|d| (d - 10.0).abs() < 1.0),
                "{settings:?} claims to have measured {:?} at ({x}, {y})",
                map.measured(x, y)
            );
            let Some(d) = map.get(x, y) else { panic!("({x}, {y}) was left empty") };
            assert!((d - 10.0).abs() < 1.0, "{settings:?} filled ({x}, {y}) with {d}");
            filled += u32::from(map.origin(x, y) == Some(Origin::Filled));
        }
        assert!(filled * 10 > all * 9, "{settings:?}: only {filled} of {all} are marked as filled");
        let on_square = map.measured(140, 65).expect("the middle of the square is measured");
        assert!((on_square - 30.0).abs() < 0.1, "{on_square}");
    }
}

#[test]
fn a_bare_surface_is_not_measured() {
    let bare = GrayImage::from_pixel(WIDTH, HEIGHT, Luma([128]));
    for settings in both(40) {
        assert_eq!(compute(settings, &bare, &bare).measured_fraction(), 0.0, "{settings:?}");
    }
}

#[test]
fn masked_pixels_have_no_disparity_and_hide_their_matches() {
    let (left, right) = slanted(12.0, 0.0, 0.0);
    let open = GrayImage::from_pixel(WIDTH, HEIGHT, Luma([255]));
    let mut masks = Pair { left: open.clone(), right: open };
    for y in 40..80 {
        for x in 100..140 {
            masks.left.put_pixel(x, y, Luma([0]));
        }
        for x in 168..208 {
            masks.right.put_pixel(x, y, Luma([0]));
        }
    }
    for settings in both(40) {
        let map =
            Matcher::new(settings).expect("settings").compute(&left, &right, Some(&masks)).expect("map");
        for y in 40..80 {
            for x in 100..140 {
                assert_eq!(map.get(x, y), None, "masked, but {settings:?} gives a disparity at ({x}, {y})");
            }
        }
        // Pixels 180..220 of the left view are where the mask of the right one is.
        let hidden = (185..215).filter(|x| map.measured(*x, 60).is_some()).count();
        assert!(hidden < 4, "{settings:?} measured {hidden} of 30 pixels that the right eye does not show");
        assert!(map.measured(60, 20).is_some());
    }
}

#[test]
fn results_do_not_depend_on_the_number_of_threads() {
    let (left, right) = slanted(10.3, 0.05, 0.04);
    for settings in both(40) {
        let on = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("pool");
            pool.install(|| compute(settings, &left, &right))
        };
        assert_eq!(on(1), on(3));
    }
}

#[test]
fn a_matcher_can_be_used_again_for_another_size() {
    let (left, right) = slanted(12.0, 0.0, 0.0);
    let mut matcher = Matcher::new(Settings::live(30)).expect("settings");
    let first = matcher.compute(&left, &right, None).expect("map");
    let small = |image: &GrayImage| image::imageops::crop_imm(image, 20, 10, 101, 37).to_image();
    let cropped = matcher.compute(&small(&left), &small(&right), None).expect("map");
    assert_eq!((cropped.width_px(), cropped.height_px()), (101, 37));
    assert_eq!(matcher.compute(&left, &right, None).expect("map"), first);
}

#[test]
fn large_ranges_and_odd_sizes_work() {
    let (left, right) = slanted(12.0, 0.0, 0.0);
    for max_disparity_px in [12, 31, 32, 63, 100, 200, 300, 1023] {
        for block in [Block::Small, Block::Medium, Block::Large] {
            let settings = Settings { max_disparity_px, block, quality: Quality::Live };
            let d = compute(settings, &left, &right).measured(150, 70);
            assert!(d.is_some_and(|d| (d - 12.0).abs() < 0.2), "{settings:?}: {d:?}");
        }
    }
}

#[test]
fn impossible_requests_are_refused() {
    assert!(matches!(Matcher::new(Settings::live(0)), Err(DisparityError::Range { asked_px: 0 })));
    assert!(matches!(Matcher::new(Settings::full(5000)), Err(DisparityError::Range { asked_px: 5000 })));
    let mut matcher = Matcher::new(Settings::live(30)).expect("settings");
    let (left, _) = slanted(12.0, 0.0, 0.0);
    let other = GrayImage::new(WIDTH, HEIGHT - 1);
    assert!(matches!(
        matcher.compute(&left, &other, None),
        Err(DisparityError::Sizes { what: "right view", .. })
    ));
    let masks = Pair { left: left.clone(), right: other };
    assert!(matches!(matcher.compute(&left, &left, Some(&masks)), Err(DisparityError::Sizes { .. })));
    let tiny = GrayImage::new(8, 8);
    assert!(matches!(matcher.compute(&tiny, &tiny, None), Err(DisparityError::Small { .. })));
}

#[test]
fn too_much_memory_is_refused_before_it_is_taken() {
    let huge = GrayImage::new(4000, 3000);
    let mut matcher = Matcher::new(Settings::live(1000)).expect("settings");
    assert!(matches!(matcher.compute(&huge, &huge, None), Err(DisparityError::Memory { .. })));
}

#[test]
fn pfm_files_round_trip() {
    let (left, right) = square();
    let map = compute(Settings::live(40), &left, &right);
    let mut file = Vec::new();
    write_pfm(&map, &mut file).expect("written to memory");
    let back = read_pfm(file.as_slice()).expect("just written");
    assert_eq!(back.as_slice(), map.as_slice());
    assert_eq!((back.width_px(), back.height_px()), (WIDTH, HEIGHT));
}

#[test]
fn pfm_stores_the_bottom_row_first_and_infinity_for_none() {
    let map = DisparityMap::from_measured(2, 2, vec![1.0, 2.0, f32::NAN, 4.0]).expect("four numbers");
    let mut file = Vec::new();
    write_pfm(&map, &mut file).expect("written to memory");
    let header = b"Pf\n2 2\n-1.0\n";
    assert_eq!(&file[..header.len()], header);
    let floats = file[header.len()..].chunks(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]]));
    assert_eq!(floats.collect::<Vec<_>>(), [f32::INFINITY, 4.0, 1.0, 2.0]);
}

#[test]
fn pfm_reads_the_other_byte_order() {
    let mut file = b"Pf 1 2 1.0\n".to_vec();
    file.extend([3.5f32, f32::INFINITY].iter().flat_map(|d| d.to_be_bytes()));
    let map = read_pfm(file.as_slice()).expect("big endian");
    assert_eq!((map.get(0, 0), map.get(0, 1)), (None, Some(3.5)));
}

#[test]
fn damaged_pfm_files_say_what_is_wrong() {
    let message = |bytes: &[u8]| read_pfm(bytes).expect_err("damaged").to_string();
    assert!(message(b"").contains("Pf"));
    assert!(message(b"PF\n2 2\n-1\n").contains("PF"));
    assert!(message(b"Pf\ntwo 2\n-1\n").contains("two"));
    assert!(message(b"Pf\n0 2\n-1\n").contains("size"));
    assert!(message(b"Pf\n60000 60000\n-1\n").contains("size"));
    assert!(message(b"Pf\n2 2\n0\n").contains("scale"));
    assert!(message(b"Pf\n2 2\n-1\nabc").contains("cut off"));
}

/// Numbers of a `.npz` file with one array of 32-bit floats.
fn read_npz(path: &std::path::Path) -> Vec<f32> {
    let bytes = std::fs::read(path).expect("readable");
    // Local file header of a zip archive: lengths of name and extra field at 26 and 28.
    let length = |at: usize| usize::from(u16::from_le_bytes([bytes[at], bytes[at + 1]]));
    let start = 30 + length(26) + length(28);
    let mut array = Vec::new();
    let mut inflate = flate2::read::DeflateDecoder::new(&bytes[start..]);
    std::io::Read::read_to_end(&mut inflate, &mut array).expect("deflated");
    let start = 10 + usize::from(u16::from_le_bytes([array[8], array[9]]));
    array[start..].chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect()
}

/// Part of the pixels with known truth that are wrong by more than 2 px or empty.
fn bad_fraction(map: &DisparityMap, truth: &[f32]) -> f64 {
    let wrong = |(i, truth): (usize, &f32)| -> bool {
        let (x, y) = (i as u32 % map.width_px(), i as u32 / map.width_px());
        map.get(x, y).is_none_or(|d| (d - truth).abs() > 2.0)
    };
    let known = truth.iter().enumerate().filter(|(_, truth)| truth.is_finite());
    let all = known.clone().count();
    known.filter(|pixel| wrong(*pixel)).count() as f64 / all as f64
}

#[test]
fn published_pairs_are_matched_better_than_by_the_usual_matcher() {
    let data = match plumbline_model::measured_data::folder("disparity") {
        Ok(data) => data,
        Err(reason) => return eprintln!("{reason}"),
    };
    let gray = |name: String| image::open(data.join(name)).expect("image").to_luma8();
    let quarter = |name: &str| -> Vec<f32> {
        let known = |v: &u8| if *v == 0 { f32::INFINITY } else { f32::from(*v) / 4.0 };
        gray(format!("{name}/disp2.png")).iter().map(known).collect()
    };
    let motorcycle = read_npz(&data.join("motorcycle/motorcycle_disp.npz"));
    let motorcycle_pair = ["motorcycle/motorcycle_left.png", "motorcycle/motorcycle_right.png"];
    let sets = [
        (["teddy/im2.png", "teddy/im6.png"], quarter("teddy"), 0.1865),
        (["cones/im2.png", "cones/im6.png"], quarter("cones"), 0.2107),
        (motorcycle_pair, motorcycle, 0.1116),
    ];
    for ([left, right], truth, usual) in sets {
        let (left_view, right_view) = (gray(left.to_owned()), gray(right.to_owned()));
        for settings in both(64) {
            let bad = bad_fraction(&compute(settings, &left_view, &right_view), &truth);
            eprintln!(
                "{left} {:?}: bad-2.0 {bad:.4} (semi-global block matching: {usual})",
                settings.quality
            );
            assert!(bad < 0.6 * usual, "{left} {settings:?}: {bad}");
        }
    }
}
