//! Cases of eyes.

use nalgebra::{DMatrix, DVector, Point3, Vector3};
use plumbline_model::robot::Rig;
use plumbline_model::session::{LocalizationRow, LocalizationTable, Manifest};
use plumbline_model::{Pixel, Point};
use rand::rngs::StdRng;
use rand::{Rng, SeedableRng};

use super::head::Head;
use super::plan::{Row, Session};
use super::secret::{Kind, Secret};
use crate::answer::{Answer, Plan, Source};
use crate::bench::RIG;
use crate::case::Case;
use crate::error::BlindError;
use crate::hide::{self, Kinds, Scene, Wish, hide};
use crate::measure::{beside, spread};
use crate::physics::normal;
use crate::recipe::Family;

/// What other effects explain all but this share of is not hidden.
const LEAST_SHOWN: f64 = 0.15;
/// A thing that somebody moved by hand goes so far, m.
const BY_HAND_M: f64 = 0.01;

/// Cases of every family on all plans.
pub fn recipes(cases: usize, seed: u64) -> Vec<Wish<Kind>> {
    hide::wishes(cases, seed, &[Plan::Plain, Plan::Rich, Plan::Watched])
}

/// Makes a case; where a kind cannot become as large as wanted, as large as it can.
///
/// # Errors
/// When nothing can be hidden.
pub fn make(wish: &Wish<Kind>) -> Result<Case, BlindError> {
    let head = Head::of_rig(&Rig::built_in(RIG)?)?;
    hide::make_or_smaller(wish, |wish| make_one(&head, wish))
}

fn make_one(head: &Head, wish: &Wish<Kind>) -> Result<Case, BlindError> {
    let mut random = StdRng::seed_from_u64(wish.seed);
    let session = Session::drawn(head, wish.plan, wish.repeated, &mut random);
    let mut maker = Maker { head, session: &session, plan: wish.plan, sigma: vec![1.0; 4], clean: vec![] };
    let bare = maker.seen(&[], Some(&mut random));
    maker.sigma = maker.noise(&bare)?;
    maker.clean = maker.seen(&[], None);
    let (hidden, dirt) = hide(&maker, wish, &mut random)?;
    let all: Vec<Secret> =
        hidden.iter().map(|(secret, _)| secret.clone()).chain(dirt.iter().cloned()).collect();
    let by_hand = (wish.family == Family::Null && wish.plan == Plan::Watched && wish.dirt).then(|| {
        Vector3::from_fn(|k, _| if k < 2 { normal(&mut random) } else { 0.0 }).normalize() * BY_HAND_M
    });
    let rows = maker.written(&all, by_hand, &mut random);
    let joints = head.joints();
    let answer = Answer {
        case: wish.number,
        seed: wish.seed,
        family: wish.family,
        generator: Source::Eyes,
        design: wish.plan,
        hidden: hidden.iter().map(|(secret, size)| secret.told(&joints, &session.sets, *size)).collect(),
        dirt: dirt.iter().map(|secret| secret.told(&joints, &session.sets, f64::NAN).named()).collect(),
        also: vec![],
        sigma: maker.sigma.clone(),
        rows: rows.len(),
        cells: session.cells,
    };
    let notes = "made by optics".to_owned();
    let mut written = plumbline_model::Session::new(Manifest {
        notes,
        ..Manifest::of_rig(RIG, jiff::Timestamp::UNIX_EPOCH)
    });
    written.localizations = Some(LocalizationTable::from_rows(joints, &rows));
    Ok(Case { session: written, files: vec![], slides: vec![], answer })
}

struct Maker<'a> {
    head: &'a Head,
    session: &'a Session,
    plan: Plan,
    sigma: Vec<f64>,
    clean: Vec<Option<Vec<f64>>>,
}

impl Maker<'_> {
    /// Every row as it is measured, with noise where chance is given; `None` out of view.
    fn seen(&self, secrets: &[Secret], mut chance: Option<&mut StdRng>) -> Vec<Option<Vec<f64>>> {
        let mut one = |row: &Row| {
            let points = self.points(secrets, row, &row.place_m, chance.as_deref_mut())?;
            if !self.session.is_estimated {
                return Some(points.to_vec());
            }
            // As the robot's own program sees it: bearings, and baseline over depth.
            let at = self
                .head
                .cameras
                .triangulate(Pixel::new(points[0], points[1]), Pixel::new(points[2], points[3]))?;
            let [x, y, z] = at.coords.coords.into();
            Some(vec![x / z, y / z, self.head.cameras.baseline_m() / z])
        };
        self.session.rows.iter().map(&mut one).collect()
    }

    fn points(
        &self,
        secrets: &[Secret],
        row: &Row,
        place_m: &Point3<f64>,
        chance: Option<&mut StdRng>,
    ) -> Option<[f64; 4]> {
        let seen = self.head.sees(secrets, &row.look, place_m)?;
        Some(match chance {
            Some(random) => seen.map(|px| px + self.session.noise_px * normal(random)),
            None => seen,
        })
    }

    /// Spread of what is measured, places that were told wrongly among it; of one thing about its mean.
    fn noise(&self, bare: &[Option<Vec<f64>>]) -> Result<Vec<f64>, BlindError> {
        let clean = self.seen(&[], None);
        let off: Vec<Vec<f64>> = bare
            .iter()
            .zip(&clean)
            .filter_map(|(bare, clean)| {
                let (bare, clean) = (bare.as_ref()?, clean.as_ref()?);
                Some(bare.iter().zip(clean).map(|(a, b)| a - b).collect())
            })
            .collect();
        if off.len() * 10 < bare.len() * 8 {
            return Err(BlindError::Missed { met: off.len(), tried: bare.len() });
        }
        Ok(spread(&off))
    }

    /// What secrets change, in sigmas; `None` when much goes out of view.
    fn moved(&self, secrets: &[Secret]) -> Option<DVector<f64>> {
        let with = self.seen(secrets, None);
        let lost = with.iter().filter(|seen| seen.is_none()).count();
        if lost * 10 > with.len() {
            return None;
        }
        let each = self.sigma.len();
        let moved = with.iter().zip(&self.clean).flat_map(|(with, without)| match (with, without) {
            (Some(with), Some(without)) => {
                (0..each).map(|c| (with[c] - without[c]) / self.sigma[c]).collect()
            }
            _ => vec![0.0; each],
        });
        Some(DVector::from_iterator(each * with.len(), moved))
    }

    /// What is not known where one thing is watched: where it is, in every coordinate.
    fn constants(&self) -> Vec<DVector<f64>> {
        if self.plan != Plan::Watched {
            return vec![];
        }
        let (each, rows) = (self.sigma.len(), self.session.rows.len());
        let mut places: Vec<Point3<f64>> = vec![];
        let things: Vec<usize> = self
            .session
            .rows
            .iter()
            .map(|row| {
                places.iter().position(|place| *place == row.place_m).unwrap_or_else(|| {
                    places.push(row.place_m);
                    places.len() - 1
                })
            })
            .collect();
        let column = |thing: usize, c: usize| {
            DVector::from_fn(each * rows, |i, _| {
                f64::from(u8::from(i % each == c && things[i / each] == thing))
            })
        };
        (0..places.len())
            .flat_map(|thing| (0..each).map(move |c| column(thing, c)).collect::<Vec<_>>())
            .collect()
    }

    /// What everything that the library knows changes, in small amounts: a column for each direction.
    fn known(&self) -> Vec<DVector<f64>> {
        let kinds =
            Kind::NAMED.iter().copied().filter(|kind| kind.shows_in(self.plan) && *kind != Kind::Knock);
        let mut columns = vec![];
        for kind in kinds {
            let directions = match kind {
                Kind::EyeRoll | Kind::RollGrows | Kind::ImageShift => 2,
                Kind::Mount => 6,
                Kind::MountGrows => 3,
                _ => 1,
            };
            let whiches = if kind == Kind::HeadZero { self.head.rest_rad.len() } else { 1 };
            for (direction, which) in (0..directions).flat_map(|d| (0..whiches).map(move |w| (d, w))) {
                let shape = std::array::from_fn(|k| f64::from(u8::from(k == direction)));
                let amount = 0.1 * kind.usual_and_most()[0];
                columns.extend(self.moved(&[Secret { kind, which, amount, shape }]));
            }
        }
        columns
    }

    /// The rows of a session.
    fn written(
        &self,
        secrets: &[Secret],
        by_hand: Option<Vector3<f64>>,
        random: &mut StdRng,
    ) -> Vec<LocalizationRow> {
        let rows = &self.session.rows;
        let moment = rows.len() * 2 / 5;
        let mut written = vec![];
        for (i, row) in rows.iter().enumerate() {
            let is_moved = i >= moment && row.place_m == rows[0].place_m;
            let moved = by_hand.filter(|_| is_moved).unwrap_or_default();
            let Some([lu, lv, ru, rv]) = self.points(secrets, row, &(row.place_m + moved), Some(random))
            else {
                continue;
            };
            let (left, right) = (Pixel::new(lu, lv), Pixel::new(ru, rv));
            let estimate = self.head.cameras.triangulate(left, right).map(|in_left| {
                let at = self.head.robot_from_left(&row.look.neck_rad) * in_left.coords;
                Point::new(at.x, at.y, at.z)
            });
            let points = !self.session.is_estimated;
            if !points && estimate.is_none() {
                continue;
            }
            written.push(LocalizationRow {
                truth: Some(Point::new(row.told_m.x, row.told_m.y, row.told_m.z)),
                estimate: estimate.filter(|_| !points),
                left: points.then_some(left),
                right: points.then_some(right),
                head_rad: row.look.neck_rad.iter().copied().map(Some).collect(),
                t_secs: Some((row.look.t_secs * 10.0).round() / 10.0),
                object: Some(self.session.thing.to_owned()),
                group: self.session.is_repeated.then(|| format!("place {}", row.cell + 1)),
                set: self.session.sets.get(row.look.set).cloned(),
                ..LocalizationRow::default()
            });
        }
        written
    }
}

impl Scene for Maker<'_> {
    type Secret = Secret;

    fn candidate(&self, kinds: &[Kind], taken: &[Secret], random: &mut StdRng) -> Option<Secret> {
        let kind = kinds[random.random_range(0..kinds.len())];
        // One name at one site: what grows and what does not would be told apart by nobody's answer.
        if taken.iter().any(|s| s.kind.id() == kind.id()) {
            return None;
        }
        let which = match kind {
            Kind::HeadZero | Kind::NeckMemory => random.random_range(0..self.head.rest_rad.len()),
            // Of the first joint it is the base's.
            Kind::HeadSkew => self.head.rest_rad.len() - 1,
            Kind::Knock => random.random_range(0..self.session.sets.len().max(1)),
            _ => 0,
        };
        let directions = match kind {
            Kind::EyeRoll | Kind::RollGrows | Kind::ImageShift => 2,
            Kind::Mount => 6,
            _ => 3,
        };
        let mut shape: [f64; 6] = std::array::from_fn(|k| if k < directions { normal(random) } else { 0.0 });
        let length = shape.iter().map(|part| part * part).sum::<f64>().sqrt();
        shape.iter_mut().for_each(|part| *part /= length.max(1e-9));
        let sign = if random.random_bool(0.5) { 1.0 } else { -1.0 };
        Some(Secret { kind, which, amount: sign * kind.usual_and_most()[0], shape })
    }

    fn shown(&self, secret: &Secret) -> Option<DVector<f64>> {
        let moved = self.moved(std::slice::from_ref(secret))?;
        let mut unknown = self.constants();
        if !secret.kind.is_named() {
            // What everything that is known together could do is not unknown.
            unknown.extend(self.known());
        }
        let columns = match unknown.is_empty() {
            true => DMatrix::zeros(moved.len(), 0),
            false => DMatrix::from_columns(&unknown),
        };
        let left = beside(&moved, &columns);
        (left.norm() > LEAST_SHOWN * moved.norm() && left.norm() > 1e-9).then_some(left)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_constant_has_no_size_where_one_thing_is_watched_and_what_grows_has() {
        let head = Head::of_rig(&Rig::built_in(RIG).expect("comes along")).expect("fisheyes");
        for seed in 0..6 {
            let mut random = StdRng::seed_from_u64(seed);
            let session = Session::drawn(&head, Plan::Watched, false, &mut random);
            let sigma = vec![0.1; if session.is_estimated { 3 } else { 4 }];
            let mut maker =
                Maker { head: &head, session: &session, plan: Plan::Watched, sigma, clean: vec![] };
            maker.clean = maker.seen(&[], None);
            let secret =
                |kind| Secret { kind, which: 0, amount: 0.01, shape: [1.0, 0.0, 0.0, 0.0, 0.0, 0.0] };
            assert_eq!(maker.size(&secret(Kind::Mount)), None);
            assert_eq!(maker.size(&secret(Kind::HeadZero)), None);
            assert!(maker.size(&secret(Kind::MountGrows)).is_some());
            assert!(maker.size(&secret(Kind::Wobble)).is_some());
        }
    }

    #[test]
    fn a_made_case_is_read_again_and_holds_what_its_answer_says() {
        for (number, plan) in [Plan::Plain, Plan::Rich, Plan::Watched].into_iter().enumerate() {
            let wish = Wish {
                number,
                family: Family::Single,
                plan,
                dirt: true,
                repeated: true,
                size_sigmas: 2.0,
                kind: Some(Kind::YawGrows),
                seed: 70 + number as u64,
            };
            let case = make(&wish).expect("made");
            let folder = tempfile::tempdir().expect("a folder");
            case.session.write(folder.path()).expect("written");
            let read = plumbline_model::Session::read(folder.path()).expect("well formed");
            let rows = read.localizations.as_ref().map_or(0, LocalizationTable::row_count);
            assert_eq!(rows, case.answer.rows);
            // As large as wanted, or the next smaller size where an eye cannot turn so far.
            let size = case.answer.hidden[0].size_sigmas;
            assert!([0.5, 1.0, 2.0].iter().any(|wanted| (size / wanted - 1.0).abs() < 0.1), "{size}");
            assert!(case.answer.dirt.len() <= 7);
        }
    }
}
