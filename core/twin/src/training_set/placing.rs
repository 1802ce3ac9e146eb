//! Toys on screen, table and desk, in hands and in the air.

use std::f64::consts::{FRAC_PI_2, PI};

use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};

use super::arms::Hand;
use super::dice::Dice;
use super::room::Room;
use crate::scene::{Item, Shape};
use crate::toys::look::{self, Look};
use crate::toys::surface::triangles;
use crate::toys::{Toy, ToyPart};

/// A toy that lies somewhere.
pub(super) struct Placed {
    /// Which.
    pub toy: Toy,
    /// Where.
    pub robot_from_toy: Isometry3<f64>,
    /// What it looks like.
    pub parts: Vec<ToyPart>,
    radius_m: f64,
}

/// Which toys there are: of eight scenes in a hundred none, else one to eight, sometimes alike.
pub(super) fn choose(dice: &mut Dice) -> Vec<Toy> {
    if dice.chance(0.08) {
        return vec![];
    }
    let many = if dice.chance(0.6) { dice.count(1, 5) } else { dice.count(3, 8) };
    let twins = dice.chance(0.3);
    let mut chosen: Vec<Toy> = vec![];
    while chosen.len() < many {
        let toy = *dice.pick(&Toy::ALL);
        if twins || chosen.len() >= Toy::ALL.len() || !chosen.contains(&toy) {
            chosen.push(toy);
        }
    }
    chosen
}

/// Finds a place for a toy; `None` where all that were tried are taken.
pub(super) fn place(
    toy: Toy,
    look: &Look,
    room: &Room,
    hands: &[Hand],
    arms: &[Item],
    others: &[Placed],
    dice: &mut Dice,
) -> Option<Placed> {
    let parts = look::parts(toy, look);
    let radius_m = toy.radius_m() * look.scale;
    for _ in 0..30 {
        let turn = lie(toy, dice);
        let in_hand = dice.chance(0.07);
        let at = match spot(room, hands, in_hand, dice) {
            Spot::On(point) => point + Vector3::z() * depth_below(&parts, &turn),
            Spot::Free(point) => point,
        };
        let clear = |other: &Placed| {
            let apart = (other.robot_from_toy.translation.vector - at).norm();
            apart > 0.8 * (other.radius_m + radius_m)
        };
        let from_arms = if in_hand { 0.004 } else { 0.6 * radius_m + 0.016 };
        if others.iter().all(clear) && distance_to(arms, &at) > from_arms {
            return Some(Placed {
                toy,
                robot_from_toy: Isometry3::from_parts(at.into(), turn),
                parts,
                radius_m,
            });
        }
    }
    None
}

/// What one piece of its kind looks like.
pub(super) fn some_look(dice: &mut Dice) -> Look {
    let bright = if dice.chance(0.8) { dice.within_f32(0.75, 1.2) } else { dice.within_f32(0.45, 1.5) };
    let tint = [0; 3].map(|_| bright * (1.0 + dice.normal(0.045) as f32).clamp(0.8, 1.2));
    Look {
        scale: dice.within(0.85, 1.15),
        tint,
        grain: dice.within_f32(0.0, 0.3),
        gloss: dice.within_f32(0.0, 0.09),
        shape: [0; 4].map(|_| dice.within(-1.0, 1.0)),
    }
}

/// How a toy lies when it was dropped.
fn lie(toy: Toy, dice: &mut Dice) -> UnitQuaternion<f64> {
    let about_x = |angle: f64| UnitQuaternion::from_axis_angle(&Vector3::x_axis(), angle);
    let heading = dice.heading();
    let tilt = UnitQuaternion::from_scaled_axis(Vector3::new(dice.normal(0.12), dice.normal(0.12), 0.0));
    match toy {
        Toy::Banana if dice.chance(0.85) => heading * tilt * about_x(if dice.chance(0.5) { PI } else { 0.0 }),
        Toy::Duck if dice.chance(0.5) => heading * tilt,
        // Upside down, on its side.
        Toy::Duck if dice.chance(0.6) => {
            heading * tilt * about_x(*dice.pick(&[PI, FRAC_PI_2 + 0.3, -FRAC_PI_2 - 0.3]))
        }
        Toy::Mushroom if dice.chance(0.3) => heading * tilt,
        // On the rim of its cap and the stem.
        Toy::Mushroom if dice.chance(0.5) => heading * tilt * about_x(FRAC_PI_2 + 0.35),
        Toy::Onion if dice.chance(0.35) => heading * tilt,
        Toy::Onion if dice.chance(0.6) => heading * tilt * about_x(FRAC_PI_2 + 0.3),
        Toy::Tomato if dice.chance(0.5) => heading * tilt * tilt * tilt,
        _ => dice.orientation(),
    }
}

enum Spot {
    /// A point of a surface on which it lies.
    On(Vector3<f64>),
    /// Where its middle is.
    Free(Vector3<f64>),
}

fn spot(room: &Room, hands: &[Hand], in_hand: bool, dice: &mut Dice) -> Spot {
    if in_hand && !hands.is_empty() {
        let hand = dice.pick(hands);
        let jitter = dice.place([-0.01; 3], [0.01; 3]);
        return Spot::Free(hand.grasp_m + jitter);
    }
    if dice.chance(0.04) {
        return Spot::Free(dice.place([0.2, -0.3, 0.12], [0.7, 0.3, 0.45]));
    }
    if dice.chance(0.12) && !hands.is_empty() {
        // Below or beside a hand.
        let palm = dice.pick(hands).palm_m;
        let x = (palm.x + dice.normal(0.05)).clamp(room.table_range_m[0][0] + 0.1, room.table_range_m[0][1]);
        let y = (palm.y + dice.normal(0.05)).clamp(room.table_range_m[1][0], room.table_range_m[1][1]);
        return Spot::On(Vector3::new(x, y, height_at(room, x, y)));
    }
    let [rx, ry] = room.table_range_m;
    let (x, y) = if room.has_screen && dice.chance(0.55) {
        let [hx, hy] = room.screen_half_m;
        let on = Point3::new(dice.within(-hx, hx), dice.within(-hy, hy), 0.0);
        let p = room.robot_from_screen * on;
        (p.x, p.y)
    } else if dice.chance(0.85) {
        (dice.within(rx[0] + 0.14, rx[1] + 0.05), dice.within(ry[0] - 0.03, ry[1] + 0.03))
    } else {
        (dice.within(rx[1], rx[1] + 0.4), dice.within(-0.5, 0.5))
    };
    Spot::On(Vector3::new(x, y, height_at(room, x, y)))
}

fn height_at(room: &Room, x: f64, y: f64) -> f64 {
    let on_screen = room.robot_from_screen.inverse() * Point3::new(x, y, 0.0);
    let [hx, hy] = room.screen_half_m;
    if room.has_screen && on_screen.x.abs() < hx && on_screen.y.abs() < hy {
        return room.robot_from_screen.translation.z;
    }
    let [rx, ry] = room.table_range_m;
    if x < rx[1] && y > ry[0] && y < ry[1] { room.table_m } else { room.desk_m }
}

/// How far the lowest point of a turned toy is below its origin, m.
fn depth_below(parts: &[ToyPart], turn: &UnitQuaternion<f64>) -> f64 {
    let mut lowest = f64::MAX;
    for part in parts {
        for corner in triangles(&part.shape).iter().flatten() {
            lowest = lowest.min((turn * (part.toy_from_shape * Point3::from(*corner))).z);
        }
    }
    -lowest
}

fn distance_to(arms: &[Item], point: &Vector3<f64>) -> f64 {
    let mut nearest = f64::MAX;
    for item in arms {
        let (reach_m, thick_m) = match &item.shape {
            Shape::Capsule { radius_m, half_length_m } => (*half_length_m, *radius_m),
            Shape::Box { half_m } => (0.0, half_m.min()),
            _ => continue,
        };
        for z in [-1.0, -0.5, 0.0, 0.5, 1.0] {
            let at = item.body_from_shape * Point3::new(0.0, 0.0, z * reach_m);
            nearest = nearest.min((at.coords - point).norm() - thick_m);
        }
    }
    nearest
}
