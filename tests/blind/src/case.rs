//! Cases: what is hidden in each, drawn by chance, its session and its answer.

use std::path::Path;

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use plumbline_model::Session;
use plumbline_model::pixel::Pixel;
use plumbline_model::session::{Chain, Manifest, RigReference, StereoImages, TouchRow, TouchTable};
use rand::rngs::StdRng;
use rand::seq::SliceRandom;
use rand::{Rng, SeedableRng};

use crate::answer::{Answer, Hidden};
use crate::bench::{Bench, RIG, TIP};
use crate::design::{Design, Planner};
use crate::error::BlindError;
use crate::measure::{lag_m, residual_m, sigma_m, size_sigmas};
use crate::mix::{CROWD, SIZES, crowd_sigmas};
use crate::physics::{Physics, normal};
use crate::recipe::{Family, Recipe};
use crate::secret::{Kind, Secret};
use crate::stage::{Cell, Met, Stage};

/// From one touch to the next, s.
const PACE_S: f64 = 7.0;
/// The robot has been on for so long when the first finger comes down, s.
const START_S: f64 = 40.0;
/// What chance does when nothing is left to it: six joints and a descent.
const USUAL_CHANCES: [f64; 7] = [0.5; 7];
/// Draws before a case is given up.
const DRAWS: usize = 24;

/// A case: what was measured, and what nobody may read who is judged by it.
pub struct Case {
    /// What was measured.
    pub session: Session,
    /// Files beside its tables: name and text (descriptions of robots that the program does not know).
    pub files: Vec<(String, String)>,
    /// Joints that slide: their columns are in meters.
    pub slides: Vec<String>,
    /// What is hidden.
    pub answer: Answer,
}

struct Order {
    /// Cell and time of each touch, in the order of the session.
    touches: Vec<(usize, f64)>,
    duration_s: f64,
}

/// Makes a case.
///
/// # Errors
/// When the physics does not accept it or the arm misses the screen.
pub fn make(bench: &Bench, planner: &Planner<'_>, recipe: &Recipe) -> Result<Case, BlindError> {
    let mut random = StdRng::seed_from_u64(recipe.seed);
    let physics = Physics::of(recipe.generator, recipe.seed);
    let cells = planner.cells(recipe.design, &physics.plans, &mut random)?;
    let screen = moved_screen(&mut random);
    let maker = Maker { bench, physics, cells, screen, design: recipe.design };
    let order = maker.order(&mut random);
    let (bare, _) = maker.tell_noise(&order, &[], &mut random)?;
    let mut secrets: Vec<Secret> = vec![];
    let mut hidden = vec![];
    let places: Vec<usize> = (0..maker.cells.len()).step_by(maker.cells.len().div_ceil(60)).collect();
    let clean = maker.rehearse(&[], &order, &places)?;
    for _ in 0..recipe.family.drawn() {
        let (secret, size) = maker.draw(recipe, &order, &places, &clean, &bare, &secrets, &mut random)?;
        secrets.push(secret.clone());
        hidden.push(maker.hidden(&secret, size));
    }
    // Of what there is much of, half of the places tell the size.
    let few: Vec<usize> = places.iter().copied().step_by(2).collect();
    let clean_few: Vec<Option<Met>> = clean.iter().cloned().step_by(2).collect();
    let one_of_many = |taken: &[Secret], size: f64, random: &mut StdRng| {
        let Some(secret) = maker.candidate(&maker.kinds(), taken, random) else { return Ok(None) };
        let found = match maker.size(&secret, &order, &few, &clean_few, &bare) {
            Err(BlindError::Missed { .. }) => return Ok(None),
            found => found?,
        };
        let amount = secret.amount * size / found.max(1e-9);
        Ok::<_, BlindError>((amount.abs() <= secret.kind.most()).then(|| secret.with_amount(amount)))
    };
    if recipe.family == Family::Crowd {
        let wanted = random.random_range(CROWD[0]..=CROWD[1]);
        for _ in 0..3 * DRAWS {
            if secrets.len() < wanted {
                let size = crowd_sigmas(&mut random);
                let Some(secret) = one_of_many(&secrets, size, &mut random)? else { continue };
                hidden.push(maker.hidden(&secret, size));
                secrets.push(secret);
            }
        }
    }
    let mut dirt = vec![];
    if recipe.dirt {
        let [fewest, most] = maker.physics.dirt;
        for _ in 0..random.random_range(fewest..=most) {
            let size = maker.physics.dirt_sigmas * random.random_range(0.25..1.0);
            dirt.extend(one_of_many(&[secrets.clone(), dirt.clone()].concat(), size, &mut random)?);
        }
    }
    let all = [secrets, dirt.clone()].concat();
    let (_, rows) = maker.tell_noise(&order, &all, &mut random)?;
    let session = maker.session(&rows);
    let answer = Answer {
        case: recipe.number,
        seed: recipe.seed,
        family: recipe.family,
        design: recipe.design.into(),
        generator: recipe.generator.into(),
        also: maker.physics.usual_names(&bench.joints(), &bench.links()),
        dirt: dirt.iter().map(|secret| maker.hidden(secret, f64::NAN).named()).collect(),
        hidden,
        sigma: vec![bare.x, bare.y, bare.z],
        rows: rows.len(),
        cells: maker.cells.len(),
    };
    Ok(Case { session, files: vec![], slides: vec![], answer })
}

/// Makes a case; where a kind cannot be as large as wanted on this robot, as large as it can.
///
/// # Errors
/// When the physics does not accept it or the arm misses the screen.
pub fn make_or_smaller(bench: &Bench, planner: &Planner<'_>, recipe: &Recipe) -> Result<Case, BlindError> {
    let smaller = |size: f64| SIZES.into_iter().rev().find(|smaller| *smaller < 0.9 * size);
    let mut recipe = recipe.clone();
    loop {
        match make(bench, planner, &recipe) {
            Err(BlindError::TooLarge { .. }) if smaller(recipe.size_sigmas).is_some() => {
                recipe.size_sigmas = smaller(recipe.size_sigmas).unwrap_or(recipe.size_sigmas);
            }
            // Hardly to be seen at all: another kind.
            Err(BlindError::TooLarge { .. }) if recipe.kind.is_some() => {
                recipe = Recipe { kind: None, seed: recipe.seed.wrapping_add(1), ..recipe };
            }
            made => return made,
        }
    }
}

/// Writes a case: the session into one folder, the answer into another.
///
/// # Errors
/// When a file cannot be written.
pub fn write(case: &Case, cases: &Path, answers: &Path) -> Result<(), BlindError> {
    let name = format!("{:03}", case.answer.case);
    write_session(&case.session, &case.files, &case.slides, &cases.join(&name))?;
    case.answer.write(&answers.join(format!("{name}.json")))
}

/// Writes a session and what lies beside its tables (name and text); columns of what slides are in meters.
///
/// # Errors
/// When a file cannot be written.
pub fn write_session(
    session: &Session,
    files: &[(String, String)],
    slides: &[String],
    folder: &Path,
) -> Result<(), BlindError> {
    session.write(folder)?;
    for (name, text) in files {
        let file = folder.join(name);
        std::fs::write(&file, text).map_err(|source| BlindError::File { file, source })?;
    }
    let table = folder.join("poses.csv");
    if slides.is_empty() {
        return Ok(());
    }
    let failed = |source| BlindError::File { file: table.clone(), source };
    let text = std::fs::read_to_string(&table).map_err(failed)?;
    let (head, rows) = text.split_once('\n').unwrap_or((&text, ""));
    let in_meters = |column: &str| {
        let own = column.strip_suffix("_rad").filter(|own| {
            ["cmd_", "enc_"].iter().any(|sort| {
                own.strip_prefix(sort).is_some_and(|joint| slides.iter().any(|slides| slides == joint))
            })
        });
        own.map_or_else(|| column.to_owned(), |own| format!("{own}_m"))
    };
    let head: Vec<String> = head.trim_end().split(',').map(in_meters).collect();
    std::fs::write(&table, format!("{}\n{rows}", head.join(","))).map_err(failed)
}

/// The screen does not stand where the rig file says; touches cannot tell, and need not.
fn moved_screen(random: &mut StdRng) -> Isometry3<f64> {
    let mut within = |most: f64| random.random_range(-most..most);
    Isometry3::from_parts(
        Translation3::new(within(0.008), within(0.008), within(0.004)),
        UnitQuaternion::from_scaled_axis(Vector3::new(within(0.006), within(0.006), within(0.02))),
    )
}

struct Maker<'a> {
    bench: &'a Bench,
    physics: Physics,
    cells: Vec<Cell>,
    screen: Isometry3<f64>,
    design: Design,
}

impl Maker<'_> {
    fn repeats(&self) -> usize {
        self.design.repeats(&self.physics.plans)
    }

    /// What this generator can hide of what the library knows.
    fn kinds(&self) -> Vec<Kind> {
        Kind::NAMED.iter().copied().filter(|kind| kind.is_hidden_by(self.physics.generator)).collect()
    }

    fn order(&self, random: &mut StdRng) -> Order {
        let mut cells: Vec<usize> = if self.physics.plans.shuffled {
            (0..self.cells.len()).flat_map(|cell| vec![cell; self.repeats()]).collect()
        } else {
            (0..self.repeats()).flat_map(|_| 0..self.cells.len()).collect()
        };
        if self.physics.plans.shuffled {
            // Drawn by chance, so that time goes with nothing else.
            cells.shuffle(random);
        }
        let mut t = START_S;
        let touches = cells
            .into_iter()
            .map(|cell| {
                t += PACE_S * random.random_range(0.8..1.2);
                (cell, t)
            })
            .collect();
        Order { touches, duration_s: t }
    }

    fn stage(&self, secrets: &[Secret], order: &Order) -> Result<Stage<'_>, BlindError> {
        let payloads_kg = self.design.payloads_kg(&self.physics.plans);
        Stage::new((self.bench, &self.physics), secrets, payloads_kg, self.screen, order.duration_s)
    }

    /// Touches some cells once, without noise.
    fn rehearse(
        &self,
        secrets: &[Secret],
        order: &Order,
        places: &[usize],
    ) -> Result<Vec<Option<Met>>, BlindError> {
        let mut stage = self.stage(secrets, order)?;
        Ok(places
            .iter()
            .map(|&cell| {
                // One of its repeats, another one for the next cell: early and late ones.
                let mut repeats = order.touches.iter().filter(|(number, _)| *number == cell);
                let t_secs = repeats.nth(cell % self.repeats()).map_or(START_S, |touch| touch.1);
                stage.touch(&self.cells[cell], t_secs, &USUAL_CHANCES)
            })
            .collect())
    }

    /// How large a secret is, against the same without it.
    fn size(
        &self,
        secret: &Secret,
        order: &Order,
        places: &[usize],
        clean: &[Option<Met>],
        sigma: &Vector3<f64>,
    ) -> Result<f64, BlindError> {
        let with = self.rehearse(std::slice::from_ref(secret), order, places)?;
        let (mut at, mut moved) = (vec![], vec![]);
        for ((cell, with), without) in places.iter().zip(&with).zip(clean) {
            let (Some(with), Some(without)) = (with, without) else { continue };
            let height_m = self.cells[*cell].height_m;
            at.push(Vector3::new(without.at_m[0], without.at_m[1], height_m));
            let seen = |met: &Met| {
                if secret.kind.is_of_servo() {
                    lag_m(self.bench, met)
                } else {
                    residual_m(self.bench, met, height_m)
                }
            };
            moved.push(seen(with) - seen(without));
        }
        if at.len() * 10 < places.len() * 9 {
            return Err(BlindError::Missed { met: at.len(), tried: places.len() });
        }
        Ok(size_sigmas(&at, &moved, sigma))
    }

    /// A secret of the wanted size.
    #[allow(clippy::too_many_arguments)]
    fn draw(
        &self,
        recipe: &Recipe,
        order: &Order,
        places: &[usize],
        clean: &[Option<Met>],
        sigma: &Vector3<f64>,
        taken: &[Secret],
        random: &mut StdRng,
    ) -> Result<(Secret, f64), BlindError> {
        let kinds: Vec<Kind> = match (recipe.kind, recipe.family) {
            (Some(kind), _) if taken.is_empty() => vec![kind],
            (_, Family::OffLibrary) => Kind::NAMELESS.to_vec(),
            _ => self.kinds(),
        };
        for _ in 0..DRAWS {
            let Some(mut secret) = self.candidate(&kinds, taken, random) else { continue };
            let mut size = 0.0;
            for _ in 0..4 {
                size = match self.size(&secret, order, places, clean, sigma) {
                    Ok(size) => size,
                    // Too far for the finger to meet the glass: not this one.
                    Err(BlindError::Missed { .. }) => break,
                    Err(other) => return Err(other),
                };
                let factor = (recipe.size_sigmas / size.max(1e-9)).clamp(0.05, 20.0);
                if (factor - 1.0).abs() < 0.08 {
                    break;
                }
                secret = secret.with_amount(secret.amount * factor);
                if secret.amount.abs() > secret.kind.most() {
                    break;
                }
                size = 0.0;
            }
            let fits = (size / recipe.size_sigmas - 1.0).abs() < 0.1;
            if fits && secret.amount.abs() <= secret.kind.most() {
                return Ok((secret, size));
            }
        }
        Err(BlindError::TooLarge { size_sigmas: recipe.size_sigmas })
    }

    /// Something that this plan can show, at a usual amount.
    fn candidate(&self, kinds: &[Kind], taken: &[Secret], random: &mut StdRng) -> Option<Secret> {
        let kind = kinds[random.random_range(0..kinds.len())];
        if self.design == Design::Plain && !kind.shows_from_one_side() {
            return None;
        }
        let joints = kind.joints();
        let joint = if joints.is_empty() { 0 } else { joints[random.random_range(0..joints.len())] };
        let once = joints.is_empty() || taken.iter().any(|s| s.joint == joint && s.kind.joints().len() > 1);
        if taken.iter().any(|s| s.kind == kind && (once || s.joint == joint)) {
            return None;
        }
        let leans = |kind: Kind| matches!(kind, Kind::TorsoLean | Kind::OtherArm);
        if leans(kind) && taken.iter().any(|s| leans(s.kind)) {
            return None;
        }
        let of_servo = kind.is_of_servo() && taken.iter().any(|s| s.joint == joint && s.kind.is_of_servo());
        if of_servo {
            return None;
        }
        let gives = |kind: Kind| matches!(kind, Kind::JointSag | Kind::SoftWhenWarm);
        if gives(kind) && taken.iter().any(|s| s.joint == joint && gives(s.kind)) {
            return None;
        }
        // One cable, one drive of an encoder, one play per joint.
        let crowded = |kind: Kind| {
            matches!(kind, Kind::Backlash | Kind::GravityBacklash | Kind::JointScale | Kind::JointCoupling)
        };
        if crowded(kind) && taken.iter().any(|s| s.joint == joint && crowded(s.kind)) {
            return None;
        }
        let positive = matches!(
            kind,
            Kind::GravityBacklash
                | Kind::JointSag
                | Kind::SidewaysGive
                | Kind::FingerRoll
                | Kind::TouchDrag
                | Kind::TorsoLean
                | Kind::ScreenBow
                | Kind::EarlyLog
                | Kind::StickSlip
                | Kind::SoftWhenWarm
                | Kind::ServoDroop
                | Kind::Stiction
        ) || (kind == Kind::Backlash && matches!(joint, 1..=3));
        let sign = if positive || random.random_bool(0.5) { 1.0 } else { -1.0 };
        let mut unit = |n: usize| {
            let mut vector = Vector3::zeros();
            for k in 0..n {
                vector[k] = normal(random);
            }
            <[f64; 3]>::from(vector.normalize())
        };
        let shape = match kind {
            Kind::JointEccentricity | Kind::ScreenScale => unit(2),
            Kind::CableStep => {
                let mut angles: Vec<f64> = self.cells.iter().map(|cell| cell.angles_rad[joint]).collect();
                angles.sort_by(f64::total_cmp);
                [angles[angles.len() * 2 / 5], 0.0, 0.0]
            }
            Kind::Magnet => {
                let tip = self.bench.nominal_tip_m(&self.cells[self.cells.len() / 2].angles_rad);
                [tip.x, tip.y, 0.0]
            }
            _ => unit(3),
        };
        let when = random.random_range(0.35..0.65);
        Some(Secret { kind, joint, amount: sign * kind.usual(), shape, when })
    }

    fn hidden(&self, secret: &Secret, size_sigmas: f64) -> Hidden {
        Hidden {
            id: secret.kind.id().to_owned(),
            site: secret.site(&self.bench.joints(), &self.bench.links()),
            parameters: secret.parameters(&self.bench.axes()),
            size_sigmas,
        }
    }

    /// The whole session with noise: the spread of repeats, and the rows.
    fn tell_noise(
        &self,
        order: &Order,
        secrets: &[Secret],
        random: &mut StdRng,
    ) -> Result<(Vector3<f64>, Vec<TouchRow>), BlindError> {
        let mut stage = self.stage(secrets, order)?;
        let (mut rows, mut residuals) = (vec![], vec![]);
        for (cell, t_secs) in &order.touches {
            let chances: [f64; 7] = random.random();
            let cell = &self.jittered(&self.cells[*cell], random);
            let Some(met) = stage.touch(cell, *t_secs, &chances) else { continue };
            let Some((met, pixel)) = self.log(met, random) else { continue };
            residuals.push((cell.number, residual_m(self.bench, &met, cell.height_m)));
            rows.push(row(cell, &met, pixel, *t_secs));
        }
        if rows.len() * 10 < order.touches.len() * 8 {
            return Err(BlindError::Missed { met: rows.len(), tried: order.touches.len() });
        }
        Ok((sigma_m(&residuals), rows))
    }

    /// As it is commanded this time.
    fn jittered(&self, cell: &Cell, random: &mut StdRng) -> Cell {
        let mut cell = cell.clone();
        if self.physics.jitter_rad > 0.0 {
            cell.angles_rad.iter_mut().for_each(|angle| *angle += self.physics.jitter_rad * normal(random));
        }
        cell
    }

    /// As it is logged: noise of panel and joints, whole pixels, whole steps of encoders. `None`
    /// beside the image.
    fn log(
        &self,
        mut met: Met,
        random: &mut StdRng,
    ) -> Option<(Met, Pixel<plumbline_model::session::Screen>)> {
        let physics = &self.physics;
        let spread = [0, 1].map(|k| met.at_m[k] + physics.panel_m[k] * physics.noise(random));
        let exact = self.bench.pixel(spread[0], spread[1]);
        let pixel = Pixel::new(exact.u_px.round(), exact.v_px.round());
        if !self.bench.screen().contains(pixel) {
            return None;
        }
        met.at_m = self.bench.on_screen_m(pixel.u_px, pixel.v_px);
        for (angle, part) in met.encoder_rad.iter_mut().zip(&self.bench.parts) {
            let read = *angle + physics.joint_rad * normal(random);
            *angle = (read / part.tick_rad).round() * part.tick_rad;
        }
        Some((met, pixel))
    }

    fn session(&self, rows: &[TouchRow]) -> Session {
        let joints = self.bench.joints();
        Session {
            manifest: Manifest {
                rig: RigReference::Named(RIG.to_owned()),
                started: jiff::Timestamp::UNIX_EPOCH,
                operator: String::new(),
                notes: "made by physics".to_owned(),
                touchscreen: Some(self.bench.screen().clone()),
                chain: Some(Chain { tip: TIP.to_owned(), joints: joints.clone() }),
                extra: toml::Table::new(),
            },
            touches: Some(TouchTable::from_rows(joints, rows)),
            localizations: None,
            poses: None,
            stereo: StereoImages::default(),
            log: None,
        }
    }
}

fn row(cell: &Cell, met: &Met, pixel: Pixel<plumbline_model::session::Screen>, t_secs: f64) -> TouchRow {
    let some = |values: &[f64]| values.iter().copied().map(Some).collect::<Vec<_>>();
    TouchRow {
        commanded_rad: some(&met.commanded_rad),
        encoder_rad: some(&met.encoder_rad),
        touch: Some(pixel),
        group: Some(format!("pose {}", cell.number + 1)),
        approach: Some(cell.approach.to_owned()),
        set: Some(cell.set.clone()),
        screen_height_m: Some(cell.height_m),
        payload_kg: Some(cell.payload_kg),
        move_secs: Some((met.move_secs * 1e3).round() / 1e3),
        t_secs: Some((t_secs * 10.0).round() / 10.0),
        target: None,
        temperature_c: vec![Some(met.temperature_c.round()); met.encoder_rad.len()],
        load: vec![],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Without anything hidden the description is right up to a tenth of the noise, and something
    /// that is hidden has the size that it was made to have.
    #[allow(clippy::print_stdout, reason = "figures are read from the test's output")]
    #[test]
    fn nothing_hidden_leaves_nothing() {
        let bench = Bench::usual().expect("the rig");
        let planner = Planner::new(&bench).expect("it reaches the screen");
        let mut random = StdRng::seed_from_u64(5);
        for design in [Design::Plain, Design::Rich] {
            let physics = Physics::lean();
            let cells = planner.cells(design, &physics.plans, &mut random).expect("poses");
            let screen = moved_screen(&mut random);
            let maker = Maker { bench: &bench, physics, cells, screen, design };
            let order = maker.order(&mut random);
            let all: Vec<usize> = (0..maker.cells.len()).collect();
            let met = maker.rehearse(&[], &order, &all).expect("physics");
            let (mut places, mut residuals) = (vec![], vec![]);
            for (cell, met) in maker.cells.iter().zip(&met) {
                let met = met.as_ref().expect("every pose meets the glass");
                places.push(Vector3::new(met.at_m[0], met.at_m[1], cell.height_m));
                residuals.push(residual_m(&bench, met, cell.height_m));
            }
            let size = size_sigmas(&places, &residuals, &Vector3::new(1e-3, 1e-3, 0.3e-3));
            println!("{design:?}: {size:.3} sigma");
            assert!(size < 0.15, "{design:?}: {size}");
        }
    }
}
