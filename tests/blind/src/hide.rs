//! What a case hides, for every scene alike: kinds drawn by chance, amounts made as large as wanted.

use nalgebra::DVector;
use rand::rngs::StdRng;
use rand::{Rng, SeedableRng};

use crate::answer::Plan;
use crate::error::BlindError;
use crate::mix::{CROWD, SIZES, crowd_sigmas, crowds};
use crate::recipe::Family;

/// Draws before a case is given up.
const DRAWS: usize = 60;
/// Effects whose traces are alike beyond this cosine are one.
const ALIKE: f64 = 0.9;
/// What the library does not have is hidden at this size or not at all, sigmas.
const LEAST_NAMELESS: f64 = 2.0;
/// Dirt is at most so large, in sigmas …
const DIRT_SIGMAS: f64 = 0.2;
/// … and there are so many pieces of it.
const DIRT: [usize; 2] = [4, 7];

/// What a case shall be.
#[derive(Clone, Debug, PartialEq)]
pub struct Wish<K> {
    /// Its number.
    pub number: usize,
    /// What kind of case.
    pub family: Family,
    /// Which plan.
    pub plan: Plan,
    /// Whether small things are wrong, too.
    pub dirt: bool,
    /// Whether repeats tell the noise; else nothing does.
    pub repeated: bool,
    /// Wanted size of each effect, in sigmas.
    pub size_sigmas: f64,
    /// The kind that it must be, where that was asked for.
    pub kind: Option<K>,
    /// Of everything drawn by chance.
    pub seed: u64,
}

impl<K> Wish<K> {
    /// One of a list by hand, not numbered yet: without dirt, with repeats.
    pub fn of(family: Family, plan: Plan, size_sigmas: f64, kind: Option<K>) -> Self {
        Self { number: 0, family, plan, dirt: false, repeated: true, size_sigmas, kind, seed: 0 }
    }

    /// Numbers a list and gives each a seed of its own, from the first on; nothing tells the noise of every fourth.
    pub fn number(wishes: &mut [Self], first_seed: u64) {
        for (number, wish) in wishes.iter_mut().enumerate() {
            (wish.number, wish.seed, wish.repeated) = (number, first_seed + number as u64, number % 4 != 1);
        }
    }
}

/// Kinds of things that can be hidden.
pub trait Kinds: Copy + PartialEq + 'static {
    /// Those that the library knows.
    const NAMED: &'static [Self];
    /// Those that it does not know.
    const NAMELESS: &'static [Self];

    /// Whether a plan can show it.
    fn shows_in(self, plan: Plan) -> bool;
}

/// Something that is wrong by an amount.
pub trait Secret: Clone {
    /// Its kinds.
    type Kind: Kinds;

    /// How much.
    fn amount(&self) -> f64;

    /// The same with another amount.
    #[must_use]
    fn with_amount(&self, amount: f64) -> Self;

    /// No robot is worse than this.
    fn most(&self) -> f64;
}

/// Where secrets are hidden.
pub trait Scene {
    /// What can be wrong.
    type Secret: Secret;

    /// Something of these kinds at a usual amount, beside what is there; `None` where it has no place.
    fn candidate(
        &self,
        kinds: &[<Self::Secret as Secret>::Kind],
        taken: &[Self::Secret],
        random: &mut StdRng,
    ) -> Option<Self::Secret>;

    /// What it does to each coordinate, in sigmas, less what the unknown frame explains; `None` of what that explains
    /// nearly wholly.
    fn shown(&self, secret: &Self::Secret) -> Option<DVector<f64>>;

    /// Root mean square of that.
    fn size(&self, secret: &Self::Secret) -> Option<f64> {
        self.shown(secret).map(|shown| shown.norm() / (shown.len().max(1) as f64).sqrt())
    }
}

/// Secrets with their sizes (sigmas), and dirt.
pub type Hiding<S> = (Vec<(S, f64)>, Vec<S>);

/// Draws what is hidden.
///
/// # Errors
/// When nothing becomes as large as wanted.
pub fn hide<S: Scene>(
    scene: &S,
    wish: &Wish<<S::Secret as Secret>::Kind>,
    random: &mut StdRng,
) -> Result<Hiding<S::Secret>, BlindError> {
    type KindOf<S> = <<S as Scene>::Secret as Secret>::Kind;
    let shown = |kinds: &[KindOf<S>]| -> Vec<KindOf<S>> {
        kinds.iter().copied().filter(|kind| kind.shows_in(wish.plan)).collect()
    };
    let (named, nameless) = (shown(KindOf::<S>::NAMED), shown(KindOf::<S>::NAMELESS));
    let mut hidden: Vec<(S::Secret, f64)> = vec![];
    for k in 0..wish.family.drawn() {
        let kinds = match (wish.kind, wish.family) {
            (Some(kind), _) if k == 0 => vec![kind],
            (_, Family::OffLibrary) => nameless.clone(),
            _ => named.clone(),
        };
        let taken: Vec<S::Secret> = hidden.iter().map(|(secret, _)| secret.clone()).collect();
        hidden.push(drawn(scene, &kinds, &taken, wish.size_sigmas, random)?);
    }
    if wish.family == Family::Crowd {
        let wanted = random.random_range(CROWD[0]..=CROWD[1]);
        for _ in 0..DRAWS {
            if hidden.len() < wanted {
                hidden.extend(one_of_many(scene, &named, &hidden, random, crowd_sigmas));
            }
        }
    }
    let mut dirt: Vec<(S::Secret, f64)> = vec![];
    if wish.dirt {
        for _ in 0..random.random_range(DIRT[0]..=DIRT[1]) {
            let taken = [hidden.clone(), dirt.clone()].concat();
            let sigmas = |random: &mut StdRng| DIRT_SIGMAS * random.random_range(0.25..1.0);
            dirt.extend(one_of_many(scene, &named, &taken, random, sigmas));
        }
    }
    Ok((hidden, dirt.into_iter().map(|(secret, _)| secret).collect()))
}

/// One more beside what is there, of a size drawn last, if the arm can be off so far.
fn one_of_many<S: Scene>(
    scene: &S,
    kinds: &[<S::Secret as Secret>::Kind],
    taken: &[(S::Secret, f64)],
    random: &mut StdRng,
    sigmas: impl FnOnce(&mut StdRng) -> f64,
) -> Option<(S::Secret, f64)> {
    let taken: Vec<S::Secret> = taken.iter().map(|(secret, _)| secret.clone()).collect();
    let secret = scene.candidate(kinds, &taken, random)?;
    let found = scene.size(&secret)?;
    let size = sigmas(random);
    let amount = secret.amount() * size / found.max(1e-9);
    (amount.abs() <= secret.most()).then(|| (secret.with_amount(amount), size))
}

/// A secret of the wanted size.
fn drawn<S: Scene>(
    scene: &S,
    kinds: &[<S::Secret as Secret>::Kind],
    taken: &[S::Secret],
    wanted: f64,
    random: &mut StdRng,
) -> Result<(S::Secret, f64), BlindError> {
    for _ in 0..DRAWS {
        let Some(mut secret) = scene.candidate(kinds, taken, random) else { continue };
        for _ in 0..6 {
            let Some(size) = scene.size(&secret) else { break };
            if (size / wanted - 1.0).abs() < 0.08 && secret.amount().abs() <= secret.most() {
                if taken.iter().any(|other| alike(scene, &secret, other)) {
                    break;
                }
                return Ok((secret, size));
            }
            let factor = (wanted / size.max(1e-9)).clamp(0.05, 20.0);
            secret = secret.with_amount(secret.amount() * factor);
            if secret.amount().abs() > secret.most() {
                break;
            }
        }
    }
    Err(BlindError::TooLarge { size_sigmas: wanted })
}

/// Whether two do the same, or the opposite: nobody could tell that there are two.
fn alike<S: Scene>(scene: &S, one: &S::Secret, other: &S::Secret) -> bool {
    let (Some(one), Some(other)) = (scene.shown(one), scene.shown(other)) else { return true };
    one.dot(&other).abs() > ALIKE * one.norm() * other.norm()
}

/// Makes a case; where a kind cannot be as large as wanted, as large as it can, else another kind.
///
/// # Errors
/// When it cannot be made whatever is hidden.
pub fn make_or_smaller<K: Kinds, Made>(
    wish: &Wish<K>,
    make: impl Fn(&Wish<K>) -> Result<Made, BlindError>,
) -> Result<Made, BlindError> {
    let mut wish = wish.clone();
    loop {
        let smaller = SIZES.into_iter().rev().find(|smaller| *smaller < 0.9 * wish.size_sigmas);
        let smaller = smaller.filter(|size| wish.family != Family::OffLibrary || *size >= LEAST_NAMELESS);
        match (make(&wish), smaller) {
            (Err(BlindError::TooLarge { .. }), Some(smaller)) => wish.size_sigmas = smaller,
            (Err(BlindError::TooLarge { .. }), None) if wish.kind.is_some() => {
                wish = Wish { kind: None, seed: wish.seed.wrapping_add(1), size_sigmas: 2.0, ..wish };
            }
            (made, _) => return made,
        }
    }
}

/// Cases of every family: of sixty, 16 without anything hidden, 24 singles of all kinds and sizes, 10 pairs, 10 with
/// what the library does not have. Plans take turns; dirt is in every other case, and in half of them repeats tell
/// the noise. After them a tenth as many of robots that are a little off everywhere.
pub fn wishes<K: Kinds>(cases: usize, seed: u64, plans: &[Plan]) -> Vec<Wish<K>> {
    let mut random = StdRng::seed_from_u64(seed);
    let (mut named, mut nameless): (Vec<K>, Vec<K>) = (vec![], vec![]);
    (0..cases + crowds(cases))
        .map(|number| {
            let family = match (number as f64 + 0.5) / cases as f64 {
                _ if number >= cases => Family::Crowd,
                s if s < 0.26 => Family::Null,
                s if s < 0.66 => Family::Single,
                s if s < 0.83 => Family::Pair,
                _ => Family::OffLibrary,
            };
            let plan = plans[number % plans.len()];
            let turn = number / plans.len();
            let size_sigmas = match family {
                Family::Null | Family::Crowd => 0.0,
                Family::Single => SIZES[turn % SIZES.len()],
                Family::OffLibrary => [2.0, 3.0, 5.0][random.random_range(0..3)],
                _ => [1.5, 2.0, 3.0][random.random_range(0..3)],
            };
            let kind = match family {
                Family::Single => next(&mut named, K::NAMED, plan, &mut random),
                Family::OffLibrary => next(&mut nameless, K::NAMELESS, plan, &mut random),
                _ => None,
            };
            let dirt = family != Family::Crowd && turn % 2 == 1;
            let repeated = (turn / 2).is_multiple_of(2);
            Wish { number, family, plan, dirt, repeated, size_sigmas, kind, seed: random.random() }
        })
        .collect()
}

/// Every kind in its turn, in an order drawn by chance; `None` where the plan shows none.
fn next<K: Kinds>(waiting: &mut Vec<K>, all: &[K], plan: Plan, random: &mut StdRng) -> Option<K> {
    if !all.iter().any(|kind| kind.shows_in(plan)) {
        return None;
    }
    loop {
        let fitting: Vec<usize> = (0..waiting.len()).filter(|&i| waiting[i].shows_in(plan)).collect();
        match fitting.len() {
            0 => waiting.extend(all),
            n => return Some(waiting.swap_remove(fitting[random.random_range(0..n)])),
        }
    }
}
