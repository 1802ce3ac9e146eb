//! Where the screen lies, measured by touching it.

use nalgebra::{
    Isometry3, Matrix2, Matrix3, Matrix6, Rotation3, Translation3, UnitQuaternion, Vector2, Vector3,
};

use super::PlacementError;
use crate::decompose;
use crate::frame::{Point, Robot};
use crate::pixel::Pixel;
use crate::session::{Screen, Touchscreen};
use crate::spread::NORMAL_95;

/// Spread of a single touch per axis that is assumed while there are too few touches to judge it, m.
pub const USUAL_NOISE_M: f64 = 1.5e-3;
/// From this many degrees of freedom on (three per touch, less six) the residuals are believed.
const TELLING_FREEDOM: usize = 9;
/// Touches must spread at least this far (standard deviation across their longest line), m.
const LEAST_SPREAD_M: f64 = 0.02;
/// A placement that leaves more than this (rms) is no placement, m.
const LARGEST_RMS_M: f64 = 0.03;
/// Touches that disagree by more than this (per axis) show errors of the arm, m.
const ARM_ERROR_M: f64 = 3e-3;
/// No screen on a table leans more than this.
const LARGEST_LEAN_RAD: f64 = 0.05;
/// A screen turned farther than this from where it nominally lies was touched in another order.
const LARGEST_TURN_RAD: f64 = std::f64::consts::FRAC_PI_4;

/// Where the screen lies, as touches say: nominal pose moved rigidly, size kept.
#[derive(Clone, Debug, PartialEq)]
pub struct ScreenPlacement {
    /// The screen where it lies.
    pub screen: Touchscreen,
    /// How far its middle lies from its nominal place, robot frame, m.
    pub moved_m: [f64; 3],
    /// How it is turned against its nominal pose: rotation vector, robot frame, rad.
    pub turned_rad: [f64; 3],
    /// Standard deviation of `moved_m`, m.
    pub sd_m: [f64; 3],
    /// Standard deviation of `turned_rad`, rad.
    pub sd_rad: [f64; 3],
    /// √(Σ|residual|² / touches), m.
    pub rms_m: f64,
    /// Number of touches it was found from.
    pub touches: usize,
    /// Per touch, in their order: fingertip − its pixel on the placed screen, robot frame, m.
    pub residuals_m: Vec<[f64; 3]>,
    /// What the operator should know, a sentence each.
    pub remarks: Vec<String>,
    /// When it was found.
    pub at: jiff::Timestamp,
    /// Short name of the rig it belongs to; empty until [`Self::of_rig`].
    pub rig: String,
}

impl ScreenPlacement {
    /// What speaks against using it, a sentence each: touches that lie far off, touches too few and too far apart to
    /// judge, a screen that leans. The other remarks only say how it was found.
    pub fn doubts(&self) -> Vec<String> {
        let residuals: Vec<Vector3<f64>> = self.residuals_m.iter().copied().map(Into::into).collect();
        let Some((noise_m, remarks)) = self.noise() else { return Vec::new() };
        let is_few = 3 * residuals.len() - 6 < TELLING_FREEDOM && noise_m > USUAL_NOISE_M;
        let few = remarks.into_iter().filter(|_| is_few);
        few.chain(speaking_against(&residuals, noise_m, lean_rad(&self.screen, self.turned_rad.into())))
            .collect()
    }

    /// Whether its touches disagree by more than a fingertip's: the arm itself errs.
    pub fn arm_errs(&self) -> bool {
        self.noise().is_some_and(|(noise_m, _)| error_of_the_arm(noise_m).is_some())
    }

    fn noise(&self) -> Option<(f64, Vec<String>)> {
        let sum: f64 = self.residuals_m.iter().flatten().map(|along| along * along).sum();
        let touches = self.residuals_m.len();
        (touches >= 3).then(|| noise(sum, touches))
    }

    /// How far its middle may lie beside where it was found along any axis (95 %), m: what all touches share is not in it.
    pub fn known_to_m(&self) -> f64 {
        NORMAL_95 * self.sd_m.iter().fold(0.0_f64, |most, sd| most.max(*sd))
    }
}

/// Places the screen: the rigid motion (six degrees of freedom, size kept) that brings touched
/// pixels of the nominal screen nearest to where the model says the fingertip was, in the sense of
/// least squares (Horn 1987; Umeyama 1991).
///
/// The uncertainty assumes touches with the same independent spread along each axis: that of the
/// residuals, or [`USUAL_NOISE_M`] if that is larger and there are fewer than five touches; the
/// remarks say which. It does not contain what all touches share, such as a fingertip that the
/// model places wrongly.
///
/// # Errors
/// With fewer than three touches, touches on a line, beside the screen or not a number, and when
/// what is found cannot be: mirrored, turned by more than 45°, or missed by more than 30 mm.
pub fn place_screen(
    nominal: &Touchscreen,
    touches: &[(Pixel<Screen>, Point<Robot>)],
) -> Result<ScreenPlacement, PlacementError> {
    check(nominal, touches)?;
    let on_glass: Vec<Vector3<f64>> =
        touches.iter().map(|(pixel, _)| nominal.point_at(*pixel).coords.coords).collect();
    let fingertips: Vec<Vector3<f64>> = touches.iter().map(|(_, point)| point.coords.coords).collect();
    let motion = rigid_motion(&on_glass, &fingertips).ok_or_else(wild)?;
    let screen = nominal.moved(&motion);
    let residuals: Vec<Vector3<f64>> =
        touches.iter().map(|(pixel, point)| point.coords - screen.point_at(*pixel).coords).collect();
    plausible(nominal, &screen, &motion, &residuals)?;

    let sum: f64 = residuals.iter().map(Vector3::norm_squared).sum();
    let rms_m = (sum / touches.len() as f64).sqrt();
    let (noise_m, mut remarks) = noise(sum, touches.len());
    let turned = motion.rotation.scaled_axis();
    remarks.extend(speaking_against(&residuals, noise_m, lean_rad(&screen, turned)));
    remarks.extend(error_of_the_arm(noise_m));
    let middle = screen.point_at(screen.middle()).coords.coords;
    let places = touches.iter().map(|(pixel, _)| screen.point_at(*pixel).coords.coords - middle);
    let sd = standard_deviations(places, noise_m).ok_or(PlacementError::OnALine { spread_m: 0.0 })?;
    let moved = middle - nominal.point_at(nominal.middle()).coords.coords;
    Ok(ScreenPlacement {
        screen,
        moved_m: moved.into(),
        turned_rad: turned.into(),
        sd_m: [sd[0], sd[1], sd[2]],
        sd_rad: [sd[3], sd[4], sd[5]],
        rms_m,
        touches: touches.len(),
        residuals_m: residuals.into_iter().map(Into::into).collect(),
        remarks,
        at: jiff::Timestamp::now(),
        rig: String::new(),
    })
}

/// Numbers of touches that no motion can be found from.
fn wild() -> PlacementError {
    PlacementError::NotFinite { what: "a fingertip or the screen".to_owned() }
}

fn check(nominal: &Touchscreen, touches: &[(Pixel<Screen>, Point<Robot>)]) -> Result<(), PlacementError> {
    if !nominal.is_usable() {
        return Err(PlacementError::NotFinite { what: "the size or pose of the nominal screen".to_owned() });
    }
    for (i, (pixel, point)) in touches.iter().enumerate() {
        let number = i + 1;
        if !pixel.vector().iter().chain(point.coords.iter()).all(|value| value.is_finite()) {
            return Err(PlacementError::NotFinite { what: format!("touch {number}") });
        }
        if !nominal.contains(*pixel) {
            return Err(PlacementError::OffScreen {
                number,
                u_px: pixel.u_px,
                v_px: pixel.v_px,
                width_px: nominal.width_px,
                height_px: nominal.height_px,
            });
        }
    }
    if touches.len() < 3 {
        return Err(PlacementError::TooFew { touches: touches.len() });
    }
    let spread_m = spread_across_m(nominal, touches);
    if spread_m < LEAST_SPREAD_M {
        return Err(PlacementError::OnALine { spread_m });
    }
    Ok(())
}

/// Standard deviation of the touched places across the line along which they spread most, m.
fn spread_across_m(nominal: &Touchscreen, touches: &[(Pixel<Screen>, Point<Robot>)]) -> f64 {
    let [u_m, v_m] = nominal.pitch_m();
    let places: Vec<Vector2<f64>> =
        touches.iter().map(|(pixel, _)| Vector2::new(pixel.u_px * u_m, pixel.v_px * v_m)).collect();
    let count = places.len() as f64;
    let mean = places.iter().sum::<Vector2<f64>>() / count;
    let scatter: Matrix2<f64> = places.iter().map(|p| (p - mean) * (p - mean).transpose()).sum();
    decompose::symmetric_eigenvalues(scatter / count).map_or(0.0, |found| found.min().max(0.0).sqrt())
}

/// The rigid motion that takes `from` nearest to `to`.
fn rigid_motion(from: &[Vector3<f64>], to: &[Vector3<f64>]) -> Option<Isometry3<f64>> {
    let count = from.len() as f64;
    let (mean_from, mean_to) =
        (from.iter().sum::<Vector3<f64>>() / count, to.iter().sum::<Vector3<f64>>() / count);
    let covariance: Matrix3<f64> =
        from.iter().zip(to).map(|(a, b)| (b - mean_to) * (a - mean_from).transpose()).sum();
    let svd = decompose::svd(covariance, true, true)?;
    let (u, v_t) = (svd.u?, svd.v_t?);
    // Points of a plane fit a reflection as well as a rotation: the rotation is wanted.
    let mut keep = Matrix3::identity();
    keep[(2, 2)] = (u * v_t).determinant().signum();
    let rotation = Rotation3::from_matrix_unchecked(u * keep * v_t);
    let turn = UnitQuaternion::from_rotation_matrix(&rotation);
    Some(Isometry3::from_parts(Translation3::from(mean_to - turn * mean_from), turn))
}

fn plausible(
    nominal: &Touchscreen,
    screen: &Touchscreen,
    motion: &Isometry3<f64>,
    residuals: &[Vector3<f64>],
) -> Result<(), PlacementError> {
    // A mirrored order of corners fits to a screen that is turned over, without any residual.
    if screen.normal().vector().dot(&nominal.normal().vector()) < 0.0 {
        return Err(PlacementError::Mirrored);
    }
    let sum: f64 = residuals.iter().map(Vector3::norm_squared).sum();
    let rms_m = (sum / residuals.len() as f64).sqrt();
    if !(rms_m <= LARGEST_RMS_M) {
        let (i, worst_m) = residuals
            .iter()
            .map(Vector3::norm)
            .enumerate()
            .max_by(|a, b| a.1.total_cmp(&b.1))
            .unwrap_or_default();
        return Err(PlacementError::Implausible { rms_m, worst: i + 1, worst_m });
    }
    let turned_rad = motion.rotation.angle();
    if turned_rad > LARGEST_TURN_RAD {
        return Err(PlacementError::Turned { turned_rad });
    }
    Ok(())
}

/// Spread of one touch per axis (m), and where it comes from.
fn noise(sum_of_squares: f64, touches: usize) -> (f64, Vec<String>) {
    let freedom = 3 * touches - 6;
    let seen_m = (sum_of_squares / freedom as f64).sqrt();
    let seen_mm = seen_m * 1e3;
    let remark = if freedom >= TELLING_FREEDOM {
        format!("a touch is good to {seen_mm:.1} mm per axis, as the {touches} touches say themselves")
    } else if seen_m > USUAL_NOISE_M {
        format!(
            "{touches} touches are few to judge how good a touch is; {seen_mm:.1} mm per axis is assumed, since they \
             disagree by more than usual: touch more places"
        )
    } else {
        format!(
            "{touches} touches are too few to judge how good a touch is; the usual {:.1} mm per axis is assumed",
            USUAL_NOISE_M * 1e3
        )
    };
    let noise_m = if freedom >= TELLING_FREEDOM { seen_m } else { seen_m.max(USUAL_NOISE_M) };
    (noise_m, vec![remark])
}

/// So many standard deviations per axis.
const FAR: f64 = 4.6;
/// Half of all lengths of a normal vector of three components are shorter, in standard deviations per axis.
const MIDDLE_OF_CHI: f64 = 1.538;

/// The median of lengths, m.
fn middle_m(residuals: &[Vector3<f64>]) -> f64 {
    let mut lengths: Vec<f64> = residuals.iter().map(Vector3::norm).collect();
    lengths.sort_by(f64::total_cmp);
    lengths.get(lengths.len() / 2).copied().unwrap_or(0.0)
}

/// A sentence for every touch that lies far off.
fn outlying(residuals: &[Vector3<f64>], noise_m: f64) -> Vec<String> {
    // One touch in 10 000 is that far off by chance (chi², 3 degrees of freedom). Where the arm errs, all may be off by a
    // centimeter: there those count that lie far beyond the middle one.
    let limit_m = match error_of_the_arm(noise_m) {
        Some(_) => FAR * middle_m(residuals) / MIDDLE_OF_CHI,
        None => FAR * noise_m,
    };
    let far = residuals.iter().map(Vector3::norm).enumerate().filter(|(_, off_m)| *off_m > limit_m);
    far.map(|(i, off_m)| {
        format!("touch {} lies {:.1} mm beside the placed screen: touch that place again", i + 1, off_m * 1e3)
    })
    .collect()
}

/// What speaks against a place, a sentence each.
fn speaking_against(residuals: &[Vector3<f64>], noise_m: f64, lean_rad: f64) -> Vec<String> {
    let mut against = outlying(residuals, noise_m);
    if lean_rad > LARGEST_LEAN_RAD {
        against.push(format!(
            "the screen seems to lean by {:.1}° against the rig file: if it does not, errors of the arm look like that",
            lean_rad.to_degrees()
        ));
    }
    against
}

/// How far a screen leans against its nominal normal after a turn (rotation vector), rad.
fn lean_rad(screen: &Touchscreen, turned: Vector3<f64>) -> f64 {
    let normal = screen.normal().vector();
    normal.angle(&(UnitQuaternion::from_scaled_axis(-turned) * normal))
}

/// What only an arm that errs can explain. A rigid placement takes in what it can of that.
fn error_of_the_arm(noise_m: f64) -> Option<String> {
    (noise_m > ARM_ERROR_M).then(|| {
        format!(
            "the touches disagree by {:.1} mm per axis, which is more than a fingertip's: the arm itself errs, and \
             the placement is the best compromise over the touched places",
            noise_m * 1e3
        )
    })
}

/// Standard deviations of a shift of the middle (m) and of a turn about it (rad), from the places
/// of the touches (m, from the middle).
fn standard_deviations(places: impl Iterator<Item = Vector3<f64>>, noise_m: f64) -> Option<[f64; 6]> {
    let mut information = Matrix6::<f64>::zeros();
    for place in places {
        // A turn w moves the place by w × place.
        let turn = -place.cross_matrix();
        let mut view = information.fixed_view_mut::<3, 3>(0, 0);
        view += Matrix3::identity();
        let mut view = information.fixed_view_mut::<3, 3>(0, 3);
        view += turn;
        let mut view = information.fixed_view_mut::<3, 3>(3, 0);
        view += turn.transpose();
        let mut view = information.fixed_view_mut::<3, 3>(3, 3);
        view += turn.transpose() * turn;
    }
    let covariance = information.try_inverse()?;
    Some(std::array::from_fn(|i| noise_m * covariance[(i, i)].max(0.0).sqrt()))
}
