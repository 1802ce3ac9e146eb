//! A detector: a network, opened and checked, with the memory that it works in.

use std::path::Path;
use std::time::Instant;

use image::RgbImage;
use ort::session::Session;
use plumbline_model::detection::Detection;
use plumbline_model::files::{self, FileError, Size};

use super::heads::{Reader, Unusable};
use super::letterbox::Letterbox;
use super::library::Library;
use super::names::{self, Found};
use super::network::{self, Network, NotFilled, Source, words};
use super::shape::{self, Metadata, Output};
use super::suppress::{Candidate, suppress, surest_first};
use super::{
    DetectError, DetectSettings, DetectTiming, DetectorInfo, DetectorOptions, Head, InputSize, NamesFrom,
    Part, Precision, Provider, Region, Task,
};

/// Finds things on one image at a time. Belongs to one thread; it can be sent to another.
pub struct Detector {
    info: DetectorInfo,
    network: Network,
    reader: Reader,
    candidates: Vec<Candidate>,
    columns: Vec<u8>,
}

impl std::fmt::Debug for Detector {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Detector").field("info", &self.info).finish_non_exhaustive()
    }
}

impl Detector {
    /// Opens an ONNX file and looks whether it is a detector. Takes a fraction of a second.
    ///
    /// # Errors
    /// ONNX Runtime is missing, the file is no detector, or its names do not fit; see
    /// [`DetectError`].
    pub fn open(path: &Path, options: &DetectorOptions) -> Result<Self, DetectError> {
        let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
        let not_read = |reason: String| DetectError::NotRead { model: path.display().to_string(), reason };
        // The library opens it by its name, whatever it is.
        let opened = files::open(path, Size::NETWORK).map_err(|error| match error {
            FileError::Unreadable { source, .. } => not_read(source.to_string()),
            FileError::NotAFile { kind, .. } => not_read(format!("it is {kind}")),
            other => not_read(other.to_string()),
        })?;
        if opened.metadata().is_ok_and(|about| about.len() == 0) {
            return Err(DetectError::NotOnnx { model: name, reason: "the file is empty".to_owned() });
        }
        Self::new(name, &Source::File(path), Some(path), options)
    }

    /// The same with the content of a file; `name` is for messages.
    ///
    /// # Errors
    /// As [`Detector::open`].
    pub fn from_bytes(name: &str, onnx: &[u8], options: &DetectorOptions) -> Result<Self, DetectError> {
        if onnx.is_empty() {
            return Err(DetectError::NotOnnx { model: name.to_owned(), reason: "it is empty".to_owned() });
        }
        Self::new(name.to_owned(), &Source::Memory(onnx), None, options)
    }

    fn new(
        name: String,
        source: &Source<'_>,
        file: Option<&Path>,
        options: &DetectorOptions,
    ) -> Result<Self, DetectError> {
        let library = Library::load()?;
        let (session, provider_used, provider_note) = network::open(&library, &name, source, options)?;
        let metadata = Metadata::of(&session);
        let found = Found::new(metadata.names.as_deref(), file);
        let (input, input_precision) = shape::input(&name, &session, &metadata)?;
        let names = found.in_file.as_ref().or(found.beside.as_ref());
        let output = |session: &Session, shape: Option<&[i64]>| {
            shape::output(&name, session, &metadata, input, names, shape)
        };
        let (session, output) = match shape::must_be_run(&session) {
            None => {
                let output = output(&session, None)?;
                (session, output)
            }
            Some(precision) => {
                // Wrong tasks are told before anything is run.
                if let Some(task) = metadata.task.as_deref().and_then(Task::from_metadata) {
                    return Err(DetectError::OtherTask { model: name, task });
                }
                let (session, shape) = first_run(&name, session, input, [input_precision, precision])?;
                let output = output(&session, Some(&shape))?;
                (session, output)
            }
        };
        let info = DetectorInfo {
            file: file.map(Path::to_owned),
            input,
            precision: output.precision,
            head: output.head,
            provider_used,
            provider_note,
            made_by: metadata.made_by.clone(),
            runtime: library.version(),
            ..named(name.clone(), found.clone(), output)?
        };
        let network = Network::new(session, [input_precision, output.precision], output.steady);
        let (candidates, columns) = (Vec::new(), Vec::new());
        Ok(Self { info, network, reader: Reader::default(), candidates, columns })
    }

    /// What is known of it.
    pub fn info(&self) -> &DetectorInfo {
        &self.info
    }

    /// Finds things on what is lit of an image; see [`Self::detect_in`].
    ///
    /// # Errors
    /// As [`Self::detect_in`].
    pub fn detect(
        &mut self,
        image: &RgbImage,
        settings: &DetectSettings,
        found: &mut Vec<Detection>,
    ) -> Result<DetectTiming, DetectError> {
        self.detect_in(image, Part::Lit, settings, found)
    }

    /// Finds things on a part of an image; `found` is cleared first and holds them by falling
    /// confidence, with their boxes on the image and clipped to it. A box that has no part on the
    /// image is left out. A network of fixed size always sees all of the image.
    ///
    /// # Errors
    /// An empty image, thresholds out of range, or a network that fails or answers nonsense.
    /// `found` is empty then, and the next image can be tried.
    pub fn detect_in(
        &mut self,
        image: &RgbImage,
        part: Part,
        settings: &DetectSettings,
        found: &mut Vec<Detection>,
    ) -> Result<DetectTiming, DetectError> {
        found.clear();
        settings.check()?;
        let begun = Instant::now();
        let (width_px, height_px) = image.dimensions();
        let lit = || Region::lit(image, &mut self.columns);
        let letterbox = Letterbox::of_part((width_px, height_px), part, lit, self.info.input)
            .ok_or(DetectError::EmptyImage { width_px, height_px })?;
        self.fill(image, &letterbox)?;
        let filled = Instant::now();
        let mut ran = filled;
        self.run(settings, &mut ran)?;
        self.finish(&letterbox, settings, found);
        Ok(DetectTiming { before: filled - begun, network: ran - filled, after: ran.elapsed() })
    }

    /// Only the network, on an image that was given to [`Self::detect`] before: what the rest is
    /// measured against.
    ///
    /// # Errors
    /// The network fails, or no image was given yet.
    pub fn run_again(&mut self) -> Result<std::time::Duration, DetectError> {
        let begun = Instant::now();
        self.network.run(|_, _| ()).map_err(|error| failed(&self.info.name, &error))?;
        Ok(begun.elapsed())
    }

    fn fill(&mut self, image: &RgbImage, letterbox: &Letterbox) -> Result<(), DetectError> {
        self.network.fill(image, letterbox).map_err(|problem| not_filled(&self.info.name, problem))
    }

    /// Runs the network and reads its head; `ran` is set between the two.
    fn run(&mut self, settings: &DetectSettings, ran: &mut Instant) -> Result<(), DetectError> {
        let Self { info, network, reader, candidates, .. } = self;
        let classes = info.names.len();
        let read = network.run(|shape, values| {
            *ran = Instant::now();
            let columns = match info.head {
                Head::Raw => shape.get(1).copied(),
                Head::RawTransposed => shape.get(2).copied(),
                Head::EndToEnd => shape.get(2).map(|columns| columns - 6 + 4 + classes as i64),
            };
            if columns != Some(4 + classes as i64) {
                return Err(DetectError::Output {
                    model: info.name.clone(),
                    reason: format!("it is of shape {shape:?} for this image"),
                });
            }
            reader.read(info.head, classes, values, settings, candidates).map_err(|problem| {
                let model = info.name.clone();
                match problem {
                    Unusable::NotFinite(count) => DetectError::NotFinite { model, count },
                    Unusable::UnknownClass(class) => {
                        DetectError::UnknownClass { model, class: class.to_string(), known: classes }
                    }
                }
            })
        });
        read.map_err(|error| failed(&self.info.name, &error))?
    }

    fn finish(&mut self, letterbox: &Letterbox, settings: &DetectSettings, found: &mut Vec<Detection>) {
        match self.info.head {
            Head::Raw | Head::RawTransposed => suppress(&mut self.candidates, settings.iou, settings.most),
            Head::EndToEnd => {
                surest_first(&mut self.candidates);
                self.candidates.truncate(settings.most);
            }
        }
        let on_image = self.candidates.iter().map(|candidate| Detection {
            class: candidate.class,
            confidence: candidate.confidence,
            area: letterbox.on_image(candidate.edges),
        });
        found.extend(
            on_image.filter(|Detection { area, .. }| area.x1_px > area.x0_px && area.y1_px > area.y0_px),
        );
    }
}

fn not_filled(model: &str, problem: NotFilled) -> DetectError {
    match problem {
        NotFilled::Image(error) => error,
        NotFilled::Runtime(error) => failed(model, &error),
    }
}

fn failed(model: &str, error: &ort::Error) -> DetectError {
    DetectError::Run { model: model.to_owned(), reason: words(error) }
}

/// Shape of the output for a gray image, where the file leaves it open.
fn first_run(
    name: &str,
    session: Session,
    input: InputSize,
    precisions: [Precision; 2],
) -> Result<(Session, Vec<i64>), DetectError> {
    let (InputSize::Fixed { width_px, height_px } | InputSize::Dynamic { width_px, height_px, .. }) = input;
    let letterbox = Letterbox::new((width_px, height_px), input)
        .ok_or(DetectError::EmptyImage { width_px, height_px })?;
    let mut network = Network::new(session, precisions, false);
    let gray = RgbImage::from_pixel(width_px, height_px, image::Rgb([114; 3]));
    network.fill(&gray, &letterbox).map_err(|problem| not_filled(name, problem))?;
    let shape = network.run(|shape, _| shape.to_vec()).map_err(|error| failed(name, &error))?;
    Ok((network.into_session(), shape))
}

/// What there is to say of the names; the rest is filled in by the caller.
fn named(name: String, found: Found, output: Output) -> Result<DetectorInfo, DetectError> {
    let mut disagreement = found.remark.clone();
    let mut remark = |text: String| match &mut disagreement {
        Some(told) => *told = format!("{told}; {text}"),
        None => disagreement = Some(text),
    };
    let (names, names_from) = match (found.choose(output.classes), output.classes) {
        (Ok(Some(chosen)), _) => chosen,
        (Ok(None), Some(classes)) => {
            remark(
                "neither the file nor a data.yaml beside it names the classes, so they are only numbered"
                    .to_owned(),
            );
            (names::numbered(classes), NamesFrom::Nowhere)
        }
        (Ok(None), None) => {
            let reason = "an end-to-end head without names does not tell how many classes it has: put its data.yaml beside the file";
            return Err(DetectError::Output { model: name, reason: reason.to_owned() });
        }
        (Err(names), classes) => {
            return Err(DetectError::ClassCount {
                model: name,
                in_network: classes.unwrap_or_default(),
                named: names.len(),
                names: names.to_string(),
            });
        }
    };
    Ok(DetectorInfo {
        name,
        file: None,
        names,
        names_from,
        names_in_file: found.in_file,
        names_beside: found.beside,
        disagreement,
        input: InputSize::Fixed { width_px: 0, height_px: 0 },
        precision: Precision::Float32,
        head: Head::Raw,
        provider_used: Provider::Cpu,
        provider_note: None,
        made_by: None,
        runtime: String::new(),
    })
}
