//! Effects that are taken for given, sized by the touches and by their usual sizes: least squares with
//! every parameter drawn to zero as far as robots usually have it (the posterior mode under normal
//! priors). The screen's place is fitted with them; where the eyes have seen it, it ties the arm to the
//! eyes, and the zero of the neck's turn is fitted, too.

use nalgebra::{DMatrix, DVector, Isometry3, Matrix3, Matrix6, Rotation3, UnitQuaternion, Vector3, Vector6};
use plumbline_effects::measurements::Observation;
use plumbline_effects::{Assumed, Effect, Measurements, Present};
use plumbline_model::robot::Rig;
use plumbline_model::session::Touchscreen;

use crate::seen::{Looked, SeenHands};
use crate::usual::{NOISE_M, SCREEN_SD, is_first_zero, moves_palm};

/// What the neck's zero is off by, usually, rad: as the library of effects has it.
pub const NECK_SD_RAD: f64 = 0.026;
/// What all hands are seen beside where they are, standard deviation per axis, m: no hand is quite of the shape
/// that the rig file gives it.
const BESIDE_SD_M: f64 = 0.0015;
/// Unknowns before the effects: six of the screen, one of the neck, six of the eyes in the head (turn,
/// then shift), three of how hands are seen.
const FRAME: usize = 16;
/// Where those of neck and eyes begin, and those of how hands are seen.
const NECK: usize = 6;
const BESIDE: usize = 13;
/// Scale of the robust loss of hands, standard deviations: one may be mistaken for its shadow. Of touches it counts
/// in what they are off by typically, if that is more: a screen may have been met with a knuckle.
const ROBUST: f64 = 2.5;
/// Median of what is off, in standard deviations per axis, of three axes.
const MEDIAN_OF_THREE: f64 = 0.888;

/// What is known besides the touches.
#[derive(Clone, Copy)]
pub struct Known<'a> {
    /// The robot as described.
    pub rig: &'a Rig,
    /// The screen, as the eyes see it.
    pub screen: Option<&'a SeenScreen>,
    /// Hands that the eyes saw.
    pub hands: Option<&'a SeenHands>,
    /// Zero of the neck's turn and its standard deviation, rad: by the body that the eyes saw, or as necks
    /// usually are.
    pub neck_rad: (f64, f64),
    /// How well it is known how the eyes sit in the head: turn (rad), then shift (m), axes of the head.
    pub mount: &'a Matrix6<f64>,
    /// This robot's arm is off by this share of what robots usually are. What is only between finger and
    /// screen counts in full.
    pub share: f64,
}

/// A fit.
pub struct Fit {
    /// Effects with their values, and where the screen lies.
    pub assumed: Assumed,
    /// Covariance of the values, in units of the parameters, effects in turn.
    pub covariance: DMatrix<f64>,
    /// Zero of the neck's turn (true less encoder, rad) and its standard deviation; `None` when the eyes
    /// have seen nothing that tells it.
    pub neck_rad: Option<(f64, f64)>,
    /// Zero of the neck and place of the eyes in the head, as [`Looked::moved`] takes them.
    eyes: [f64; 7],
    /// How far all hands are seen beside where they are, m.
    beside_m: Vector3<f64>,
}

/// The screen as the eyes see it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeenScreen {
    /// Middle of its image and its axes (u, v, into the glass) by the eyes, their neck's zeros taken for
    /// right.
    pub robot_from_screen: Isometry3<f64>,
    /// Covariance of shift and turn of its middle, robot axes, m and rad.
    pub covariance: Matrix6<f64>,
}

/// Where a screen lies: the middle of its image, axes u, v and into the glass, robot frame.
pub fn pose(screen: &Touchscreen) -> Isometry3<f64> {
    let (u, v) = (screen.u_axis.vector(), screen.v_axis.vector());
    let into = -screen.normal().vector();
    let turn = Matrix3::from_columns(&[u, into.cross(&u), into]);
    let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(turn));
    debug_assert!((into.cross(&u) - v).norm() < 0.05);
    Isometry3::from_parts(screen.point_at(screen.middle()).coords.coords.into(), rotation)
}

/// Rounds of linearizing.
const ROUNDS: usize = 10;
/// In the first of them every touch counts in full: an arm as described may be far off everywhere.
const IN_FULL: usize = 2;

/// Fits effects to rows of one session of touches, and to what the eyes saw. `None` when the rows cannot be
/// predicted.
pub fn fit(
    measurements: &Measurements,
    rows: &[&Observation],
    effects: &[Effect],
    known: &Known<'_>,
) -> Option<Fit> {
    let typical: Vec<f64> =
        effects.iter().flat_map(|effect| effect.parameters().iter().map(|p| p.typical)).collect();
    let count = FRAME + typical.len();
    let prior = information_before(effects, known)?;
    let mut usual = DVector::<f64>::zeros(count);
    usual[NECK] = known.neck_rad.0;
    let looked = Looked::new(known.rig);
    let mut assumed = Assumed {
        effects: effects
            .iter()
            .map(|effect| Present { effect: effect.clone(), values: vec![0.0; effect.parameters().len()] })
            .collect(),
        placements: vec![Isometry3::identity()],
        ..Assumed::default()
    };
    // Where the fit stands, in the units of the tangents.
    let mut at = DVector::<f64>::zeros(count);
    let mut inverse = DMatrix::identity(count, count);
    for round in 0..ROUNDS {
        let mut normal = prior.clone();
        let mut right = &prior * (&usual - &at);
        let counts =
            if round < IN_FULL { vec![1.0; rows.len()] } else { counts(measurements, rows, &assumed)? };
        for (row, counts) in rows.iter().zip(counts) {
            let tangents = measurements.tangents(row, &assumed, effects)?;
            for (k, noise_m) in NOISE_M.into_iter().enumerate() {
                let slope = DVector::from_fn(count, |i, _| match i {
                    0..NECK => tangents.gauge[(k, i)],
                    NECK..FRAME => 0.0,
                    _ => tangents.effects[(k, i - FRAME)],
                });
                let weight = counts * noise_m.powi(-2);
                normal += &slope * slope.transpose() * weight;
                right += slope * ((row.measured[k] - tangents.predicted[k]) * weight);
            }
        }
        let eyes: [f64; 7] = std::array::from_fn(|k| at[NECK + k]);
        if let Some(screen) = known.screen {
            let (slopes, off) = tie(&looked, screen, known.rig, &assumed.placements[0], &eyes);
            let information = screen.covariance.try_inverse()?;
            let mut frame = normal.view_mut((0, 0), (FRAME, FRAME));
            frame += slopes.transpose() * information * &slopes;
            let mut frame = right.rows_mut(0, FRAME);
            frame += slopes.transpose() * (information * off);
        }
        if let Some(hands) = known.hands {
            let beside_m = Vector3::from_fn(|k, _| at[BESIDE + k]);
            for (slopes, off, information) in
                hands.against(&looked, &assumed, effects, NECK, &eyes, &beside_m)?
            {
                let weight = 1.0 / (1.0 + (off.transpose() * information * off).x / ROBUST.powi(2));
                normal += slopes.transpose() * information * &slopes * weight;
                right += slopes.transpose() * (information * off) * weight;
            }
        }
        let factor = normal.cholesky()?;
        let change = factor.solve(&right);
        inverse = factor.inverse();
        let twist: [f64; 6] = std::array::from_fn(|k| change[k]);
        assumed.placements[0] = measurements.moved(0, &assumed.placements[0], &twist);
        at += &change;
        let mut k = FRAME;
        for present in &mut assumed.effects {
            for value in &mut present.values {
                *value = at[k] * typical[k - FRAME];
                k += 1;
            }
        }
        if round >= IN_FULL && change.amax() < 1e-7 {
            break;
        }
    }
    let n = typical.len();
    let covariance = DMatrix::from_fn(n, n, |r, c| inverse[(FRAME + r, FRAME + c)] * typical[r] * typical[c]);
    let is_told = known.screen.is_some() || known.neck_rad.1 < NECK_SD_RAD;
    let neck_rad = is_told.then(|| (at[NECK], inverse[(NECK, NECK)].max(0.0).sqrt()));
    let eyes = std::array::from_fn(|k| at[NECK + k]);
    let beside_m = Vector3::from_fn(|k, _| at[BESIDE + k]);
    Some(Fit { assumed, covariance, neck_rad, eyes, beside_m })
}

/// How much each touch counts, 0–1: the farther off beside the others, the less.
fn counts(measurements: &Measurements, rows: &[&Observation], assumed: &Assumed) -> Option<Vec<f64>> {
    let off = |row: &&Observation| {
        let predicted = measurements.predict(row, assumed)?;
        let squares = NOISE_M.iter().enumerate().map(|(k, m)| ((row.measured[k] - predicted[k]) / m).powi(2));
        Some((squares.sum::<f64>() / NOISE_M.len() as f64).sqrt())
    };
    let off: Vec<f64> = rows.iter().map(off).collect::<Option<_>>()?;
    let typical = (median(&off) / MEDIAN_OF_THREE).max(1.0);
    Some(off.iter().map(|off| 1.0 / (1.0 + (off / (ROBUST * typical)).powi(2))).collect())
}

/// The middle one of values, the upper one of two; 0 of none.
fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied().unwrap_or_default()
}

/// What is known of the unknowns before anything is measured: the inverse of their covariance, effects in
/// their usual sizes.
fn information_before(effects: &[Effect], known: &Known<'_>) -> Option<DMatrix<f64>> {
    let shares = effects.iter().flat_map(|effect| {
        // The zero of the first joint turns arm and screen together: touches cannot tell its size.
        let told = moves_palm(effect) && !is_first_zero(effect, known.rig);
        let share = if told { known.share } else { 1.0 };
        vec![share; effect.parameters().len()]
    });
    let frame = (0..FRAME).map(|k| match k {
        0..NECK => SCREEN_SD[k / 3],
        NECK => known.neck_rad.1,
        BESIDE.. => BESIDE_SD_M,
        _ => 1.0,
    });
    let sd: Vec<f64> = frame.chain(shares).collect();
    let mut prior = DMatrix::from_diagonal(&DVector::from_fn(sd.len(), |k, _| sd[k].powi(-2)));
    prior.view_mut((NECK + 1, NECK + 1), (6, 6)).copy_from(&known.mount.try_inverse()?);
    Some(prior)
}

/// How far the screen as seen lies from where `placement` has it (shift, turn), and how that changes with
/// the placement's twist and with neck and eyes.
fn tie(
    looked: &Looked<'_>,
    seen: &SeenScreen,
    rig: &Rig,
    placement: &Isometry3<f64>,
    eyes: &[f64; 7],
) -> (DMatrix<f64>, Vector6<f64>) {
    let by_arm = placement.inverse() * pose(&rig.touchscreen);
    let off = |eyes: &[f64; 7]| {
        let by_eyes = looked.moved(eyes) * seen.robot_from_screen;
        let shift = by_eyes.translation.vector - by_arm.translation.vector;
        let turn = (by_eyes.rotation * by_arm.rotation.inverse()).scaled_axis();
        Vector6::new(shift.x, shift.y, shift.z, turn.x, turn.y, turn.z)
    };
    let mut slopes = DMatrix::zeros(6, FRAME);
    // The placement moves the robot's points: the screen goes the other way.
    slopes.view_mut((0, 0), (6, 6)).fill_diagonal(-1.0);
    const STEP: f64 = 1e-4;
    for k in 0..eyes.len() {
        let (mut ahead, mut behind) = (*eyes, *eyes);
        ahead[k] += STEP;
        behind[k] -= STEP;
        slopes.set_column(NECK + k, &((off(&behind) - off(&ahead)) / (2.0 * STEP)));
    }
    (slopes, off(eyes))
}

/// A touch that was held out counts as off by no more than so many times the middle one.
const FARTHEST_TOUCH: f64 = 3.0;

/// Error on rows that were not fitted, each group of repeats held out once: rms of the distance along
/// the glass and of the height together, m. What a few touches are off by beside the others does not decide.
pub fn held_out_m(measurements: &Measurements, effects: &[Effect], known: &Known<'_>) -> Option<f64> {
    let mut off_m = vec![];
    for cell in 0..measurements.cell_count() {
        let (back, used): (Vec<&Observation>, Vec<&Observation>) =
            measurements.rows.iter().partition(|row| row.cell == cell);
        let fitted = fit(measurements, &used, effects, known)?;
        for row in back {
            let predicted = measurements.predict(row, &fitted.assumed)?;
            off_m.push((0..3).map(|k| (row.measured[k] - predicted[k]).powi(2)).sum::<f64>().sqrt());
        }
    }
    let most_m = FARTHEST_TOUCH * median(&off_m);
    let squares: f64 = off_m.iter().map(|m| m.min(most_m).powi(2)).sum();
    (!off_m.is_empty()).then(|| (squares / off_m.len() as f64).sqrt())
}

/// Hands that were left out are looked at in so many parts, each left out once.
const PARTS: usize = 4;
/// A hand that is found elsewhere counts as no farther than so many squared standard deviations.
const FARTHEST: f64 = 9.0;

/// How far hands that were not fitted lie from where the eyes saw them: squared standard deviations per hand.
/// `None`: no hands were seen, or they cannot be predicted.
pub fn hands_held_out(measurements: &Measurements, effects: &[Effect], known: &Known<'_>) -> Option<f64> {
    let hands = known.hands?;
    let rows: Vec<&Observation> = measurements.rows.iter().collect();
    let looked = Looked::new(known.rig);
    let mut far = 0.0;
    for part in 0..PARTS {
        let used = hands.only(|i| i % PARTS != part);
        let fitted = fit(measurements, &rows, effects, &Known { hands: Some(&used), ..*known })?;
        let (eyes, beside_m) = (&fitted.eyes, &fitted.beside_m);
        let back = hands.only(|i| i % PARTS == part);
        for (_, off, information) in back.against(&looked, &fitted.assumed, effects, NECK, eyes, beside_m)? {
            far += (off.transpose() * information * off).x.min(FARTHEST);
        }
    }
    (!hands.seen.is_empty()).then(|| far / hands.seen.len() as f64)
}

#[cfg(test)]
mod tests {
    use plumbline_effects::Surface;
    use plumbline_effects::arm::Arm;
    use plumbline_effects::measurements::What;
    use plumbline_model::Pixel;

    use plumbline_effects::Kind;

    use super::*;
    use crate::made_up::postures;
    use crate::seen::SeenHand;
    use crate::usual::{measurements, row};

    const PALM: &str = "right_palm_center";

    const TIP: &str = "right_index_tip";
    const ZERO_RAD: f64 = 0.03;

    /// Touches on a grid and hands over the table of a robot whose first joint alone is off, and what the
    /// eyes see of its screen, without noise.
    fn measured(rig: &Rig) -> (Measurements, SeenScreen, SeenHands) {
        let screen = &rig.touchscreen;
        let pixels =
            (0..12).map(|i| Pixel::new(900.0 + 250.0 * f64::from(i % 4), 300.0 + 350.0 * f64::from(i / 4)));
        let on_glass: Vec<_> = pixels.map(|pixel| screen.point_at(pixel).coords.coords).collect();
        let arm = Arm::of_rig(rig, TIP).expect("an arm");
        let zero = Effect::find("joint-zero", "r_shoulder_z", None, Some(&arm), None).expect("known");
        let truth = Assumed {
            effects: vec![Present { effect: zero, values: vec![ZERO_RAD] }],
            placements: vec![Isometry3::identity()],
            ..Assumed::default()
        };
        let rows =
            postures(rig, TIP, &on_glass).into_iter().map(|angles| row(What::Touch, angles, vec![1.0; 6]));
        let mut touches = measurements(rig, arm, Some(Surface::of(screen)), rows.collect());
        for k in 0..touches.rows.len() {
            let felt = touches.predict(&touches.rows[k], &truth).expect("predicted");
            touches.rows[k].measured = felt;
        }
        let over = [[0.25, -0.3], [0.35, -0.2], [0.3, -0.05], [0.25, 0.1]];
        let over = over.map(|[x, y]| Vector3::new(x, y, 0.15));
        let rows = postures(rig, PALM, &over).into_iter().map(|angles| row(What::Pose, angles, vec![1.0; 6]));
        let arm = measurements(rig, Arm::of_rig(rig, PALM).expect("an arm"), None, rows.collect());
        let seen = arm.rows.iter().map(|row| SeenHand {
            palm_m: Vector3::from_column_slice(&arm.predict(row, &truth).expect("predicted")),
            information: nalgebra::Matrix3::identity() / 2e-3f64.powi(2),
        });
        let seen = seen.collect();
        let covariance = Matrix6::from_diagonal(&Vector6::new(1e-6, 1e-6, 1e-6, 6e-6, 6e-6, 6e-6));
        let screen = SeenScreen { robot_from_screen: pose(screen), covariance };
        (touches, screen, SeenHands { arm, seen })
    }

    #[test]
    fn a_touch_that_is_far_off_beside_the_others_does_not_bend_the_fit() {
        const KNUCKLE_M: f64 = 0.03;
        let rig = Rig::built_in("nico").expect("valid");
        let (mut touches, screen, hands) = measured(&rig);
        let arm = touches.apparatuses[0].arm.as_ref().expect("an arm");
        let zeros: Vec<Effect> = Effect::sites(Kind::JointZero, Some(arm), None)
            .into_iter()
            .filter(|effect| !effect.site.is_empty())
            .collect();
        let mount = Matrix6::from_diagonal(&Vector6::new(1e-6, 1e-6, 1e-6, 3e-7, 3e-7, 3e-7));
        let truth = touches.clone();
        // How far the touches that are as they should be are off on average, m.
        let off_m = |touches: &Measurements| {
            let known = Known {
                rig: &rig,
                screen: Some(&screen),
                hands: Some(&hands),
                neck_rad: (0.0, 0.003),
                mount: &mount,
                share: 1.0,
            };
            let rows: Vec<&Observation> = touches.rows.iter().collect();
            let fitted = fit(touches, &rows, &zeros, &known).expect("predicted");
            let of_row = |row: &Observation| {
                let predicted = truth.predict(row, &fitted.assumed).expect("predicted");
                (Vector3::from_column_slice(&predicted) - Vector3::from_column_slice(&row.measured)).norm()
            };
            truth.rows.iter().skip(1).map(of_row).sum::<f64>() / (truth.rows.len() - 1) as f64
        };
        let undisturbed_m = off_m(&touches);
        touches.rows[0].measured[0] += KNUCKLE_M;
        let bent_m = off_m(&touches) - undisturbed_m;
        assert!(bent_m < 0.02 * KNUCKLE_M, "{undisturbed_m} m, {bent_m} m more with it");
        // Half of them are off: that is the robot, not a knuckle.
        for row in touches.rows.iter_mut().step_by(2) {
            row.measured[0] += KNUCKLE_M;
        }
        let split_m = off_m(&touches) - undisturbed_m;
        assert!(split_m > 0.1 * KNUCKLE_M, "{split_m} m");
    }

    #[test]
    fn the_turn_that_arm_screen_and_head_share_is_told_by_the_body_and_by_nothing_else() {
        let rig = Rig::built_in("nico").expect("valid");
        let (touches, screen, hands) = measured(&rig);
        assert!(
            touches.rows.len() >= 8 && hands.seen.len() >= 3,
            "{} {}",
            touches.rows.len(),
            hands.seen.len()
        );
        let mount = Matrix6::from_diagonal(&Vector6::new(1e-6, 1e-6, 1e-6, 3e-7, 3e-7, 3e-7));
        let rows: Vec<&Observation> = touches.rows.iter().collect();
        let arm = touches.apparatuses[0].arm.as_ref().expect("an arm");
        let zeros: Vec<Effect> = Effect::sites(Kind::JointZero, Some(arm), None)
            .into_iter()
            .filter(|effect| !effect.site.is_empty())
            .collect();
        let fitted = |neck_rad: (f64, f64), share: f64| {
            let known = Known {
                rig: &rig,
                screen: Some(&screen),
                hands: Some(&hands),
                neck_rad,
                mount: &mount,
                share,
            };
            let fitted = fit(&touches, &rows, &zeros, &known).expect("predicted");
            (fitted.assumed.effects[0].values[0], fitted.covariance[(0, 0)].sqrt(), fitted.neck_rad)
        };
        for share in [0.03, 1.0] {
            let (zero_rad, sd_rad, neck) = fitted((0.0, 0.003), share);
            assert!((zero_rad - ZERO_RAD).abs() < 0.004, "{zero_rad} ± {sd_rad}");
            assert!(sd_rad < 0.006 && neck.expect("told").1 <= 0.003, "{sd_rad} {neck:?}");
            let (_, without_rad, _) = fitted((0.0, NECK_SD_RAD), share);
            assert!(without_rad > 2.0 * sd_rad, "{without_rad} against {sd_rad}");
        }
    }
}
