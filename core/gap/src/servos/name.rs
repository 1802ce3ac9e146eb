//! What servos show, as named effects.

use nalgebra::DMatrix;
use plumbline_effects::arm::Arm;
use plumbline_effects::{Effect, Kind};

use super::lag::Slope;
use crate::finding::{ClassMember, FoundParameter, NamedEffect};

/// How sure a name is that all of this speaks for.
const PROBABILITY: f64 = 0.97;
/// What other servos of a robot may do as well is less sure.
const PROBABILITY_OF_MORE: f64 = 0.8;
/// A mass is told from those of other links less surely.
const PROBABILITY_OF_MASS: f64 = 0.9;

/// What an effect does to the rows, frames placed.
pub(super) struct Size {
    /// In units of the noise.
    pub sigmas: f64,
    /// On the table, m.
    pub m: f64,
}

/// An effect of one value at a joint.
pub(super) fn named(arm: &Arm, kind: Kind, joint: usize, slope: Slope, size: &Size) -> Option<NamedEffect> {
    let effect = Effect::find(kind.id(), &arm.parts[joint].joint, None, Some(arm), None)?;
    Some(of_effect(&effect, slope, size, PROBABILITY))
}

/// The same where it stands out by no more than servos of a robot may differ.
pub(super) fn hardly(found: NamedEffect) -> NamedEffect {
    NamedEffect { probability: PROBABILITY_OF_MORE, class_probability: PROBABILITY_OF_MORE, ..found }
}

/// The same where friction could do as much.
pub(super) fn or_friction(arm: &Arm, joint: usize, found: NamedEffect) -> Option<NamedEffect> {
    or_other(arm, joint, found, Kind::Stiction, "approach from the other side, or repeat with a known weight")
}

/// The same where play could do as much: an encoder behind the gear stays behind by both.
pub(super) fn or_play(arm: &Arm, joint: usize, found: NamedEffect) -> Option<NamedEffect> {
    or_other(
        arm,
        joint,
        found,
        Kind::Backlash,
        "log the encoder of the motor too, or feel the joint's play by hand",
    )
}

/// The same where an effect of another kind could do as much: both are in its class, with equal shares.
fn or_other(
    arm: &Arm,
    joint: usize,
    mut found: NamedEffect,
    kind: Kind,
    split_by: &str,
) -> Option<NamedEffect> {
    let other = Effect::find(kind.id(), &arm.parts[joint].joint, None, Some(arm), None)?;
    found.probability *= 0.5;
    found.class.iter_mut().for_each(|member| member.probability = 0.5);
    found.class.push(ClassMember {
        id: other.id().to_owned(),
        site: other.site.clone(),
        title: other.title.clone(),
        probability: 0.5,
    });
    found.split_by = Some(split_by.to_owned());
    Some(found)
}

/// A mass that is off by a share of the description's.
pub(super) fn named_mass(arm: &Arm, link: usize, share: Slope, size: &Size) -> Option<NamedEffect> {
    let part = &arm.parts[link];
    let is_last = link + 1 == arm.len();
    let kind = if is_last { Kind::PayloadMass } else { Kind::LinkMass };
    let effect = Effect::find(kind.id(), &part.link, None, Some(arm), None)?;
    let mass = Slope { value: share.value * part.mass_kg, sd: share.sd * part.mass_kg };
    let mut named = of_effect(&effect, mass, size, PROBABILITY_OF_MASS);
    named.not_addable = Some(format!(
        "a mass belongs into the robot's description, where {} has {:.0} g: weigh it and write it there",
        part.link.replace('_', " "),
        1e3 * part.mass_kg
    ));
    Some(named)
}

fn of_effect(effect: &Effect, slope: Slope, size: &Size, probability: f64) -> NamedEffect {
    let covariance = DMatrix::from_element(1, 1, slope.sd * slope.sd);
    let reported = effect.report(&[slope.value], &covariance).into_iter();
    let parameters = reported.map(|one| FoundParameter {
        name: one.name,
        value: one.value,
        low: one.low,
        high: one.high,
        text: one.text,
    });
    let class = ClassMember {
        id: effect.id().to_owned(),
        site: effect.site.clone(),
        title: effect.title.clone(),
        probability: 1.0,
    };
    NamedEffect {
        id: effect.id().to_owned(),
        site: effect.site.clone(),
        title: effect.title.clone(),
        probability,
        class_probability: probability,
        parameters: parameters.collect(),
        shape: None,
        reference_s: 0.0,
        values: vec![slope.value],
        covariance: vec![slope.sd * slope.sd],
        size_sigmas: size.sigmas,
        size_m: size.m,
        class: vec![class],
        beside: vec![],
        split_by: None,
        runner_up: None,
        not_addable: None,
    }
}
