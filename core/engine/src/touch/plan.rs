//! A plan with everything that a run needs of it, as it is kept in the session's folder, and how it
//! is made.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

use plumbline_correction::CorrectionModel;
use plumbline_effects::observability::{Noise, PlanScore, PlannedContact, score};
use plumbline_effects::{ModelArm, RobotModel};
use plumbline_model::JobContext;
use plumbline_model::robot::ik::SolverError;
use plumbline_model::robot::{Posture, Rig};
use plumbline_model::session::Touchscreen;
use plumbline_model::touch_plan::{PlanOptions, PlannedTouch, TouchPlan};
use plumbline_model::{Point, Robot};
use serde::{Deserialize, Serialize};

use super::command::Correction;
use super::telling;
use super::view::PlanView;
use crate::ground::jobs::{JobError, Part};
use crate::ground::text::sentence;
use crate::motion::{Hold, NoWay, Planner, ScreenPlace, TouchPace, Wanted};

/// The tip that touches unless another finger was chosen, and that M1 to M3 correct.
pub const TIP: &str = "right_index_tip";
/// Version of the plan's file.
pub const FORMAT: u32 = 1;
/// Share of the work of a plan whose touches have to be chosen first after which they are chosen.
const CHOSEN_AT: f64 = 0.8;

/// A planned touch with the point that is sent for it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Aim {
    /// The planned touch.
    pub touch: PlannedTouch,
    /// How the hand is held at it.
    #[serde(default, skip_serializing_if = "Hold::is_usual")]
    pub hold: Hold,
    /// Place of its pixel on the glass, on its block; robot frame, m.
    pub place_m: [f64; 3],
    /// The point that is sent; robot frame, m.
    pub sent_m: [f64; 3],
    /// Whether the model that corrects knows this part of the screen; true without a model.
    pub inside: bool,
    /// Why it cannot be touched.
    pub refusal: Option<String>,
    /// Posture at the contact; `None` when it cannot be touched.
    pub posture: Option<Posture>,
}

impl Aim {
    /// The point that is sent.
    pub fn sent(&self) -> Point<Robot> {
        point(self.sent_m)
    }

    /// Place of its pixel on the glass.
    pub fn place(&self) -> Point<Robot> {
        point(self.place_m)
    }

    /// As it is planned.
    pub fn wanted(&self) -> Wanted {
        let PlannedTouch { target, side, .. } = self.touch;
        Wanted { target, place: self.place(), sent: self.sent(), side, hold: self.hold, deeper_m: 0.0 }
    }

    /// Height of the block under the screen (m) and mass in the hand (kg) that it needs.
    pub fn preparation(&self) -> [f64; 2] {
        [self.touch.screen_height_m, self.touch.payload_kg]
    }
}

/// A whole plan.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunPlan {
    /// Version of the file.
    pub format: u32,
    /// What it was made from.
    pub options: PlanOptions,
    /// In the order in which they are made.
    pub touches: Vec<Aim>,
    /// What corrected the targets.
    pub corrected_with: Option<Correction>,
    /// The model of the robot that they were corrected with, for people: "with 2 effects"; empty where
    /// no effects corrected them.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub model: String,
    /// How long it takes, estimated, s.
    pub duration_s: f64,
    /// What it will be able to tell apart; not kept on disk.
    #[serde(skip)]
    pub score: Option<PlanScore>,
}

impl RunPlan {
    /// A touch by its number, from 1.
    pub fn aim(&self, number: usize) -> Option<&Aim> {
        self.touches.get(number.checked_sub(1)?).filter(|aim| aim.touch.number == number)
    }

    /// Number of touches that can be made.
    pub fn reachable(&self) -> usize {
        self.touches.iter().filter(|aim| aim.refusal.is_none()).count()
    }

    /// What the window shows of it.
    pub fn view(&self) -> PlanView {
        PlanView {
            options: self.options.clone(),
            reachable: self.reachable(),
            refusals: refusals(&self.touches),
            duration: Duration::try_from_secs_f64(self.duration_s).unwrap_or_default(),
            model: self.model.as_str().into(),
            score: self.score.clone(),
            postures: self.touches.iter().map(|aim| aim.posture.clone()).collect(),
        }
    }
}

/// What is to be planned.
#[derive(Clone, Debug)]
pub struct PlanRequest {
    /// The robot, its screen where it is taken to lie without a block under it.
    pub rig: Arc<Rig>,
    /// Whether that place of the screen was measured.
    pub place: ScreenPlace,
    /// What the operator chose.
    pub options: PlanOptions,
    /// What targets are corrected with.
    pub corrector: Corrector,
}

/// What targets are corrected with.
#[derive(Clone, Debug, Default)]
pub enum Corrector {
    /// Nothing: they are sent as they are.
    #[default]
    None,
    /// A model that was trained from touches.
    Model(Arc<CorrectionModel>),
    /// The effects of the robot as it is known.
    Effects(Arc<RobotModel>),
}

impl Corrector {
    fn name(&self) -> Option<Correction> {
        match self {
            Self::None => None,
            Self::Model(model) => Some(model.method().into()),
            Self::Effects(_) => Some(Correction::Effects),
        }
    }

    fn model(&self) -> String {
        match self {
            Self::None | Self::Model(_) => String::new(),
            Self::Effects(model) => model.title(),
        }
    }
}

/// Plans every touch, in order, by an arm that begins ready to touch.
pub fn make(request: &PlanRequest, context: &dyn JobContext) -> Result<RunPlan, JobError> {
    let PlanRequest { rig, place, options, corrector } = request;
    let words = |error: &dyn std::fmt::Display| JobError::failed(sentence(&error.to_string()));
    let tip = options.finger.tip();
    let (began, planned) = match options.telling() {
        Some(wanted) => {
            options.check(&rig.touchscreen).map_err(|error| words(&error))?;
            (CHOSEN_AT, telling(request, wanted, &Part { whole: context, begin: 0.0, end: CHOSEN_AT })?)
        }
        None => {
            let plan = TouchPlan::make(options, &rig.touchscreen).map_err(|error| words(&error))?;
            (0.0, plan.touches.into_iter().map(|touch| (touch, Hold::default())).collect())
        }
    };
    let senders = Senders::of(corrector, tip).map_err(JobError::failed)?;
    let (pace, count) = (TouchPace::default(), planned.len());
    let mut duration = Duration::ZERO;
    let mut planner: Option<(f64, Planner)> = None;
    let mut stands: Option<Posture> = None;
    let mut touches: Vec<Aim> = vec![];
    let mut contacts = vec![];
    for (touch, hold) in planned {
        context.checkpoint()?;
        let done = touches.len() as f64 / count.max(1) as f64;
        context.report(began + (0.9 - began) * done, &format!("target {} of {count}", touches.len() + 1));
        let height_m = touch.screen_height_m;
        let planner = match &mut planner {
            Some((of_m, planner)) if *of_m == height_m => &*planner,
            slot => {
                let on_block = Arc::new(raised(rig, height_m));
                let made = Planner::new(&on_block, tip, *place).map_err(JobError::failed)?;
                &slot.insert((height_m, made)).1
            }
        };
        let from = stands.take().unwrap_or_else(|| planner.ready(&rig.home()));
        let mut aim = senders.aim(rig, planner, touch, hold, &from);
        let path = match aim.refusal.take() {
            None => planner.plan(&aim.wanted(), &from).map_err(|why| why.to_string()),
            Some(reason) => Err(reason),
        };
        stands = Some(match path {
            Ok(path) => {
                duration += path.duration(&pace);
                contacts.push(PlannedContact {
                    angles_rad: path.contact.of(planner.chain().joints()),
                    direction: path.direction.iter().map(|sign| f64::from(*sign)).collect(),
                    screen_height_m: height_m,
                    payload_kg: aim.touch.payload_kg,
                    group: aim.touch.group.clone(),
                });
                aim.posture = Some(path.contact.clone());
                path.above().clone()
            }
            Err(reason) => {
                aim.refusal = Some(reason);
                from
            }
        });
        touches.push(aim);
    }
    context.checkpoint()?;
    context.report(0.9, "what the touches will tell");
    // A plan without a score is still a plan.
    let score = score(rig, tip, &contacts, &Noise::default())
        .map_err(|error| log::info!("the plan was not scored: {error}"))
        .ok();
    Ok(RunPlan {
        format: FORMAT,
        options: options.clone(),
        touches,
        corrected_with: corrector.name(),
        model: corrector.model(),
        duration_s: duration.as_secs_f64(),
        score,
    })
}

/// The touches that tell most of where the palm will be, of the screen where it is taken to lie; `wanted`:
/// how many places, and how many of them twice.
fn telling(
    request: &PlanRequest,
    (places, again): (usize, usize),
    context: &dyn JobContext,
) -> Result<Vec<(PlannedTouch, Hold)>, JobError> {
    let PlanRequest { rig, place, options, .. } = request;
    let planner = Planner::new(rig, options.finger.tip(), *place).map_err(JobError::failed)?;
    let possible = telling::candidates(&planner, &options.area, context)?;
    context.checkpoint()?;
    let chosen = telling::choose(rig, options.finger, &possible, places, again)
        .map_err(|error| JobError::failed(sentence(&error.to_string())))?;
    let ordered = telling::in_short_ways(&chosen, &possible);
    let planned = ordered.iter().enumerate().map(|(k, pick)| {
        let candidate = &possible[pick.candidate];
        (candidate.planned(k + 1, pick.group), candidate.hold)
    });
    Ok(planned.collect())
}

/// Why targets cannot be corrected as was asked.
#[derive(Debug, thiserror::Error)]
enum NotCorrected {
    /// There is nothing to correct with.
    #[error(
        "No effect is in the model. Search the gap and add what it names, or correct with something else."
    )]
    Nominal,
    /// It was learned with another arm.
    #[error(
        "M1 to M3 were learned with the right index finger. Correct the left one with the effects of the model, or \
         send its targets as they are."
    )]
    OtherFinger,
    /// The model does not speak of this arm.
    #[error("{}", sentence(&.0.to_string()))]
    Arm(#[from] SolverError),
}

/// What decides where the tip is sent.
enum Senders<'a> {
    /// To the pixel itself.
    Plain,
    /// Where a trained model says. It speaks of the screen without a block: what it adds is added on
    /// the block, too.
    Model(&'a CorrectionModel),
    /// Where the arm with its effects ends on the pixel.
    Effects { arm: ModelArm, screen: Touchscreen },
}

impl<'a> Senders<'a> {
    fn of(corrector: &'a Corrector, tip: &str) -> Result<Self, NotCorrected> {
        Ok(match corrector {
            Corrector::None => Self::Plain,
            Corrector::Model(_) if tip != TIP => return Err(NotCorrected::OtherFinger),
            Corrector::Model(model) => Self::Model(model),
            Corrector::Effects(model) => {
                if model.is_nominal() {
                    return Err(NotCorrected::Nominal);
                }
                let arm = model.arm(tip)?;
                let screen = model.touchscreen().clone();
                Self::Effects { arm, screen }
            }
        })
    }

    /// The point that is sent for a planned touch, by an arm that stands at `from`.
    fn aim(&self, rig: &Rig, planner: &Planner, touch: PlannedTouch, hold: Hold, from: &Posture) -> Aim {
        let place = rig.touchscreen.raised(touch.screen_height_m).point_at(touch.target);
        let (mut sent, mut inside, mut refusal) = (place, true, None);
        match self {
            _ if touch.as_described => {}
            Self::Plain => {}
            Self::Model(model) => {
                let correction = model.correct(touch.target);
                let up_m = rig.touchscreen.normal().vector() * touch.screen_height_m;
                (sent, inside) = (Point::from(correction.target.coords + up_m), correction.inside);
            }
            Self::Effects { arm, screen } => {
                let mut direction: Option<Vec<f64>> = None;
                let commanded = |sent| {
                    let (angles_rad, signs) =
                        planner.commanded(touch.target, sent, touch.side, hold, from)?;
                    // A joint that nearly stands must not turn round from one point to the next.
                    Ok::<_, NoWay>((angles_rad, direction.get_or_insert(signs).clone()))
                };
                match arm.deviated().sent_for(
                    screen,
                    touch.target,
                    touch.screen_height_m,
                    touch.payload_kg,
                    commanded,
                ) {
                    Ok(Some(point)) => sent = point,
                    Ok(None) => {
                        refusal = Some(format!(
                            "The effects of the model leave no command that leads to pixel ({:.0}, {:.0}). Choose a \
                             smaller area, or correct with something else.",
                            touch.target.u_px, touch.target.v_px
                        ));
                    }
                    Err(why) => refusal = Some(why.to_string()),
                }
            }
        }
        Aim {
            touch,
            hold,
            place_m: place.coords.coords.into(),
            sent_m: sent.coords.coords.into(),
            inside,
            refusal,
            posture: None,
        }
    }
}

/// The robot with its screen on a block of this height.
pub fn raised(rig: &Rig, height_m: f64) -> Rig {
    Rig { touchscreen: rig.touchscreen.raised(height_m), ..rig.clone() }
}

/// Reasons that differ only in their numbers count as one; the first of them speaks for all.
fn refusals(touches: &[Aim]) -> Vec<(String, usize)> {
    let mut kinds: BTreeMap<String, (String, usize)> = BTreeMap::new();
    for reason in touches.iter().filter_map(|aim| aim.refusal.as_ref()) {
        let kind: String = reason.chars().filter(|c| !c.is_ascii_digit()).collect();
        kinds.entry(kind).or_insert_with(|| (reason.clone(), 0)).1 += 1;
    }
    let mut refusals: Vec<(String, usize)> = kinds.into_values().collect();
    refusals.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
    refusals
}

fn point([x, y, z]: [f64; 3]) -> Point<Robot> {
    Point::new(x, y, z)
}
