//! What is put somewhere: the touchscreen on its block, the weight in the hand, the toys, the chessboard.

use mujoco_rs::mujoco_c::mjtEnableBit;
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use plumbline_model::{Board, Pose, Robot};
use rand::{Rng, SeedableRng, rngs::StdRng};

use super::World;
use super::look::isometry;
use crate::error::TwinError;
use crate::physics::place::Places;
use crate::toys::Toy;

/// The body that is moved by hand: the board.
const BOARD_MOCAP: usize = 0;
/// Blocks under the touchscreen may be this high, m.
const HIGHEST_BLOCK_M: f64 = 0.2;
/// The hand may carry this much, kg.
const HEAVIEST_KG: f64 = 0.5;
/// Where toys are that were put away.
const SHELF_M: [f64; 3] = [-3.0, 0.0, 0.4];

impl World {
    /// Puts the touchscreen on a block of this height (0: back on the table), straight up.
    ///
    /// # Errors
    /// When the block is too high or not a number.
    pub fn raise_screen(&mut self, by_m: f64) -> Result<(), TwinError> {
        if !(0.0..=HIGHEST_BLOCK_M).contains(&by_m) {
            return Err(TwinError::Value {
                what: "the height of the block under the touchscreen",
                value: format!("{by_m} m"),
                remedy: "give 0 to 0.2 m",
            });
        }
        let before = self.places;
        self.places = self.level;
        self.places.raise_screen(by_m);
        self.raised_m = by_m;
        self.move_screen(&before);
        Ok(())
    }

    /// Puts the touchscreen where it belongs. It is a part of the world and no body that could move, for what
    /// lies on such a one never sleeps, and what never sleeps creeps.
    /// What stands on it goes with it; `before`: where all was.
    fn move_screen(&mut self, before: &Places) {
        let at_m: [f64; 3] = self.places.robot_from_screen.translation.vector.into();
        // Where parts of the world are is computed anew only while nothing may sleep.
        for may_sleep in [false, true] {
            let Some(mut model) = self.spare.take() else { return };
            model.body_pos_mut()[self.screen_body] = at_m;
            let sleep = mjtEnableBit::mjENBL_SLEEP as i32;
            let flags = &mut model.opt_mut().enableflags;
            *flags = if may_sleep { *flags | sleep } else { *flags & !sleep };
            self.spare = Some(self.data.swap_model(model));
            self.data.forward();
        }
        if let Some(model) = &mut self.spare {
            model.opt_mut().enableflags |= mjtEnableBit::mjENBL_SLEEP as i32;
        }
        for toy in Toy::ALL {
            let Some(mut place) = self.toy(toy) else { continue };
            let at_m = place.translation.vector;
            let height_m = |places: &Places| places.surface_m(at_m.x, at_m.y);
            let rise_m = height_m(&self.places) - height_m(before);
            if rise_m != 0.0 {
                place.translation.vector.z += rise_m;
                self.put_toy(toy, place);
            }
        }
    }

    /// Height of the block under the touchscreen, m.
    pub fn screen_raised_m(&self) -> f64 {
        self.raised_m
    }

    /// Hangs a weight into the right palm (0: takes it off). It pulls; it has no inertia.
    ///
    /// # Errors
    /// When it is too heavy or not a number.
    pub fn load_hand(&mut self, mass_kg: f64) -> Result<(), TwinError> {
        if !(0.0..=HEAVIEST_KG).contains(&mass_kg) {
            return Err(TwinError::Value {
                what: "the weight in the hand",
                value: format!("{mass_kg} kg"),
                remedy: "give 0 to 0.5 kg",
            });
        }
        let palm = self.rig.arm("right").and_then(|arm| arm.joints.last().copied());
        let palm = palm.and_then(|joint| {
            let child = self.rig.description.joint(joint).child;
            self.body_of_link(child)
        });
        if let Some(body) = palm {
            self.data.xfrc_applied_mut()[body] = [0.0, 0.0, -9.81 * mass_kg, 0.0, 0.0, 0.0];
            self.load_kg = mass_kg;
        }
        Ok(())
    }

    /// The weight in the right hand, kg.
    pub fn hand_load_kg(&self) -> f64 {
        self.load_kg
    }

    /// Puts a toy on the table (or on what stands there).
    ///
    /// # Errors
    /// When the place is not on the table.
    pub fn place_toy(&mut self, toy: Toy, x_m: f64, y_m: f64) -> Result<(), TwinError> {
        if !self.places.on_table(x_m, y_m) {
            return Err(TwinError::Value {
                what: "the place of a toy",
                value: format!("({x_m:.3}, {y_m:.3}) m"),
                remedy: "choose a place on the table",
            });
        }
        // The glass on the table is thin: a toy is put down from above it anyway.
        let below_m = match self.raised_m {
            0.0 => self.places.table_height_m(x_m, y_m),
            _ => self.places.surface_m(x_m, y_m),
        };
        let z_m = below_m + self.toy_size * toy.rest_height_m() + 0.004;
        let mut random = StdRng::seed_from_u64(self.seed.wrapping_mul(31).wrapping_add(toy as u64));
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), random.random_range(-0.6..0.6));
        self.put_toy(toy, Isometry3::from_parts(Translation3::new(x_m, y_m, z_m), turn));
        Ok(())
    }

    /// Size of toys, times that of the usual ones.
    pub(crate) fn toy_size(&self) -> f64 {
        self.toy_size
    }

    /// Puts a toy anywhere, also into the air.
    pub fn put_toy(&mut self, toy: Toy, robot_from_toy: Isometry3<f64>) {
        let state = &mut self.toys[toy as usize];
        state.out = true;
        let (qpos, dof) = (state.qpos, state.dof);
        let (p, q) = (robot_from_toy.translation.vector, robot_from_toy.rotation.quaternion());
        let at = [p.x, p.y, p.z, q.w, q.i, q.j, q.k];
        self.data.qpos_mut()[qpos..qpos + 7].copy_from_slice(&at);
        self.data.qvel_mut()[dof..dof + 6].fill(0.0);
        self.data.forward();
    }

    /// Puts a toy away.
    pub fn remove_toy(&mut self, toy: Toy) {
        self.toys[toy as usize].out = false;
        self.pin_shelf();
        self.data.forward();
    }

    /// Where a toy is; `None` when it was put away.
    pub fn toy(&self, toy: Toy) -> Option<Isometry3<f64>> {
        let state = &self.toys[toy as usize];
        let q = &self.data.qpos()[state.qpos..state.qpos + 7];
        state.out.then(|| isometry([q[0], q[1], q[2]], [q[3], q[4], q[5], q[6]]))
    }

    /// Toys that were put away stay where they are.
    pub(super) fn pin_shelf(&mut self) {
        for (i, toy) in self.toys.iter().enumerate().filter(|(_, toy)| !toy.out) {
            let at = [SHELF_M[0], SHELF_M[1] + 0.3 * i as f64, SHELF_M[2], 1.0, 0.0, 0.0, 0.0];
            self.data.qpos_mut()[toy.qpos..toy.qpos + 7].copy_from_slice(&at);
            self.data.qvel_mut()[toy.dof..toy.dof + 6].fill(0.0);
        }
    }

    /// Holds the chessboard somewhere, or puts it away.
    pub fn hold_board(&mut self, robot_from_board: Option<Pose<Robot, Board>>) {
        // What a person lays down lies on what is there.
        let robot_from_board = robot_from_board.map(|mut pose| {
            let lift_m = self.places.lift_m(&pose.isometry, &plumbline_model::default_board());
            pose.isometry.translation.vector.z += lift_m;
            pose
        });
        self.board = robot_from_board;
        let place = robot_from_board.map_or(Isometry3::translation(0.0, 0.0, -2.0), |pose| pose.isometry);
        let q = place.rotation.quaternion();
        self.data.mocap_pos_mut()[BOARD_MOCAP] = place.translation.vector.into();
        self.data.mocap_quat_mut()[BOARD_MOCAP] = [q.w, q.i, q.j, q.k];
        self.data.forward();
    }

    /// Where the chessboard is held.
    pub fn board(&self) -> Option<Pose<Robot, Board>> {
        self.board
    }
}
