//! Parameters of effects as people and files read them.

use nalgebra::{DMatrix, DVector};
use plumbline_model::parameter_units::RIGID_NM_PER_RAD;

use super::Effect;
use super::entry::Shape;

/// Standard deviations on either side of a 95 % interval.
const NINETY_FIVE: f64 = 1.96;

/// A parameter with its 95 % interval.
#[derive(Clone, Debug, PartialEq)]
pub struct Reported {
    /// Name with the unit, as on the command line.
    pub name: String,
    /// Value.
    pub value: f64,
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// What a number cannot say (`from_joint`: the name of a joint; `which` of some things); the value is then
    /// zero.
    pub text: Option<String>,
}

impl Effect {
    /// Its parameters under the names and in the units of the command line: one value per
    /// parameter of [`Self::parameters`] and their covariance in squared units of the values.
    pub fn report(&self, values: &[f64], covariance: &DMatrix<f64>) -> Vec<Reported> {
        if self.is_of_every_site() {
            return self.of_members(values, covariance);
        }
        (self.kind.entry().reported)(self, &Fit { values, covariance })
    }

    /// Its parameters as they are, and what its shape says about times.
    pub(super) fn plain(&self, fit: &Fit<'_>) -> Vec<Reported> {
        let own = self.parameters().iter().enumerate().map(|(k, one)| fit.plain(k, one.name));
        own.chain(self.times()).collect()
    }

    /// Of something whose sign says only to which side it counts.
    pub(super) fn size(&self, fit: &Fit<'_>) -> Vec<Reported> {
        vec![fit.size(0, self.parameters()[0].name)]
    }

    /// Of a compliance that is told as a stiffness.
    pub(super) fn stiffness(&self, fit: &Fit<'_>) -> Vec<Reported> {
        vec![fit.stiffness()]
    }

    /// Of what another joint pulls along.
    pub(super) fn coupled(&self, fit: &Fit<'_>) -> Vec<Reported> {
        let text = self.puller().map(|puller| puller.joint.clone());
        vec![
            fit.plain(0, "ratio"),
            Reported { name: "from_joint".to_owned(), value: 0.0, low: 0.0, high: 0.0, text },
        ]
    }

    /// Of what begins at a torque.
    pub(super) fn limit(&self, fit: &Fit<'_>) -> Vec<Reported> {
        vec![self.shape("torque_nm"), fit.plain(0, self.parameters()[0].name)]
    }

    /// Of one of several things, by its shape.
    pub(super) fn one_of(&self, fit: &Fit<'_>) -> Vec<Reported> {
        let Shape::OneOf(choices) = self.kind.entry().shape else { return self.plain(fit) };
        let text = choices.get(self.choice()).map(|which| (*which).to_owned());
        let choice = Reported { name: "which".to_owned(), value: 0.0, low: 0.0, high: 0.0, text };
        vec![fit.plain(0, self.parameters()[0].name), choice]
    }

    /// Those of every member, with the name of its site before.
    fn of_members(&self, values: &[f64], covariance: &DMatrix<f64>) -> Vec<Reported> {
        let mut at = 0;
        let mut all = vec![];
        for member in &self.members {
            let count = member.parameters().len();
            let own = covariance.view((at, at), (count, count)).clone_owned();
            all.extend(
                member
                    .report(&values[at..at + count], &own)
                    .into_iter()
                    .map(|one| Reported { name: format!("{}_{}", member.site, one.name), ..one }),
            );
            at += count;
        }
        all
    }

    /// What its shape says about times.
    fn times(&self) -> Vec<Reported> {
        match self.kind.entry().shape {
            Shape::Moment => vec![self.shape("t_secs")],
            Shape::TimeConstant(_) => vec![self.shape("time_constant_s")],
            Shape::Growth(_) => self.growth().map_or(vec![], |growth| {
                let known = |name: &str, value: f64| Reported {
                    name: name.to_owned(),
                    value,
                    low: value / std::f64::consts::SQRT_2,
                    high: value * std::f64::consts::SQRT_2,
                    text: None,
                };
                let second = if self.shape.is_some_and(|shape| shape < 0.0) {
                    known("late_s", growth.late_s)
                } else {
                    known("delay_s", growth.delay_s)
                };
                vec![known("time_constant_s", growth.time_constant_s), second]
            }),
            Shape::None
            | Shape::OnceOrTwice
            | Shape::Teeth
            | Shape::Limit
            | Shape::OneOf(_)
            | Shape::AnotherJoint => vec![],
        }
    }

    fn shape(&self, name: &str) -> Reported {
        let value = self.shape.unwrap_or_default();
        let [low, high] = self.shape_range.unwrap_or([value; 2]);
        Reported { name: name.to_owned(), value, low, high, text: None }
    }

    /// a sin(k q + φ) of a sine and a cosine.
    pub(super) fn wave(&self, fit: &Fit<'_>) -> Vec<Reported> {
        let (sine, cosine) = (fit.values[0], fit.values[1]);
        let amplitude = sine.hypot(cosine);
        let scale = if amplitude > 0.0 { 1.0 / amplitude } else { 0.0 };
        let sd = fit.sd_along(&DVector::from_vec(vec![sine * scale, cosine * scale]));
        let across = DVector::from_vec(vec![-cosine * scale * scale, sine * scale * scale]);
        let phase_sd = if amplitude > 0.0 { fit.sd_along(&across) } else { f64::MAX };
        let half_turn = std::f64::consts::PI;
        let phase = cosine.atan2(sine);
        let phase_width = (NINETY_FIVE * phase_sd).min(half_turn);
        let order = self.shape.unwrap_or(1.0);
        let plain = |name: &str, value: f64, width: f64| Reported {
            name: name.to_owned(),
            value,
            low: value - width,
            high: value + width,
            text: None,
        };
        let mut size = plain("amplitude_rad", amplitude, NINETY_FIVE * sd);
        size.low = size.low.max(0.0);
        vec![size, plain("phase_rad", phase, phase_width), plain("order", order, 0.0)]
    }

    /// Turns about x, y, z of the joint of two turns across its axis; what lies along the axis
    /// cannot be seen.
    pub(super) fn skew(&self, fit: &Fit<'_>) -> Vec<Reported> {
        let [a, b] = self.across.unwrap_or_default();
        let names = ["rot_x_rad", "rot_y_rad", "rot_z_rad"];
        (0..3)
            .filter(|&k| a[k].hypot(b[k]) > 1e-9)
            .map(|k| {
                let weights = DVector::from_vec(vec![a[k], b[k]]);
                let value = a[k] * fit.values[0] + b[k] * fit.values[1];
                let width = NINETY_FIVE * fit.sd_along(&weights);
                let name = names[k].to_owned();
                Reported { name, value, low: value - width, high: value + width, text: None }
            })
            .collect()
    }
}

/// Values with their covariance.
pub(crate) struct Fit<'a> {
    values: &'a [f64],
    covariance: &'a DMatrix<f64>,
}

impl Fit<'_> {
    fn sd_along(&self, weights: &DVector<f64>) -> f64 {
        if self.covariance.nrows() != weights.len() {
            return 0.0;
        }
        weights.dot(&(self.covariance * weights)).max(0.0).sqrt()
    }

    fn plain(&self, k: usize, name: &str) -> Reported {
        let value = self.values[k];
        let width = NINETY_FIVE * self.covariance.get((k, k)).map_or(0.0, |square| square.max(0.0).sqrt());
        Reported { name: name.to_owned(), value, low: value - width, high: value + width, text: None }
    }

    /// Of something whose sign says only to which side it counts.
    fn size(&self, k: usize, name: &str) -> Reported {
        let signed = self.plain(k, name);
        let (low, high) =
            if signed.value < 0.0 { (-signed.high, -signed.low) } else { (signed.low, signed.high) };
        Reported { value: signed.value.abs(), low: low.max(0.0), high, ..signed }
    }

    /// Of a compliance.
    fn stiffness(&self) -> Reported {
        let give = self.plain(0, "stiffness_nm_per_rad");
        let stiff = |compliance: f64| {
            if compliance.abs() > 1.0 / RIGID_NM_PER_RAD {
                1.0 / compliance
            } else {
                RIGID_NM_PER_RAD.copysign(give.value)
            }
        };
        let (a, b) = if give.low * give.high > 0.0 {
            (stiff(give.low), stiff(give.high))
        } else if give.value < 0.0 {
            (stiff(give.low), -RIGID_NM_PER_RAD)
        } else {
            (stiff(give.high), RIGID_NM_PER_RAD)
        };
        Reported { value: stiff(give.value), low: a.min(b), high: a.max(b), ..give }
    }
}
