//! A trained correction model, where it may be trusted, and where it comes from.

use plumbline_model::session::Screen;
use plumbline_model::{Pixel, Point, Robot};
use serde::{Deserialize, Serialize};

use crate::blocks::Blocks;
use crate::border::{Border, Spread};
use crate::data::{Touch, TouchData};
use crate::errors::Errors;
use crate::heights::HeightGrid;
use crate::method::{Correction, Method};
use crate::network::Ensemble;
use crate::options::TrainOptions;
use crate::placement::M1;

/// Maps a touch pixel to the point that must be sent.
#[derive(Clone, Debug, PartialEq)]
pub struct CorrectionModel {
    pub(crate) parts: Parts,
    pub(crate) trust: Option<Trust>,
    pub(crate) provenance: Provenance,
}

/// What answers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "method", rename_all = "lowercase")]
pub(crate) enum Parts {
    M1(M1),
    M2 { network: Ensemble, heights: HeightGrid },
    M3 { network: Ensemble },
}

/// The spread is widened by no larger factor; what is missing then is added.
const WIDEST: f64 = 3.0;

/// Where answers may be trusted, and how far.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Trust {
    pub border: Border,
    pub spread: Spread,
    /// Standard deviation per axis that comes to the spread, m: touches of sets that were held out are
    /// off by what their whole set is off by, which areas held out do not show.
    pub of_sets_m: [f64; 3],
    /// Factor on the spread per axis, 1 to [`WIDEST`], for the same reason.
    pub widened: [f64; 3],
}

impl Trust {
    /// The spread learned from areas, widened until it holds held-out residuals (m) of the touches.
    pub(crate) fn new(border: Border, spread: Spread, data: &TouchData, residuals_m: &[[f64; 3]]) -> Self {
        let count = residuals_m.len().max(1) as f64;
        // Where few touches tell nothing of the noise at a touch, the spread is nearly zero there
        // and large away from it: no factor puts that right.
        let (mut found, mut stated) = ([0.0; 3], [0.0; 3]);
        for (touch, residual) in data.touches.iter().zip(residuals_m) {
            let sd_m = spread.sd_m(touch.pixel);
            for axis in 0..3 {
                found[axis] += residual[axis].powi(2);
                stated[axis] += sd_m[axis].powi(2);
            }
        }
        let factor = |axis: usize| (found[axis] / stated[axis].max(f64::MIN_POSITIVE)).sqrt();
        let widened: [f64; 3] = std::array::from_fn(|axis| factor(axis).clamp(1.0, WIDEST));
        let rest = |axis: usize| (found[axis] - widened[axis].powi(2) * stated[axis]) / count;
        let of_sets_m = std::array::from_fn(|axis| rest(axis).max(0.0).sqrt());
        Self { border, spread, of_sets_m, widened }
    }

    /// Why it cannot be used; `None` when it can. Border and spread are checked as they are read.
    pub(crate) fn fault(&self) -> Option<String> {
        let sound = self.of_sets_m.iter().all(|sd_m| sd_m.is_finite() && *sd_m >= 0.0);
        let sound = sound && self.widened.iter().all(|factor| (1.0..=WIDEST).contains(factor));
        (!sound).then(|| "a part of the spread is negative, or no number".to_owned())
    }

    fn sd_m(&self, pixel: Pixel<Screen>, disagreement_m: [f64; 3]) -> [f64; 3] {
        let sd_m = self.spread.sd_m_with(pixel, disagreement_m);
        std::array::from_fn(|axis| self.of_sets_m[axis].hypot(self.widened[axis] * sd_m[axis]))
    }
}

/// Where a model comes from; enough to train it again.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Provenance {
    /// Name of the session, or of the file that was imported.
    pub session: String,
    /// Name and version of the program.
    pub software: String,
    /// When it was trained or imported.
    pub made: jiff::Timestamp,
    /// What it was trained on; empty for an imported model.
    pub touches: Vec<TrainedTouch>,
    /// What was left out of the session and why, a sentence each.
    pub left_out: Vec<String>,
    /// `None` for an imported model.
    pub options: Option<TrainOptions>,
    /// Errors of targets sent as they are, on the same touches: what there is without a model. As the screen lay
    /// for the training, wherever it is placed later. `None` for an imported model.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub without: Option<Errors>,
    /// Errors on the touches that it was trained on.
    pub training: Option<Errors>,
    /// Errors on touches that were held out.
    pub cross_validation: Option<CrossValidation>,
    /// What else has to be known of it, a sentence each.
    pub remarks: Vec<String>,
}

/// A touch as a model keeps it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TrainedTouch {
    /// Row of the session's table, counted from 0.
    pub row: usize,
    /// Touch pixel (u, v), px.
    pub pixel: [f64; 2],
    /// Point sent, robot frame, m.
    pub sent_m: [f64; 3],
    /// Its set.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub set: Option<String>,
}

/// Errors on touches whose whole block the model had not seen.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CrossValidation {
    /// What was held out together.
    pub blocks: Blocks,
    /// Over all touches.
    pub errors: Errors,
    /// 95 % interval of the mean 2D error, from drawing blocks with replacement, m.
    pub mean_2d_interval_m: [f64; 2],
    /// Predicted − sent, in the order of the touches, m.
    pub residuals_m: Vec<[f64; 3]>,
}

impl From<&Touch> for TrainedTouch {
    fn from(touch: &Touch) -> Self {
        Self {
            row: touch.row,
            pixel: [touch.pixel.u_px, touch.pixel.v_px],
            sent_m: touch.sent.coords.into(),
            set: touch.set.clone(),
        }
    }
}

impl Parts {
    pub(crate) fn at(&self, pixel: Pixel<Screen>) -> Point<Robot> {
        match self {
            Self::M1(m1) => m1.at(pixel),
            Self::M2 { network, heights } => {
                let xy = network.at(pixel);
                Point::new(xy[0], xy[1], heights.at(xy[0], xy[1]))
            }
            Self::M3 { network } => {
                let xyz = network.at(pixel);
                Point::new(xyz[0], xyz[1], xyz[2])
            }
        }
    }

    pub(crate) fn method(&self) -> Method {
        match self {
            Self::M1(_) => Method::M1,
            Self::M2 { .. } => Method::M2,
            Self::M3 { .. } => Method::M3,
        }
    }

    /// Its networks; `None` for M1.
    pub(crate) fn network(&self) -> Option<&Ensemble> {
        match self {
            Self::M1(_) => None,
            Self::M2 { network, .. } | Self::M3 { network } => Some(network),
        }
    }

    /// Predicted − sent for each touch, m.
    pub(crate) fn residuals_m(&self, data: &TouchData) -> Vec<[f64; 3]> {
        let residual = |touch: &Touch| (self.at(touch.pixel).coords - touch.sent.coords).into();
        data.touches.iter().map(residual).collect()
    }

    /// Standard deviation between the networks of the ensemble per axis, m.
    fn disagreement_m(&self, pixel: Pixel<Screen>) -> [f64; 3] {
        let Some(network) = self.network().filter(|network| network.members.len() > 1) else {
            return [0.0; 3];
        };
        let answers: Vec<Vec<f64>> = network.members.iter().map(|member| member.at(pixel)).collect();
        let count = answers.len() as f64;
        std::array::from_fn(|axis| {
            let values = answers.iter().filter_map(|answer| answer.get(axis).copied());
            let mean = values.clone().sum::<f64>() / count;
            (values.map(|value| (value - mean).powi(2)).sum::<f64>() / (count - 1.0)).sqrt()
        })
    }

    pub(crate) fn fault(&self) -> Option<String> {
        let outputs = |network: &Ensemble, needed: usize| {
            let found = network.outputs();
            (found != needed).then(|| format!("the network has {found} outputs where {needed} are needed"))
        };
        match self {
            Self::M1(m1) => m1.fault(),
            Self::M2 { network, heights } => {
                network.fault().or_else(|| outputs(network, 2)).or_else(|| heights.fault())
            }
            Self::M3 { network } => network.fault().or_else(|| outputs(network, 3)),
        }
    }
}

impl CorrectionModel {
    /// Which kind it is.
    pub fn method(&self) -> Method {
        self.parts.method()
    }

    /// The point to send so that the real fingertip lands on `pixel`.
    ///
    /// It answers for every pixel: outside of the border with the straight continuation of its
    /// units (ReLU) or of its placement (M1, whose height stays that of the grid's edge). How little
    /// that is worth stands in `inside` and `sd_m`. Of a model that was imported without its
    /// touches nothing is known: nothing is inside and `sd_m` is infinite.
    pub fn correct(&self, pixel: Pixel<Screen>) -> Correction {
        let target = self.parts.at(pixel);
        match &self.trust {
            None => Correction { target, inside: false, sd_m: [f64::INFINITY; 3] },
            Some(trust) => Correction {
                target,
                inside: trust.border.contains(pixel),
                sd_m: trust.sd_m(pixel, self.parts.disagreement_m(pixel)),
            },
        }
    }

    /// Where it comes from.
    pub fn provenance(&self) -> &Provenance {
        &self.provenance
    }

    /// Where its data end; `None` for a model that was imported without its touches.
    pub fn border(&self) -> Option<&Border> {
        self.trust.as_ref().map(|trust| &trust.border)
    }

    /// Shape of its networks and how many are averaged; `None` for M1.
    pub fn network_shape(&self) -> Option<(String, usize)> {
        let network = self.parts.network()?;
        Some((network.members.first()?.shape(), network.members.len()))
    }

    /// The placement and heights of an M1.
    pub fn m1(&self) -> Option<&M1> {
        match &self.parts {
            Parts::M1(m1) => Some(m1),
            _ => None,
        }
    }
}
