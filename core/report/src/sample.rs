//! Made-up findings, one of each kind, for tests and for pictures of the window: nothing here was
//! measured.

use nalgebra::Isometry3;
use plumbline_effects::measurements::{Unit, What};
use plumbline_gap::finding::{
    Candidate, ClassMember, Comparison, CoordinateComparison, Dependence, Experiment, FORMAT, FoundParameter,
    KindComparison, Knowledge, NamedEffect, NextExperiment, Residual, Shown, ShownUnit, Unexplained, Unseen,
};
use plumbline_gap::{Finding, Verdict};

use crate::{HistoryEntry, ReportContext};

/// A context that goes with the findings of this module.
pub fn context() -> ReportContext {
    let entry = |name: &str, gap: f64| HistoryEntry { name: name.to_owned(), gap };
    ReportContext {
        date: "21 November 2026".to_owned(),
        model: "nominal model".to_owned(),
        history: vec![
            entry("nominal", 6.71e-3),
            entry("zero of the elbow", 4.32e-3),
            entry("+ sag of the shoulder", 3.58e-3),
        ],
        screen_m: Some([[0.26, 0.28], [0.26, -0.28], [0.58, -0.28], [0.58, 0.28]]),
    }
}

/// Two effects, both named.
pub fn named() -> Finding {
    Finding {
        verdict: Verdict::Named,
        sentence: "The elbow's zero is off by 1.8° and the bracket of the shoulder gives way under load. With both in the model the mean error falls from 6.7 mm to 3.6 mm, close to the 3.0 mm that noise leaves.".to_owned(),
        effects: vec![elbow_zero(), shoulder_sag()],
        ..base()
    }
}

/// Many things are a little off, and one name is sure.
pub fn much() -> Finding {
    let mut sag = shoulder_sag();
    (sag.probability, sag.class_probability) = (0.41, 0.41);
    Finding {
        verdict: Verdict::Class,
        many: Some(0.96),
        sentence: "Many things are a little off, more than these rows can tell apart. Sure: right elbow: zero position off. The other name is not. With it the error on rows that were not used falls from 6.71 mm to 3.58 mm; noise alone leaves 3.02 mm.".to_owned(),
        effects: vec![elbow_zero(), sag],
        ..base()
    }
}

/// One effect with two possible names.
pub fn class() -> Finding {
    let mut sag = shoulder_sag();
    sag.probability = 0.58;
    sag.class_probability = 0.97;
    sag.class.push(member(
        "joint-eccentricity",
        "r_shoulder_y",
        "Shoulder, forward: encoder or gear off center",
        0.39,
    ));
    sag.split_by = Some("repeat ten poses with a 250 g weight at the palm".to_owned());
    Finding {
        verdict: Verdict::Class,
        sentence: "Something that swings with the angle of the shoulder is missing: its bracket gives way under load, or its encoder sits off center. These data cannot tell which.".to_owned(),
        effects: vec![sag],
        next: Some(NextExperiment {
            what: "repeat 10 poses with a 250 g weight at the palm".to_owned(),
            why: "A bracket gives way more under the weight, an encoder does not mind it".to_owned(),
            kind: Experiment::Weight,
            count: 10,
            minutes: 4.5,
            expected_probability: 0.96,
            others: vec![
                ("touch 12 places with another posture of the elbow".to_owned(), 0.84, 5.0),
                ("touch 12 places with the screen raised by 60 mm".to_owned(), 0.71, 6.0),
            ],
        }),
        ..base()
    }
}

/// A gap that is not in the library.
pub fn not_in_library() -> Finding {
    let mut like = elbow_zero();
    like.probability = 0.21;
    like.class_probability = 0.21;
    let mut finding = Finding {
        verdict: Verdict::NotInLibrary,
        sentence: "There is a gap of 6.7 mm, but no effect of the library explains it: after the best of them far more is left than noise leaves.".to_owned(),
        effects: vec![like],
        ..base()
    };
    finding.shown.after = 5.3e-3;
    finding.shown.closure = Some(0.38);
    finding.shown.closure_range = Some([0.2, 0.51]);
    finding.unexplained = Unexplained {
        p_value: 1e-6,
        probability: 0.93,
        depends_on: vec![Dependence {
            on: "angle of the elbow".to_owned(),
            of: "error along u".to_owned(),
            share: 0.46,
            formula: Some("about 2.9 mm × sin(3 × angle)".to_owned()),
        }],
        share: 0.62,
    };
    finding
}

/// Model and measurement agree.
pub fn no_gap() -> Finding {
    let mut finding = Finding {
        verdict: Verdict::NoGap,
        sentence: "There is no gap: what was measured differs from the model by no more than repeats of the same touch differ from each other.".to_owned(),
        effects: vec![],
        ..base()
    };
    finding.shown = Shown {
        before: 3.1e-3,
        after: 3.1e-3,
        floor: 3.0e-3,
        closure: None,
        closure_range: None,
        unseen: None,
        ..finding.shown
    };
    finding.shown.telling.clear();
    for residual in &mut finding.comparison.residuals {
        residual.before_m = residual.after_m;
    }
    for coordinate in finding.comparison.kinds.iter_mut().flat_map(|kind| &mut kind.coordinates) {
        coordinate.rms = 1.02 * coordinate.floor;
        coordinate.share = 1.0 / 3.0;
    }
    for candidate in &mut finding.candidates {
        candidate.probability *= 0.02;
        candidate.score_sigmas *= 0.1;
    }
    finding.comparison.is_gap = false;
    finding.comparison.p_value = 0.41;
    finding.comparison.size_sigmas = 0.08;
    finding
}

/// Nothing but a verdict: what is left of a search that could compare nothing.
pub fn empty() -> Finding {
    let mut finding = no_gap();
    finding.sessions.clear();
    finding.candidates.clear();
    finding.comparison.residuals.clear();
    finding.comparison.kinds.clear();
    finding.comparison.rows = 0;
    finding.comparison.rows_kept = 0;
    finding.comparison.cells = 0;
    finding.shown.rows = 0;
    (finding.shown.before, finding.shown.floor) = (f64::NAN, f64::NAN);
    finding.sentence = String::new();
    finding
}

/// As much as there can be: six effects of many parameters, long names, thousands of rows.
pub fn crowded() -> Finding {
    let long =
        "right shoulder, second joint from the torso, the one that turns the arm sideways: axis not square";
    let mut effects = vec![];
    for i in 0..7 {
        let mut effect = if i % 2 == 0 { elbow_zero() } else { shoulder_sag() };
        effect.title = format!("{long} {i}");
        effect.parameters = ["rot_x_rad", "rot_y_rad", "rot_z_rad", "x_m", "y_m", "z_m"]
            .map(|name| parameter(name, 0.0123, 0.0101, 0.0143))
            .to_vec();
        effect.class.push(member("joint-scale", "x", long, 0.1));
        effect.class.push(member("joint-scale", "y", long, 0.1));
        effect.split_by = Some(
            "repeat ten poses with a 250 g weight at the palm and the screen raised by 60 mm".to_owned(),
        );
        effects.push(effect);
    }
    let mut finding = Finding { effects, verdict: Verdict::Class, ..class() };
    finding.sentence =
        format!("{} {}", finding.sentence, "Much is missing, and all of it has long names.".repeat(6));
    finding.sessions = (0..12).map(|i| format!("2026-11-21-touch-rich-with-a-very-long-name-{i}")).collect();
    finding.rig =
        "nico-with-a-very-long-name-of-a-robot-that-nobody-would-choose-but-somebody-did".to_owned();
    finding.warnings = vec!["residuals are 1000 times too large, which is a unit".to_owned(); 4];
    let many = finding.comparison.residuals.clone();
    for _ in 0..20 {
        finding.comparison.residuals.extend(many.iter().cloned());
    }
    finding
}

/// Measured with the eyes only, in pixels.
pub fn pixels() -> Finding {
    let mut finding = named();
    finding.shown.unit = ShownUnit::Pixel;
    (finding.shown.before, finding.shown.after, finding.shown.floor) = (2.31, 0.42, 0.31);
    finding.shown.worst_tenth = [13.2, 7.4];
    finding.shown.unseen = None;
    finding.comparison.kinds = vec![KindComparison {
        what: What::EyePoints,
        coordinates: What::EyePoints
            .coordinates()
            .iter()
            .zip([0.12, 0.31, 0.4, 0.17])
            .map(|((name, unit), share)| coordinate(name, *unit, 2.0 * share, 0.3, share))
            .collect(),
    }];
    finding.sentence = "The eyes sit 1.4° turned against the head.".to_owned();
    finding.effects.truncate(1);
    finding.effects[0].id = "camera-mount".to_owned();
    finding.effects[0].size_m = 1.9;
    finding.effects[0].title = "Eyes: mounted elsewhere than in the model".to_owned();
    finding
}

fn base() -> Finding {
    Finding {
        format: FORMAT,
        rig: "nico".to_owned(),
        sessions: vec!["2026-11-20-touch-rich".to_owned()],
        version: "0.1.0".to_owned(),
        seed: 1,
        verdict: Verdict::Named,
        sentence: String::new(),
        comparison: Comparison {
            rows: 246,
            rows_kept: 245,
            cells: 61,
            kinds: vec![KindComparison {
                what: What::Touch,
                coordinates: vec![
                    coordinate("along u", Unit::Meter, 0.0051, 0.0021, 0.34),
                    coordinate("along v", Unit::Meter, 0.0064, 0.0023, 0.52),
                    coordinate("height over the glass", Unit::Meter, 0.0012, 0.0007, 0.14),
                ],
            }],
            floor_from_repeats: true,
            floor_source: plumbline_gap::finding::FloorSource::Repeats,
            p_value: 1e-9,
            size_sigmas: 2.4,
            is_gap: true,
            residuals: residuals(),
        },
        effects: vec![],
        candidates: candidates(),
        shown: Shown {
            blocks: "5 folds of whole sets".to_owned(),
            rows: 245,
            unit: ShownUnit::Meter,
            before: 6.71e-3,
            after: 3.58e-3,
            floor: 2.98e-3,
            closure: Some(0.84),
            closure_range: Some([0.71, 0.93]),
            worst_tenth: [13.2e-3, 7.4e-3],
            inside_95: 0.94,
            unseen: Some(Unseen {
                what: "with a weight of 250 g".to_owned(),
                rows: 40,
                before: 8.4e-3,
                after: 3.9e-3,
                floor: 3.0e-3,
            }),
            part: None,
            covariates: vec![
                ("angle of the elbow".to_owned(), "rad".to_owned()),
                ("load of the shoulder".to_owned(), "N m".to_owned()),
            ],
            telling: vec![0, 1],
        },
        unexplained: Unexplained { p_value: 0.21, probability: 0.04, depends_on: vec![], share: 0.16 },
        next: None,
        placements: vec![Isometry3::identity()],
        mounts: vec![],
        partial: false,
        many: None,
        undetermined: vec![],
        left_out: vec![],
        warnings: vec![],
        seconds: 2.7,
    }
}

fn coordinate(name: &str, unit: Unit, rms: f64, floor: f64, share: f64) -> CoordinateComparison {
    CoordinateComparison { name: name.to_owned(), unit, rms, floor, share }
}

fn parameter(name: &str, value: f64, low: f64, high: f64) -> FoundParameter {
    FoundParameter { name: name.to_owned(), value, low, high, text: None }
}

fn member(id: &str, site: &str, title: &str, probability: f64) -> ClassMember {
    ClassMember { id: id.to_owned(), site: site.to_owned(), title: title.to_owned(), probability }
}

fn elbow_zero() -> NamedEffect {
    NamedEffect {
        id: "joint-zero".to_owned(),
        site: "r_elbow_y".to_owned(),
        title: "Elbow: zero position off".to_owned(),
        probability: 0.97,
        class_probability: 0.97,
        parameters: vec![parameter("offset_rad", 0.031, 0.028, 0.034)],
        shape: None,
        reference_s: 0.0,
        values: vec![0.031],
        covariance: vec![2.3e-6],
        size_sigmas: 2.1,
        size_m: 4.8e-3,
        class: vec![member("joint-zero", "r_elbow_y", "Elbow: zero position off", 1.0)],
        beside: vec![],
        split_by: None,
        runner_up: Some(("link-length@r_lower_arm".to_owned(), 3.1)),
        not_addable: None,
    }
}

fn shoulder_sag() -> NamedEffect {
    NamedEffect {
        id: "joint-sag".to_owned(),
        site: "r_shoulder_y".to_owned(),
        title: "Shoulder, forward: bracket gives way under load".to_owned(),
        probability: 0.91,
        class_probability: 0.91,
        parameters: vec![parameter("compliance_rad_per_nm", 0.0112, 0.0087, 0.0137)],
        shape: None,
        reference_s: 0.0,
        values: vec![0.0112],
        covariance: vec![1.6e-6],
        size_sigmas: 1.2,
        size_m: 2.6e-3,
        class: vec![member(
            "joint-sag",
            "r_shoulder_y",
            "Shoulder, forward: bracket gives way under load",
            1.0,
        )],
        beside: vec![],
        split_by: None,
        runner_up: Some(("joint-eccentricity@r_shoulder_y".to_owned(), 1.4)),
        not_addable: None,
    }
}

fn candidates() -> Vec<Candidate> {
    let of = |id: &str, site: &str, title: &str, probability: f64, knowledge: Knowledge| Candidate {
        id: id.to_owned(),
        site: site.to_owned(),
        title: title.to_owned(),
        probability,
        score_sigmas: 10.0 * probability,
        knowledge,
    };
    let with_elbow = Knowledge::TradeOff(vec!["joint-zero@r_elbow_y".to_owned()]);
    vec![
        of("joint-zero", "r_elbow_y", "Elbow: zero position off", 0.97, Knowledge::Known),
        of(
            "joint-sag",
            "r_shoulder_y",
            "Shoulder, forward: bracket gives way under load",
            0.91,
            Knowledge::Known,
        ),
        of("link-length", "r_lower_arm", "Lower arm: wrong length", 0.02, with_elbow),
        of("backlash", "r_elbow_y", "Elbow: play in the gears", 0.0, Knowledge::Dead),
        of("finger-roll", "tip", "fingertip rolls on the glass", 0.0, Knowledge::Flat),
    ]
}

/// Noise from a simple generator: the same on every machine.
fn noise(state: &mut u64) -> f64 {
    let mut sum = 0.0;
    for _ in 0..12 {
        *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        sum += (*state >> 11) as f64 / (1u64 << 53) as f64;
    }
    sum - 6.0
}

fn residuals() -> Vec<Residual> {
    let mut state = 7;
    let mut rows = vec![];
    for i in 0..82 {
        let (column, line) = (i % 10, i / 10);
        let at = [0.29 + 0.032 * f64::from(line), 0.25 - 0.055 * f64::from(column)];
        let reach = at[0].hypot(at[1] + 0.2);
        let elbow = 2.4 - 2.6 * reach;
        let load = 4.0 * reach;
        for _ in 0..3 {
            let rest = [0.0019 * noise(&mut state), 0.0019 * noise(&mut state), 0.0006 * noise(&mut state)];
            let shift = [0.0085 * (elbow - 1.2), -0.004 + 0.006 * (load - 1.6), 0.001 * load];
            rows.push(Residual {
                session: 0,
                what: What::Touch,
                row: rows.len(),
                set: format!("line {line}"),
                at_m: [at[0], at[1], 0.69],
                before_m: std::array::from_fn(|k| shift[k] + rest[k]),
                after_m: rest,
                covariates: vec![Some(elbow), Some(load)],
                outlier: false,
            });
        }
    }
    if let Some(last) = rows.last_mut() {
        last.outlier = true;
        last.before_m = [0.3, 0.0, 0.0];
    }
    rows
}
