//! From a prediction and a pair of images to the place of the hand.

use nalgebra::{Matrix3, Vector3};
use plumbline_model::Eye;

use super::lines::{from_colors, from_evidence};
use super::search::{Scores, best_shift};
use super::shape::{EyesAt, HandShape, InView, Part, Solid};
use super::sight::{Around, Images, Sight};
use super::solve::{Measured, Prior, Solution, Unknowns, moved, nothing, resized, slope, solve, three};
use super::view::{HandView, RimPoint, labels, mask, rim};
use super::{EyeFit, HandNotSeen, HandOptions, HandSeen, OutlinePoint, Pair, Predicted};

/// Half lengths of the lines on which evidence is added up, px: one round each.
const EVIDENCE_PX: [usize; 3] = [9, 6, 4];
/// Rounds in which colors are fitted.
const COLOR_ROUNDS: usize = 3;
/// Candidates of the first search lie this far apart, m: about a pixel.
const STEP_M: f64 = 0.0025;
/// Fewer lines than this are no hand.
const LEAST_LINES: usize = 20;
/// Images are cut anew when the hand was looked for farther than this, px.
const NARROW_PX: f64 = 6.0;
/// Without a pair before, edges of the background pass for the hand's: a line is off by this much, px.
const BACKGROUND_PX: f64 = 1.3;
/// A residual larger than this is no outline of the hand, px.
const MOST_SPREAD_PX: f64 = 3.0;

impl HandShape {
    /// What both eyes would see of the hand.
    pub fn view(&self, eyes: &EyesAt, predicted: &Predicted<'_>) -> HandView {
        let solids = self.posed(predicted.posture);
        let [left, right] = Eye::BOTH.map(|eye| {
            let hand = InView::new(&solids, &eyes.camera_from_robot(eye), &predicted.robot_from_tip);
            mask(&hand, eyes.camera(eye))
        });
        HandView { left, right }
    }
}

/// Finds the hand in a pair of images, from where the arm's model has it.
///
/// `before` is a pair taken with the same posture of the head when the hand was not in view; with it,
/// what lies behind the hand is known. It works without, where hand and background differ in color.
///
/// # Errors
/// When the hand is not where it should be, or cannot be told from what is around it.
pub fn look_for_hand(
    before: Option<Pair<'_>>,
    now: Pair<'_>,
    eyes: &EyesAt,
    hand: &HandShape,
    predicted: &Predicted<'_>,
    options: &HandOptions,
) -> Result<HandSeen, HandNotSeen> {
    let solids = hand.posed(predicted.posture);
    let prior = Prior::new(&predicted.covariance_m2, &solids, options).ok_or(HandNotSeen::NoPrior)?;
    let sights = |around: &Around<'_>| -> Result<Vec<Sight<'_>>, HandNotSeen> {
        let of = |eye| Sight::new(eye, images(before, now, eye), eyes, around, options);
        let sights: Vec<Sight<'_>> =
            Eye::BOTH.into_iter().map(of).collect::<Result<Vec<_>, _>>()?.into_iter().flatten().collect();
        if sights.is_empty() { Err(HandNotSeen::OutsideView) } else { Ok(sights) }
    };
    let wide =
        Around { solids: &solids, place: predicted.robot_from_tip, covariance_m2: predicted.covariance_m2 };
    let mut search = Search { solids: &solids, predicted, prior, sights: sights(&wide)? };
    let mut at = nothing(&solids);
    let shift = search.first_shift().ok_or(HandNotSeen::NoPrior)?;
    at.fixed_rows_mut::<3>(0).copy_from(&shift);
    if search.sights.iter().any(|sight| sight.reach_px > NARROW_PX) {
        // From here on less of the images matters.
        let narrow = Around { place: moved(predicted, &at), covariance_m2: Matrix3::zeros(), ..wide };
        search.sights = sights(&narrow)?;
    }
    let mut solution = None;
    for round in 0..EVIDENCE_PX.len() + COLOR_ROUNDS {
        let lines = search.lines(&at, EVIDENCE_PX.get(round).copied());
        if lines.len() < LEAST_LINES {
            return Err(search.nothing_there(&at, options));
        }
        let found = solve(&lines, &search.prior, &at).ok_or(HandNotSeen::NoPrior)?;
        at = found.unknowns.clone();
        solution = Some((lines, found));
    }
    let (lines, found) = solution.ok_or(HandNotSeen::NoPrior)?;
    search.judged(&lines, &found, options)
}

fn images<'a>(before: Option<Pair<'a>>, now: Pair<'a>, eye: Eye) -> Images<'a> {
    Images { now: now.of(eye), before: before.map(|pair| pair.of(eye)) }
}

/// All that is known, while it is looked for.
struct Search<'a> {
    solids: &'a [Solid],
    predicted: &'a Predicted<'a>,
    prior: Prior,
    sights: Vec<Sight<'a>>,
}

impl Search<'_> {
    /// To about a pixel, by silhouettes.
    fn first_shift(&self) -> Option<Vector3<f64>> {
        let covariance_m2: &Matrix3<f64> = &self.predicted.covariance_m2;
        let mut shift = Vector3::zeros();
        for round in 0..2 {
            let mut unknowns = nothing(self.solids);
            unknowns.fixed_rows_mut::<3>(0).copy_from(&shift);
            let place = moved(self.predicted, &unknowns);
            let solids = self.solids;
            let mut eyes = vec![];
            for sight in &self.sights {
                let labels_here = labels(&sight.in_view(solids, &place), &sight.rays);
                let Some(ratios) = sight.ratios(&labels_here, round == 0) else { continue };
                let predicted =
                    labels(&sight.in_view(self.solids, &self.predicted.robot_from_tip), &sight.rays);
                eyes.push((&sight.moves, Scores::new(&sight.evidence, &ratios, &predicted, sight.reach_px)));
            }
            shift = best_shift(&eyes, covariance_m2, STEP_M)?;
        }
        Some(shift)
    }

    /// Lines across the rim of the hand at a place: by evidence up to `half_px`, or by colors.
    fn lines(&self, at: &Unknowns, half_px: Option<usize>) -> Vec<Measured> {
        let (place, solids) = (moved(self.predicted, at), resized(self.solids, at));
        let mut lines = vec![];
        for sight in &self.sights {
            let hand = sight.in_view(&solids, &place);
            let labels = labels(&hand, &sight.rays);
            let rim = rim(&hand, sight.camera, &sight.evidence.region, &labels);
            let ratios = half_px.and_then(|_| sight.ratios(&labels, false));
            for point in rim {
                let crossing = match (half_px, &ratios) {
                    (Some(half_px), Some(ratios)) => {
                        from_evidence(ratios, &sight.evidence.region, &point, half_px)
                    }
                    (Some(_), None) => None,
                    (None, _) => from_colors(sight.images.now, sight.images.before, &point),
                };
                let crossing = crossing.map(|crossing| match sight.images.before {
                    Some(_) => crossing,
                    None => crossing.doubted(BACKGROUND_PX),
                });
                let slope = slope(
                    &point,
                    &solids[point.solid],
                    sight.camera,
                    &sight.camera_from_robot,
                    &place,
                    at.len(),
                );
                if let Some((crossing, slope)) = crossing.zip(slope) {
                    lines.push(Measured { eye: sight.eye, point, crossing, slope });
                }
            }
        }
        lines
    }

    /// Shares of the hand that look like something else, and that have changed.
    fn shares(&self, at: &Unknowns, sight: &Sight<'_>) -> (f64, Option<f64>) {
        let (place, solids) = (moved(self.predicted, at), resized(self.solids, at));
        let labels = labels(&sight.in_view(&solids, &place), &sight.rays);
        let hand: Vec<usize> =
            (0..labels.len()).filter(|i| matches!(labels[*i], Some(Part::Palm | Part::Digit))).collect();
        let share = |count: usize| count as f64 / hand.len().max(1) as f64;
        let odd = sight
            .ratios(&labels, false)
            .map_or(hand.len(), |ratios| hand.iter().filter(|i| ratios[**i] < UNLIKE).count());
        let changed = sight
            .evidence
            .knows_before()
            .then(|| share(hand.iter().filter(|i| sight.evidence.has_changed(**i) == Some(true)).count()));
        (share(odd), changed)
    }

    /// Why there are too few lines.
    fn nothing_there(&self, at: &Unknowns, options: &HandOptions) -> HandNotSeen {
        let shares: Vec<_> = self.sights.iter().map(|sight| self.shares(at, sight)).collect();
        let changed = shares.iter().filter_map(|(_, changed)| *changed).reduce(f64::max);
        if let Some(share) = changed.filter(|share| *share < options.least_changed) {
            return HandNotSeen::NothingChanged { share };
        }
        let share = shares.iter().map(|(hidden, _)| *hidden).fold(0.0, f64::max);
        HandNotSeen::Hidden { share }
    }

    fn judged(
        &self,
        lines: &[Measured],
        found: &Solution,
        options: &HandOptions,
    ) -> Result<HandSeen, HandNotSeen> {
        let at = &found.unknowns;
        let offset_m: Vector3<f64> = three(at, 0);
        let information = self.predicted.covariance_m2.try_inverse().ok_or(HandNotSeen::NoPrior)?;
        let sigmas = offset_m.dot(&(information * offset_m)).max(0.0).sqrt();
        let mut fit = [None, None];
        let mut seen = false;
        let mut worst: Option<HandNotSeen> = None;
        for sight in &self.sights {
            let (hidden, changed) = self.shares(at, sight);
            match changed.filter(|share| *share < options.least_changed) {
                Some(share) => worst = Some(HandNotSeen::NothingChanged { share }),
                None if hidden > options.most_hidden => worst = Some(HandNotSeen::Hidden { share: hidden }),
                None => seen = true,
            }
            fit[sight.eye.index()] = Some(EyeFit {
                outline: self.outline(sight, lines, found),
                spread_px: found.spread_px,
                hidden,
                changed,
            });
        }
        if let Some(worst) = worst.filter(|_| !seen) {
            return Err(worst);
        }
        if !(sigmas <= options.most_sigmas) || !(found.spread_px <= MOST_SPREAD_PX) {
            return Err(HandNotSeen::DoesNotFit { sigmas, spread_px: found.spread_px });
        }
        Ok(HandSeen {
            offset_m,
            covariance_m2: found.covariance.fixed_view::<3, 3>(0, 0).into_owned(),
            turn_rad: three(at, 3),
            robot_from_tip: moved(self.predicted, at),
            fit,
        })
    }

    fn outline(&self, sight: &Sight<'_>, lines: &[Measured], found: &Solution) -> Vec<OutlinePoint> {
        let own = lines.iter().zip(found.residuals.iter().zip(&found.weights));
        own.filter(|(line, _)| line.eye == sight.eye)
            .map(|(line, (residual, weight))| {
                let point: &RimPoint = &line.point;
                let on_line = line.crossing.shift_px - residual;
                OutlinePoint {
                    pixel_px: point.pixel + point.normal * on_line,
                    normal: point.normal,
                    residual_px: Some(*residual),
                    weight: *weight,
                }
            })
            .collect()
    }
}

/// Pixels whose evidence is below this look like something else than the hand.
const UNLIKE: f32 = -1.0;
