//! Whether a thing stands where the networks of the published methods were trained.

use plumbline_grasp::Method;
use plumbline_model::Point;

use super::around::GraspAround;
use super::view::{Gate, GateState, Need};

/// A word where a thing stands beside the touches from which the network of M2 or M3 was trained, robot
/// frame, m; nothing elsewhere, and where nobody knows from which. It warns and does not refuse: the published
/// experiment grasps there, too.
pub(super) fn area(around: &GraspAround, method: Method, [x_m, y_m]: [f64; 2]) -> Option<Gate> {
    let corrections = &around.corrections;
    let network = match method {
        Method::M2 => corrections.m2.as_ref(),
        Method::M3 => corrections.m3.as_ref(),
        Method::M1 | Method::M4 | Method::M5 => None,
    };
    let border = network?.border()?;
    let screen = around.model.touchscreen();
    // The glass is so level that its height there is that of its origin.
    let pixel = screen.pixel_at(Point::new(x_m, y_m, screen.origin.coords.z));
    let name = method.name().to_uppercase();
    if border.contains(pixel) {
        let text = format!("{name} was trained around there.");
        return Some(Gate { of: Need::Area, state: GateState::Open, text });
    }
    let nearest = screen.point_at(border.nearest_inside(pixel)).coords;
    let beside_mm = (nearest.x - x_m).hypot(nearest.y - y_m) * 1e3;
    let text = format!(
        "The thing stands {beside_mm:.0} mm beside the touches from which {name} was trained: its correction there is \
         that of the border, and may be off. Put it nearer, or choose M5."
    );
    Some(Gate { of: Need::Area, state: GateState::Doubtful, text })
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use nalgebra::Vector3;
    use plumbline_correction::{CorrectionModel, Touch, TouchData, TrainOptions, train};
    use plumbline_grasp::Corrections;
    use plumbline_model::robot::Rig;
    use plumbline_model::{Pixel, Unattended};

    use super::*;

    /// Trained from touches on the middle of the screen; what answers does not matter here.
    fn trained(rig: &Rig) -> CorrectionModel {
        let touch = |row: usize| {
            let pixel = Pixel::new(660.0 + 100.0 * (row % 7) as f64, 340.0 + 100.0 * (row / 7) as f64);
            // As arms are, a little off.
            let off_m = Vector3::new((row as f64).sin(), (1.7 * row as f64).cos(), 0.5) * 1e-3;
            let sent = Point::from(rig.touchscreen.point_at(pixel).coords + off_m);
            Touch { pixel, sent, set: None, group: None, row }
        };
        let touches = (0..35).map(touch).collect();
        let data = TouchData { touches, screen: rig.touchscreen.clone(), left_out: vec![] };
        let model = train(
            &data,
            plumbline_correction::Method::M1,
            &TrainOptions::default(),
            &Unattended,
            &mut |_| {},
        );
        model.expect("trained")
    }

    #[test]
    fn beside_the_touches_of_a_network_a_thing_is_doubtful_and_not_refused() {
        let rig = Arc::new(Rig::built_in("nico").expect("comes with the program"));
        let model = Some(Arc::new(trained(&rig)));
        let bare = GraspAround::bare(&rig);
        let corrections = Corrections { m2: model.clone(), m3: model, ..Corrections::default() };
        let around = GraspAround { corrections, ..GraspAround::bare(&rig) };
        let at = |u_px: f64| {
            let at = rig.touchscreen.point_at(Pixel::new(u_px, 540.0)).coords;
            [at.x, at.y]
        };
        for method in [Method::M2, Method::M3] {
            let within = area(&around, method, at(960.0)).expect("it is known where it was trained");
            assert_eq!(within.state, GateState::Open, "{within:?}");
            // Touches end at 1260 px, their border half of 100 px farther.
            let beside = area(&around, method, at(1800.0)).expect("it is known where it was trained");
            assert_eq!(beside.state, GateState::Doubtful, "{beside:?}");
            let beside_mm = (1800.0 - 1310.0) * 1e3 * rig.touchscreen.width_m / 1920.0;
            let said_mm: f64 =
                beside.text.split(' ').find_map(|word| word.parse().ok()).expect("it is said how far");
            assert!((said_mm - beside_mm).abs() < 6.0, "{beside_mm}: {beside:?}");
            assert!(beside.text.contains(&method.name().to_uppercase()), "{beside:?}");
            assert_eq!(area(&bare, method, at(1800.0)), None, "nothing was trained");
        }
        for method in [Method::M1, Method::M4, Method::M5] {
            assert_eq!(area(&around, method, at(1800.0)), None, "{method:?} has no network");
        }
    }
}
