//! What was seen in an image, to be drawn over it: Foxglove's `ImageAnnotations`.

use foxglove::messages::{
    Color, ImageAnnotations, Point2, PointsAnnotation, TextAnnotation, points_annotation,
};
use jiff::Timestamp;

use crate::messages::time;

const LINE_PX: f64 = 2.0;
const TEXT_PX: f64 = 14.0;
const LINE: Color = Color { r: 1.0, g: 0.75, b: 0.1, a: 1.0 };
const PAPER: Color = Color { r: 0.0, g: 0.0, b: 0.0, a: 0.6 };

/// Foxglove counts from the corner of the first pixel, and this program from its middle.
const FROM_CORNER_PX: f64 = 0.5;

/// A thing in an image.
#[derive(Clone, Debug, PartialEq)]
pub struct Outline {
    /// Its box on the raw image: left, top, right, bottom, px.
    pub box_px: [f64; 4],
    /// What is written beside it: "tomato 0.94".
    pub text: String,
}

pub(crate) fn annotations(at: Timestamp, outlines: &[Outline]) -> ImageAnnotations {
    let boxed = |outline: &Outline| {
        let [left, top, right, bottom] = outline.box_px.map(|px| px + FROM_CORNER_PX);
        let corners = [[left, top], [right, top], [right, bottom], [left, bottom]];
        PointsAnnotation {
            timestamp: time(at),
            r#type: points_annotation::Type::LineLoop as i32,
            points: corners.map(|[x, y]| Point2 { x, y }).to_vec(),
            outline_color: Some(LINE),
            outline_colors: vec![],
            fill_color: None,
            thickness: LINE_PX,
            metadata: vec![],
        }
    };
    let named = |outline: &Outline| TextAnnotation {
        timestamp: time(at),
        position: Some(Point2 {
            x: outline.box_px[0] + FROM_CORNER_PX,
            y: outline.box_px[1] + FROM_CORNER_PX,
        }),
        text: outline.text.clone(),
        font_size: TEXT_PX,
        text_color: Some(LINE),
        background_color: Some(PAPER),
        metadata: vec![],
    };
    ImageAnnotations {
        timestamp: time(at),
        circles: vec![],
        points: outlines.iter().map(boxed).collect(),
        texts: outlines.iter().map(named).collect(),
        metadata: vec![],
    }
}
