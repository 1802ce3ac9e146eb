//! What can be seen: the robot's shapes, table, touchscreen, toys, board, and the room.

use nalgebra::{Isometry3, Vector3};
use plumbline_model::Chessboard;
use plumbline_model::robot::LinkIndex;

use crate::hand_look::{self, HandLook};
use crate::physics::World;
use crate::physics::parts::{self, Side};
use crate::scene::{BodyIndex, Item, Light, Material, Pattern, Scenery, Shape};
use crate::toys::look::{self, Look};
use crate::toys::{Toy, ToyPart};

/// Numbers of the objects in [`Item::object`]; 0 is the room.
pub mod object {
    use crate::toys::Toy;

    /// Walls, floor, curtain, furniture.
    pub const ROOM: u16 = 0;
    /// The table's top.
    pub const TABLE: u16 = 1;
    /// The touchscreen.
    pub const SCREEN: u16 = 2;
    /// The chessboard.
    pub const BOARD: u16 = 3;
    /// Torso, neck, head, arms.
    pub const ROBOT: u16 = 4;
    /// The hand of the first arm of the rig is 5, that of the second 6.
    ///
    /// Fingers and thumb; the palm has its own number.
    pub const FIRST_HAND: u16 = 5;
    /// The palm of the first arm of the rig is 7, that of the second 8: from the wrist to the roots
    /// of the fingers, as people draw boxes of hands.
    pub const FIRST_PALM: u16 = 7;
    /// The first toy is 10, the others follow in the order of [`Toy::ALL`].
    pub const FIRST_TOY: u16 = 10;

    /// Number of a toy.
    pub fn of_toy(toy: Toy) -> u16 {
        FIRST_TOY + toy as u16
    }

    /// The toy of a number.
    pub fn toy(object: u16) -> Option<Toy> {
        Toy::ALL.into_iter().find(|toy| of_toy(*toy) == object)
    }
}

const BLACK_GLASS: Material =
    Material { albedo: [0.006, 0.006, 0.008], gloss: 0.35, pattern: Pattern::Plain };
const BEZEL: Material = Material { albedo: [0.010, 0.010, 0.011], gloss: 0.15, pattern: Pattern::Plain };
const WALL: Material = plain([0.76, 0.76, 0.74]);
const CEILING: Material = plain([0.80, 0.80, 0.78]);
const FLOOR: Material = Material {
    albedo: [0.45, 0.43, 0.39],
    gloss: 0.025,
    pattern: Pattern::Speckle { size_m: 0.03, contrast: 0.15 },
};
const WOOD: Material = Material {
    albedo: [0.55, 0.20, 0.045],
    gloss: 0.025,
    pattern: Pattern::Speckle { size_m: 0.012, contrast: 0.12 },
};
const DARK_WOOD: Material = plain([0.10, 0.045, 0.022]);
const LAMINATE: Material = Material {
    albedo: [0.50, 0.50, 0.47],
    gloss: 0.025,
    pattern: Pattern::Speckle { size_m: 0.0045, contrast: 0.75 },
};
const CURTAIN: Material = Material {
    albedo: [0.012, 0.013, 0.020],
    gloss: 0.0,
    pattern: Pattern::Folds { period_m: 0.11, contrast: 0.55 },
};
const METAL: Material = Material { albedo: [0.50, 0.50, 0.51], gloss: 0.2, pattern: Pattern::Plain };

const fn plain(albedo: [f32; 3]) -> Material {
    Material { albedo, gloss: 0.0, pattern: Pattern::Plain }
}

/// Everything visible now.
pub(crate) fn scenery(world: &World, board: Chessboard, revision: u64) -> Scenery {
    let mut items = vec![];
    room(&mut items);
    furniture(world, &mut items);
    robot(world, &mut items);
    toys(world, &mut items);
    if world.board().is_some() {
        items.push(Item {
            object: object::BOARD,
            body: BodyIndex(world.board_body()),
            body_from_shape: Isometry3::identity(),
            shape: Shape::Board { board },
            material: plain([0.80, 0.80, 0.80]),
        });
    }
    Scenery { revision, items, light: Light::default() }
}

/// A room like the one in the laboratory: desk, walls, a black curtain two meters away.
fn room(items: &mut Vec<Item>) {
    let mut put = |middle_m: [f64; 3], half_m: [f64; 3], material: Material| {
        items.push(block(object::ROOM, BodyIndex(0), middle_m, half_m, material));
    };
    put([0.6, 0.0, -0.76], [2.6, 2.4, 0.01], FLOOR);
    put([0.6, 0.0, 1.95], [2.6, 2.4, 0.01], CEILING);
    put([2.22, 0.0, 0.6], [0.02, 2.4, 1.4], WALL);
    put([0.6, -1.35, 0.6], [2.6, 0.02, 1.4], WALL);
    put([0.6, 1.75, 0.6], [2.6, 0.02, 1.4], WALL);
    put([-1.2, 0.0, 0.6], [0.02, 2.4, 1.4], WALL);
    // Two halves of the curtain with a gap, and the bright wall under it.
    put([2.03, 0.50, 0.80], [0.02, 0.48, 0.72], CURTAIN);
    put([2.03, -0.46, 0.80], [0.02, 0.44, 0.72], CURTAIN);
    // A dark cupboard and a window front to the left, a box on the floor.
    put([1.1, 1.70, 0.0], [0.16, 0.03, 0.75], DARK_WOOD);
    put([1.9, 0.95, -0.05], [0.10, 0.10, 0.13], plain([0.03, 0.022, 0.018]));
    // The desk: its edge shows beside and behind the laminate.
    put([0.53, 0.0, -0.002], [0.64, 0.56, 0.018], WOOD);
    // What lies on its far end.
    put([0.98, 0.16, 0.028], [0.10, 0.08, 0.004], plain([0.72, 0.74, 0.76]));
    put([0.98, -0.02, 0.026], [0.05, 0.06, 0.003], plain([0.02, 0.02, 0.022]));
    put([0.92, -0.36, 0.030], [0.03, 0.10, 0.012], plain([0.70, 0.70, 0.70]));
    put([0.90, -0.28, 0.035], [0.035, 0.03, 0.020], plain([0.02, 0.02, 0.02]));
    // The steel bar in front of the robot.
    put([0.035, 0.0, 0.058], [0.03, 0.17, 0.010], METAL);
}

fn furniture(world: &World, items: &mut Vec<Item>) {
    let places = world.places();
    let [x, y] = places.table_half_m;
    let [u, v] = places.screen_size_m;
    let body = |name: &str| BodyIndex(world.body_named(name).unwrap_or(0));
    // As thick as the gap to the desk underneath.
    items.push(block(object::TABLE, body("table"), [0.0, 0.0, -0.018], [x, y, 0.018], LAMINATE));
    let screen = body("screen");
    items.push(block(object::SCREEN, screen, [0.0, 0.0, 0.003], [0.5 * u, 0.5 * v, 0.003], BLACK_GLASS));
    // The frame is a hair lower than the glass and broader on the near side.
    let (margin, near) = (0.018, 0.032);
    items.push(block(
        object::SCREEN,
        screen,
        [0.0, 0.5 * (near - margin), 0.0040],
        [0.5 * u + margin, 0.5 * (v + near + margin), 0.0035],
        BEZEL,
    ));
}

fn robot(world: &World, items: &mut Vec<Item>) {
    let rig = world.rig();
    let sides = parts::sides(rig);
    let palms = hand_look::palms(rig);
    let look = HandLook::default();
    for (i, link) in rig.description.links().iter().enumerate() {
        let index = LinkIndex(i);
        let Some(body) = world.body_of_link(index).map(BodyIndex) else { continue };
        let is_palm = palms.contains(&Some(index));
        let object = match sides[i] {
            Side::Hand(arm) if is_palm => object::FIRST_PALM + arm as u16,
            Side::Hand(arm) => object::FIRST_HAND + arm as u16,
            Side::Arm(_) | Side::Body => object::ROBOT,
        };
        let mut put = |body, drawn: Vec<hand_look::Drawn>| {
            items.extend(drawn.into_iter().map(|(body_from_shape, shape, material)| Item {
                object,
                body,
                body_from_shape,
                shape,
                material,
            }));
        };
        let outer = world.body_named(&format!("{}.outer", link.name)).map(BodyIndex);
        if let (Some(finger), Some(outer)) = (parts::finger(rig, index), outer) {
            let (near, far) = hand_look::finger(&finger, &look);
            put(body, near);
            put(outer, far);
            continue;
        }
        for visual in &link.visuals {
            let (place, shape) = parts::shape_of(visual);
            put(
                body,
                match (&shape, sides[i]) {
                    (Shape::Box { half_m }, _) if is_palm => hand_look::palm(&place, half_m, &look),
                    (_, Side::Hand(_)) => hand_look::thumb(&place, &shape, &look),
                    _ => vec![(place, shape, parts::material_of(visual, sides[i]))],
                },
            );
        }
    }
}

fn toys(world: &World, items: &mut Vec<Item>) {
    for toy in Toy::ALL.into_iter().filter(|toy| world.toy(*toy).is_some()) {
        let Some(body) = world.body_named(&format!("toy.{}", toy.name())) else { continue };
        let item = |part: &ToyPart| Item {
            object: object::of_toy(toy),
            body: BodyIndex(body),
            body_from_shape: part.toy_from_shape,
            shape: part.shape.clone(),
            material: part.material,
        };
        if (world.toy_size() - 1.0).abs() < f64::EPSILON {
            items.extend(toy.look().iter().map(item));
        } else {
            let look = Look { scale: world.toy_size(), ..Look::default() };
            items.extend(look::parts(toy, &look).iter().map(item));
        }
    }
}

fn block(object: u16, body: BodyIndex, middle_m: [f64; 3], half_m: [f64; 3], material: Material) -> Item {
    Item {
        object,
        body,
        body_from_shape: Isometry3::translation(middle_m[0], middle_m[1], middle_m[2]),
        shape: Shape::Box { half_m: Vector3::from(half_m) },
        material,
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use plumbline_model::robot::Rig;

    use super::*;
    use crate::scenario::Scenario;

    #[test]
    fn all_items_hang_on_bodies_of_the_snapshot_and_toys_come_and_go() {
        let rig = Arc::new(Rig::built_in("nico").expect("valid"));
        let mut world = World::new(rig, &Scenario::built_in("lab").expect("valid"), 1).expect("a world");
        let board = Chessboard::new(8, 5, 0.03).expect("valid");
        let all = scenery(&world, board, 0);
        let bodies = world.snapshot().robot_from_body.len();
        assert!(all.items.iter().all(|item| item.body.0 < bodies));
        for toy in Toy::ALL {
            assert!(all.items.iter().any(|item| item.object == object::of_toy(toy)), "{toy:?}");
            assert_eq!(object::toy(object::of_toy(toy)), Some(toy));
        }
        let count = |object| all.items.iter().filter(|item| item.object == object).count();
        for hand in 0..2 {
            // Three fingers of two pieces with a ring and a tip, a thumb with two rings and a tip.
            assert_eq!(count(object::FIRST_HAND + hand), 3 * 4 + 4);
            assert!(count(object::FIRST_PALM + hand) > 5);
        }
        assert!(!all.items.iter().any(|item| item.object == object::BOARD));
        world.remove_toy(Toy::Duck);
        world.hold_board(Some(plumbline_model::Pose::identity()));
        let later = scenery(&world, board, 1);
        assert!(!later.items.iter().any(|item| item.object == object::of_toy(Toy::Duck)));
        assert!(later.items.iter().any(|item| item.object == object::BOARD));
    }
}
