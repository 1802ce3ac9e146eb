//! What input and output of a network must look like to be a detector's.

use ort::session::Session;
use ort::value::{Outlet, ValueType};
use plumbline_model::detection::ClassNames;

use super::network::precision;
use super::{DetectError, Head, InputSize, Precision, Task};

/// Metadata of an export of ultralytics, as far as it is there.
#[derive(Debug, Default)]
pub(super) struct Metadata {
    pub names: Option<String>,
    pub task: Option<String>,
    pub image_size: Option<(u32, u32)>,
    pub stride: Option<u32>,
    pub end_to_end: bool,
    pub made_by: Option<String>,
}

impl Metadata {
    /// Of an opened network; what is not there or not readable is left out.
    pub fn of(session: &Session) -> Self {
        let Ok(metadata) = session.metadata() else { return Self::default() };
        let custom = |key: &str| metadata.custom(key).filter(|text| !text.trim().is_empty());
        let producer = metadata.producer().filter(|text| !text.is_empty());
        let author = custom("author").or(producer);
        let version = custom("version").map(|version| format!(" {version}")).unwrap_or_default();
        Self {
            names: custom("names"),
            task: custom("task"),
            image_size: custom("imgsz").as_deref().and_then(height_width),
            stride: custom("stride").and_then(|text| text.trim().parse().ok()),
            end_to_end: custom("end2end").is_some_and(|text| text.trim().eq_ignore_ascii_case("true")),
            made_by: author.map(|author| format!("{author}{version}")),
        }
    }
}

/// `[480, 640]` or `640` as (width, height).
fn height_width(text: &str) -> Option<(u32, u32)> {
    let text = text.trim().trim_matches(['[', ']', '(', ')']);
    let numbers: Option<Vec<u32>> = text
        .split(',')
        .map(str::trim)
        .filter(|part| !part.is_empty())
        .map(|part| part.parse().ok())
        .collect();
    match numbers?.as_slice() {
        [side] if *side > 0 => Some((*side, *side)),
        [height, width] if *height > 0 && *width > 0 => Some((*width, *height)),
        _ => None,
    }
}

/// The size that a network takes.
pub(super) fn input(
    model: &str,
    session: &Session,
    metadata: &Metadata,
) -> Result<(InputSize, Precision), DetectError> {
    let wrong = |reason: String| DetectError::Input { model: model.to_owned(), reason };
    let [input] = session.inputs() else {
        return Err(wrong(format!("it has {} inputs", session.inputs().len())));
    };
    let (shape, precision) = tensor(input).map_err(wrong)?;
    let &[batch, channels, height, width] = shape.as_slice() else {
        return Err(wrong(format!("its input has {} dimensions", shape.len())));
    };
    if batch > 1 {
        return Err(wrong(format!("it takes {batch} images at once")));
    }
    match channels {
        3 | -1 => {}
        1 => return Err(wrong("it takes gray images, one channel".to_owned())),
        _ if width == 3 => return Err(wrong("its channels come last, as in TensorFlow".to_owned())),
        _ => return Err(wrong(format!("it takes {channels} channels"))),
    }
    let stride_px = metadata.stride.unwrap_or(32).max(1);
    let (usual_width, usual_height) = metadata.image_size.unwrap_or((640, 640));
    let size = match (u32::try_from(width), u32::try_from(height)) {
        (Ok(width_px @ 1..), Ok(height_px @ 1..)) => InputSize::Fixed { width_px, height_px },
        (width, height) => {
            let whole = |side: u32| side.div_ceil(stride_px) * stride_px;
            InputSize::Dynamic {
                width_px: width.unwrap_or_else(|_| whole(usual_width)),
                height_px: height.unwrap_or_else(|_| whole(usual_height)),
                stride_px,
            }
        }
    };
    Ok((size, precision))
}

/// Shape (−1 where it may vary) and number type of a tensor; else what it is.
fn tensor(outlet: &Outlet) -> Result<(Vec<i64>, Precision), String> {
    match outlet.dtype() {
        ValueType::Tensor { ty, shape, .. } => {
            let precision = precision(*ty).ok_or_else(|| format!("{} is of {ty} numbers", outlet.name()))?;
            Ok((shape.to_vec(), precision))
        }
        _ => Err(format!("{} is no tensor", outlet.name())),
    }
}

/// The form of a network's output.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Output {
    pub head: Head,
    /// Classes in the head; an end-to-end head does not tell.
    pub classes: Option<usize>,
    pub precision: Precision,
    /// Whether inputs of one shape have outputs of one shape.
    pub steady: bool,
}

/// Whether only a run tells the form of the output, because it leaves both of its sides open;
/// then the type of its numbers.
pub(super) fn must_be_run(session: &Session) -> Option<Precision> {
    let (shape, precision) = tensor(session.outputs().first()?).ok()?;
    matches!(shape.as_slice(), [_, ..=0, ..=0]).then_some(precision)
}

/// What the output declares of itself, or what shape it had in a first run.
pub(super) fn output(
    model: &str,
    session: &Session,
    metadata: &Metadata,
    input: InputSize,
    names: Option<&ClassNames>,
    shape_of_run: Option<&[i64]>,
) -> Result<Output, DetectError> {
    let wrong = |reason: String| DetectError::Output { model: model.to_owned(), reason };
    let other = |task| DetectError::OtherTask { model: model.to_owned(), task };
    if let Some(task) = metadata.task.as_deref().and_then(Task::from_metadata) {
        return Err(other(task));
    }
    let Some(first) = session.outputs().first() else { return Err(wrong("it has none".to_owned())) };
    let (declared, precision) = tensor(first).map_err(wrong)?;
    let &[_, rows, columns] = shape_of_run.unwrap_or(&declared) else {
        return Err(match declared.len() {
            2 => other(Task::Classify),
            4 => other(Task::Depth),
            count => wrong(format!("it has {count} dimensions")),
        });
    };
    // Masks come as a second output of four dimensions.
    if let Some(second) = session.outputs().get(1)
        && tensor(second).is_ok_and(|(shape, _)| shape.len() == 4)
    {
        return Err(other(Task::Segment));
    }
    let form = form(rows, columns, metadata, input, names).map_err(wrong)?;
    let steady = match form.0 {
        Head::EndToEnd => declared.get(1).is_some_and(|rows| *rows > 0),
        Head::Raw | Head::RawTransposed => true,
    };
    Ok(Output { head: form.0, classes: form.1, precision, steady })
}

/// Which of the forms 1×rows×columns is, and its classes.
fn form(
    rows: i64,
    columns: i64,
    metadata: &Metadata,
    input: InputSize,
    names: Option<&ClassNames>,
) -> Result<(Head, Option<usize>), String> {
    let classes = |side: i64| usize::try_from(side - 4).ok().filter(|classes| *classes > 0);
    let named = names.map(|names| names.len() as i64 + 4);
    let boxes = boxes(input);
    let transposed_of_two = named == Some(6) && !metadata.end_to_end && boxes == Some(rows);
    if metadata.end_to_end || (columns == 6 && !transposed_of_two) {
        if columns == 6 {
            return Ok((Head::EndToEnd, None));
        }
        return Err(format!("1x{rows}x{columns} is not end-to-end, which the file says it is"));
    }
    // Many more boxes than classes; names decide where that is not so.
    let is_transposed = match named {
        Some(side) if rows == side && columns != side => false,
        Some(side) if columns == side && rows != side => true,
        _ => columns > 0 && (rows < 0 || rows > columns),
    };
    let (head, side) = if is_transposed { (Head::RawTransposed, columns) } else { (Head::Raw, rows) };
    let count = if is_transposed { rows } else { columns };
    if named == Some(side - 1) && boxes.is_some_and(|boxes| boxes != count) {
        return Err(format!(
            "1x{rows}x{columns} has a confidence of its own for every box, as the first YOLOv3 and YOLOv5 had"
        ));
    }
    match classes(side) {
        Some(classes) => Ok((head, Some(classes))),
        None => Err(format!("1x{rows}x{columns} leaves no room for classes")),
    }
}

/// Boxes of a raw head with strides 8, 16 and 32, if the input is fixed.
fn boxes(input: InputSize) -> Option<i64> {
    match input {
        InputSize::Fixed { width_px, height_px } => {
            let cells =
                |stride: u32| i64::from(width_px.div_ceil(stride)) * i64::from(height_px.div_ceil(stride));
            Some(cells(8) + cells(16) + cells(32))
        }
        InputSize::Dynamic { .. } => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const INPUT: InputSize = InputSize::Fixed { width_px: 640, height_px: 640 };

    fn names(count: usize) -> ClassNames {
        ClassNames::new((0..count).map(|i| i.to_string()))
    }

    fn form_of(rows: i64, columns: i64, named: Option<usize>) -> Result<(Head, Option<usize>), String> {
        let names = named.map(names);
        form(rows, columns, &Metadata::default(), INPUT, names.as_ref())
    }

    #[test]
    fn the_forms_of_output_are_told_apart() {
        assert_eq!(form_of(84, 8400, Some(80)), Ok((Head::Raw, Some(80))));
        assert_eq!(form_of(84, 8400, None), Ok((Head::Raw, Some(80))));
        assert_eq!(form_of(8400, 84, Some(80)), Ok((Head::RawTransposed, Some(80))));
        assert_eq!(form_of(8400, 84, None), Ok((Head::RawTransposed, Some(80))));
        assert_eq!(form_of(300, 6, Some(8)), Ok((Head::EndToEnd, None)));
        assert_eq!(form_of(300, 6, Some(2)), Ok((Head::EndToEnd, None)));
        assert_eq!(form_of(8400, 6, Some(2)), Ok((Head::RawTransposed, Some(2))));
        assert_eq!(form_of(6, 8400, Some(2)), Ok((Head::Raw, Some(2))));
        assert_eq!(form_of(12, 21, Some(8)), Ok((Head::Raw, Some(8))));
        assert_eq!(form_of(5, 2, Some(1)), Ok((Head::Raw, Some(1))), "fewer boxes than rows");
    }

    #[test]
    fn what_is_no_head_is_refused() {
        assert!(form_of(4, 8400, None).is_err());
        assert!(form_of(25200, 85, Some(80)).expect_err("objectness").contains("of its own"));
        let claims = Metadata { end_to_end: true, ..Metadata::default() };
        assert!(form(84, 8400, &claims, INPUT, None).is_err());
    }

    #[test]
    fn sizes_are_read_height_first() {
        assert_eq!(height_width("[480, 640]"), Some((640, 480)));
        assert_eq!(height_width("416"), Some((416, 416)));
        assert_eq!(height_width("[416]"), Some((416, 416)));
        for text in ["", "[]", "[0, 5]", "wide", "[1, 2, 3]"] {
            assert_eq!(height_width(text), None, "{text}");
        }
    }
}
