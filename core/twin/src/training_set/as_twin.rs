//! Scenes of the running twin itself: its room, light, eyes and toys, with only toys, arms and head
//! thrown by dice. What a detector scores on them is what the window will show.

use std::sync::Arc;

use nalgebra::{Isometry3, UnitQuaternion};
use plumbline_model::Chessboard;
use plumbline_model::robot::Rig;

use super::SetError;
use super::arms::{self, Bank};
use super::dice::Dice;
use super::labels::Thing;
use super::placing::{self, Placed};
use super::room::Room;
use super::scene::{choose_posture, class_of_hand, class_of_toy, look_somewhere};
use crate::physics::World;
use crate::scenario::Scenario;
use crate::scene::{Item, Scenery, Snapshot};
use crate::scenery::{object, scenery};
use crate::toys::Toy;
use crate::toys::look::Look;

/// Mixed into the seed, so that no scene is thrown by the dice of another kind of set.
const OWN_DICE: u64 = 0x7477_696e;
/// Height of the desk around the laminate, m.
const DESK_M: f64 = 0.016;

/// A scene of the running twin.
pub(super) struct TwinScene {
    everything: Scenery,
    pub snapshot: Snapshot,
    pub things: Vec<Thing>,
    pub noise_seed: u64,
}

impl TwinScene {
    /// What is drawn: all but the things without which it was asked for.
    pub fn scenery(&self, without: &[u16]) -> Scenery {
        let mut scenery = self.everything.clone();
        scenery.items.retain(|item| !without.contains(&item.object));
        scenery
    }
}

/// Makes scenes of the twin's built-in laboratory.
pub(super) struct Laboratory {
    world: World,
    board: Chessboard,
}

impl Laboratory {
    pub fn new(rig: Arc<Rig>) -> Result<Self, SetError> {
        let world = World::new(rig, &Scenario::built_in("lab")?, 1)?;
        let board = Chessboard::new(8, 5, 0.03).map_err(|error| SetError::Encode(error.to_string()))?;
        Ok(Self { world, board })
    }

    /// The scene of one pair.
    pub fn scene(&mut self, bank: &Bank, seed: u64, index: u64) -> TwinScene {
        let mut dice = Dice::of_pair(seed ^ OWN_DICE, index);
        let dice = &mut dice;
        let world = &mut self.world;
        let rig = world.rig().clone();
        world.reset();
        Toy::ALL.into_iter().for_each(|toy| world.remove_toy(toy));
        let mut posture = look_somewhere(&rig, dice);
        world.stand(&posture);
        let eyes = world.snapshot().eyes;
        for arm in 0..rig.arms.len() {
            if let Some(angles) = choose_posture(&rig, bank, arm, &posture, &eyes, dice) {
                posture = posture.with(&rig.arms[arm].joints, &angles);
            }
            posture = arms::grip(&rig, arm, &posture, dice);
        }
        world.stand(&posture);
        let in_the_way = arms_of(&scenery(world, self.board, 0), &world.snapshot());
        let room = room(world);
        let mut placed: Vec<Placed> = vec![];
        for toy in placing::choose(dice) {
            if placed.iter().all(|other| other.toy != toy) {
                let look = Look::default();
                placed.extend(placing::place(toy, &look, &room, &[], &in_the_way, &placed, dice));
            }
        }
        for one in &placed {
            world.put_toy(one.toy, one.robot_from_toy);
        }
        let (everything, snapshot) = (scenery(world, self.board, index), world.snapshot());
        let things = things(&rig, &everything, &snapshot);
        TwinScene { everything, snapshot, things, noise_seed: dice.seed() }
    }
}

/// Where toys can lie in the twin.
fn room(world: &World) -> Room {
    let places = world.places();
    let screen = places.robot_from_screen.translation;
    let table = places.robot_from_table.translation.vector;
    let [x, y] = places.table_half_m;
    let [u, v] = places.screen_size_m;
    Room {
        robot_from_screen: Isometry3::from_parts(screen, UnitQuaternion::identity()),
        screen_half_m: [0.5 * v, 0.5 * u],
        has_screen: true,
        table_m: table.z,
        table_range_m: [[table.x - x, table.x + x], [table.y - y, table.y + y]],
        desk_m: DESK_M,
    }
}

/// The robot's items with their places in the robot frame.
fn arms_of(everything: &Scenery, snapshot: &Snapshot) -> Vec<Item> {
    let robot = object::ROBOT..object::FIRST_TOY;
    let mut items: Vec<Item> =
        everything.items.iter().filter(|item| robot.contains(&item.object)).cloned().collect();
    for item in &mut items {
        item.body_from_shape = snapshot.robot_from_body[item.body.0] * item.body_from_shape;
    }
    items
}

fn things(rig: &Rig, everything: &Scenery, snapshot: &Snapshot) -> Vec<Thing> {
    let hands = rig.arms.iter().enumerate().filter_map(|(arm, one)| {
        class_of_hand(&one.name).map(|class| (object::FIRST_PALM + arm as u16, class))
    });
    let toys = Toy::ALL.into_iter().map(|toy| (object::of_toy(toy), class_of_toy(toy)));
    let thing = |(object, class)| {
        let own = everything.items.iter().filter(|item| item.object == object);
        let robot_from_shapes: Vec<_> = own
            .map(|item| (snapshot.robot_from_body[item.body.0] * item.body_from_shape, item.shape.clone()))
            .collect();
        (!robot_from_shapes.is_empty()).then_some(Thing { object, class, robot_from_shapes })
    };
    hands.chain(toys).filter_map(thing).collect()
}
