//! Which effects an arm is corrected with: none, those that a search named, or all usual ones, each drawn
//! to zero. Touches held out say which errs least.

use plumbline_effects::arm::Arm;
use plumbline_effects::{Effect, Kind, Measurements};
use plumbline_model::{Cancelled, JobContext};

use crate::fit::{Known, hands_held_out, held_out_m};
use crate::usual::{is_first_zero, usual};

/// Another model has to err less by this share on held-out touches, or the simpler one stays.
const WORTH: f64 = 0.95;
/// A few named effects have to err less by this share than all usual ones together. Names are for people: a
/// few that explain what a fingertip does may put what they leave out into the height of the glass, where the
/// palm misses it, and do not say so.
const WORTH_ALONE: f64 = 0.75;
/// The arm's effects are tried at these shares of their usual size, the simplest robot first.
const SHARES: [f64; 5] = [0.03, 0.1, 0.25, 0.5, 1.0];

/// What an arm is corrected with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Which {
    /// No effect of the arm: touches held out err no less with any.
    Nothing,
    /// Those that were named, and nothing else.
    Named,
    /// All usual ones, each drawn to zero.
    All,
}

/// Rms on touches held out, along the glass and in height together, m; `None`: it cannot be told.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HeldOut {
    /// Without effects; only the screen's place is fitted.
    pub nothing_m: Option<f64>,
    /// With those that were named.
    pub named_m: Option<f64>,
    /// With all usual ones, at the share that errs least.
    pub all_m: Option<f64>,
}

/// What was chosen.
#[derive(Clone, Debug)]
pub struct Chosen {
    /// Which.
    pub which: Which,
    /// The effects themselves.
    pub effects: Vec<Effect>,
    /// This robot's arm is off by this share of what robots usually are.
    pub share: f64,
    /// How each did.
    pub held_out: HeldOut,
}

impl Chosen {
    /// Rms on touches held out with what was chosen, m.
    pub fn error_m(&self) -> Option<f64> {
        match self.which {
            Which::Nothing => self.held_out.nothing_m,
            Which::Named => self.held_out.named_m,
            Which::All => self.held_out.all_m,
        }
    }
}

/// Compares them on touches of one arm on one screen. `known` without its share of the usual sizes, which is
/// chosen here.
///
/// # Errors
/// When it is cancelled.
pub fn choose(
    measurements: &Measurements,
    arm: &Arm,
    mut named: Vec<Effect>,
    known: &Known<'_>,
    context: &dyn JobContext,
) -> Result<Chosen, Cancelled> {
    let all = usual(arm);
    // Touches alone cannot name it: what the eyes saw sizes it.
    let first_zero = all.iter().find(|effect| is_first_zero(effect, known.rig));
    let every_zero = named.iter().any(|effect| effect.kind == Kind::JointZero && effect.is_of_every_site());
    if let Some(zero) = first_zero.filter(|zero| !named.is_empty() && !every_zero && !named.contains(zero)) {
        named.push(zero.clone());
    }
    let steps = 2 + SHARES.len();
    let error_m = |step: usize, effects: &[Effect], share: f64| {
        context.checkpoint()?;
        context.report(step as f64 / steps as f64, "comparing on touches held out");
        Ok::<_, Cancelled>(held_out_m(measurements, effects, &Known { share, ..*known }))
    };
    let nothing_m = error_m(0, &[], 1.0)?;
    let named_m = if named.is_empty() { None } else { error_m(1, &named, 1.0)? };
    // Whether this robot errs as robots usually do, or by less, the touches held out say, too.
    let (mut all_m, mut share) = (None, 1.0);
    for (k, tried) in SHARES.into_iter().enumerate() {
        let error_m = error_m(2 + k, &all, tried)?;
        if all_m.is_none() || is_better(error_m, all_m, WORTH) {
            (all_m, share) = (error_m, tried);
        }
    }
    let held_out = HeldOut { nothing_m, named_m, all_m };
    let which = which(&held_out);
    let (effects, share) = match which {
        Which::Nothing => (vec![], 1.0),
        Which::Named => (named, 1.0),
        Which::All => (all, share),
    };
    Ok(Chosen { which, effects, share, held_out })
}

/// Touches held out may err by this factor more where hands that were held out are met better.
const NO_WORSE: f64 = 1.1;

/// By which share of what robots usually are the arm is off, now that the eyes have seen its hand: of those with
/// which touches held out err about as little as they can, the one with which hands that were held out are met
/// best; `share` (of `known`) unless another one is clearly better. A fingertip on its glass may be met by an
/// arm that is hardly off and a finger that is bent; the palm then is elsewhere.
pub fn share_by_hands(measurements: &Measurements, effects: &[Effect], known: &Known<'_>) -> f64 {
    let with = |share: f64| Known { share, ..*known };
    let touches_m = SHARES.map(|share| held_out_m(measurements, effects, &with(share)));
    let least_m = touches_m.into_iter().flatten().fold(f64::INFINITY, f64::min);
    let mut best = (known.share, hands_held_out(measurements, effects, known));
    for (share, error_m) in SHARES.into_iter().zip(touches_m) {
        // An arm that touched nothing is told by its hand alone.
        let is_no_worse = measurements.rows.is_empty() || error_m.is_some_and(|m| m <= NO_WORSE * least_m);
        let far = hands_held_out(measurements, effects, &with(share));
        if is_no_worse && is_better(far, best.1, WORTH) {
            best = (share, far);
        }
    }
    best.0
}

fn which(held_out: &HeldOut) -> Which {
    let HeldOut { nothing_m, named_m, all_m } = *held_out;
    if is_better(all_m, nothing_m, WORTH) {
        if is_better(named_m, all_m, WORTH_ALONE) { Which::Named } else { Which::All }
    } else if is_better(named_m, nothing_m, WORTH) {
        Which::Named
    } else {
        Which::Nothing
    }
}

fn is_better(new_m: Option<f64>, old_m: Option<f64>, worth: f64) -> bool {
    matches!((new_m, old_m), (Some(new), Some(old)) if new < worth * old)
}

#[cfg(test)]
mod tests {
    use nalgebra::{Isometry3, Matrix3, Matrix6, Vector3, Vector6};
    use plumbline_effects::Assumed;
    use plumbline_effects::measurements::What;
    use plumbline_model::Unattended;
    use plumbline_model::robot::Rig;

    use super::*;
    use crate::fit::NECK_SD_RAD;
    use crate::made_up::{TIP, hidden, postures, touches};
    use crate::seen::{SeenHand, SeenHands};
    use crate::usual::{measurements, row};

    /// Many small errors, none of which touches could name.
    const MANY: [(&str, &str, &[f64]); 6] = [
        ("joint-zero", "r_shoulder_y", &[0.02]),
        ("joint-zero", "r_arm_x", &[-0.02]),
        ("joint-zero", "r_elbow_y", &[0.025]),
        ("joint-zero", "r_wrist_z", &[-0.03]),
        ("joint-sag", "r_shoulder_y", &[0.01]),
        ("joint-scale", "r_elbow_y", &[0.01]),
    ];

    fn chosen(effects: &[(&str, &str, &[f64])], named: &[(&str, &str, &[f64])]) -> Chosen {
        let rig = Rig::built_in("nico").expect("valid");
        let touches = touches(&rig, effects);
        assert!(touches.rows.len() >= 20, "{}", touches.rows.len());
        let arm = touches.apparatuses[0].arm.clone().expect("an arm");
        let named = hidden(&arm, named).into_iter().map(|present| present.effect).collect();
        let mount = Matrix6::identity();
        let known = Known {
            rig: &rig,
            screen: None,
            hands: None,
            neck_rad: (0.0, NECK_SD_RAD),
            mount: &mount,
            share: 1.0,
        };
        choose(&touches, &arm, named, &known, &Unattended).expect("not cancelled")
    }

    /// Hands over the table of an arm with hidden effects, seen to within 2 mm.
    fn hands(rig: &Rig, effects: &[(&str, &str, &[f64])]) -> SeenHands {
        const PALM: &str = "right_palm_center";
        let over =
            [[0.25, -0.3], [0.35, -0.3], [0.3, -0.2], [0.38, -0.1], [0.25, -0.1], [0.32, 0.0], [0.25, 0.1]];
        let over = over.map(|[x, y]| Vector3::new(x, y, 0.15));
        let arm = Arm::of_rig(rig, PALM).expect("an arm");
        let effects = hidden(&arm, effects);
        let truth = Assumed { effects, placements: vec![Isometry3::identity()], ..Assumed::default() };
        let directions = vec![1.0; arm.len()];
        let rows = postures(rig, PALM, &over);
        let rows = rows.into_iter().map(|angles| row(What::Pose, angles, directions.clone())).collect();
        let arm = measurements(rig, arm, None, rows);
        let seen = arm.rows.iter().map(|row| SeenHand {
            palm_m: Vector3::from_column_slice(&arm.predict(row, &truth).expect("predicted")),
            information: Matrix3::identity() / 2e-3f64.powi(2),
        });
        let seen = seen.collect();
        SeenHands { arm, seen }
    }

    #[test]
    fn hands_tell_that_an_arm_is_off_by_more_than_its_fingertip_shows_and_nothing_where_it_is_not() {
        let rig = Rig::built_in("nico").expect("valid");
        let mount = Matrix6::from_diagonal(&Vector6::new(1e-6, 1e-6, 1e-6, 3e-7, 3e-7, 3e-7));
        let share_of = |effects: &[(&str, &str, &[f64])]| {
            // It touched nothing: only the hand tells.
            let touches = measurements(&rig, Arm::of_rig(&rig, TIP).expect("an arm"), None, vec![]);
            let library = usual(touches.apparatuses[0].arm.as_ref().expect("an arm"));
            let seen = hands(&rig, effects);
            assert!(seen.seen.len() >= 5, "{}", seen.seen.len());
            let neck_rad = (0.0, 0.0015);
            let known =
                Known { rig: &rig, screen: None, hands: Some(&seen), neck_rad, mount: &mount, share: 0.03 };
            share_by_hands(&touches, &library, &known)
        };
        let off = [("joint-zero", "r_elbow_y", &[0.03][..]), ("joint-zero", "r_arm_x", &[0.025][..])];
        let (of_off, of_right) = (share_of(&off), share_of(&[]));
        assert!(of_off > 0.2, "{of_off}");
        assert!(of_right <= 0.1, "{of_right}");
    }

    #[test]
    fn an_arm_with_many_small_errors_is_corrected_by_all_usual_effects() {
        let chosen = chosen(&MANY, &MANY[2..3]);
        assert_eq!(chosen.which, Which::All, "{:?}", chosen.held_out);
        let (before, after) = (chosen.held_out.nothing_m.expect("told"), chosen.error_m().expect("told"));
        assert!(after < 0.5 * before && after < 1.5e-3, "{before} {after}");
    }

    #[test]
    fn an_arm_without_errors_stays_as_described() {
        let chosen = chosen(&[], &[]);
        assert!(chosen.which == Which::Nothing && chosen.effects.is_empty(), "{:?}", chosen.held_out);
        assert_eq!(chosen.held_out.named_m, None);
    }

    #[test]
    fn the_simpler_model_stays_unless_touches_held_out_say_otherwise() {
        let of = |nothing: f64, named: Option<f64>, all: Option<f64>| {
            which(&HeldOut { nothing_m: Some(nothing), named_m: named, all_m: all })
        };
        assert_eq!(of(1.0, Some(0.97), Some(0.98)), Which::Nothing);
        assert_eq!(of(5.0, Some(2.0), None), Which::Named);
        // A few names beat all effects together only clearly.
        assert_eq!(of(5.0, Some(0.9), Some(1.0)), Which::All);
        assert_eq!(of(5.0, Some(0.7), Some(1.0)), Which::Named);
        assert_eq!(of(1.0, None, Some(0.5)), Which::All);
        assert_eq!(which(&HeldOut::default()), Which::Nothing);
    }
}
