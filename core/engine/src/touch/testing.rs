//! What tests of this workflow share.
use std::sync::{Arc, OnceLock};

use plumbline_model::Pixel;
use plumbline_model::robot::Rig;
use plumbline_model::session::Screen;
use plumbline_model::touch_plan::Side;

use super::record::{Standing, TouchRecord};

/// The rig that comes with the program.
pub fn rig() -> Arc<Rig> {
    static RIG: OnceLock<Arc<Rig>> = OnceLock::new();
    RIG.get_or_init(|| Arc::new(Rig::built_in("nico").expect("the rig that comes with the program"))).clone()
}

/// A touch of which only the place matters.
pub fn record(number: usize, group: &str, target: Pixel<Screen>, touched: Pixel<Screen>) -> TouchRecord {
    TouchRecord {
        number,
        standing: Standing::Counts,
        touched,
        target,
        sent_m: [0.4, 0.0, 0.056],
        group: group.to_owned(),
        set: "set".to_owned(),
        side: Side::Above,
        screen_height_m: 0.0,
        payload_kg: 0.0,
        commanded_rad: vec![],
        encoder_rad: vec![],
        later_encoder_rad: vec![],
        direction: vec![],
        temperature_c: vec![],
        load: vec![],
        move_secs: None,
        connected_secs: None,
    }
}
