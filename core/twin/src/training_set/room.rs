//! Rooms like the laboratory's: walls, curtain, desk, laminate, touchscreen.

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use plumbline_model::robot::Rig;

use super::clutter;
use super::dice::Dice;
use crate::scene::{BodyIndex, Item, Material, Pattern, Shape};

/// What toys can lie on.
#[derive(Clone, Debug)]
pub(super) struct Room {
    /// Middle of the glass's top.
    pub robot_from_screen: Isometry3<f64>,
    /// Half of the glass's extents along x and y of the robot.
    pub screen_half_m: [f64; 2],
    /// Whether there is a touchscreen.
    pub has_screen: bool,
    /// Height of the table's top.
    pub table_m: f64,
    /// Ranges of the table along x and y.
    pub table_range_m: [[f64; 2]; 2],
    /// Height of the desk behind it.
    pub desk_m: f64,
}

pub(super) fn plain(albedo: [f32; 3]) -> Material {
    Material { albedo, gloss: 0.0, pattern: Pattern::Plain }
}

/// Collects items in the robot frame.
pub(super) fn put(items: &mut Vec<Item>, object: u16, at: Isometry3<f64>, shape: Shape, material: Material) {
    items.push(Item { object, body: BodyIndex(0), body_from_shape: at, shape, material });
}

fn block(items: &mut Vec<Item>, middle_m: [f64; 3], half_m: [f64; 3], material: Material) {
    let at = Isometry3::from_parts(Vector3::from(middle_m).into(), UnitQuaternion::identity());
    put(items, 0, at, Shape::Box { half_m: Vector3::from(half_m) }, material);
}

/// Draws a room and says what lies where.
pub(super) fn furnish(rig: &Rig, dice: &mut Dice, items: &mut Vec<Item>) -> Room {
    // Three rooms of five are about like the laboratory, the others are any.
    let like_lab = dice.chance(0.6);
    walls(like_lab, dice, items);
    let room = tables(rig, like_lab, dice, items);
    if room.has_screen {
        screen(&room, like_lab, dice, items);
    }
    before_the_robot(&room, dice, items);
    clutter::behind(&room, dice, items);
    clutter::around(&room, dice, items);
    room
}

fn walls(like_lab: bool, dice: &mut Dice, items: &mut Vec<Item>) {
    // Walls are lit from all over the room: brighter than one lamp makes them.
    let wall = if like_lab || dice.chance(0.3) { dice.gray(0.7, 1.6) } else { dice.color() };
    let side = |dice: &mut Dice| {
        let shade = dice.within_f32(0.75, 1.1);
        plain(wall.map(|c| c * shade))
    };
    let floor = if like_lab { dice.gray(0.25, 0.6) } else { dice.color() };
    let (front, left, right) = (dice.within(1.7, 2.8), dice.within(1.2, 2.3), dice.within(-2.0, -1.0));
    block(items, [0.6, 0.0, -0.76], [3.0, 3.0, 0.01], plain(floor));
    let ceiling_m = dice.within(1.5, 2.2);
    let material = side(dice);
    block(items, [0.6, 0.0, ceiling_m], [3.0, 3.0, 0.01], material);
    for (middle, half) in [
        ([front, 0.0, 0.6], [0.02, 3.0, 1.7]),
        ([0.6, right, 0.6], [3.0, 0.02, 1.7]),
        ([0.6, left, 0.6], [3.0, 0.02, 1.7]),
        ([-1.3, 0.0, 0.6], [0.02, 3.0, 1.7]),
    ] {
        let material = side(dice);
        block(items, middle, half, material);
    }
    // Lamps.
    for _ in 0..dice.count(0, 4) {
        let at = dice.place([0.0, -1.0, 0.0], [1.8, 1.5, 0.0]);
        let bright = dice.within_f32(1.0, 2.5);
        block(
            items,
            [at.x, at.y, ceiling_m - 0.01],
            [dice.within(0.08, 0.3), dice.within(0.08, 0.4), 0.01],
            plain([bright; 3]),
        );
    }
    if like_lab || dice.chance(0.7) {
        curtain(front - 0.1, like_lab, dice, items);
    }
    if like_lab && dice.chance(0.8) {
        // Glass above a white panel, a dark door, a box on the floor.
        let x = dice.within(0.5, 1.1);
        block(items, [x, left - 0.05, 0.1], [0.08, 0.03, 0.8], plain([0.10, 0.045, 0.022]));
        let (pane, deep) = (dice.gray(0.02, 0.4), dice.within(0.2, 0.5));
        block(items, [x + 0.1 + deep, left - 0.05, 1.0], [deep, 0.02, 0.25], plain(pane));
        let at = [dice.within(1.4, 1.9), dice.within(0.7, left - 0.1), dice.within(-0.3, 0.05)];
        block(items, at, [0.1, 0.1, 0.13], plain(dice.gray(0.015, 0.06)));
    }
    // A door, a cupboard, windows and pictures at the walls.
    for _ in 0..dice.count(1, 5) {
        let material = if dice.chance(0.5) { plain(dice.gray(0.01, 0.9)) } else { plain(dice.color()) };
        let (w, h, z) = (dice.within(0.08, 0.5), dice.within(0.1, 0.9), dice.within(-0.3, 1.1));
        match dice.count(0, 2) {
            0 => block(items, [dice.within(0.2, 2.0), left - 0.04, z], [w, 0.03, h], material),
            1 => block(items, [dice.within(0.2, 2.0), right + 0.04, z], [w, 0.03, h], material),
            _ => block(items, [front - 0.03, dice.within(right, left), z], [0.02, w, h], material),
        }
    }
}

fn curtain(x_m: f64, like_lab: bool, dice: &mut Dice, items: &mut Vec<Item>) {
    let albedo = if like_lab || dice.chance(0.4) { dice.gray(0.003, 0.025) } else { dice.color() };
    let folds = Pattern::Folds { period_m: dice.within_f32(0.06, 0.16), contrast: dice.within_f32(0.1, 0.6) };
    let material = Material { albedo, gloss: 0.0, pattern: folds };
    let (middle, gap) = (dice.within(-0.4, 0.4), dice.within(0.0, 0.08));
    let (low, high) = (dice.within(-0.15, 0.2), dice.within(1.3, 1.9));
    for side in [-1.0, 1.0] {
        let half = dice.within(0.35, 0.75);
        let y = middle + side * (half + gap);
        block(items, [x_m, y, 0.5 * (low + high)], [0.02, half, 0.5 * (high - low)], material);
    }
}

fn wood(dice: &mut Dice) -> Material {
    let shade = dice.within_f32(0.35, 1.3);
    let tint = dice.within_f32(0.6, 1.6);
    Material {
        albedo: [0.58 * shade, 0.22 * shade * tint.sqrt(), 0.055 * shade * tint],
        gloss: dice.within_f32(0.0, 0.029),
        pattern: Pattern::Speckle {
            size_m: dice.within_f32(0.006, 0.03),
            contrast: dice.within_f32(0.03, 0.25),
        },
    }
}

fn table_top(like_lab: bool, dice: &mut Dice) -> Material {
    if like_lab || dice.chance(0.4) {
        // Black and white grains.
        return Material {
            albedo: dice.gray(0.35, 0.70),
            gloss: dice.within_f32(0.0, 0.029),
            pattern: Pattern::Speckle {
                size_m: dice.within_f32(0.0018, 0.0055),
                contrast: dice.within_f32(0.45, 1.15),
            },
        };
    }
    if dice.chance(0.4) {
        return wood(dice);
    }
    let albedo = if dice.chance(0.5) { dice.gray(0.02, 0.9) } else { dice.color() };
    let size_m = dice.within_f32(0.002, 0.05);
    let pattern = Pattern::Speckle { size_m, contrast: dice.within_f32(0.0, 0.6) };
    Material { albedo, gloss: dice.within_f32(0.0, 0.029), pattern }
}

fn tables(rig: &Rig, like_lab: bool, dice: &mut Dice, items: &mut Vec<Item>) -> Room {
    let table_m = rig.table.height_m + dice.within(-0.02, 0.02);
    let [x, y] = [rig.table.x_range_m, rig.table.y_range_m];
    let far = x[1] + dice.within(-0.04, 0.10);
    let wide = [y[0] + dice.within(-0.12, 0.08), y[1] + dice.within(-0.08, 0.12)];
    let desk_m =
        if dice.chance(0.5) { table_m - dice.within(0.0, 0.006) } else { table_m - dice.within(0.01, 0.05) };
    let top = table_top(like_lab, dice);
    let (mx, my) = (0.5 * (x[0] + far), 0.5 * (wide[0] + wide[1]));
    block(items, [mx, my, table_m - 0.016], [0.5 * (far - x[0]), 0.5 * (wide[1] - wide[0]), 0.016], top);
    let desk = if like_lab || dice.chance(0.6) { wood(dice) } else { table_top(false, dice) };
    let (deep, half) = (dice.within(0.9, 1.4), dice.within(0.5, 0.75));
    let desk_low = desk_m - 0.02;
    block(items, [0.5 * deep - 0.1, 0.0, desk_low], [0.5 * deep + 0.1, half, 0.02], desk);
    let screen = &rig.touchscreen;
    let middle = screen.origin.coords.coords
        + 0.5 * (screen.u_axis.vector() * screen.width_m + screen.v_axis.vector() * screen.height_m);
    let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), dice.normal(0.10));
    let shift = Vector3::new(dice.normal(0.02), dice.normal(0.03), 0.0);
    let at = Vector3::new(middle.x, middle.y, table_m + dice.within(0.002, 0.022)) + shift;
    Room {
        robot_from_screen: Isometry3::from_parts(at.into(), turn),
        screen_half_m: [0.5 * screen.height_m, 0.5 * screen.width_m],
        has_screen: like_lab || dice.chance(0.85),
        table_m,
        table_range_m: [[x[0], far], wide],
        desk_m,
    }
}

fn screen(room: &Room, like_lab: bool, dice: &mut Dice, items: &mut Vec<Item>) {
    let gloss = match dice.within(0.0, 1.0) {
        p if p < if like_lab { 0.85 } else { 0.4 } => dice.within_f32(0.03, 0.06),
        p if p < 0.9 => dice.within_f32(0.075, 0.20),
        _ => dice.within_f32(0.0, 0.40),
    };
    let glass = Material { albedo: dice.gray(0.001, 0.012), gloss, pattern: Pattern::Plain };
    let frame = Material {
        albedo: dice.gray(0.003, 0.02),
        gloss: dice.within_f32(0.02, 0.15),
        pattern: Pattern::Plain,
    };
    let [x, y] = room.screen_half_m;
    let over_m = (room.robot_from_screen.translation.z - room.table_m).max(0.002);
    let deep = 0.5 * (over_m + 0.006);
    let at = |dx: f64, dy: f64, dz: f64| room.robot_from_screen * Translation3::new(dx, dy, dz);
    let shape = |hx: f64, hy: f64, hz: f64| Shape::Box { half_m: Vector3::new(hx, hy, hz) };
    put(items, 0, at(0.0, 0.0, -deep), shape(x, y, deep), glass);
    let margin = dice.within(0.012, 0.024);
    let near = margin + dice.within(0.0, 0.025);
    let middle = -0.5 * (near - margin);
    put(items, 0, at(middle, 0.0, -deep - 0.0006), shape(x + 0.5 * (near + margin), y + margin, deep), frame);
    if dice.chance(0.7) {
        // The maker's mark.
        let mark = plain(dice.gray(0.3, 0.9));
        put(items, 0, at(-x - 0.5 * near, dice.within(-0.02, 0.02), 0.0), shape(0.004, 0.009, 0.0004), mark);
    }
    if dice.chance(0.22) {
        // It shows something: windows, pictures, a cross.
        for _ in 0..dice.count(1, 5) {
            let bright = dice.within_f32(0.1, 1.3);
            let color = if dice.chance(0.5) { dice.gray(0.6, 1.0) } else { dice.color() };
            let (hx, hy) = (dice.within(0.003, 0.5 * x), dice.within(0.003, 0.6 * y));
            let lit = plain(color.map(|c| c * bright));
            let place =
                at(dice.within(hx - x, x - hx), dice.within(hy - y, y - hy), dice.within(0.0001, 0.0004));
            put(items, 0, place, shape(hx, hy, 0.0003), lit);
        }
    }
}

/// A steel bar and wooden things stand between the robot and its table.
fn before_the_robot(room: &Room, dice: &mut Dice, items: &mut Vec<Item>) {
    if dice.chance(0.85) {
        let steel = Material {
            albedo: dice.gray(0.25, 0.85),
            gloss: dice.within_f32(0.02, 0.35),
            pattern: Pattern::Plain,
        };
        let (x, y) = (dice.within(0.0, 0.07), dice.normal(0.03));
        block(items, [x, y, room.table_m + 0.012], [0.03, dice.within(0.08, 0.2), 0.012], steel);
    }
    for _ in 0..dice.count(0, 3) {
        let material = wood(dice);
        let at = dice.place([0.03, -0.12, room.table_m], [0.13, 0.12, room.table_m + 0.02]);
        block(
            items,
            at.into(),
            [dice.within(0.008, 0.05), dice.within(0.02, 0.12), dice.within(0.004, 0.03)],
            material,
        );
    }
    for _ in 0..dice.count(0, 4) {
        let at = dice.place([-0.02, -0.15, room.table_m], [0.10, 0.15, room.table_m + 0.05]);
        let material = plain(dice.gray(0.005, 0.3));
        block(
            items,
            at.into(),
            [dice.within(0.005, 0.02), dice.within(0.005, 0.03), dice.within(0.005, 0.02)],
            material,
        );
    }
}
