//! A made-up robot that touches its screen, for tests.

use nalgebra::{Isometry3, Point3, Vector3};
use plumbline_effects::arm::Arm;
use plumbline_effects::measurements::What;
use plumbline_effects::{Assumed, Effect, Measurements, Present, Surface};
use plumbline_model::Pixel;
use plumbline_model::robot::Rig;
use plumbline_model::robot::ik::{Options, Solver, Target};

use crate::usual::{NOISE_M, measurements, row};

/// The finger that touches.
pub const TIP: &str = "right_index_tip";

/// Angles with which a tip comes to points.
pub fn postures(rig: &Rig, tip: &str, points: &[Vector3<f64>]) -> Vec<Vec<f64>> {
    let solver = Solver::of_rig(rig, tip).expect("a tip");
    let solved = points.iter().filter_map(|point| {
        let target = Target::Position(Point3::from(*point).into());
        let answer = solver.solve_from(&target, &rig.home(), &Options::default()).ok()?;
        answer.is_reached().then(|| answer.best().joints.to_vec())
    });
    solved.collect()
}

/// Effects of an arm with values.
pub fn hidden(arm: &Arm, effects: &[(&str, &str, &[f64])]) -> Vec<Present> {
    let present = |(id, site, values): &(&str, &str, &[f64])| Present {
        effect: Effect::find(id, site, None, Some(arm), None).expect("known"),
        values: values.to_vec(),
    };
    effects.iter().map(present).collect()
}

/// Touches on a grid by an arm with hidden effects, from both sides in turn; noise of a panel.
pub fn touches(rig: &Rig, effects: &[(&str, &str, &[f64])]) -> Measurements {
    let screen = &rig.touchscreen;
    let pixels =
        (0..24).map(|i| Pixel::new(500.0 + 220.0 * f64::from(i % 6), 150.0 + 240.0 * f64::from(i / 6)));
    let on_glass: Vec<_> = pixels.map(|pixel| screen.point_at(pixel).coords.coords).collect();
    let arm = Arm::of_rig(rig, TIP).expect("an arm");
    let truth = Assumed {
        effects: hidden(&arm, effects),
        placements: vec![Isometry3::identity()],
        ..Assumed::default()
    };
    let directions = |i: usize| vec![if i.is_multiple_of(2) { 1.0 } else { -1.0 }; arm.len()];
    let postures = postures(rig, TIP, &on_glass).into_iter().enumerate();
    let rows = postures.map(|(i, angles)| {
        let mut touch = row(What::Touch, angles, directions(i));
        (touch.row, touch.cell) = (i, i);
        touch
    });
    let rows = rows.collect();
    let mut touches = measurements(rig, arm, Some(Surface::of(screen)), rows);
    for k in 0..touches.rows.len() {
        let mut felt = touches.predict(&touches.rows[k], &truth).expect("predicted");
        for (axis, at) in felt.iter_mut().enumerate() {
            let share = ((k * 37 + axis * 101) % 23) as f64 / 11.0 - 1.0;
            *at += NOISE_M[axis] * 0.5 * share;
        }
        touches.rows[k].measured = felt;
    }
    touches
}
