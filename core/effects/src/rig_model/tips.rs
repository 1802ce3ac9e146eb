//! What a model says of tips and markers: where one that was mounted anew sits, and which rows have none.

use std::collections::BTreeMap;

use plumbline_model::predict::{SessionPrediction, TipOutcome, TipPlace, not_predicted};
use plumbline_model::session::Session;

use super::PlacedExternal;
use crate::measurements::{LeftOut, What};

/// Tells what became of the rows of each tip, once they were predicted with a model; a row that was not has no
/// prediction then, since the nominal one stands in another frame.
pub(super) fn tell(
    session: &Session,
    left_out: &[LeftOut],
    external: Option<&PlacedExternal>,
    prediction: &mut SessionPrediction,
) {
    let (Some(table), Some(chain)) = (&session.poses, &session.manifest.chain) else { return };
    let left_out: BTreeMap<usize, &str> = left_out
        .iter()
        .filter(|left| left.table == What::Pose.table())
        .map(|left| (left.row, left.why.as_str()))
        .collect();
    let nominal = std::mem::take(&mut prediction.tips);
    for (i, row) in table.rows().enumerate() {
        let tip = row.tip.as_ref().unwrap_or(&chain.tip);
        let known = nominal.iter().find(|one| one.tip == *tip);
        let Some(outcome) = known.map(|known| TipOutcome { rows: 1, ..known.clone() }) else { continue };
        let outcome = match left_out.get(&i).filter(|_| prediction.poses[i].is_some()) {
            Some(why) => {
                prediction.poses[i] = None;
                TipOutcome { place: TipPlace::Nowhere, words: not_predicted(why), ..outcome }
            }
            None => with_marker(outcome, external, *tip == chain.tip),
        };
        outcome.add_to(&mut prediction.tips);
    }
}

/// With what the model says of the marker at the tip of the chain.
fn with_marker(outcome: TipOutcome, external: Option<&PlacedExternal>, is_of_chain: bool) -> TipOutcome {
    let Some(placed) = external.filter(|placed| is_of_chain && placed.is_mounted_anew()) else {
        return outcome;
    };
    let session = placed.session.clone();
    let off = format!(
        "{:.1} mm and {:.1}° beside the frame {}",
        placed.tip_from_marker.translation.vector.norm() * 1e3,
        placed.tip_from_marker.rotation.angle().to_degrees(),
        outcome.tip
    );
    match outcome.place {
        TipPlace::Frame => TipOutcome {
            words: format!(
                "the marker {off}, where the model found it in {session}: was it mounted anew since, it sits elsewhere"
            ),
            place: TipPlace::Model { session },
            ..outcome
        },
        TipPlace::Description => TipOutcome {
            words: format!(
                "{}. In {session} the model found the marker {off}; that was not used, since this session does not say \
                 that its own was mounted anew (tip_place = \"unknown\" under [chain] in session.toml)",
                outcome.words
            ),
            ..outcome
        },
        TipPlace::Model { .. } | TipPlace::Nowhere => outcome,
    }
}
