//! Cases of arms that are measured from outside.

use nalgebra::{DVector, Vector3};
use plumbline_model::Session;
use plumbline_model::session::{Chain, Manifest, PoseTable, RigReference};
use rand::rngs::StdRng;
use rand::{Rng, SeedableRng};

use super::robot::TIP;
use super::run::{Met, Setup, Visit};
use super::secret::{Kind, Secret};
use crate::answer::{Answer, Plan, Source};
use crate::case::Case;
use crate::error::BlindError;
use crate::hide::{self, Scene, Wish, hide};
use crate::measure::{beside, spread};
use crate::physics::normal;

/// File of the description in a session's folder.
const DESCRIPTION: &str = "robot.urdf";
/// Sizes are measured on about so many visits.
const LOOKS: usize = 60;
/// What frame and marker explain all but this share of is not hidden.
const LEAST_SHOWN: f64 = 0.15;
/// A mass is another one when it is off by this share.
const OTHER_MASS: f64 = 0.05;

/// Cases of every family on both plans.
pub fn recipes(cases: usize, seed: u64) -> Vec<Wish<Kind>> {
    hide::wishes(cases, seed, &[Plan::Plain, Plan::Rich])
}

/// Makes a case; where a kind cannot become as large as wanted, as large as it can.
///
/// # Errors
/// When nothing can be hidden.
pub fn make(wish: &Wish<Kind>) -> Result<Case, BlindError> {
    Ok(made(wish)?.case)
}

/// A case with the arm itself, which can be measured again.
pub(super) struct Made {
    pub case: Case,
    pub setup: Setup,
    pub secrets: Vec<Secret>,
    pub random: StdRng,
}

/// Makes a case and keeps the arm.
///
/// # Errors
/// As [`make`].
pub(super) fn made(wish: &Wish<Kind>) -> Result<Made, BlindError> {
    hide::make_or_smaller(wish, make_one)
}

fn make_one(wish: &Wish<Kind>) -> Result<Made, BlindError> {
    let mut random = StdRng::seed_from_u64(wish.seed);
    let setup = Setup::drawn(wish.plan, wish.repeated, &mut random);
    let bare = setup.measure(&[], &setup.visits, Some(&mut random));
    let sigma = spread(&bare.iter().map(|met| setup.residual(met)).collect::<Vec<_>>());
    let looks: Vec<Visit> =
        setup.visits.iter().step_by(setup.visits.len().div_ceil(LOOKS)).cloned().collect();
    let clean = setup.measure(&[], &looks, None);
    let maker = Maker { setup: &setup, looks, clean, sigma: sigma.clone(), plan: wish.plan };
    let (hidden, dirt) = hide(&maker, wish, &mut random)?;
    let all: Vec<Secret> =
        hidden.iter().map(|(secret, _)| secret.clone()).chain(dirt.iter().cloned()).collect();
    let met = setup.measure(&all, &setup.visits, Some(&mut random));
    let answer = Answer {
        case: wish.number,
        seed: wish.seed,
        family: wish.family,
        generator: Source::Arms,
        design: wish.plan,
        hidden: hidden.iter().map(|(secret, size)| secret.told(&setup.robot, *size)).collect(),
        dirt: dirt.iter().map(|secret| secret.told(&setup.robot, f64::NAN).named()).collect(),
        also: masses(&setup),
        sigma,
        rows: met.len(),
        cells: setup.cells.len(),
    };
    let slides = setup.robot.slides();
    let case = Case { session: session(&setup, &met)?, files: files(&setup), slides, answer };
    Ok(Made { case, setup, secrets: all, random })
}

/// What lies beside a session's tables.
pub(super) fn files(setup: &Setup) -> Vec<(String, String)> {
    vec![(DESCRIPTION.to_owned(), setup.robot.urdf())]
}

/// Links that weigh other than described, by the names of the command line.
fn masses(setup: &Setup) -> Vec<String> {
    let links = setup.robot.links();
    let others =
        links.iter().zip(&setup.mass_factors).filter(|(_, factor)| (**factor - 1.0).abs() >= OTHER_MASS);
    others
        .map(|(link, _)| {
            let kind = if links.last() == Some(link) { "payload-mass" } else { "link-mass" };
            format!("{kind}@{link}")
        })
        .collect()
}

pub(super) fn session(setup: &Setup, met: &[Met]) -> Result<Session, BlindError> {
    let joints = setup.robot.joints();
    let rows: Vec<_> = met.iter().map(|met| setup.row(met)).collect();
    // Keys of poses stand in sections of their own, as the format has them.
    let place = if setup.unknown_mount.is_some() { "unknown" } else { "known" };
    let extra: toml::Table = toml::from_str(&format!(
        "[external]\nframe = \"tracker\"\n[chain]\ntip_place = \"{place}\"\nencoders = \"motor\"\n"
    ))
    .map_err(BlindError::Keys)?;
    let mut session = Session::new(Manifest {
        rig: RigReference::File(DESCRIPTION.into()),
        chain: Some(Chain { tip: TIP.to_owned(), joints: joints.clone() }),
        notes: "made by geometry".to_owned(),
        extra,
        ..Manifest::of_rig("drawn", jiff::Timestamp::UNIX_EPOCH)
    });
    session.poses = Some(PoseTable::from_rows(joints, &rows));
    Ok(session)
}

struct Maker<'a> {
    setup: &'a Setup,
    looks: Vec<Visit>,
    clean: Vec<Met>,
    sigma: Vec<f64>,
    plan: Plan,
}

impl Scene for Maker<'_> {
    type Secret = Secret;

    fn candidate(&self, kinds: &[Kind], taken: &[Secret], random: &mut StdRng) -> Option<Secret> {
        let kind = kinds[random.random_range(0..kinds.len())];
        let joint = if kind.is_of_joint() { random.random_range(0..self.setup.robot.len()) } else { 0 };
        let is_beside = |s: &Secret| s.kind == kind && (s.joint == joint || !kind.is_of_joint());
        if taken.iter().any(is_beside) {
            return None;
        }
        // What slides has less that can be wrong, and no cable of another joint goes there.
        let parts = &self.setup.robot.parts;
        let from = match kind {
            Kind::FarCable => Some((joint + 2) % parts.len()),
            _ => None,
        };
        let slides = parts[joint].slides && !kind.is_of_slides();
        if slides || from.is_some_and(|from| parts[from].slides) {
            return None;
        }
        // A link comes from the joint before, and has a length.
        let needs_before = matches!(kind, Kind::LinkLength | Kind::LinkBending);
        let length_m = self.setup.robot.parts[joint].shift_m.norm();
        if needs_before && (joint == 0 || length_m < 0.04) {
            return None;
        }
        let gives = |kind: Kind| matches!(kind, Kind::JointSag | Kind::SoftWhenWarm);
        if gives(kind) && taken.iter().any(|s| s.joint == joint && gives(s.kind)) {
            return None;
        }
        if kind == Kind::Hysteresis && self.plan == Plan::Plain && !self.setup.is_repeated {
            // One visit to each pose from one side: how far it came is then hardly more than from which side.
            return None;
        }
        let sign = if kind.is_positive() || random.random_bool(0.5) { 1.0 } else { -1.0 };
        let mut shape = Vector3::from_fn(|_, _| normal(random)).normalize();
        if kind == Kind::JointEccentricity {
            shape.z = 0.0;
            shape = shape.try_normalize(1e-6)?;
        }
        let when = random.random_range(0.35..0.65);
        let secret =
            Secret { kind, joint, amount: sign * kind.usual_and_most()[0], shape: shape.into(), when };
        let is_pulled = kind != Kind::JointCoupling || !parts[secret.puller(parts.len())].slides;
        is_pulled.then_some(secret)
    }

    fn shown(&self, secret: &Secret) -> Option<DVector<f64>> {
        let with = self.setup.measure(std::slice::from_ref(secret), &self.looks, None);
        let moved = self.setup.moved(&with, &self.clean, &self.sigma);
        let left = beside(&moved, &self.setup.unknown(&self.clean, &self.sigma));
        (left.norm() > LEAST_SHOWN * moved.norm() && left.norm() > 1e-9).then_some(left)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn setup(seed: u64) -> Setup {
        Setup::drawn(Plan::Rich, false, &mut StdRng::seed_from_u64(seed))
    }

    #[test]
    fn what_frame_or_marker_hide_has_no_size() {
        let mut tried = 0;
        for seed in 0..12 {
            let setup = setup(seed);
            let looks = setup.visits.clone();
            let clean = setup.measure(&[], &looks, None);
            let each = if setup.oriented { 6 } else { 3 };
            let (last, marker_is_known) = (setup.robot.len() - 1, setup.unknown_mount.is_none());
            let maker = Maker { setup: &setup, looks, clean, sigma: vec![1e-3; each], plan: Plan::Rich };
            let secret =
                |kind, joint| Secret { kind, joint, amount: 0.003, shape: [0.6, 0.0, 0.8], when: 0.5 };
            // The zero of the first joint, and how its axis stands, are the frame's.
            assert_eq!(maker.size(&secret(Kind::JointZero, 0)), None, "{seed}");
            assert_eq!(maker.size(&secret(Kind::AxisSkew, 0)), None, "{seed}");
            // A slide along the axis of the first joint, or a turn about the way of a first slide, is the frame's, too.
            if !setup.robot.parts[..2].iter().any(|part| part.slides) {
                assert!(maker.size(&secret(Kind::JointZero, 1)).is_some(), "{seed}");
            }
            assert!(maker.size(&secret(Kind::JointScale, 0)).is_some(), "{seed}");
            // A marker that was mounted anew hides the zero of the last joint.
            let of_last = maker.size(&secret(Kind::JointZero, last));
            assert_eq!(of_last.is_some(), marker_is_known, "{seed}");
            assert_eq!(maker.size(&secret(Kind::TipOffset, 0)).is_some(), marker_is_known, "{seed}");
            tried += usize::from(marker_is_known);
        }
        assert!((2..11).contains(&tried), "both sorts: {tried}");
    }

    #[test]
    fn without_secrets_the_written_session_is_the_description_in_another_frame() {
        let setup = setup(3);
        let met = setup.measure(&[], &setup.visits, None);
        // Up to half a step of an encoder at arm's length.
        for met in &met {
            assert!(setup.residual(met).iter().all(|off| off.abs() < 2e-3));
        }
        let session = session(&setup, &met).expect("keys");
        let folder = tempfile::tempdir().expect("a folder");
        session.write(folder.path()).expect("written");
        std::fs::write(folder.path().join(DESCRIPTION), setup.robot.urdf()).expect("written");
        let read = Session::read(folder.path()).expect("well formed");
        assert_eq!(read.manifest.pose_setup().tip_is_unknown, setup.unknown_mount.is_some());
        let rig =
            plumbline_model::robot::Rig::read_measured(&folder.path().join(DESCRIPTION)).expect("a robot");
        let chain = rig.chain(TIP).expect("the marker");
        let row = read.poses.as_ref().and_then(|poses| poses.row(0)).expect("a row");
        let angles: Vec<f64> = row.encoder_rad.iter().map(|angle| angle.expect("logged")).collect();
        let described = setup.external_from_base * chain.robot_from_tip(&angles).isometry * setup.mount();
        let off = described.translation.vector - row.measured.expect("measured").coords.coords;
        assert!(off.norm() < 4e-3, "{off:?}");
    }
}
