use super::*;

fn grid(columns: u32, rows: u32, pitch_px: f64) -> Vec<Pixel<Screen>> {
    let at = |i: u32| Pixel::new(f64::from(i % columns) * pitch_px, f64::from(i / columns) * pitch_px);
    (0..columns * rows).map(at).collect()
}

fn border(pixels: &[Pixel<Screen>]) -> Border {
    Border::around(pixels).expect("the pixels have an area")
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
