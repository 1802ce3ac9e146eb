use std::sync::Arc;

use plumbline_engine::view::{TouchOutcome, TouchState, TouchView};

use super::moved::TOUCHES;
use super::*;

#[test]
fn every_row_has_a_field_per_heading_and_what_is_not_known_is_empty() {
    let (mut view, state) = (View::default(), PanelState::default());
    assert_eq!(table_of(Pane::Joints, &view, &state), None);
    let touch = TouchState {
        number: 7,
        target: plumbline_model::Pixel::new(960.0, 700.0),
        target_place: plumbline_model::Point::new(0.4, 0.0, 0.05),
        sent: plumbline_model::Point::new(0.4, 0.0, 0.05),
        inside: true,
        set: "a, \"b\"".to_owned(),
        group: "g".to_owned(),
        side: plumbline_model::touch_plan::Side::Above,
        outcome: TouchOutcome::Missed("nothing, felt".to_owned()),
        error_m: None,
        touched: None,
    };
    let touched = TouchState {
        outcome: TouchOutcome::Touched,
        error_m: Some([0.00123, -0.004]),
        touched: Some(plumbline_model::Pixel::new(963.0, 690.25)),
        ..touch.clone()
    };
    view.touch = Arc::new(TouchView { touches: [touch, touched].into(), ..Default::default() });
    let text = table_of(Pane::TouchRun, &view, &state).and_then(|table| table.csv()).expect("two rows");
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines[0], TOUCHES.join(","));
    assert_eq!(lines[1], "7,960.00,700.00,,,,,g,\"a, \"\"b\"\"\",missed,\"nothing, felt\"");
    assert_eq!(lines[2], "7,960.00,700.00,963.00,690.25,1.230,-4.000,g,\"a, \"\"b\"\"\",touched,");
    assert_eq!(lines.len(), 3);
}
