//! What stands still by itself and is looked for again: the touchscreen, a thing, a hand at rest.

use nalgebra::{Rotation3, Vector3};
use plumbline_effects::SeenUnder;
use plumbline_model::{Pixel, Point, Raw, Robot};
use plumbline_vision::follow::{EyeTurn, Followed, RememberedEye};

use super::WatcherSetup;

/// Fewer places of a reference in an eye do not tell where it is.
const LEAST_PLACES: usize = 4;
/// A reference of which less than this share is seen again is gone or covered.
const LEAST_SHARE: f64 = 0.35;
/// One that moved by itself by more than this in an eye stands elsewhere, px.
const ELSEWHERE_PX: f64 = 1.5;

/// What a reference is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ReferenceKind {
    /// The touchscreen: nobody carries it about.
    Screen,
    /// A thing on the table, that may be moved by hand.
    Thing,
    /// A hand at rest, known by its encoders.
    Hand,
}

/// A reference as it is known before it is looked for.
#[derive(Clone, Debug, PartialEq)]
pub struct Reference {
    /// Its name, for people.
    pub name: String,
    /// What it is.
    pub kind: ReferenceKind,
    /// Where it is, robot frame.
    pub place: Point<Robot>,
    /// Around it in the left and the right picture: corners of a convex outline in order.
    pub outlines: [Vec<Pixel<Raw>>; 2],
}

/// A reference that was looked for.
#[derive(Clone, Debug, PartialEq)]
pub struct ReferenceSeen {
    /// Its name, for people.
    pub name: String,
    /// What it is.
    pub kind: ReferenceKind,
    /// Whether it is gone or covered; what follows is then `None`.
    pub is_lost: bool,
    /// How far it moved by itself since it was remembered, px: what is left when the turn of each eye is taken
    /// off; left (u, v), right (u, v).
    pub own_px: Option<[[f64; 2]; 2]>,
    /// The same in the robot's frame, m.
    pub own_m: Option<Vector3<f64>>,
    /// Where it comes out, minus where it came out when it was remembered, robot frame, m: turned eyes and own
    /// motion together.
    pub drift_m: Option<Vector3<f64>>,
}

impl ReferenceSeen {
    /// Whether it stands elsewhere than when it was remembered, or is gone.
    pub fn is_elsewhere(&self) -> bool {
        self.is_lost || self.own_px.is_some_and(|eyes| eyes.iter().any(|[u, v]| u.hypot(*v) > ELSEWHERE_PX))
    }
}

/// A reference and its places in the remembered pictures.
#[derive(Clone, Debug)]
pub(super) struct Kept {
    name: String,
    kind: ReferenceKind,
    place: Point<Robot>,
    /// Numbers of its places, left and right.
    places: [Vec<usize>; 2],
}

/// Gives each place of both pictures to the first reference that it lies in; those with too few are left out.
pub(super) fn keep(references: &[Reference], eyes: &[RememberedEye; 2]) -> Vec<Kept> {
    let mut taken: [Vec<bool>; 2] = [0, 1].map(|eye: usize| vec![false; eyes[eye].places().len()]);
    let mut kept = Vec::new();
    for reference in references {
        let mut places: [Vec<usize>; 2] = [vec![], vec![]];
        for (eye, remembered) in eyes.iter().enumerate() {
            for (index, at) in remembered.places().iter().enumerate() {
                if !taken[eye][index] && is_inside(&reference.outlines[eye], at) {
                    taken[eye][index] = true;
                    places[eye].push(index);
                }
            }
        }
        if places.iter().all(|places| places.len() >= LEAST_PLACES) {
            kept.push(Kept {
                name: reference.name.clone(),
                kind: reference.kind,
                place: reference.place,
                places,
            });
        }
    }
    kept
}

/// Whether a pixel lies in a convex outline, whichever way round its corners are given.
fn is_inside(outline: &[Pixel<Raw>], at: &Pixel<Raw>) -> bool {
    let side = |k: usize| {
        let (a, b) = (outline[k].vector(), outline[(k + 1) % outline.len()].vector());
        (b - a).perp(&(at.vector() - a))
    };
    let sides: Vec<f64> = (0..outline.len()).map(side).collect();
    outline.len() >= 3 && (sides.iter().all(|side| *side >= 0.0) || sides.iter().all(|side| *side <= 0.0))
}

impl Kept {
    /// Where it is now.
    pub fn seen(
        &self,
        setup: &WatcherSetup,
        eyes: [(&EyeTurn, &[Followed]); 2],
        turns_rad: &[Vector3<f64>; 2],
        [remembered, now]: [&SeenUnder; 2],
    ) -> ReferenceSeen {
        let own = [0, 1].map(|eye: usize| own_px(&self.places[eye], eyes[eye]));
        let own_px = match own {
            [Some(left), Some(right)] => Some([left, right]),
            _ => None,
        };
        let still = [Vector3::zeros(); 2];
        // Seen when it was remembered, and placed as by what the model knows of the eyes at that time or now.
        let place = |turns: &[Vector3<f64>; 2], by: &[[f64; 2]; 2], under: &SeenUnder| {
            self.located(setup, turns, by, [remembered, under])
        };
        let [own_m, drift_m] = match (own_px, place(&still, &[[0.0; 2]; 2], remembered)) {
            (Some(own), Some(before)) => [place(&still, &own, remembered), place(turns_rad, &own, now)]
                .map(|at| at.map(|at| at - before)),
            _ => [None, None],
        };
        ReferenceSeen {
            name: self.name.clone(),
            kind: self.kind,
            is_lost: own_px.is_none(),
            own_px,
            own_m,
            drift_m,
        }
    }

    /// Where it comes out when the eyes have turned and it is seen shifted.
    fn located(
        &self,
        setup: &WatcherSetup,
        turns_rad: &[Vector3<f64>; 2],
        by_px: &[[f64; 2]; 2],
        [remembered, under]: [&SeenUnder; 2],
    ) -> Option<Vector3<f64>> {
        let model = &setup.model;
        let cameras = &model.rig().eyes.cameras;
        let (left, right) = model.project(&self.place, &setup.posture, remembered)?;
        let eyes = [(left, &cameras.left), (right, &cameras.right)];
        let mut seen = [left, right];
        for (eye, (at, camera)) in eyes.into_iter().enumerate() {
            let ray = Rotation3::new(turns_rad[eye]) * camera.unproject(at).ok()?;
            let there = camera.project(&ray).ok()?;
            seen[eye] = Pixel::new(there.u_px + by_px[eye][0], there.v_px + by_px[eye][1]);
        }
        let in_left = cameras.triangulate(seen[0], seen[1])?;
        let place = model.place(&in_left, &nalgebra::Matrix3::zeros(), &setup.posture, under)?;
        Some(place.point.coords.coords)
    }
}

/// Median of what its places moved by themselves, px; `None`: too few are seen again.
fn own_px(places: &[usize], (turn, followed): (&EyeTurn, &[Followed])) -> Option<[f64; 2]> {
    let of_it = followed.iter().zip(&turn.residuals_px).filter(|(one, _)| places.contains(&one.index));
    let residuals: Vec<&[f64; 2]> = of_it.map(|(_, residual)| residual).collect();
    let enough =
        residuals.len() >= LEAST_PLACES - 1 && residuals.len() as f64 >= LEAST_SHARE * places.len() as f64;
    let middle = |k: usize| {
        let mut values: Vec<f64> = residuals.iter().map(|residual| residual[k]).collect();
        values.sort_by(f64::total_cmp);
        values[values.len() / 2]
    };
    enough.then(|| [middle(0), middle(1)])
}
