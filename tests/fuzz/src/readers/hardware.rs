//! Images, folders of pairs, videos, bytes on the wire.

use std::path::Path;

use plumbline_hardware::dynamixel::{Deframer, Found, decode_instruction, decode_status};
use plumbline_hardware::{Next, Replay, SourceOptions, SourceSpec, load_image, open};

use plumbline_recording::{Recording, Topic};

use super::{Reader, one};
use crate::check::Heard;

pub fn readers() -> Vec<Reader> {
    vec![
        one("image-png", &["images/color.png"], 30, |folder| picture(&folder.join("images/color.png"))),
        one("image-png-16-bit", &["images/gray16.png"], 15, |folder| {
            picture(&folder.join("images/gray16.png"))
        }),
        one("image-png-clear", &["images/clear.png"], 15, |folder| picture(&folder.join("images/clear.png"))),
        one("image-jpeg", &["images/color.jpg"], 30, |folder| picture(&folder.join("images/color.jpg"))),
        one("image-folder", &["pairs/"], 20, |folder| source(&SourceSpec::Folder(folder.join("pairs")))),
        one("videos", &["videos/"], 12, |folder| {
            source(&SourceSpec::Videos {
                left: folder.join("videos/left.avi"),
                right: folder.join("videos/right.avi"),
            })
        }),
        one("recording", &["recordings/"], 25, |folder| {
            let file = folder.join("recordings/log.mcap");
            match SourceSpec::from_paths(std::slice::from_ref(&file)) {
                Ok(spec) => source(&spec).and(rest_of_a_recording(&file)),
                Err(error) => Heard::refused(error),
            }
        }),
        one("wire-protocol-1", &["wire/v1.bin"], 30, |folder| wire(&folder.join("wire/v1.bin"))),
    ]
}

fn picture(file: &Path) -> Heard {
    match load_image(file) {
        Ok(loaded) => Heard::accepted((loaded.image.dimensions(), &loaded.notes)),
        Err(problem) => Heard::refused(problem),
    }
}

/// What is in it beside images; nothing where it cannot be opened.
fn rest_of_a_recording(file: &Path) -> Vec<String> {
    let Ok(mut recording) = Recording::open(file) else { return vec![] };
    let told = Topic::ALL.map(|topic| match topic {
        Topic::Joints => recording.joints().map(|told| format!("{told:?}")),
        Topic::Goals => recording.goals().map(|told| format!("{told:?}")),
        Topic::Notes => recording.notes().map(|told| format!("{told:?}")),
        Topic::Transforms => recording.robot_from_left().map(|told| format!("{told:?}")),
        Topic::Eyes => {
            let pairs: Result<Vec<_>, _> = (0..recording.pair_count())
                .map(|index| recording.pair(index).map(|pair| pair.eyes))
                .collect();
            pairs.map(|eyes| format!("{eyes:?}"))
        }
        topic => recording.told(topic).map(|told| format!("{told:?}")),
    });
    told.into_iter().map(|told| told.unwrap_or_else(|error| error.to_string())).collect()
}

/// Opens a source and plays it.
fn source(spec: &SourceSpec) -> Heard {
    let options = SourceOptions { replay: Replay::ONCE, ..SourceOptions::default() };
    let mut source = match open(spec, &options) {
        Ok(source) => source,
        Err(error) => return Heard::refused(error),
    };
    let mut sizes = vec![];
    let mut lost = None;
    for _ in 0..40 {
        match source.next_pair() {
            Ok(Next::Pair(frame)) => sizes.push(frame.left.dimensions()),
            Ok(Next::NotYet) => std::thread::sleep(source.wait_hint()),
            Ok(Next::End) => break,
            Err(error) => {
                lost = Some(error.to_string());
                break;
            }
        }
    }
    let reports: Vec<String> = source.take_reports().iter().map(ToString::to_string).collect();
    Heard::accepted((source.describe(), source.counters(), sizes)).and(reports).and(lost)
}

/// Reads the stream in pieces of changing length, as they come from a port. The content of files is
/// taken up to the largest that a line of a megabit carries in some seconds.
fn wire(file: &Path) -> Heard {
    let bytes = match std::fs::metadata(file).map(|data| data.is_file()) {
        Ok(true) => std::fs::read(file).unwrap_or_default(),
        _ => return Heard::refused("no bytes on the line"),
    };
    let bytes = &bytes[..bytes.len().min(400_000)];
    let (mut frames, mut garbage, mut wrong, mut messages) = (0, 0, 0, vec![]);
    let mut deframer = Deframer::default();
    for (k, piece) in bytes.chunks(1 + bytes.len() % 13).enumerate() {
        deframer.push(piece);
        if k % 97 == 96 {
            deframer.clear();
        }
        while let Some(found) = deframer.pop() {
            match found {
                Found::Frame(frame) => {
                    frames += 1;
                    std::hint::black_box(decode_status(&frame));
                    messages.extend(decode_instruction(&frame).err().map(|error| error.to_string()));
                }
                Found::Garbage(count) => garbage += count,
                Found::WrongCheck { .. } => wrong += 1,
            }
        }
    }
    messages.sort();
    messages.dedup();
    Heard::accepted((frames, garbage, wrong, deframer.pending())).and(messages)
}
