//! How the head stands on the robot: its eyes look down at the robot's own body, whose edges the rig
//! file describes.
//!
//! A board of unknown place tells how the eyes sit to the joints of the head; turned to the side about
//! the neck's axis, everything would look the same. The body does not turn with the head, and it is near:
//! a tenth of a degree moves its edges by as much as it moves an object on the table by half a millimeter.

use nalgebra::{
    DMatrix, DVector, Isometry3, Matrix6, Point3, Translation3, UnitQuaternion, Vector2, Vector3,
};
use plumbline_effects::robot_model::Mounted;
use plumbline_fit::NECK_SD_RAD;
use plumbline_grasp::Body;
use plumbline_model::robot::{BodyEdges, Rig};
use plumbline_model::{Eye, JobContext};
use serde::{Deserialize, Serialize};

use crate::HandEyeError;
use crate::edges::{profile, steepest};
use crate::picture::{Picture, from_head_poses};

/// Turns and nod of the head (rad) from which it looks down at the body: as low as its counterweights let it
/// turn.
const TURNS_RAD: [f64; 5] = [0.0, 0.15, 0.3, -0.3, -0.15];
const NOD_RAD: f64 = -0.7;
/// Places along each edge.
const SAMPLES: usize = 40;
/// Edges are looked for this far from where they should be, first and later, px.
const WINDOW_PX: [f64; 3] = [9.0, 6.0, 4.0];
/// Levels are taken over these places beside each other along the edge, px.
const BESIDE_PX: [f64; 5] = [-2.0, -1.0, 0.0, 1.0, 2.0];
/// Scale of the robust loss, px.
const ROBUST_PX: f64 = 0.5;
const ROUNDS: usize = 9;
/// Fewer edge points tell nothing.
const FEWEST: usize = 100;
/// An edge that is found at fewer of its places in an image is not seen there.
const SEEN: usize = SAMPLES / 2;
/// Neighboring places share their noise: so many of them count as one.
const ALIKE: f64 = 4.0;
/// Edges that fit worse than this are not those of the rig file, rms, px.
const WORST_PX: f64 = 0.8;
/// Lenses leave this much at the border of the image, px.
const LENS_PX: f64 = 0.15;
/// The neck, the eyes in the head (turn, shift), the body (turn, shift).
const UNKNOWNS: usize = 13;
/// Where the body's unknowns begin.
const BODY: usize = 7;
/// What the description says of how far bodies are off counts as so many numbers that were measured.
const DESCRIBED: f64 = 1.0;

/// The head as it stands on the robot.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SeenBody {
    /// Zero of the neck's turn: true less encoder, rad.
    pub neck_rad: f64,
    /// One standard deviation, rad.
    pub neck_sd_rad: f64,
    /// Rms of the edges, px.
    pub rms_px: f64,
    /// Edge points that were found.
    pub points: usize,
    /// This body is off by this share of what the description allows for.
    #[serde(default)]
    pub share_of_described: Option<f64>,
}

impl SeenBody {
    /// Head poses from which it is looked at, at most.
    pub const LOOKS: usize = TURNS_RAD.len();
}

/// Looks down at the body from some head poses. `rig` has its eyes as calibrated, `mounted` says how well that
/// is known. `None` when the rig describes no edges, they are not seen, or they do not fit. Only the head moves.
///
/// # Errors
/// When the robot does not carry it out, or it is cancelled.
pub fn see(
    body: &mut dyn Body,
    rig: &Rig,
    mounted: &Mounted,
    looks: &mut dyn FnMut(usize),
    context: &dyn JobContext,
) -> Result<Option<SeenBody>, HandEyeError> {
    if rig.outlines.body.is_none() {
        return Ok(None);
    }
    let pictures = from_head_poses(body, &poses_rad(rig), looks, context)?;
    Ok(fit(rig, &mounted.covariance, mounted.rest_sigma_rad[0], &pictures))
}

/// Head poses (turn and nod) that look down and are allowed.
fn poses_rad(rig: &Rig) -> Vec<[f64; 2]> {
    let (home, head) = (rig.home(), [rig.eyes.pan, rig.eyes.tilt]);
    let is_allowed = |pose_rad: &[f64; 2]| {
        let wanted = home.with(&head, pose_rad);
        head.iter().all(|joint| rig.limits_in(*joint, &wanted).contain(wanted[*joint]))
    };
    TURNS_RAD.map(|turn_rad| [turn_rad, NOD_RAD]).into_iter().filter(is_allowed).collect()
}

/// Fits the head's zero to the edges of the body. The neck comes to rest to within `rest_sd_rad`.
fn fit(
    rig: &Rig,
    mount_covariance: &Matrix6<f64>,
    rest_sd_rad: f64,
    pictures: &[Picture],
) -> Option<SeenBody> {
    let body = rig.outlines.body.as_ref()?;
    let looking = Looking { rig, body };
    let mut at = DVector::<f64>::zeros(UNKNOWNS);
    let (mut last, mut share) = (None, 1.0);
    for round in 0..ROUNDS {
        let prior = prior_information(mount_covariance, body, share)?;
        let window_px = WINDOW_PX[round.min(WINDOW_PX.len() - 1)];
        let (mut normal, mut right) = (DMatrix::<f64>::zeros(UNKNOWNS, UNKNOWNS), DVector::zeros(UNKNOWNS));
        let (mut squares, mut weights, mut points) = (0.0, 0.0, 0);
        for picture in pictures {
            for found in looking.found(picture, &at, window_px) {
                let weight = 1.0 / (1.0 + (found.off_px / ROBUST_PX).powi(2));
                normal += &found.slope * found.slope.transpose() * weight;
                right += &found.slope * (found.off_px * weight);
                squares += weight * found.off_px.powi(2);
                weights += weight;
                points += 1;
            }
        }
        if points < FEWEST {
            return None;
        }
        let rms_px = (squares / weights.max(1e-9)).sqrt();
        let scale = 1.0 / ((rms_px.powi(2) + LENS_PX.powi(2)) * ALIKE);
        let normal = normal * scale + &prior;
        let right = right * scale - &prior * &at;
        let factor = normal.cholesky()?;
        at += factor.solve(&right);
        let covariance = factor.inverse();
        share = share_of_described(body, &at, &covariance);
        last = Some((covariance[(0, 0)], rms_px, points));
    }
    let (variance, rms_px, points) = last?;
    if rms_px > WORST_PX {
        return None;
    }
    // The head comes to rest elsewhere each time.
    let views = (pictures.len() / 2).max(1) as f64;
    let rest_rad = rest_sd_rad / views.sqrt();
    let neck_sd_rad = variance.sqrt().hypot(rest_rad);
    Some(SeenBody { neck_rad: at[0], neck_sd_rad, rms_px, points, share_of_described: Some(share) })
}

/// How far this body is off, as a share of what the description allows for: that the body is turned about the
/// neck's axis looks like a neck that is off, but a body that is where it should be in all that can be seen of
/// it was put together well in that, too. A step of expectation maximization for the common variance of its
/// turn and shift (Dempster, Laird and Rubin 1977): what cannot be seen adds nothing.
fn share_of_described(body: &BodyEdges, at: &DVector<f64>, covariance: &DMatrix<f64>) -> f64 {
    let squares = (0..6).map(|k| {
        let variance = described_sd(body, k).powi(2);
        (at[BODY + k].powi(2) + covariance[(BODY + k, BODY + k)]) / variance
    });
    ((DESCRIBED + squares.sum::<f64>()) / (DESCRIBED + 6.0)).sqrt()
}

/// How far bodies are off by the description: turn (rad), then shift (m).
fn described_sd(body: &BodyEdges, k: usize) -> f64 {
    if k < 3 { body.turn_sd_rad } else { body.shift_sd_m }
}

/// What is known before: the neck as necks usually are, the eyes by the board, the body as described and by
/// how much this one seems to be off.
fn prior_information(mount: &Matrix6<f64>, body: &BodyEdges, share: f64) -> Option<DMatrix<f64>> {
    let mut covariance = DMatrix::<f64>::zeros(UNKNOWNS, UNKNOWNS);
    covariance[(0, 0)] = NECK_SD_RAD.powi(2);
    covariance.view_mut((1, 1), (6, 6)).copy_from(mount);
    for k in 0..6 {
        covariance[(BODY + k, BODY + k)] = (share * described_sd(body, k)).powi(2);
    }
    Some(covariance.cholesky()?.inverse())
}

/// An edge point that was found: how far from where it should be, and how that place changes.
struct Found {
    off_px: f64,
    slope: DVector<f64>,
}

struct Looking<'a> {
    rig: &'a Rig,
    body: &'a BodyEdges,
}

impl Looking<'_> {
    /// The edges in one image. Whether an edge is a step to bright or to dark is the same all along it,
    /// and what most of its places say.
    fn found(&self, picture: &Picture, at: &DVector<f64>, window_px: f64) -> Vec<Found> {
        let mut all = vec![];
        for edge in &self.body.edges_m {
            let of_sign = [1.0, -1.0].map(|sign| self.of_edge(picture, at, edge, sign, window_px));
            let [brighter, darker] = of_sign;
            let more = if brighter.len() >= darker.len() { brighter } else { darker };
            if more.len() >= SEEN {
                all.extend(more);
            }
        }
        all
    }

    fn of_edge(
        &self,
        picture: &Picture,
        at: &DVector<f64>,
        [from, to]: &[Vector3<f64>; 2],
        sign: f64,
        window_px: f64,
    ) -> Vec<Found> {
        let along = (to - from).normalize() * 0.004;
        let mut found = vec![];
        for k in 0..SAMPLES {
            let point = from + (to - from) * ((k as f64 + 0.5) / SAMPLES as f64);
            let Some(pixel) = self.pixel(picture, at, &point) else { continue };
            let Some(next) = self.pixel(picture, at, &(point + along)) else { continue };
            let line = next - pixel;
            let Some(toward) = Vector2::new(-line.y, line.x).try_normalize(1e-3) else { continue };
            let levels = profile(&picture.image, &pixel, &toward, window_px, &BESIDE_PX);
            let Some(off_px) = levels.and_then(|levels| steepest(&levels, sign)) else { continue };
            let slope = DVector::from_fn(UNKNOWNS, |i, _| {
                const STEP: f64 = 1e-4;
                let mut moved = at.clone();
                moved[i] += STEP;
                self.pixel(picture, &moved, &point).map_or(0.0, |there| (there - pixel).dot(&toward) / STEP)
            });
            found.push(Found { off_px, slope });
        }
        found
    }

    /// Where a point of the body (robot frame, as described) is seen.
    fn pixel(&self, picture: &Picture, at: &DVector<f64>, point: &Vector3<f64>) -> Option<Vector2<f64>> {
        let motion = |from: usize| {
            let turn = UnitQuaternion::from_scaled_axis(at.fixed_rows::<3>(from).into_owned());
            Isometry3::from_parts(Translation3::from(at.fixed_rows::<3>(from + 3).into_owned()), turn)
        };
        let (eyes, pan) = (&self.rig.eyes, self.rig.eyes.pan);
        let mut posture = picture.posture.clone();
        posture[pan] += at[0];
        let nominal = self.rig.robot_from_left(&posture).isometry;
        let mount = eyes.head_from_left.isometry;
        let left_from_robot = (nominal * mount.inverse() * motion(1) * mount).inverse();
        // The body turns about its middle.
        let middle =
            self.body.edges_m.iter().flatten().sum::<Vector3<f64>>() / (2 * self.body.edges_m.len()) as f64;
        let lies = middle + (motion(BODY) * Point3::from(point - middle)).coords;
        let in_left = left_from_robot * Point3::from(lies);
        let in_eye = match picture.eye {
            Eye::Left => in_left,
            Eye::Right => eyes.cameras.right_from_left.isometry * in_left,
        };
        Some(eyes.cameras.camera(picture.eye).project(&in_eye.coords).ok()?.vector())
    }
}

#[cfg(test)]
mod tests {
    use plumbline_model::Unattended;

    use super::*;
    use crate::twin::TwinBody;

    /// What is seen of a twin whose head stands so far from where its encoder says.
    fn looked(rig: &Rig, zero_rad: f64) -> Option<SeenBody> {
        let text = format!(
            "format = 1\nname = \"head\"\ntitle = \"Head\"\nabout = \"A head that is turned.\"\n\
             [joint.head_z]\nencoder_zero_rad = {zero_rad}\n"
        );
        let mut body = TwinBody::new(rig, &text);
        let sd = nalgebra::Vector6::new(1e-3, 1e-3, 1e-3, 5e-4, 5e-4, 5e-4);
        let covariance = Matrix6::from_diagonal(&sd.map(|sd| sd * sd));
        let mounted = Mounted { covariance, rest_sigma_rad: [1e-3; 2] };
        see(&mut body, rig, &mounted, &mut |_| {}, &Unattended).expect("looked")
    }

    #[test]
    fn the_body_tells_how_the_head_stands_to_a_fifth_of_a_degree() {
        let rig = Rig::built_in("nico").expect("valid");
        for zero_rad in [0.0, 0.02] {
            let seen = looked(&rig, zero_rad).expect("the body is in sight");
            assert!((seen.neck_rad - zero_rad).abs() < 0.0035, "{seen:?}");
            assert!((0.0005..0.006).contains(&seen.neck_sd_rad), "{seen:?}");
        }
    }

    #[test]
    fn a_body_that_is_off_tells_less_of_the_head_than_one_that_is_as_described() {
        let rig = Rig::built_in("nico").expect("valid");
        let right = looked(&rig, 0.0).expect("the body is in sight");
        let mut other = rig.clone();
        let body = other.outlines.body.as_mut().expect("it is described");
        let off_m = Vector3::new(1.5, -1.5, 1.5) * body.shift_sd_m;
        body.edges_m.iter_mut().flatten().for_each(|end| *end += off_m);
        let off = looked(&other, 0.0).expect("the body is in sight");
        let share = |seen: &SeenBody| seen.share_of_described.expect("told");
        assert!(share(&right) < 0.6 && share(&off) > 1.5 * share(&right), "{right:?} {off:?}");
        assert!(off.neck_sd_rad > 1.3 * right.neck_sd_rad, "{right:?} {off:?}");
        // Within what it says of itself.
        assert!(right.neck_rad.abs() < 3.0 * right.neck_sd_rad, "{right:?}");
        assert!(off.neck_rad.abs() < 3.0 * off.neck_sd_rad, "{off:?}");
    }

    #[test]
    fn a_body_that_is_not_described_is_not_looked_at() {
        let mut rig = Rig::built_in("nico").expect("valid");
        rig.outlines.body = None;
        assert_eq!(looked(&rig, 0.0), None);
    }
}
