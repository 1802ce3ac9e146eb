//! Packets against the makers' printed bytes; streams that break; tables.

use super::*;
use plumbline_model::measured_data;
use plumbline_model::robot::servo::LAST_TICK;

fn bytes(text: &str) -> Vec<u8> {
    text.split_whitespace().map(|byte| u8::from_str_radix(byte, 16).expect("hexadecimal")).collect()
}

fn only_frame(bytes: &[u8]) -> Frame {
    let mut deframer = Deframer::default();
    deframer.push(bytes);
    let Some(Found::Frame(frame)) = deframer.pop() else { panic!("no packet in {bytes:02x?}") };
    assert_eq!(deframer.pending(), 0);
    frame
}

/// Decodes as an instruction and encodes again: the same bytes.
fn instruction_of(text: &str) -> (u8, Instruction) {
    let bytes = bytes(text);
    let frame = only_frame(&bytes);
    let instruction = decode_instruction(&frame).expect("an instruction");
    assert_eq!(encode_instruction(frame.id, &instruction), Ok(bytes), "{instruction:?}");
    (frame.id, instruction)
}

/// Decodes as a status and encodes again: the same bytes.
fn status_of(text: &str) -> Status {
    let bytes = bytes(text);
    let status = decode_status(&only_frame(&bytes));
    assert_eq!(encode_status(status.id, status.error.byte(), &status.data), Ok(bytes));
    status
}

#[test]
fn printed_packets_of_protocol_1() {
    let v1 = instruction_of;
    assert_eq!(v1("FF FF 01 02 01 FB"), (1, Instruction::Ping));
    assert_eq!(v1("FF FF 01 04 02 2B 01 CC"), (1, Instruction::Read { address: 43, length: 1 }));
    assert_eq!(
        v1("FF FF 01 05 03 0C 64 AA DC"),
        (1, Instruction::Write { address: 12, data: vec![100, 170] })
    );
    assert_eq!(
        v1("FF FF FE 0E 83 1E 04 00 10 00 50 01 01 20 02 60 03 67"),
        (
            BROADCAST,
            Instruction::SyncWrite {
                address: 30,
                length: 4,
                data: vec![(0, vec![0x10, 0, 0x50, 1]), (1, vec![0x20, 2, 0x60, 3])]
            }
        )
    );
    let items = vec![BulkItem { id: 1, address: 30, length: 2 }, BulkItem { id: 2, address: 36, length: 2 }];
    assert_eq!(v1("FF FF FE 09 92 00 02 01 1E 02 02 24 1D"), (BROADCAST, Instruction::BulkRead { items }));
    let status = status_of("FF FF 01 02 24 D8");
    assert_eq!(status.error.to_string(), "it is too hot, it is overloaded");
    assert!(status.error.is_alarm() && !status.error.is_transmission());
    assert_eq!(status_of("FF FF 01 03 00 20 DB").data, [32]);
}

#[test]
fn an_instruction_that_does_not_fit_is_refused() {
    let far = Instruction::Read { address: 300, length: 2 };
    assert!(matches!(encode_instruction(1, &far), Err(EncodeError::TooLong("read"))));
    let uneven = Instruction::SyncWrite { address: 30, length: 2, data: vec![(7, vec![1, 2, 3])] };
    assert!(matches!(encode_instruction(1, &uneven), Err(EncodeError::WrongLength { id: 7, .. })));
    let many = Instruction::SyncWrite { address: 30, length: 4, data: vec![(1, vec![0; 4]); 60] };
    assert!(matches!(encode_instruction(1, &many), Err(EncodeError::TooLong(_))));
}

/// All vectors of the makers' manual and of the maker's library, where they are at hand.
#[test]
fn measured_vectors() {
    let folder = match measured_data::folder("dynamixel") {
        Ok(folder) => folder,
        Err(reason) => {
            eprintln!("{reason}");
            return;
        }
    };
    let mut checked = 0;
    for file in ["vectors_protocol1.json", "vectors_sdk_emitted.json"] {
        let text = std::fs::read_to_string(folder.join(file)).expect("the file");
        let content: serde_json::Value = serde_json::from_str(&text).expect("JSON");
        for vector in content["vectors"].as_array().expect("a list") {
            let name = vector["name"].as_str().expect("a name");
            let bytes = vector["bytes"].as_str().expect("bytes");
            // Protocol 2.0, which none of the robot's servos speaks.
            if name.starts_with("P2") {
                continue;
            }
            // Nobody is to be able to say it.
            if vector["instruction"] == "factory_reset" {
                let frame = only_frame(&self::bytes(bytes));
                assert_eq!(decode_instruction(&frame), Err(DecodeError::UnknownInstruction(6)), "{name}");
                checked += 1;
                continue;
            }
            let id = vector["id"].as_u64();
            if vector["kind"] == "status" || name.contains("status") {
                let status = status_of(bytes);
                assert!(id.is_none_or(|id| id == u64::from(status.id)), "{name}");
                if let Some(error) = vector["error"].as_u64() {
                    assert_eq!(error, u64::from(status.error.byte()), "{name}");
                    let data: Vec<u8> = serde_json::from_value(vector["data"].clone()).expect("bytes");
                    assert_eq!(data, status.data, "{name}");
                }
            } else {
                let (found, instruction) = instruction_of(bytes);
                assert!(id.is_none_or(|id| id == u64::from(found)), "{name}");
                if let Some(wanted) = vector["instruction"].as_str() {
                    assert_eq!(wanted, instruction.name().replace(' ', "_"), "{name}");
                }
                let parts = match &instruction {
                    Instruction::Read { address, length } => Some((*address, Some(*length), None)),
                    Instruction::Write { address, data } | Instruction::RegWrite { address, data } => {
                        Some((*address, None, Some(data.clone())))
                    }
                    Instruction::SyncWrite { address, length, .. } => Some((*address, Some(*length), None)),
                    _ => None,
                };
                if let (Some((address, length, data)), Some(wanted)) = (parts, vector["address"].as_u64()) {
                    assert_eq!(u64::from(address), wanted, "{name}");
                    assert_eq!(length.map(u64::from), vector["length"].as_u64(), "{name}");
                    if let Some(data) = data {
                        let wanted: Vec<u8> = serde_json::from_value(vector["data"].clone()).expect("bytes");
                        assert_eq!(data, wanted, "{name}");
                    }
                }
            }
            checked += 1;
        }
    }
    eprintln!("{checked} vectors hold");
    assert!(checked >= 18, "only {checked} vectors were checked");
}

#[test]
fn any_bytes_come_back() {
    // A small generator with a fixed seed: many 0xFF and 0xFD, which are what may go wrong.
    let mut state = 12_345_u32;
    let mut next = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        [0xFF, 0xFF, 0xFD, 0x00, (state >> 8) as u8][(state >> 24) as usize % 5]
    };
    for length in 0..120 {
        let data: Vec<u8> = (0..length).map(|_| next()).collect();
        let encoded = encode_status(5, 0, &data).expect("short enough");
        assert_eq!(decode_status(&only_frame(&encoded)).data, data);
    }
}

#[test]
fn a_stream_recovers_after_whatever_was_broken() {
    let good = encode_status(3, 0, &[1, 2, 3, 4]).expect("short enough");
    for broken in 0..good.len() {
        for mask in [0x01, 0x80, 0xFF] {
            let mut stream = good.clone();
            stream[broken] ^= mask;
            stream.extend_from_slice(&good);
            // A broken length may announce more than comes: the host gives up, so bytes enough.
            for _ in 0..90 {
                stream.extend_from_slice(&good);
            }
            let mut deframer = Deframer::default();
            let mut right = 0;
            for byte in stream {
                deframer.push(&[byte]);
                while let Some(found) = deframer.pop() {
                    match found {
                        // The sum of 1.0 is weak: a length that is one too large, and the next
                        // packet's header as sum, pass it. The host knows the length it wants.
                        Found::Frame(frame) => {
                            let status = decode_status(&frame);
                            if status.data.len() == 4 {
                                assert_eq!(status.data, [1, 2, 3, 4], "{broken} {mask}");
                                right += 1;
                            }
                        }
                        Found::Garbage(bytes) => assert!(bytes > 0),
                        Found::WrongCheck { .. } => {}
                    }
                }
            }
            assert!(right >= 20, "byte {broken} broken, {right} packets found");
        }
    }
}

#[test]
fn tables_are_readable_and_do_not_overlap() {
    for table in ControlTable::all() {
        let mut registers: Vec<(Item, &Register)> = table.registers().collect();
        registers.sort_by_key(|(_, register)| register.address);
        for pair in registers.windows(2) {
            let ((item, register), (_, next)) = (pair[0], pair[1]);
            assert!(register.address + register.size <= next.address, "{table}: {item:?} overlaps");
            assert!(matches!(register.size, 1 | 2) && register.scale > 0.0, "{table}: {item:?}");
        }
    }
    let mx = ControlTable::of_model("MX-64").expect("known");
    assert_eq!(ControlTable::of_number(310), Some(mx));
    for (item, address, size) in [
        (Item::GoalPosition, 30, 2),
        (Item::MovingSpeed, 32, 2),
        (Item::PresentPosition, 36, 2),
        (Item::PresentLoad, 40, 2),
        (Item::PresentTemperature, 43, 1),
    ] {
        let register = mx.register(item).expect("part of it");
        assert_eq!((register.address, register.size), (address, size));
    }
    assert_eq!(ControlTable::of_model("SR-EROSBRD-").map(|table| table.number), Some(405));
    assert_eq!(ControlTable::of_model("SR-SEED28").map(|table| table.number), Some(404));
    assert_eq!(ControlTable::of_model("AX-12"), None);
}

#[test]
fn raw_values_become_si_and_back() {
    let mx = ControlTable::of_model("MX-64").expect("known");
    assert_eq!(mx.motor_rad(Ticks(2048)), Some(0.0));
    assert_eq!(mx.motor_rad(Ticks(1024)), Some(-std::f64::consts::FRAC_PI_2));
    for ticks in 0..=LAST_TICK {
        let motor_rad = mx.motor_rad(Ticks(ticks)).expect("a position");
        assert_eq!(mx.ticks(motor_rad), Some(Ticks(ticks)));
    }
    assert_eq!(mx.ticks(std::f64::consts::PI), Some(Ticks(LAST_TICK)));
    for beyond in [3.15, -3.15, f64::NAN, f64::INFINITY] {
        assert_eq!(mx.ticks(beyond), None, "{beyond}");
    }
    let load = mx.register(Item::PresentLoad).expect("part of it");
    assert!((load.si(1024 + 512) + 0.5).abs() < 1e-3 && (load.si(512) - 0.5).abs() < 1e-3);
    assert_eq!(load.raw(-0.5), Some(1024 + 512));
    let speed = mx.register(Item::MovingSpeed).expect("part of it");
    assert_eq!(speed.raw(30f64.to_radians()), Some(44));
}
