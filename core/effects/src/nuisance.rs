//! What nobody wants to know but has to find: where screens and external devices stand, and where
//! markers sit, and what is constant where one thing was watched.

use std::collections::BTreeMap;

use nalgebra::{Translation3, UnitQuaternion, Vector3};

use crate::forward::{Assumed, Tangents};
use crate::measurements::Measurements;
use crate::observation::{Observation, What};

/// A frame is known no better than this beforehand, m and rad.
const FRAME_SD: f64 = 0.5;
/// A marker that was mounted anew sits this near its nominal place, m …
const MOUNT_SD_M: f64 = 0.05;
/// … and is turned against where it was found at first by this, rad.
const MOUNT_SD_RAD: f64 = 0.5;
/// What is constant of a stand beforehand: bearings and the angle between both rays.
const OFFSET_SD: f64 = 0.2;

/// One direction in which something moves that is found along with the effects.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Nuisance {
    /// Of the frame that a session shares with those of its label: shifts along x, y, z, then turns.
    Frame {
        /// The first session with it.
        session: usize,
        /// 0–5.
        axis: usize,
    },
    /// Of the marker at a session's tip: shifts along the tip's x, y, z, then turns about its own.
    Mount {
        /// The session.
        session: usize,
        /// 0–5.
        axis: usize,
    },
    /// What is constant of one coordinate while one thing is watched: it cannot be told there whether the
    /// mount, a zero of the neck or the place that somebody wrote down is off.
    Offset {
        /// The stand, see [`Observation::stand`].
        stand: usize,
        /// Its natural coordinate.
        coordinate: usize,
    },
}

impl Nuisance {
    /// Standard deviation beforehand, m or rad: wide, so that what rows do not tell stays where it is.
    pub fn prior_sd(self) -> f64 {
        match self {
            Self::Frame { .. } => FRAME_SD,
            Self::Offset { .. } => OFFSET_SD,
            Self::Mount { axis, .. } => {
                if axis < 3 {
                    MOUNT_SD_M
                } else {
                    MOUNT_SD_RAD
                }
            }
        }
    }

    /// How far it stands from where it is expected, m or rad. Frames can be anywhere.
    pub fn value(self, assumed: &Assumed) -> f64 {
        match self {
            Self::Mount { session, axis } if axis < 3 => assumed.mount(session).translation.vector[axis],
            Self::Offset { stand, coordinate } => assumed.offset(stand)[coordinate],
            Self::Mount { .. } | Self::Frame { .. } => 0.0,
        }
    }
}

impl Measurements {
    /// The session whose frame a session shares: the first one of its label, else itself.
    pub fn frame_of(&self, session: usize) -> usize {
        let Some(label) = &self.apparatuses[session].external_frame else { return session };
        self.apparatuses
            .iter()
            .position(|other| other.external_frame.as_ref() == Some(label))
            .unwrap_or(session)
    }

    /// Everything that is free with these rows.
    pub fn nuisances(&self) -> Vec<Nuisance> {
        let count = self.apparatuses.len();
        let (mut framed, mut mounted, mut turned) =
            (vec![false; count], vec![false; count], vec![false; count]);
        for row in self.rows.iter().filter(|row| row.what.is_placed()) {
            framed[self.frame_of(row.session)] = true;
            if self.feels_mount(row) {
                mounted[row.session] = true;
                turned[row.session] |= row.what == What::OrientedPose;
            }
        }
        let frames = (0..count).filter(|&session| framed[session]);
        let mut all: Vec<Nuisance> =
            frames.flat_map(|session| (0..6).map(move |axis| Nuisance::Frame { session, axis })).collect();
        for session in (0..count).filter(|&session| mounted[session]) {
            let axes = if turned[session] { 6 } else { 3 };
            all.extend((0..axes).map(|axis| Nuisance::Mount { session, axis }));
        }
        let stands: BTreeMap<usize, usize> =
            self.rows.iter().filter_map(|row| Some((row.stand?, row.what.len()))).collect();
        for (stand, coordinates) in stands {
            all.extend((0..coordinates).map(|coordinate| Nuisance::Offset { stand, coordinate }));
        }
        all
    }

    /// Whether a row measured a marker whose place is not known.
    pub(crate) fn feels_mount(&self, row: &Observation) -> bool {
        row.what.is_pose() && row.marker == 0 && self.apparatuses[row.session].tip_is_unknown
    }

    /// How a coordinate of a row changes with a nuisance.
    pub fn nuisance_slope(
        &self,
        row: &Observation,
        tangents: &Tangents,
        coordinate: usize,
        nuisance: Nuisance,
    ) -> f64 {
        match nuisance {
            Nuisance::Frame { session, axis } => {
                let own = row.what.is_placed() && self.frame_of(row.session) == session;
                if own { tangents.gauge[(coordinate, axis)] } else { 0.0 }
            }
            Nuisance::Mount { session, axis } => {
                let own = row.session == session && self.feels_mount(row);
                if own { tangents.mount[(coordinate, axis)] } else { 0.0 }
            }
            Nuisance::Offset { stand, coordinate: own } => {
                if row.stand == Some(stand) && own == coordinate {
                    row.what.offset_unit()
                } else {
                    0.0
                }
            }
        }
    }

    /// Moves frames and mounts by a step, one value per nuisance. Turns of a frame go no further than
    /// `furthest_rad`: the tangent does not reach.
    pub fn move_nuisances(
        &self,
        assumed: &mut Assumed,
        nuisances: &[Nuisance],
        step: &[f64],
        furthest_rad: f64,
    ) {
        let sessions = self.apparatuses.len();
        let mut frames = vec![None::<[f64; 6]>; sessions];
        let mut mounts = vec![None::<[f64; 6]>; sessions];
        for (nuisance, value) in nuisances.iter().zip(step) {
            let (of, session, axis) = match *nuisance {
                Nuisance::Frame { session, axis } => (&mut frames, session, axis),
                Nuisance::Mount { session, axis } => (&mut mounts, session, axis),
                Nuisance::Offset { stand, coordinate } => {
                    assumed.shift_offset(stand, coordinate, *value);
                    continue;
                }
            };
            of[session].get_or_insert([0.0; 6])[axis] = *value;
        }
        for (session, twist) in frames.into_iter().enumerate() {
            let Some(mut twist) = twist else { continue };
            shorten(&mut twist, furthest_rad);
            let placement = self.moved(session, &assumed.placements[session], &twist);
            for other in (0..sessions).filter(|&other| self.frame_of(other) == session) {
                assumed.placements[other] = placement;
            }
        }
        for (session, twist) in mounts.into_iter().enumerate() {
            let Some(mut twist) = twist else { continue };
            shorten(&mut twist, furthest_rad);
            let mut mount = assumed.mount(session);
            mount.translation =
                Translation3::from(mount.translation.vector + Vector3::new(twist[0], twist[1], twist[2]));
            mount.rotation *= UnitQuaternion::from_scaled_axis(Vector3::new(twist[3], twist[4], twist[5]));
            assumed.set_mount(session, mount);
        }
    }
}

fn shorten(twist: &mut [f64; 6], furthest_rad: f64) {
    let turn = twist[3].hypot(twist[4]).hypot(twist[5]);
    let shrink = (furthest_rad / turn.max(1e-12)).min(1.0);
    twist.iter_mut().for_each(|value| *value *= shrink);
}
