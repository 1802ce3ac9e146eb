//! Texts: scripts, commands, journals, a finding, a scenario, bytes on the wire.

use std::path::Path;

use jiff::Timestamp;
use plumbline::WindowSettings;
use plumbline_engine::journal::{Entry, Heading};
use plumbline_engine::{Command, EyesCommand, LiveCommand, ProbePoint, SourceCommand, SourceSpec};
use plumbline_hardware::dynamixel::{Instruction, encode_instruction, encode_status};
use plumbline_model::Eye;

use super::{Problem, put};

pub fn make(folder: &Path) -> Result<(), Problem> {
    put(folder, "twin/lab.toml", include_str!("../../../../core/twin/scenarios/lab.toml"))?;
    for (name, finding) in [
        ("named", plumbline_report::sample::named()),
        ("class", plumbline_report::sample::class()),
        ("none", plumbline_report::sample::no_gap()),
        ("pixels", plumbline_report::sample::pixels()),
    ] {
        let file = folder.join(format!("finding/{name}.json"));
        std::fs::create_dir_all(folder.join("finding"))?;
        finding.write(&file)?;
    }
    put(folder, "words/script.txt", SCRIPT)?;
    put(folder, "words/arguments.txt", ARGUMENTS)?;
    put(folder, "journal/journal.jsonl", journal()?)?;
    let mut settings = WindowSettings::default();
    for screen in [plumbline::Screen::Live, plumbline::Screen::Robot] {
        settings.arrangement(screen);
    }
    std::fs::create_dir_all(folder.join("window"))?;
    settings.save(&folder.join("window/window.json"))?;
    put(folder, "wire/v1.bin", wire()?)?;
    Ok(())
}

/// Questions and answers one after the other, as they lie on the line.
fn wire() -> Result<Vec<u8>, Problem> {
    let mut bytes = vec![];
    for id in [1, 44, 200] {
        bytes.extend(encode_instruction(id, &Instruction::Ping)?);
        bytes.extend(encode_instruction(id, &Instruction::Read { address: 36, length: 8 })?);
        bytes.extend(encode_status(id, 0, &[0xff, 0xff, 0xfd, 0x00, 9, 200, 7, 7])?);
        bytes.extend(encode_instruction(id, &Instruction::Write { address: 30, data: vec![0, 8] })?);
        bytes.extend(encode_status(id, 0x24, &[])?);
    }
    Ok(bytes)
}

const SCRIPT: &str = concat!(
    r#"collect-recording;solve;wait:1.5;pair:3;probe:335,330;picture:a.png;show:gap-names;"#,
    r#"errors:both;object:Tomato;joint:r_elbow_y;preview-joint:"r_elbow_y",40;"#,
    r#"draw-box:1,[1,2,30,40];choose-box:2;models-accept-m1;source:{"pairs-per-second":15};"#,
    r#"robot:{"preview":{"pose":{"name":"touch-ready"}}};"#,
    r#"robot:{"preview":{"look-at":{"point_m":[0.3,0.1,0.05]}}};robot:{"speed":0.5};"#,
    r#"robot:{"connect-port":{"path":"tty"}};twin:{"hold-board":{"place":3}};"#,
    r#"twin:{"lay-board":{"x_m":0.3,"y_m":0.1,"yaw_rad":0.3}};"#,
    r#"twin:{"advance-warm-up":{"minutes":10}};twin:{"fault":{"name":"r_elbow_y","on":true}};"#,
    r#"touch:{"correct-with":"m3"};detect:{"confidence":0.4};gap:{"choose":{"sessions":["a"]}};"#,
    r#"scores:{"open-cell":{"model":0,"cell":{"truth":1,"found":2}}};scores:{"show-picture":3};"#,
    r#"quit"#,
);

const ARGUMENTS: &str =
    "--size\n1280x800\n--theme\ndark\n--screen\nlive\n--cameras\n0,2\n--twin\nlab\n--do\nwait:1;quit";

/// Commands of several workflows.
fn journal() -> Result<String, Problem> {
    let commands: Vec<Command> = vec![
        EyesCommand::ChooseBoard { columns: 9, rows: 6, square_m: 0.03 }.into(),
        EyesCommand::MinutesSinceOn(Some(12.5)).into(),
        LiveCommand::Probe(ProbePoint::Raw { eye: Eye::Left, u_px: 320.5, v_px: 240.0 }).into(),
        SourceCommand::PairsPerSecond(12.5).into(),
        SourceCommand::Open(SourceSpec::Folder("board".into())).into(),
        EyesCommand::Solve.into(),
    ];
    let heading = Heading { journal: 1, software: "plumbline".to_owned(), started: Timestamp::UNIX_EPOCH };
    let mut text = serde_json::to_string(&heading)? + "\n";
    for (k, command) in commands.into_iter().enumerate() {
        let (at_secs, newest_seq) = (0.5 * k as f64, Some(k as u64));
        let entry = Entry { at_secs, day: Some(Timestamp::UNIX_EPOCH), newest_seq, command };
        text += &(serde_json::to_string(&entry)? + "\n");
    }
    Ok(text)
}
