//! Things that lie about and are no toys.

use nalgebra::{Isometry3, Vector3};

use super::dice::Dice;
use super::room::{Room, plain, put};
use crate::scene::{Item, Material, Pattern, Shape};
use crate::toys::along;

/// What lies on the far desk: papers, a laptop, a power strip, cables.
pub(super) fn behind(room: &Room, dice: &mut Dice, items: &mut Vec<Item>) {
    let far = room.table_range_m[0][1];
    for _ in 0..dice.count(1, 6) {
        let at = dice.place([far + 0.06, -0.5, room.desk_m], [far + 0.5, 0.5, room.desk_m]);
        let tone = if dice.chance(0.5) { dice.gray(0.5, 0.95) } else { dice.gray(0.004, 0.08) };
        let half = Vector3::new(dice.within(0.02, 0.12), dice.within(0.02, 0.14), dice.within(0.002, 0.015));
        let place = Isometry3::from_parts((at + Vector3::z() * half.z).into(), dice.heading());
        put(items, 0, place, Shape::Box { half_m: half }, plain(tone));
    }
    for _ in 0..dice.count(0, 4) {
        let (black, bright) = (dice.gray(0.003, 0.03), dice.gray(0.5, 0.9));
        let color = if dice.chance(0.8) { black } else { bright };
        let height_m = room.desk_m + 0.004;
        let start = dice.place([0.3, -0.6, height_m], [far + 0.4, 0.6, height_m]);
        cable(start, color, dice, items);
    }
}

fn cable(start: Vector3<f64>, color: [f32; 3], dice: &mut Dice, items: &mut Vec<Item>) {
    let (mut at, mut heading) = (start, dice.within(-3.1, 3.1));
    let radius_m = dice.within(0.0015, 0.0045);
    for _ in 0..dice.count(4, 12) {
        heading += dice.normal(0.5);
        let next = at + Vector3::new(heading.cos(), heading.sin(), dice.normal(0.05)) * 0.03;
        let shape = Shape::Capsule { radius_m, half_length_m: 0.5 * (next - at).norm() };
        put(items, 0, along(at, next), shape, plain(color));
        at = next;
    }
}

/// Things of any form and color that are no toys. Balls have colors that no toy has.
pub(super) fn around(room: &Room, dice: &mut Dice, items: &mut Vec<Item>) {
    let many = if dice.chance(0.35) { 0 } else { dice.count(1, 9) };
    for _ in 0..many {
        let at = dice.place([0.1, -0.6, room.table_m], [1.0, 0.6, room.table_m]);
        let color = match dice.count(0, 3) {
            0 => dice.gray(0.003, 0.9),
            1 => *dice.pick(&[[0.6, 0.02, 0.015], [0.85, 0.6, 0.02], [0.8, 0.8, 0.78], [0.85, 0.14, 0.015]]),
            _ => dice.color(),
        };
        let material =
            Material { albedo: color, gloss: dice.within_f32(0.0, 0.029), pattern: Pattern::Plain };
        let flat = dice.chance(0.35);
        match dice.count(0, 4) {
            0 | 1 => {
                let s = dice.within(0.006, 0.05);
                let thick = if flat { 0.0015 } else { s * dice.within(0.2, 1.2) };
                let half = Vector3::new(s, s * dice.within(0.3, 2.0), thick);
                let place = Isometry3::from_parts((at + Vector3::z() * thick).into(), dice.heading());
                put(items, 0, place, Shape::Box { half_m: half }, material);
            }
            2 => {
                // Pens, rods, bottles.
                let radius_m = dice.within(0.002, 0.012);
                let half_length_m = dice.within(4.0, 9.0) * radius_m;
                let up = at + Vector3::z() * radius_m;
                let way = dice.heading() * Vector3::x() * half_length_m;
                put(
                    items,
                    0,
                    along(up - way, up + way),
                    Shape::Capsule { radius_m, half_length_m },
                    material,
                );
            }
            3 => {
                let (radius_m, half_length_m) = (dice.within(0.01, 0.045), dice.within(0.01, 0.07));
                let place = Isometry3::translation(at.x, at.y, at.z + half_length_m);
                put(items, 0, place, Shape::Cylinder { radius_m, half_length_m }, material);
            }
            _ => {
                let cool = *dice.pick(&[
                    [0.02, 0.06, 0.5],
                    [0.03, 0.35, 0.06],
                    [0.25, 0.03, 0.35],
                    [0.012, 0.012, 0.013],
                    [0.03, 0.3, 0.35],
                ]);
                let r = dice.within(0.008, 0.045);
                let place = Isometry3::translation(at.x, at.y, at.z + r);
                let shape = Shape::Ellipsoid { radii_m: Vector3::new(r, r * dice.within(0.8, 1.2), r) };
                put(items, 0, place, shape, Material { albedo: cool, ..material });
            }
        }
    }
    // A wire of a bright color across everything.
    if dice.chance(0.2) {
        let color = *dice.pick(&[
            [0.6, 0.02, 0.015],
            [0.85, 0.6, 0.02],
            [0.8, 0.8, 0.78],
            [0.85, 0.14, 0.015],
            [0.02, 0.06, 0.5],
        ]);
        let height_m = room.table_m + 0.005;
        let start = dice.place([0.1, -0.5, height_m], [0.7, 0.5, height_m]);
        cable(start, color, dice, items);
    }
}
